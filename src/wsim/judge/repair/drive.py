"""What is wrong with a drive: its strength, its gains, or what it is set to, by how its joint moved."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import rotate
from wsim.judge.evidence.joints import anchors_of, track_of
from wsim.judge.evidence.welded import welded
from wsim.judge.repair.rule import ROOM
from wsim.judge.verdict import RepairTarget

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.scene.world import Joint, Motor

    Floats = NDArray[np.float64]

OFF = 0.05  # of what it is set to: a drive that is nearer got there
SETTLED = 0.02  # of it, that a load may push it back by, and to which an exponential falls within 4 time constants
CONSTANTS = 4.0
PLACES = 180  # of each half turn, at which a hinge is tried
FULL, HALF = 0.98, 0.5  # of its strength; of the frames at its end


def drive_of(evidence: Evidence, prim: str) -> Joint | None:
    """The joint whose drive moves a body, or what is fixed to it."""
    prims = {body.prim for body in evidence.world.bodies}
    if prim not in prims:
        return None
    held = {evidence.world.bodies[k].prim for k in welded(evidence, evidence.index(prim))}
    driven = [joint for joint in evidence.world.joints if joint.drive is not None]
    child = next((joint for joint in driven if joint.child in held), None)
    return child or next((joint for joint in driven if joint.parent in held), None)


def by_drive(evidence: Evidence, prim: str, share: float | None, why: str) -> RepairTarget | None:
    """The target of what a drive moves otherwise than asked; None of what none moves.

    Args:
        evidence: What happened.
        prim: The body.
        share: How many times as far, or as fast, the drive is to go where it does go where it is set to.
        why: What is wrong then.
    """
    joint = drive_of(evidence, prim)
    if joint is None or joint.drive is None:
        return None
    track = track_of(evidence, joint)
    if track is None:
        return None
    motor = joint.drive
    if strained(evidence, joint):
        return stronger(joint, motor)
    found = (
        _position(evidence, joint, motor, track.position)
        if motor.stiffness
        else _speed(evidence, joint, motor, track.position)
    )
    if found is not None:
        return found
    what = "position" if motor.stiffness else "velocity"
    now = getattr(motor, what)
    to = None if share is None or not now else now * share
    if to is not None and abs(to / now - 1.0) < SETTLED:
        to = None
    return _part(joint, what, now, to, why)


def to_point(evidence: Evidence, prim: str, point: Floats, window: tuple[float, float] | None) -> RepairTarget | None:
    """What a drive from the world is to be set to, so that a body comes to a point; None of what none moves.

    Args:
        evidence: What happened.
        prim: The body.
        point: (3,) [m].
        window: From when to when it is to be there [s]; of a drive that turns at a rate.
    """
    joint = drive_of(evidence, prim)
    if joint is None or joint.drive is None or joint.parent is not None or joint.kind not in ("revolute", "prismatic"):
        return None
    ends = anchors_of(evidence, joint)
    pivot, axis = ends.above[0], rotate(ends.above_turn[0], np.eye(3)["XYZ".index(joint.axis)])
    start = evidence.body_q[0, evidence.index(prim), :3].astype(np.float64)
    if joint.kind == "prismatic":
        q = float((point - start) @ axis)
    else:
        ways = np.linspace(-math.pi, math.pi, 2 * PLACES + 1)
        turns = np.concatenate([np.sin(ways / 2)[:, None] * axis, np.cos(ways / 2)[:, None]], axis=1)
        off = np.linalg.norm(pivot + rotate(turns, np.broadcast_to(start - pivot, (len(turns), 3))) - point, axis=1)
        q = float(ways[int(np.argmin(off))])
    motor = joint.drive
    if not motor.stiffness:
        if window is None or not sum(window):
            return None
        # As fast as it is, and the other way round, if that will do; else so that it is there in the middle of it.
        back = -q / motor.velocity if motor.velocity else -1.0
        to = -motor.velocity if window[0] <= back <= window[1] else 2.0 * q / sum(window)
        return _part(joint, "velocity", motor.velocity, to, f"it is to be there after {q / to:.3g} s" if to else "")
    if not motor.damping:
        return _part(joint, "position", motor.position, q / 2, "undamped it swings to twice where it is set to")
    return _part(joint, "position", motor.position, q, "there it is at the place that is asked for")


def strained(evidence: Evidence, joint: Joint) -> bool:
    """Whether a drive ends at the end of its strength, and is not meant to."""
    effort = evidence.recording.scalars.get("drive" + joint.prim.removeprefix("/World"))
    if joint.drive is None or joint.drive.max_effort is None or joint.drive.saturates or effort is None:
        return False
    full = np.abs(effort[evidence.window]) >= FULL * joint.drive.max_effort
    return bool(full.mean() > HALF)


def stronger(joint: Joint, motor: Motor) -> RepairTarget:
    """As strong as its gains ask for at most: beyond that a bound does nothing."""
    asked = motor.stiffness * abs(motor.position) + motor.damping * abs(motor.velocity)
    to = (1.0 + ROOM) * asked if motor.max_effort is not None and asked > motor.max_effort else None
    why = "it is at its limit: its gains ask for so much at the most"
    return _part(joint, "max_force", motor.max_effort, to, why)


def _position(evidence: Evidence, joint: Joint, motor: Motor, q: Floats) -> RepairTarget | None:
    """A drive that does not come to where it is set to, or swings about it."""
    here = evidence.window
    scale = max(abs(motor.position), 1e-6)
    off = motor.position - float(q[here].mean())
    seconds = float(evidence.time[-1] - evidence.time[0])
    swing = float(np.std(q[here]))
    if swing > SETTLED * scale and _crossings(evidence.time, q - motor.position) >= 3:
        period = 2.0 * seconds / _crossings(evidence.time, q - motor.position)
        to = motor.stiffness * period / math.pi  # 2 sqrt(k I) = 2 k / omega
        if to > motor.damping:
            return _part(joint, "damping", motor.damping, to, "it swings about where it is set to: damped critically")
    if abs(off) <= OFF * scale:
        return None
    way = float(q[here][-1] - q[here][0])
    if way * off > 0.0 and abs(way) > SETTLED * scale:
        to = 2.0 * CONSTANTS * motor.damping / seconds
        if to > motor.stiffness:
            why = "it is still on its way: its time constant, damping over stiffness, is too long for the run"
            return _part(joint, "stiffness", motor.stiffness, to, why)
        return None
    why = f"its load holds it {abs(off):.3g} short: as much stiffer"
    return _part(joint, "stiffness", motor.stiffness, motor.stiffness * abs(off) / (SETTLED * scale), why)


def _speed(evidence: Evidence, joint: Joint, motor: Motor, q: Floats) -> RepairTarget | None:
    """A drive that does not come to the speed that it is set to."""
    rate = float(np.mean(np.gradient(q, evidence.time)[evidence.window]))
    off = motor.velocity - rate
    if abs(off) <= OFF * abs(motor.velocity) or not motor.damping:
        return None
    to = motor.damping * abs(off) / (SETTLED * max(abs(motor.velocity), 1e-6))
    return _part(joint, "damping", motor.damping, to, "its load slows it: its push grows with its damping")


def _part(joint: Joint, what: str, now: float | None, to: float | None, why: str) -> RepairTarget:
    turns = joint.kind == "revolute"
    of, effort = ("rad", "N m") if turns else ("m", "N")
    unit = {"position": of, "velocity": f"{of}/s", "max_force": effort, "stiffness": f"{effort}/{of}",
            "damping": f"{effort} s/{of}"}[what]  # fmt: skip
    way = "raise"
    if to is None and what in ("position", "velocity"):
        way = "change"
    elif to is not None and now is not None and to < now:
        way = "lower"
    return RepairTarget.model_validate(
        {"kind": "drive", "prim": joint.prim, "parameter": f"drive.{what}", "direction": way, "current": now,
         "suggested": to, "unit": unit, "why": why}
    )  # fmt: skip


def _crossings(time: Floats, off: Floats) -> int:
    return int(np.sum(off[:-1] * off[1:] < 0.0))
