"""Predicates about how a motion goes on: what swings, and what is conserved."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.evidence.motion import FLOAT32
from wsim.judge.evidence.pendulum import Pendulum, period_of, pivot_of
from wsim.judge.evidence.welded import welded
from wsim.judge.language.between import Course
from wsim.judge.language.measure import Measure, measures, mends
from wsim.judge.language.measures_place import latest
from wsim.judge.repair.drive import drive_of
from wsim.judge.repair.lasting import leak
from wsim.judge.repair.matter import damped, friction
from wsim.judge.repair.rule import longer_run, shorter_step
from wsim.judge.verdict import Finding, RepairTarget
from wsim.plan.schema.formula_motion import ClimbsTo, Conserves, DiesDown, Swings

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.language.signals import Signals
    from wsim.scene.world import Fluid

    Floats = NDArray[np.float64]

FAINT = 0.02  # of the farthest way: what goes less far trembles
REST = 0.5  # [deg]: a smaller swing is rest


@measures(Swings)
def _swings(asked: Swings, signals: Signals) -> list[Measure]:
    prim = signals.prim(asked.object)
    swing = _pendulum(signals, asked.object)
    half, highest = _half_swings(signals.time, swing.angle, _farthest(signals.time, swing))
    if asked.period is None:
        expected = period_of(swing, signals.gravity)[:, None]
        source = f"2 pi sqrt(I / m g d) at its amplitude, to {asked.share:.0%}"
    else:
        expected, source = np.full((signals.count, 1), asked.period), f"the objective's, to {asked.share:.0%}"
    # A body that does not pass its middle twice has a period of twice its time at least, which may be long enough to
    # tell; else it is not known.
    length = 2 * float(signals.time[-1] - signals.time[0])
    too_long = np.where(length > expected * (1 + asked.share), length, np.nan)
    value = np.where(np.isfinite(half), 2 * half, np.where(np.isfinite(swing.angle), too_long, np.nan))
    found = [
        Measure.about(
            value, expected, asked.share * expected, what="period", prim=prim, unit="s", limit_from=source
        )
    ]  # fmt: skip
    if asked.amplitude is None:
        what, source = "amplitude", "a smaller swing is rest"
        found.append(Measure(what, prim, highest, REST, "deg", REST, source, at_most=False))
    else:
        found.append(
            Measure.about(
                highest, asked.amplitude, asked.share * asked.amplitude, what="amplitude", prim=prim, unit="deg",
                limit_from=f"the objective's, to {asked.share:.0%}",
            )
        )  # fmt: skip
    return found


def _pendulum(signals: Signals, name: str) -> Pendulum:
    """The body, with what fixed joints hold to it, as a pendulum about the point that its own velocities turn about."""
    i = signals.row(name)
    twist = signals.qd(name)
    pivot, axis = pivot_of(signals.centre_of_mass(i), twist[..., :3], twist[..., 3:])
    parts = welded(signals.frames(*(body.prim for body in signals.world.bodies)), i)
    assert signals.mass is not None
    masses = signals.mass[:, parts]
    centres = np.stack([signals.centre_of_mass(k) for k in parts], axis=1)  # (W, parts, T, 3)
    mass = masses.sum(axis=1)
    arms = _across(centres - pivot[:, None, None], axis)
    arm = np.einsum("wb,wbti->wti", masses, arms) / mass[:, None, None]
    down = -signals.up
    angle = np.arctan2(np.einsum("wti,wi->wt", np.cross(np.broadcast_to(down, arm.shape), arm), axis), arm @ down)
    own = sum(signals.inertia_about(k, axis[:, None])[:, 0] for k in parts)
    inertia = own + (masses * np.mean(np.sum(arms**2, axis=-1), axis=-1)).sum(axis=1)
    rate = np.einsum("wti,wi->wt", twist[..., 3:], axis)
    return Pendulum(angle, rate, mass, np.linalg.norm(arm, axis=-1).mean(axis=1), inertia)


def _across(ways: Floats, axis: Floats) -> Floats:
    """Ways (W, B, T, 3) without what goes along axes (W, 3)."""
    return np.asarray(ways - np.einsum("wbti,wi->wbt", ways, axis)[..., None] * axis[:, None, None])


def _farthest(time: Floats, swing: Pendulum) -> Floats:
    """The greatest angle to either side at each frame, and up to the next where it turns back before that (W, T)."""
    course = Course(time, swing.angle[..., None], swing.rate[..., None], np.zeros(1))
    between = np.maximum(course.greatest(np.ones(1)), -course.least(np.ones(1)))
    ends = np.abs(swing.angle)
    turns = swing.angle[:, :-1] * swing.angle[:, 1:] > 0.0
    return np.concatenate([np.where(turns, between, ends[:, :-1]), ends[:, -1:]], axis=1)


def _half_swings(time: Floats, angle: Floats, farthest: Floats) -> tuple[Floats, Floats]:
    """Length of the half swing that each frame is in, or is nearest to [s], and how far it goes [deg], (W, T) each.

    A half swing is from one passage of the middle to the next. Of those that the recording begins and ends in not all
    is seen: each is as long, and goes as far, as the nearest whole one, or more where it is seen to. The length is NaN
    in a world that passes the middle less than twice.
    """
    count, frames = angle.shape
    if frames < 2:
        return np.full(angle.shape, np.nan), np.degrees(farthest)
    a, b = angle[:, :-1], angle[:, 1:]
    passes = (a * b < 0.0) | ((a == 0.0) & (b != 0.0) & (np.arange(frames - 1) > 0))
    moment = time[:-1] - a * np.diff(time) / np.where(passes, b - a, 1.0)
    last = np.maximum.accumulate(np.where(passes, moment, -np.inf), axis=1)
    following = np.minimum.accumulate(np.where(passes, moment, np.inf)[:, ::-1], axis=1)[:, ::-1]
    # The frame k is after the passages of the intervals up to k - 1, and before those from k on.
    edge = np.full((count, 1), np.inf)
    until, since = np.concatenate([following, edge], axis=1), np.concatenate([-edge, last], axis=1)
    whole = np.isfinite(until - since)
    half = np.minimum(until, time[-1]) - np.maximum(since, time[0])
    swing = np.concatenate([np.zeros((count, 1), np.intp), np.cumsum(passes, axis=1)], axis=1)
    highest = np.zeros((count, int(swing.max()) + 1))
    np.maximum.at(highest, (np.arange(count)[:, None], swing), farthest)
    far = np.take_along_axis(highest, swing, axis=1)
    half, far = (np.where(whole, seen, _at_least(seen, whole)) for seen in (half, far))
    return np.where(whole.any(axis=1, keepdims=True), half, np.nan), np.degrees(far)


def _at_least(values: Floats, known: NDArray[np.bool_]) -> Floats:
    """Each number (W, T), or the nearest known one before it, or else after it, if that is greater."""
    frames = np.arange(values.shape[1])
    before = np.maximum.accumulate(np.where(known, frames, -1), axis=1)
    after = np.minimum.accumulate(np.where(known, frames, frames[-1])[:, ::-1], axis=1)[:, ::-1]
    return np.maximum(values, np.take_along_axis(values, np.where(before >= 0, before, after), axis=1))


@measures(DiesDown)
def _dies_down(asked: DiesDown, signals: Signals) -> list[Measure]:
    """The worst share of a way between two turning points over that two ways before it, at every frame (W, T)."""
    axis = np.eye(3)["xyz".index(asked.axis)]
    course = signals.course(asked.object)
    place, low, high = course.place @ axis, course.least(axis), course.greatest(axis)
    shares = [_worst_share(_points(*each)) for each in zip(place, low, high, strict=True)]
    value = np.repeat(np.array(shares)[:, None], len(signals.time), axis=1)
    source = "the objective's: of the way two turns before, the same way round"
    return [
        Measure("share that it goes as far", signals.prim(asked.object), value, asked.share, "1", asked.share, source)
    ]


def _points(place: Floats, low: Floats, high: Floats) -> Floats:
    """Places at frames (T,) and, where it turns between two of them, there, in their order."""
    ends = np.stack([place[:-1], place[1:]])
    turned = np.where(low < ends.min(axis=0), low, np.where(high > ends.max(axis=0), high, ends[0]))
    return np.append(np.stack([place[:-1], turned], axis=1).ravel(), place[-1:])


def _worst_share(place: Floats) -> float:
    """Of one world's places (N,); infinite where it turns back too seldom to tell, NaN where it is not finite."""
    if not np.isfinite(place).all():
        return math.nan
    # The last one is broken off where the recording ends: it may be as far, but not farther, than it is seen.
    ways = np.abs(np.diff(_turning_points(place, FAINT * float(np.ptp(place)))))
    ways = ways[: len(ways) - (len(ways) > 3)]
    return float((ways[2:] / ways[:-2]).max()) if len(ways) > 2 else math.inf


