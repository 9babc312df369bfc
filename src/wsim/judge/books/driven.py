"""What drives may give within a frame and take again before it ends: frames show the sum of both.

With effort = k s + c (u - q'), s what is left of the way to go to where it is set, kinetic energy and k s^2 / 2 rise by
no more than c (u - q') q' <= c u^2 / 4, as a damper takes all else; with a greatest effort F what it holds is the work
of min(k s, F) over that way.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.scene.world import Motor

    Floats = NDArray[np.float64]


def held(drive: Motor, position: Floats) -> Floats:
    """What a drive holds as a spring does, at joint positions (T,) [J]."""
    left = np.abs(drive.position - position)
    if drive.max_effort is None or drive.stiffness <= 0.0:
        return np.asarray(0.5 * drive.stiffness * left**2)
    within = np.minimum(left, drive.max_effort / drive.stiffness)
    return np.asarray(0.5 * drive.stiffness * within**2 + drive.max_effort * (left - within))


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
            found += held(drive, track.position)[:-1] + 0.25 * drive.damping * drive.velocity**2 * evidence.motion.h
    return found


def alone(evidence: Evidence) -> tuple[Floats, Floats] | None:
    """What the only drive of a world did by its steps, and how unsure that is, (T - 1,) each [J]; None of several.

    Of a stiff one frames do not tell it: its speed comes and goes between two of them.
    """
    recording = evidence.recording
    worked, unsure = (recording.scalars.get(f"work/drives{end}") for end in ("", "_unsure"))
    drives = sum(joint.drive is not None for joint in evidence.world.joints)
    if drives != 1 or worked is None or unsure is None or not np.isfinite([worked[1:], unsure[1:]]).all():
        return None
    return np.asarray(worked[1:], dtype=np.float64), np.asarray(unsure[1:], dtype=np.float64)
