"""Which shapes may touch, as MuJoCo's masks of 32 bits, where Newton finds none that say it exactly.

Newton covers the pairs that may touch by stars, which more than 33 shapes need not fit into, and then gives each shape
that may touch all others a colour of its own: from the 33rd on pairs that are not to touch do. Here shapes that are
kept from the same others share a bit: a wall of forty bricks, a post and a door on it are three kinds.

Where those are more than bits, clusters of shapes that hang together by pairs kept apart, robots for one, share theirs.
A bit for each kind of the largest cluster says who touches within each. What is in two clusters touches, if shapes of
their forms do at all: of C clusters, log2 C bits tell any two apart, for each class of forms.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import newton
import numpy as np
from scipy.sparse.csgraph import connected_components

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
    masks = by_kinds(body, group, pairs, model.shape_type.numpy()[shapes])
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


def by_kinds(
    body: Integers, group: Integers, apart: Integers, form: Integers | None = None
) -> tuple[Integers, Integers] | None:
    """Masks of shapes, contype and conaffinity, (N,) each, from 0 to 2^32 - 1; None where they are of too many kinds.

    Args:
        body: Of each shape, (N,); -1 stands still. What is of one body never touches in MuJoCo.
        group: Newton's collision group of each, (N,): 0 touches nothing. Others than 0 and 1 are left to Newton.
        apart: Pairs that are not to touch, (P, 2).
        form: What each is, a box for one, (N,); by default all are the same.
    """
    if not np.isin(group, (0, 1)).all():
        return None
    touches = group != 0
    kept = _matrix(len(body), apart)
    known = _known_of_bodies(body, kept)
    must = ~kept & ~known & touches & touches[:, None]
    kept &= ~known
    kind = _kinds(kept)
    if kind.max(initial=0) < BITS:
        meets, bits = _meets(kept, kind), 1 << np.arange(kind.max(initial=-1) + 1, dtype=np.int64)
        masks = bits[kind], (meets * bits).sum(axis=1)[kind]
    else:
        found = _by_clusters(kept, must, np.zeros_like(body) if form is None else form)
        if found is None:
            return None
        masks = found
    return np.where(touches, masks[0], 0), np.where(touches, masks[1], 0)


def _meets(kept: Bools, kind: Integers) -> Bools:
    """Which of K kinds touch, (K, K)."""
    first = np.unique(kind, return_index=True)[1]
    meets = ~kept[np.ix_(first, first)]
    for k, shape in enumerate(first):  # two of a kind
        others = np.flatnonzero(kind == k)
        meets[k, k] = len(others) < 2 or not kept[shape, others[others != shape][0]]
    return np.asarray(meets)


def _by_clusters(kept: Bools, must: Bools, form: Integers) -> tuple[Integers, Integers] | None:
    """Masks (N,) with bits that clusters share; None where that takes too many.

    Args:
        kept: Which are kept apart by masks alone, (N, N).
        must: Which are to touch, (N, N); of what is in neither, MuJoCo knows otherwise.
        form: What each is, (N,).
    """
    never, klass = _classes(kept, must, form)
    kept = kept & ~never[np.ix_(klass, klass)]
    kind = np.unique(np.stack([_kinds(kept), klass], axis=1), axis=0, return_inverse=True)[1].reshape(-1)
    own = klass[np.unique(kind, return_index=True)[1]]  # of each kind
    meets = _meets(kept, kind)
    count, cluster = connected_components(~meets, directed=False)
    place, most = np.zeros(len(own), dtype=np.int64), 0
    for each in range(len(never)):  # a bit is of one class in all clusters
        rows = [np.flatnonzero((cluster == c) & (own == each)) for c in range(count)]
        for row in rows:
            place[row] = most + np.arange(len(row))
        most += max(map(len, rows))
    codes = (count - 1).bit_length()
    if most + codes * len(never) > BITS:
        return None
    bit, code, may = np.int64(1) << place, cluster.astype(np.int64), ~never[np.ix_(own, own)]
    near = meets & may & (cluster[:, None] == cluster)
    shift = most + codes * np.arange(len(never))  # where the codes of each class are
    contype = bit | code << shift[own]  # what differs in a bit of the code meets by it, one way or the other
    other = (~code & ((1 << codes) - 1))[:, None] << shift
    return contype[kind], ((near * bit).sum(axis=1) | (other * ~never[own]).sum(axis=1))[kind]


def _classes(kept: Bools, must: Bools, form: Integers) -> tuple[Bools, Integers]:
    """Classes of forms that touch the same forms: which two of them never do, and the class of each shape."""
    form = np.unique(form, return_inverse=True)[1].reshape(-1)
    touch, part = _grouped(must, form), _grouped(kept, form)
    part &= ~touch
    klass = np.arange(len(touch))
    for own in range(1, len(klass)):
        for other in range(own):
            tried = np.where(np.arange(len(klass)) == own, klass[other], klass)
            if not (_grouped(touch, tried) & _grouped(part, tried)).any():
                klass = tried
                break
    klass = np.unique(klass, return_inverse=True)[1].reshape(-1)
    return _grouped(part, klass), klass[form]


def _grouped(pairs: Bools, group: Integers) -> Bools:
    """Which groups any pair (N, N) is of, (G, G)."""
    has = (group == np.arange(group.max(initial=0) + 1)[:, None]).astype(float)
    return np.asarray(has @ pairs.astype(float) @ has.T > 0.0)


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
