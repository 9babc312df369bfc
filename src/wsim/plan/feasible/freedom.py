"""What a joint to what stands still leaves free, or a kinematic body's velocity: other motions cannot be asked."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from wsim.plan.feasible.asked import Said, said
from wsim.plan.layout.boxes import rotation

if TYPE_CHECKING:
    from wsim.plan.schema import Joint, Plan, PlanObject

_IN_THE_AIR = ("flies", "falls_freely")
_TURNS = ("turned_between", "spin_between")
_OVER = ("topples", "tilts", "tilts_to")
_ROOM = 0.02  # [m]: what an anchor's place and a joint's give leave open


def freedom_faults(plan: Plan) -> Iterator[str]:
    """All of them."""
    items = {item.name: item for item in plan.objects}
    held = {joint.child: joint for joint in plan.joints if holds(plan, joint)}
    for each in said(plan):
        joint, item = held.get(each.object or ""), items.get(each.object or "")
        if item is None or each.optional:
            continue
        if joint is not None and (why := _asks_more(each, joint, item)):
            yield f"{each.where}: {each.name} of {each.object}, and {joint.name} {why}; ask for what it lets it do"
        if joint is None and _coasts(plan, item) and (why := _goes_elsewhere(each, item, plan.simulation.duration)):
            yield f"{each.where}: {each.name} of {each.object}, which {why}; give it another velocity, or a schedule"


def holds(plan: Plan, joint: Joint) -> bool:
    """Whether a hinge or a slider ties its child to what stands still, for good."""
    parent = next((item for item in plan.objects if item.name == joint.parent), None)
    stands = parent is None or parent.state == "static"
    kept = not any(each.of == joint.name and each.quantity == "release" for each in plan.schedules)
    alone = sum(joint.child in (one.child, one.parent) for one in plan.joints if one.kind != "fixed") == 1
    return joint.kind in ("hinge", "slider") and stands and kept and alone


def _coasts(plan: Plan, item: PlanObject) -> bool:
    """Whether nothing but its stated velocity moves what is kinematic."""
    tied = any(item.name in (joint.child, joint.parent) for joint in plan.joints)
    steered = bool(item.registration.actuation) or any(step.asks_for_control for step in plan.steps)
    scheduled = any(each.of == item.name for each in plan.schedules)
    return item.state == "kinematic" and any(item.velocity) and not (tied or steered or scheduled or item.assembled)


def _goes_elsewhere(each: Said, item: PlanObject, duration: float) -> str:
    """Where a velocity takes a body, if that is not what is asked; empty where it may be."""
    gone = [duration * speed for speed in item.velocity]
    told = ", ".join(f"{way:.3g}" for way in gone)
    if each.denied or each.name not in ("moves", "drops"):
        return ""
    if each.name == "drops":
        return "" if gone[2] < 0.0 else f"goes ({told}) m by its velocity and no lower"
    way = {"front": gone[0], "back": -gone[0], "left": gone[1], "right": -gone[1]}
    far = way.get(each.fields.get("direction") or "", math.hypot(*gone[:2]))
    return "" if far > 0.0 and far >= (each.fields.get("least") or 0.0) - _ROOM else f"goes ({told}) m by its velocity"


def _asks_more(each: Said, joint: Joint, item: PlanObject) -> str:
    """What the joint does that shuts out what is asked; empty where it does not."""
    along = joint.axis.lower()
    if each.name in _IN_THE_AIR and not each.denied:
        return "holds it all the time: it never flies"
    if joint.kind == "slider" and (each.name in _OVER or (each.name == "upright" and each.denied)):
        return "lets it turn about nothing"
    if each.denied:
        return ""
    axis, away = str(each.fields.get("axis", "")), each.fields.get("of") is None and _is_off_nought(each)
    if each.name in _TURNS and away and (joint.kind == "slider" or axis != along):
        return "lets it turn about nothing" if joint.kind == "slider" else f"lets it turn about {along} alone"
    if each.name == "drops" and (along != "z") == (joint.kind == "slider"):
        return "keeps it at its height"
    if each.name == "gone_between" and away and (axis != along if joint.kind == "slider" else axis == along):
        return f"lets it move along {along} alone" if joint.kind == "slider" else f"keeps it where it is along {along}"
    return _too_far(each, joint, item) if joint.kind == "hinge" else ""


def _is_off_nought(each: Said) -> bool:
    low, high = each.fields.get("low"), each.fields.get("high")
    return low is not None and high is not None and not low <= 0.0 <= high


def _too_far(each: Said, joint: Joint, item: PlanObject) -> str:
    """What is further away than a body on a hinge comes: twice its distance from the axis."""
    anchor = joint.anchor or (0.0, 0.0, 0.0)
    if item.pose is None:
        return ""
    turn = rotation(item.pose.rotation_deg)
    off = [sum(turn[i][k] * anchor[k] for k in range(3)) for i in range(3)]
    arm = math.hypot(*(off[i] for i in range(3) if "XYZ"[i] != joint.axis))
    wanted = each.fields.get("least") if each.name == "moves" else None
    if each.name == "gone_between" and _is_off_nought(each) and each.fields.get("of") is None:
        wanted = min(abs(each.fields["low"]), abs(each.fields["high"]))
    if wanted is None or wanted <= 2.0 * arm + _ROOM:
        return ""
    return f"holds its centre {arm:.3g} m off the axis: it comes no further than {2.0 * arm:.3g} m"
