"""Which worlds can be simulated as one batch: those of one topology, that differ in numbers alone."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from wsim.errors import UserError
from wsim.scene.validate import shown
from wsim.scene.world import (
    Body,
    Contact,
    Event,
    Fluid,
    Gear,
    Guide,
    Joint,
    JointPath,
    Motor,
    Policy,
    Reach,
    Rope,
    Schedule,
    Shape,
    Spring,
    World,
)
from wsim.scene.world_sensors import SensorCamera, SensorContact, SensorIMU, SensorRange

# Numbers that each world of a batch has of its own.
FREE: dict[type[BaseModel], frozenset[str]] = {
    World: frozenset({"gravity", "containers", "time_step"}),
    Shape: frozenset({"size", "position", "rotation", "friction", "restitution", "surface_velocity"}),
    Body: frozenset({"mass", "volume", "com", "inertia", "position", "rotation", "velocity", "angular_velocity"}),
    Joint: frozenset({"parent_anchor", "parent_turn", "child_anchor", "child_turn", "fastest"}),
    Motor: frozenset({"position", "velocity"}),
    Gear: frozenset({"ratio", "offset"}),
    Contact: frozenset({"friction", "restitution"}),
    Policy: frozenset({"times", "commands", "speed"}),
    JointPath: frozenset({"times", "positions"}),
    Schedule: frozenset({"times", "values", "linear", "point"}),
    Event: frozenset({"value", "delay"}),
    Reach: frozenset({"point", "start", "times", "positions", "rotations"}),
    SensorIMU: frozenset(
        {"position", "rotation", "accelerometer_noise", "gyroscope_noise", "accelerometer_bias", "gyroscope_bias"}
    ),
    SensorRange: frozenset({"position", "rotation", "nearest", "farthest", "noise"}),
    SensorContact: frozenset({"rotation", "threshold"}),
    SensorCamera: frozenset({"position", "rotation", "fov", "farthest"}),
    Guide: frozenset({"position", "axis", "side"}),
    Spring: frozenset({"stiffness", "damping", "rest_length"}),
    Rope: frozenset({"length"}),
    Fluid: frozenset({"density", "viscosity", "yield_stress", "flow_index", "size", "center", "velocity", "volume"}),
}
# Bounds that the solver has a row for: all worlds state one or none does.
STATED: dict[type[BaseModel], frozenset[str]] = {
    Joint: frozenset({"low", "high", "break_force", "break_torque"}),
    Motor: frozenset({"max_effort"}),
}
# Coefficients that it has a row or an actuator for where they are more than 0.
POSITIVE: dict[type[BaseModel], frozenset[str]] = {
    Shape: frozenset({"rolling"}),
    Joint: frozenset({"friction", "armature"}),
    Motor: frozenset({"stiffness", "damping"}),
    Contact: frozenset({"rolling"}),
    Guide: frozenset({"radius"}),
}
# What no solver asks for.
LOOKS = frozenset({"line", "color", "opacity", "cameras", "lights", "parameters", "name", "seed"})


def topology(world: World) -> str:
    """A digest that is the same for worlds which differ in numbers alone.

    A mesh's corners belong to it: a mesh that is scaled is another one.
    """
    return hashlib.sha256(json.dumps(_kept(world), sort_keys=True).encode()).hexdigest()


def alike(worlds: Sequence[World]) -> list[list[int]]:
    """The indices of worlds by topology, in the order in which each comes first."""
    return together([topology(world) for world in worlds])


def together(topologies: Sequence[str]) -> list[list[int]]:
    """The indices of worlds by what `topology` says of each, in the order in which each comes first."""
    groups: dict[str, list[int]] = {}
    for k, one in enumerate(topologies):
        groups.setdefault(one, []).append(k)
    return list(groups.values())


def check_alike(stages: Sequence[Path], worlds: Sequence[World]) -> None:
    """Refuse worlds that are no batch.

    Raises:
        ValueError: Naming a stage that differs from the first.
    """
    groups = alike(worlds)
    if len(groups) > 1:
        other = stages[groups[1][0]]
        raise ValueError(f"{other} is another world than {stages[0]}, not other numbers alone; simulate it by itself")


def _kept(value: Any) -> Any:
    if isinstance(value, BaseModel):
        kind = type(value)
        free, stated, positive = (of.get(kind, frozenset()) for of in (FREE, STATED, POSITIVE))
        found: dict[str, Any] = {"leads": value.leads} if isinstance(value, Motor) else {}  # an actuator more
        for name in kind.model_fields:
            own = getattr(value, name)
            if name in stated:
                found[name] = own is not None
            elif name in positive:
                found[name] = bool(own)
            elif name not in free and name not in LOOKS:
                found[name] = _kept(own)
        return found
    if isinstance(value, list | tuple):
        return [_kept(each) for each in value]
    return value


def paths_of(stage: object) -> list[Path]:
    """The files that were given, one or a list.

    Raises:
        UserError: Something else was.
    """
    given = [stage] if isinstance(stage, str | Path) else stage
    if not isinstance(given, Sequence) or not given or not all(isinstance(each, str | Path) for each in given):
        raise UserError(
            f"stage = {shown(stage)}: give the path of a USD file, or a list of paths; "
            "stage.Export(path) writes a Usd.Stage, scene.save(path) a Scene"
        )
    return [Path(each) for each in given]
