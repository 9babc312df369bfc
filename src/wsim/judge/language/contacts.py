"""The gap between two objects, at frames and between them, and how small it is when they touch."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import multiply, rotate
from wsim.geometry.shapes import kind_of
from wsim.judge.evidence.contact import distance
from wsim.judge.evidence.recorded import MissingError
from wsim.judge.language.between import turned

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.language.signals import Signals

    Floats = NDArray[np.float64]
    Indices = NDArray[np.intp]

PARTS = 8  # of the time between two frames, at which a gap is looked for
NEAR = 0.02  # of a body's smallest extent, and of its way between two frames: what touches may be off by
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
    the two have no gap if they pressed on each other.
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
    least[:, :-1] = np.where(signals.pressed(one, other), np.minimum(least[:, :-1], 0.0), least[:, :-1])
    return least


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
    gravity = np.array(signals.world.gravity, dtype=np.float64)
    for k, i in enumerate(rows):
        q, qd = signals.body_q[w, at, i].astype(np.float64), signals.body_qd[w, at, i].astype(np.float64)
        gained = (signals.body_qd[w, t + 1, i, :3] - signals.body_qd[w, t, i, :3]).astype(np.float64)
        # What flies falls; what is carried, or is hit in between, is taken to go on as it does.
        falls = np.linalg.norm(gained - gravity * h[:, None], axis=-1) < 0.5 * np.linalg.norm(gravity) * h
        com = np.array(signals.world.bodies[i].com, dtype=np.float64)
        place = q[:, :3] + rotate(q[:, 3:], com)
        centre = place[:, None] + qd[:, None, :3] * s[..., None]
        centre = centre + 0.5 * (falls[:, None] * s**2)[..., None] * gravity
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


def touch_reach(signals: Signals, one: str, other: str) -> tuple[Floats, str]:
    """The gap up to which two objects count as touching (W, T) [m], and why."""
    relative = np.linalg.norm(signals.velocity(one) - signals.velocity(other), axis=-1)
    size, fall = moving_size(signals, one, other), signals.gravity * signals.step**2 / 8
    source = f"{NEAR:g} L, {NEAR:g} of the way between two frames, and g h^2 / 8: how well that way is known"
    return NEAR * size + NEAR * relative * signals.step + fall, source
