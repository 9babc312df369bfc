"""Attributes: whether what is asked for is there, and what it is."""

from __future__ import annotations

import ast
import math
from dataclasses import fields, is_dataclass
from importlib import import_module

import numpy as np

from wsim.program.api.entry import Entry
from wsim.program.validator import imports, objects
from wsim.program.validator.state import State
from wsim.program.validator.types import class_of
from wsim.program.validator.values import UNKNOWN, Class, Const, Dict, Instance, Items, Named, Object, Value, wrapped

_SCENE = "wsim.scene.Scene"
_SHOWN = ("wsim.scene", "wsim.assets", "wsim.program.control_world")
_CONTROL = "wsim.program.control_world."
_HANDLES = ("wsim.scene.Handle", "wsim.scene.Tank", "wsim.scene.Fluid", "wsim.scene.Material", "wsim.scene.Drive",
            "wsim.scene.Track", "wsim.scene.Part", "wsim.scene.Vehicle", "wsim.scene.Terrain")  # fmt: skip


def attribute(reader: State, value: Value, name: str, node: ast.Attribute) -> Value:
    """What `value.name` is; a problem if there is no such thing."""
    if name.startswith("_") and not isinstance(value, (Object, Class)):
        return UNKNOWN
    if isinstance(value, Named) and value.owner is None:
        return _of_named(reader, value.name, name, node)
    if isinstance(value, Instance):
        return _of_instance(reader, value, name, node)
    if isinstance(value, Const):
        return _of_const(reader, value, name, node)
    if isinstance(value, (Object, Class)):
        return objects.attribute(reader, value, name, node)
    if isinstance(value, (Items, Dict)):
        kind = value.kind if isinstance(value, Items) else dict
        if not hasattr(kind, name):
            _missing(reader, node, f"builtins.{kind.__name__}", name)
        return Named(f"builtins.{kind.__name__}.{name}", value)
    return UNKNOWN


def store(reader: State, value: Value, name: str, node: ast.Attribute) -> None:
    """`value.name = ...`: only some attributes of wsim's own classes may be set."""
    kind = value.type if isinstance(value, Instance) else class_of(value.value) if isinstance(value, Const) else ""
    if name.startswith("_") or not (kind.startswith(_CONTROL + "Control") or kind in (*_HANDLES, _SCENE)):
        return
    entry = reader.member(kind, name)
    short = kind.rpartition(".")[2]
    if entry is None:
        _missing(reader, node, kind, name)
    elif not entry.extra.get("writable"):
        reader.problems.add(node, "attribute", f'"{name}" of {short} is for reading; it cannot be set')


def _of_named(reader: State, whole: str, name: str, node: ast.Attribute) -> Value:
    holder = reader.entry(whole)
    if holder is None or holder.kind not in ("module", "class"):
        return UNKNOWN
    found = reader.member(whole, name)
    if found is None:
        found = reader.entry(f"{whole}.{name}")
    if found is None:
        if whole.startswith("builtins.") or not _is_whole(reader, holder):
            return UNKNOWN
        if holder.kind == "module" and reader.index.programs.children(f"{whole}.{name}"):
            return Named(f"{whole}.{name}")
        if holder.kind == "module" and imports.is_there(f"{whole}.{name}"):
            return UNKNOWN
        _missing(reader, node, whole, name)
        return UNKNOWN
    if found.kind in ("module", "class", "function", "method"):
        return Named(found.name)
    if found.name in ("math.pi", "math.tau", "math.e", "math.inf", "math.nan", "numpy.pi", "numpy.e", "numpy.inf"):
        return Const(getattr(math, found.short))
    return _typed(reader, found, None)


def _is_whole(reader: State, holder: Entry) -> bool:
    """Whether the index has all the names of a module or class."""
    if holder.name.startswith("wsim.") and holder.kind == "module" and holder.name not in _SHOWN:
        return False  # a part of wsim's, which others show the names of
    return bool(reader.index.programs.children(holder.name)) and not holder.extra.get("partial")


def _of_instance(reader: State, value: Instance, name: str, node: ast.Attribute) -> Value:
    if value.type == _SCENE and name == "stage" and value.world is not None:
        value.world.touched()
    found = reader.member(value.type, name)
    if found is None:
        holder = reader.entry(value.type)
        inherits = value.loose and bool(reader.index.programs.ending(name))
        if holder is not None and _is_whole(reader, holder) and not inherits:
            _missing(reader, node, value.type, name)
        return UNKNOWN
    if found.kind in ("method", "function"):
        return Named(found.name, value)
    return _typed(reader, found, value.world)


def _of_const(reader: State, value: Const, name: str, node: ast.Attribute) -> Value:
    kind = class_of(value.value)
    if kind in _HANDLES:
        if not hasattr(value.value, name):
            _missing(reader, node, kind, name)
            return UNKNOWN
        return wrapped(getattr(value.value, name))
    if is_dataclass(value.value) and name in {field.name for field in fields(value.value)}:
        return wrapped(getattr(value.value, name))  # a field without a default is none of the class
    if not hasattr(type(value.value), name):
        _missing(reader, node, kind, name)
        return UNKNOWN
    return Named(f"{kind}.{name}", value)


def _typed(reader: State, found: Entry, world: object) -> Value:
    """An attribute of the class that it holds, if that is one of the index."""
    returns = found.returns
    if returns in ("float", "int", "str", "bool") and found.source == "wsim":
        return Instance(f"builtins.{returns}")
    if returns.endswith(".Vec3") and found.source == "wsim":
        return Items(tuple, [Instance("builtins.float")] * 3)
    if returns and reader.entry(returns) is not None and returns.startswith(("wsim.", "pxr.", "numpy.")):
        holder = reader.entry(returns)
        if holder is not None and holder.kind == "class":
            return Instance(returns, world)
    return UNKNOWN


def _missing(reader: State, node: ast.Attribute, holder: str, name: str) -> None:
    entry = reader.entry(holder)
    kind = "module" if entry is not None and entry.kind == "module" else "class"
    shown = holder if kind == "module" else holder.removeprefix("builtins.").rpartition(".")[2]
    advice = _former(holder, name)
    if advice:
        reader.problems.add(node, "deprecated", f"{shown}.{name} was removed: {advice}", _instead(reader, advice))
        return
    if "None" in shown:
        reader.problems.add(node, "attribute", f'this is None, which has no "{name}"')
        return
    what = "module " * (kind == "module") + shown
    reader.problems.add(node, "attribute", f'{what} has no "{name}"', reader.nearest(name, holder))


def _instead(reader: State, advice: str) -> str:
    """The signature of what an advice speaks of first."""
    for word in advice.replace("`", " ").replace("(", " ").split():
        if word.startswith("np."):
            entry = reader.entry("numpy." + word.removeprefix("np.").rstrip(".,"))
            if entry is not None:
                return entry.signature
    return ""


def _former(holder: str, name: str) -> str:
    """What NumPy itself says of a name that it no longer has."""
    if holder != "numpy":
        return ""
    try:
        expired: dict[str, str] = import_module("numpy._expired_attrs_2_0").__expired_attributes__
    except (ImportError, AttributeError):
        expired = {}
    told = str(expired.get(name) or getattr(np, "__former_attrs__", {}).get(name, ""))
    lines = [line for line in told.splitlines() if "has no attribute" not in line]
    return " ".join(" ".join(lines).split(". ")[:2]).strip().rstrip(".")[:240]
