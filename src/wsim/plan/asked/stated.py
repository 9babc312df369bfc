"""Whether a property of the plan has the value that the prompt states."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from wsim.plan.asked.nodes import nodes
from wsim.plan.layout.boxes import rotation
from wsim.plan.schema.clause import OF_CORDS, WHOLE
from wsim.plan.schema.formula import Always, Mean, Predicate

if TYPE_CHECKING:
    from wsim.plan.asked.demands import Demand
    from wsim.plan.schema import Joint, Objective, OpeningPlan, Plan, PlanObject
    from wsim.plan.schema.nodes import Node
    from wsim.plan.schema.schedules import SchedulePlan

ROUNDING = 0.05  # share: "about half a metre" is planned as 0.48 m
WIDE = 2.5  # times a number, and a part of it: a range that reaches further asks for something else
FIELDS = {  # by unit: where a number of it may stand in an object or a joint that is named without a property
    "m": ("size", "limits", "anchor", "length"), "kg": ("mass",), "kg/m^3": ("density",),
    "m/s": ("velocity", "surface_velocity", "drive", "actuation"),
    "m^3": ("volume",), "m^3/s": ("rate",),
    "deg/s": ("spin", "drive"), "deg": ("limits", "drive", "direction"), "N": ("drive",), "s": ("duration",),
}  # fmt: skip
OF_UNIT = {  # what can be of no other
    "size": "m", "length": "m", "mass": "kg", "density": "kg/m^3", "velocity": "m/s", "surface_velocity": "m/s",
    "spin": "deg/s", "duration": "s", "volume": "m^3",
}  # fmt: skip
OPEN = ("place", "level", "actuation")  # a stated distance may be the difference of two places, or one of many
_POINTS = ("target", "center", "path", "at")  # of formulas: places in the world


def states(plan: Plan, name: str, field: str, demand: Demand) -> bool:
    """Whether a property has a number; without one, any that may. Places are differences, and are not compared."""
    if field in OPEN:
        return True
    if name in {each.name for each in plan.schedules}:
        field = field or ("times" if demand.unit == "s" else "values")
    if demand.unit and OF_UNIT.get(field, demand.unit) != demand.unit:
        return False
    fields = (field,) if field else FIELDS.get(demand.unit, ())
    return any(close(value, demand) for each in fields for value in values(plan, name, each))


def asks(objective: Objective, demand: Demand) -> bool:
    """Whether an objective has a number, in a range, or a place that may come of it."""
    given = {objective.value, objective.tolerance} - {None}
    least = objective.kind in ("moves", "goes_down") and demand.limit == "most"
    if not least and any(close(float(value), demand) for value in given if value is not None):
        return True
    return any(_has(node, denied, demand) for node, denied in nodes(objective))


def _has(node: Node, denied: bool, demand: Demand) -> bool:
    """Whether a node of a formula has it."""
    fields = dict(node)
    if demand.unit in ("m", "deg") and any(isinstance(fields.get(name), (tuple, float)) for name in _POINTS):
        return True
    low, high, least = fields.pop("low", None), fields.pop("high", None), fields.pop("least", None)
    if isinstance(low, float) and isinstance(high, float) and _in_range(low, high, denied, demand):
        return True
    if isinstance(least, float) and close(least, demand) and (demand.limit == "most") == denied:
        return True
    window = fields.get("window")
    if demand.limit == "since" and isinstance(window, tuple):
        fields.pop("window")
        if window[0] > 0.0 and not ends_by(window[1], demand):
            return True
    if any(close(value, demand) for value in _numbers(fields.values())):
        return True
    holds = demand.unit == "s" and isinstance(node, Always | Mean) and isinstance(window, tuple)
    return holds and window is not None and window[1] is not None and _lasts(window[1] - window[0], demand)


def _in_range(low: float, high: float, denied: bool, demand: Demand) -> bool:
    """Whether a range has a number, on the side of it that the prompt says; one that holds of anything has none."""
    assert demand.value is not None
    value = abs(demand.value)
    nearest = 0.0 if low * high < 0.0 else min(abs(low), abs(high))
    furthest = max(abs(low), abs(high))
    at_end = close(low, demand) or close(high, demand)
    if denied:
        return at_end
    if demand.limit == "least":
        return nearest >= value * (1.0 - ROUNDING)
    if demand.limit == "most":
        return furthest <= value * (1.0 + ROUNDING)
    inside = nearest <= value * (1.0 + ROUNDING) and furthest >= value * (1.0 - ROUNDING)
    return at_end or (inside and furthest <= WIDE * value and nearest * WIDE >= value)


def _lasts(seconds: float, demand: Demand) -> bool:
    """Whether a window is as long as a stated time, less what starting and stopping take of it."""
    assert demand.value is not None
    return math.isclose(seconds, demand.value, rel_tol=2.0 * ROUNDING)


def asks_by_then(objective: Objective, demand: Demand) -> bool:
    """Whether an objective asks for something by a time: in a window that ends by then, or from then on."""
    for node in objective.formula.walk() if objective.formula is not None else ():
        windows = getattr(node, "windows", None) or (getattr(node, "window", None),)
        holds = isinstance(node, Always | Mean)
        if any(w is not None and ends_by(w[0] if holds else w[1], demand) for w in windows):
            return True
        if isinstance(node, Predicate) and any(close(value, demand) for value in _numbers(dict(node).values())):
            return True
    return False


def ends_by(time: float | None, demand: Demand) -> bool:
    """Whether a time is a stated one, or before it."""
    assert demand.value is not None
    return time is not None and time <= demand.value * (1.0 + ROUNDING)


def _numbers(fields: Iterable[object]) -> Iterator[float]:
    for value in fields:
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            yield float(value)
        elif isinstance(value, tuple):
            yield from _numbers(value)


def close(value: float, demand: Demand) -> bool:
    """Whether a plan's number is a stated one, whichever way it points."""
    assert demand.value is not None
    return math.isclose(abs(value), abs(demand.value), rel_tol=ROUNDING, abs_tol=1e-9)


