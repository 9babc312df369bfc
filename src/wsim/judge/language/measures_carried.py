"""Predicates about what carries a body: that it is on it, at rest on it, and weighs on it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import conjugate, level, rotate
from wsim.judge.evidence.layers import mass_displaced
from wsim.judge.evidence.recorded import MissingError
from wsim.judge.evidence.support import Support, height_over, support_of
from wsim.judge.evidence.welded import volume_of, welded
from wsim.judge.language.contacts import gap, normals, touch_reach
from wsim.judge.language.measure import Measure, measures, mends
from wsim.judge.repair.lasting import settled
from wsim.judge.repair.matter import LEVEL, NEAR, friction, heavier, slope
from wsim.judge.repair.passing import beside, fallen_through
from wsim.judge.repair.rule import density, longer_run
from wsim.judge.verdict import Finding, RepairTarget
from wsim.plan.schema.formula_contact import LiesOn, RestsOn, StaysOn, SupportedBy, WeighsOn

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.language.signals import Signals
    from wsim.scene.world import Fluid

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]

STILL = 0.05  # of sqrt(g L): what rests bobs by 5 % of L, as in the checks
RESTS, STAYS = 0.05, 0.1  # of its height, that what rests on something, or stays on it, may be off it
SPACINGS = 0.25  # particle spacings, that what lies under fluid may be off the floor
UPWARDS = 0.1  # of a contact's normal, that is up where it bears: a face within 6 degrees of a wall's does not
LITTLE = 0.05  # of a body's weight: what bears less of it does not carry it
THIN = 0.05  # of a spacing: half of the slab that a section is measured by


@measures(LiesOn)
def _lies_on(asked: LiesOn | RestsOn, signals: Signals) -> list[Measure]:
    off, support = _off(signals, asked.object, asked.ref)
    prim, other = signals.prim(asked.object), signals.prim(asked.ref)
    height = _height(signals, asked.object)
    spacing = SPACINGS * support.fluid.spacing if support.fluid is not None else 0.0
    limit = asked.within or max(RESTS * height, spacing)
    source = f"{RESTS:g} of its height, {height:.3g} m"
    source += f", or {SPACINGS:g} particle spacings if more" if spacing else ""
    return [
        Measure.about(
            off, 0.0, limit, what=f"gap to the top of {other}", prim=prim, unit="m",
            limit_from="the objective's" if asked.within else source,
        )
    ]  # fmt: skip


@measures(RestsOn)
def _rests_on(asked: RestsOn, signals: Signals) -> list[Measure]:
    prim, other, size = signals.prim(asked.object), signals.prim(asked.ref), signals.solid(asked.object).smallest
    speed = np.linalg.norm(signals.velocity(asked.object) - signals.velocity(asked.ref), axis=-1)
    rest = STILL * signals.speed_scale(size)
    return [
        *_lies_on(asked, signals),
        Measure(
            f"speed against {other}", prim, speed, rest, "m/s", rest,
            f"{STILL:g} sqrt(g L), L = {size:.3g} m: bobbing by {STILL:.0%} of L", expected=0.0,
        ),
    ]  # fmt: skip


@measures(StaysOn)
def _stays_on(asked: StaysOn, signals: Signals) -> list[Measure]:
    off, _ = _off(signals, asked.object, asked.ref)
    limit = asked.within or STAYS * _height(signals, asked.object)
    source = "the objective's" if asked.within else f"{STAYS:g} of its height"
    what, prim = f"gap to the top of {signals.prim(asked.ref)}", signals.prim(asked.object)
    return [Measure(what, prim, np.abs(off), limit, "m", limit, source, expected=0.0)]


def _height(signals: Signals, name: str) -> float:
    """A body's vertical extent at the start [m]."""
    low, high = signals.ends(name)
    return float(high[0, 0] - low[0, 0])


