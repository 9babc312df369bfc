"""Predicates about the way that a body makes: how far, down which slope, rolling or in flight, and how it tips."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import conjugate, level, multiply, rotate
from wsim.geometry.shapes import into, kind_of
from wsim.judge.evidence.contact import distance
from wsim.judge.evidence.recorded import MissingError
from wsim.judge.evidence.support import downhill
from wsim.judge.language.between import Course, peaks
from wsim.judge.language.measure import Measure, measures, mends
from wsim.judge.language.measures_place import latest
from wsim.judge.repair.drive import by_drive
from wsim.judge.repair.matter import LEVEL, friction, slope
from wsim.judge.repair.passing import pushed_over
from wsim.judge.repair.rule import FARTHEST, ROOM, density, longer_run, shorter_step, time_step
from wsim.judge.verdict import Finding, RepairTarget
from wsim.plan.schema.formula_motion import Drops, FallsFreely, Flies, GoesDown, Moves, Rolls, RollsFreely, TiltsTo

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.language.signals import Signals

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]

DIRECTIONS = {"front": (1.0, 0.0), "back": (-1.0, 0.0), "left": (0.0, 1.0), "right": (0.0, -1.0)}
LEAST = 0.5  # of its smallest extent: a way, where none is asked
PARTING = 0.05  # of its smallest extent: a gap beyond is no contact any more
SHARE, LITTLE = 0.02, 1e-3  # of the way flown, or [m] if more: off a parabola
JOLT = 0.5  # [m/s] from frame to frame beside gravity's: a touch between two frames


@measures(Moves)
def _moves(asked: Moves, signals: Signals) -> list[Measure]:
    moved = _moved(signals, asked.object)
    if asked.direction is not None:
        value, where = moved[..., :2] @ np.array(DIRECTIONS[asked.direction]), f" to the {asked.direction}"
    else:
        value, where = np.linalg.norm(level(moved, signals.up), axis=-1), ""
    limit, source = _least(signals, asked.object, asked.least)
    prim = signals.prim(asked.object)
    return [Measure(f"level way{where}", prim, value, limit, "m", limit, source, at_most=False)]


@measures(GoesDown)
def _goes_down(asked: GoesDown, signals: Signals) -> list[Measure]:
    value = _moved(signals, asked.object) @ _downhill(signals, asked.object, asked.ref)
    limit, source = _least(signals, asked.object, asked.least)
    what, prim = f"way down {signals.prim(asked.ref)}", signals.prim(asked.object)
    return [Measure(what, prim, value, limit, "m", limit, source, at_most=False)]


def _moved(signals: Signals, name: str) -> Floats:
    """The way of a body's origin since the start (W, T, 3) [m]."""
    place = signals.q(name)[..., :3]
    return np.asarray(place - place[:, :1])


def _least(signals: Signals, name: str, asked: float | None) -> tuple[float, str]:
    if asked is not None:
        return asked, "the objective's distance"
    return LEAST * signals.solid(name).smallest, f"{LEAST:g} of its smallest extent"


def _downhill(signals: Signals, name: str, ref: str) -> Floats:
    frames = signals.frames(name)
    return downhill(frames, signals.prim(ref), 0)


def _on_it(signals: Signals, name: str, ref: str | None) -> Bools:
    """Whether a body has not left another object yet (W, T): what it meets then is another story. All, without one."""
    near = _near(signals, name, ref)
    left = ~near & np.logical_or.accumulate(near, axis=1)
    return ~np.logical_or.accumulate(left, axis=1)


def _near(signals: Signals, name: str, ref: str | None) -> Bools:
    """Whether a body is on another object, or all but (W, T). All, without one."""
    if ref is None:
        return np.ones((signals.count, len(signals.time)), dtype=bool)
    gap = signals.fold(distance(signals.frames(name, ref), signals.prim(name), signals.prim(ref)))
    return np.asarray(gap <= PARTING * signals.solid(name).smallest)


@measures(Rolls)
def _rolls(asked: Rolls, signals: Signals) -> list[Measure]:
    """The way that its turning would carry it, over the way that it makes: 1 is rolling, 0 sliding (W, T).

    Of all the time that it is there, hops left out: what is set down, held and let go rolls after that.
    """
    here, twist = _near(signals, asked.object, asked.on), signals.qd(asked.object)
    turned = (np.linalg.norm(twist[..., 3:], axis=-1) * here).sum(axis=1) * _rolling_radius(signals, asked.object)
    made = (np.linalg.norm(twist[..., :3], axis=-1) * here).sum(axis=1)
    share = np.where(made > 0.0, turned / np.where(made > 0.0, made, 1.0), np.nan)
    value = np.repeat(share[:, None], here.shape[1], axis=1)
    source = "1 is rolling without slipping, 0 sliding without turning"
    what, prim = "part of its way that its turning makes up", signals.prim(asked.object)
    return [Measure(what, prim, value, asked.share, "1", asked.share, source, at_most=False)]