def _turning_points(place: Floats, faint: float) -> Floats:
    """The start, the places from which it goes back by more than what is faint, and the end, (N,)."""
    found, far, way = [place[0]], place[0], 0.0
    for here in place:
        if way == 0.0 and abs(here - place[0]) > faint:
            way = math.copysign(1.0, here - place[0])
        if way * (here - far) >= 0.0:
            far = here
        elif way * (far - here) > faint:
            found.append(far)
            far, way = here, -way
    return np.array([*found, place[-1] if way * (far - place[-1]) <= 0.0 else far])


@measures(ClimbsTo)
def _climbs_to(asked: ClimbsTo, signals: Signals) -> list[Measure]:
    course, height = signals.course(asked.object), signals.centre_of_mass(signals.row(asked.object)) @ signals.up
    # Of each frame what is known from the one before it on: lowest and highest are between frames.
    low, high = (
        np.concatenate([height[:, :1], each], axis=1)
        for each in (course.least(signals.up), course.greatest(signals.up))
    )
    lowest = np.minimum.accumulate(low, axis=1)
    fall = height[:, :1] - lowest
    least = FLOAT32 * max(signals.solid(asked.object).smallest, float(np.nanmax(np.abs(height), initial=0.0)))
    # Where it falls on, it has not come up from what it falls to.
    above = np.where(low > lowest, high, height) - lowest
    value = np.where(fall > least, above / np.maximum(fall, least), 0.0)
    what, source = "share of its start's height", "the objective's, over its lowest place so far"
    prim = signals.prim(asked.object)
    return [Measure(what, prim, value, asked.share, "1", asked.share, source, at_most=False, expected=1.0)]


