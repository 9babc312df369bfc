"""Schedules of a stage, read back."""

from __future__ import annotations

import math
from collections.abc import Iterable

from pxr import Gf, Usd, UsdPhysics

from wsim import quantities
from wsim.scene import schema
from wsim.scene.usd_prims import rigid_frame
from wsim.scene.usd_schedules import kind_of
from wsim.scene.usd_shapes import to_vec3
from wsim.scene.usd_values import line_of, targets_of, value_of
from wsim.scene.world import Event, Schedule

_HINGES = ("position", "velocity")  # what of a hinge is told in degrees


def read_schedules(prims: Iterable[Usd.Prim]) -> list[Schedule]:
    """The schedules among a stage's prims, which was checked."""
    return [_schedule(prim) for prim in prims if schema.has(prim, schema.SCHEDULE)]


def _schedule(prim: Usd.Prim) -> Schedule:
    target, quantity = targets_of(prim, "target")[0], str(value_of(prim, "quantity", ""))
    found = quantities.OF[kind_of(target)][quantity]
    turns = (target.IsA(UsdPhysics.RevoluteJoint) and quantity in _HINGES) or quantity == "angular_velocity"
    unit = math.pi / 180.0 if turns else 1.0
    times, flat = list(value_of(prim, "times", ())), [unit * each for each in value_of(prim, "values", ())]
    values = [tuple(flat[k * found.count : (k + 1) * found.count]) for k in range(len(times))]
    if quantity == "surface_velocity":  # as its shapes have theirs: in the world's axes
        frame = rigid_frame(target)
        values = [to_vec3(frame.TransformDir(Gf.Vec3d(*value))) for value in values]
    point = value_of(prim, "point", None)
    return Schedule.model_validate({
        "prim": str(prim.GetPath()),
        "target": str(target.GetPath()),
        "quantity": quantity,
        "times": times,
        "values": values,
        "linear": bool(value_of(prim, "linear", False)),
        "point": None if point is None else to_vec3(point),
        "after": _event(prim),
        "line": line_of(prim),
    })  # fmt: skip


def _event(prim: Usd.Prim) -> Event | None:
    kind = str(value_of(prim, "event", ""))
    if not kind:
        return None
    ends = targets_of(prim, "eventOf")
    unit = math.pi / 180.0 if kind == "joint" and ends[0].IsA(UsdPhysics.RevoluteJoint) else 1.0
    return Event.model_validate({
        "kind": kind,
        "first": str(ends[0].GetPath()),
        "second": str(ends[1].GetPath()) if kind == "touch" else None,
        "axis": str(value_of(prim, "eventAxis", "")) or None,
        "value": unit * value_of(prim, "eventValue", 0.0),
        "above": bool(value_of(prim, "eventAbove", True)),
        "delay": value_of(prim, "eventDelay", 0.0),
    })  # fmt: skip