def _rolling_radius(signals: Signals, name: str) -> float:
    """Of what is round, a wheel thinner than it is high too; else half of the smallest extent [m]."""
    shapes = signals.body(name).shapes
    if len(shapes) == 1 and shapes[0].kind in ("sphere", "cylinder", "capsule"):
        return float(shapes[0].size[0])
    return signals.solid(name).smallest / 2


@measures(RollsFreely)
def _rolls_freely(asked: RollsFreely, signals: Signals) -> list[Measure]:
    """v^2 / 2 s where it leaves the slope, of what starts at rest: whenever it was let go, that is its acceleration."""
    body = signals.body(asked.object)
    if len(body.shapes) != 1 or body.shapes[0].kind != "sphere":
        raise MissingError("it is no ball: only of one is the acceleration known")
    along, here = _downhill(signals, asked.object, asked.ref), _on_it(signals, asked.object, asked.ref)
    worlds, last = np.arange(signals.count), np.maximum(here.sum(axis=1) - 1, 0)
    way = (_moved(signals, asked.object) @ along)[worlds, last]
    speed = (signals.qd(asked.object)[..., :3] @ along)[worlds, last]
    radius = body.shapes[0].size[0]
    gone = way > PARTING * radius
    value = np.where(gone, speed**2 / np.where(gone, 2.0 * way, 1.0), 0.0 * way)
    inertia = float(np.trace(np.array(body.inertia).reshape(3, 3))) / 3
    expected = float(np.array(signals.world.gravity) @ along) / (1.0 + inertia / (body.mass * radius**2))
    return [
        Measure.about(
            np.repeat(value[:, None], here.shape[1], axis=1), expected, asked.share * expected, unit="m/s^2",
            what="speed that it gathers", prim=body.prim,
            limit_from=f"g sin(slope) / (1 + I / m r^2), to {asked.share:.0%}",
        )
    ]  # fmt: skip


@measures(Flies)
def _flies(asked: Flies, signals: Signals) -> list[Measure]:
    last, course = _flight(signals, asked.object).sum(axis=1) - 1, signals.course(asked.object)
    ends = signals.time[last] - signals.time[0]
    # Where a blow ends it, that is where the courses before and after it meet.
    w = np.flatnonzero(last < len(signals.time) - 1)
    w = w[course.struck[w, last[w]]]
    ends[w] += course.meet(last[w], last[w] + 1, w)[0]
    value = np.repeat(ends[:, None], len(signals.time), axis=1)
    source = "the objective's" if asked.least != Flies.model_fields["least"].default else "a shorter one is no flight"
    what, prim = "time before it touches anything", signals.prim(asked.object)
    return [Measure(what, prim, value, asked.least, "s", asked.least, source, at_most=False)]


@measures(FallsFreely)
def _falls_freely(asked: FallsFreely, signals: Signals) -> list[Measure]:
    flies, t = _flight(signals, asked.object), (signals.time - signals.time[0])[:, None]
    path = signals.start_velocity(asked.object)[:, None] * t + np.array(signals.world.gravity) * t**2 / 2
    value = np.where(flies, np.linalg.norm(_moved(signals, asked.object) - path, axis=-1), 0.0)
    steps = np.linalg.norm(np.diff(path, axis=1), axis=2) * flies[:, 1:]
    way = steps.sum(axis=1, keepdims=True)
    limit = np.full_like(way, asked.within) if asked.within else np.maximum(SHARE * way, LITTLE)
    source = "the objective's" if asked.within else f"{SHARE:g} of the way flown, {float(way[0, 0]):.3g} m"
    what, prim = "way off the parabola of its start", signals.prim(asked.object)
    return [Measure(what, prim, value, limit, "m", limit, source, expected=0.0)]


def _flight(signals: Signals, name: str) -> Bools:
    """Whether a body has touched nothing yet (W, T); its first frame counts as one of the flight."""
    touches = np.any(np.nan_to_num(signals.force(name)) != 0.0, axis=-1)
    v = signals.qd(name)[..., :3]
    # A contact between two frames shows in the speed alone: what gravity gives, and no more.
    gain = np.diff(v, axis=1) - np.array(signals.world.gravity) * np.diff(signals.time)[:, None]
    touches[:, 1:] |= np.linalg.norm(gain, axis=-1) > JOLT
    touches |= _wet(signals, name)
    touches[:, 0] = False
    return ~np.logical_or.accumulate(touches, axis=1)


