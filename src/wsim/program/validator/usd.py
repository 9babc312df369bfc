"""USD's strings: names of attributes and schemas, paths of prims, and values of attributes."""

from __future__ import annotations

import ast
import re
from difflib import get_close_matches
from functools import lru_cache
from typing import Any

from pxr import Sdf

from wsim.program.api.entry import Entry
from wsim.program.api.lookup import Index
from wsim.program.validator.arguments import Arguments
from wsim.program.validator.problem import spelt
from wsim.program.validator.state import State
from wsim.program.validator.types import class_of
from wsim.program.validator.values import UNKNOWN, Const, Instance, Items, Value

_NAMESPACES = ("physics:", "newton:", "wsim:", "drive:", "limit:", "primvars:display", "inputs:diffuse")
_READS = ("GetAttribute", "HasAttribute", "CreateAttribute", "GetRelationship", "CreateRelationship", "GetProperty")
_APPLIES = ("ApplyAPI", "AddAppliedSchema", "HasAPI", "RemoveAPI", "CanApplyAPI")
_MAKES = re.compile(r"^(Define|DefinePrim|OverridePrim|CreateClassPrim)$")
_SPREADS = ("GetRootLayer", "GetEditTarget", "GetReferences", "GetPayloads", "RemovePrim", "GetSessionLayer")
# Attributes that cannot be below zero.
_NOT_NEGATIVE = (
    "mass", "density", "radius", "height", "size", "width", "length", "staticFriction", "dynamicFriction",
    "restitution", "intensity", "focalLength", "damping", "stiffness", "maxForce",
)  # fmt: skip
_ATTRIBUTE = re.compile(r"^(Create|Get)\w+Attr$")
# The degrees of freedom of a joint, as UsdPhysics names them.
_FREEDOMS = ("transX", "transY", "transZ", "rotX", "rotY", "rotZ", "distance", "linear", "angular")
_NUMBERS = ("float", "double", "int", "half", "uint")


def check(reader: State, entry: Entry, owner: Value | None, bound: dict[str, Any], arguments: Arguments) -> None:
    """What USD itself would find out only when the program runs."""
    first = arguments.given[0] if arguments.given else next(iter(arguments.named.values()), (UNKNOWN, arguments.call))
    if entry.short in _READS and entry.parent.startswith("pxr.Usd.Prim"):
        _attribute_name(reader, entry.short, *first)
    elif entry.short in _APPLIES:
        _schema_name(reader, entry.short, *first)
    elif _MAKES.match(entry.short):
        _makes(reader, entry, bound, arguments)
    elif entry.short == "GetPrimAtPath" and isinstance(owner, Instance) and owner.type == "pxr.Usd.Stage":
        _finds(reader, *first)
    elif entry.short in _SPREADS:
        reader.world.open = True
    elif entry.short.startswith("Create") and _ATTRIBUTE.match(entry.short) and (arguments.given or arguments.named):
        _value(reader, entry, _attribute_of(reader, entry), *bound.get("defaultValue", first))
    elif entry.name == "pxr.Usd.Attribute.Set" and isinstance(owner, Instance) and "value" in bound:
        _value(reader, entry, reader.entry(owner.path), *bound["value"])
    elif entry.name == "pxr.Sdf.ValueTypeNames.Find":
        _value_type(reader, *first)
    elif entry.short == "Apply":
        _applied(reader, entry, first[0], arguments.call)
        if "name" in bound:
            _instance_name(reader, entry, *bound["name"])


def _value_type(reader: State, value: Value, node: ast.AST) -> None:
    """The name of a type of attributes."""
    if isinstance(value, Const) and isinstance(value.value, str) and not Sdf.ValueTypeNames.Find(value.value):
        reader.problems.add(node, "value", f'USD has no type "{value.value}"')


def _applied(reader: State, entry: Entry, prim: Value, node: ast.AST) -> None:
    """A prim of USD's own that collides or moves is an object of the world."""
    if entry.parent.endswith(("RigidBodyAPI", "CollisionAPI")) and isinstance(prim, Instance) and reader.certain:
        name = prim.path.removeprefix("/World/")
        if prim.path != name and name and "/" not in name:
            reader.world.raw.setdefault(name, node)


