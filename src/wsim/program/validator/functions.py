"""Functions of the program itself: read where they are called, with what they are given there."""

from __future__ import annotations

import ast

from wsim.program.validator.arguments import Arguments
from wsim.program.validator.state import State, assigned
from wsim.program.validator.values import UNKNOWN, Const, Function, Instance, Named, Scope, Value, merged

_DEEPEST = 12


def define(reader: State, node: ast.FunctionDef | ast.AsyncFunctionDef) -> None:
    """`def name(...):`; the body is read where it is called."""
    for each in node.decorator_list:
        reader.value(each)
    defaults = [*node.args.defaults, *(each for each in node.args.kw_defaults if each is not None)]
    values = {id(each): reader.value(each) for each in defaults}
    takers = [*node.args.posonlyargs, *node.args.args]
    pairs = [*zip(takers[len(takers) - len(node.args.defaults) :], node.args.defaults, strict=True)]
    pairs += [(a, d) for a, d in zip(node.args.kwonlyargs, node.args.kw_defaults, strict=True) if d is not None]
    simple = not node.decorator_list and isinstance(node, ast.FunctionDef) and not yields(node)
    made = Function(node, reader.scope, {a.arg: values[id(d)] for a, d in pairs}, simple)
    reader.functions.append(made)
    reader.bind(ast.Name(node.name), made)


def yields(node: ast.AST) -> bool:
    """Whether a function is a generator or a coroutine."""
    return any(isinstance(each, (ast.Yield, ast.YieldFrom, ast.Await)) for each in ast.walk(node))


def run(reader: State, function: Function, arguments: Arguments) -> Value:
    """Read a function of the program as it is called here, and give what it returns."""
    if not function.plain or reader.depth >= _DEEPEST or reader.steps <= 0:
        arguments.hand_over()
        return UNKNOWN
    given = _given(reader, function, arguments)
    return enter(reader, function, given)


def _given(reader: State, function: Function, arguments: Arguments) -> dict[str, Value]:
    """The function's arguments by name; a problem where they do not fit."""
    a = function.node.args
    places = [each.arg for each in (*a.posonlyargs, *a.args)]
    bound: dict[str, Value] = {}
    if function.owner is not None and places:
        bound, places = {places[0]: function.owner}, places[1:]
    keywords = [each.arg for each in (*a.args, *a.kwonlyargs)]
    name = getattr(function.node, "name", "lambda")
    given = dict(zip(places, arguments.values, strict=False))
    if len(arguments.given) > len(places) and a.vararg is None:
        node = arguments.given[len(places)][1]
        text = f"{name}() takes {len(places)} positional arguments, and is given {len(arguments.given)}"
        reader.problems.add(node, "argument", text)
    for key, (value, node) in arguments.named.items():
        if key not in keywords and a.kwarg is None:
            reader.problems.add(node, "argument", f'{name}() has no argument "{key}"')
        elif key in keywords:
            given[key] = value
    required = [p for p in (*places, *(each.arg for each in a.kwonlyargs)) if p not in function.defaults]
    if isinstance(function.node, ast.Lambda):
        required = [] if a.defaults or a.kw_defaults else required
    missing = [p for p in required if p not in given]
    if missing and not arguments.open:
        names = ", ".join(f'"{p}"' for p in missing)
        reader.problems.add(arguments.call, "argument", f"{name}() lacks {names}")
    return given | bound


def enter(reader: State, function: Function, given: dict[str, Value], *, called: bool = True) -> Value:
    """Read a function's body with these arguments; where it is not `called` here, the others may be anything."""
    node = function.node
    reader.called.add(node)
    body: list[ast.stmt] = [ast.Return(node.body)] if isinstance(node, ast.Lambda) else node.body
    scope = Scope(assigned(body) | frozenset(each.arg for each in ast.walk(node.args) if isinstance(each, ast.arg)))
    scope.outer = function.scope
    for each in ast.walk(node.args):
        if isinstance(each, ast.arg):
            default = function.defaults.get(each.arg) if called else None
            scope.values[each.arg] = given.get(each.arg) or default or _annotated(reader, each)
    before = reader.scope, reader.certain
    reader.scope = scope
    reader.depth += 1
    reader.returned.append([])
    try:
        flow = reader.block(body)
    finally:
        reader.scope, reader.certain = before
        reader.depth -= 1
        returned = reader.returned.pop()
    if flow == "on":
        returned.append(Const(None))
    result = returned[0] if returned else UNKNOWN
    for each_value in returned[1:]:
        result = merged(result, each_value)
    return result


def _annotated(reader: State, argument: ast.arg) -> Value:
    """What an argument is by its annotation alone."""
    if argument.annotation is None:
        return UNKNOWN
    with reader.problems.quiet():
        if isinstance(argument.annotation, ast.Constant) and isinstance(argument.annotation.value, str):
            try:
                found = reader.value(ast.parse(argument.annotation.value, mode="eval").body)
            except SyntaxError:
                return UNKNOWN
        else:
            found = reader.value(argument.annotation)
    entry = reader.entry(found.name) if isinstance(found, Named) else None
    if entry is None or entry.kind != "class" or entry.source not in ("wsim", "pxr"):
        return UNKNOWN
    return Instance(entry.name, loose=True)
