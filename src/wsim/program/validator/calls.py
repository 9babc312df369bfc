"""Calls: whether their arguments fit, and what they return."""

from __future__ import annotations

import ast
from dataclasses import replace
from typing import Any

import numpy as np

from wsim.program.api.entry import Entry
from wsim.program.validator import (
    argument_units,
    control_calls,
    forbidden,
    functions,
    objects,
    plain_values,
    pure,
    scene_calls,
    usd,
)
from wsim.program.validator.arguments import Arguments, Misfit, misfit
from wsim.program.validator.state import State
from wsim.program.validator.types import fits, type_of
from wsim.program.validator.values import UNKNOWN, Class, Const, Dict, Function, Instance, Items, Named, Value

_SCENE = "wsim.scene.Scene."
_CONTROL = "wsim.program.control_world.ControlWorld."


def call(reader: State, called: Value, arguments: Arguments) -> Value:
    """What a call returns; a problem if it cannot be called, or not so."""
    if isinstance(called, Function):
        return functions.run(reader, called, arguments)
    if isinstance(called, Class):
        return objects.construct(reader, called, arguments)
    if not isinstance(called, Named):
        arguments.hand_over()
        plain_value = isinstance(called, Instance) and called.type.startswith("builtins.")
        if (plain_value or isinstance(called, (Const, Items, Dict))) and reader.certain and not _callable(called):
            reader.problems.add(arguments.call, "attribute", "this is no function; it cannot be called")
        return UNKNOWN
    entry = reader.entry(called.name)
    if entry is None or entry.kind not in ("class", "function", "method"):
        return _unlisted(reader, called, arguments)
    forbidden.check(reader, entry, arguments)
    wrong = _misfit(reader, entry, called, arguments)
    if wrong is not None:
        reader.problems.add(wrong.node, "argument", wrong.message, entry.signature)
    elif entry.deprecated:
        reader.problems.add(arguments.call, "deprecated", f"{entry.short} is deprecated: {entry.deprecated}")
    return _result(reader, entry, called, arguments, fitting=wrong is None)


def _unlisted(reader: State, called: Named, arguments: Arguments) -> Value:
    if isinstance(called.owner, (Const, Items, Dict)):
        return plain_values.method(reader, called, arguments)
    arguments.hand_over()
    return UNKNOWN


def _misfit(reader: State, entry: Entry, called: Named, arguments: Arguments) -> Misfit | None:
    def may_be(value: Value, annotation: str) -> bool:
        return fits(value, annotation, reader.index)

    if entry.kind != "method" or called.owner is not None or entry.extra.get("static"):
        return misfit(arguments, entry, may_be)
    if entry.source not in ("wsim", "pxr") or arguments.open:
        return None
    # Called on its class: what it is a method of is the first argument.
    kind = entry.parent.rpartition(".")[2]
    first = type_of(arguments.values[0]) if arguments.given else "builtins.NoneType"
    base = reader.entry(first)
    if first.startswith(("builtins.", "wsim.")) and first != entry.parent and not _inherits(base, entry.parent):
        text = f"{entry.short}() is called on the class {kind}; call it on an object: {kind}(...).{entry.short}()"
        return Misfit(arguments.call, text)
    rest = Arguments(arguments.call, arguments.given[1:], arguments.named)
    return misfit(rest, entry, may_be)


def _result(reader: State, entry: Entry, called: Named, arguments: Arguments, *, fitting: bool) -> Value:
    """What a function or class of the index gives, after what is checked of each kind of it."""
    bound = arguments.bound(entry.parameters) if entry.overloads else dict(arguments.named)
    argument_units.check(reader, entry, bound)
    if entry.name.startswith(_SCENE):
        made = scene_calls.check(reader, entry, called.owner, bound, arguments, fitting=fitting)
        return made if made is not None else _returned(reader, entry, called)
    if entry.source == "pxr" and fitting:
        usd.check(reader, entry, called.owner, bound, arguments)
        path = usd.path_of(reader, entry, called.owner, bound, arguments)
        if path and entry.returns == "pxr.Sdf.Path":
            return pure.function("pxr.Sdf.Path", [Const(path)], {})
        if path:
            made = _returned(reader, entry, called)
            return replace(made, path=path) if isinstance(made, Instance) else made
    if entry.name.startswith(_CONTROL) and fitting:
        control_calls.check(reader, entry, called.owner, bound)
    if entry.source == "numpy" and "dtype" in bound:
        _dtype(reader, *bound["dtype"])
    if called.owner is not None and isinstance(called.owner, (Const, Items, Dict)):
        return plain_values.method(reader, called, arguments)
    if entry.name in scene_calls.PLAIN and fitting:
        return Instance(entry.name) if arguments.open else scene_calls.made(entry.name, bound)
    if not arguments.open and fitting:
        named = {key: value for key, (value, _) in arguments.named.items()}
        found = reader.tried(arguments.call, lambda: pure.function(entry.name, arguments.values, named))
        if found is not UNKNOWN:
            return found
    arguments.hand_over()
    return Instance("numpy.ndarray") if _draws_several(entry, bound) else _returned(reader, entry, called)


def _returned(reader: State, entry: Entry, called: Named) -> Value:
    """What the index says that an entry returns."""
    world = called.owner.world if isinstance(called.owner, Instance) else None
    if entry.kind == "class":
        return Instance(entry.name) if entry.source in ("wsim", "pxr") else UNKNOWN
    returns = entry.returns
    if returns.startswith("list["):
        return Items(list, [], exact=False, each=Instance(returns[5:-1]))
    if entry.name == "pxr.Usd.Stage.Traverse":
        return Items(list, [], exact=False, each=Instance("pxr.Usd.Prim"))
    found = reader.entry(returns) if returns else None
    if found is None or found.kind != "class" or found.source not in ("wsim", "pxr", "numpy"):
        return UNKNOWN
    return Instance(returns, world if returns.startswith("wsim.program.") else None)


def _draws_several(entry: Entry, bound: dict[str, Any]) -> bool:
    """Whether random numbers are drawn as an array."""
    size = bound.get("size", (Const(None), None))[0]
    draws = entry.parent == "numpy.random.Generator" and entry.short not in ("choice", "integers")
    return draws and size not in (Const(None), UNKNOWN)


def _dtype(reader: State, value: Value, node: ast.AST) -> None:
    """The name of a type of numbers."""
    if isinstance(value, Const) and isinstance(value.value, str):
        try:
            np.dtype(value.value)
        except TypeError:
            reader.problems.add(node, "value", f'NumPy has no type "{value.value}"')


def _inherits(entry: Entry | None, base: str) -> bool:
    return entry is not None and base in entry.bases


def _callable(value: Value) -> bool:
    return isinstance(value, Const) and callable(value.value)
