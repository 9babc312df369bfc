"""Objectives put to all worlds of a batch on its device, before any of them is read and judged in full.

What is a number of poses and velocities, taken together over frames, needs no recording: its least, its greatest or its
mean over a window is worked out where the numbers are (`wsim.kernels.screen`). A world in which such an objective fails
is rejected, whatever else may be wrong with it. No world is accepted here: one in which all of them hold, or in which
one is nearer to its limit than rounding goes, is judged in full.

Limits, windows and what a formula means are the language's (`wsim.judge.language`), which is asked for them at the
first frame. Only how a number follows from a frame is written a second time, in the kernel.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar

import numpy as np
import warp as wp

from wsim.forks import uncollected
from wsim.judge.decide import conclude
from wsim.judge.evidence.evidence import Evidence
from wsim.judge.evidence.recorded import MissingError
from wsim.judge.language.evaluate import first_of_last, frames_of
from wsim.judge.language.measure import MEASURERS
from wsim.judge.language.measures_way import DIRECTIONS
from wsim.judge.language.objective import ObjectiveCheck, conjuncts, formula_of
from wsim.judge.language.sentence import sentence
from wsim.judge.language.signals import Signals
from wsim.judge.language.trace import span_of
from wsim.kernels import screen as kernel
from wsim.plan.schema.formula import Always, Eventually, Finally, Formula, Mean, Not, Predicate
from wsim.plan.schema.formula_contact import Settles
from wsim.plan.schema.formula_motion import Moves
from wsim.plan.schema.formula_place import (
    Crosses,
    GoneBetween,
    Reaches,
    SpeedBetween,
    SpinBetween,
    StaysWithin,
    Upright,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.language.measure import Measure
    from wsim.judge.verdict import Finding, Verdict
    from wsim.plan.schema import Plan
    from wsim.recording.trajectories import Trajectories
    from wsim.scene.world import World
    from wsim.sim.tracks import Tracks

    Floats = NDArray[np.float64]

NEAR = 1e-4  # of a limit and of the margin: what is nearer than that to it is judged in full
AXES = {name: np.eye(3)[k] for k, name in enumerate("xyz")}
NOTHING = np.zeros(3)
Value = TypeVar("Value")


@dataclass(frozen=True)
class Number:
    """What is asked of a body at each frame, as `wsim.kernels.screen` has it."""

    what: int
    along: Floats
    other: str | None = None
    size: float = 0.0


def _settles(asked: Settles, signals: Signals) -> Number:
    return Number(kernel.FASTEST, NOTHING, size=signals.solid(asked.object).smallest / 2)


def _reaches(asked: Reaches, signals: Signals) -> Number | None:
    return None if isinstance(asked.target, str) else Number(kernel.DISTANCE, np.array(asked.target))


def _stays_within(asked: StaysWithin, signals: Signals) -> Number:
    if not isinstance(asked.center, str):
        return Number(kernel.DISTANCE, np.array(asked.center))
    if signals.moves(asked.center):
        return Number(kernel.DISTANCE, NOTHING, asked.center)
    return Number(kernel.DISTANCE, signals.centre(asked.center))


def _moves(asked: Moves, signals: Signals) -> Number:
    if asked.direction is None:
        return Number(kernel.LEVEL_WAY, signals.up)
    return Number(kernel.WAY, np.array([*DIRECTIONS[asked.direction], 0.0]))


def _gone(asked: GoneBetween, signals: Signals) -> Number | None:
    against = asked.of is not None and signals.moves(asked.of)  # whose turning counts, too
    return None if against else Number(kernel.WAY, AXES[asked.axis])


def _spins(asked: SpinBetween, signals: Signals) -> Number:
    other = asked.of if asked.of is not None and signals.moves(asked.of) else None
    return Number(kernel.RATE, AXES[asked.axis], other)


NUMBERS: dict[type[Predicate], Callable[[Any, Signals], Number | None]] = {
    Settles: _settles,
    SpeedBetween: lambda asked, _: Number(kernel.SPEED, NOTHING),
    Reaches: _reaches,
    StaysWithin: _stays_within,
    Crosses: lambda asked, _: Number(kernel.PLACE, AXES[asked.axis]),
    Moves: _moves,
    GoneBetween: _gone,
    Upright: lambda asked, signals: Number(kernel.TILT, signals.up),
    SpinBetween: _spins,
}
# Between frames the language sees what is nearer or farther along than at any, and what leans, strays or is faster: by
# frames alone no world is to be rejected for the first, nor for the second where that is denied.
KEPT_BETWEEN, LOST_BETWEEN = (Reaches, Crosses), (StaysWithin, SpeedBetween, Upright)


@dataclass(frozen=True)
class InTime:
    """A formula that is one number's least, greatest or mean over frames from `first` to before `last`."""

    predicate: Predicate
    how: int
    sign: float  # -1: the predicate is denied, and `how` is of its denial
    first: int
    last: int


