"""What carries a body: the top of it, how far the body is off that, and which way it slopes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import conjugate, level, rotate, sides_of
from wsim.geometry.shapes import top_under
from wsim.judge.evidence.contact import distance
from wsim.judge.evidence.faces import normal_under
from wsim.judge.evidence.recorded import MissingError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.scene.world import Fluid, Static

    Floats = NDArray[np.float64]

DOWNHILL_LEAST = 0.01  # of a unit: a slope below this has no direction


@dataclass
class Support:
    """What a body is to rest on."""

    top: Floats  # its height at each frame, (T,) [m]
    over: NDArray[np.bool_]  # whether the body's centre is over it, (T,)
    fluid: Fluid | None = None  # the fluid that stands on it
    name: str = ""


def support_of(evidence: Evidence, i: int, prim: str) -> Support:
    """The top of a container's floor, a static object or another body, under body i; MissingError."""
    frames = len(evidence.time)
    where = evidence.body_q[:, i, :3]
    container = evidence.container(prim)
    if container is not None:
        p = evidence.local(container, where)
        half = np.array(container.inner_size) / 2
        over = (np.abs(p[:, 0]) <= half[0]) & (np.abs(p[:, 1]) <= half[1])
        fluid = next((f for f in evidence.world.fluids if f.container == prim), None)
        floor = np.array(container.inner_center) - rotate(np.array(container.rotation), np.array([0.0, 0.0, half[2]]))
        return Support(np.full(frames, floor @ evidence.up), over, fluid, "the inner floor of " + prim)
    static = evidence.static(prim)
    if static is not None:
        return _on_static(static, where, evidence.ends(i)[1], evidence.up)
    j = evidence.index(prim)
    top = evidence.ends(j)[1]
    low, high = _footprint(evidence, j)
    at = where @ sides_of(evidence.up).T
    over = np.all((at >= low) & (at <= high), axis=1)
    return Support(top, over, None, prim)


def height_over(evidence: Evidence, i: int, prim: str, support: Support) -> Floats:
    """How far body i is off what carries it (T,) [m]: the gap of their surfaces, where it is above it.

    Seen from the support, which may tilt or be a slope: the height of the body's lowest point over it says nothing of
    that. In a container it is the height over the floor, for the walls may be near; where it is under the support it is
    the difference of their heights. Over a static mesh, of which the corners alone are probed, it is what is less.
    """
    heights = evidence.ends(i)[0] - support.top
    if evidence.container(prim) is not None:
        return heights
    gap = distance(evidence, evidence.world.bodies[i].prim, prim)
    static = evidence.static(prim)
    if static is not None:
        if any(shape.kind == "mesh" for shape in static.shapes):
            gap = np.where(np.abs(heights) < np.abs(gap), heights, gap)
        above = evidence.body_q[:, i, :3] @ evidence.up > support.top
    else:
        j = evidence.index(prim)
        own = rotate(conjugate(evidence.body_q[:1, j, 3:]), evidence.up[None])  # what pointed up at the start
        apart = evidence.body_q[:, i, :3] - evidence.body_q[:, j, :3]
        above = np.sum(apart * rotate(evidence.body_q[:, j, 3:], np.broadcast_to(own, apart.shape)), axis=1) > 0.0
    return np.where(above & np.isfinite(gap), gap, heights)


def _on_static(static: Static, where: Floats, high: Floats, up: Floats) -> Support:
    """The highest that a static object's shapes reach at each position.

    But for those that end above the body, for a shelf has boards; where all of them do, it is the highest.
    """
    shapes = [shape for shape in static.shapes if shape.collides] or static.shapes
    tops = np.stack([np.full(len(where), -np.inf), *(top_under(shape, where, up) for shape in shapes)])
    below = np.max(np.where(tops <= high, tops, -np.inf), axis=0)
    top = np.where(np.isfinite(below), below, np.max(tops, axis=0))
    return Support(top, np.isfinite(top), None, static.prim)


def _footprint(evidence: Evidence, j: int) -> tuple[Floats, Floats]:
    """The bounding rectangle of a body seen from above, at each frame, (T, 2) each."""
    q = evidence.body_q[:, j]
    lows, highs = [], []
    for surface in evidence.solid(j).surfaces:
        points = (rotate(q[:, None, 3:], surface.vertices[None]) + q[:, None, :3]) @ sides_of(evidence.up).T
        lows.append(points.min(axis=1))
        highs.append(points.max(axis=1))
    return np.min(lows, axis=0), np.max(highs, axis=0)


def downhill(evidence: Evidence, prim: str, i: int) -> Floats:
    """The unit vector (3,) down the slope of the static object's face that body i is over; MissingError without one."""
    static = evidence.static(prim)
    if static is None or not static.shapes:
        raise MissingError(f"the world has no static object {prim} to go down")
    slope = level(-evidence.up, normal_under(static.shapes, evidence.body_q[:, i, :3], evidence.up))
    steepness = float(np.linalg.norm(slope))
    if steepness < DOWNHILL_LEAST:
        raise MissingError(f"{prim} is level: nothing goes down it")
    return np.asarray(slope / steepness, dtype=np.float64)
