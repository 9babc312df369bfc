"""Predicates about where a body is, how it stands and how fast it is."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import conjugate, rotate, sides_of
from wsim.judge.evidence.evidence import Evidence
from wsim.judge.evidence.motion import FLOAT32
from wsim.judge.evidence.recorded import MissingError
from wsim.judge.language.between import Course, peaks
from wsim.judge.language.contacts import PARTS, about, swept_gap, touch_reach
from wsim.judge.language.hollows import hollow_of
from wsim.judge.language.measure import Measure, measures, mends
from wsim.judge.repair.drive import by_drive
from wsim.judge.repair.lasting import leak
from wsim.judge.repair.matter import slides_off
from wsim.judge.repair.passing import beside, fallen_through, pushed_over, started_in, too_small
from wsim.judge.verdict import Finding, RepairTarget
from wsim.plan.schema.formula_place import (
    ContainedIn,
    Crosses,
    FollowsPath,
    Reaches,
    SpeedBetween,
    StaysInside,
    StaysWithin,
    Upright,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.language.signals import Signals
    from wsim.plan.schema.predicate import Place

    Floats = NDArray[np.float64]

LASTING = 0.05  # of a body's smallest extent, by which it may be in a wall: as much as the check of penetration lets


@measures(Reaches)
def _reaches(asked: Reaches, signals: Signals) -> list[Measure]:
    prim = signals.prim(asked.object)
    if isinstance(asked.target, str):
        value = about(swept_gap(signals, asked.object, asked.target))
        default, source = touch_reach(signals, asked.object, asked.target)
        what = f"gap to {signals.prim(asked.target)}"
    else:
        value = _distances(signals, asked.object, asked.target, nearest=True)
        size = signals.solid(asked.object).smallest
        default, source = np.full(1, size / 2), f"half of its smallest extent, {size:.3g} m: the point is in it"
        what = "distance to the point"
    limit = default if asked.within is None else asked.within
    scale = np.maximum(limit, FLOAT32 * signals.solid(asked.object).smallest)
    return [Measure(what, prim, value, limit, "m", scale, source if asked.within is None else "the objective's")]


@measures(StaysWithin)
def _stays_within(asked: StaysWithin, signals: Signals) -> list[Measure]:
    value = _distances(signals, asked.object, asked.center, nearest=False)
    prim = signals.prim(asked.object)
    return [Measure("distance", prim, value, asked.radius, "m", asked.radius, "the objective's radius")]


def _distances(signals: Signals, name: str, target: Place, nearest: bool) -> Floats:
    """From a body's origin to a point or another's, at frames and beside them, where nearest or farthest (W, T) [m].

    Looked for between frames wherever it may come nearer, or go farther, than at any frame.
    """
    sign = 1.0 if nearest else -1.0
    apart = signals.centre(name) - (signals.centre(target) if isinstance(target, str) else np.array(target))
    value = sign * np.linalg.norm(apart, axis=-1)
    if len(signals.time) < 2:
        return sign * value
    course = signals.origin_course(name)
    velocity, pull = course.velocity, course.pull
    if isinstance(target, str):
        other = signals.origin_course(target)
        velocity, pull = velocity - other.velocity, pull - other.pull
    course = Course(signals.time, apart, velocity, pull)
    speed = np.linalg.norm(course.velocity, axis=-1)
    way = np.maximum(speed[:, :-1], speed[:, 1:]) * course.h + np.linalg.norm(course.pull) * course.h**2
    bound = 0.5 * (value[:, :-1] + value[:, 1:] - way)
    w, k = np.nonzero(bound < value.min(axis=1, keepdims=True))
    between = np.full(way.shape, np.inf)
    between[w, k] = _nearest_on(sign, course.samples(w, k, PARTS))
    return -sign * peaks(-value, -between)


def _nearest_on(sign: float, path: Floats) -> Floats:
    """The least of a sign times the distance from the origin on straight lines between points (N, P, 3), (N,)."""
    ends = sign * np.linalg.norm(path, axis=-1)
    if sign < 0.0:
        return np.asarray(ends.min(axis=1))
    return np.asarray(_to_segment(np.zeros(3), path[:, :-1], path[:, 1:]).min(axis=1))


@measures(ContainedIn)
def _contained_in(asked: ContainedIn, signals: Signals) -> list[Measure]:
    prim, hollow = signals.prim(asked.object), hollow_of(signals, asked.ref)
    solid, value = signals.solid(asked.object), hollow.room(signals, asked.object)
    tolerance = LASTING * solid.smallest if asked.within is None else asked.within
    source = f"{LASTING:g} of its smallest extent, as the check of penetration has it"
    return [
        Measure(
            f"room to the walls, floor and rim of {hollow.prim}", prim, value, -tolerance, "m", solid.smallest,
            source if asked.within is None else "the objective's", at_most=False,
        )
    ]  # fmt: skip


@measures(StaysInside)
def _stays_inside(asked: StaysInside, signals: Signals) -> list[Measure]:
    prim = signals.prim(asked.object)
    if not signals.moves(asked.object):
        return [_fluid_inside(asked, signals)]
    hollow = hollow_of(signals, asked.ref)
    room, size = hollow.depth(signals, asked.object), signals.solid(asked.object).smallest
    what = f"way from its centre to the walls and floor of {hollow.prim}"
    source = "the objective's" if asked.within else "the walls' inner faces"
    return [Measure(what, prim, room, -asked.within, "m", size, source, at_most=False)]


def _fluid_inside(asked: StaysInside, signals: Signals) -> Measure:
    """Of a tank, or of the vessel that it fills."""
    evidence, fluid = signals.fluid(asked.object)
    track, prim = evidence.track(fluid), signals.prim(asked.ref)
    own = fluid.volume is not None and f"{fluid.container}/".startswith(f"{prim}/")
    outside = evidence.outside(fluid) if own else evidence.containment(signals.container(asked.ref), fluid).outside
    value = outside[latest(track.time, signals.time)][None]
    source = f"{asked.share:g} of the particles, farther out than a spacing of {fluid.spacing:g} m"
    return Measure(f"part outside {prim}", fluid.prim, value, asked.share, "1", asked.share, source)


def latest(known: Floats, time: Floats) -> NDArray[np.intp]:
    """For each time the index of the last of the known times at or before it, or of the first (T,)."""
    return np.maximum(np.searchsorted(known, time + 1e-9, side="right") - 1, 0)


@measures(Upright)
def _upright(asked: Upright, signals: Signals) -> list[Measure]:
    prim, q = signals.prim(asked.object), signals.q(asked.object)[..., 3:]
    solid = signals.solid(asked.object)
    if all(shape.kind == "sphere" for shape in solid.shapes):
        raise MissingError("a ball has no upright")
    own = rotate(conjugate(q[:, :1]), signals.up)  # what points up at the start, in the body's frame
    points = rotate(q, own)
    level_ = np.cross(signals.qd(asked.object)[..., 3:], points) @ signals.up
    course = Course(signals.time, (points @ signals.up)[..., None], level_[..., None], np.zeros(1))
    highest = peaks(-course.place[..., 0], -course.least(np.ones(1)))  # of what leans out and back between frames
    value = np.degrees(np.arccos(np.clip(-highest, -1.0, 1.0)))
    limit, source = asked.within, "the objective's angle"
    if limit is None:
        limit, source = _tipping(signals, asked.object)
    return [Measure("tilt", prim, value, limit, "deg", limit, source)]


def _tipping(signals: Signals, name: str) -> tuple[float, str]:
    """The tilt at which a body's middle is over the edge that it tips about [deg]: beyond it, it falls."""
    solid = signals.solid(name)
    q = signals.frames(name).body_q[:1, 0, 3:]
    *halves, middle = (
        float(high[0] - low[0]) / 2
        for low, high in (solid.reach(q, axis) for axis in (*sides_of(signals.up), signals.up))
    )
    half = min(halves)
    angle = math.degrees(math.atan2(half, middle))
    return angle, f"atan({half:.3g} m / {middle:.3g} m): there its middle is over the edge that it tips about"


