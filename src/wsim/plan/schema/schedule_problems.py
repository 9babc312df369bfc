"""What makes schedules of a plan impossible: of nothing, twice, out of range, or never."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from wsim import quantities
from wsim.plan.schema.schedules import EventPlan, Pair, SchedulePlan
from wsim.quantities import Quantity, What

if TYPE_CHECKING:
    from wsim.plan.schema.draft import Draft, Joint
    from wsim.plan.schema.objects import PlanObject

_MADE = ("fluid", "robot", "vehicle", "scatter")  # of primitives: nothing that one quantity is of


def schedule_problems(plan: Draft) -> Iterator[str]:
    """What of a plan's schedules is of nothing, twice, out of range, or never."""
    seen: dict[tuple[object, str], int] = {}
    for i, each in enumerate(plan.schedules):
        where = f"schedules.{i}"
        found = _quantity(plan, where, each)
        if isinstance(found, str):
            yield found
            continue
        quantity, joint = found
        yield from _joint_problems(where, each, joint)
        yield from _values(where, each, quantity, joint)
        key = frozenset(each.of) if isinstance(each.of, tuple) else each.of, each.quantity
        if key in seen:
            yield f"{where}: schedules.{seen[key]} is of the same {each.quantity}; put all keys into one"
        seen.setdefault(key, i)
        wrong = [] if each.after is None else [f"after.{problem}" for problem in _event(plan, i, each.after)]
        yield from (f"{where}.{problem}" for problem in wrong or _beyond_the_end(plan, each))


def _beyond_the_end(plan: Draft, each: SchedulePlan) -> Iterator[str]:
    clock, end = earliest(plan, each), plan.simulation.duration
    if (said := quantities.beyond_the_end(clock, each.times[-1], end)) is not None:
        yield f"{'after.delay' if clock > end else 'times'}: {said}"


def earliest(plan: Draft, each: SchedulePlan) -> float:
    """The first moment at which a schedule's clock may begin [s]."""
    if each.after is None:
        return 0.0
    names = [one.name for one in plan.schedules]
    before = each.after.start or each.after.end
    came = 0.0
    if before in names[: names.index(each.name)]:
        other = plan.schedules[names.index(before)]
        came = earliest(plan, other) + other.times[0 if each.after.start else -1]
    return came + (each.after.delay or 0.0)


def _quantity(plan: Draft, where: str, each: SchedulePlan) -> tuple[Quantity, Joint | None] | str:
    """The quantity that a schedule is of, with its joint, or what is wrong with that."""
    joints = {joint.name: joint for joint in plan.joints}
    items = {item.name: item for item in plan.objects}
    if isinstance(each.of, tuple):
        pair = next((pair for pair in plan.contacts if {pair.object, pair.ref} == set(each.of)), None)
        if pair is None or pair.friction is None:
            return (
                f"{where}.of: {each.of[0]} and {each.of[1]} have no friction of their own; add a contact that states it"
            )
    elif each.of not in joints and each.of not in items:
        known = ", ".join([*joints, *(item.name for item in plan.objects)][:12])
        robots = "; a robot's own joints go by its actuation" if any(_is_robot(item) for item in plan.objects) else ""
        return f"{where}.of: no joint and no object {each.of!r}; the plan has {known}{robots}"
    kind = _kind(each.of, joints, items)
    if kind is None and _is_robot(items[str(each.of)]):
        return (
            f"{where}.of: {each.of} is a robot, whose joints go by its registration.actuation: "
            '{"kind": "schedule", "joint": ..., "times": [s], "target": [deg or m]}'
        )
    if kind is None:
        return f"{where}.of: {each.of} is a {items[str(each.of)].primitive}, of which no schedule is; name a solid"
    found = quantities.OF[kind].get(each.quantity)
    if found is None:
        said = each.of if isinstance(each.of, str) else " and ".join(each.of)
        return (
            f"{where}.quantity: {said} is a {quantities.CALLED[kind]}, which has {quantities.said(kind)}; this is "
            f"{each.quantity!r}"
        )
    return found, joints.get(str(each.of))


def _is_robot(item: PlanObject) -> bool:
    return item.primitive == "robot"


def _kind(of: str | Pair, joints: dict[str, Joint], items: dict[str, PlanObject]) -> What | None:
    if isinstance(of, tuple):
        return "pair"
    if of in joints:
        return "joint"
    item = items[of]
    if item.primitive in _MADE:
        return None
    return {"static": "solid", "kinematic": "kinematic"}.get(item.state, "body")  # type: ignore[return-value]


def _joint_problems(where: str, each: SchedulePlan, joint: Joint | None) -> Iterator[str]:
    if joint is None:
        return
    if each.quantity == "release":
        held = joint.kind == "slider" or joint.limits is not None or joint.drive is not None
        if held:
            yield (
                f"{where}: {joint.name} slides, or has limits or a drive, and cannot let go; hold the body by a fixed "
                "joint to what has them, and release that"
            )
        return
    if joint.kind not in ("hinge", "slider"):
        yield f"{where}.quantity: {joint.name} is a {joint.kind} joint, which has no {each.quantity}"
        return
    gain = {"position": "stiffness", "velocity": "damping"}.get(each.quantity)
    if gain is not None and (joint.drive is None or not getattr(joint.drive, gain) > 0.0):
        yield f"{where}: the {each.quantity} is what {joint.name}'s drive aims at; give it a drive with a {gain}"


def _values(where: str, each: SchedulePlan, quantity: Quantity, joint: Joint | None) -> Iterator[str]:
    unit = quantity.turning if joint is not None and joint.kind == "hinge" else quantity.unit
    for k, value in enumerate(each.values):
        numbers = value if isinstance(value, tuple) else (value,)
        if len(numbers) != quantity.count:
            yield f"{where}.values.{k}: a {each.quantity} is {'[x, y, z]' if quantity.count > 1 else 'one number'}"
        elif not all(quantity.low <= number <= quantity.most for number in numbers):
            yield f"{where}.values.{k}: must be from {quantity.low:g} to {quantity.most:g} {unit}".rstrip()


def _event(plan: Draft, i: int, event: EventPlan) -> Iterator[str]:
    items = {item.name: item for item in plan.objects}
    joints = {joint.name: joint for joint in plan.joints}
    kind = event.kind
    if kind in ("start", "end"):
        name, before = getattr(event, kind), [each.name for each in plan.schedules[:i]]
        if name not in before:
            yield f"{kind}: no schedule {name!r} stands before this one; those are {', '.join(before) or 'none'}"
    elif kind == "joint":
        if event.joint not in joints or joints[event.joint].kind not in ("hinge", "slider"):
            known = [name for name, joint in joints.items() if joint.kind in ("hinge", "slider")]
            yield f"joint: no hinge or slider {event.joint!r}; the plan has {', '.join(known) or 'none'}"
    elif kind == "body":
        if event.body not in items or items[event.body].state not in ("dynamic", "kinematic"):
            yield f"body: {event.body!r} is nothing of the plan that moves"
    elif event.touch is not None:
        unknown = [name for name in event.touch if name not in items]
        if unknown:
            yield f"touch: no object {unknown[0]!r}"
        elif event.touch[0] == event.touch[1] or not any(items[name].state == "dynamic" for name in event.touch):
            yield f"touch: {event.touch[0]} and {event.touch[1]} never meet; name two objects of which one is dynamic"
        elif any({joint.child, joint.parent} == set(event.touch) for joint in plan.joints):
            yield f"touch: {event.touch[0]} and {event.touch[1]} never touch: a joint ties them"
