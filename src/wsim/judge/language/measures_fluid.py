"""Predicates about bodies and fluid, on one recorded world: Archimedes is the oracle.

The surface is that of still fluid: as high as the conserved volume in the container makes it, over what the bodies
displace at the end. Waves are not in it; what has not yet been poured in is not either.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.evidence.evidence import Evidence
from wsim.judge.evidence.recorded import MissingError
from wsim.judge.evidence.welded import displaced, still_draft, unheld_lift, welded
from wsim.judge.language.measure import Measure, measures, mends
from wsim.judge.language.measures_place import latest
from wsim.judge.repair.lasting import settled
from wsim.judge.repair.matter import heavier, lighter, own_density
from wsim.judge.repair.passing import started_in, too_small
from wsim.judge.repair.place import over
from wsim.judge.repair.rule import density, finer, longer_run, planned_density
from wsim.judge.verdict import Finding, RepairTarget
from wsim.plan.schema.formula_fluid import Fills, FillsTo, Floats, LevelIn, Sinks, Submerged, SwirlsBetween

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.language.signals import Signals
    from wsim.scene.world import Fluid

    Array = NDArray[np.float64]

LIFT = 0.25  # of a body's weight, that may be missing to what is under and should rise
SHARE, SPACINGS = 0.1, 0.5  # of the body's height, or particle spacings if more: what particles resolve of a draft
SAME = 0.01  # share by which two densities differ by rounding alone


@dataclass
class _Wet:
    """A body in a fluid; heights are (1, T) [m]."""

    evidence: Evidence
    fluid: Fluid
    surface: Array
    floor: float
    low: Array
    high: Array
    height: float  # the body's vertical extent at the end
    tolerance: float
    source: str  # of the tolerance


def _wet(signals: Signals, name: str, fluid_name: str, within: float | None) -> _Wet:
    evidence, fluid = signals.fluid(fluid_name)
    surface, floor = _surface(signals, evidence, fluid)
    low, high = signals.ends(name)
    height = float((high - low)[0, evidence.window].mean())
    tolerance = within or max(SHARE * height, SPACINGS * fluid.spacing)
    source = f"the larger of {SHARE:g} of its height and {SPACINGS:g} particle spacings, {tolerance:.3g} m"
    return _Wet(evidence, fluid, surface, floor, low, high, height, tolerance, "the objective's" if within else source)


def _surface(signals: Signals, evidence: Evidence, fluid: Fluid) -> tuple[Array, float]:
    """Height of the still surface at each frame, (1, T), and of what the fluid lies on [m]."""
    level, container, track = evidence.level(fluid), evidence.container_of(fluid), evidence.track(fluid)
    if container is None:
        raise MissingError(f"{fluid.prim} has no container: it has no level")
    inside = evidence.containment(container, fluid).inside() * track.count * fluid.cell
    end = float(inside[track.time >= evidence.window_start - 1e-9].mean())
    area = container.inner_size[0] * container.inner_size[1]
    missing = (end - inside) / area
    return (level.height - missing[latest(track.time, signals.time)])[None], level.bottom


@measures(Floats)
def _floats(asked: Floats, signals: Signals) -> list[Measure]:
    wet = _wet(signals, asked.object, asked.fluid, asked.within)
    prim = signals.prim(asked.object)
    i = wet.evidence.index(prim)
    needed, volume = displaced(wet.evidence, i, wet.fluid)
    value, beside = wet.surface - wet.low, _beside(signals, asked.object, wet)
    if needed >= volume:
        return [*_too_heavy(asked, wet, value, needed / volume), *beside]
    expected = still_draft(wet.evidence, i, needed)
    source = f"Archimedes for its own shape, {expected:.4g} m, and {wet.source}"
    return [
        Measure.about(value, expected, wet.tolerance, what="draft", prim=prim, unit="m", limit_from=source),
        *beside,
    ]


def _too_heavy(asked: Floats, wet: _Wet, draft: Array, ratio: float) -> list[Measure]:
    """What is denser than the fluid lies on its floor, as deep as that is; and if it were not, it is too heavy."""
    evidence, fluid = wet.evidence, wet.fluid
    i = evidence.index(evidence.prim(asked.object))
    body, depth = evidence.world.bodies[i], evidence.level(fluid).height - wet.floor
    note = f"with {ratio * fluid.density:.4g} kg/m^3 Archimedes has it on the floor, {depth:.4g} m deep"
    planned = evidence.planned(body.prim)
    if planned is not None and planned.material is not None and len(welded(evidence, i)) == 1:
        share = planned.material.density / fluid.density
        solid = evidence.solid(i)
        if share < 1.0:
            would = solid.draft(evidence.resting_pose(i)[1], solid.volume * share)
            note += f"; the plan's {planned.material.name} would float {would:.4g} m deep"
    return [
        Measure(
            "draft", body.prim, draft, wet.height, "m", wet.tolerance, "its height: what floats is no deeper",
            expected=depth, note=note,
        ),
        Measure(
            f"mean density, over that of {fluid.prim},", body.prim, np.full_like(draft, ratio), 1.0, "1", 1.0,
            "Archimedes: what floats is lighter", note=note,
        ),
    ]  # fmt: skip


def _beside(signals: Signals, name: str, wet: _Wet) -> list[Measure]:
    """Of a body that is out of the fluid's container at some time, how far its centre is beyond the walls."""
    container = wet.evidence.container_of(wet.fluid)
    if container is None:
        return []
    p = np.abs(Evidence.local(container, signals.centre(name))[..., :2])
    beyond = (p - np.array(container.inner_size[:2]) / 2).max(axis=-1)
    if not np.any(beyond > 0.0):
        return []
    what, source = f"way beyond the walls of {container.prim}", "what floats in a container is over it"
    return [Measure(what, signals.prim(name), beyond, 0.0, "m", wet.tolerance, source, expected=0.0)]


