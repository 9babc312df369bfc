"""How long a step the links of a loaded chain can take.

A link on two ball joints is turned back into line by the pull T along it: its fastest swing is that in which each link
turns against the next, omega² = T l / I, l the way between its joints and I its inertia across (about its middle). That
pull is a stiffness of which no step knows beforehand: steps of the first order shake where omega h is above 2, those of
the fourth above 2.8. On a post of radius R, where links bend by l / R each, a link is pressed by T l / R, and one that
is turned by t rolls until it is pressed R t farther along. That turns it back by T l t once more: omega² = 2 T l / I.
"""

from __future__ import annotations

import math
from collections import defaultdict

import numpy as np

from wsim.errors import UserError
from wsim.limits import MIN_TIME_STEP
from wsim.scene.world import Body, Joint, World

SHARE = 1.0  # of 1 / omega under what hangs at rest: what swings pulls up to three times as much, and 2 / sqrt(3) > 1


def cable_limits(world: World) -> dict[str, float]:
    """How long a step each link of a chain that hangs can take [s], by the weight of what hangs on it.

    Of links between ball joints, where one side or neither is held: what lies over a post with a weight at either end
    is pulled by the heavier one at most, and turned back by the post as well. The pull in what is held on both sides is
    not known.

    Raises:
        UserError: If so much hangs on a link that no step of `MIN_TIME_STEP` or more can follow it.
    """
    bodies = {body.prim: body for body in world.bodies}
    held: dict[str, list[Joint]] = defaultdict(list)
    for joint in world.joints:
        for prim in (joint.parent, joint.child):
            if prim in bodies:
                held[prim].append(joint)
    g = float(np.linalg.norm(world.gravity))
    limits = {}
    for body in world.bodies:
        ends = held[body.prim]
        if body.kinematic or len(ends) != 2 or any(joint.kind != "spherical" for joint in ends):
            continue
        sides = [_beyond(_other(joint, body.prim), body.prim, held, bodies) for joint in ends]
        hanging = [mass for mass in sides if mass is not None]
        if not hanging:
            continue
        stiffness = _length(body, ends) * g * (max(hanging) + body.mass) * len(hanging)
        if stiffness <= 0.0:
            continue
        step = SHARE * math.sqrt(_across(body, ends) / stiffness)
        if step < MIN_TIME_STEP:
            most = max(hanging) * (step / MIN_TIME_STEP) ** 2
            raise UserError(
                f"{body.prim}: {max(hanging):.4g} kg on a link of {body.mass:.2g} kg would need a time step of "
                f"{step:.1e} s; hang at most {most:.2g} kg on it, give it more mass_per_length or fewer links, "
                "or use a rope"
            )
        limits[f"the pull on {body.prim}"] = step
    return limits


def _other(joint: Joint, prim: str) -> str | None:
    return joint.parent if joint.child == prim else joint.child


def _beyond(start: str | None, link: str, held: dict[str, list[Joint]], bodies: dict[str, Body]) -> float | None:
    """Mass of what hangs together beyond a link [kg]; None where something holds it."""
    found: set[str] = {link}
    total, ahead = 0.0, [start]
    while ahead:
        prim = ahead.pop()
        if prim in found:
            continue
        body = bodies.get(prim or "")
        if body is None or body.kinematic:
            return None
        found.add(body.prim)
        total += body.mass
        ahead += [_other(joint, body.prim) for joint in held[body.prim]]
    return total


def _anchors(body: Body, ends: list[Joint]) -> list[np.ndarray]:
    own = [joint.child_anchor if joint.child == body.prim else joint.parent_anchor for joint in ends]
    return [np.array(anchor or body.com) for anchor in own]


def _length(body: Body, ends: list[Joint]) -> float:
    one, two = _anchors(body, ends)
    return float(np.linalg.norm(two - one))


def _across(body: Body, ends: list[Joint]) -> float:
    """The least inertia that turns a link across the way between its joints, about its middle [kg m²]."""
    one, two = _anchors(body, ends)
    along = (two - one) / max(float(np.linalg.norm(two - one)), 1e-12)
    axes = np.linalg.svd(along[None])[2][1:]
    return float(np.linalg.eigvalsh(axes @ np.array(body.inertia).reshape(3, 3) @ axes.T)[0])
