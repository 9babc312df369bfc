"""What to state of a start or a way so that it is the one that was taken: as the program writes it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.paths import logarithm
from wsim.geometry.rotations import conjugate, matrices, multiply
from wsim.judge.verdict import RepairTarget

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding, RepairKind

    Floats = NDArray[np.float64]

DIGITS = 6
STARTS: dict[str, tuple[RepairKind, str, str]] = {
    "m": ("settlement", "position", "m"),
    "rad": ("geometry", "rotation_deg", "deg"),
    "m/s": ("physical parameter", "velocity", "m/s"),
    "rad/s": ("physical parameter", "angular_velocity_deg", "deg/s"),
}  # by the unit of what is off: what the program calls it, and in which unit


def start_taken(evidence: Evidence, finding: Finding) -> RepairTarget:
    """The place, the turn or the speed that a body starts with, where the stage states another; MissingError."""
    i, motion = evidence.index(finding.prim or ""), evidence.motion
    kind, parameter, unit = STARTS[finding.unit]
    taken = {
        "m": motion.q[0, i, :3], "rad": roll_pitch_yaw(motion.q[0, i, 3:]),
        "m/s": motion.v[0, i], "rad/s": np.degrees(motion.w[0, i]),
    }[finding.unit]  # fmt: skip
    why = "it starts so, and not as stated: state the start that it takes, or let nothing else give it one"
    return _to(finding, kind, parameter, taken, unit, why)


def way_taken(evidence: Evidence, finding: Finding) -> RepairTarget:
    """The velocity, or the keys of the path, by which what is kinematic went where it did; MissingError."""
    i, motion, time = evidence.index(finding.prim or ""), evidence.motion, evidence.time
    path, turns = evidence.world.bodies[i].path, finding.unit == "rad"
    if path is None:
        why, seconds = "that is the velocity with which it went", float(time[-1] - time[0])
        if not turns:
            mean = (motion.com[-1, i] - motion.com[0, i]) / seconds
            return _to(finding, "physical parameter", "velocity", mean, "m/s", why)
        steps = logarithm(multiply(motion.q[1:, i, 3:], conjugate(motion.q[:-1, i, 3:])))  # less than half a turn each
        return _to(
            finding, "physical parameter", "angular_velocity_deg", np.degrees(steps.sum(0) / seconds), "deg/s", why
        )
    keys = np.array(path.rotations if turns else path.positions, dtype=np.float64)
    near = np.abs(time[:, None] - time[0] - np.array(path.times)).argmin(axis=0)
    known = np.array(path.times) <= time[-1] - time[0]
    keys[known] = (motion.q[near, i, 3:] if turns else motion.q[near, i, :3])[known]
    values = np.array([roll_pitch_yaw(key) for key in keys]) if turns else keys
    name, unit = ("path.rotations_deg", "deg") if turns else ("path.positions", "m")
    return _to(finding, "settlement", name, values.ravel(), unit, "there it is at the times of its keys")


def roll_pitch_yaw(q: Floats) -> Floats:
    """The turns about the world's X, Y and Z, in this order, of a rotation (4,), xyzw, (3,) [deg]."""
    axes = matrices(np.asarray(q, dtype=np.float64) / np.linalg.norm(q))
    pitch = math.asin(min(1.0, max(-1.0, -axes[2, 0])))
    if abs(axes[2, 0]) > 1.0 - 1e-12:  # X looks up or down: roll and yaw are about one axis
        return np.degrees([0.0, pitch, math.atan2(-axes[0, 1], axes[1, 1])])
    roll, yaw = math.atan2(axes[2, 1], axes[2, 2]), math.atan2(axes[1, 0], axes[0, 0])
    return np.degrees([roll, pitch, yaw])


def _to(finding: Finding, kind: RepairKind, parameter: str, values: Floats, unit: str, why: str) -> RepairTarget:
    vector = tuple(round(float(x), DIGITS) + 0.0 for x in values)
    return RepairTarget(
        kind=kind, prim=finding.prim, parameter=parameter, direction="change", vector=vector, unit=unit, why=why
    )