def _attribute_name(reader: State, call: str, value: Value, node: ast.AST) -> None:
    if not isinstance(value, Const) or not isinstance(value.value, str):
        return
    name = value.value
    if call != "CreateAttribute" and f"inputs:{name}" in _attributes(reader.index)[0]:
        if name not in _attributes(reader.index)[0] and reader.written.count(name) == 1:
            message = f'no schema has an attribute "{name}"'
            reader.problems.add(node, "attribute", message, f'"inputs:{name}"')
        return
    if not name.startswith(_NAMESPACES) or reader.written.count(name) > 1:
        return
    known, patterns = _attributes(reader.index)
    if name in known or any(pattern.fullmatch(name) for pattern in patterns):
        return
    space, _, last = name.rpartition(":")
    beside = [each.rpartition(":")[2] for each in known if each.rpartition(":")[0] == space]
    close = get_close_matches(last, beside, n=1, cutoff=0.75)
    if close:  # a namespace takes attributes of one's own too
        reader.problems.add(node, "attribute", f'no schema has an attribute "{name}"', f'"{space}:{close[0]}"')


@lru_cache(maxsize=2)
def _attributes(index: Index) -> tuple[frozenset[str], tuple[re.Pattern[str], ...]]:
    """The attributes of all schemas, and patterns of those of which one schema has several."""
    names = index.programs.schema_attributes()
    patterns = tuple(re.compile(re.escape(name).replace(r"\*", r"[\w:]+")) for name in names if "*" in name)
    return frozenset(name for name in names if "*" not in name), patterns


def _schema_name(reader: State, call: str, value: Value, node: ast.AST) -> None:
    if not isinstance(value, Const) or not isinstance(value.value, str):
        return
    entry = reader.entry(value.value.partition(":")[0])
    if entry is None or entry.kind != "schema":
        known = reader.index.programs.schemas()
        if call != "ApplyAPI" and not get_close_matches(value.value, known, n=1, cutoff=0.88):
            return  # a stage may name schemas that are not installed
        reader.problems.add(node, "name", f'no schema "{value.value}" is installed', spelt(value.value, known))


def _makes(reader: State, entry: Entry, bound: dict[str, Any], arguments: Arguments) -> None:
    """A prim that is made without the scene's calls."""
    world = reader.world
    world.touched()
    value, node = bound.get("path", (UNKNOWN, arguments.call))
    text = _path(value)
    if not text:
        world.open = True
    else:
        world.others.update(text.removeprefix("/World/").split("/")[:1])
        if not re.fullmatch(r"(/[A-Za-z_]\w*)+", text) and text != "/":
            message = f'"{text}" is no path of a prim; it starts with / and has letters, digits and _ only'
            reader.problems.add(node, "value", message, '"/World/name"')
    kind, kind_node = bound.get("typeName", (UNKNOWN, arguments.call))
    if entry.short == "DefinePrim" and isinstance(kind, Const) and isinstance(kind.value, str) and kind.value:
        found = reader.entry(kind.value)
        if found is None or found.kind != "schema":
            close = spelt(kind.value, reader.index.programs.schemas())
            if close:
                reader.problems.add(kind_node, "name", f'no schema "{kind.value}" is installed', close)


def _schema_attribute(reader: State, name: str) -> str:
    """The whole name of the schema attribute of this name, if there is one alone."""
    found = [each for each in reader.index.programs.ending(name) if each.rpartition(".")[2] == name]
    return found[0] if len(found) == 1 else ""


def path_of(reader: State, entry: Entry, owner: Value | None, bound: dict[str, Any], arguments: Arguments) -> str:
    """Where the prim is that a call makes, finds or speaks of; of an attribute, its name in the index; or ""."""
    if entry.returns == "pxr.Usd.Attribute":
        if _ATTRIBUTE.match(entry.short):
            found = _attribute_of(reader, entry)
            return found.name if found is not None else ""
        name = bound.get("attrName", (UNKNOWN, None))[0]
        known = (
            isinstance(name, Const)
            and isinstance(name.value, str)
            and entry.short in ("GetAttribute", "CreateAttribute")
        )
        return _schema_attribute(reader, name.value) if known and isinstance(name, Const) else ""
    if entry.short in ("GetPrim", "GetPath", "GetPrimPath") and isinstance(owner, Instance):
        return owner.path
    if entry.short == "GetDefaultPrim" and isinstance(owner, Instance) and owner.world is not None:
        return "/World"
    if _MAKES.match(entry.short) or entry.short == "GetPrimAtPath":
        return _path(bound.get("path", (UNKNOWN, None))[0])
    first = arguments.values[0] if arguments.given else UNKNOWN
    if isinstance(first, Instance) and first.path and (entry.kind == "class" or entry.short in ("Apply", "Get")):
        return first.path
    return ""


def _path(value: Value) -> str:
    """A path that is given as text or as a path; "" if it is not known."""
    if isinstance(value, Const) and (isinstance(value.value, str) or type(value.value).__name__ == "Path"):
        return str(value.value)
    return ""


