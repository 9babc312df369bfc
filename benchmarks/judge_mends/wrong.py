"""One wrong number or arrangement each: in the program alone, or in the program and left open by the plan."""

from __future__ import annotations

import ast
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from benchmarks.judge_families.drawn import Draw
from benchmarks.judge_mends.calls import call_of, keyword_of, literal, put, run_of
from benchmarks.judge_worlds import in_program
from wsim.plan.schema import Plan, PlanObject
from wsim.program.mend.text import made_by

SOLID = ("box", "sphere", "cylinder", "capsule")
Change = Callable[[str], str]
Wrong = Callable[[Plan, Draw], "Mistake | None"]


@dataclass(frozen=True)
class Mistake:
    """What is wrong in a program.

    Attributes:
        what: In words, with its size.
        program: Makes it, in the text of the right program; or
        plan: in the plan that the program is written from.
        opened: The plan that the judge is told, where the plan leaves open what is wrong.
    """

    what: str
    program: Change | None = None
    plan: Callable[[Plan], Plan] | None = None
    opened: Callable[[Plan], Plan] | None = None


WRONG: dict[str, Wrong] = {}


def wrong(make: Wrong) -> Wrong:
    """Register a kind of mistake: of a plan and a draw the mistake, or None where it cannot be made there."""
    WRONG[make.__name__] = make
    return make


# ---- parts
def _loose(plan: Plan) -> list[PlanObject]:
    return [o for o in plan.objects if o.state == "dynamic" and o.primitive in SOLID and o.pose is not None]


def _free(plan: Plan) -> list[PlanObject]:
    held = {name for joint in plan.joints for name in (joint.child, joint.parent)}
    return [o for o in _loose(plan) if o.name not in held]


def _asked(plan: Plan, *kinds: str) -> set[str]:
    return {o.object for o in plan.objectives if o.kind in kinds}


def _without(name: str, **fields: Any) -> Callable[[Plan], Plan]:
    """The plan that leaves something of an object open."""
    return lambda plan: in_program._with(plan, name, lambda item: item.model_copy(update=fields))


def _unmade(name: str) -> Callable[[Plan], Plan]:
    """The plan that leaves an object's material open, and its mass."""

    def change(item: PlanObject) -> PlanObject:
        kept = item.registration.model_copy(update={"mass": None, "density": None})
        return item.model_copy(update={"material": None, "registration": kept})

    return lambda plan: in_program._with(plan, name, change)


def _as_it_is(plan: Plan) -> Plan:
    """The plan itself, which has no word on what is wrong."""
    return plan


def _untold(plan: Plan) -> Plan:
    """The plan that does not say where its drives go."""

    def change(item: PlanObject) -> PlanObject:
        told = [each.model_copy(update={"target": ()}) for each in item.registration.actuation]
        return item.model_copy(update={"registration": item.registration.model_copy(update={"actuation": told})})

    return plan.model_copy(update={"objects": [change(item) for item in plan.objects]})


def edited(change: Callable[[ast.FunctionDef], None]) -> Change:
    """A change of the calls in `build`."""

    def of(program: str) -> str:
        tree = ast.parse(program)
        change(next(node for node in tree.body if isinstance(node, ast.FunctionDef) and node.name == "build"))
        return ast.unparse(ast.fix_missing_locations(tree)) + "\n"

    return of


def _with(name: str, keyword: str, value: Callable[[Any], object]) -> Change:
    def change(build: ast.FunctionDef) -> None:
        call = call_of(build, name)
        put(call, keyword, value(literal(call, keyword)))

    return edited(change)


def _factor(draw: Draw, low: float, high: float) -> float:
    by = draw.log(low, high)
    return round(by if draw.sign() > 0 else 1.0 / by, 3)


# ---- what bodies are made of
@wrong
def density(plan: Plan, draw: Draw) -> Mistake | None:
    """A body is far too heavy or too light; open where it is to float, sink or be submerged."""
    items = [o for o in _loose(plan) if o.material is not None and o.registration.mass is None]
    if not items:
        return None
    item, by = draw.pick(items), _factor(draw, 1.5, 5.0)
    return Mistake(f"{item.name}: density x {by:g}", plan=in_program.heavier(item.name, by))