@measures(Conserves)
def _conserves(asked: Conserves, signals: Signals) -> list[Measure]:
    if asked.what == "mass":
        return [_mass(asked, signals)]
    rows = [signals.row(name) for name in asked.objects] or [
        i for i, body in enumerate(signals.world.bodies) if not body.kinematic
    ]
    prim = signals.world.bodies[rows[0]].prim if len(rows) == 1 else "/World"
    change, scale = (_energy if asked.what == "energy" else _momentum)(signals, rows)
    unit = "J" if asked.what == "energy" else "kg m/s"
    limit = asked.share * scale
    source = f"{asked.share:g} of the {asked.what} that moves, {float(np.nanmedian(scale)):.3g} {unit}"
    return [Measure(f"change of {asked.what}", prim, change, limit, unit, scale, source, expected=0.0)]


def _energy(signals: Signals, rows: list[int]) -> tuple[Floats, Floats]:
    """Change of kinetic and potential energy (W, T), and how much of either comes and goes (W, 1) [J]."""
    assert signals.mass is not None
    kinetic, potential = np.zeros((2, signals.count, len(signals.time)))
    size = np.zeros((signals.count, 1))
    for i in rows:
        mass, twist = signals.mass[:, [i]], signals.body_qd[:, :, i].astype(np.float64)
        own = -mass * (signals.centre_of_mass(i) @ np.array(signals.world.gravity))
        kinetic += mass * np.einsum("wti,wti->wt", twist[..., :3], twist[..., :3]) / 2
        kinetic += signals.inertia_about(i, twist[..., 3:]) / 2
        potential += own
        size = size + np.abs(own).max(axis=1, keepdims=True)
    total = kinetic + potential
    moved = np.maximum(kinetic.max(axis=1, keepdims=True), np.ptp(potential, axis=1, keepdims=True))
    return np.abs(total - total[:, :1]), moved + size * FLOAT32 + np.finfo(np.float32).tiny


def _momentum(signals: Signals, rows: list[int]) -> tuple[Floats, Floats]:
    """Change of the momentum that gravity leaves (W, T), and the sum of the sizes of all momenta (W, 1) [kg m/s]."""
    assert signals.mass is not None
    total, size = np.zeros((signals.count, len(signals.time), 3)), np.zeros((signals.count, len(signals.time)))
    for i in rows:
        v = signals.body_qd[:, :, i, :3].astype(np.float64)
        if signals.gravity > 0.0:
            v = v - (v @ signals.up)[..., None] * signals.up
        total = total + signals.mass[:, i, None, None] * v
        size = size + signals.mass[:, [i]] * np.linalg.norm(v, axis=-1)
    change = np.linalg.norm(total - total[:, :1], axis=-1)
    return change, size.max(axis=1, keepdims=True) + np.finfo(np.float32).tiny


