"""What makes a plan of valid parts invalid as a whole. Each problem names its path, and what would fix it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, get_args

from wsim.limits import MAX_DURATION, MAX_FRAME_RATE, MAX_FRICTION, bad_stops, bad_time_step
from wsim.plan.schema.clauses import clause_problems
from wsim.plan.schema.cord_problems import cord_problems
from wsim.plan.schema.draft import KindOfTwo
from wsim.plan.schema.land import land_problems
from wsim.plan.schema.opening_problems import opening_problems
from wsim.plan.schema.schedule_problems import schedule_problems
from wsim.plan.schema.supports import support_problems

if TYPE_CHECKING:
    from wsim.plan.schema.draft import Draft
    from wsim.plan.schema.objects import PlanObject
    from wsim.plan.schema.relations import Relation

SHOWN = 12  # names in a message
_UNITS = {"hinge": "deg", "slider": "m"}


def problems(plan: Draft) -> list[str]:
    """All of them."""
    return [
        *_names(plan),
        *_numbers(plan),
        *_rows(plan),
        *support_problems(plan),
        *_groups(plan),
        *_joints(plan),
        *cord_problems(plan),
        *_contacts(plan),
        *_actuation(plan),
        *_by_time(plan),
        *schedule_problems(plan),
        *opening_problems(plan),
        *land_problems(plan),
        *_others(plan),
        *clause_problems(plan),
    ]


def _numbers(plan: Draft) -> Iterator[str]:
    """What the scene would refuse to be given."""
    simulation = plan.simulation
    for field, most, unit in (("duration", MAX_DURATION, "s"), ("frame_rate", MAX_FRAME_RATE, "Hz")):
        value = getattr(simulation, field)
        if value > most:
            yield f"simulation.{field}: {value:g} must be <= {most:g} {unit}"
    if wrong := bad_time_step(simulation.time_step):
        yield f"simulation.time_step: {wrong}"
    for i, item in enumerate(plan.objects):
        if item.material is not None and item.material.friction > MAX_FRICTION:
            yield f"objects.{i}.material.friction: {item.material.friction:g} must be <= {MAX_FRICTION:g}"
        for field in ("velocity", "angular_velocity_deg"):
            value = getattr(item, field)
            if why := _ill_moved(item, field) if value is not None and any(value) else "":
                yield f"objects.{i}.{field}: {list(value)} of {item.name}, which {why}; remove it"


def _ill_moved(item: PlanObject, field: str) -> str:
    """Why an object cannot start with a velocity, or a spin."""
    if item.state == "static":
        return "is static and never moves"
    return "is a fluid, and starts without a spin" if item.state == "fluid" and field != "velocity" else ""


def _names(plan: Draft) -> Iterator[str]:
    named = {
        "objects": [item.name for item in plan.objects],
        "cameras": [camera.name for camera in plan.cameras],
        "sensors": [sensor.name for sensor in plan.sensors],
        "joints": [joint.name for joint in plan.joints],
        "cords": [cord.name for cord in plan.cords],
        "schedules": [schedule.name for schedule in plan.schedules],
        "openings": [opening.name for opening in plan.openings],
    }
    taken: dict[str, str] = {}
    for kind, names in named.items():
        for index, name in enumerate(names):
            where = f"{kind}.{index}"
            if name in taken:
                yield f"{where}.name: {name!r} is taken by {taken[name]}; give it another name"
            else:
                taken[name] = where


def _known(plan: Draft) -> str:
    names = [item.name for item in plan.objects]
    more = f" and {len(names) - SHOWN} more" if len(names) > SHOWN else ""
    return (", ".join(names[:SHOWN]) or "no objects") + more


def _rows(plan: Draft) -> Iterator[str]:
    items = {item.name: item for item in plan.objects}
    groups = {row.group for item in plan.objects for row in item.relations if row.predicate == "GROUP"}
    for i, item in enumerate(plan.objects):
        for j, row in enumerate(item.relations):
            where = f"objects.{i}.topology.relation.{j}"
            for field, name in row.refs():
                if name == item.name:
                    yield f"{where}.{field}: {item.name} cannot be placed by itself; name another object"
                elif name not in items and name not in groups:
                    yield f"{where}.{field}: no object {name!r}; the plan has {_known(plan)}"
            yield from _row_problems(where, item, row, items)


def _row_problems(where: str, item: PlanObject, row: Relation, items: dict[str, PlanObject]) -> Iterator[str]:
    other, spec = items.get(row.ref or ""), row.spec
    if other is not None and spec.ref_role not in (None, other.role):
        yield f"{where}.ref: {row.predicate} needs a {spec.ref_role}; {row.ref} is a {other.role}"
    # What is hollow beside tanks is known to the catalogue alone; the layout asks it.
    if other is not None and row.predicate == "PLACE-IN" and other.primitive in ("ground", "fluid"):
        yield f"{where}.ref: PLACE-IN needs a container; {row.ref} is a {other.role}"
    if other is not None and other.primitive in ("terrain", "scatter"):
        yield f"{where}.ref: {row.ref} is a {other.primitive}, which has no sides and no top; give {item.name} a pose"
    if spec.of_role not in (None, item.role):
        yield f"{where}: {row.predicate} is a {spec.of_role}'s; {item.name} is a {item.role}"


def _groups(plan: Draft) -> Iterator[str]:
    made: dict[str, tuple[str, int]] = {}
    member_of: dict[str, str] = {}
    rows = [(i, j, item, row) for i, item in enumerate(plan.objects) for j, row in enumerate(item.relations)]
    names = {item.name for item in plan.objects}
    for i, j, item, row in rows:
        where = f"objects.{i}.topology.relation.{j}"
        if row.predicate not in ("GROUP", "COPY-GROUP"):
            continue
        for name in [item.name, *(row.members or [])]:
            if name in member_of:
                yield f"{where}.members: {name} is in the group of {member_of[name]} already; a thing has one group"
            member_of[name] = item.name
        if row.predicate == "GROUP" and row.group is not None:
            if row.group in made or row.group in names:
                yield f"{where}.group: {row.group!r} is taken; give the group another name"
            made[row.group] = (item.name, len(row.members or []))
    for i, j, item, row in rows:
        for field, name in row.refs():
            if name in made and member_of.get(item.name) == made[name][0]:
                yield (
                    f"objects.{i}.topology.relation.{j}.{field}: {item.name} is in the group {name}, and cannot be "
                    "placed by it; name an object"
                )
    for i, j, _, row in rows:
        if row.predicate != "COPY-GROUP" or row.group is None:
            continue
        where = f"objects.{i}.topology.relation.{j}"
        if row.group not in made:
            known = ", ".join(made) or "none"
            yield f"{where}.group: no group {row.group!r}; the plan's groups: {known}"
        elif len(row.members or []) != made[row.group][1]:
            yield (
                f"{where}.members: {len(row.members or [])} members copy the group {row.group}, which has "
                f"{made[row.group][1]} beside its anchor; name as many"
            )


def _joints(plan: Draft) -> Iterator[str]:
    names = {item.name for item in plan.objects}
    for i, joint in enumerate(plan.joints):
        for field in ("child", "parent"):
            name = getattr(joint, field)
            if name is not None and name not in names:
                yield f"joints.{i}.{field}: no object {name!r}; the plan has {_known(plan)}"
        if joint.child == joint.parent:
            yield f"joints.{i}.parent: {joint.child} cannot hold itself; name another object, or leave it out"
        if joint.limits is not None and joint.kind in ("fixed", "ball"):
            yield f"joints.{i}.limits: a {joint.kind} joint has none; remove them"
        elif joint.limits is not None and (wrong := bad_stops(*joint.limits, _UNITS[joint.kind])):
            yield f"joints.{i}.limits: {wrong}"


def _tied(plan: Draft) -> dict[frozenset[str], str]:
    """Pairs that a joint keeps from touching, and its name."""
    return {frozenset((joint.child, joint.parent)): joint.name for joint in plan.joints if joint.parent is not None}


def _contacts(plan: Draft) -> Iterator[str]:
    """Two objects that meet, stated once."""
    items = {item.name: item for item in plan.objects}
    seen: dict[frozenset[str], int] = {}
    ties = _tied(plan)
    for i, contact in enumerate(plan.contacts):
        unknown = [field for field in ("object", "ref") if getattr(contact, field) not in items]
        for field in unknown:
            yield f"contacts.{i}.{field}: no object {getattr(contact, field)!r}; the plan has {_known(plan)}"
        if unknown:
            continue
        one, other, pair = items[contact.object], items[contact.ref], frozenset((contact.object, contact.ref))
        fluid = next((item for item in (one, other) if item.primitive == "fluid"), None)
        if one is other:
            yield f"contacts.{i}.ref: {one.name} does not touch itself; name another object"
        elif fluid is not None:
            yield f"contacts.{i}: {fluid.name} is a fluid, which has no friction or restitution; name two solids"
        elif {"vehicle", "scatter"} & {one.primitive, other.primitive}:
            both = f"{one.name} and {other.name}"
            yield f"contacts.{i}: {both}: a vehicle or a scatter is many bodies; leave it to their materials"
        elif one.state == other.state == "static":
            yield f"contacts.{i}: {one.name} and {other.name} are both static; they never meet"
        elif pair in ties:
            yield (
                f"contacts.{i}: {one.name} and {other.name} never touch: the joint {ties[pair]} ties them; leave one "
                "of the two out"
            )
        elif contact.friction is not None and contact.friction > MAX_FRICTION:
            yield f"contacts.{i}.friction: {contact.friction:g} must be <= {MAX_FRICTION:g}"
        elif pair in seen:
            yield f"contacts.{i}: {one.name} and {other.name} are in contacts.{seen[pair]}, too; state the pair once"
        seen.setdefault(pair, i)


def _actuation(plan: Draft) -> Iterator[str]:
    """A joint that an object's actuation names is there, and has no drive beside it."""
    joints = {joint.name: joint for joint in plan.joints}
    for i, item in enumerate(plan.objects):
        for j, actuation in enumerate(item.registration.actuation):
            if actuation.kind == "schedule":  # of a joint that the robot has of its own
                continue
            where = f"objects.{i}.registration.actuation.{j}.joint"
            if actuation.joint is not None and actuation.joint not in joints:
                yield f"{where}: no joint {actuation.joint!r}; the plan has {', '.join(joints) or 'none'}"
            elif actuation.joint is not None and joints[actuation.joint].drive is not None:
                yield f"{where}: {actuation.joint} has a drive; remove it, or this actuation: one thing drives a joint"