@wrong
def too_heavy_to_float(plan: Plan, draw: Draw) -> Mistake | None:
    """What is to float is heavier than the fluid."""
    items = [o for o in _loose(plan) if o.name in _asked(plan, "floats") and o.density]
    if not items:
        return None
    item, to = draw.pick(items), round(draw.between(1100.0, 4000.0))
    return Mistake(
        f"{item.name}: {to} kg/m^3", plan=in_program.heavier(item.name, to / (item.density or 1.0)),
        opened=_unmade(item.name),
    )  # fmt: skip


@wrong
def too_light_to_sink(plan: Plan, draw: Draw) -> Mistake | None:
    """What is to lie under the surface is lighter than the fluid."""
    items = [o for o in _loose(plan) if o.name in _asked(plan, "submerged", "rests_on") and o.density and
             any(other.primitive == "fluid" for other in plan.objects)]  # fmt: skip
    if not items:
        return None
    item, to = draw.pick(items), round(draw.between(200.0, 800.0))
    return Mistake(
        f"{item.name}: {to} kg/m^3", plan=in_program.heavier(item.name, to / (item.density or 1.0)),
        opened=_unmade(item.name),
    )  # fmt: skip


@wrong
def friction(plan: Plan, draw: Draw) -> Mistake | None:
    """A surface is far too slick or too rough; open on a slope and where a way is asked for."""
    items = [o for o in _free(plan) if o.material is not None]
    if not items:
        return None
    item = draw.pick(items)
    assert item.material is not None
    to = round(item.material.friction * _factor(draw, 2.0, 8.0), 3)
    return Mistake(f"{item.name}: friction {to:g}", program=_with(item.name, "friction", lambda _: min(to, 1.5)))


@wrong
def too_slick(plan: Plan, draw: Draw) -> Mistake | None:
    """What is to stay on a slope has too little friction."""
    items = [o for o in _free(plan) if o.name in _asked(plan, "stays_on", "rests_on", "settles")
             and o.pose is not None and abs(o.pose.rotation_deg[1]) > 2.0]  # fmt: skip
    if not items:
        return None
    item = draw.pick(items)
    assert item.pose is not None
    to = round(math.tan(math.radians(abs(item.pose.rotation_deg[1]))) * draw.between(0.2, 0.8), 3)
    return Mistake(
        f"{item.name}: friction {to:g}", program=_with(item.name, "friction", lambda _: to), opened=_unmade(item.name)
    )


@wrong
def too_rough(plan: Plan, draw: Draw) -> Mistake | None:
    """What is to slide down a slope sticks to it."""
    items = [o for o in _free(plan) if o.name in _asked(plan, "slides")
             and o.pose is not None and abs(o.pose.rotation_deg[1]) > 2.0]  # fmt: skip
    if not items:
        return None
    item = draw.pick(items)
    assert item.pose is not None
    to = round(math.tan(math.radians(abs(item.pose.rotation_deg[1]))) * draw.between(1.2, 2.0), 3)

    def change(build: ast.FunctionDef) -> None:
        for each in ast.walk(build):
            if isinstance(each, ast.Call) and made_by(each) in (item.name, "ramp"):
                put(each, "friction", to)

    def opened(plan: Plan) -> Plan:
        return _unmade("ramp")(_unmade(item.name)(plan))

    return Mistake(f"{item.name}: friction {to:g}", program=edited(change), opened=opened)


@wrong
def restitution(plan: Plan, draw: Draw) -> Mistake | None:
    """A body bounces too well."""
    items = [o for o in _free(plan) if o.material is not None and o.material.restitution < 0.5]
    if not items:
        return None
    item, to = draw.pick(items), round(draw.between(0.7, 0.98), 2)
    return Mistake(f"{item.name}: restitution {to:g}", program=_with(item.name, "restitution", lambda _: to))


@wrong
def dead_bounce(plan: Plan, draw: Draw) -> Mistake | None:
    """What is to bounce up to a height bounces too little or too much."""
    items = [o for o in _free(plan) if o.material is not None and o.material.restitution >= 0.5]
    if not items:
        return None
    item = draw.pick(items)
    to = round(draw.pick((draw.between(0.2, 0.5), draw.between(0.88, 0.98))), 3)
    return Mistake(
        f"{item.name}: restitution {to:g}", program=_with(item.name, "restitution", lambda _: to),
        opened=_unmade(item.name),
    )  # fmt: skip


