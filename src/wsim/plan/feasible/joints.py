"""Joints: an anchor that holds neither body, a tilt that a hinge does not allow, and a weight that it bears."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from wsim.plan.feasible.asked import said
from wsim.plan.feasible.freedom import holds
from wsim.plan.layout.bodies import convex
from wsim.plan.layout.boxes import Solid, rotation

if TYPE_CHECKING:
    from wsim.plan.schema import Joint, Plan, PlanObject, Vec3

FAR = 0.05  # [m]: a gap that a hinge's leaves or an axle's hub bridge
SHARE = 0.25  # of the larger body's half extent, likewise
_TILTS = ("topples", "tilts", "tilts_to", "upright", "tilt_between")
AXES: dict[str, Vec3] = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


def joint_faults(plan: Plan) -> Iterator[str]:
    """All of them."""
    items = {item.name: item for item in plan.objects}
    for number, joint in enumerate(plan.joints):
        child, parent = items.get(joint.child), items.get(joint.parent or "")
        if child is not None and parent is not None:
            yield from _off(number, joint, child, parent)
    upright = {
        joint.child: joint
        for joint in plan.joints
        if joint.axis == "Z" and joint.kind == "hinge" and holds(plan, joint)
    }
    held = {joint.child: joint for joint in plan.joints if _bears(joint, items)}
    for each in said(plan):
        if each.name == "weighs_on" and not each.denied and each.object in held:
            yield (
                f"{each.where}: weighs_on({each.object}, {each.ref}), and {held[each.object].name} bears a part of its "
                f"weight; ask lies_on({each.object}, {each.ref})"
            )
        if each.name in _TILTS and each.object in upright:
            joint = upright[each.object]
            yield (
                f"{each.where}: {each.name} of {each.object}, which {joint.name} lets turn about the vertical alone: "
                f"it never tilts; ask turned_between({each.object}, z, low, high) of it"
            )


def _bears(joint: Joint, items: dict[str, PlanObject]) -> bool:
    """Whether what stands still holds a body by its joint, in the way of its weight, for good."""
    holder = items.get(joint.parent or "")
    stands = holder is None or holder.state == "static"
    return stands and joint.kind in ("hinge", "ball")


def _off(number: int, joint: Joint, child: PlanObject, parent: PlanObject) -> Iterator[str]:
    """An anchor in the air: a hinge there turns bodies about nothing that either of them reaches."""
    if joint.kind not in ("hinge", "ball") or child.pose is None or parent.pose is None:
        return
    place = _anchor(joint, child)
    solids = [*_solids(child), *_solids(parent)]
    if not _solids(child) or not _solids(parent):
        return
    room = FAR + SHARE * max(max(solid.half) for solid in solids)
    gaps = {item.name: min(_outside(solid, place) for solid in _solids(item)) for item in (child, parent)}
    if min(gaps.values()) > room:
        at = ", ".join(f"{x:.3g}" for x in place)
        told = " and ".join(f"{gap:.2g} m off {name}" for name, gap in gaps.items())
        yield (
            f"joints.{number}.anchor: it is at ({at}), {told}; a {joint.kind} is on one of the two: give the anchor "
            f"from the centre of {child.name}, before it is turned, or put a body there"
        )


def _anchor(joint: Joint, child: PlanObject) -> Vec3:
    """Where the anchor is in the world [m]."""
    assert child.pose is not None
    turn, own = rotation(child.pose.rotation_deg), joint.anchor or (0.0, 0.0, 0.0)
    x, y, z = (
        child.pose.position[i] + sum(turn[i][k] * own[k] for k in range(3)) for i in range(3)
    )  # fmt: skip
    return x, y, z


def _solids(item: PlanObject) -> list[Solid]:
    """The convex parts of a body; none of what only the catalogue knows."""
    return convex(item) if item.primitive in ("box", "sphere", "cylinder", "capsule", "tank") else []


def _outside(solid: Solid, place: Vec3) -> float:
    """How far a point is outside the box round a solid, in the solid's own axes [m]."""
    off = [place[i] - solid.center[i] for i in range(3)]
    own = [sum(solid.axes[i][k] * off[i] for i in range(3)) for k in range(3)]
    return math.hypot(*(max(0.0, abs(along) - half) for along, half in zip(own, solid.half, strict=True)))
