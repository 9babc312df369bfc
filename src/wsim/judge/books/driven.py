"""What drives may give within a frame and take again before it ends: frames show the sum of both.

With effort = k s + c (u - q'), s what is left of the way to go to where it is set, kinetic energy and k s^2 / 2 rise by
no more than c (u - q') q' <= c u^2 / 4, as a damper takes all else; with a greatest effort F what it holds is the work
of min(k s, F) over that way.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.evidence.motion import FLOAT32
from wsim.judge.evidence.scheduled import Aims

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.books.recorded_ties import RecordedTies
    from wsim.judge.evidence.evidence import Evidence
    from wsim.scene.world import Motor

    Floats = NDArray[np.float64]


def held(drive: Motor, aim: Floats | float, position: Floats) -> Floats:
    """What a drive holds as a spring does, aiming at a position, at joint positions (T,) [J]."""
    left = np.abs(aim - position)
    if drive.max_effort is None or drive.stiffness <= 0.0:
        return np.asarray(0.5 * drive.stiffness * left**2)
    within = np.minimum(left, drive.max_effort / drive.stiffness)
    return np.asarray(0.5 * drive.stiffness * within**2 + drive.max_effort * (left - within))


def changes_hands(evidence: Evidence, rows: NDArray[np.intp]) -> float:
    """What the drives of some bodies' joints hold as springs, from its least to its most, added up [J].

    Of drives that somebody sets while the world runs that is not known, and counts as nothing.
    """
    found, ours = 0.0, set(rows.tolist())
    if evidence.recording.metadata.get("controlled"):
        return found
    for joint in evidence.world.joints:
        track, drive = evidence.joint(joint), joint.drive
        if drive is not None and track is not None and evidence.index(joint.child) in ours:
            found += float(np.ptp(held(drive, Aims.of(evidence, joint).position, track.position)))
    return found


def given_within(evidence: Evidence) -> Floats:
    """What drives may give at most by any moment of an interval, of that which its ends show, (T - 1,) [J].

    Of drives that somebody sets while the world runs that is not known, and counts as nothing.
    """
    found = np.zeros(len(evidence.motion.h))
    if evidence.recording.metadata.get("controlled"):
        return found
    for joint in evidence.world.joints:
        track, drive = evidence.joint(joint), joint.drive
        if drive is not None and track is not None:
            aims = Aims.of(evidence, joint)
            fastest = np.maximum(np.abs(aims.velocity[1:]), np.abs(aims.velocity[:-1]))
            found += held(drive, aims.position, track.position)[:-1]
            found += 0.25 * drive.damping * fastest**2 * evidence.motion.h
    return found


def resting(ties: RecordedTies, k: int) -> tuple[Floats, Floats]:
    """What joint k's drive gives at rest by its law, and how far that may be off, (T - 1,) each [N or N m].

    Of one that is faster than the frames, which do not show how it came there; inf where it may not be at rest.
    """
    joint = ties.joints[k]
    drive, motion, at = joint.drive, ties.laws.motion, ties.laws.position(joint)
    if drive is None or at is None or drive.max_effort is not None or drive.stiffness <= 0.0:  # a damper holds nothing
        return np.zeros(len(motion.h)), np.full(len(motion.h), np.inf)
    aims = ties.laws.aims(joint)
    effort, ours = drive.stiffness * (aims.position - at), motion.unit == motion.unit[ties.pairs[k][1]]
    moved = (ties.struck | motion.meets)[:, ours].any(axis=1) | (aims.mean_velocity != 0.0)
    moved |= aims.jumps | (np.diff(aims.position) != 0.0)
    swings = settled(motion.h, at, ties.laws.rate(joint), drive, ties.laws.loose(joint))
    rounding = 8.0 * FLOAT32 * drive.stiffness * float(max(np.pi, np.abs(motion.com).max()))
    return 0.5 * (effort[1:] + effort[:-1]), np.where(moved, np.inf, swings + rounding)


def settled(h: Floats, position: Floats, rate: Floats, drive: Motor, loose: Floats) -> Floats:
    """How far a drive's mean effort may be from that of its joint at rest, (T - 1,) [N or N m], by its law.

    Between frames that are too far apart to show it a joint may swing, by A at the first; it is A exp(-c h / 2 I) at
    the next one, c its damping and I what it moves. By the difference of both the places differ, or the rates do: what
    they change by in an interval and those beside it bounds A, and k A what the effort swings by.

    Args:
        h: Of each interval [s].
        position: Of the joint, (T,) [rad or m].
        rate: Its speed, (T,).
        drive: Its law.
        loose: 1 / I, (T,).
    """
    slowest = np.sqrt(drive.stiffness * loose.min())
    dies = 1.0 - np.exp(-0.5 * drive.damping * loose.min() * h)
    moved = np.abs(np.diff(position)) + np.maximum(np.abs(rate[1:]), np.abs(rate[:-1])) / max(slowest, 1e-12)
    around = np.pad(moved, 1, mode="edge")
    most = np.maximum(np.maximum(around[:-2], around[2:]), moved)
    return np.asarray((drive.stiffness + drive.damping * slowest) * most / np.maximum(dies, 1e-12))