@measures(SpeedBetween)
def _speed_between(asked: SpeedBetween, signals: Signals) -> list[Measure]:
    prim = signals.prim(asked.object)
    value = np.linalg.norm(signals.qd(asked.object)[..., :3], axis=-1)
    fastest = value
    if len(signals.time) > 1:
        course = signals.course(asked.object)
        w, k = np.nonzero(course.struck)
        met = np.full(course.struck.shape, -np.inf)
        _, _, before, after = course.meet(k, k + 1, w)
        met[w, k] = np.maximum(np.linalg.norm(before, axis=-1), np.linalg.norm(after, axis=-1))
        fastest = peaks(value, met)  # as it meets what it strikes, or parts from it
    low, high = (
        Measure("speed", prim, of, limit, "m/s", asked.high or 1.0, "the objective's range", at_most=at_most)
        for of, limit, at_most in ((value, asked.low, False), (fastest, asked.high, True))
    )
    return [low, high]


@measures(Crosses)
def _crosses(asked: Crosses, signals: Signals) -> list[Measure]:
    prim, size = signals.prim(asked.object), signals.solid(asked.object).smallest
    value = signals.centre(asked.object)[..., "xyz".index(asked.axis)]
    above = value[:, :1] > asked.at
    from_above = np.broadcast_to(above, value.shape)
    if len(signals.time) > 1:
        course, axis = signals.origin_course(asked.object), np.eye(3)["xyz".index(asked.axis)]
        value = np.where(above, -peaks(-value, -course.least(axis)), peaks(value, course.greatest(axis)))
    source = "the objective's plane; it started on the other side, or on it"
    return [Measure(asked.axis, prim, value, asked.at, "m", size, source, at_most=from_above)]