@wrong
def mass(plan: Plan, draw: Draw) -> Mistake | None:
    """A body weighs something else."""
    items = [o for o in _loose(plan) if o.mass]
    if not items:
        return None
    item, by = draw.pick(items), _factor(draw, 1.3, 10.0)
    to = round((item.mass or 1.0) * by, 4)
    return Mistake(f"{item.name}: {to:g} kg", program=_with(item.name, "mass", lambda _: to))


# ---- where bodies are, and how fast
def _shifted(item: PlanObject, by: tuple[float, float, float], what: str, opened: bool) -> Mistake:
    return Mistake(
        f"{item.name}: {what} by {math.hypot(*by):.3g} m", plan=in_program.moved(item.name, by),
        opened=_without(item.name, pose=None) if opened else None,
    )  # fmt: skip


@wrong
def sunk(plan: Plan, draw: Draw) -> Mistake | None:
    """A body starts inside what carries it."""
    items = [o for o in _free(plan) if not any(o.velocity)]
    if not items:
        return None
    item = draw.pick(items)
    share = draw.between(0.15, 0.4)
    return _shifted(item, (0.0, 0.0, -round(share * min(item.size), 4)), "sunk", draw.sign() > 0)


@wrong
def lifted(plan: Plan, draw: Draw) -> Mistake | None:
    """A body starts above where it is to stand."""
    items = [o for o in _free(plan) if not any(o.velocity)]
    if not items:
        return None
    item = draw.pick(items)
    return _shifted(item, (0.0, 0.0, round(draw.between(0.4, 2.0) * max(item.size), 4)), "lifted", False)


@wrong
def beside(plan: Plan, draw: Draw) -> Mistake | None:
    """A body starts beside what is to carry it."""
    items = [o for o in _free(plan) if o.name in _asked(plan, "rests_on", "stays_on", "stays_inside", "floats")
             and not any(o.velocity)]  # fmt: skip
    if not items:
        return None
    item = draw.pick(items)
    refs = [o.ref for o in plan.objectives if o.object == item.name and o.ref]
    ref = next((o for o in plan.objects if o.name in refs and o.size), None)
    if ref is None:
        return None
    half = max(ref.size[:2]) / 2 if len(ref.size) > 1 else ref.size[0]
    x, y = draw.heading()
    far = 1.4 * half + max(item.size)
    return _shifted(item, (round(x * far, 3), round(y * far, 3), 0.0), "beside", draw.sign() > 0)


@wrong
def turned(plan: Plan, draw: Draw) -> Mistake | None:
    """A body starts turned."""
    items = [o for o in _free(plan) if o.primitive != "sphere" and not any(o.velocity)]
    if not items:
        return None
    item = draw.pick(items)
    assert item.pose is not None
    a, b, c = item.pose.rotation_deg
    to = (round(a + draw.sign() * draw.between(10.0, 40.0), 1), b, c)
    return Mistake(f"{item.name}: turned to {to[0]:g} degrees", plan=in_program.turned(item.name, to))


@wrong
def start_speed(plan: Plan, draw: Draw) -> Mistake | None:
    """A body starts too fast or too slow."""
    items = [o for o in _free(plan) if any(o.velocity)]
    if not items:
        return None
    item, by = draw.pick(items), _factor(draw, 1.3, 3.0)
    return Mistake(f"{item.name}: velocity x {by:g}", plan=in_program.launched(item.name, by))


@wrong
def start_direction(plan: Plan, draw: Draw) -> Mistake | None:
    """A body starts another way."""
    items = [o for o in _free(plan) if any(o.velocity)]
    if not items:
        return None
    item = draw.pick(items)
    turn = math.radians(draw.sign() * draw.between(20.0, 160.0))
    x, y, z = item.velocity
    to = (round(x * math.cos(turn) - y * math.sin(turn), 4), round(x * math.sin(turn) + y * math.cos(turn), 4), z)
    return Mistake(f"{item.name}: velocity {to}", program=_with(item.name, "velocity", lambda _: to))


@wrong
def size(plan: Plan, draw: Draw) -> Mistake | None:
    """A body is too large or too small."""
    items = _free(plan)
    if not items:
        return None
    item, by = draw.pick(items), _factor(draw, 1.2, 2.0)
    return Mistake(f"{item.name}: size x {by:g}", plan=in_program.scaled(item.name, by, lift=False))


