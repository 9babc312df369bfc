"""Degrees where radians are meant, and the other way, in what calls and joints are given."""

from __future__ import annotations

import ast
from typing import Any

from wsim.program.api.entry import Entry
from wsim.program.validator import units
from wsim.program.validator.state import State
from wsim.program.validator.values import Instance

_TURNS = {f"{module}.{name}" for module in ("math", "numpy") for name in ("sin", "cos", "tan")}


def check(reader: State, entry: Entry, bound: dict[str, Any]) -> None:
    """What a call is given, by the units of its parameters."""
    if entry.name in _TURNS and bound:
        _, node = next(iter(bound.values()))
        if units.said(node, reader.unit_of) == "deg":
            reader.problems.add(
                node, "unit", f"{entry.name}() takes radians, and is given degrees; convert with math.radians"
            )
        return
    if not entry.name.startswith("wsim."):
        return
    for parameter in entry.parameters:
        if parameter.name not in bound or not parameter.unit:
            continue
        _, node = bound[parameter.name]
        degrees = parameter.unit in ("deg", "deg/s")
        for part in node.elts if isinstance(node, (ast.Tuple, ast.List)) else [node]:
            told = units.said(part, reader.unit_of)
            strict = parameter.name.endswith("_deg") or parameter.name == "fov"
            if degrees and (told == "rad" or (strict and not told and units.of_pi(part))):
                text = f'"{parameter.name}" of {entry.short}() is in {parameter.unit}, and is given radians'
                reader.problems.add(part, "unit", f"{text}; convert with math.degrees", entry.signature)
            elif parameter.unit in ("rad", "rad/s") and told == "deg":
                text = f'"{parameter.name}" of {entry.short}() is in {parameter.unit}, and is given degrees'
                reader.problems.add(part, "unit", f"{text}; convert with math.radians", entry.signature)


def check_target(reader: State, target: ast.expr, value: ast.expr, told: str) -> None:
    """A joint's target is in radians."""
    if isinstance(target, ast.Attribute) and target.attr == "target" and told == "deg":
        owner = reader.value(target.value)
        if isinstance(owner, Instance) and owner.type.endswith(".ControlJoint"):
            message = '"target" of a joint is in radians, and is given degrees; convert with math.radians'
            reader.problems.add(value, "unit", message)