def _wet(signals: Signals, name: str) -> Bools:
    """Whether a particle of some fluid is within half a spacing of a body (W, T)."""
    wet = np.zeros((signals.count, len(signals.time)), dtype=bool)
    solid, q = signals.solid(name), signals.q(name)
    for each in signals.world.fluids:
        evidence, fluid = signals.fluid(each.prim)
        track = evidence.track(fluid)
        at = latest(track.time, signals.time)
        for k in range(len(signals.time)):
            apart = np.asarray(track.position[at[k]], dtype=np.float64) - q[0, k, :3]
            reach = float(evidence.motion.radius[signals.row(name)]) + fluid.spacing
            own = rotate(conjugate(q[0, k, 3:]), apart[np.linalg.norm(apart, axis=1) < reach])
            depths = [kind_of(shape).depth(into(shape, own)) for shape in solid.shapes] if len(own) else []
            if any(bool(np.any(depth > -fluid.spacing / 2)) for depth in depths):
                wet[:, k:] = True
                break
    return wet


@measures(Drops)
def _drops(asked: Drops, signals: Signals) -> list[Measure]:
    low, high = signals.ends(asked.object)
    limit = asked.share * (high - low)[:, :1]
    source, prim = f"{asked.share:g} of its height", signals.prim(asked.object)
    return [Measure("way down of its lowest point", prim, low[:, :1] - low, limit, "m", limit, source, at_most=False)]


@measures(TiltsTo)
def _tilts_to(asked: TiltsTo, signals: Signals) -> list[Measure]:
    start = [signals.q(name)[:, 0, :3] for name in (asked.object, asked.ref)]
    side = level(start[1] - start[0], signals.up)
    length = np.linalg.norm(side, axis=-1, keepdims=True)
    if np.any(length < 1e-6):
        raise MissingError(f"{asked.ref} starts over the middle of {asked.object}: no side goes down")
    q = signals.q(asked.object)[..., 3:]
    since = multiply(q, np.broadcast_to(conjugate(q[:, :1]), q.shape))
    turned = rotate(since, np.broadcast_to((side / length)[:, None], (*q.shape[:2], 3)))
    rate = np.cross(signals.qd(asked.object)[..., 3:], turned) @ signals.up
    down = -turned @ signals.up
    course = Course(signals.time, down[..., None], -rate[..., None], np.zeros(1))
    value = np.degrees(np.arcsin(np.clip(peaks(down, course.greatest(np.ones(1))), -1.0, 1.0)))
    what, prim = f"angle down on the side of {asked.ref}", signals.prim(asked.object)
    source = "clearly out of level" if math.isclose(asked.least, 5.0) else "the objective's"
    return [Measure(what, prim, value, asked.least, "deg", asked.least, source, at_most=False)]


# ---- what to change
@mends(Moves, GoesDown)
def _go(asked: Moves | GoesDown, finding: Finding, evidence: Evidence) -> RepairTarget:
    """Under friction a way goes as the square of the speed it starts with."""
    body = evidence.body(finding.prim or "")
    speed = float(np.linalg.norm(body.velocity))
    value, limit = finding.value or 0.0, finding.limit or 0.0
    share = (1.0 + ROOM) * limit / value if 0.0 < value < limit else None
    driven = by_drive(evidence, body.prim, share, "its drive gets where it is set to, which is not far enough")
    if driven is not None and not speed:
        return driven
    if any(joint.child == body.prim or joint.parent == body.prim for joint in evidence.world.joints) and not speed:
        why = "a joint holds it, and nothing drives that"
        return RepairTarget(kind="drive", prim=body.prim, parameter="drive", direction="add", why=why)
    going = _gets_there(finding, evidence)
    if going is not None:
        return longer_run(evidence, going, "it is on its way, and fast enough to get there")
    if speed > 0.0:
        to = (1.0 + ROOM / 2) * speed * math.sqrt(limit / value) if 0.0 < value < limit else None
        return RepairTarget(
            kind="physical parameter", prim=body.prim, parameter="velocity", direction="raise", current=speed,
            suggested=to, unit="m/s", why="under friction it gets as far as v^2 / (2 mu g)",
        )  # fmt: skip
    ref, to = evidence.prim(asked.ref) if isinstance(asked, GoesDown) else "", None
    steep = slope(evidence, body.prim, ref)
    if steep > LEVEL:  # from rest it goes g t^2 (sin - mu cos) / 2
        t = float(evidence.time[-1] - evidence.time[0])
        to = max(0.0, math.tan(steep) - 2.0 * limit / (evidence.gravity * math.cos(steep) * t**2))
    return friction(evidence, body.prim, "lower", to, "it starts at rest: less friction lets it go", ref)