def _by_time(plan: Draft) -> Iterator[str]:
    """What a robot does by time comes in order, each joint by one schedule, and ends before the world does."""
    for i, item in enumerate(plan.objects):
        done, scheduled = 0.0, set[str]()
        for j, each in enumerate(item.registration.actuation):
            where = f"objects.{i}.registration.actuation.{j}"
            if not each.times:
                continue
            if each.times[-1] > plan.simulation.duration:
                yield f"{where}.times: {each.times[-1]:g} s is after the end, at {plan.simulation.duration:g} s"
            if each.kind == "schedule":
                if each.joint in scheduled:
                    yield f"{where}.joint: {each.joint} has a schedule already; put their targets and times into one"
                scheduled.add(str(each.joint))
                continue
            starts = done if each.start is None else each.start
            if starts < done:
                yield f"{where}.start: {starts:g} s is before {done:g} s, when the one before is done"
            elif each.times[0] <= starts:
                yield f"{where}.times: {each.times[0]:g} s must be after {starts:g} s, when it sets out"
            done = max(done, each.times[-1])
        if done and any(each.policy for each in item.registration.actuation):
            yield f"objects.{i}.registration.actuation: a policy walks {item.name}; what it walks reaches for nothing"


def _goes(item: PlanObject) -> bool:
    return item.state != "static" and item.primitive not in ("fluid", "ground", "terrain", "scatter")


