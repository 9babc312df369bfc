"""How deep shapes are in each other, from their recorded poses."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import numpy as np

from wsim.geometry.rotations import conjugate, lengths, matrices, multiply, rotate
from wsim.scene.contact import passing

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.evidence.placed import Placed
    from wsim.judge.evidence.recorded import Part, Recorded

    Floats = NDArray[np.float64]

CHUNK = 2048  # frames probed at once
CAUGHT = 5.0  # time constants, after which a soft contact has let go of what it caught


@dataclass
class Overlap:
    """Two shapes that come into each other."""

    a: Placed
    b: Placed
    depth: Floats  # (T,) [m]; not positive when apart
    rows: tuple[int, int]  # in `Recorded.placed`


def overlaps(evidence: Recorded) -> list[Overlap]:
    """Every pair of shapes that overlap at some time, but for those of one owner, jointed, or made to pass.

    A shape is probed with points on its surface against the other's distance function, both ways round. Two boxes whose
    edges cross with no corner inside are missed: the solver's own penetration, where recorded, covers them.
    """
    if Overlap not in evidence.kept:
        part = evidence.part
        evidence.kept[Overlap] = _overlaps(evidence) if part is None else _of_part(evidence, part)
    return cast("list[Overlap]", evidence.kept[Overlap])


def _of_part(evidence: Recorded, part: Part) -> list[Overlap]:
    found, shapes = [], evidence.placed
    for pair in overlaps(part.whole):
        depth = pair.depth[part.frames]
        if depth.max() > 0.0:
            a, b = pair.rows
            found.append(Overlap(shapes[a], shapes[b], depth, pair.rows))
    return found


def _overlaps(evidence: Recorded) -> list[Overlap]:
    shapes = evidence.placed
    jointed = {frozenset((joint.parent or joint.fixture, joint.child)) for joint in evidence.world.joints}
    passes = passing(evidence.world)
    # Two can only meet if the boxes about all the places that each is ever in do.
    low, high = (np.array([shape.room[end] for shape in shapes]).reshape(-1, 3) for end in (0, 1))
    found = []
    for index, a in enumerate(shapes):
        if a.body < 0:
            break
        later = slice(index + 1, None)
        may_meet = np.all((low[index] <= high[later]) & (low[later] <= high[index]), axis=1)
        for other in index + 1 + np.flatnonzero(may_meet):
            b = shapes[other]
            if a.owner == b.owner or frozenset((a.owner, b.owner)) in jointed:
                continue
            if passes((a.owner, a.shape.prim), (b.owner, b.shape.prim)):
                continue
            depth = _depth(a, b)
            if depth is not None and depth.max() > 0.0:
                found.append(Overlap(a, b, depth, (index, int(other))))
    return found


def distance(evidence: Recorded, one: str, other: str) -> Floats:
    """The gap between two objects at each frame, (T,) [m]; not positive when they touch, inf where nothing collides."""
    if evidence.part is not None:
        return distance(evidence.part.whole, one, other)[evidence.part.frames]
    key = distance, one, other
    if key not in evidence.kept:
        evidence.kept[key] = _distance(evidence, one, other)
    return cast("Floats", evidence.kept[key])


def _distance(evidence: Recorded, one: str, other: str) -> Floats:
    shapes = evidence.placed
    near = np.ones(len(evidence.time), dtype=bool)
    gap = np.full(len(near), np.inf)
    for a in (shape for shape in shapes if shape.owner == one):
        for b in (shape for shape in shapes if shape.owner == other):
            gap = np.minimum(gap, -np.maximum(_probe(a, b, near), _probe(b, a, near)))
    return gap


def given_way(evidence: Evidence, rows: list[int]) -> Floats:
    """How deep the world's soft contacts let some bodies' surfaces in, by how fast they have just been, (T,) [m]."""
    motion, give = evidence.motion, evidence.world.give
    if give.time <= 0.0 and give.depth <= 0.0:
        return np.zeros(len(evidence.time))
    speed = np.sum([motion.surface_speed[:, row] for row in rows if row >= 0], axis=0)
    behind = max(1, math.ceil(CAUGHT * give.time / motion.dt_frames))
    padded = np.concatenate([np.full(behind, speed[0]), speed])
    recent = np.lib.stride_tricks.sliding_window_view(padded, behind + 1).max(axis=1)
    found: Floats = give.depth + give.time * recent
    return found


def _depth(a: Placed, b: Placed) -> Floats | None:
    near = np.ones(len(a.position), dtype=bool)
    if np.isfinite(b.radii).all():
        near = lengths(a.position - b.position) < a.radii + b.radii
    if not near.any():
        return None
    depth = np.full(len(near), -np.inf)
    depth[near] = np.maximum(_probe(a, b, near), _probe(b, a, near))
    return depth


def _probe(a: Placed, b: Placed, near: NDArray[np.bool_]) -> Floats:
    """How deep the points of a are in b, (n,) [m]."""
    if a.shape.kind == "plane":
        return np.full(int(near.sum()), -np.inf)
    frames = np.flatnonzero(near)
    depth = np.empty(len(frames))
    for start in range(0, len(frames), CHUNK):  # so many frames at once as the processor's cache holds
        part = frames[start : start + CHUNK]
        points, margin = a.at(part).probes()
        back = conjugate(b.rotation[part])
        local = rotate(back, a.position[part] - b.position[part])[:, :, None]
        if points.any():  # else it is the middle of a ball, however turned
            local = local + matrices(multiply(back, a.rotation[part])) @ points.swapaxes(-1, -2)
        inside = b.at(part).depth(np.moveaxis(local, 1, -1)).max(axis=1)
        depth[start : start + CHUNK] = inside + (margin[:, 0] if isinstance(margin, np.ndarray) else margin)
    return depth
