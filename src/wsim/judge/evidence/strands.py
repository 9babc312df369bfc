"""Bodies that are one thing to who looks at them: the links of a cable."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from wsim.scene.world import Body, World

ROUNDING = 1e-4  # of a size that a stage has in single precision, by way of a scale


def strands(world: World) -> list[list[Body]]:
    """All bodies, each by itself or, of a cable, with its other links: capsules of one radius on ball joints."""
    of = {body.prim: [body] for body in world.bodies}
    for joint in world.joints:
        if joint.kind != "spherical" or joint.parent is None:
            continue
        one, other = of[joint.parent], of[joint.child]
        if one is not other and _alike(_radius(one[0]), _radius(other[0])):
            one += other
            of |= {body.prim: one for body in other}
    return list({id(thing): thing for thing in of.values()}.values())


def _radius(body: Body) -> float | None:
    """Of a link [m]; None of what is none."""
    alone = body.shapes[0] if len(body.shapes) == 1 else None
    return alone.size[0] if alone is not None and alone.kind == "capsule" else None


def _alike(one: float | None, other: float | None) -> bool:
    return one is not None and other is not None and math.isclose(one, other, rel_tol=ROUNDING)