@measures(FollowsPath)
def _follows_path(asked: FollowsPath, signals: Signals) -> list[Measure]:
    prim, size = signals.prim(asked.object), signals.solid(asked.object).smallest
    limit = asked.within or size / 2
    source = "the objective's" if asked.within else f"half of its smallest extent, {size:.3g} m: the path is in it"
    p, path = signals.centre(asked.object), np.array(asked.path)
    off = np.full(p.shape[:2], np.inf)
    for a, b in itertools.pairwise(path):
        off = np.minimum(off, _to_segment(p, a, b))
    missed = np.broadcast_to(_missed(p, path, limit)[:, None], off.shape)
    what = "distance to the point of the path that it misses most"
    return [
        Measure("distance from the path", prim, off, limit, "m", limit, source),
        Measure(what, prim, missed, limit, "m", limit, source),
    ]


def _missed(p: Floats, path: Floats, limit: float) -> Floats:
    """How near the body gets, at worst, to the points of the path taken in order, (W,) [m].

    A point counts from where the one before it was reached. After one that is not reached no other is looked for.
    """
    count, frames = p.shape[:2]
    start = np.zeros(count, dtype=np.intp)
    worst = np.zeros(count)
    going = np.ones(count, dtype=bool)
    for point in path:
        # Between two frames it is on the line between them.
        near = np.linalg.norm(p - point, axis=-1)
        if frames > 1:
            near[:, 1:] = np.minimum(near[:, 1:], _to_segment(point, p[:, :-1], p[:, 1:]))
        near = np.where(np.arange(frames) >= start[:, None], near, np.inf)
        nearest = near.min(axis=1)
        worst = np.where(going & ~(nearest <= worst), nearest, worst)
        going = going & (nearest <= limit)
        start = np.argmax(near <= limit, axis=1)
    return worst


def _to_segment(p: Floats, a: Floats, b: Floats) -> Floats:
    """Distance (...) of points to line segments, (..., 3) each; shapes broadcast."""
    along = b - a
    length2 = np.sum(along * along, axis=-1)
    share = np.sum((p - a) * along, axis=-1) / np.where(length2 > 0.0, length2, 1.0)
    nearest = a + np.clip(share, 0.0, 1.0)[..., None] * along
    return np.asarray(np.linalg.norm(p - nearest, axis=-1))


