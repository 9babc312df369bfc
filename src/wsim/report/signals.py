"""Which recorded quantity a finding judged: the one from which its value comes.

A finding carries a number, not the signal behind it. Quantities of its prim in its unit are worked out as the judge
does, and the first that has the finding's value (at a frame, as the mean over the final window, or as the mean or rms
of the last half second) is the judged one. Where none has it, the first shows what went on, and no limit is drawn.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import conjugate, level, rotate, tilt
from wsim.judge.evidence.contact import distance, overlaps
from wsim.judge.evidence.support import downhill, support_of
from wsim.report.asked import decider

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding

    Values = NDArray[np.float64]

EXACT = 1e-6  # share by which a value may differ from the signal's, which is worked out in another order
LAST = 0.5  # [s] at the end, of what is to be at rest


@dataclass(frozen=True)
class Signal:
    """A quantity over time, and how a finding's value comes from it."""

    title: str
    unit: str
    time: Values  # (T,) [s]
    value: Values  # (T,)
    downwards: bool = False  # drawn with larger values lower: depths
    averaged: bool = True  # whether the judge takes means of it; else its value is a frame's
    how: str = ""  # "at 0.208 s", "the mean from 2.5 s on"; empty: the value is not this signal's
    over: tuple[float, float] | None = None  # [s]: the stretch that the value is taken from


def find_signal(evidence: Evidence, finding: Finding, ref: str | None = None) -> Signal | None:
    """The signal that a finding judged; else the first that shows its prim; None where there is nothing to show.

    Args:
        evidence: Of the recording that was judged, with its plan.
        finding: One of its verdict.
        ref: The prim of the other object of the finding's objective.
    """
    if not len(evidence.time):
        return None
    first: Signal | None = None
    for signal in _candidates(evidence, finding, ref):
        if not np.isfinite(signal.value).any():
            continue
        found = _match(signal, finding, evidence) if signal.unit == finding.unit else None
        if found is not None:
            return found
        # Of a number that is no quantity over time (a mass, a size) another quantity tells nothing.
        if signal.unit == finding.unit or finding.unit in ("", "s"):
            first = first or signal
    others = (_match(signal, finding, evidence) for signal in _scalars(evidence, finding.unit))
    return next((signal for signal in others if signal is not None), first)


def _match(signal: Signal, finding: Finding, evidence: Evidence) -> Signal | None:
    """The signal with how the finding's value comes from it, or None."""
    value, time = signal.value, signal.time
    finite = np.abs(value[np.isfinite(value)])
    if finding.value is None or not len(finite):
        return None
    error = EXACT * max(abs(finding.value), 1e-3 * float(finite.max()))
    # What stands still has the mean's value at every frame too: the means come first.
    stretches = (
        (evidence.window_start, "the mean", lambda part: float(np.mean(part))),
        (float(evidence.time[-1]) - LAST, "the mean", lambda part: float(np.mean(part))),
        (float(evidence.time[-1]) - LAST, "the rms", lambda part: math.sqrt(float(np.mean(part**2)))),
    )
    for start, word, statistic in stretches if signal.averaged else ():
        part = value[time >= start - 1e-9]
        if len(part) and abs(statistic(part) - finding.value) <= error:
            return replace(signal, how=f"as {word} from {start:.3g} s on", over=(start, float(time[-1])))
    here = np.flatnonzero(np.abs(value - finding.value) <= error)
    if not len(here):
        return None
    # Of several frames that have it, the one nearest to the moment that the finding names.
    moment = finding.time if finding.time is not None else float(time[here[0]])
    at = float(time[here[np.argmin(np.abs(time[here] - moment))]])
    return replace(signal, how=f"at {at:.3g} s", over=(at, at))


def _candidates(evidence: Evidence, finding: Finding, ref: str | None) -> Iterator[Signal]:
    """Signals that the finding may be about: those in its unit first, then those that show its prim."""
    sources = [(finding.unit, lambda: _of_formula(evidence, finding)), *_sources(evidence, finding.prim, ref)]
    for same in (True, False):
        for unit, source in sources:
            if (unit == finding.unit) is not same:
                continue
            try:
                yield from source()
            except (LookupError, ValueError, ArithmeticError, TypeError):
                continue  # the world has no such quantity, or not in numbers


def _sources(
    evidence: Evidence, prim: str | None, ref: str | None
) -> Iterator[tuple[str, Callable[[], Iterator[Signal]]]]:
    """(unit, signals in it) of a prim."""
    row = next((i for i, body in enumerate(evidence.world.bodies) if body.prim == prim), None)
    if row is not None:
        yield "m", lambda: _depths(evidence, row)
        if ref:
            yield "m", lambda: _beside(evidence, row, ref)
        yield "m", lambda: _ways(evidence, row, ref)
        yield "m", lambda: _overlaps(evidence, prim)
        yield "m/s", lambda: _speeds(evidence, row)
        yield "m/s^2", lambda: _accelerations(evidence, row)
        yield "N", lambda: _forces(evidence, row)
        yield "J", lambda: _energies(evidence, row)
        yield "deg", lambda: _tilt(evidence, row)
        yield "1", lambda: _turning(evidence, row)
        return
    if any(fluid.prim == prim for fluid in evidence.world.fluids):
        yield "share of particles", lambda: _outside(evidence, prim or "")
        yield "1", lambda: _density(evidence, prim or "")
        yield "m/s", lambda: _fastest(evidence, prim or "")
        yield "m", lambda: _surface(evidence, prim or "")


