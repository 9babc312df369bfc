"""Classes of the program itself: their objects, and what these hold."""

from __future__ import annotations

import ast
from dataclasses import replace

from wsim.program.validator import functions
from wsim.program.validator.arguments import Arguments
from wsim.program.validator.problem import spelt
from wsim.program.validator.state import State, assigned
from wsim.program.validator.values import UNKNOWN, Class, Function, Named, Object, Scope, Value

_PLAIN_BASES = ("builtins.object",)
_DATACLASS = "dataclasses.dataclass"


def define(reader: State, node: ast.ClassDef) -> None:
    """`class Name:`."""
    bases = [reader.value(each) for each in node.bases]
    for each in node.decorator_list:
        reader.value(each)
    inner = Scope(assigned(node.body), reader.scope, of_class=True)
    before, reader.scope = reader.scope, inner
    reader.block(node.body)
    reader.scope = before
    reader.bind(ast.Name(node.name), _made(reader, node, inner.values, bases))


def _made(reader: State, node: ast.ClassDef, members: dict[str, Value], bases: list[Value]) -> Value:
    """The class that a `class` statement makes."""
    decorators = [_decorator(reader, each) for each in node.decorator_list]
    whole = not node.keywords and all(each == _DATACLASS for each in decorators)
    inherited: dict[str, Value] = {}
    fields: dict[str, Value | None] = {}
    for base in bases:
        if isinstance(base, Class):
            inherited, fields = inherited | base.members, fields | (base.fields or {})
        whole = whole and (
            (isinstance(base, Class) and base.whole) or (isinstance(base, Named) and base.name in _PLAIN_BASES)
        )
    if _DATACLASS in decorators:
        for each in node.body:
            if isinstance(each, ast.AnnAssign) and isinstance(each.target, ast.Name) and not _shared(each):
                # A default that is `field(...)` says only that there is one.
                given = members.get(each.target.id, UNKNOWN) if each.value is not None else None
                fields[each.target.id] = UNKNOWN if isinstance(each.value, ast.Call) else given
    dataclass = _DATACLASS in decorators or any(isinstance(b, Class) and b.fields is not None for b in bases)
    return Class(node, inherited | members, fields if dataclass else None, whole)


def _decorator(reader: State, node: ast.expr) -> str:
    """The whole name of a decorator; "" if it is not one of the index."""
    with reader.problems.quiet():  # it was read where it stands; here its names may not be in scope
        value = reader.value(node.func if isinstance(node, ast.Call) else node)
    return value.name if isinstance(value, Named) else ""


def construct(reader: State, kind: Class, arguments: Arguments) -> Value:
    """The object that a call of a class makes."""
    made = Object(kind)
    start = kind.members.get("__init__")
    if not kind.whole or "__new__" in kind.members:
        arguments.hand_over()
        return UNKNOWN
    if isinstance(start, Function):
        functions.run(reader, replace(start, owner=made), arguments)
        return made
    if kind.fields is not None:
        _fill(reader, made, kind.fields, arguments)
        after = kind.members.get("__post_init__")
        if isinstance(after, Function):
            functions.run(reader, replace(after, owner=made), Arguments(arguments.call))
        return made
    if arguments.given or arguments.named:
        name = kind.node.name
        reader.problems.add(arguments.call, "argument", f"{name}() takes no arguments")
    return made


def _fill(reader: State, made: Object, fields: dict[str, Value | None], arguments: Arguments) -> None:
    """Give a dataclass's fields their values."""
    name = made.kind.node.name
    given = dict(zip(fields, arguments.values, strict=False))
    if len(arguments.given) > len(fields):
        text = f"{name}() takes {len(fields)} arguments, and is given {len(arguments.given)}"
        reader.problems.add(arguments.given[len(fields)][1], "argument", text)
    for key, (value, node) in arguments.named.items():
        if key not in fields:
            reader.problems.add(node, "argument", f'{name}() has no argument "{key}"; it takes {", ".join(fields)}')
        given[key] = value
    missing = [key for key, default in fields.items() if key not in given and default is None]
    if missing and not arguments.open:
        names = ", ".join(f'"{key}"' for key in missing)
        reader.problems.add(arguments.call, "argument", f"{name}() lacks {names}")
    made.fields = {key: given.get(key) or default or UNKNOWN for key, default in fields.items()}


def attribute(reader: State, value: Object | Class, name: str, node: ast.Attribute) -> Value:
    """What an attribute of a program's own object or class is."""
    kind = value if isinstance(value, Class) else value.kind
    if not kind.whole:
        return UNKNOWN
    if isinstance(value, Object) and name in value.fields:
        return UNKNOWN if reader.rounds and name in reader.stored else value.fields[name]
    found = kind.members.get(name)
    if found is None:
        dynamic = "__getattr__" in kind.members or name in reader.stored or name.startswith("_")
        if kind.whole and not dynamic and not isinstance(value, Class) and name not in (kind.fields or {}):
            text = f'{kind.node.name} has no "{name}"'
            reader.problems.add(node, "attribute", text, spelt(name, [*kind.members, *value.fields]))
        return UNKNOWN
    if not isinstance(found, Function) or isinstance(value, Class):
        return UNKNOWN if isinstance(found, Function) or name in reader.stored else found
    decorators = (
        [] if isinstance(found.node, ast.Lambda) else [_decorator(reader, d) for d in found.node.decorator_list]
    )
    bound = replace(found, owner=value, plain=not functions.yields(found.node))
    if not decorators:
        return bound
    if decorators == ["builtins.property"] or decorators == ["functools.cached_property"]:
        return functions.run(reader, bound, Arguments(ast.copy_location(ast.Call(node, [], []), node)))
    if decorators == ["builtins.staticmethod"]:
        return replace(bound, owner=None)
    return UNKNOWN


def store(reader: State, value: Object, name: str, given: Value) -> None:
    """`self.name = ...`"""
    value.fields[name] = given if reader.certain and not reader.rounds else UNKNOWN


def _shared(node: ast.AnnAssign) -> bool:
    """Whether a dataclass takes an annotated name for the class's own, and not for a field."""
    return "ClassVar" in ast.dump(node.annotation)
