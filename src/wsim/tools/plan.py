"""Tools that read and write the plan."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Literal

from pydantic import Field

from wsim.errors import UserError
from wsim.plan.asked.covered import not_checked
from wsim.plan.feasible.plan import refuse_impossible
from wsim.plan.store import load, save
from wsim.plan.unheeded import unheeded
from wsim.tools.base import Arguments, Result, Tool, Workspace
from wsim.tools.text import number, numbers, table

if TYPE_CHECKING:
    from wsim.plan.schema import Joint, Plan, PlanObject, Vec3

Part = Literal[
    "all", "objects", "relations", "joints", "cords", "contacts", "schedules", "openings", "cameras", "objectives",
    "assumptions", "steps",
]  # fmt: skip
SIDE_NAME = "plan.json.new"


class ReadPlan(Arguments):
    """A part of the plan."""

    part: Part = Field("all", description="which rows; all of them by default, but assumptions and steps")
    object: str = Field("", description="only rows that name this object", max_length=200)


class WritePlan(Arguments):
    """A whole plan."""

    plan: str | dict[str, Any] = Field(
        description="the plan as JSON, all of it; the layout works out places that it leaves out"
    )


def read_plan(workspace: Workspace, asked: ReadPlan) -> Result:
    """The plan as tables."""
    plan = workspace.plan
    if plan is None:
        raise UserError("the run has no plan; write one with write_plan")
    if asked.object and asked.object not in [item.name for item in plan.objects]:
        raise UserError(f"object: no {asked.object[:60]!r}; the plan has {_names(plan)}")
    return Result("\n".join(_show(plan, asked.part, asked.object)))


def write_plan(workspace: Workspace, asked: WritePlan) -> Result:
    """Check a plan, lay it out, and make it the run's."""
    judged = [folder.name for folder in workspace.run.iterations() if (folder / "verdict.json").is_file()]
    if judged:
        raise UserError(
            f"iteration {judged[0]} was judged by the plan that is there: it stays; another plan needs another run"
        )
    try:
        text = asked.plan if isinstance(asked.plan, str) else json.dumps(asked.plan)
    except RecursionError as error:
        raise UserError("plan: nested too deep; a plan has about ten levels") from error
    side = workspace.run.path / SIDE_NAME
    side.write_bytes(text.encode("utf-8", "surrogatepass"))  # what is no text, the reader says
    try:
        plan = load(side)
        refuse_impossible(plan, side)
    except UserError as error:
        return Result(f"not written: {str(error).removeprefix(f'{side}: ')}", ok=False)
    finally:
        side.unlink()
    save(plan, workspace.run.path / "plan.json")
    return Result("\n".join(["plan.json written, laid out:", *_show(plan, "all", "")]))


def plan_lines(plan: Plan) -> list[str]:
    """All of a plan as tables, the steps too, however long; a step says what no other row has room for."""
    return [*_show(plan, "all", "")[: -1 if plan.assumptions or plan.steps else None], *_steps(plan, "")]


def _names(plan: Plan) -> str:
    names = [item.name for item in plan.objects]
    return ", ".join(names[:20]) + (f" and {len(names) - 20} more" if len(names) > 20 else "")


def _show(plan: Plan, part: Part, name: str) -> list[str]:
    """The rows of a part, and of one object alone where it is named."""
    parts: dict[str, Callable[[Plan, str], list[str]]] = {
        "objects": _objects,
        "relations": _relations,
        "objectives": _objectives,
        "joints": _joints,
        "cords": _cords,
        "contacts": _contacts,
        "schedules": _schedules,
        "openings": _openings,
        "cameras": _cameras,
        "assumptions": _assumptions,
        "steps": _steps,
    }
    if part != "all":
        return parts[part](plan, name) or [f"no {part}" + (f" that name {name}" if name else "")]
    run = plan.simulation
    lines = [f"{plan.title}: {number(run.duration)} s at {number(run.frame_rate)} frames/s", *_picture(plan)]
    for key in (
        "objects",
        "relations",
        "objectives",
        "joints",
        "cords",
        "contacts",
        "schedules",
        "openings",
        "cameras",
    ):
        lines += parts[key](plan, name)
    rest = [f"{len(rows)} {key}" for key, rows in (("assumptions", plan.assumptions), ("steps", plan.steps)) if rows]
    if not name:
        lines += [f"not done: {line}" for line in unheeded(plan)]
        lines += [f"not checked: {line}" for line in not_checked(plan)]
        lines += [f"stands in for: {plan.stands_in_for}"] if plan.stands_in_for else []
    return [*lines, *([f"also: {', '.join(rest)}"] if rest else [])]


