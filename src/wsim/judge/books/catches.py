"""What stops of joints and ropes catch: neither has any restitution, so that nothing goes back faster than it came.

What comes to its stop, or to a rope's end, is held there. It leaves as fast as what else acts takes it back until the
next frame: gravity, a spring, a drive, of which the intervals around tell how much that is.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.ropes import path_length
from wsim.judge.books.laws import Laws
from wsim.judge.books.ropes import SLACK, Ropes
from wsim.judge.evidence.joints import track_of
from wsim.judge.evidence.motion import FLOAT32
from wsim.scene.cord_paths import moving_stops

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.scene.world import Joint, Rope

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]

SHOWS = 0.2  # of an approach: where what else acts changes it by more, frames do not tell a throw


@dataclass(frozen=True)
class Catch:
    """One moment at which something was held."""

    prim: str  # of the joint or the rope
    interval: int
    approach: float  # [rad/s] or [m/s]
    back: float
    others: float  # what else may have taken it back
    unit: str


def catches(evidence: Evidence) -> list[Catch]:
    """All of a recording whose mechanism meets nothing else then."""
    found: list[Catch] = []
    laws = Laws(evidence)
    for joint in evidence.world.joints:
        if joint.kind in ("revolute", "prismatic") and joint.child_anchor is not None and not joint.may_break:
            told = _alone(evidence, [evidence.index(joint.child)])
            for law in laws.joints[joint.prim]:
                told = told & law.known
            unit = "rad/s" if joint.kind == "revolute" else "m/s"
            for room, rate in _rooms(evidence, joint, laws):
                found += _held(joint.prim, evidence.motion.h, room, rate, told, unit)
    if evidence.world.ropes:
        ways = Ropes(evidence)
        for rope in evidence.world.ropes:
            rows = [evidence.index(guide.body) for guide in rope.path if guide.body is not None]
            room, rate = _slack(evidence, ways, rope)
            found += _held(rope.prim, evidence.motion.h, room, rate, _alone(evidence, rows), "m/s")
    return found


def _alone(evidence: Evidence, rows: list[int]) -> Bools:
    """Intervals in which nothing else may have hit what bodies are part of, (T - 1,)."""
    return np.asarray(~evidence.motion.meets[:, np.isin(evidence.motion.unit, evidence.motion.unit[rows])].any(axis=1))


def _rooms(evidence: Evidence, joint: Joint, laws: Laws) -> Iterator[tuple[Floats, Floats]]:
    """How far a joint is from each of its stops, and how fast it comes nearer, (T,) each."""
    track = track_of(evidence, joint)
    if track is None:
        return
    rate = laws.rate(joint)
    if joint.low is not None:
        yield track.position - joint.low, -rate
    if joint.high is not None:
        yield joint.high - track.position, rate


def _slack(evidence: Evidence, ways: Ropes, rope: Rope) -> tuple[Floats, Floats]:
    """How much longer a rope is than its way, and how fast that gets longer, (T,) each."""
    way = path_length(moving_stops(rope.path, ways.poses(rope, evidence.body_q)))
    return rope.length * (1.0 + SLACK) - way, ways.rate(rope)


def _held(prim: str, h: Floats, room: Floats, rate: Floats, alone: Bools, unit: str) -> list[Catch]:
    """The intervals in which something comes to its end, by more than places are rounded to, and turns back."""
    if len(h) < 4:
        return []
    rounding = 8.0 * FLOAT32 * float(np.abs(room).max())
    speed_up = np.abs(np.diff(rate)) / h
    others = np.maximum(speed_up[:-2], speed_up[2:]) * h[1:-1]  # of the interval before and after
    before, after = rate[1:-2], -rate[2:-1]
    reached = np.minimum(room[1:-2] - before * h[1:-1], room[2:-1]) <= rounding
    quiet = alone[1:-1] & (others < SHOWS * before)
    return [
        Catch(prim, int(k) + 1, float(before[k]), float(after[k]), 2.0 * float(others[k]), unit)
        for k in np.flatnonzero((before * h[1:-1] > rounding) & (after > 0.0) & reached & quiet)
    ]
