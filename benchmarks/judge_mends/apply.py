"""A suggestion of the judge, applied to a program's text: the call that makes the prim gets the suggested value."""

from __future__ import annotations

import ast
import math
from collections.abc import Sequence

from benchmarks.judge_mends.unroll import unrolled
from wsim.judge.verdict import RepairTarget
from wsim.plan.schema import Plan
from wsim.program.compose import compose

OF_THE_RUN = ("duration", "time_step", "frame_rate", "gravity")
SIZES = {
    "box": ("size",), "sphere": ("radius",), "cylinder": ("radius", "height"), "capsule": ("radius", "height"),
    "tank": ("inner_size",), "fluid": ("size",),
}  # fmt: skip
AS_PLANNED = ("shape", "role", "kind")  # what one value does not say: the plan's own object or joint


class NotAppliedError(ValueError):
    """The suggestion says too little, or names what the program does not have."""


def applied(program: str, target: RepairTarget, plan: Plan) -> str:
    """The program with a suggestion applied as it stands, by nobody's judgement.

    Raises:
        NotAppliedError: It has no value, or the program no such call.
    """
    tree = ast.parse(program)
    build = next(node for node in tree.body if isinstance(node, ast.FunctionDef) and node.name == "build")
    if target.direction == "add" and not _valued(target):
        _add(build, target, plan)
    elif target.direction == "remove":
        _remove(build, target)
    elif target.parameter in AS_PLANNED:
        _replace(build, target, plan)
    elif _valued(target):
        _set(build, target)
    else:
        raise NotAppliedError("the suggestion has no value")
    return ast.unparse(ast.fix_missing_locations(tree)) + "\n"


def _valued(target: RepairTarget) -> bool:
    return target.suggested is not None or target.vector is not None or bool(target.text)


# ---- calls
def _method(node: ast.AST) -> str:
    """The name of a call on the scene; nothing of another node."""
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and isinstance(node.func.value, ast.Name):
        return node.func.attr if node.func.value.id == "scene" else ""
    return ""


def _named(node: ast.AST) -> str:
    """The prim that a call makes."""
    if not _method(node) or _method(node) in ("material", "param") or not isinstance(node, ast.Call) or not node.args:
        return ""
    first = node.args[0]
    return first.value if isinstance(first, ast.Constant) and isinstance(first.value, str) else ""


def _call(build: ast.FunctionDef, name: str) -> ast.Call:
    for node in ast.walk(build):
        if isinstance(node, ast.Call) and _named(node) == name:
            return node
    raise NotAppliedError(f"no call of the program makes {name!r}")


def _run(build: ast.FunctionDef) -> ast.Call:
    found = [node for node in ast.walk(build) if isinstance(node, ast.Call) and _method(node) == "simulation"]
    if not found:
        build.body.append(ast.parse("scene.simulation()").body[0])
        return build.body[-1].value  # type: ignore[attr-defined, no-any-return]
    return found[-1]


def _keyword(call: ast.Call, name: str) -> ast.expr | None:
    return next((keyword.value for keyword in call.keywords if keyword.arg == name), None)


def _put(call: ast.Call, name: str, value: object) -> None:
    call.keywords = [keyword for keyword in call.keywords if keyword.arg != name]
    call.keywords.append(ast.keyword(name, ast.parse(repr(value), mode="eval").body))


def _literal(call: ast.Call, name: str, otherwise: object = None) -> object:
    found = _keyword(call, name)
    if found is None:
        return otherwise
    try:
        return ast.literal_eval(found)
    except ValueError as error:
        raise NotAppliedError(f"{name} is not written as numbers") from error


def _object(prim: str | None) -> str:
    if not prim:
        raise NotAppliedError("the suggestion names no prim")
    return prim.split("/")[2] if prim.count("/") > 1 else prim.strip("/")


# ---- values
def _set(build: ast.FunctionDef, target: RepairTarget) -> None:
    parameter = target.parameter
    if parameter in OF_THE_RUN:
        _put(_run(build), parameter, target.vector if target.vector is not None else target.suggested)
        return
    call = _call(build, _object(target.prim))
    if ", " in parameter:
        _several(call, parameter.split(", "), target)
    elif parameter.startswith("drive."):
        _drive(call, parameter.partition(".")[2], target)
    elif "." in parameter:
        _component(call, parameter, target)
    elif parameter == "size":
        _size(call, target)
    elif target.vector is not None or target.text:
        _put(call, parameter, target.vector if target.vector is not None else target.text)
    else:
        _number(call, parameter, float(target.suggested or 0.0))


def _number(call: ast.Call, parameter: str, value: float) -> None:
    now = _literal(call, parameter) if parameter in ("velocity", "position") else None
    if isinstance(now, tuple):
        size = math.sqrt(sum(x * x for x in now))
        if size == 0.0:
            raise NotAppliedError(f"{parameter} has no direction")
        _put(call, parameter, tuple(round(x * value / size, 6) for x in now))
        return
    other = {"density": "mass", "mass": "density"}.get(parameter)
    call.keywords = [keyword for keyword in call.keywords if keyword.arg != other]
    _put(call, parameter, value)