def in_time(formula: Formula, time: Floats) -> InTime | None:
    """How a formula takes the frames together; None where otherwise. Raises MissingError as `evaluate` does."""
    if isinstance(formula, Not):
        found = in_time(formula.of, time)
        return None if found is None else _denied(found)
    if isinstance(formula, Predicate):
        return _alone(formula, time)
    if isinstance(formula, Mean) and isinstance(formula.of, Predicate):
        return InTime(formula.of, kernel.MEAN, 1.0, *frames_of(formula, time))
    if not isinstance(formula, Always | Eventually | Finally):
        return None
    inner, sign = formula.of, 1.0
    while isinstance(inner, Not):
        inner, sign = inner.of, -sign
    if not isinstance(inner, Predicate):
        return None
    if isinstance(formula, Finally):
        return InTime(inner, kernel.LEAST, sign, first_of_last(time, formula.seconds), len(time))
    low, high = span_of(time, len(time), formula.window)
    how = kernel.GREATEST if isinstance(formula, Eventually) else kernel.LEAST
    return InTime(inner, how, sign, int(low[0]), int(high[0]))


def _alone(predicate: Predicate, time: Floats) -> InTime:
    """A predicate that stands outside of every temporal operator, read with its own."""
    at_end = {"finally": None, "finally[0]": 0.0}
    first = first_of_last(time, at_end[predicate.alone]) if predicate.alone in at_end else 0
    last = 1 if predicate.alone == "now" else len(time)
    how = kernel.GREATEST if predicate.alone == "eventually" else kernel.LEAST
    return InTime(predicate, how, 1.0, first, last)


def _denied(found: InTime) -> InTime:
    """The least of a number's margins, denied, is the greatest of its denial's."""
    other = {kernel.LEAST: kernel.GREATEST, kernel.GREATEST: kernel.LEAST, kernel.MEAN: kernel.MEAN}
    return replace(found, how=other[found.how], sign=-found.sign)


@dataclass(frozen=True)
class Watched:
    """One conjunct of an objective, and what decides it in each of W worlds."""

    check: ObjectiveCheck
    said: str
    when: InTime
    measure: Measure  # of the first world
    numbers: list[Number]  # (W,), as the others
    low: Floats
    high: Floats


class OwnError(Exception):
    """What is asked is each world's own."""


class Together(Signals):
    """Worlds that state numbers of their own, as one, for as long as none of these is asked for."""

    def _own(self, *_: object) -> NoReturn:
        raise OwnError

    body = _own  # type: ignore[assignment]
    container = _own  # type: ignore[assignment]
    centre_of_mass = _own  # type: ignore[assignment]
    inertia_about = _own  # type: ignore[assignment]
    frames = _own
    posed = _own  # type: ignore[assignment]

    def centre(self, name: str) -> Floats:
        """Of what moves."""
        return super().centre(name) if self.moves(name) else self._own()