def _picture(plan: Plan) -> list[str]:
    """What the planner saw in the reference picture."""
    if plan.image is None:
        return []
    seen = {field: said for field, said in plan.image.hints if said}
    told = "; ".join(f"{field}: {said if isinstance(said, str) else ', '.join(said)}" for field, said in seen.items())
    return [f"picture {plan.image.path}: {told or 'no hints'}"]


def _objects(plan: Plan, name: str) -> list[str]:
    rows = []
    for item in plan.objects:
        if name not in ("", item.name):
            continue
        made = item.construction
        what = f"asset {made.asset}" if made.kind == "asset" else item.primitive
        what = f"robot {made.robot}" if made.kind == "robot" else what
        what = f"vehicle {made.vehicle}" if made.kind == "vehicle" else what
        what = f"{made.count} x {', '.join(made.what)}" if made.kind == "scatter" else what
        what = f"terrain {numbers(made.extent, ' x ')} m" if made.kind == "terrain" else what
        pose, weight = item.pose, item.registration
        density = weight.density or (item.material.density if item.material and not weight.mass else None)
        rows.append([
            item.name, what, item.state, item.material.name if item.material else "", number(density),
            number(weight.mass), numbers(item.size, " x "), numbers(pose.position) if pose else "",
            numbers(pose.rotation_deg) if pose and any(pose.rotation_deg) else "",
            numbers(item.velocity) if any(item.velocity) else "",
            numbers(item.surface_velocity) if item.surface_velocity else "",
            *_surface(item),
        ])  # fmt: skip
    head = (
        "object", "what", "state", "material", "kg/m^3", "kg", "size [m]", "place [m]", "turned [deg]", "m/s",
        "surface m/s", "friction", "restitution", "rolling",
    )  # fmt: skip
    return [*table(head, rows), *_moved(plan, name)] if rows else []


def _moved(plan: Plan, name: str) -> list[str]:
    """What drives objects, as the plan has it: the route of a vehicle, the reaches of an arm."""
    found = []
    for item in plan.objects:
        for each in item.registration.actuation if name in ("", item.name) else ():
            said = each.model_dump(mode="json", exclude_defaults=True, exclude={"kind", "words"})
            told = ", ".join(f"{key} {json.dumps(value)}" for key, value in said.items())
            found.append(f"{item.name} is moved by {each.kind}{f': {told}' if told else ''}")
    return found


def _surface(item: PlanObject) -> list[str]:
    """Friction, and restitution and rolling resistance where the plan states them."""
    material = item.material
    if material is None or item.primitive == "fluid":
        return ["", "", ""]
    return [
        number(material.friction),
        number(material.restitution) if material.restitution else "",
        number(material.rolling),
    ]


def _relations(plan: Plan, name: str) -> list[str]:
    shown = (item for item in plan.objects if item.relations and _about(name, item.name, *_refs(item)))
    return [f"where: {item.name}: {'; '.join(row.sentence() for row in item.relations)}" for item in shown]


def _refs(item: Any) -> list[str]:
    return [ref for row in item.relations for _, ref in row.refs()]


def _about(name: str, *named: str | None) -> bool:
    return not name or name in named


def _objectives(plan: Plan, name: str) -> list[str]:
    rows = []
    for objective in plan.objectives:
        if _about(name, objective.object, objective.ref):
            words = objective.sentence or " ".join(filter(None, (objective.object, objective.kind, objective.ref)))
            rows.append([objective.kind, objective.object, objective.ref or "", words])
    return table(("must", "object", "ref", "sentence"), rows) if rows else []


def _joints(plan: Plan, name: str) -> list[str]:
    rows = [
        [
            joint.name, joint.kind, joint.parent or "the world", joint.child, joint.axis,
            numbers(joint.anchor) if joint.anchor else "", numbers(joint.limits) if joint.limits else "",
            _driven(joint),
        ]
        for joint in plan.joints
        if _about(name, joint.child, joint.parent)
    ]  # fmt: skip
    head = ("joint", "kind", "parent", "child", "axis", "anchor from the child [m]", "limits", "drive")
    return table(head, rows) if rows else []


