"""The gap between two objects, at frames and between them, and how small it is when they touch."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import lengths, multiply, rotate
from wsim.geometry.shapes import kind_of
from wsim.judge.evidence.contact import distance
from wsim.judge.evidence.recorded import MissingError
from wsim.judge.language.between import Course, turned
from wsim.scene.contact import within

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.language.signals import Signals
    from wsim.scene.world import World

    Floats = NDArray[np.float64]
    Indices = NDArray[np.intp]

PARTS = 8  # of the time between two frames, at which a gap is looked for
NEAR = 0.02  # of a body's smallest extent, and of its way between two frames: what touches may be off by
NUDGE = 1e-3  # of the smallest extent, by which a body is moved to see which way the gap grows
ALONG = 0.5  # cosine of what a blow changes and its normal: friction may turn it by so much
SLOP = 1e-3  # of the smallest extent: surfaces as near as that are one, to the solver
ONLY_CROSSED = 1e9  # [m]: where two lines do not cross there is no least of theirs


def gap(signals: Signals, one: str, other: str) -> Floats:
    """The gap between two objects' surfaces (W, T) [m], negative where one is in the other.

    Raises:
        MissingError: One of them has nothing that collides, or they are two meshes, whose distance is not measured.
    """
    a, b = signals.prim(one), signals.prim(other)
    if a == b:
        raise MissingError(f"{one!r} is named twice; name two objects")
    frames = signals.frames(one, other)
    kinds = [{shape.shape.kind for shape in frames.placed if shape.owner == prim} for prim in (a, b)]
    for prim, kind in zip((a, b), kinds, strict=True):
        if not kind:
            raise MissingError(f"{prim} has nothing that collides: it cannot touch")
    if kinds == [{"mesh"}, {"mesh"}] or kinds == [{"plane"}, {"plane"}]:
        raise MissingError(f"{a} and {b} are both a {next(iter(kinds[0]))}, whose distance is not measured")
    return signals.fold(distance(frames, a, b))


def moving_size(signals: Signals, one: str, other: str) -> float:
    """The smallest extent of the first of two objects that moves [m]."""
    return signals.solid(one if signals.moves(one) else other).smallest


def swept_gap(signals: Signals, one: str, other: str) -> Floats:
    """The least gap between each frame and the next, (W, T) [m]; of the last frame its own.

    In between, what moves goes on from the frame before as it goes there, and comes to the next one as it goes then: in
    a blow both ways meet at the surface. A gap counts where both have it, so that what bounces off a third thing on
    the way is not thought to have come nearer than it did. Looked for where they may meet within the frame. What is
    struck twice in it, as the middle balls of a cradle are, goes neither way for a while: where contacts are recorded,
    the two have no gap if they pressed on each other; else if a blow drives them apart so near to each other.
    """
    at_frames = gap(signals, one, other)
    least = at_frames.copy()
    least[:, :-1] = np.minimum(at_frames[:, :-1], at_frames[:, 1:])
    rows = [signals.row(name) for name in (one, other) if signals.moves(name)]
    h = np.diff(signals.time)
    way = np.zeros((signals.count, max(len(h), 0)))
    for i in rows:
        qd = signals.body_qd[:, :, i].astype(np.float64)
        fast = np.linalg.norm(qd[..., :3], axis=-1) + np.linalg.norm(qd[..., 3:], axis=-1) * _radius(signals, i)
        way = way + np.maximum(fast[:, :-1], fast[:, 1:]) * h + signals.gravity * h**2 / 2
    w, t = np.nonzero((least[:, :-1] > 0.0) & (least[:, :-1] <= way))
    if len(w) and rows:
        ways = [_carried_on(signals, rows, w, t, back) for back in (False, True)]
        time = np.zeros(len(w) * (PARTS + 1))
        gaps = [
            distance(signals.posed(rows, time, q.reshape(-1, len(rows), 7)), signals.prim(one), signals.prim(other))
            for q in ways
        ]
        ahead, behind = (each.reshape(len(w), PARTS + 1) for each in gaps)
        least[w, t] = np.minimum(least[w, t], _lowest(ahead, behind))
    met = signals.pressed(one, other)
    if signals.evidence is None or signals.evidence.recording.contacts is None:
        met = _struck(signals, one, other, least[:, :-1])
    least[:, :-1] = np.where(met, np.minimum(least[:, :-1], 0.0), least[:, :-1])
    return least


def _struck(signals: Signals, one: str, other: str, least: Floats) -> NDArray[np.bool_]:
    """Where a blow drives two objects apart that come as near as what touches (W, T - 1), their gap between frames."""
    course, reach = against(signals, one, other), touch_reach(signals, one, other)[0]
    reach = np.broadcast_to(reach, (signals.count, len(signals.time)))
    found = course.struck & (least <= np.maximum(reach[:, :-1], reach[:, 1:]))
    w, k = np.nonzero(found)
    if len(w):
        when, _, before, after = course.meet(k, k + 1, w)
        rows = [signals.row(name) for name in (one, other) if signals.moves(name)]
        normal = normal_of(signals, one, other, rows, struck_poses(signals, rows, w, k, k + 1, when))[1]
        parts = np.sum((after - before) * normal, axis=1) >= ALONG * lengths(after - before)
        found[w, k] = parts & (np.sum(before * normal, axis=1) < 0.0)
    return found


def _radius(signals: Signals, i: int) -> float:
    """Of a ball about a body's origin that holds it [m]."""
    reach = [kind_of(s).radius_about + float(np.linalg.norm(s.position)) for s in signals.world.bodies[i].shapes]
    return max((each for each in reach if np.isfinite(each)), default=0.0)