class Starts:
    """Worlds at their first frame: together, and each by itself, which takes longer."""

    def __init__(self, starts: Trajectories) -> None:
        self.count, self._starts = starts.world_count, starts
        arrays = starts.body_q, starts.body_qd, starts.contact_force
        kind = Together if starts.worlds else Signals
        self._together = [kind(starts.world, starts.time, *arrays, mass=starts.mass)]
        # What is up is asked of the first one alone.
        self._plumb = all(world.gravity == starts.world.gravity for world in starts.worlds)

    @cached_property
    def _each(self) -> list[Signals]:
        return [Signals.of_recording(self._starts.recording(k)) for k in range(self.count)]

    def ask(self, asked: Callable[[Signals], Value]) -> list[Value]:
        """One answer for all worlds, or one for each."""
        with contextlib.suppress(OwnError):
            if self._plumb:
                return [asked(signals) for signals in self._together]
        return [asked(signals) for signals in self._each]


def watched(plan: Plan, starts: Trajectories, time: Floats) -> list[Watched]:
    """What of a plan can be told of all worlds from their bodies' tracks.

    Args:
        plan: Whose objectives are asked.
        starts: The worlds at their first frame alone.
        time: Of all frames (T,) [s].
    """
    first, every = Evidence(starts.recording(0), plan), Starts(starts)
    found = []
    for objective in plan.objectives:
        with contextlib.suppress(MissingError):  # the judge says what is missing
            for formula in conjuncts(formula_of(objective, first)):
                found.append(_watch(ObjectiveCheck(objective), formula, every, time))
    return [one for one in found if one is not None]


