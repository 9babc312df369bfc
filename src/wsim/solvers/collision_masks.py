"""Which shapes may touch, as MuJoCo's masks of 32 bits, where Newton finds none that say it exactly.

Newton covers the pairs that may touch by stars, which more than 33 shapes need not fit into, and then gives each shape
that may touch all others a colour of its own: from the 33rd on pairs that are not to touch do. Here shapes that are
kept from the same others share a bit: a wall of forty bricks, a post and a door on it are three kinds.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import newton
import numpy as np

from wsim.errors import UserError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Integers = NDArray[np.int64]
    Bools = NDArray[np.bool_]

BITS = 32


def compiled_by_kinds(model: Any, shapes: Integers, found: Any) -> Any:
    """What Newton has compiled for some shapes of a model, with masks by kinds; as it was where its colours do as well.

    Raises:
        UserError: If neither keeps all apart that is to be.
    """
    one, two = np.triu_indices(len(shapes), k=1)
    apart = model.shape_collision_filter_mask(np.stack((shapes[one], shapes[two]), axis=1))
    pairs = np.stack((one[apart], two[apart]), axis=1)
    body, group = (each.numpy()[shapes] for each in (model.shape_body, model.shape_collision_group))
    masks = by_kinds(body, group, pairs)
    if masks:
        return replace(found, exact=True, collision_type=masks[0], collision_affinity=masks[1])
    kept = _matrix(len(shapes), pairs)
    met = np.argwhere(kept & ~_known_of_bodies(body, kept) & _met_by_colours(model, shapes, group))
    if len(met):
        first, second = (model.shape_label[shapes[k]] for k in met[0])
        raise UserError(
            f"{first} and {second} are not to touch, nor are {len(met) // 2 - 1} more pairs: more than can be "
            f"told by {BITS} bits; give static shapes that others hang on kinematic=True in place of static=True"
        )
    return found


def _met_by_colours(model: Any, shapes: Integers, group: Integers) -> Bools:
    """Which shapes touch by the colours that Newton takes else, (N, N)."""
    solver = newton.solvers.SolverMuJoCo
    colours = solver._color_collision_shapes(model, shapes, False, model.shape_label)[shapes]
    masks = np.array([solver._collision_color_masks(int(each)) for each in colours], dtype=np.int64) & (2**BITS - 1)
    contype, conaffinity = np.where(group[:, None] != 0, masks, 0).T
    one_way = (contype[:, None] & conaffinity) != 0
    return np.asarray(one_way | one_way.T)


def by_kinds(body: Integers, group: Integers, apart: Integers) -> tuple[Integers, Integers] | None:
    """Masks of shapes, contype and conaffinity, (N,) each, from 0 to 2^32 - 1; None where they are of too many kinds.

    Args:
        body: Of each shape, (N,); -1 stands still. What is of one body never touches in MuJoCo.
        group: Newton's collision group of each, (N,): 0 touches nothing. Others than 0 and 1 are left to Newton.
        apart: Pairs that are not to touch, (P, 2).
    """
    if not np.isin(group, (0, 1)).all():
        return None
    kept = _matrix(len(body), apart)
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


def _matrix(count: int, pairs: Integers) -> Bools:
    """Pairs (P, 2) of `count` things, both ways, (N, N)."""
    found = np.zeros((count, count), dtype=bool)
    found[pairs[:, 0], pairs[:, 1]] = found[pairs[:, 1], pairs[:, 0]] = True
    return found


def _known_of_bodies(body: Integers, kept: Bools) -> Bools:
    """Pairs (N, N) of which MuJoCo knows by their bodies: of one, or of two that move and keep apart as a whole."""
    same = body[:, None] == body
    which = body == np.unique(body)[:, None]  # (bodies, N)
    may = which.astype(float) @ (~kept & ~same).astype(float) @ which.T.astype(float)  # how many pairs of each two
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