def _off(signals: Signals, name: str, ref: str) -> tuple[Floats, Support]:
    """How far a body is off what carries it, (W, T) [m], and what that is.

    Where it is not over that, it is off it by its own height at least, however near the two are.
    """
    frames = signals.frames(name, ref)
    prim, other = signals.prim(name), signals.prim(ref)
    i = frames.index(prim)
    support = support_of(frames, i, other)
    over = support.over & np.isfinite(support.top)
    least = max(frames.solid(i).smallest, _height(signals, name))
    gap = height_over(frames, i, other, support)
    return signals.fold(np.where(over, gap, np.maximum(least, np.abs(np.where(np.isfinite(gap), gap, 0.0))))), support


@measures(WeighsOn)
def _weighs_on(asked: WeighsOn, signals: Signals) -> list[Measure]:
    prim, other = signals.prim(asked.object), signals.prim(asked.ref)
    # What is one is carried as one; what hangs on it by a hinge or a rope may weigh on it or elsewhere.
    weight, most = (_weight(signals, prims) for prims in (signals.together(asked.object), signals.tied(asked.object)))
    force = borne(signals, asked.object, asked.ref)
    fluid = next((each for each in signals.world.fluids if each.container == other), None)
    lift, film = _by_fluid(signals, asked.object, fluid) if fluid is not None else (0.0, 0.0)
    expected, room = weight - lift, asked.share * weight
    source = f"{asked.share:g} of its weight about its weight" + (" less buoyancy" if lift else "")
    source += ", and that of what is tied to it" if np.any(most > weight) else ""
    if film > 0.0:
        source += f", and upwards {film:.3g} N for the fluid that particles cannot bring under it"
    band = (expected - room, expected + (most - weight) + room + film)
    return [
        Measure.between(
            force, band, expected, what="force of contacts upwards", prim=prim, unit="N", scale=room, limit_from=source
        )
    ]


def _weight(signals: Signals, prims: set[str]) -> Floats:
    """Of some bodies together in each world, (W, 1) [N]."""
    assert signals.mass is not None
    rows = sorted(signals.row(prim) for prim in prims)
    return signals.mass[:, rows].sum(axis=1, keepdims=True) * signals.gravity


def borne(signals: Signals, name: str, ref: str) -> Floats:
    """The net force of contacts upwards on a body, and on what is fixed to it, where another object bears of it (W, T).

    Where it bears little of their weight, that alone [N]: they touch it, and something else carries them. Where
    contacts are not recorded it bears them if they lie on it, or touch it from above.
    """
    ours, theirs = signals.together(name), signals.together(ref)
    rows = sorted(signals.row(prim) for prim in ours)
    net = signals.contact_force[:, :, rows].astype(np.float64).sum(axis=2) @ signals.up
    given = signals.given(ours, theirs)
    if given is not None:
        least = LITTLE * _weight(signals, ours)
        by_it = given @ signals.up
        return np.where(by_it >= least, net, np.minimum(net, by_it))
    lies = np.zeros(net.shape, dtype=bool)
    for one in ours:
        for other in theirs:
            off, support = _off(signals, one, other)
            spacing = SPACINGS * support.fluid.spacing if support.fluid is not None else 0.0
            lies |= np.abs(off) <= max(STAYS * _height(signals, one), spacing)
            lies |= _from_above(signals, one, other)
    return np.where(lies | ~np.isfinite(net), net, 0.0)


def _from_above(signals: Signals, one: str, other: str) -> Bools:
    """Where a body touches another object such that it would have to go up to part from it, (W, T).

    It need not be over that with its own origin: a plank is borne by trestles near its ends.
    """
    try:
        near = gap(signals, one, other) <= touch_reach(signals, one, other)[0]
    except MissingError:  # what has no distance is told by how it lies alone
        return np.zeros((signals.count, len(signals.time)), dtype=bool)
    w, t = np.nonzero(near)
    if len(w):
        near[w, t] = normals(signals, one, other, w, t) @ signals.up >= UPWARDS
    return near


