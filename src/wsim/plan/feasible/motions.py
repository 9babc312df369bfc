"""Motions that are asked of what cannot move: at all, beyond its joint's limits, or so early."""

from __future__ import annotations

from collections.abc import Iterator
from math import inf
from typing import TYPE_CHECKING

from wsim.plan.feasible.asked import Said, said
from wsim.plan.schema.schedule_problems import earliest

if TYPE_CHECKING:
    from wsim.plan.schema import Joint, Plan, PlanObject, SchedulePlan

_OF_MOTION = """moves topples slides rolls_down rolls rolls_freely swings flies falls_freely tilts tilts_to floats sinks
crosses drops climbs_to goes_down dies_down bounces_to follows_path"""
_OF_RANGES = "gone_between turned_between spin_between own_spin_between tilt_between speed_between"
_MOVES = frozenset(_OF_MOTION.split())  # of what does not move none is true
_RANGES = frozenset(_OF_RANGES.split())  # nor are these, where nought is outside
_MEETS = frozenset(("collides_with", "pushes"))  # of two of which one moves
_SLACK = {"hinge": 1.0, "slider": 1e-3}  # [deg], [m]: what a hard stop gives
_WAY = "widen the joint's limits, or ask for what they allow"
_TOPPLED = 45.0  # [deg]: as "topples" has it
_LEANS = {("X", "y"): -1.0, ("Y", "x"): 1.0}  # how a turn about an axis leans what points up towards another


def motion_faults(plan: Plan) -> Iterator[str]:
    """All of them."""
    items = {item.name: item for item in plan.objects}
    still = {name: why for name, item in items.items() if (why := _still(plan, item, items))}
    waits = {name: found for name in items if (found := _waits(plan, items[name])) is not None}
    held = {joint.child: joint for joint in plan.joints if _is_held(joint, items)}
    for each in (one for one in said(plan) if not one.denied and not one.optional):
        name = each.object or ""
        if name in still and _asks_to_move(each, still):
            yield f"{each.where}: {each.name} of {name}, which {still[name]}"
        elif name in waits and _asks_to_move(each, still) and each.end <= waits[name][0]:
            begins, why = waits[name]
            yield (
                f"{each.where}: {each.name} of {name} by {each.end:g} s, which does not move before {begins:g} s "
                f"({why}); let the window reach further, or the schedule begin before"
            )
        if name in held:
            yield from _beyond(each, held[name])


def _asks_to_move(each: Said, still: dict[str, str]) -> bool:
    """Whether what is said of an object is not true where it does not move."""
    if each.name in _MEETS:
        return each.ref in still
    if each.name in _RANGES and each.fields.get("of") in (None, *still):
        return not each.fields["low"] <= 0.0 <= each.fields["high"]
    return each.name in _MOVES


def _still(plan: Plan, item: PlanObject, items: dict[str, PlanObject]) -> str:
    """Why an object never moves, and the way out; empty where it may."""
    if item.state == "static":
        return 'is static and never moves; make it "dynamic"'
    if item.state == "kinematic" and not _sets_out(item) and not _is_moved(plan, item):
        return "is kinematic and has no velocity and no schedule: it never moves; give it one"
    for joint in plan.joints:
        holder = items.get(joint.parent or "")
        fixed = joint.kind == "fixed" and joint.child == item.name and (holder is None or holder.state == "static")
        if fixed and not any(each.of == joint.name for each in plan.schedules):
            return f"{joint.name} holds to what stands still: it never moves; schedule its release, or leave it out"
    return ""


def _sets_out(item: PlanObject) -> bool:
    return any(item.velocity) or any(item.angular_velocity_deg or ())


def _is_moved(plan: Plan, item: PlanObject) -> bool:
    """Whether anything but a velocity of its own may move what is kinematic."""
    tied = any(item.name in (joint.child, joint.parent) for joint in plan.joints)
    steered = bool(item.registration.actuation) or any(step.asks_for_control for step in plan.steps)
    return tied or steered or item.assembled or any(each.of == item.name for each in plan.schedules)


def _waits(plan: Plan, item: PlanObject) -> tuple[float, str] | None:
    """When what is kinematic sets out by its schedules at the earliest, and by which; None where that is at once."""
    own = [each for each in plan.schedules if each.of == item.name]
    steered = bool(item.registration.actuation) or any(step.asks_for_control for step in plan.steps)
    if item.state != "kinematic" or not own or steered or _sets_out(item):
        return None
    begins, first = min(((_begins(plan, each), each) for each in own), key=lambda pair: pair[0])
    return (begins, f"schedule {first.name}") if begins > 0.0 else None


def _begins(plan: Plan, each: SchedulePlan) -> float:
    """The earliest time at which a schedule gives more than nought [s]; infinite where it never does."""
    acts = [any(value) if isinstance(value, tuple) else bool(value) for value in each.values]
    if not any(acts):
        return inf
    first = acts.index(True)
    key = each.times[max(first - 1, 0) if each.linear else first]
    return earliest(plan, each) + key


def _is_held(joint: Joint, items: dict[str, PlanObject]) -> bool:
    """Whether a joint with limits ties its child to what stands still."""
    holder = items.get(joint.parent or "")
    return joint.limits is not None and joint.kind in _SLACK and (holder is None or holder.state == "static")


def _beyond(each: Said, joint: Joint) -> Iterator[str]:
    """A range that a joint's limits shut out."""
    assert joint.limits is not None
    low, high = joint.limits
    wanted = {"hinge": "turned_between", "slider": "gone_between"}[joint.kind]
    axis, unit, slack = str(each.fields.get("axis", "")), "deg" if joint.kind == "hinge" else "m", _SLACK[joint.kind]
    if each.name == "topples" and joint.kind == "hinge" and joint.axis != "Z" and max(-low, high) < _TOPPLED:
        yield f"{each.where}: topples of {each.object}, which {joint.name} lets turn by {low:g} to {high:g} deg; {_WAY}"
    sign = 0.0
    if each.name == wanted and axis == joint.axis.lower() and each.fields.get("of") in (None, joint.parent):
        sign = 1.0
    elif each.name == "tilt_between" and joint.kind == "hinge":
        sign = _LEANS.get((joint.axis, axis), 0.0)
    if not sign:
        return
    own = sorted(sign * limit + 0.0 for limit in (low, high))
    if each.fields["high"] < own[0] - slack or each.fields["low"] > own[1] + slack:
        asked = f"{each.name} {axis} {each.fields['low']:g} to {each.fields['high']:g} {unit}"
        yield f"{each.where}: {asked} of {each.object}, and {joint.name}'s limits are {own[0]:g} to {own[1]:g}; {_WAY}"