def _carried_on(signals: Signals, rows: list[int], w: Indices, t: Indices, back: bool) -> Floats:
    """Poses (N, PARTS + 1, B, 7) through intervals, from the frame before by its velocity or back from the next."""
    at = t + 1 if back else t
    h = signals.time[t + 1] - signals.time[t]
    s = np.linspace(0.0, 1.0, PARTS + 1) * h[:, None] - (h[:, None] if back else 0.0)
    poses = np.empty((len(w), PARTS + 1, len(rows), 7))
    for k, i in enumerate(rows):
        q, qd = signals.body_q[w, at, i].astype(np.float64), signals.body_qd[w, at, i].astype(np.float64)
        body = signals.world.bodies[i]
        com, course = np.array(body.com, dtype=np.float64), signals.course(body.prim)
        centre = course.place[w, at][:, None] + qd[:, None, :3] * s[..., None]
        # What is struck goes on as it sped up before it, and after; else as its speed changes meanwhile.
        smooth = (course.velocity[w, t + 1] - course.velocity[w, t]) / h[:, None]
        gains = np.where(course.struck[w, t][:, None], course.speeding(t, t + 1, w)[int(back)], smooth)
        centre = centre + 0.5 * (s**2)[..., None] * gains[:, None]
        turn = multiply(turned(qd[:, 3:], s), q[:, None, 3:])
        poses[:, :, k, 3:] = turn
        poses[:, :, k, :3] = centre - rotate(turn, com)
    return poses


def _lowest(a: Floats, b: Floats) -> Floats:
    """The least of the greater of two (N, P), on straight lines between their points, (N,)."""
    least = np.maximum(a, b).min(axis=1)
    gap_, next_ = a[:, :-1] - b[:, :-1], a[:, 1:] - b[:, 1:]
    share = np.where(gap_ * next_ < 0.0, gap_ / np.where(gap_ != next_, gap_ - next_, 1.0), 0.0)
    return np.asarray(
        np.minimum(least, (a[:, :-1] + share * (a[:, 1:] - a[:, :-1]) + ONLY_CROSSED * (share == 0.0)).min(axis=1))
    )


def about(values: Floats) -> Floats:
    """Of what is known from each frame to the next (W, T): the least about each frame."""
    return np.minimum(values, np.concatenate([values[:, :1], values[:, :-1]], axis=1))


def touch_limit(signals: Signals, one: str, other: str) -> tuple[Floats, str]:
    """The gap up to which two objects are taken to touch (W, T) [m], and why.

    Where it is recorded what presses on what, what does not press does not touch, however near it is; but for two
    between which no contacts are looked for, as both are led or fixed, a joint ties them, a gear meshes them, or they
    are made to pass.
    """
    free = [name for name in (one, other) if signals.moves(name) and not signals.body(name).kinematic]
    spared = _spared(signals.world, signals.prim(one), signals.prim(other))
    if signals.evidence is None or signals.evidence.recording.contacts is None or not free or spared:
        return touch_reach(signals, one, other)
    limit = np.full((1, 1), SLOP * moving_size(signals, one, other))
    return limit, f"{SLOP:g} L: where contacts are recorded, what does not press does not touch"


