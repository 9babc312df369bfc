"""The call that makes a suggestion's prim gets the value that is suggested."""

from __future__ import annotations

import ast
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from wsim.program.compose import compose
from wsim.program.mend.text import NotMendedError, Source, keyword, made_by, makes, method
from wsim.program.mend.unroll import unrolled

if TYPE_CHECKING:
    from wsim.judge.verdict import RepairTarget
    from wsim.plan.schema import Plan

OF_THE_RUN = ("duration", "time_step", "frame_rate", "gravity")
SIZES = {
    "box": ("size",), "sphere": ("radius",), "cylinder": ("radius", "height"), "capsule": ("radius", "height"),
    "tank": ("inner_size",), "fluid": ("size",),
}  # fmt: skip
AS_PLANNED = ("shape", "role", "kind")  # what one value does not say: the plan's own object or joint
ADDED = ("missing object", "joint", "drive")


def mended(program: str, target: RepairTarget, plan: Plan | None = None) -> str:
    """The program with a suggestion applied as it stands.

    Args:
        program: Its text; what the suggestion does not name stays as it was written.
        target: The suggestion.
        plan: Where what is missing comes from, or what is another than planned.

    Raises:
        NotMendedError: The suggestion has no value, the program no such call, or the plan no such object.
    """
    name = _object(target.prim) if target.prim else ""
    if name:  # an object that a loop makes has no call of its own
        source = Source(program)
        if name not in map(made_by, source.calls()):
            program = unrolled(program, name)
    source = Source(program)
    if target.direction == "add" and not _valued(target):
        _add(source, target, plan)
    elif target.direction == "remove":
        _remove(source, target)
    elif target.parameter in AS_PLANNED:
        _replace(source, target, plan)
    elif _valued(target):
        _set(source, target)
    else:
        raise NotMendedError("the suggestion has no value")
    return source.text


def _valued(target: RepairTarget) -> bool:
    return target.suggested is not None or target.vector is not None or bool(target.text)


def _object(prim: str | None) -> str:
    if not prim:
        raise NotMendedError("the suggestion names no prim")
    return prim.split("/")[2] if prim.count("/") > 1 else prim.strip("/")


# ---- values
def _set(source: Source, target: RepairTarget) -> None:
    parameter = target.parameter
    value = target.vector if target.vector is not None else target.suggested
    if parameter in OF_THE_RUN:
        run = [call for call in source.calls() if method(call) == "simulation"]
        if run:
            source.put(run[-1], parameter, value)
        else:
            source.insert(None, f"scene.simulation({parameter}={value!r})")
        return
    if parameter.startswith("path."):
        _keys(source, target)
        return
    call = source.call(_object(target.prim))
    if ", " in parameter:
        _several(source, call, parameter.split(", "), target)
    elif parameter.startswith("drive."):
        _drive(source, call, parameter.partition(".")[2], target)
    elif "." in parameter:
        _component(source, call, parameter, target)
    elif parameter == "size":
        _size(source, call, target)
    elif target.vector is not None or target.text:
        source.put(call, parameter, target.vector if target.vector is not None else target.text)
    else:
        _number(source, call, parameter, float(target.suggested or 0.0))


def _literal(source: Source, call: ast.Call, name: str, otherwise: object = None) -> object:
    found = keyword(call, name)
    if found is None:
        return otherwise
    try:
        return ast.literal_eval(found)
    except ValueError as error:
        raise NotMendedError(f"{name} is not written as numbers: {source.said(found)}") from error


def _number(source: Source, call: ast.Call, parameter: str, value: float) -> None:
    now = _literal(source, call, parameter) if parameter in ("velocity", "position") else None
    if isinstance(now, tuple):
        size = math.sqrt(sum(x * x for x in now))
        if size == 0.0:
            raise NotMendedError(f"{parameter} has no direction")
        source.put(call, parameter, tuple(x * value / size for x in now))
        return
    other = {"density": "mass", "mass": "density"}.get(parameter)
    held = keyword(call, other) if other else None
    if other and held is not None and keyword(call, parameter) is None:
        named = next(each for each in call.keywords if each.arg == other)
        source.replace(named, f"{parameter}={value!r}")
        return
    if other and held is not None:
        source.drop(call, other)
    source.put(call, parameter, value)


def _keys(source: Source, target: RepairTarget) -> None:
    """Three numbers at each key of a path, behind one another."""
    name, values = _object(target.prim), target.vector or ()
    paths = [call for call in source.calls() if method(call) == "path" and call.args]
    made = [call for call in paths if _named(source, call.args[0]) == name]
    if not made:
        raise NotMendedError(f"no call gives {name} a path")
    source.put(
        made[0], target.parameter.partition(".")[2], [tuple(values[k : k + 3]) for k in range(0, len(values), 3)]
    )


