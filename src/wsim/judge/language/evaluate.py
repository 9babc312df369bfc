"""A formula put to signals: how far each world is from breaking or keeping it, what decides that, and when."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from wsim.judge.evidence.final_window import final_window
from wsim.judge.evidence.recorded import MissingError
from wsim.judge.language import (
    measures_carried,
    measures_contact,
    measures_fluid,
    measures_place,
    measures_turn,
    measures_way,
    measures_whole,
)
from wsim.judge.language.measure import MEASURERS, Measure
from wsim.judge.language.trace import Trace, extreme, following, pick, pick_all, span_of, until
from wsim.plan.schema.formula import (
    Always,
    And,
    Eventually,
    Finally,
    Formula,
    Mean,
    Node,
    Not,
    Or,
    Ordered,
    Predicate,
    Then,
    Until,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.language.signals import Signals

    Floats = NDArray[np.float64]

PREDICATES = (
    measures_carried,
    measures_contact,
    measures_fluid,
    measures_place,
    measures_turn,
    measures_way,
    measures_whole,
)  # importing them registers them


@dataclass(eq=False)
class Outcome:
    """What a formula comes to in each of W worlds."""

    satisfied: NDArray[np.bool_]  # (W,)
    margin: Floats  # (W,), of the measure that decides, in its unit; positive = satisfied, -inf where not finite
    robustness: Floats  # (W,): the margin, or where units are mixed its share of its scale
    moment: Floats  # (W,) [s]: the frame that decides
    measure: NDArray[np.integer[Any]]  # (W,): which of `measures` decides
    measures: list[Measure]
    predicates: list[Predicate]  # that each of the measures is of

    @property
    def units(self) -> list[str]:
        """The unit of each world's margin."""
        return [self.measures[m].unit for m in self.measure]


def evaluate(formula: Formula, signals: Signals) -> Outcome:
    """Evaluate a formula on W worlds, from their first frame on.

    A predicate outside of every temporal operator is read with its own: `touches(a, b)` is `eventually(touches(a, b))`
    (`Predicate.alone`). Where all measures have one unit, robustness is in it; else margins are compared as shares of
    their scales.

    Raises:
        MissingError: A name is not known, a window is not covered by the recording, or a signal was not recorded.
    """
    return _Evaluation(signals).outcome(formula)