def _several(call: ast.Call, names: list[str], target: RepairTarget) -> None:
    """Vectors of three numbers each, behind one another."""
    if target.vector is None:
        raise NotAppliedError("the suggestion has no values")
    for k, name in enumerate(names):
        _put(call, name, tuple(target.vector[3 * k : 3 * k + 3]))


def _size(call: ast.Call, target: RepairTarget) -> None:
    names = SIZES.get(_method(call))
    if names is None or target.vector is None:
        raise NotAppliedError("the suggested size is not whole")
    if len(names) == 1 and len(target.vector) > 1:
        _put(call, names[0], target.vector)
    else:
        for name, value in zip(names, target.vector, strict=True):
            _put(call, name, value)


def _component(call: ast.Call, parameter: str, target: RepairTarget) -> None:
    name, axis = parameter.split(".")
    now = _literal(call, name, (0.0, 0.0, 0.0))
    if not isinstance(now, tuple) or target.suggested is None:
        raise NotAppliedError(f"{name} is no vector")
    values: Sequence[float] = [float(x) for x in now]
    k = "xyz".index(axis)
    _put(call, name, tuple(target.suggested if i == k else x for i, x in enumerate(values)))


def _drive(call: ast.Call, name: str, target: RepairTarget) -> None:
    drive = _keyword(call, "drive")
    if not isinstance(drive, ast.Call) or target.suggested is None:
        raise NotAppliedError("the joint has no drive written out")
    turns = target.unit.startswith("rad")
    _put(drive, name, math.degrees(target.suggested) if turns else target.suggested)


# ---- statements
def _makes(statement: ast.stmt) -> str:
    return next((name for node in ast.walk(statement) if (name := _named(node))), "")


def _statements(plan: Plan) -> list[ast.stmt]:
    tree = ast.parse(unrolled(compose(plan)))
    build = next(node for node in tree.body if isinstance(node, ast.FunctionDef) and node.name == "build")
    return build.body


def _add(build: ast.FunctionDef, target: RepairTarget, plan: Plan) -> None:
    """What the plan has and the program lacks, as the plan's own program has it."""
    if target.kind not in ("missing object", "joint", "drive"):
        raise NotAppliedError("the suggestion does not say what is to be added")
    names = [_object(target.prim), target.parameter]
    planned = _statements(plan)
    wanted = next((each for name in reversed(names) for each in planned if name and _makes(each) == name), None)
    if wanted is None:
        raise NotAppliedError("the plan's program has no such call")
    _take(build, planned, wanted)


def _take(build: ast.FunctionDef, planned: list[ast.stmt], wanted: ast.stmt) -> None:
    """A statement of the plan's program, and those before it that it needs."""
    has = {node.id for node in ast.walk(build) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)}
    needs = {node.id for node in ast.walk(wanted) if isinstance(node, ast.Name)} - has
    for each in planned:
        made = {node.id for node in ast.walk(each) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)}
        if made & needs and each is not wanted:
            _held(build, _makes(each), next(iter(made))) or _take(build, planned, each)
    last = next((k for k, each in enumerate(build.body) if _makes_view(each)), len(build.body))
    build.body.insert(last, wanted)


def _held(build: ast.FunctionDef, name: str, variable: str) -> bool:
    """Whether the program makes that prim already; then it is called by the variable."""
    for k, each in enumerate(build.body):
        if name and _makes(each) == name and isinstance(each, ast.Expr):
            build.body[k] = ast.Assign([ast.Name(variable, ast.Store())], each.value)
            return True
    return False


def _makes_view(statement: ast.stmt) -> bool:
    return any(_method(node) in ("camera", "simulation") for node in ast.walk(statement))


def _remove(build: ast.FunctionDef, target: RepairTarget) -> None:
    call = _call(build, _object(target.prim))
    if target.parameter:
        names = (target.parameter, f"{target.parameter}_deg")
        kept = [keyword for keyword in call.keywords if keyword.arg not in names]
        if len(kept) == len(call.keywords):
            raise NotAppliedError(f"the call has no {target.parameter}")
        call.keywords = kept
        return
    name = _object(target.prim)
    gone = [each for each in build.body if _makes(each) == name]
    held = {node.id for each in gone for node in ast.walk(each) if isinstance(node, ast.Name) and
            isinstance(node.ctx, ast.Store)}  # fmt: skip
    build.body = [
        each for each in build.body
        if each not in gone and not any(isinstance(n, ast.Name) and n.id in held for n in ast.walk(each))
    ]  # fmt: skip


def _replace(build: ast.FunctionDef, target: RepairTarget, plan: Plan) -> None:
    """An object that is another than the plan's, made as the plan's program makes it."""
    name = _object(target.prim)
    planned = _statements(plan)
    wanted = next((each for each in planned if _makes(each) == name), None)
    k = next((k for k, each in enumerate(build.body) if _makes(each) == name), None)
    if wanted is None or k is None:
        raise NotAppliedError(f"the plan's program has no {name!r}")
    build.body[k] = wanted