def _named(source: Source, node: ast.expr) -> str:
    """The object that an argument means: its name, or the variable that holds its handle."""
    if isinstance(node, ast.Constant):
        return str(node.value)
    held = [each for each in ast.walk(ast.parse(source.text)) if isinstance(each, ast.Assign)]
    said = source.said(node)
    return next((made_by(each.value) for each in held if any(ast.unparse(to) == said for to in each.targets)), "")


def _several(source: Source, call: ast.Call, names: list[str], target: RepairTarget) -> None:
    """Vectors of three numbers each, behind one another."""
    if target.vector is None:
        raise NotMendedError("the suggestion has no values")
    for k, name in enumerate(names):
        source.put(call, name, tuple(target.vector[3 * k : 3 * k + 3]))


def _size(source: Source, call: ast.Call, target: RepairTarget) -> None:
    names = SIZES.get(method(call))
    if names is None or target.vector is None:
        raise NotMendedError("the suggested size is not whole")
    if len(names) == 1 and len(target.vector) > 1:
        source.put(call, names[0], target.vector)
    else:
        for name, value in zip(names, target.vector, strict=True):
            source.put(call, name, value)


def _component(source: Source, call: ast.Call, parameter: str, target: RepairTarget) -> None:
    name, axis = parameter.split(".")
    now = _literal(source, call, name, (0.0, 0.0, 0.0))
    if not isinstance(now, tuple) or target.suggested is None or axis not in "xyz":
        raise NotMendedError(f"{name} is no vector")
    values: Sequence[float] = [float(x) for x in now]
    source.put(call, name, tuple(target.suggested if i == "xyz".index(axis) else x for i, x in enumerate(values)))


def _drive(source: Source, call: ast.Call, name: str, target: RepairTarget) -> None:
    drive = keyword(call, "drive")
    if not isinstance(drive, ast.Call) or target.suggested is None:
        raise NotMendedError("the joint has no drive written out")
    turns = target.unit.startswith("rad")
    source.put(drive, name, math.degrees(target.suggested) if turns else target.suggested)


# ---- statements
def _planned(plan: Plan | None) -> Source:
    if plan is None:
        raise NotMendedError("there is no plan to take it from")
    return Source(unrolled(compose(plan)))


def _add(source: Source, target: RepairTarget, plan: Plan | None) -> None:
    """What the plan has and the program lacks, as the plan's own program has it."""
    if target.kind not in ADDED:
        raise NotMendedError("the suggestion does not say what is to be added")
    planned = _planned(plan)
    names = [name for name in (target.parameter, _object(target.prim)) if name]
    wanted = next((each for name in names for each in planned.build.body if makes(each) == name), None)
    if wanted is None:
        raise NotMendedError("the plan's program has no such call")
    views = ("camera", "simulation")
    before = next((s for s in source.build.body if any(method(n) in views for n in ast.walk(s))), None)
    source.insert(before, "\n".join(_with_needs(source, planned, wanted)))


def _with_needs(source: Source, planned: Source, wanted: ast.stmt) -> list[str]:
    """A statement of the plan's program, behind those that it needs and the program has not."""
    has, lines = _stored(source.build), []
    needs = {node.id for node in ast.walk(wanted) if isinstance(node, ast.Name)} - has
    for each in planned.build.body:
        made = _stored(each)
        if each is wanted or not made & needs:
            continue
        held = next((s for s in source.build.body if makes(each) and makes(s) == makes(each)), None)
        if isinstance(held, ast.Expr):  # the program makes it, and does not keep it
            source.replace(held, f"{next(iter(made))} = {source.said(held)}")
        else:
            lines += _with_needs(source, planned, each)
    return [*lines, planned.statement(wanted)]


def _stored(node: ast.AST) -> set[str]:
    """Names that are given a value."""
    return {each.id for each in ast.walk(node) if isinstance(each, ast.Name) and isinstance(each.ctx, ast.Store)}


def _remove(source: Source, target: RepairTarget) -> None:
    name = _object(target.prim)
    call = source.call(name)
    if target.parameter:
        if not [each for each in (target.parameter, f"{target.parameter}_deg") if source.drop(call, each)]:
            raise NotMendedError(f"the call has no {target.parameter}")
        return
    gone = [each for each in source.build.body if makes(each) == name]
    held = {name for each in gone for name in _stored(each)}
    for each in source.build.body:
        uses = {node.id for node in ast.walk(each) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load)}
        if each in gone or uses & held:
            source.remove(each)


def _replace(source: Source, target: RepairTarget, plan: Plan | None) -> None:
    """An object that is another than the plan's, made as the plan's program makes it."""
    name, planned = _object(target.prim), _planned(plan)
    wanted = next((each for each in planned.build.body if makes(each) == name), None)
    now = next((each for each in source.build.body if makes(each) == name), None)
    if wanted is None or now is None:
        raise NotMendedError(f"the plan's program has no {name!r}")
    *needs, statement = _with_needs(source, planned, wanted)
    if needs:
        source.insert(now, "\n".join(needs))
    source.rewrite(now, statement)