class _Evaluation:
    """One formula on some signals: its measures, each taken once, and the traces of its nodes."""

    def __init__(self, signals: Signals) -> None:
        self.signals = signals
        self.measures: list[Measure] = []
        self.margins: list[Floats] = []
        self.predicates: list[Predicate] = []
        self.rows: dict[Node, list[int]] = {}
        self.shared_unit = True

    def outcome(self, formula: Formula) -> Outcome:
        self._measure(formula)
        self.shared_unit = len({measure.unit for measure in self.measures}) == 1
        trace = self._trace(formula, timed=False)
        robustness, source = trace.robustness[:, 0], trace.source[:, 0]
        frames, worlds = len(self.signals.time), np.arange(self.signals.count)
        measure, frame = source // frames, source % frames
        sizes = np.abs(np.stack([margin[worlds, frame] for margin in self.margins])[measure, worlds])
        known = np.isfinite(robustness)
        return Outcome(
            satisfied=robustness >= 0.0,
            margin=np.where(known, np.copysign(sizes, robustness), -np.inf),
            robustness=np.where(known, robustness, -np.inf),
            moment=self.signals.time[frame],
            measure=measure,
            measures=self.measures,
            predicates=self.predicates,
        )

    # ---- predicates
    def _measure(self, formula: Formula) -> None:
        """Take the measures of every predicate of the formula; events of an `ordered` are measured by themselves."""
        if isinstance(formula, (Predicate, Mean)):
            if formula not in self.rows:
                predicate, found = self._measures_of(formula)
                self.rows[formula] = list(range(len(self.measures), len(self.measures) + len(found)))
                self.measures += found
                self.predicates += [predicate] * len(found)
                self.margins += [self._known(predicate, measure) for measure in found]
            return
        for part in formula.parts():
            self._measure(part)

    def _measures_of(self, node: Predicate | Mean) -> tuple[Predicate, list[Measure]]:
        """The predicate that a node is, or is the mean of, and its measures."""
        if isinstance(node, Ordered):
            return node, [self._order(node)]
        if isinstance(node, Predicate):
            return node, self._of_predicate(node)
        assert isinstance(node.of, Predicate)  # as a plan makes sure
        shape = (self.signals.count, len(self.signals.time))
        frames = frames_of(node, self.signals.time)
        return node.of, [measure.averaged(shape, *frames) for measure in self._of_predicate(node.of)]

    def _of_predicate(self, predicate: Predicate) -> list[Measure]:
        for name in sorted(predicate.objects_named()):
            self.signals.prim(name)
        return MEASURERS[type(predicate)](predicate, self.signals)

    def _known(self, predicate: Predicate, measure: Measure) -> Floats:
        """The margin (W, T), NaN wherever the pose of an object that is spoken of is not finite."""
        shape = (self.signals.count, len(self.signals.time))
        margin = np.broadcast_to(measure.margin, shape)
        rows = [self.signals.row(name) for name in predicate.names() if self.signals.moves(name)]
        finite = np.isfinite(self.signals.body_q[:, :, rows]).all(axis=(2, 3))
        return np.where(finite, margin, np.nan)

    def _order(self, ordered: Ordered) -> Measure:
        """From each frame on, the least time from an event's first moment to that of the next one, (W, T) [s]."""
        signals = self.signals
        traces = []
        for event in ordered.events:
            own = _Evaluation(signals)
            own._measure(event)
            own.shared_unit = False
            traces.append(own._trace(event, timed=True))
        n = min(len(trace) for trace in traces)
        unknown = np.any([np.isnan(trace.robustness[:, :n]) for trace in traces], axis=0)
        never = np.iinfo(np.intp).max
        moments = []
        for trace in traces:
            holds = np.where(trace.robustness[:, :n] >= 0.0, np.arange(n), never)
            following = np.minimum.accumulate(holds[:, ::-1], axis=1)[:, ::-1]
            moments.append(np.where(following < never, signals.time[np.minimum(following, n - 1)], np.nan))
        least = np.min(np.diff(moments, axis=0), axis=0)
        # An event that never happens breaks the order by all the time that there was for it.
        left = signals.time[n - 1] - signals.time[:n] + signals.step
        value = np.where(np.isnan(least), -left, least)
        tail = np.logical_or.accumulate(unknown[:, ::-1], axis=1)[:, ::-1]
        whole = np.full((signals.count, len(signals.time)), np.nan)
        whole[:, :n] = np.where(tail, np.nan, value)
        source = f"half of the time between two frames, {signals.step:.3g} s: nearer events have no order"
        prim = signals.prim(min(ordered.names()))
        return Measure(
            "least time from one event to the next", prim, whole, signals.step / 2, "s",
            max(float(signals.time[-1] - signals.time[0]), signals.step, 1e-9), source, at_most=False,
        )  # fmt: skip

    # ---- traces
    def _trace(self, formula: Formula, timed: bool) -> Trace:
        if isinstance(formula, Predicate):
            return self._in_time(formula) if not timed else self._frames(formula)
        if isinstance(formula, Mean):
            return self._of_means(formula)
        if isinstance(formula, (And, Or)):
            return pick_all([self._trace(part, timed) for part in formula.of], greatest=isinstance(formula, Or))
        if isinstance(formula, Not):
            return self._trace(formula.of, timed).negated()
        if isinstance(formula, (Always, Eventually)):
            inner = self._trace(formula.of, timed=True)
            low, high = span_of(self.signals.time, len(inner), formula.window)
            return extreme(inner, low, high, greatest=isinstance(formula, Eventually))
        if isinstance(formula, Finally):
            return self._at_the_end(self._trace(formula.of, timed=True), formula.seconds)
        if isinstance(formula, Until):
            hold, goal = self._trace(formula.hold, timed=True), self._trace(formula.goal, timed=True)
            return until(hold, goal, self.signals.time, formula.window)
        assert isinstance(formula, Then)  # the one kind of node that is left
        return self._one_after_another(formula)

    def _in_time(self, predicate: Predicate) -> Trace:
        """A predicate that stands outside of every temporal operator."""
        trace = self._frames(predicate)
        if predicate.alone == "now":
            return trace
        if predicate.alone.startswith("finally"):
            return self._at_the_end(trace, 0.0 if predicate.alone == "finally[0]" else None)
        low, high = span_of(self.signals.time, len(trace), None)
        return extreme(trace, low, high, greatest=predicate.alone == "eventually")

    def _of_means(self, mean: Mean) -> Trace:
        """The same at each frame; what decides is where the means begin."""
        trace, (first, _) = self._frames(mean), frames_of(mean, self.signals.time)
        frames = len(self.signals.time)
        return Trace(trace.robustness, (trace.source // frames * frames + first).astype(np.int32))

    def _frames(self, predicate: Node) -> Trace:
        """A predicate's robustness at each frame: the least of its measures."""
        traces = []
        frames = len(self.signals.time)
        for row in self.rows[predicate]:
            scale = 1.0 if self.shared_unit else self.measures[row].scale
            robustness = self.margins[row] / np.where(np.asarray(scale) > 0.0, scale, 1.0)
            source = np.broadcast_to(np.arange(frames, dtype=np.int32) + row * frames, robustness.shape)
            traces.append(Trace(robustness, source))
        return pick_all(traces, greatest=False)

    def _at_the_end(self, inner: Trace, seconds: float | None) -> Trace:
        """The least over the last seconds, the same at each frame."""
        time = self.signals.time
        if len(inner) < len(time):
            raise MissingError("what is to hold at the end looks beyond it; take the window out of it")
        low = first_of_last(time, seconds)
        least = extreme(inner, np.array([low]), np.array([len(time)]), greatest=False)
        return Trace(np.repeat(least.robustness, len(time), axis=1), np.repeat(least.source, len(time), axis=1))

    def _one_after_another(self, formula: Then) -> Trace:
        """From the last event backwards: this event, and in its window after it the rest; at any time from now on."""
        time = self.signals.time
        rest = self._trace(formula.events[-1], timed=True)
        for event, window in zip(formula.events[-2::-1], formula.windows[::-1], strict=True):
            first = self._trace(event, timed=True)
            rest = pick(first, following(rest, time, window, first), greatest=False)
        low, high = span_of(time, len(rest), None)
        return extreme(rest, low, high, greatest=True)


def first_of_last(time: Floats, seconds: float | None) -> int:
    """The first frame of the last seconds, or of the final window; MissingError where they are not covered."""
    span, step = float(time[-1] - time[0]), float(np.median(np.diff(time))) if len(time) > 1 else 0.0
    wanted = final_window(span) if seconds is None else seconds
    if wanted > span + step / 2:
        raise MissingError(f"the last {wanted:g} s are not covered: the recording has {span:.4g} s; record longer")
    return int(np.searchsorted(time, time[-1] - wanted - 1e-6))


def frames_of(mean: Mean, time: Floats) -> tuple[int, int]:
    """The frames [low, high) that a mean is over; MissingError where they are not covered, or there is none."""
    if mean.window is None:
        return first_of_last(time, mean.seconds), len(time)
    low, high = span_of(time, len(time), mean.window)
    return int(low[0]), int(high[0])