def _spared(world: World, a: str, b: str) -> bool:
    """Whether the simulator looks for no contact between two objects, or between some of their shapes."""
    tied = [(joint.parent or joint.fixture, joint.child) for joint in world.joints]
    turns = {joint.prim: joint.child for joint in world.joints}
    tied += [(turns.get(gear.first), turns[gear.second]) for gear in world.gears if gear.second in turns]
    apart = ((p, q) for pair in world.apart for p, q in (pair, pair[::-1]))
    return any({*pair} == {a, b} for pair in tied) or any(within(p, a) and within(q, b) for p, q in apart)


def touch_reach(signals: Signals, one: str, other: str) -> tuple[Floats, str]:
    """The gap up to which two objects may touch, as far as their ways tell (W, T) [m], and why."""
    relative = np.linalg.norm(signals.velocity(one) - signals.velocity(other), axis=-1)
    size, fall = moving_size(signals, one, other), signals.gravity * signals.step**2 / 8
    source = f"{NEAR:g} L, {NEAR:g} of the way between two frames, and g h^2 / 8: how well that way is known"
    return NEAR * size + NEAR * relative * signals.step + fall, source


def against(signals: Signals, one: str, other: str) -> Course:
    """How the first of two objects goes as seen from the second."""
    place, velocity = np.zeros((2, signals.count, len(signals.time), 3))
    pull = np.zeros(3)
    for name, sign in ((one, 1.0), (other, -1.0)):
        if signals.moves(name):
            own = signals.course(name)
            place, velocity, pull = place + sign * own.place, velocity + sign * own.velocity, pull + sign * own.pull
    return Course(signals.time, place, velocity, pull)


def struck_poses(signals: Signals, rows: list[int], w: Indices, first: Indices, last: Indices, when: Floats) -> Floats:
    """Poses of some bodies as a blow begins, (N, B, 7)."""
    found = np.empty((len(w), len(rows), 7))
    for k, i in enumerate(rows):
        q, qd = (each[w, first, i].astype(np.float64) for each in (signals.body_q, signals.body_qd))
        course, com = signals.course(signals.world.bodies[i].prim), np.array(signals.world.bodies[i].com)
        before, _ = course.speeding(first, last, w)
        place = course.place[w, first] + qd[:, :3] * when[:, None] + 0.5 * before * when[:, None] ** 2
        turn = multiply(turned(qd[:, 3:], when[:, None])[:, 0], q[:, 3:])
        found[:, k, :3], found[:, k, 3:] = place - rotate(turn, com), turn
    return found


def normals(signals: Signals, one: str, other: str, w: Indices, frame: Indices) -> Floats:
    """The way that the first of two objects has to go for their gap to grow, at frames of worlds w, (N, 3)."""
    rows = [signals.row(name) for name in (one, other) if signals.moves(name)]
    poses = np.stack([signals.body_q[w, frame, i].astype(np.float64) for i in rows], axis=1)
    return normal_of(signals, one, other, rows, poses)[1]


def normal_of(signals: Signals, one: str, other: str, rows: list[int], poses: Floats) -> tuple[Floats, Floats]:
    """The gap of two objects at poses (N, B, 7), and the unit vector to the first along which it grows (N, 3)."""
    nudge = NUDGE * moving_size(signals, one, other) * np.concatenate([np.zeros((1, 3)), np.eye(3), -np.eye(3)])
    asked = np.repeat(poses[:, None], len(nudge), axis=1)
    asked[:, :, 0, :3] += nudge
    evidence = signals.posed(rows, np.zeros(asked.shape[0] * len(nudge)), asked.reshape(-1, len(rows), 7))
    gaps = distance(evidence, signals.prim(one), signals.prim(other)).reshape(len(poses), len(nudge))
    grows = (gaps[:, 1:4] - gaps[:, 4:]) * (1.0 if signals.moves(one) else -1.0)
    return gaps[:, 0], grows / np.maximum(lengths(grows), 1e-30)[:, None]