def _of_formula(evidence: Evidence, finding: Finding) -> Iterator[Signal]:
    """The measure that decides a formula."""
    found = decider(finding, evidence)
    if found is not None:
        measure = found[1].single or found[1]
        value = np.broadcast_to(measure.value, (1, len(evidence.time)))[0]
        title = measure.what[:1].upper() + measure.what[1:]
        yield Signal(title.replace("/World/", ""), measure.unit, evidence.time, np.asarray(value, np.float64))


# ---- of bodies
def _depths(evidence: Evidence, i: int) -> Iterator[Signal]:
    """Depths below the still surface, then heights."""
    low, high = evidence.ends(i)
    for fluid in evidence.world.fluids:
        try:
            level = evidence.level(fluid).height
        except LookupError:
            continue
        yield Signal("Depth of the lowest point below the surface", "m", evidence.time, level - low, downwards=True)
        yield Signal("Depth of the highest point below the surface", "m", evidence.time, level - high, downwards=True)
    yield Signal("Height of the lowest point", "m", evidence.time, low)
    yield Signal("Lower than at the start by", "m", evidence.time, low[0] - low)


def _beside(evidence: Evidence, i: int, ref: str) -> Iterator[Signal]:
    """How far from the other object."""
    name, prim = ref.rsplit("/", 1)[-1], evidence.world.bodies[i].prim
    container = evidence.container(ref)
    if container is not None:
        p = evidence.local(container, evidence.body_q[:, i, :3])
        half = np.array(container.inner_size) / 2
        room = np.minimum((half[:2] - np.abs(p[:, :2])).min(axis=1), p[:, 2] + half[2])
        yield Signal(f"From its centre to the nearest wall or the floor of {name}", "m", evidence.time, room)
        yield Signal(f"Beyond the wall of {name}", "m", evidence.time, (np.abs(p[:, :2]) - half[:2]).max(axis=1))
    try:
        gap = evidence.ends(i)[0] - support_of(evidence, i, ref).top
        yield Signal(f"Gap between its lowest point and {name}", "m", evidence.time, gap)
        yield Signal(f"Gap between its lowest point and {name}", "m", evidence.time, np.abs(gap))
    except LookupError:
        pass
    yield Signal(f"Distance to {name}", "m", evidence.time, distance(evidence, prim, ref))


def _ways(evidence: Evidence, i: int, ref: str | None) -> Iterator[Signal]:
    """How far from where it started."""
    moved = evidence.body_q[:, i, :3] - evidence.body_q[0, i, :3]
    if ref and _slopes(evidence, ref, i):
        yield Signal("Way down the slope", "m", evidence.time, moved @ downhill(evidence, ref, i))
    yield Signal("Way from the start", "m", evidence.time, np.linalg.norm(level(moved, evidence.up), axis=1))
    for title, axis, sign in (("front", 0, 1), ("back", 0, -1), ("left", 1, 1), ("right", 1, -1)):
        yield Signal(f"Way to the {title}", "m", evidence.time, sign * moved[:, axis])
    t = (evidence.time - evidence.time[0])[:, None]
    flight = np.array(evidence.world.bodies[i].velocity) * t + np.array(evidence.world.gravity) * t**2 / 2
    yield Signal("Off the parabola of its start", "m", evidence.time, np.linalg.norm(moved - flight, axis=1))


def _slopes(evidence: Evidence, ref: str, i: int) -> bool:
    try:
        downhill(evidence, ref, i)
    except LookupError:
        return False
    return True


def _overlaps(evidence: Evidence, prim: str | None) -> Iterator[Signal]:
    """How deep it is in each other object."""
    for pair in overlaps(evidence):
        if prim in (pair.a.owner, pair.b.owner):
            other = pair.b.owner if prim == pair.a.owner else pair.a.owner
            yield Signal(f"Depth in {other.rsplit('/', 1)[-1]}", "m", evidence.time, np.maximum(pair.depth, 0.0))


def _speeds(evidence: Evidence, i: int) -> Iterator[Signal]:
    v, w = evidence.body_qd[:, i, :3], np.linalg.norm(evidence.body_qd[:, i, 3:], axis=1)
    speed = np.linalg.norm(v, axis=1)
    between = np.zeros_like(speed)
    step = np.maximum(np.diff(evidence.time), 1e-9)
    between[1:] = np.linalg.norm(np.diff(evidence.body_q[:, i, :3], axis=0), axis=1) / step
    between -= w * float(np.linalg.norm(evidence.world.bodies[i].com))
    yield Signal("Speed", "m/s", evidence.time, speed)
    yield Signal("Speed between frames", "m/s", evidence.time, between)
    yield Signal("Vertical speed", "m/s", evidence.time, np.abs(v[:, 2]))
    yield Signal("Speed of its fastest point", "m/s", evidence.time, speed + w * evidence.solid(i).smallest / 2)