def _wheels(plan: Draft) -> str:
    """What else a formula may name: the wheels of vehicles."""
    wheels = [prim for item in plan.objects if item.primitive == "vehicle" for prim in item.prims if "_wheel_" in prim]
    return f", and the wheels {', '.join(wheels)}" if wheels else ""


def _others(plan: Draft) -> Iterator[str]:
    names = {item.name for item in plan.objects}
    parts = {prim for item in plan.objects if item.primitive == "vehicle" for prim in item.prims}
    cameras = {camera.name for camera in plan.cameras}
    for i, objective in enumerate(plan.objectives):
        if objective.object not in names:
            hint = "; as a part of a vehicle a formula alone may name it" if objective.object in parts else ""
            yield f"objectives.{i}.object: no object {objective.object!r}; the plan has {_known(plan)}{hint}"
        if objective.ref is None and objective.kind in get_args(KindOfTwo):
            yield f'objectives.{i}.ref: "{objective.kind}" needs "ref", the name of the other object'
        if objective.ref is not None and objective.ref not in names:
            yield f"objectives.{i}.ref: no object {objective.ref!r}; the plan has {_known(plan)}"
        for name in sorted(objective.formula.names()) if objective.formula is not None else ():
            if not name.startswith("/") and name not in names | parts:
                yield f"objectives.{i}.formula: no object {name!r}; the plan has {_known(plan)}{_wheels(plan)}"
    for i, camera in enumerate(plan.cameras):
        if camera.of is not None and camera.of not in names:
            yield f"cameras.{i}.of: no object {camera.of!r}; the plan has {_known(plan)}"
        if camera.follows is not None and not any(item.name == camera.follows and _goes(item) for item in plan.objects):
            goers = ", ".join(item.name for item in plan.objects if _goes(item)) or "none"
            yield f"cameras.{i}.follows: {camera.follows!r} is no body that moves; the plan has {goers}"
    for i, sensor in enumerate(plan.sensors):
        if sensor.mount is not None and sensor.mount not in names:
            yield f"sensors.{i}.mount: no object {sensor.mount!r}; the plan has {_known(plan)}"
    tied = {each.name for things in (plan.joints, plan.cords, plan.schedules) for each in things}
    for i, step in enumerate(plan.steps):
        for j, name in enumerate(step.objects):
            if name not in names | tied:
                yield f"steps.{i}.objects.{j}: no object {name!r}; the plan has {_known(plan)}"
    for i, name in enumerate(plan.outputs.stills):
        if name not in cameras:
            yield f"outputs.stills.{i}: no camera {name!r}; the plan has {', '.join(cameras) or 'none'}"