def _watch(check: ObjectiveCheck, formula: Formula, starts: Starts, time: Floats) -> Watched | None:
    when = in_time(formula, time)
    kind = None if when is None else type(when.predicate)
    if when is None or kind not in NUMBERS or kind in (KEPT_BETWEEN if when.sign > 0.0 else LOST_BETWEEN):
        return None
    asked, count = when.predicate, starts.count
    numbers = starts.ask(
        lambda signals: NUMBERS[kind](asked, signals) if signals.moves(asked.object) else None  # type: ignore[attr-defined]
    )
    if any(number is None for number in numbers):
        return None
    measures = starts.ask(lambda signals: MEASURERS[kind](asked, signals))
    bounds = [_range_of(found, count // len(measures)) for found in measures]
    low, high = np.concatenate(bounds, axis=1)
    every = [number for number in numbers if number is not None] * (count // len(numbers))
    return Watched(check, sentence(formula), when, measures[0][0], every, low, high)


def _range_of(measures: list[Measure], count: int) -> Floats:
    """The bounds of the number that all measures of a predicate are of, (2, W)."""
    low, high = np.full(count, -np.inf), np.full(count, np.inf)
    for measure in measures:
        limit, at_most = (np.broadcast_to(of, (count, 1))[:, 0] for of in (measure.limit, measure.at_most))
        low = np.where(at_most, low, np.maximum(low, limit))
        high = np.where(at_most, np.minimum(high, limit), high)
    return np.stack([low, high])


@dataclass(frozen=True)
class Told:
    """What M objectives come to in W worlds, (M, W) each."""

    margin: Floats  # positive: it holds; NaN: the world's numbers are not all finite
    value: Floats  # that decides, or the mean
    moment: NDArray[np.int32]  # the frame that decides


def reduce(asked: Sequence[Watched], q: Any, qd: Any, world: World) -> Told:
    """Work out what is asked, on the device that the bodies' tracks are on.

    Args:
        asked: M objectives.
        q: Poses by world, frame and body.
        qd: Velocities likewise.
        world: What all state alike.
    """
    rows = {body.prim: row for row, body in enumerate(world.bodies)}
    device, shape = q.device, (len(asked), q.shape[0])

    def row(name: str | None) -> int:
        return kernel.NONE if name is None else rows[Evidence.prim(name) if not name.startswith("/") else name]

    numbers = [[one.numbers[w] for w in range(shape[1])] for one in asked]
    whole = {
        "what": [each[0].what for each in numbers],
        "body": [row(one.when.predicate.object) for one in asked],  # type: ignore[attr-defined]
        "other": [row(each[0].other) for each in numbers],
        "how": [one.when.how for one in asked],
    }
    margin, value = (wp.zeros(shape, dtype=wp.float64, device=device) for _ in range(2))
    moment = wp.zeros(shape, dtype=int, device=device)
    doubles = [
        [[number.size for number in each] for each in numbers],
        [one.low for one in asked],
        [one.high for one in asked],
    ]
    broken = wp.zeros(shape[1], dtype=int, device=device)
    wp.launch(kernel.find_broken, dim=q.shape, inputs=[q, qd], outputs=[broken], device=device)
    wp.launch(
        kernel.reduce_objectives,
        dim=shape,
        inputs=[
            q,
            qd,
            broken,
            *(wp.array(of, dtype=int, device=device) for of in whole.values()),
            wp.array([one.when.sign for one in asked], dtype=wp.float64, device=device),
            wp.array([one.when.first for one in asked], dtype=int, device=device),
            wp.array([one.when.last for one in asked], dtype=int, device=device),
            wp.array([[number.along for number in each] for each in numbers], dtype=wp.vec3d, device=device),
            *(wp.array(np.array(of), dtype=wp.float64, device=device) for of in doubles),
        ],
        outputs=[margin, value, moment],
        device=device,
    )
    return Told(margin.numpy(), value.numpy(), moment.numpy())


@uncollected()
def rejected(tracks: Tracks, plan: Plan | None) -> dict[int, Verdict]:
    """The verdicts on worlds of which an objective is known to fail, by their number."""
    world = tracks.simulation.world
    if plan is None or tracks.bodies is None or world.foreign:
        return {}
    asked = watched(plan, tracks.read_starts(), tracks.time)
    if not asked:
        return {}
    told = reduce(asked, tracks.bodies.q, tracks.bodies.qd, world)
    limits = np.stack([np.where(np.isfinite(one.low), one.low, one.high) for one in asked])
    fails = told.margin < -NEAR * (np.abs(limits) + np.abs(told.margin))
    return {int(w): _verdict(asked, told, int(w), tracks.time) for w in np.flatnonzero(fails.any(axis=0))}


def _verdict(asked: Sequence[Watched], told: Told, w: int, time: Floats) -> Verdict:
    verdict = conclude([_finding(one, told, m, w, time) for m, one in enumerate(asked)])
    return verdict.model_copy(update={"summary": f"{verdict.summary} All else was not judged."})


def _finding(one: Watched, told: Told, m: int, w: int, time: Floats) -> Finding:
    """As the language has it (`wsim.judge.language.objective`), without what to change."""
    value, moment, measure = float(told.value[m, w]), float(time[told.moment[m, w]]), one.measure
    at_most = bool(one.high[w] - value <= value - one.low[w])
    limit = float(one.high[w] if at_most else one.low[w])
    at_most ^= one.when.sign < 0.0  # the limit is kept from the other side
    holds = "holds" if told.margin[m, w] >= 0.0 else "does not hold"
    unit = "" if measure.unit == "1" else f" {measure.unit}"
    mean = "mean " if one.when.how == kernel.MEAN else ""
    when = "from" if mean else "at"
    return one.check.measured(
        f"{one.said} {holds}: the {mean}{measure.what} of {measure.prim} is {value:.4g}{unit} {when} {moment:.3f} s, "
        f"where {limit:.4g}{unit} is the {'most' if at_most else 'least'}",
        value, limit, measure.unit, at_most=at_most, objective=one.check.asks, prim=measure.prim, time=moment,
    )  # fmt: skip