def _cords(plan: Plan, name: str) -> list[str]:
    rows = [
        [
            cord.name, cord.kind, _end(cord.a, cord.anchor_a), _end(cord.b, cord.anchor_b),
            ", ".join(f"{each.object} {each.side}" for each in cord.around or ()), number(cord.length),
            number(cord.stiffness), number(cord.damping), number(cord.rest_length),
        ]
        for cord in plan.cords
        if _about(name, cord.a, cord.b, *(each.object for each in cord.around or ()))
    ]  # fmt: skip
    head = ("cord", "kind", "from", "to", "around", "length [m]", "N/m", "N s/m", "rest length [m]")
    return table(head, rows) if rows else []


def _end(name: str | None, anchor: Vec3 | None) -> str:
    """What a cord's end is fixed to, and where."""
    return f"{name or 'the world'}{f' at {numbers(anchor)}' if anchor else ''}"


def _contacts(plan: Plan, name: str) -> list[str]:
    rows = [
        [each.object, each.ref, number(each.friction), number(each.restitution), number(each.rolling)]
        for each in plan.contacts
        if _about(name, each.object, each.ref)
    ]
    return table(("contact of", "and", "friction", "restitution", "rolling"), rows) if rows else []


def _openings(plan: Plan, name: str) -> list[str]:
    rows = [
        [each.name, each.kind, each.fluid, each.at or "", numbers(each.offset), number(each.rate)]
        for each in plan.openings
        if _about(name, each.name, each.fluid, each.at or "")
    ]
    return table(("opening", "kind", "fluid", "at", "from there [m]", "rate [m^3/s]"), rows) if rows else []


def _schedules(plan: Plan, name: str) -> list[str]:
    rows = []
    for each in plan.schedules:
        of = [each.of] if isinstance(each.of, str) else list(each.of)
        if not _about(name, *of):
            continue
        keys = zip(each.times, each.values or ("",) * len(each.times), strict=True)
        said = "; ".join(f"{number(time)} s: {_value(value)}".rstrip(": ") for time, value in keys)
        event = "" if each.after is None else each.after.model_dump_json()
        point = numbers(each.point) if each.point is not None else ""
        ramps = "yes" if each.linear or (each.linear is None and each.quantity == "position") else ""
        rows.append([each.name, " and ".join(of), each.quantity, said, ramps, point, event])
    head = ("schedule", "of", "quantity", "by time", "straight between", "at point [m]", "after")
    return table(head, rows) if rows else []


def _value(value: float | tuple[float, ...] | str) -> str:
    if isinstance(value, str):
        return value
    return number(value) if isinstance(value, float) else f"({', '.join(map(number, value))})"


def _driven(joint: Joint) -> str:
    given = joint.drive.model_dump() if joint.drive else {}
    return ", ".join(f"{name} {number(value)}" for name, value in given.items() if value)


def _cameras(plan: Plan, name: str) -> list[str]:
    rows = [
        [
            camera.name, camera.view or "", camera.of or "", numbers(camera.eye) if camera.eye else "",
            numbers(camera.target) if camera.target else "", camera.follows or "",
        ]
        for camera in plan.cameras
        if _about(name, camera.of)
    ]  # fmt: skip
    return table(("camera", "view", "of", "eye [m]", "target [m]", "follows"), rows) if rows else []


def _assumptions(plan: Plan, name: str) -> list[str]:
    return [f"assumed: {a.subject}: {a.choice} ({a.why})" for a in plan.assumptions if _about(name, a.subject)]


def _steps(plan: Plan, name: str) -> list[str]:
    return [
        f"step {k}: {step.title}: {', '.join(step.objects)}; shows {step.shows}"
        for k, step in enumerate(plan.steps, start=1)
        if _about(name, *step.objects)
    ]


TOOLS = (
    Tool(
        "read_plan",
        "The plan: objects, where they are, joints, contacts, schedules, cameras and what must happen, as tables.",
        ReadPlan, read_plan, narrow="ask for one part, or one object",
    ),
    Tool(
        "write_plan", "Check a plan, lay it out and keep it; the answer says what is wrong with it, or its places.",
        WritePlan, write_plan, writes=True, narrow="read_plan with one part shows the rest",
    ),
)  # fmt: skip