# ---- what to change
@mends(Reaches, Crosses)
def _reach(asked: Reaches | Crosses, finding: Finding, evidence: Evidence) -> RepairTarget:
    """It stops short, or goes another way."""
    short = abs((finding.value or 0.0) - (finding.limit or 0.0))
    driven = by_drive(evidence, finding.prim or "", None, f"its drive is set to {short:.3g} m beside that")
    if driven is not None:
        return driven
    start = evidence.body(finding.prim or "").velocity
    why = f"it stays {short:.3g} m short of where it must get: faster, or aimed better"
    return RepairTarget(
        kind="physical parameter", prim=finding.prim, parameter="velocity",
        direction="change", current=float(np.linalg.norm(start)), unit="m/s", why=why,
    )  # fmt: skip


@mends(StaysWithin)
def _hold(asked: StaysWithin, finding: Finding, evidence: Evidence) -> RepairTarget:
    """It slides away, or goes too far."""
    why = "it gets too far: hold it, or start it slower or nearer"
    return slides_off(evidence, finding.prim or "") or RepairTarget(
        kind="settlement", prim=finding.prim, parameter="position", direction="change", unit="m", why=why
    )


@mends(ContainedIn, StaysInside)
def _keep_in(asked: ContainedIn | StaysInside, finding: Finding, evidence: Evidence) -> RepairTarget:
    """A fluid leaks; a body goes through a wall or over it."""
    if any(fluid.prim == finding.prim for fluid in evidence.world.fluids):
        return leak(finding, evidence)
    prim, ref = finding.prim or "", evidence.prim(asked.ref)
    container = evidence.container(ref)
    if container is None:  # a bucket, say: whether it is missed or left, aiming is what is open
        why = f"it is not in {ref}: let it start there, or aim it there"
        return RepairTarget(
            kind="settlement", prim=finding.prim, parameter="position", direction="change", unit="m", why=why
        )
    frame = evidence.recording.frame_index(finding.time or 0.0)
    p = evidence.local(container, evidence.body_q[frame, evidence.index(prim), :3])
    if not started_in(evidence, prim, container):
        return beside(evidence, prim, ref)
    if p[2] > container.inner_size[2] / 2:
        return too_small(evidence, ref, abs(finding.value or 0.0))
    return fallen_through(evidence, prim, ref)


@mends(Upright)
def _stand(asked: Upright, finding: Finding, evidence: Evidence) -> RepairTarget:
    """A wider foot tips later: the angle at which it does is that of its middle over its edge."""
    if (finding.value or 0.0) < (finding.limit or 0.0):
        return pushed_over(finding, evidence)
    why = "it tips where its middle is over its edge: a wider or a lower body, or a weaker push"
    return RepairTarget(kind="geometry", prim=finding.prim, parameter="size", direction="change", unit="m", why=why)


@mends(SpeedBetween)
def _speed_up(asked: SpeedBetween, finding: Finding, evidence: Evidence) -> RepairTarget:
    """The start decides how fast it is, by as much as is missing."""
    value, limit = finding.value or 0.0, finding.limit or 0.0
    now = float(np.linalg.norm(evidence.body(finding.prim or "").velocity))
    return RepairTarget(
        kind="physical parameter", prim=finding.prim, parameter="velocity",
        direction="raise" if value < limit else "lower", current=now, suggested=max(0.0, now + limit - value),
        unit="m/s", why="it starts with that much less or more",
    )  # fmt: skip


@mends(FollowsPath)
def _steer(asked: FollowsPath, finding: Finding, evidence: Evidence) -> RepairTarget:
    """What follows a path is steered."""
    why = "it leaves its path: what steers it must turn sooner or go slower"
    return RepairTarget(kind="controller", prim=finding.prim, parameter="path", direction="change", why=why)