def _gets_there(finding: Finding, evidence: Evidence) -> float | None:
    """When what still moves at the end has gone as far as asked [s], slowed as it is; None if it stops before."""
    missing = (finding.limit or 0.0) - (finding.value or 0.0)
    i, late = evidence.index(finding.prim or ""), evidence.window
    speed = np.linalg.norm(level(evidence.body_qd[late, i, :3].astype(np.float64), evidence.up), axis=1)
    time = evidence.time[late]
    if missing <= 0.0 or len(time) < 2 or speed[-1] <= 0.0:
        return None
    slowed = max(0.0, float((speed[0] - speed[-1]) / (time[-1] - time[0])))
    v, wanted = float(speed[-1]), (1.0 + ROOM) * missing
    if v**2 <= 2.0 * slowed * wanted:
        return None
    left = wanted / v if slowed == 0.0 else (v - math.sqrt(v**2 - 2.0 * slowed * wanted)) / slowed
    end = float(evidence.time[-1])
    return end + left if end + left <= FARTHEST["duration"] * end else None  # what creeps gets nowhere


@mends(Rolls)
def _roll(asked: Rolls, finding: Finding, evidence: Evidence) -> RepairTarget:
    """A ball rolls without slipping where friction is above 2/7 of the slope's tangent; what is to slide has less."""
    prim, ref = finding.prim or "", evidence.prim(asked.on) if asked.on else ""
    if (finding.value or 0.0) > (finding.limit or 0.0):
        return friction(evidence, prim, "lower", None, "friction turns it: with less it slides", ref)
    return _gripping(evidence, prim, ref)


@mends(RollsFreely)
def _roll_freely(asked: RollsFreely, finding: Finding, evidence: Evidence) -> RepairTarget:
    """Too fast: it slips. Too slow: something holds it back."""
    prim, ref = finding.prim or "", evidence.prim(asked.ref)
    if (finding.value or 0.0) > (finding.expected or 0.0):
        return _gripping(evidence, prim, ref)
    why = "something holds a ball back that should roll freely"
    return friction(evidence, prim, "lower", None, why, ref)


def _gripping(evidence: Evidence, prim: str, ref: str) -> RepairTarget:
    steep = slope(evidence, prim, ref)
    to = 2.0 / 7.0 * math.tan(steep) if steep > LEVEL else None
    why = "a ball rolls without slipping where friction is above 2/7 tan(slope)"
    return friction(evidence, prim, "raise", to, why, ref)


@mends(Flies)
def _fly(asked: Flies, finding: Finding, evidence: Evidence) -> RepairTarget:
    """It lands too soon."""
    prim, limit = finding.prim or "", finding.limit or 0.0
    rise = 0.5 * evidence.gravity * limit * (1.0 + ROOM)
    why = f"a flight of {limit:g} s takes {rise:.3g} m/s upwards, or as much height"
    return RepairTarget(
        kind="physical parameter", prim=prim, parameter="velocity.z", direction="raise",
        current=float(np.array(evidence.body(prim).velocity) @ evidence.up), suggested=rise, unit="m/s", why=why,
    )  # fmt: skip


@mends(FallsFreely)
def _let_fall(asked: FallsFreely, finding: Finding, evidence: Evidence) -> RepairTarget:
    """Something beside gravity acts on it, or it is the integration's error."""
    value, limit = finding.value or 0.0, finding.limit or 0.0
    step, last = time_step(evidence), float(evidence.time[-1])
    if step is not None and 0.0 < limit < value <= evidence.gravity * step * last:
        return shorter_step(evidence, limit / value, "the integration's error, g dt t / 2, is as large as this")
    why = "something beside gravity acts on it: a drive, damping, a joint or a control"
    return RepairTarget(kind="physical parameter", prim=finding.prim, parameter="forces", direction="remove", why=why)


@mends(Drops)
def _topple(asked: Drops, finding: Finding, evidence: Evidence) -> RepairTarget:
    """What stays up is to be pushed over."""
    return pushed_over(finding, evidence)


@mends(TiltsTo)
def _tilt(asked: TiltsTo, finding: Finding, evidence: Evidence) -> RepairTarget:
    """The lever needs more weight on that side."""
    ref, why = evidence.prim(asked.ref), "the side goes down whose weight times arm is greater"
    return RepairTarget(
        kind="physical parameter", prim=ref, parameter="density", direction="raise", current=density(evidence, ref),
        unit="kg/m^3", why=why,
    )  # fmt: skip
