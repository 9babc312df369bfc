"""What creeps: points of contact that slip one way for many frames, each time by less than a frame shows.

Within one interval a slow slip may come and go, and friction may be anything inside its cone. Over many frames it is
told by how far the two points that touch have gone apart, by the poses alone: where each frame adds to it, the slip
lasts, and friction is against it on the cone's edge. The change of momentum over all of them then has its forces, or
something creeps that friction would hold, or would stop.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import conjugate, lengths, multiply, rotate
from wsim.judge.books.admissible import explain
from wsim.judge.books.balance import Books
from wsim.judge.books.forces import STILL, Poses, pushes
from wsim.judge.books.phases import latest
from wsim.judge.books.touching import NEAR, Contacts, Touching, touching_of
from wsim.judge.evidence.motion import FLOAT32

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence

    Floats = NDArray[np.float64]

INTERVALS = 16  # that a slip lasts for
EACH = 0.3  # of the mean: each frame adds as much to a slip that lasts
TURN = 0.02  # [rad]: what turns by more against what it touches rolls
ROUND = 0.1  # [rad]: what turns both by more, as a turntable does, turns the friction's way with it
SHARED = 0.2  # what resists rolling over friction, by the ways of both: the slip has all but 2 % of the cone's edge
CREEP = 2e-5  # [m/s]: what wsim leaves of what friction holds is below 1e-6
ORDERS = 1.1  # times what steps of two orders leave between what leads and what is led, found: 0.99
ENOUGH = 1e-3  # of gravity: a rest that is as good as none


@dataclass(frozen=True)
class Lacking:
    """What a body lacks to go on as it does for many frames."""

    row: int
    first: int  # frame
    last: int
    drift: Floats  # (3,) [m], of it over what it touches; 0 if it stands
    force: Floats  # (3,) [m/s^2], of its mass: what nothing gives


def creeps(copies: Sequence[Evidence]) -> list[list[Lacking]]:
    """All of some recordings of similar worlds, in spans that overlap by a half."""
    spans = [Span(n, first, calm) for n, evidence in enumerate(copies) for first, calm in _spans(evidence)]
    found: list[list[Lacking]] = [[] for _ in copies]
    if not spans:
        return found
    touching = touching_of(copies)
    contacts, at = _contacts(copies, touching, spans)
    drift = _drifts(copies, touching, contacts, at, spans)
    own = replace(contacts, shapes=contacts.shapes % max(len(touching.shapes) // len(touching.worlds), 1))
    for k in np.unique(at[np.any(drift != 0.0, axis=1)]):
        found[spans[k].copy] += _of_span(copies[spans[k].copy], own.only(at == k), spans[k], drift[at == k])
    return found


@dataclass(frozen=True)
class Span:
    """Some intervals of one of several recordings."""

    copy: int
    first: int  # frame
    calm: NDArray[np.bool_]  # (B,), what nothing hits in it

    @property
    def last(self) -> int:
        """Its last frame."""
        return self.first + INTERVALS

    @property
    def middle(self) -> int:
        """The frame in its middle."""
        return self.first + INTERVALS // 2


def _spans(evidence: Evidence) -> list[tuple[int, NDArray[np.bool_]]]:
    """Where a recording's bodies may creep: from which frame on, and those that nothing hits (B,)."""
    motion, books = evidence.motion, Books.of(evidence)
    firsts = np.arange(0, len(motion.h) - INTERVALS + 1, INTERVALS // 2)
    moved = lengths(motion.com[firsts + INTERVALS] - motion.com[firsts])
    hit = books.hit[firsts[:, None] + np.arange(INTERVALS)].any(axis=1)
    calm = ~motion.jointed & ~motion.kinematic & ~hit
    least = CREEP * (evidence.time[firsts + INTERVALS] - evidence.time[firsts])
    spans = np.flatnonzero(np.any(calm & (moved > least[:, None]), axis=1))
    return [(int(firsts[span]), calm[span]) for span in spans]


def _contacts(
    copies: Sequence[Evidence], touching: Touching, spans: Sequence[Span]
) -> tuple[Contacts, NDArray[np.intp]]:
    """Those in the middle of all spans, as each recording by itself counts bodies, and the span of each, (n,)."""
    every, poses = np.arange(len(spans)), np.stack([copies[span.copy].body_q[span.middle] for span in spans])
    which = np.array([span.copy for span in spans])
    contacts = touching.of_many(poses, np.full(len(spans), NEAR), every, which)
    bodies = max(poses.shape[1], 1)
    at = np.maximum(contacts.one, contacts.two) // bodies
    one, two = (np.where(rows >= 0, rows - at * bodies, rows) for rows in (contacts.one, contacts.two))
    return replace(contacts, one=one, two=two), at


def _of_span(evidence: Evidence, contacts: Contacts, span: Span, drift: Floats) -> list[Lacking]:
    """What its bodies lack to go on, that creep by these drifts (n, 3) at their contacts."""
    books, middle, calm, first, last = Books.of(evidence), span.middle, span.calm, span.first, span.last
    motion, touching, size = evidence.motion, Touching.of(evidence), books.size
    poses = Poses(evidence.body_q[middle], motion.com[middle], motion.v[middle], motion.w[middle])
    slips = np.any(drift != 0.0, axis=1)
    rows = {int(row) for one, two in zip(contacts.one[slips], contacts.two[slips], strict=True) for row in (one, two)}
    creeping = [row for row in sorted(rows) if row >= 0 and calm[row]]
    if not creeping:
        return []
    friction, rolling = touching.laws(contacts.shapes)
    ways = drift / np.maximum(np.linalg.norm(drift, axis=1, keepdims=True), 1e-300)
    arm = size[np.where(contacts.two >= 0, contacts.two, contacts.one)]
    turning = np.maximum(rolling, np.pi * friction * rolling) * arm
    columns = pushes(contacts, poses, friction, np.stack([ways, ways], axis=1), turning)
    scale = np.repeat(1.0 / motion.mass, 6).reshape(-1, 6)
    scale[:, 3:] /= size[:, None]
    wanted = books.wanted[first:last].mean(axis=0)
    rest, *_ = explain(columns, calm, wanted, scale, ENOUGH * max(evidence.gravity, 1.0))
    found = []
    for row in creeping:
        own = slips & ((contacts.one == row) | (contacts.two == row))
        sign = np.where(contacts.two[own] == row, 1.0, -1.0)
        found.append(Lacking(row, first, last, (sign[:, None] * drift[own]).mean(axis=0), rest[row, :3]))
    return found


def _drifts(
    copies: Sequence[Evidence], touching: Touching, contacts: Contacts, at: NDArray[np.intp], spans: Sequence[Span]
) -> Floats:
    """How far each contact's second body goes over the first in its span, (n, 3) [m]; 0 if not steadily."""
    copy, firsts = (np.array([getattr(span, name) for span in spans]) for name in ("copy", "first"))
    time, frames = copies[0].time, firsts[:, None] + np.arange(INTERVALS + 1)
    q = np.stack([copies[span.copy].body_q[span.first : span.last + 1] for span in spans])  # (spans, F, B, 7)
    paths = [_path(touching, contacts, side, at, q, time[frames]) for side in (0, 1)]
    apart = paths[1] - paths[0]  # (n, F, 3)
    apart = apart - np.einsum("nfi,ni->nf", apart, contacts.normal)[..., None] * contacts.normal[:, None]
    drift = apart[:, -1] - apart[:, 0]
    length = np.linalg.norm(drift, axis=1)
    gone = np.einsum("nfi,ni->nf", np.diff(apart, axis=1), drift / np.maximum(length, 1e-300)[:, None])
    rounding = 2.0 * FLOAT32 * np.abs(q[..., :3]).max(axis=(1, 2, 3), initial=0.0)[at]  # of both ends
    rate = length / (time[frames[:, -1]] - time[firsts])[at]
    steady = gone.min(axis=1) > EACH * length / INTERVALS
    steady &= (rate > np.maximum(CREEP, _soft(copies, touching, contacts, copy[at], at))) & (rate < 2.0 * STILL)
    steady &= (length > INTERVALS * rounding) & ~touching.changing[contacts.shapes].any(axis=1)
    steady &= rate > _behind(copies, copy[at], paths, (time[frames[:, -1]] - time[firsts])[at])
    relative, absolute = _turned(contacts, at, q)
    steady &= (relative < TURN) & (absolute < ROUND)
    # Resisted rolling shares the cone with the slip, and goes with one: friction is then inside it.
    friction, rolling = touching.laws(contacts.shapes)
    sizes = np.stack([Books.of(evidence).size for evidence in copies])
    arm = sizes[copy[at], np.where(contacts.two >= 0, contacts.two, contacts.one)]
    steady &= np.maximum(rolling, np.pi * friction * rolling) * arm * relative <= SHARED * friction * length
    return np.where(steady[:, None], drift, 0.0)


def _behind(copies: Sequence[Evidence], copy: NDArray[np.intp], paths: Sequence[Floats], span: Floats) -> Floats:
    """The slip that steps leave between what is led round and what it carries, (n,) [m/s].

    Steps of the first order take what goes at v from one to the next by the velocity at the end, those of the second by
    the mean: where one body goes by each, at an acceleration a, one is a t ahead, t half a time step. What lies on a
    turntable so drifts out by w^2 r t, and back by w' r t as that gains speed.

    Args:
        copies: Of similar worlds, over the same times.
        copy: Whose each contact is, (n,).
        paths: Of the points of both bodies at each contact, (n, F, 3) each [m].
        span: How long these are, (n,) [s].
    """
    middle = paths[0].shape[1] // 2
    bends = [lengths(path[:, 0] - 2.0 * path[:, middle] + path[:, -1]) for path in paths]
    late = np.array([latest(evidence) for evidence in copies])
    found: Floats = ORDERS * late[copy] * np.maximum(*bends) / (0.5 * span) ** 2
    return found


def _soft(
    copies: Sequence[Evidence], touching: Touching, contacts: Contacts, copy: NDArray[np.intp], at: NDArray[np.intp]
) -> Floats:
    """The slip that another engine's soft friction leaves to what is pressed by all that is there, (n,) [m/s]."""
    give = copies[0].world.give
    if give.creep == 0.0 or not len(at):
        return np.zeros(len(at))
    mass = np.stack([evidence.motion.mass for evidence in copies])
    lightest = np.full(int(at.max()) + 1, np.inf)
    for rows in (contacts.one, contacts.two):
        np.minimum.at(lightest, at[rows >= 0], mass[copy, rows][rows >= 0])
    loads = (mass @ ~copies[0].motion.kinematic)[copy] / lightest[at]
    found: Floats = give.creep * touching.laws(contacts.shapes)[0] * copies[0].gravity * loads
    return found


def _path(touching: Touching, contacts: Contacts, side: int, at: NDArray[np.intp], q: Floats, time: Floats) -> Floats:
    """Where the material point that is at a contact in its span's middle frame is in each frame, (n, F, 3) [m].

    Args:
        touching: The shapes.
        contacts: n of them.
        side: Of the first or the second body (1).
        at: Their spans, (n,).
        q: Poses in these, (spans, F, B, 7).
        time: Likewise, (spans, F) [s].
    """
    rows, middle = (contacts.two if side else contacts.one), INTERVALS // 2
    belt = touching.surface_velocity[contacts.shapes[:, side]]
    gone = (time - time[:, [middle]])[at][..., None] * belt[:, None]
    if not q.shape[2]:
        return contacts.point[:, None] + gone
    poses = q[at, :, np.maximum(rows, 0)]  # (n, F, 7)
    own = rotate(conjugate(poses[:, middle, 3:]), contacts.point - poses[:, middle, :3])
    moving = poses[..., :3] + rotate(poses[..., 3:], own[:, None] + gone)
    found: Floats = np.where((rows >= 0)[:, None, None], moving, contacts.point[:, None] + gone)
    return found


def _turned(contacts: Contacts, at: NDArray[np.intp], q: Floats) -> tuple[Floats, Floats]:
    """By how much the bodies of each contact turn in a span, against each other and at most, (n,) each [rad]."""
    turns = []
    for rows in (contacts.one, contacts.two):
        first, last = (q[at, frame, np.maximum(rows, 0), 3:] for frame in (0, -1))
        turns.append(np.where((rows >= 0)[:, None], multiply(last, conjugate(first)), (0.0, 0.0, 0.0, 1.0)))
    relative = multiply(turns[1], conjugate(turns[0]))
    apart: Floats = 2.0 * np.linalg.norm(relative[:, :3], axis=1)
    most: Floats = 2.0 * np.maximum(*(np.linalg.norm(turn[:, :3], axis=1) for turn in turns))
    return apart, most