@measures(Sinks)
def _sinks(asked: Sinks, signals: Signals) -> list[Measure]:
    wet = _wet(signals, asked.object, asked.fluid, asked.within)
    above = Measure(
        "height above the floor", signals.prim(asked.object), wet.low - wet.floor, wet.tolerance, "m", wet.tolerance,
        wet.source, expected=0.0,
    )  # fmt: skip
    return [above, *_under(signals, asked.object, wet, 0.0)]


@measures(Submerged)
def _submerged(asked: Submerged, signals: Signals) -> list[Measure]:
    return _under(signals, asked.object, _wet(signals, asked.object, asked.fluid, None), asked.within)


def _under(signals: Signals, name: str, wet: _Wet, above: float) -> list[Measure]:
    """The depth of its highest point, which may be `above` [m]; of what should rise, the lift that nothing holds."""
    depth, prim = wet.surface - wet.high, signals.prim(name)
    source = "the objective's" if above else "the surface"
    found = [Measure("depth of its highest point", prim, depth, -above, "m", wet.tolerance, source, at_most=False)]
    i = wet.evidence.index(prim)
    weight = sum(wet.evidence.world.bodies[k].mass for k in welded(wet.evidence, i)) * wet.evidence.gravity
    volume = sum(wet.evidence.solid(k).volume for k in welded(wet.evidence, i))
    lift = (
        unheld_lift(wet.evidence, i, wet.fluid) if weight < wet.fluid.density * volume * wet.evidence.gravity else None
    )
    if lift is not None:
        limit = LIFT * weight
        what, source = "lift that nothing holds", f"{LIFT:g} of its weight: what is lighter than the fluid rises"
        found.append(Measure(what, prim, np.full_like(depth, lift), limit, "N", limit, source, expected=0.0))
    return found


