"""How far fluid may fall in a world."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from wsim.geometry.rotations import conjugate, rotate
from wsim.geometry.shapes import reach, top_under
from wsim.scene.world import Body, Fluid, Shape, World
from wsim.sim.vessels import way_of

Array = np.ndarray
AS_IS = np.array([[0.0, 0.0, 0.0, 1.0]])


def over_all(fluid: Fluid, world: World) -> float:
    """How high the top of a fluid is above the lowest point of what stands still, and above planes [m].

    Minus infinity where nothing stands: what falls meets nothing.
    """
    still = _still(world)
    planes = [shape.position[2] for shape in still if shape.kind == "plane"]
    lows = planes or [float(reach(shape, AS_IS)[0][0]) for shape in still]
    return _top(fluid) - min(lows, default=math.inf)


def poured(fluid: Fluid, world: World) -> float:
    """How far the fluid in a vessel that moves may fall out of it [m]; 0 where it stays in.

    Out of one that is led and tilted so that its surface gets to the rim, or that hangs on a joint, it falls to the
    lowest that there is; out of one that nobody holds, to what is under it. One that is led upright keeps it.
    """
    body = next((body for body in world.bodies if body.prim == fluid.container and fluid.volume is not None), None)
    if body is None:
        return 0.0
    if body.path is not None:
        place, turned = way_of(body)[1:]
        rise = float(place[:, 2].max()) - body.position[2]
        return max(over_all(fluid, world) + rise, 0.0) if _spills(fluid, body, turned) else 0.0
    if body.kinematic:
        return 0.0
    if any(body.prim in (joint.child, joint.parent) for joint in world.joints):
        return max(over_all(fluid, world), 0.0)
    under = np.array([[*fluid.center[:2], 0.0]])
    tops = [float(top_under(shape, under)[0]) for shape in _still(world)]
    found = [top for top in tops if top < fluid.center[2]]
    return _top(fluid) - max(found) if found else max(over_all(fluid, world), 0.0)


def _spills(fluid: Fluid, body: Body, turned: Array) -> bool:
    """Whether a surface that stays level gets to the rim of a body that is turned so, (T, 4)."""
    walls: Sequence[Shape] = [shape for shape in body.shapes if shape.collides]
    rim = body.position[2] + max(float(reach(shape, np.array([body.rotation]))[1][0]) for shape in walls)
    upright = rotate(turned, rotate(conjugate(np.array(body.rotation)), np.array([0.0, 0.0, 1.0])))[:, 2]
    return bool((upright < math.cos(math.atan2(rim - _top(fluid), 0.5 * max(fluid.size[:2])))).any())


def _still(world: World) -> list[Shape]:
    return [shape for static in world.statics for shape in static.shapes if shape.collides]


def _top(fluid: Fluid) -> float:
    return fluid.center[2] + 0.5 * fluid.size[2]
