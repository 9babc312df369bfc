"""The work of drives on some bodies: by their laws where frames tell them, by what is recorded, and within bounds.

What a drive does that is faster than the frames they do not tell: its speed comes and goes between two of them. What
all of a world's drives did by its steps is recorded, so that those of a group that has all of these are known together.
Where another has some, too, there is a most that each can do: what it held as a spring at the interval's start and does
not at its end, and of a damper c at a speed u c (u d - d^2 / h), as the mean of a rate's square is no less than its
mean's, d the way of the joint; with a greatest effort c u^2 / 4 (`wsim.judge.books.driven`). At least a drive does what
all did, less the most that the others can.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.books.driven import held
from wsim.judge.books.led import over
from wsim.judge.books.recorded_ties import OWN
from wsim.judge.evidence.scheduled import drive_is_set

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.books.recorded_ties import RecordedTies
    from wsim.judge.evidence.evidence import Evidence

    Floats = NDArray[np.float64]


def worked(evidence: Evidence, ties: RecordedTies, ours: set[int]) -> tuple[Floats, Floats]:
    """The work of drives and rotors of joints on some bodies, and how unsure it is, (T - 1,) each [J]."""
    joints = [k for k, joint in enumerate(ties.joints) if joint.kind in OWN]
    told = {k: _told(evidence, ties, k) for k in joints}
    known = [k for k in joints if told[k] is not None]
    rest = [k for k in joints if told[k] is None]
    inside, outside = ([k for k in rest if bool(ours & set(ties.pairs[k])) == is_ours] for is_ours in (True, False))
    none = np.zeros((2, len(ties.intervals)))
    own = sum((np.array(told[k]) for k in known if ours & set(ties.pairs[k])), none)
    if not inside:
        return own[0], own[1]
    low, high = _between(evidence, ties, inside)
    recorded = _recorded(evidence)
    if recorded is not None:
        every = sum((np.array(told[k]) for k in known), none)
        all_, doubt = recorded[0] - every[0], recorded[1] + every[1]
        least, most = _between(evidence, ties, outside)
        if outside:
            low, high = np.maximum(low, all_ - most - doubt), np.minimum(high, all_ - least + doubt)
        else:
            low, high = all_ - doubt, all_ + doubt
    blind = ~np.isfinite(low)
    if blind.any():  # who says nothing of all drives' work is asked as if their impulses came evenly
        even = np.sum([_evenly(evidence, ties, k) for k in inside], axis=0)
        low, high = np.where(blind, even[0] - even[1], low), np.where(blind, even[0] + even[1], high)
    return own[0] + 0.5 * (low + high), own[1] + 0.5 * np.maximum(high - low, 0.0)


def _recorded(evidence: Evidence) -> tuple[Floats, Floats] | None:
    """What all drives and rotors did by steps, and how unsure that is, (T - 1,) each [J]; None of older recordings."""
    worked, unsure = (evidence.recording.scalars.get(f"work/drives{end}") for end in ("", "_unsure"))
    if worked is None or unsure is None or not np.isfinite([worked[1:], unsure[1:]]).all():
        return None
    return np.asarray(worked[1:], dtype=np.float64), np.asarray(unsure[1:], dtype=np.float64)


def _between(evidence: Evidence, ties: RecordedTies, some: list[int]) -> tuple[Floats, Floats]:
    """The least and the most that drives which their law does not tell can have done together, (T - 1,) each [J]."""
    low, high = np.zeros((2, len(ties.intervals)))
    for k in some:
        stated = ties.drive(k)
        resolved = stated is not None and stated.known.all()
        work, doubt = _evenly(evidence, ties, k)
        low = low + (work - doubt if resolved else -np.inf)
        high = high + (work + doubt if resolved else _most(evidence, ties, k))
    return low, high


def _told(evidence: Evidence, ties: RecordedTies, k: int) -> tuple[Floats, Floats] | None:
    """The work of joint k's drive by its law, less what its rotor keeps; None where frames do not tell it."""
    joint, drive, spun = ties.joints[k], ties.joints[k].drive, _spun(ties, k)
    if drive_is_set(evidence.world, joint):
        return None
    if drive is None:
        return -spun, np.zeros_like(spun)
    stated, at, rate = ties.drive(k), evidence.joint(joint), ties.laws.rate(joint)
    if stated is None or at is None or not stated.known.all() or drive.max_effort is not None:
        return None
    stretch = drive.position - at.position
    rubs, doubt = drive.damping * np.array(over(evidence, rate * (rate - drive.velocity)))
    return -0.5 * drive.stiffness * np.diff(stretch**2) - rubs - spun, doubt


def _spun(ties: RecordedTies, k: int) -> Floats:
    """What joint k's rotor keeps, (T - 1,) [J]."""
    return np.asarray(0.5 * ties.joints[k].armature * np.diff(ties.laws.rate(ties.joints[k]) ** 2))


def _evenly(evidence: Evidence, ties: RecordedTies, k: int) -> tuple[Floats, Floats]:
    """The work of what is recorded that joint k's drive gave, where that and the rate change evenly, (T - 1,) each."""
    h, rate = ties.intervals, ties.laws.rate(ties.joints[k])
    drive = np.asarray(ties.track.drive[1:, k], dtype=np.float64)
    mean, change = 0.5 * (rate[1:] + rate[:-1]), np.diff(rate)
    force = np.gradient(drive / h) if len(drive) > 1 else np.zeros(len(drive))
    bend = h * force * change / 12.0
    jumps = np.abs(np.diff(change, prepend=change[:1]))
    return drive * mean + bend - _spun(ties, k), np.abs(bend) + np.abs(drive) * jumps / 6.0


def _most(evidence: Evidence, ties: RecordedTies, k: int) -> Floats:
    """The most that joint k's drive can have done, (T - 1,) [J], however fast it came and went."""
    joint, h = ties.joints[k], ties.intervals
    drive, at = joint.drive, evidence.joint(joint)
    told = drive is not None and drive.told and not evidence.recording.metadata.get("controlled")
    if drive is None or at is None or not told or drive_is_set(evidence.world, joint):
        return np.full(len(h), np.inf)
    way, u = np.diff(at.position), drive.velocity
    damper = u * way - way**2 / h if drive.max_effort is None else 0.25 * u**2 * h
    return np.asarray(-np.diff(held(drive, drive.position, at.position)) + drive.damping * damper - _spun(ties, k))
