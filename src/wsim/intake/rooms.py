"""The upright box in an asset that things can be put into: what `hollow` says in its metadata."""

from __future__ import annotations

import numpy as np
from scipy import ndimage

from wsim.intake.lattice import Bools
from wsim.intake.measure import Seen
from wsim.intake.model import Array, Collider

WALLED = 0.8  # share of a side, or of the floor, that something closes
SIDES = 3  # that must be closed: a cupboard is open in front
_HIGHEST_START = 0.2  # of the room's height: how far above its floor the box may begin
_THINNEST = 3  # cells along each edge

Span = tuple[int, int]
Box = tuple[Span, Span, Span]


def room(seen: Seen, colliders: list[Collider]) -> tuple[Array, Array] | None:
    """Size and centre [m] of the largest upright box that is free, has a floor and at least three walls; or None."""
    filled = seen.lattice.union(colliders)
    if seen.inside is not None:
        filled = filled | seen.inside
    best: tuple[int, Box] | None = None
    for cells in seen.rooms:
        for box in _boxes(cells & ~filled):
            count = int(np.prod([last - first for first, last in box]))
            if _holds(filled, box) and (best is None or count > best[0]):
                best = count, box
    if best is None:
        return None
    # From centre to centre of its cells, of which the outer halves may not be free.
    low = np.array([seen.lattice.centers(k)[best[1][k][0]] for k in range(3)])
    high = np.array([seen.lattice.centers(k)[best[1][k][1] - 1] for k in range(3)])
    return high - low, (low + high) / 2


def _boxes(free: Bools) -> list[Box]:
    """From some heights near the floor of a room: the largest square there, widened, and raised as far as it goes."""
    heights = np.flatnonzero(free.any(axis=(0, 1)))
    if not len(heights):
        return []
    highest = heights[0] + max(1, round(_HIGHEST_START * (heights[-1] - heights[0])))
    boxes = []
    for z in range(heights[0], highest + 1):
        reach = ndimage.distance_transform_cdt(np.pad(free[:, :, z], 1), metric="chessboard")[1:-1, 1:-1]
        x, y = np.unravel_index(int(reach.argmax()), reach.shape)
        r = int(reach[x, y]) - 1
        if r < 1:
            continue
        box: Box = ((int(x) - r, int(x) + r + 1), (int(y) - r, int(y) + r + 1), (z, z + 1))
        grown = _grown(free, box)
        if min(last - first for first, last in grown) >= _THINNEST:
            boxes.append(grown)
    return boxes


def _grown(free: Bools, box: Box) -> Box:
    """A box moved out as long as it stays free: sideways by turns, then upwards."""
    spans = [list(span) for span in box]
    for axes in ((0, 1), (2,)):
        moving = True
        while moving:
            moving = False
            for axis in axes:
                for end in (1,) if axis == 2 else (0, 1):
                    at = spans[axis][1] if end else spans[axis][0] - 1
                    if not 0 <= at < free.shape[axis]:
                        continue
                    slab = [slice(*span) for span in spans]
                    slab[axis] = slice(at, at + 1)
                    if free[tuple(slab)].all():
                        spans[axis][end] += 1 if end else -1
                        moving = True
    (a, b), (c, d), (e, f) = spans
    return (a, b), (c, d), (e, f)


def _holds(filled: Bools, box: Box) -> bool:
    """Whether a box has a floor and enough walls."""
    (x0, x1), (y0, y1), (z0, z1) = box
    if filled[x0:x1, y0:y1, :z0].any(axis=2).mean() < WALLED:
        return False
    walls = (
        filled[:x0, y0:y1, z0:z1].any(axis=0), filled[x1:, y0:y1, z0:z1].any(axis=0),
        filled[x0:x1, :y0, z0:z1].any(axis=1), filled[x0:x1, y1:, z0:z1].any(axis=1),
    )  # fmt: skip
    return sum(wall.mean() >= WALLED for wall in walls) >= SIDES
