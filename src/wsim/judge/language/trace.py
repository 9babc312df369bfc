"""Robustness through time: the minima and maxima of signal temporal logic, over all worlds at once.

Robust semantics after Fainekos and Pappas (2009) and Donze and Maler (2010). Each robustness is plus or minus that of
one measure at one frame; which one it is travels along, so that a verdict can say what decided it and when.
A robustness that is not a number takes every minimum and every maximum that it is in: nothing that depends on it holds.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce
from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.evidence.recorded import MissingError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Indices = NDArray[np.intp]
    Between = tuple[float, float | None]  # [s]

SAME = 1e-6  # [s]: times nearer than this are one frame; far below a frame, above what float32 loses in a minute


@dataclass(eq=False)
class Trace:
    """A formula's robustness at the first n frames: those from which all that it looks at was recorded."""

    robustness: Floats  # (W, n)
    source: NDArray[np.int32]  # (W, n): measure * T + frame

    def __len__(self) -> int:
        return int(self.robustness.shape[1])

    def first(self, n: int) -> Trace:
        """Its first n frames."""
        return Trace(self.robustness[:, :n], self.source[:, :n])

    def at(self, frames: slice | Indices) -> Trace:
        """Its values at some frames."""
        return Trace(self.robustness[:, frames], self.source[:, frames])

    def negated(self) -> Trace:
        """Of the formula's denial."""
        return Trace(-self.robustness, self.source)


def pick(a: Trace, b: Trace, greatest: bool) -> Trace:
    """The smaller or the greater of two at each frame; of equals the first; what is no number before all others."""
    n = min(len(a), len(b))
    x, y = a.robustness[:, :n], b.robustness[:, :n]
    better = y > x if greatest else y < x
    with_b = better | (np.isnan(y) & ~np.isnan(x))
    return Trace(np.where(with_b, y, x), np.where(with_b, b.source[:, :n], a.source[:, :n]))


def pick_all(traces: list[Trace], greatest: bool) -> Trace:
    """The smallest or the greatest of several at each frame."""
    return reduce(lambda a, b: pick(a, b, greatest), traces)


def span_of(time: Floats, n: int, window: Between | None, after: bool = False) -> tuple[Indices, Indices]:
    """The frames [low, high) of a window, seen from each frame from which it is covered.

    Args:
        time: (T,) [s].
        n: Frames at which what is looked for is known.
        window: From and to [s]; None is to the end.
        after: Whether the window starts with the next frame at the earliest.

    Raises:
        MissingError: The recording covers the window from no frame, or a window holds no frame.
    """
    start, end = window if window is not None else (0.0, None)
    step = float(np.median(np.diff(time))) if len(time) > 1 else 0.0
    low = np.searchsorted(time[:n], time + start - SAME)
    if after:
        low = np.maximum(low, np.arange(1, len(time) + 1))
    if end is None:
        high, covered = np.full(len(time), n), low < n
    else:
        high = np.searchsorted(time[:n], time + end + SAME, side="right")
        covered = time + end <= time[n - 1] + step / 2 + SAME
    count = int(covered.sum())
    said = f"[{start:g}, {'end' if end is None else f'{end:g}'}] s"
    if count == 0:
        seen = f"{time[n - 1] - time[0]:.4g} s of it" if n < len(time) else f"{time[-1] - time[0]:.4g} s"
        raise MissingError(
            f"the window {said} is not covered: the recording has {seen} to look at; record longer, or shorten it"
        )
    if np.any(low[:count] >= high[:count]):
        raise MissingError(f"the window {said} holds no frame: they are {step:.4g} s apart; widen it by as much")
    return low[:count], high[:count]


def following(trace: Trace, time: Floats, window: Between | None, event: Trace) -> Trace:
    """The greatest robustness in a window after each frame, as far as was recorded: what is to follow may still come.

    The window opens with the next frame at the earliest and closes with the last one. Where nothing is left of it
    nothing follows: that is farther from holding than the trace, or the event that it follows, ever is.
    """
    n = len(trace)
    start, end = window if window is not None else (0.0, None)
    low = np.maximum(np.searchsorted(time[:n], time + start - SAME), np.arange(1, len(time) + 1))
    high = np.full(len(time), n) if end is None else np.searchsorted(time[:n], time + end + SAME, side="right")
    some = low < high
    span_of(time, n, window, after=True)  # from the first frame on it must be covered, and hold frames
    found = extreme(trace, np.where(some, low, 0), np.where(some, high, 1), greatest=True)
    never = -sum(np.max(np.abs(each.robustness), axis=1, keepdims=True) for each in (trace, event))
    return Trace(np.where(some, found.robustness, never), np.where(some, found.source, trace.source[:, -1:]))


def extreme(trace: Trace, low: Indices, high: Indices, greatest: bool) -> Trace:
    """The smallest or greatest robustness of each range of frames [low, high).

    Ranges are met by two that overlap and whose length is a power of two; those are built by doubling.
    """
    level = np.frexp(high - low)[1] - 1  # floor(log2(length))
    robustness = np.empty((len(trace.robustness), len(low)))
    source = np.empty(robustness.shape, dtype=np.int32)
    for k in range(int(level.max()) + 1):
        here = np.flatnonzero(level == k)
        if len(here):
            best = pick(trace.at(low[here]), trace.at(high[here] - 2**k), greatest)
            robustness[:, here], source[:, here] = best.robustness, best.source
        trace = pick(trace, trace.at(slice(2**k, None)), greatest) if len(trace) > 2**k else trace
    return Trace(robustness, source)


def until(hold: Trace, goal: Trace, time: Floats, window: Between | None) -> Trace:
    """`hold` at every frame before one of the window at which `goal` is.

    With a window [a, b] it is split as by Donze, Ferrere and Maler (2013): the goal within [a, b], and the same without
    a latest time, which is `hold` up to a and from there until without a window.
    """
    n = min(len(hold), len(goal))
    plain = _until_any_time(hold.first(n), goal.first(n))
    if window is None:
        return plain
    low, high = span_of(time, n, window)
    result = plain.at(low)
    if window[1] is not None:
        result = pick(extreme(goal, low, high, greatest=True), result, greatest=False)
    waits = np.flatnonzero(low > np.arange(len(low)))
    if len(waits):
        before = extreme(hold, waits, low[waits], greatest=False)
        both = pick(before, result.at(waits), greatest=False)
        result.robustness[:, waits], result.source[:, waits] = both.robustness, both.source
    return result


def _until_any_time(hold: Trace, goal: Trace) -> Trace:
    """From the last frame backwards: the goal now, or `hold` now and until from the next frame."""
    robustness, source = goal.robustness.copy(), goal.source.copy()
    ahead = goal.at(slice(len(goal) - 1, None))
    for k in range(len(goal) - 2, -1, -1):
        now = slice(k, k + 1)
        ahead = pick(goal.at(now), pick(hold.at(now), ahead, greatest=False), greatest=True)
        robustness[:, now], source[:, now] = ahead.robustness, ahead.source
    return Trace(robustness, source)