@wrong
def missing(plan: Plan, draw: Draw) -> Mistake | None:
    """An object is left out."""
    items = [o for o in plan.objects if o.primitive in SOLID]
    if not items:
        return None
    item = draw.pick(items)
    return Mistake(f"{item.name} is missing", plan=in_program.without(item.name))


@wrong
def too_many(plan: Plan, draw: Draw) -> Mistake | None:
    """There is an object more than the plan has."""
    items = _free(plan)
    if not items:
        return None
    item = draw.pick(items)
    offset = (round(draw.between(1.0, 3.0), 2), round(draw.between(1.0, 3.0), 2), 0.0)
    return Mistake(f"another {item.name}", plan=in_program.extra(item.name, "spare", offset))


@wrong
def swapped(plan: Plan, draw: Draw) -> Mistake | None:
    """Two objects stand in each other's place."""
    items = _free(plan)
    if len(items) < 2:
        return None
    one = draw.pick(items)
    other = draw.pick([o for o in items if o is not one])
    return Mistake(f"{one.name} and {other.name} swapped", plan=in_program.swapped(one.name, other.name))


# ---- the run
def _of_run(keyword: str, value: object) -> Change:
    return edited(lambda build: put(run_of(build), keyword, value))


@wrong
def duration(plan: Plan, draw: Draw) -> Mistake | None:
    """The run is shorter than planned; open where the plan is as short."""
    to = round(plan.simulation.duration * draw.between(0.15, 0.6), 2)

    def opened(plan: Plan) -> Plan:
        return plan.model_copy(update={"simulation": plan.simulation.model_copy(update={"duration": to})})

    return Mistake(f"{to:g} s long", program=_of_run("duration", to), opened=opened if draw.sign() > 0 else None)


@wrong
def gravity(plan: Plan, draw: Draw) -> Mistake | None:
    """Gravity is another, or points elsewhere."""
    g, turn = 9.81 * _factor(draw, 1.2, 4.0), math.radians(draw.pick((0.0, 0.0, 5.0, 20.0)))
    to = (round(g * math.sin(turn), 3), 0.0, -round(g * math.cos(turn), 3))
    return Mistake(f"gravity {to}", program=_of_run("gravity", to))


# ---- joints and drives
def _joint_call(plan: Plan, draw: Draw) -> tuple[str, str] | None:
    joints = [j for j in plan.joints if j.kind in ("hinge", "slider")]
    if not joints:
        return None
    joint = draw.pick(joints)
    return joint.name, joint.kind


def _drive_changed(name: str, part: str, change: Callable[[float], float]) -> Change:
    def of(build: ast.FunctionDef) -> None:
        drive = keyword_of(call_of(build, name), "drive")
        if not isinstance(drive, ast.Call):
            raise ValueError("no drive")
        put(drive, part, change(float(literal(drive, part, 0.0))))  # type: ignore[arg-type]

    return edited(of)


@wrong
def drive_target(plan: Plan, draw: Draw) -> Mistake | None:
    """A drive goes elsewhere, or at another speed."""
    found = _joint_call(plan, draw)
    if found is None:
        return None
    by = draw.pick((-1.0, 0.3, 0.5, 1.6, 2.5))
    part = "velocity" if plan.title.startswith("A motor turns a wheel") else "position"
    change = _drive_changed(found[0], part, lambda x: x * by)
    opened = _untold if draw.sign() > 0 else None
    return Mistake(f"{found[0]}: drive {part} x {by:g}", program=change, opened=opened)


@wrong
def drive_strength(plan: Plan, draw: Draw) -> Mistake | None:
    """A drive is too weak."""
    found = _joint_call(plan, draw)
    if found is None:
        return None
    by = round(draw.log(0.001, 0.1), 4)
    change = _drive_changed(found[0], "max_force", lambda x: x * by)
    return Mistake(f"{found[0]}: greatest effort x {by:g}", program=change, opened=_as_it_is)


@wrong
def drive_gain(plan: Plan, draw: Draw) -> Mistake | None:
    """A drive has too little stiffness or damping."""
    found = _joint_call(plan, draw)
    if found is None:
        return None
    part, by = draw.pick(("stiffness", "damping")), round(draw.log(0.01, 0.2), 4)
    change = _drive_changed(found[0], part, lambda x: x * by)
    return Mistake(f"{found[0]}: {part} x {by:g}", program=change, opened=_as_it_is)