@measures(FillsTo)
def _fills_to(asked: FillsTo, signals: Signals) -> list[Measure]:
    evidence, fluid = signals.fluid(asked.fluid)
    surface, floor = _surface(signals, evidence, fluid)[0], evidence.level(fluid).floor
    tolerance = asked.within or SPACINGS * fluid.spacing
    source = "the objective's" if asked.within else f"{SPACINGS:g} particle spacings: what the particles resolve"
    return [
        Measure.about(
            surface - floor, asked.level, tolerance, what="level above the floor", prim=fluid.prim, unit="m",
            limit_from=source,
        )
    ]  # fmt: skip


@measures(Fills)
def _fills(asked: Fills, signals: Signals) -> list[Measure]:
    evidence, fluid = signals.fluid(asked.fluid)
    container, track = signals.container(asked.ref), evidence.track(fluid)
    value = evidence.containment(container, fluid).inside()[latest(track.time, signals.time)][None]
    what, source = f"part in {container.prim}", "the rest may splash out"
    return [Measure(what, fluid.prim, value, asked.share, "1", 1.0, source, at_most=False, expected=1.0)]


@measures(LevelIn)
def _level_in(asked: LevelIn, signals: Signals) -> list[Measure]:
    """By the volume of the particles that are in the vessel, as if they stood level in it."""
    evidence, fluid = signals.fluid(asked.fluid)
    container, track = signals.container(asked.ref), evidence.track(fluid)
    inside = evidence.containment(container, fluid).inside() * track.count * fluid.cell
    value = inside[latest(track.time, signals.time)] / (container.inner_size[0] * container.inner_size[1])
    tolerance = asked.within or SPACINGS * fluid.spacing
    source = "the objective's" if asked.within else f"{SPACINGS:g} particle spacings: what the particles resolve"
    return [
        Measure.about(
            value[None], asked.level, tolerance, what=f"level in {container.prim}", prim=fluid.prim, unit="m",
            limit_from=source,
        )
    ]  # fmt: skip


@measures(SwirlsBetween)
def _swirls(asked: SwirlsBetween, signals: Signals) -> list[Measure]:
    """The rate of the rigid turn with the fluid's angular momentum about its middle: L / I, particles being alike."""
    evidence, fluid = signals.fluid(asked.fluid)
    track, k = evidence.track(fluid), "xyz".index(asked.axis)
    r, v = (each - track.mean(each)[:, None] for each in (track.position, track.velocity))
    momentum = np.nansum(np.cross(r, v)[..., k], axis=1)
    inertia = np.nansum(np.sum(r**2, axis=-1) - r[..., k] ** 2, axis=1)
    rate = np.degrees(momentum / np.maximum(inertia, np.finfo(np.float64).tiny))
    value = rate[latest(track.time, signals.time)][None]
    what, scale = f"rate at which it turns about {asked.axis}", max(abs(asked.low), abs(asked.high), 1e-9)
    return [
        Measure(what, fluid.prim, value, limit, "deg/s", scale, "the objective's range", at_most=at_most)
        for limit, at_most in ((asked.low, False), (asked.high, True))
    ]


# ---- what to change
@mends(Floats)
def _float(asked: Floats, finding: Finding, evidence: Evidence) -> RepairTarget:
    """Out of its container, too heavy, or not as dense as planned; else the particles are too coarse for its draft."""
    prim, fluid = finding.prim or "", evidence.fluid(evidence.prim(asked.fluid))
    container = evidence.container_of(fluid)
    if container is not None and finding.expected == 0.0:
        put = None if started_in(evidence, prim, container) else over(
            evidence, prim, container.prim, f"it starts beside {container.prim}"
        )  # fmt: skip
        return put or too_small(evidence, container.prim, finding.value or 0.0)
    now, planned = density(evidence, prim), planned_density(evidence, prim)
    if now >= fluid.density:
        return lighter(evidence, prim, fluid.density)
    if planned is not None and abs(planned / now - 1.0) > SAME:
        why = f"the plan's material; it floats as deep as its share of the fluid's {fluid.density:g} kg/m^3"
        return own_density(evidence, prim, planned, why)
    value, limit, expected = finding.value, finding.limit, finding.expected
    if value is None or limit is None or expected is None or value == expected:
        return settled(finding, evidence)
    why = "its density gives another draft than is seen; the draft's error shrinks with the spacing"
    return finer(evidence, fluid, abs(limit - expected) / abs(value - expected), why)


