"""When something happens: what is touched, struck, turned round, at its highest or at rest, by a run's motion alone."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.scene.labels import object_of

if TYPE_CHECKING:
    from wsim.scene.world import World
    from wsim.sim.framing.motion import Motion
    from wsim.sim.framing.subjects import Subject

Array = np.ndarray
STILLS = 6  # of a run
SLOW = 0.05  # of its greatest speed: what is slower rests
BLOW = 0.25  # of its greatest speed: what changes by more from one frame to the next was struck
AGAIN = 0.6  # what the same thing weighs when it happens again
FLIGHT = 0.5  # of its size: what falls or flies farther without a contact does so for a moment of its own
HIGH = 0.15  # of the range of its heights: how far a summit stands out


@dataclass(frozen=True)
class Moment:
    """Something that happens.

    Attributes:
        frame: When.
        what: In words, with the object's name.
        weight: How much it matters, of 1.
    """

    frame: int
    what: str
    weight: float


def moments(world: World, motion: Motion, subjects: Sequence[Subject]) -> list[Moment]:
    """What happens to the main subjects, in order of time; the first and the last frame are no moments."""
    found: list[Moment] = []
    if len(motion.time) < 3:
        return found
    for subject in subjects:
        if subject.main and subject.able:
            rows = [k for k, body in enumerate(world.bodies) if object_of(body.prim) in subject.parts]
            found += _of(subject, motion, rows)
    return sorted(found, key=lambda moment: moment.frame)


def chosen(found: Sequence[Moment], frames: int, most: int) -> list[int]:
    """Frames for so many stills: the first, the last, and moments, the weightiest first and not side by side.

    What happens often counts less each time: a bounce is shown with its heights. Where less happens than there are
    stills, the rest are where the longest time passes between those.
    """
    if frames == 0:
        return []
    kept = sorted({0, frames - 1})
    apart = max(1, frames // (4 * most))
    often: Counter[str] = Counter()
    left = list(found)
    while left and len(kept) < most:
        best = max(left, key=lambda moment: (moment.weight * AGAIN ** often[moment.what], -moment.frame))
        left.remove(best)
        if min(abs(best.frame - frame) for frame in kept) >= apart:
            kept.append(best.frame)
            often[best.what] += 1
    kept.sort()
    while len(kept) < min(most, frames):
        gaps = np.diff(kept)
        k = int(np.argmax(gaps))
        kept.insert(k + 1, kept[k] + int(gaps[k]) // 2)
    return kept


def _of(subject: Subject, motion: Motion, rows: Sequence[int]) -> Iterator[Moment]:
    name = subject.prim.rsplit("/", 1)[-1]
    centre = subject.centre
    between = np.diff(centre, axis=0) / np.diff(motion.time)[:, None]
    speed = np.linalg.norm(between, axis=1)
    fastest = float(speed.max())
    if fastest * float(motion.time[-1] - motion.time[0]) < 1e-3 * max(subject.size, 1e-6):
        return
    if rows:
        force = motion.force[:, list(rows)].max(axis=1)
        yield from _touched(name, force)
        yield from _in_flight(name, force, centre, FLIGHT * subject.size)
    jumps = np.linalg.norm(np.diff(between, axis=0), axis=1)  # at frame k + 1
    for k in _peaks(jumps, BLOW * fastest):
        yield Moment(k + 1, f"{name} is struck", min(1.0, 0.4 + 0.5 * float(jumps[k]) / fastest))
    height = centre[:, 2]
    span = float(np.ptp(height))
    if span > 0.2 * subject.size:
        for k in _peaks(height, float(height.min()) + HIGH * span):
            stands_out = min(height[k] - height[: k + 1].min(), height[k] - height[k:].min())
            if stands_out > HIGH * span:
                yield Moment(k, f"{name} is highest", 0.55)
    moving = np.flatnonzero(speed > SLOW * fastest)
    if moving[0] > 1:
        yield Moment(int(moving[0]), f"{name} starts", 0.5)
    if moving[-1] + 2 < len(motion.time) - 1:
        yield Moment(int(moving[-1]) + 2, f"{name} rests", 0.45)


def _touched(name: str, force: Array) -> Iterator[Moment]:
    """Where contacts push again that did not for two frames."""
    free = force <= 0.0
    onset = np.flatnonzero(free[:-2] & free[1:-1] & ~free[2:]) + 2
    for n, k in enumerate(onset[:20]):
        yield Moment(int(k), f"{name} touches", 0.9 if n == 0 else 0.6)


def _in_flight(name: str, force: Array, centre: Array, least: float) -> Iterator[Moment]:
    """In the middle of the way down of what came off something, and touches nothing until it is at least so far off."""
    free = np.concatenate([[False], force <= 0.0, [False]])
    begins, ends = np.flatnonzero(~free[:-1] & free[1:]), np.flatnonzero(free[:-1] & ~free[1:])
    for first, end in zip(begins.tolist(), ends.tolist(), strict=True):
        if first > 0 and end < len(force) and centre[first, 2] - centre[end, 2] > least:
            yield Moment((first + end) // 2, f"{name} falls", 0.6)


def _peaks(values: Array, least: float) -> list[int]:
    """Indices inside where a value is above its neighbours, and above `least`."""
    inner = values[1:-1]
    found = np.flatnonzero((inner > least) & (inner > values[:-2]) & (inner >= values[2:])) + 1
    return [int(k) for k in found[:100]]
