"""Which shapes may touch, as MuJoCo's masks of 32 bits, where Newton finds none that say it exactly.

Newton covers the pairs that may touch by stars, which more than 33 shapes need not fit into, and then gives each shape
that may touch all others a colour of its own: from the 33rd on pairs that are not to touch do. Here shapes that are
kept from the same others share a bit: a wall of forty bricks, a post and a door on it are three kinds.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Integers = NDArray[np.int64]
    Bools = NDArray[np.bool_]

BITS = 32


def compiled_by_kinds(model: Any, shapes: Integers, found: Any) -> Any:
    """What Newton has compiled for some shapes of a model, with masks by kinds; as it was where there are none."""
    one, two = np.triu_indices(len(shapes), k=1)
    apart = model.shape_collision_filter_mask(np.stack((shapes[one], shapes[two]), axis=1))
    body, group = (each.numpy()[shapes] for each in (model.shape_body, model.shape_collision_group))
    masks = by_kinds(body, group, np.stack((one[apart], two[apart]), axis=1))
    return replace(found, exact=True, collision_type=masks[0], collision_affinity=masks[1]) if masks else found


def by_kinds(body: Integers, group: Integers, apart: Integers) -> tuple[Integers, Integers] | None:
    """Masks of shapes, contype and conaffinity, (N,) each, from 0 to 2^32 - 1; None where they are of too many kinds.

    Args:
        body: Of each shape, (N,); -1 stands still. What is of one body never touches in MuJoCo.
        group: Newton's collision group of each, (N,): 0 touches nothing. Others than 0 and 1 are left to Newton.
        apart: Pairs that are not to touch, (P, 2).
    """
    if not np.isin(group, (0, 1)).all():
        return None
    kept = np.zeros((len(body), len(body)), dtype=bool)
    kept[apart[:, 0], apart[:, 1]] = kept[apart[:, 1], apart[:, 0]] = True
    kept &= ~_known_of_bodies(body, kept)
    kind = _kinds(kept)
    first = np.unique(kind, return_index=True)[1]
    if len(first) > BITS:
        return None
    bits = 1 << np.arange(len(first), dtype=np.int64)
    meets = ~kept[np.ix_(first, first)]
    for k, shape in enumerate(first):  # two of a kind
        others = np.flatnonzero(kind == k)
        meets[k, k] = len(others) < 2 or not kept[shape, others[others != shape][0]]
    touches = group != 0
    return np.where(touches, bits[kind], 0), np.where(touches, (meets * bits).sum(axis=1)[kind], 0)


def _known_of_bodies(body: Integers, kept: Bools) -> Bools:
    """Pairs (N, N) of which MuJoCo knows by their bodies: of one, or of two that move and keep apart as a whole."""
    same = body[:, None] == body
    which = body == np.unique(body)[:, None]  # (bodies, N)
    may = which.astype(np.int64) @ (~kept & ~same).astype(np.int64) @ which.T.astype(np.int64)
    row = np.searchsorted(np.unique(body), body)
    whole = (may == 0)[np.ix_(row, row)]
    return np.asarray(same | (whole & (body[:, None] >= 0) & (body >= 0)))


def _kinds(kept: Bools) -> Integers:
    """Which shapes are kept from the same others, each other among them or not, (N,)."""
    closed = kept | np.eye(len(kept), dtype=bool)
    _, among, count = np.unique(closed, axis=0, return_inverse=True, return_counts=True)
    _, without = np.unique(kept, axis=0, return_inverse=True)
    among, without = among.reshape(-1), without.reshape(-1)
    alike = count[among] > 1
    names = np.where(alike, among, len(kept) + without)
    return np.asarray(np.unique(names, return_inverse=True)[1]).reshape(-1)