@mends(Sinks, Submerged)
def _sink(asked: Sinks | Submerged, finding: Finding, evidence: Evidence) -> RepairTarget:
    """Too light to go under, or the fluid too shallow to cover it."""
    prim, fluid = finding.prim or "", evidence.fluid(evidence.prim(asked.fluid))
    if density(evidence, prim) <= fluid.density:
        return heavier(evidence, prim, fluid.density)
    level, i = evidence.level(fluid), evidence.index(prim)
    height = float((evidence.ends(i)[1] - evidence.ends(i)[0])[evidence.window].mean())
    depth = level.height - level.bottom
    if height > depth:
        return RepairTarget(
            kind="fluid", prim=fluid.prim, parameter="level", direction="raise", current=depth,
            suggested=depth + (height - depth) + fluid.spacing, unit="m", why="it is taller than the fluid is deep",
        )  # fmt: skip
    return longer_run(evidence, None, "it is heavy enough to sink, and the fluid deep enough: it has not got there yet")


@mends(FillsTo)
def _fill_to(asked: FillsTo, finding: Finding, evidence: Evidence) -> RepairTarget:
    """As much fluid as the level needs: the level is as high as the volume."""
    value, expected = finding.value or 0.0, finding.expected
    fluid = evidence.fluid(finding.prim or "")
    now = fluid.size[2]
    return RepairTarget(
        kind="fluid", prim=fluid.prim, parameter="level", direction="raise" if value < (expected or 0.0) else "lower",
        current=now, suggested=now * expected / value if expected and value > 0.0 else None, unit="m",
        why="in the same container the level is as high as the volume",
    )  # fmt: skip


@mends(Fills)
def _fill(asked: Fills, finding: Finding, evidence: Evidence) -> RepairTarget:
    """More than the container holds, or still on its way."""
    fluid, container = evidence.fluid(finding.prim or ""), evidence.container(evidence.prim(asked.ref))
    if container is None:
        return RepairTarget(kind="missing object", direction="add", why="there is nothing to fill")
    room, volume = math.prod(container.inner_size), fluid.amount
    if volume > room:
        top = volume / math.prod(container.inner_size[:2])
        return RepairTarget(
            kind="geometry", prim=container.prim, parameter="inner_size.z", direction="raise",
            current=container.inner_size[2], suggested=top, unit="m", why="there is more fluid than it holds",
        )  # fmt: skip
    return longer_run(evidence, None, "it holds that much: the rest is still on its way, or is poured beside it")


@mends(LevelIn)
def _pour(asked: LevelIn, finding: Finding, evidence: Evidence) -> RepairTarget:
    """More or less of the fluid must come into the vessel."""
    way = "raise" if (finding.value or 0.0) < (finding.expected or 0.0) else "lower"
    why = "what comes into the vessel stands as high as its volume over the vessel's floor"
    return RepairTarget(kind="fluid", prim=finding.prim, parameter="size", direction=way, unit="m", why=why)


@mends(SwirlsBetween)
def _stir(asked: SwirlsBetween, finding: Finding, evidence: Evidence) -> RepairTarget:
    """What turns a fluid is a body, a wall or a jet that goes round."""
    why = "something must drive it round: a paddle, a wall that turns, an inlet along the wall"
    return RepairTarget(kind="fluid", prim=finding.prim, parameter="motion", direction="change", why=why)