def _accelerations(evidence: Evidence, i: int) -> Iterator[Signal]:
    """Between each frame and the one before it."""
    change = np.diff(evidence.body_qd[:, i, :3], axis=0) / np.maximum(np.diff(evidence.time), 1e-9)[:, None]
    own = np.linalg.norm(change - np.array(evidence.world.gravity), axis=1)
    yield Signal("Acceleration besides gravity", "m/s^2", evidence.time[1:], own, averaged=False)
    yield Signal("Acceleration", "m/s^2", evidence.time[1:], np.linalg.norm(change, axis=1), averaged=False)


def _forces(evidence: Evidence, i: int) -> Iterator[Signal]:
    force = np.asarray(evidence.recording.contact_force[:, i], dtype=np.float64)
    yield Signal("Contact force upwards", "N", evidence.time, force[:, 2])
    yield Signal("Contact force", "N", evidence.time, np.linalg.norm(force, axis=1))


def _energies(evidence: Evidence, i: int) -> Iterator[Signal]:
    """Kinetic and potential energy of a body, from where it starts."""
    body, q, qd = evidence.world.bodies[i], evidence.body_q[:, i], evidence.body_qd[:, i]
    spin = rotate(conjugate(q[:, 3:]), qd[:, 3:])
    inertia = np.array(body.inertia).reshape(3, 3)
    kinetic = 0.5 * body.mass * np.sum(qd[:, :3] ** 2, axis=1) + 0.5 * np.einsum("ti,ij,tj->t", spin, inertia, spin)
    center = q[:, :3] + rotate(q[:, 3:], np.broadcast_to(np.array(body.com, dtype=np.float64), (len(q), 3)))
    potential = -body.mass * (center @ np.array(evidence.world.gravity))
    yield Signal("Kinetic and potential energy", "J", evidence.time, kinetic + potential - potential[0])


def _tilt(evidence: Evidence, i: int) -> Iterator[Signal]:
    yield Signal("Tilt since the start", "deg", evidence.time, tilt(evidence.body_q[:, i, 3:], evidence.up))


def _turning(evidence: Evidence, i: int) -> Iterator[Signal]:
    speed = np.linalg.norm(evidence.body_qd[:, i, :3], axis=1)
    rim = np.linalg.norm(evidence.body_qd[:, i, 3:], axis=1) * evidence.solid(i).smallest / 2
    moving = speed > 1e-3 * max(float(np.nanmax(speed)), 1e-9)
    share = np.where(moving, rim / np.where(moving, speed, 1.0), np.nan)
    yield Signal("Speed of its rim over its own", "1", evidence.time, share)
    length = np.linalg.norm(evidence.body_q[:, i, 3:], axis=1)
    yield Signal("Error of the quaternion's length", "1", evidence.time, np.abs(length - 1.0))


# ---- of fluids
def _outside(evidence: Evidence, prim: str) -> Iterator[Signal]:
    fluid = evidence.fluid(prim)
    yield Signal(
        "Particles outside", "share of particles", evidence.track(fluid).time, evidence.outside(fluid), averaged=False
    )


def _density(evidence: Evidence, prim: str) -> Iterator[Signal]:
    fluid = evidence.fluid(prim)
    track = evidence.track(fluid)
    error = np.abs(track.density / fluid.density - 1.0)
    tail = track.percentile(error, 0.99)
    yield Signal("Mean density error", "1", track.time, track.mean(error), averaged=False)
    yield Signal("Density error that 99 % keep to", "1", track.time, np.asarray(tail, np.float64), averaged=False)


def _fastest(evidence: Evidence, prim: str) -> Iterator[Signal]:
    track = evidence.track(evidence.fluid(prim))
    square = np.nan_to_num(np.einsum("tni,tni->tn", track.velocity, track.velocity)).max(axis=1)
    yield Signal(
        "Speed of the fastest particle", "m/s", track.time, np.sqrt(np.asarray(square, np.float64)), averaged=False
    )


def _surface(evidence: Evidence, prim: str) -> Iterator[Signal]:
    track = evidence.track(evidence.fluid(prim))
    top = track.percentile(track.position[:, :, 2], 0.99)
    yield Signal("Height that 99 % of the particles are below", "m", track.time, np.asarray(top, np.float64))


def _scalars(evidence: Evidence, unit: str) -> Iterator[Signal]:
    """What else was recorded as one number a frame; in the finding's unit, should it have its value."""
    for name, values in sorted(evidence.recording.scalars.items()):
        yield Signal(name.replace("/", ": ").replace("_", " "), unit, evidence.time, np.asarray(values, np.float64))