def _by_fluid(signals: Signals, name: str, fluid: Fluid) -> tuple[float, float]:
    """Buoyancy at the end, and the lift that is lost where no particle fits between body and floor [N].

    Nothing presses up on the part of the body's underside that is within a spacing of the floor: at the most the still
    fluid's pressure there, times the body's section a spacing above its lowest point.
    """
    evidence: Evidence | None = signals.evidence
    if evidence is None:
        raise MissingError(f"{fluid.prim} is seen through its particles, which only a recording of one world has")
    i = signals.row(name)
    solid = evidence.solid(i)
    position, rotation = evidence.resting_pose(i)
    z, level = float(position[2]), evidence.level(fluid).height
    bottom = float(evidence.ends(i)[0][evidence.window].mean())
    specific = fluid.density * evidence.gravity
    thin = THIN * fluid.spacing
    height = bottom + min(fluid.spacing, solid.smallest / 2)
    slab = solid.volume_below(rotation, z, height + thin) - solid.volume_below(rotation, z, height - thin)
    film = specific * max(0.0, level - bottom) * slab / (2 * thin)
    poses = {k: evidence.resting_pose(k) for k in welded(evidence, i)}
    under = mass_displaced(evidence, fluid, lambda height: volume_of(evidence, poses, height))
    return under * evidence.gravity, film


# ---- what to change
@mends(LiesOn, RestsOn, WeighsOn, SupportedBy)
def _put_on(asked: LiesOn | RestsOn | WeighsOn | SupportedBy, finding: Finding, evidence: Evidence) -> RepairTarget:
    """Beside it: put it over it. Below it: nothing stops it. Above it: too light, or not there yet."""
    prim, ref, value = finding.prim or "", evidence.prim(asked.ref), finding.value or 0.0
    if finding.unit != "m":
        return settled(finding, evidence)
    i, fluid = evidence.index(prim), next((f for f in evidence.world.fluids if f.container == ref), None)
    support = support_of(evidence, i, ref)
    if not support.over[evidence.window].all():
        return beside(evidence, prim, ref)
    if value < 0.0:
        return fallen_through(evidence, prim, ref)
    if fluid is not None and density(evidence, prim) < fluid.density:
        return heavier(evidence, prim, fluid.density)
    fall = -float((evidence.body_qd[evidence.window, i, :3] @ evidence.up).mean())
    if fall > 0.0:
        return longer_run(evidence, float(evidence.time[-1]) + value / fall, f"it still comes down at {fall:.2g} m/s")
    why = f"it hangs {value:.3g} m above {ref}: its collision shape is larger than it looks"
    return RepairTarget(kind="geometry", prim=prim, parameter="collision", direction="change", why=why)


@mends(StaysOn)
def _keep_on(asked: StaysOn, finding: Finding, evidence: Evidence) -> RepairTarget:
    """It slides off: on a slope friction must be more than its tangent. Or it was never on it."""
    prim, ref = finding.prim or "", evidence.prim(asked.ref)
    if not support_of(evidence, evidence.index(prim), ref).over[0]:
        return beside(evidence, prim, ref)
    steep = slope(evidence, prim, ref)
    if steep > LEVEL:
        why = f"a body stays on a slope of {math.degrees(steep):.3g} degrees where friction is above its tangent"
        return friction(evidence, prim, "raise", math.tan(steep), why, ref)
    if _slipped(finding, evidence, ref):
        why = "it slides or is carried off: more friction holds it"
        return friction(evidence, prim, "raise", None, why, ref)
    why = f"it comes off {ref} and does not slide: what lifts or throws it must be slower"
    return RepairTarget(kind="settlement", prim=prim, parameter="motion", direction="change", why=why)


def _slipped(finding: Finding, evidence: Evidence, ref: str) -> bool:
    """Whether the finding's body has moved along what it is to stay on, by more than it has moved off it."""
    i = evidence.index(finding.prim or "")
    here = evidence.body_q[:, i, :3]
    if evidence.static(ref) is None and evidence.container(ref) is None:
        other = evidence.body_q[:, evidence.index(ref)]
        here = rotate(conjugate(other[:, 3:]), here - other[:, :3])  # as seen from what carries it
    along = float(np.linalg.norm(level(here - here[0], evidence.up), axis=1).max())
    off = float(np.max(evidence.ends(i)[0] - evidence.ends(i)[0][0]))
    return along > max(off, NEAR * evidence.solid(i).smallest)
