"""Which bodies do in an interval what they did in one before, so that the same impulses explain it again.

What stands is solved once: where it, and all that touches it, is where it was and goes as it went, the impulses that
were admissible still are; where some of them came from what was apart, where all that it may touch does. What they then
leave is the change now less the change then, added to what they left.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.books.touching import touching_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from wsim.judge.books.touching import Touching
    from wsim.judge.evidence.evidence import Evidence

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]
    Rows = NDArray[np.intp]

PLACE = 1e-5  # of a body's size, and [rad]: an arm that is off by less
SPEED = 1e-3  # of what gravity gives in an interval
CHANGE = 1e-4  # of gravity
LONGER = 1.5  # times as long is another interval
CHUNK = 64  # intervals whose distances between all bodies are held at once


class Repeats:
    """Which bodies are to be worked out anew in each of N = W (T - 1) intervals of W copies, (N, B).

    A body that is near another that changes takes impulses of it only where nothing else explains both. So what changes
    and what touches it is worked out first, and where that leaves something, all that it may come to touch.
    """

    def __init__(self, copies: Sequence[Evidence], wanted: Floats, hit: Bools, size: Floats, unit: float) -> None:
        """Of copies of T frames of B bodies each, whose intervals are one after another.

        Args:
            copies: W of them.
            wanted: Changes to be explained, (N, B, 6) [m/s^2].
            hit: Whether something hit a body, (N, B).
            size: (W, B) [m].
            unit: A strength of gravity [m/s^2].
        """
        self.anew, self._all = fresh(copies, wanted, hit, size, unit)
        self.apart = np.ones_like(hit)  # what took impulses of what it does not touch, or is not explained
        self._share = 1  # of what relies on such impulses, looked at once

    def lacking(self, ks: Rows) -> Bools:
        """Intervals (K,) in which something needs more than what touches it, and has not had that."""
        more = np.any(self.anew[ks] != self._all[ks], axis=1)
        return np.asarray(more & np.any(self.anew[ks] & self.apart[ks], axis=1))

    def stale(self) -> Rows:
        """Intervals that are to be worked out with all that bodies may touch there, until there is none."""
        due = np.flatnonzero(self.lacking(np.arange(len(self.anew))))
        if not len(due):  # what repeats impulses of what has changed since
            body = np.arange(self.anew.shape[1])
            due = np.flatnonzero(np.any(~self.anew & self._all & self.apart[self._source, body], axis=1))[: self._share]
            self._share *= 2
        self.anew[due] = self._all[due]
        return due

    @property
    def _source(self) -> Rows:
        """The interval that each body repeats in each, or the same, (N, B)."""
        return np.maximum.accumulate(np.where(self.anew, np.arange(len(self.anew))[:, None], 0), axis=0)

    def again(self, found: Floats, wanted: Floats | None = None) -> Floats:
        """What was found of bodies worked out anew, (N, B, …), of all; plus what they want more than then."""
        source, body = self._source, np.arange(self.anew.shape[1])
        repeated = found[source, body]
        return repeated if wanted is None else np.asarray(repeated + wanted - wanted[source, body])


def fresh(copies: Sequence[Evidence], wanted: Floats, hit: Bools, size: Floats, unit: float) -> tuple[Bools, Bools]:
    """Where a body, or what it touches or hangs on, differs from the last interval of its kind, (N, B); or may touch.

    Arguments as of `Repeats`.
    """
    motion, world, count = copies[0].motion, copies[0].world, len(copies)
    seen = np.stack([_seen(evidence, each, unit) for evidence, each in zip(copies, size, strict=True)], axis=1)
    kinds = np.concatenate([wanted / (CHANGE * unit), hit[..., None]], axis=2)
    kinds = kinds.reshape(count, len(motion.h), *kinds.shape[1:]).swapaxes(0, 1)
    changed = _changed(seen, kinds)  # (T - 1, W, B); the first of each copy is
    longer = np.abs(np.diff(np.log(motion.h), prepend=np.log(motion.h[:1]))) > np.log(LONGER)
    changed |= longer[:, None, None]
    breaks = {end for joint in world.joints if joint.may_break for end in (joint.parent, joint.child)}
    changed[..., [body.prim in breaks for body in world.bodies]] = True
    every, hits = changed.copy(), hit.reshape(count, len(motion.h), -1).swapaxes(0, 1)
    ks, ns = np.nonzero(changed.any(axis=2) & ~changed.all(axis=2))
    com, ranges = np.stack([evidence.motion.com for evidence in copies]), np.stack([_ranges(each) for each in copies])
    touching = touching_of(copies)
    for start in range(0, len(ks), CHUNK):
        k, n = ks[start : start + CHUNK], ns[start : start + CHUNK]
        tied = motion.unit[:, None] == motion.unit
        frames = np.maximum(k - 1, 0), k, k + 1
        near = tied | np.any([_near(com[n, at], ranges[n, at]) for at in frames], axis=0)
        every[k, n] = _spread(changed[k, n], near)
        some = np.flatnonzero(np.any(every[k, n] != changed[k, n], axis=1))  # few, where bodies are far from each other
        if not len(some):
            continue
        k, n = k[some], n[some]
        struck = hits[k, n][:, :, None] | hits[k, n][:, None]
        touch = tied | (near[some] & struck) | _touch(touching, copies, k, n)
        changed[k, n] = _spread(changed[k, n], touch)
    touched, may = (np.ascontiguousarray(each.swapaxes(0, 1)).reshape(hit.shape) for each in (changed, every))
    return touched, may


def _touch(touching: Touching, copies: Sequence[Evidence], ks: Rows, ns: Rows) -> Bools:
    """Whether two bodies touch at either end of some intervals of copies, or a frame before, (K, B, B)."""
    each = np.stack([np.maximum(ks - 1, 0), ks, ks + 1])
    frames, which = np.unique(np.stack([np.tile(ns, (3, 1)), each]).reshape(2, -1), axis=1, return_inverse=True)
    poses = np.stack([copies[n].body_q[frame] for n, frame in frames.T])
    found = touching.near(poses, frames[0])[which.ravel()]
    return np.asarray(found.reshape(3, len(ks), *found.shape[1:]).any(axis=0))


def _seen(evidence: Evidence, size: Floats, unit: float) -> Floats:
    """Poses and velocities of each frame, (T, B, 13), by what they may differ by."""
    motion = evidence.motion
    speed = SPEED * unit * motion.dt_frames
    place, turn = evidence.body_q[..., :3] / (PLACE * size[:, None]), evidence.body_q[..., 3:] / PLACE
    return np.concatenate([place, turn, motion.v / speed, motion.w * size[:, None] / speed], axis=2)


def _changed(frames: Floats, intervals: Floats) -> Bools:
    """Whether anything of a body in an interval is more than one off what it was when it last was, (T - 1, W, B)."""
    found = np.ones(intervals.shape[:3], dtype=bool)
    if not len(found):
        return found
    steps = np.any(frames[1:] != frames[:-1], axis=(1, 2, 3))
    steps[1:] |= steps[:-1] | np.any(intervals[1:] != intervals[:-1], axis=(1, 2, 3))
    last = np.concatenate([frames[0], frames[1], intervals[0]], axis=2)
    for k in range(1, len(found)):
        if not steps[k]:  # to the bit
            found[k] = False
            continue
        now = np.concatenate([frames[k], frames[k + 1], intervals[k]], axis=2)
        found[k] = np.any(np.abs(now - last) > 1.0, axis=2)
        last[found[k]] = now[found[k]]
    return found


def _ranges(evidence: Evidence) -> Floats:
    """How far about its centre of mass each body may be in the intervals about a frame, (T, B) [m]."""
    motion = evidence.motion
    reach = np.concatenate([motion.reach, motion.reach[-1:]])
    margins = [max((shape.margin for shape in body.shapes), default=0.0) for body in evidence.world.bodies]
    return np.asarray(motion.radius + np.array(margins) + 2.0 * np.maximum(reach, np.roll(reach, 1, axis=0)))


def _near(com: Floats, ranges: Floats) -> Bools:
    """Whether two bodies may touch, (K, B, B), at their centres of mass (K, B, 3) with their ranges (K, B) [m]."""
    c = (com - com.mean(axis=1, keepdims=True)).astype(np.float32)
    square = np.einsum("kbi,kbi->kb", c, c)
    apart2 = square[:, :, None] + square[:, None, :] - 2.0 * c @ c.transpose(0, 2, 1)
    bound = (ranges[:, :, None] + ranges[:, None, :]).astype(np.float32) * 1.001 + 0.004
    return np.asarray(apart2 < bound * bound)


def _spread(some: Bools, near: Bools) -> Bools:
    """All that some bodies (K, B) are connected to."""
    links = near.astype(np.float32)
    while True:
        more = (links @ some[..., None].astype(np.float32))[..., 0] > 0.0
        if np.array_equal(more, some):
            return some
        some = more
