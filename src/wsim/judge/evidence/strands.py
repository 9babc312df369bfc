"""Bodies that are one thing to who looks at them: the links of a cable, and what inner parts hold together."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wsim.scene.labels import wheels

if TYPE_CHECKING:
    from wsim.scene.world import Body, Joint, World

ROUNDING = 1e-4  # of a size that a stage has in single precision, by way of a scale


def strands(world: World) -> list[list[Body]]:
    """All bodies, each by itself or as one thing with others.

    Of a cable with its other links, capsules of one radius on ball joints. A body of which nothing collides is an inner
    part, as what is between a wheel and its spring: with all that joints tie to it, it is one thing, a vehicle. So is
    what is fixed to another for good, a door with its handle, and a cart with its wheels.
    """
    of = {body.prim: [body] for body in world.bodies}
    bodies, turns = {body.prim: body for body in world.bodies}, wheels(world)
    for joint in world.joints:
        if joint.parent is None:
            continue
        one, other = of[joint.parent], of[joint.child]
        is_wheel = turns.get(joint.child) == joint.parent or turns.get(joint.parent) == joint.child
        if one is not other and (is_wheel or _together(bodies[joint.parent], bodies[joint.child], joint)):
            one += other
            of |= {body.prim: one for body in other}
    return list({id(thing): thing for thing in of.values()}.values())


def _together(one: Body, other: Body, joint: Joint) -> bool:
    """Whether both ends of a joint are one thing."""
    if any(end.shapes and not any(shape.collides for shape in end.shapes) for end in (one, other)):
        return True
    if joint.kind == "fixed" and not joint.closing:
        return True
    return joint.kind == "spherical" and _alike(_radius(one), _radius(other))


def _radius(body: Body) -> float | None:
    """Of a link [m]; None of what is none."""
    alone = body.shapes[0] if len(body.shapes) == 1 else None
    return alone.size[0] if alone is not None and alone.kind == "capsule" else None


def _alike(one: float | None, other: float | None) -> bool:
    return one is not None and other is not None and math.isclose(one, other, rel_tol=ROUNDING)