def values(plan: Plan, name: str, field: str) -> Iterator[float]:
    """The numbers of a property, SI, angles in degrees; of a vector also its length, of a radius the diameter too."""
    if name == WHOLE:
        yield plan.simulation.duration
        return
    for item in plan.objects:
        if item.name == name:
            yield from _of_object(plan, item, field)
    for joint in plan.joints:
        if joint.name == name:
            yield from _of_joint(joint, field)
    for cord in plan.cords:
        if cord.name == name and field in OF_CORDS:
            yield from (value for value in (getattr(cord, field),) if value is not None)
    for schedule in plan.schedules:
        if schedule.name == name:
            yield from _of_schedule(schedule, field)
    for opening in plan.openings:
        if opening.name == name:
            yield from _of_opening(plan, opening, field)


def _of_object(plan: Plan, item: PlanObject, field: str) -> Iterator[float]:
    vectors = {
        "velocity": item.velocity, "spin": item.angular_velocity_deg, "surface_velocity": item.surface_velocity,
    }  # fmt: skip
    if field in vectors:
        vector = vectors[field] or (0.0, 0.0, 0.0)
        yield from (*vector, math.hypot(*vector), math.hypot(*vector[:2]))
    elif field == "actuation":
        yield from (each.speed for each in item.registration.actuation if each.speed is not None)
    elif field == "direction" and any(item.velocity):
        x, y, z = item.velocity
        yield from (math.degrees(math.atan2(z, math.hypot(x, y))), math.degrees(math.atan2(y, x)))
    elif field == "size":
        yield from (*item.size, *(2.0 * edge for edge in item.size), *(item.dimensions or ()))
    elif field == "volume":
        yield from _volume(plan, item)
    elif field in ("mass", "density"):
        yield from (value for value in (getattr(item, field),) if value is not None)
    elif field in ("friction", "restitution", "rolling"):
        own = [getattr(item.material, field)] if item.material is not None else []
        pairs = [getattr(each, field) for each in plan.contacts if item.name in (each.object, each.ref)]
        yield from (value for value in (*own, *pairs) if value is not None)
    elif field == "place":
        yield from (value for row in item.relations for value in (row.value, row.gap) if value is not None)
        if item.pose is not None:
            yield from (*item.pose.position, *item.pose.rotation_deg)
            yield from _distances(plan, item)