def _mass(asked: Conserves, signals: Signals) -> Measure:
    """What of a fluid is no longer where it can be counted: outside of its container, or not finite."""
    evidence, fluid = signals.fluid(asked.objects[0])
    track = evidence.track(fluid)
    if track.present is not None:
        return _passed_mass(asked, signals, evidence, fluid)
    total = fluid.amount * fluid.density
    finite = np.isfinite(track.position).all(axis=2)
    there = finite.mean(axis=1) if fluid.container is None else 1.0 - evidence.outside(fluid)
    there = np.minimum(there, finite.mean(axis=1))
    value = (np.abs(there - there[0]) * total)[latest(track.time, signals.time)][None]
    source = f"{asked.share:g} of {total:.4g} kg"
    return Measure("change of mass", fluid.prim, value, asked.share * total, "kg", total, source, expected=0.0)


def _passed_mass(asked: Conserves, signals: Signals, evidence: Evidence, fluid: Fluid) -> Measure:
    """Of a fluid that comes from taps and leaves by drains: what came less what went and what is held."""
    track, scalars = evidence.track(fluid), evidence.recording.scalars
    held = track.count * fluid.density * fluid.cell
    at = np.minimum(np.searchsorted(evidence.time, track.time), len(evidence.time) - 1)
    passed = (scalars["fluid/mass_in"] - scalars["fluid/mass_out"])[at]
    total = float((held[0] + scalars["fluid/mass_in"][at]).max())
    value = np.abs(held[0] + passed - held)[latest(track.time, signals.time)][None]
    source = f"{asked.share:g} of {total:.4g} kg"
    what = "mass that came, less what went and what is held,"
    return Measure(what, fluid.prim, value, asked.share * total, "kg", total, source, expected=0.0)


# ---- what to change
@mends(Swings)
def _swing(asked: Swings, finding: Finding, evidence: Evidence) -> RepairTarget:
    """Let go too low, too short a run for a period, or a period that the hinge spoils."""
    if finding.unit == "deg" and finding.expected is None:
        return RepairTarget(
            kind="settlement", prim=finding.prim, parameter="rotation", direction="raise", current=finding.value,
            suggested=finding.limit, unit="deg", why="at rest below its hinge it has nowhere to swing from",
        )  # fmt: skip
    if finding.value is None and finding.expected is not None and finding.expected > evidence.world.duration:
        return longer_run(evidence, 2 * finding.expected, "a period takes longer than the run")
    why = "its hinge holds it back or drives it: a pendulum's period needs one with no friction, damping or drive"
    return RepairTarget(kind="joint", prim=finding.prim, parameter="damping", direction="lower", why=why)


@mends(Conserves)
def _conserve(asked: Conserves, finding: Finding, evidence: Evidence) -> RepairTarget:
    """A fluid's mass leaks; energy and momentum go with the step's error."""
    if finding.unit == "kg":
        return leak(finding, evidence)
    why = "what is conserved drifts with the step's error; half the step is the first to try"
    return shorter_step(evidence, 0.5, why)


@mends(DiesDown)
def _damp(asked: DiesDown, finding: Finding, evidence: Evidence) -> RepairTarget:
    """What goes on as far is taken energy from: by its joint's drive, or where it touches."""
    prim = finding.prim or ""
    joint = drive_of(evidence, prim)
    if joint is None or joint.drive is None:
        return damped(evidence, evidence.index(prim), "nothing takes its energy: it goes as far each time")
    why = "nothing damps it: it goes as far each time"
    return RepairTarget(
        kind="drive", prim=joint.prim, parameter="drive.damping", direction="raise", current=joint.drive.damping,
        why=why,
    )  # fmt: skip


@mends(ClimbsTo)
def _climb(asked: ClimbsTo, finding: Finding, evidence: Evidence) -> RepairTarget:
    """What comes up too little has lost too much on its way; what comes too high has got energy from the step."""
    if (finding.value or 0.0) > (finding.limit or 0.0):
        why = "it rises above its start: the integration adds energy; half the step is the first to try"
        return shorter_step(evidence, 0.5, why)
    return friction(evidence, finding.prim or "", "lower", None, "it loses too much on its way up")