@wrong
def joint_axis(plan: Plan, draw: Draw) -> Mistake | None:
    """A joint is about another axis."""
    found = _joint_call(plan, draw)
    if found is None:
        return None
    joint = next(j for j in plan.joints if j.name == found[0])
    axis = draw.pick([letter for letter in "XYZ" if letter != joint.axis])
    return Mistake(f"{found[0]}: axis {axis}", plan=in_program.hinged_elsewhere(found[0], axis))


@wrong
def joint_limits(plan: Plan, draw: Draw) -> Mistake | None:
    """A joint stops too early."""
    joints = [j for j in plan.joints if j.kind in ("hinge", "slider")]
    if not joints:
        return None
    joint, by = draw.pick(joints), draw.between(0.05, 0.4)
    name = "limits_deg" if joint.kind == "hinge" else "limits"
    low, high = joint.limits or ((-60.0, 60.0) if joint.kind == "hinge" else (-0.5, 0.5))
    to = (round(low * by, 3), round(high * by, 3))
    return Mistake(f"{joint.name}: limits {to}", program=_with(joint.name, name, lambda _: to))


@wrong
def joint_place(plan: Plan, draw: Draw) -> Mistake | None:
    """A hinge is elsewhere on its body."""
    joints = [j for j in plan.joints if j.kind in ("hinge", "ball")]
    if not joints:
        return None
    joint = draw.pick(joints)
    size = max(plan.object(joint.child).size)
    by = round(draw.sign() * draw.between(0.15, 0.4) * size, 4)

    def to(now: Any) -> object:
        if now is None:
            raise ValueError("the program gives it no place")
        a, b, c = now
        return (a + by, b, c) if joint.axis != "X" else (a, b + by, c)

    return Mistake(f"{joint.name}: {by:g} m away", program=_with(joint.name, "anchor", to))


@wrong
def joint_missing(plan: Plan, draw: Draw) -> Mistake | None:
    """A joint is left out."""
    if not plan.joints:
        return None
    joint = draw.pick(plan.joints)
    return Mistake(f"{joint.name} is missing", plan=in_program.without_joint(joint.name))


# ---- cameras
@wrong
def camera_away(plan: Plan, draw: Draw) -> Mistake | None:
    """A camera looks elsewhere, from where it stands."""
    camera, (x, y, z) = draw.pick(plan.cameras), draw.direction()
    a, b, c = camera.eye or (0.0, 0.0, 0.0)
    target = (round(a + x, 3), round(b + y, 3), round(c + abs(z), 3))

    def change(build: ast.FunctionDef) -> None:
        put(call_of(build, camera.name), "target", target)
        put(call_of(build, camera.name), "fixed", True)  # another is corrected without a repair

    return Mistake(f"{camera.name} looks at {target}", program=edited(change), opened=_as_it_is)


@wrong
def camera_elsewhere(plan: Plan, draw: Draw) -> Mistake | None:
    """A camera stands far away, or low behind what there is, and looks past it."""
    camera, (x, y) = draw.pick(plan.cameras), draw.heading()
    eye, target = (round(15.0 * x, 2), round(15.0 * y, 2), 2.0), (round(20.0 * x, 2), round(20.0 * y, 2), 1.0)

    def change(build: ast.FunctionDef) -> None:
        put(call_of(build, camera.name), "eye", eye)
        put(call_of(build, camera.name), "target", target)
        put(call_of(build, camera.name), "fixed", True)

    return Mistake(f"{camera.name} stands at {eye}", program=edited(change), opened=_as_it_is)


# ---- fluids
def _fluid(plan: Plan) -> PlanObject | None:
    return next((o for o in plan.objects if o.primitive == "fluid" and o.relation("FREE-SURFACE-AT")), None)


@wrong
def water_level(plan: Plan, draw: Draw) -> Mistake | None:
    """The tank is filled too low."""
    item = _fluid(plan)
    by = round(draw.between(0.4, 0.8), 3)
    return Mistake(f"level x {by:g}", plan=in_program.filled(item.name, by)) if item else None


@wrong
def fluid_density(plan: Plan, draw: Draw) -> Mistake | None:
    """The fluid is another."""
    item = _fluid(plan)
    to = round(draw.pick((700.0, 790.0, 1260.0, 1400.0)))
    return Mistake(f"fluid of {to} kg/m^3", program=_with(item.name, "density", lambda _: to)) if item else None