def _finds(reader: State, value: Value, node: ast.AST) -> None:
    """A prim that is looked for by its path: one that is spelt nearly like one that is there, and is not, is a slip."""
    world, text = reader.world, _path(value)
    if not text.startswith("/World/") or world.open or not reader.certain:
        return
    name = text.removeprefix("/World/").split("/")[0]
    known = {*world.names, *world.others, "Looks", "Parameters", "PhysicsScene"}
    if name in known:
        return
    close = get_close_matches(name, known, n=1, cutoff=0.6)
    if close and reader.written.count(name) == 0:
        reader.problems.add(node, "prim", f'no prim "{text}" has been made', f'"/World/{close[0]}"')


def _value(reader: State, entry: Entry, attribute: Entry | None, value: Value, node: ast.AST) -> None:
    """A value that an attribute is given."""
    if not isinstance(value, (Const, Items)) or (isinstance(value, Const) and value.value is None):
        return
    number = isinstance(value, Const) and isinstance(value.value, (int, float)) and not isinstance(value.value, bool)
    base = attribute.short.rpartition(":")[2] if attribute is not None else ""
    if number and isinstance(value, Const) and base in _NOT_NEGATIVE and value.value < 0:
        message = f'"{base}" = {value.value:g} must not be below 0'
        reader.problems.add(node, "value", message, entry.signature)
        return
    kind = attribute.returns if attribute is not None else ""
    if _is_wrong(kind, value):
        reader.problems.add(node, "argument", f'"{base}" takes a {kind}', entry.signature)
        return
    allowed = attribute.extra.get("allowed") if attribute is not None else None
    if allowed and isinstance(value, Const) and value.value not in allowed:
        message = f'"{base}" = "{value.value}" must be one of {", ".join(allowed)}'
        reader.problems.add(node, "value", message, spelt(str(value.value), allowed, 0.5))


def _is_wrong(kind: str, value: Const | Items) -> bool:
    """Whether USD takes no such value for an attribute of a kind."""
    text = isinstance(value, Const) and isinstance(value.value, str)
    if kind in _NUMBERS:
        return isinstance(value, Items) or text
    if re.fullmatch(r"(float|double|half|vector|point|color|normal)3[fdh]?", kind):
        return not _three(value)
    if kind in ("quatf", "quatd", "quath"):
        return isinstance(value, Items) or class_of(value.value).startswith("builtins.")
    if re.fullmatch(r"\w+3[fdh]?\[\]", kind):
        return isinstance(value, Items) and _has_numbers(value)
    return kind in ("token", "string") and not text


def _instance_name(reader: State, entry: Entry, value: Value, node: ast.AST) -> None:
    """Which freedom of a joint a drive or a limit is for."""
    if entry.parent not in ("pxr.UsdPhysics.DriveAPI", "pxr.UsdPhysics.LimitAPI"):
        return
    if isinstance(value, Const) and isinstance(value.value, str) and value.value not in _FREEDOMS:
        kind = entry.parent.rpartition(".")[2]
        message = f'{kind} has no "{value.value}"; it takes {", ".join(_FREEDOMS)}'
        reader.problems.add(node, "value", message, entry.signature)


def _three(value: Const | Items) -> bool:
    if isinstance(value, Items):
        # USD makes a vector of a tuple, and not of a list.
        return value.kind is tuple and (not value.exact or len(value.items) == 3)
    return not isinstance(value.value, (int, float, str))


def _has_numbers(value: Items) -> bool:
    """Whether its items are numbers, where they must be vectors."""
    return any(isinstance(each, Const) and isinstance(each.value, (int, float)) for each in value.items)


def _attribute_of(reader: State, entry: Entry) -> Entry | None:
    """The attribute that a schema class's call gets or creates, such as `CreateMassAttr`; None if it is not found."""
    short = re.sub(r"^(Create|Get)|Attr$", "", entry.short)
    attribute = short[:1].lower() + short[1:]
    schema = _schema_of(reader, entry.parent)
    for name in (attribute, f"physics:{attribute}", f"inputs:{attribute}") if schema else ():
        found = reader.entry(f"{schema}.{name}") or reader.entry(f"{schema}.drive:*:{name}")
        if found is not None:
            return found
    return None


def _schema_of(reader: State, kind: str) -> str:
    """The schema of a class of pxr: `pxr.UsdPhysics.MassAPI` is "PhysicsMassAPI"; "" if it has none."""
    module, _, short = kind.removeprefix("pxr.").partition(".")
    for name in (f"{module.removeprefix('Usd')}{short}", short):
        found = reader.entry(name)
        if found is not None and found.kind == "schema":
            return name
    return ""