def _volume(plan: Plan, item: PlanObject) -> Iterator[float]:
    """Of a fluid that stands in a tank, or of a block or a body [m^3]."""
    held, level = item.relation("PLACE-IN"), item.relation("FREE-SURFACE-AT")
    tank = next((each for each in plan.objects if held is not None and each.name == held.ref), None)
    if item.volume is not None or item.registration.volume is not None:
        yield from (value for value in (item.volume, item.registration.volume) if value is not None)
    elif tank is not None and tank.primitive == "tank" and level is not None and level.value is not None:
        yield tank.size[0] * tank.size[1] * level.value


def _distances(plan: Plan, item: PlanObject) -> Iterator[float]:
    """From its centre to those of others, and to the anchors of joints [m]."""
    assert item.pose is not None
    poses = {each.name: each.pose for each in plan.objects if each.pose is not None}
    yield from (math.dist(item.pose.position, pose.position) for name, pose in poses.items() if name != item.name)
    for joint in plan.joints:
        pose, own = poses.get(joint.child), joint.anchor or (0.0, 0.0, 0.0)
        if pose is not None:
            turn = rotation(pose.rotation_deg)
            place = [pose.position[i] + sum(turn[i][k] * own[k] for k in range(3)) for i in range(3)]
            yield math.dist(item.pose.position, place)


def _of_joint(joint: Joint, field: str) -> Iterator[float]:
    if field == "anchor" and joint.anchor is not None:
        yield math.hypot(*joint.anchor)
    elif field == "limits":
        yield from joint.limits or ()
    elif field == "drive" and joint.drive is not None:
        yield from (joint.drive.velocity, joint.drive.position, joint.drive.max_force or 0.0)


def of_opening(plan: Plan, opening: OpeningPlan, demand: Demand) -> str:
    """Which of an opening's properties has a number; empty where none has."""
    fields = {
        "m": ("radius", "size", "offset"), "s": ("start", "stop"), "m^3/s": ("rate",), "m^3": ("rate",),
        "m/s": ("rate", "drop_speed"),
    }.get(demand.unit, ())  # fmt: skip
    found = (field for field in fields if any(close(value, demand) for value in _of_opening(plan, opening, field)))
    return next(found, "")


def _of_opening(plan: Plan, opening: OpeningPlan, field: str) -> Iterator[float]:
    """Its number; of a mouth the width, too, of a time how long it is open, of a rate the rain and all that comes."""
    value = getattr(opening, field, None)
    if field in ("size", "offset"):
        yield from value or ()
    elif value is not None:
        yield float(value)
    if field == "radius":
        yield 2.0 * (opening.radius or 0.0)
    elif field == "stop":
        yield (opening.stop or plan.simulation.duration) - (opening.start or 0.0)
    elif field == "rate" and opening.rate is not None:
        yield from (opening.rate / opening.area, opening.poured(plan.simulation.duration))


def _of_schedule(schedule: SchedulePlan, field: str) -> Iterator[float]:
    """Its keys' values, or their times, how long it is from one to another, and its delay [s]."""
    if field == "times":
        times = schedule.times
        yield from (abs(one - other) for one in times for other in (0.0, *times))
        if schedule.after is not None:
            yield schedule.after.delay or 0.0
    elif field == "values":
        for value in schedule.values:
            vector = value if isinstance(value, tuple) else (value,)
            yield from (*vector, math.hypot(*vector))
