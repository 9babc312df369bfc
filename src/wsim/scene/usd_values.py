"""What a prim of a stage says of wsim's own: attributes, relationships, and the line of the program that made it.

It imports little but pxr: what checks a stage as a program writes it needs no models of worlds.
"""

from __future__ import annotations

from typing import Any

from pxr import Usd, UsdPhysics

from wsim.defaults import DURATION


def value_of(prim: Usd.Prim, name: str, default: object) -> Any:
    """A prim's attribute `wsim:name`, or what holds where it has none."""
    attribute = prim.GetAttribute(f"wsim:{name}")
    value = attribute.Get() if attribute else None
    return default if value is None else value


def targets_of(prim: Usd.Prim, name: str) -> list[Usd.Prim]:
    """The prims that a prim's relationship `wsim:name` points to, as far as they are there."""
    relation = prim.GetRelationship(f"wsim:{name}")
    found = (prim.GetStage().GetPrimAtPath(path) for path in (relation.GetTargets() if relation else []))
    return [each for each in found if each]


def line_of(prim: Usd.Prim) -> str | None:
    """The line of the program that made a prim."""
    line = prim.GetCustomDataByKey("wsim:line")
    return line if isinstance(line, str) else None


def duration_of(stage: Usd.Stage) -> float:
    """How long the run of a stage is [s]."""
    scenes = (prim for prim in stage.Traverse() if prim.IsA(UsdPhysics.Scene))
    return next((float(value_of(prim, "duration", DURATION)) for prim in scenes), DURATION)
