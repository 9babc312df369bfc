"""What a slider's way tells of its drive's mean force where frames are too far apart to tell the force all along.

A damper gives its constant times how far the joint goes, however fast it goes there: a mode that it damps need not be
resolved, only one that the stiffness makes swing, of phase p between frames. Its mean both ends' places and rates leave
to p^4 / 720 of its amplitude (`jolts.mean_force`). Where the joint goes farther than rates and accelerations have it,
or less far, it may have gone by as much at once, at any time. A blow may bring a drive to its greatest effort between
two frames, and nothing of that is left at their ends.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.books import jolts
from wsim.judge.evidence.motion import FLOAT32

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.scheduled import Aims
    from wsim.scene.world import Motor

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]

FOLLOWED = 2.0  # of the phase that a drive's stiffness gives its mechanism [rad]: faster ones are not followed
SLOW = 0.5  # of a speed that the damper takes in a step: how an engine sums up what is faster is its own affair
BEYOND = 250.0  # p^2 / 250 of the fastest h tells p^4 / 720 of an amplitude from its rates, p^2 / 2 of it at least


@dataclass(frozen=True)
class Course:
    """How a slider with a drive goes, of T frames."""

    place: Floats  # (T,) [m]
    rate: Floats  # (T,)
    h: Floats  # (T - 1,) [s]
    extent: float  # the largest number that its place is the rounded difference of [m]
    mobility: float  # by how much a unit force speeds it up at most [1/kg]
    late: float  # the time step, which a rate may be told late by [s]


def eased(drive: Motor, aims: Aims, place: Floats, rate: Floats, h: Floats) -> Floats:
    """The share of a drive's effort, at its most at both ends of an interval, that may be missing, (T - 1,).

    To give less it has to be asked for less, by as much as it is asked for beyond its most: its joint then goes by
    another rate for a while, and so much farther or less far than rates and accelerations have it. What else hangs
    there may swing it so, or hit it. For that while it may have given all of it the other way.

    Args:
        drive: Its law.
        aims: What it aims at.
        place: Of its joint, (T,) [rad or m].
        rate: (T,).
        h: Lengths of the intervals, (T - 1,) [s].
    """
    if drive.max_effort is None or len(h) < 2:
        return np.zeros(len(h))
    stray = jolts.strayed(place, rate, h)
    asked = np.abs(drive.stiffness * (aims.position - place) + drive.damping * (aims.velocity - rate))
    beyond = np.minimum(asked[1:], asked[:-1]) - drive.max_effort - drive.stiffness * stray
    lasts = drive.damping * stray / h / np.maximum(beyond, 1e-12 * drive.max_effort)
    return np.asarray(2.0 * np.minimum(lasts, 1.0))


def off_the_way(drive: Motor, course: Course, mean: Floats, may: Floats, below: Bools, struck: Bools) -> Floats:
    """By how much a drive's mean force may be off what its joint's way tells, (T - 1,) [N]; inf: by any.

    Args:
        drive: Its law.
        course: How its joint goes.
        mean: What the way tells, (T - 1,).
        may: By how much that is off where the rate changes evenly, or jumps (`Laws.mean_of_drive`).
        below: Where it is below its greatest effort at both ends.
        struck: Where a blow may come.
    """
    if len(course.h) < 2:
        return np.full(len(course.h), np.inf)
    h, rate, extent = course.h, course.rate, 8.0 * FLOAT32 * course.extent
    fastest = np.maximum(np.abs(rate[1:]), np.abs(rate[:-1]))
    bend = h / 12.0 * np.diff(np.gradient(rate))
    stray = np.abs(np.diff(course.place) - 0.5 * (rate[1:] + rate[:-1]) * h + bend)
    phase = np.sqrt(drive.stiffness * course.mobility) * h
    off = may + drive.stiffness * (stray + phase**2 / BEYOND * fastest * h + extent)
    off = off + drive.damping / h * extent
    # Sums over steps are those of starts, of ends or of means, of place and rate each.
    far, faster = np.abs(np.diff(course.place)), np.abs(np.diff(rate))
    off = off + np.minimum(course.late / h, 1.0) * (0.5 * drive.stiffness * far + drive.damping * faster)
    tells = (phase < FOLLOWED) & (drive.damping * course.mobility * course.late < SLOW)
    if drive.max_effort is not None:  # what goes to and fro may be at its most meanwhile
        tells &= below & ~struck & (np.abs(mean) + off + drive.damping * stray / h < drive.max_effort)
    return np.asarray(np.where(tells, off, np.inf))
