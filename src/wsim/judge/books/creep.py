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
    spans = [(n, first, calm) for n, evidence in enumerate(copies) for first, calm in _spans(evidence)]
    found: list[list[Lacking]] = [[] for _ in copies]
    for (n, first, calm), contacts in zip(spans, _contacts(copies, spans), strict=True):
        found[n] += _of_span(copies[n], contacts, calm, first, first + INTERVALS)
    return found


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


def _contacts(copies: Sequence[Evidence], spans: Sequence[tuple[int, int, NDArray[np.bool_]]]) -> list[Contacts]:
    """Those in the middle of each span, as each recording by itself counts bodies and shapes."""
    if not spans:
        return []
    touching, every = touching_of(copies), np.arange(len(spans))
    poses = np.stack([copies[n].body_q[first + INTERVALS // 2] for n, first, _ in spans])
    which = np.array([n for n, *_ in spans])
    contacts = touching.of_many(poses, np.full(len(spans), NEAR), every, which)
    bodies, shapes = poses.shape[1], len(touching.shapes) // len(touching.worlds)
    at = np.maximum(contacts.one, contacts.two) // max(bodies, 1)
    one, two = (np.where(rows >= 0, rows - at * bodies, rows) for rows in (contacts.one, contacts.two))
    own = replace(contacts, one=one, two=two, shapes=contacts.shapes % max(shapes, 1))
    return [own.only(at == k) for k in every]


def _of_span(evidence: Evidence, contacts: Contacts, calm: NDArray[np.bool_], first: int, last: int) -> list[Lacking]:
    books, middle = Books.of(evidence), (first + last) // 2
    motion, touching, size = evidence.motion, Touching.of(evidence), books.size
    poses = Poses(evidence.body_q[middle], motion.com[middle], motion.v[middle], motion.w[middle])
    if not len(contacts):
        return []
    drift = _drifts(evidence, touching, contacts, first, last)
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


def _drifts(evidence: Evidence, touching: Touching, contacts: Contacts, first: int, last: int) -> Floats:
    """How far each contact's second body goes over the first in a span, (n, 3) [m]; 0 if not steadily."""
    time = evidence.time[first : last + 1]
    frames = np.arange(first, last + 1)
    paths = [_path(evidence, touching, contacts, side, frames) for side in (0, 1)]
    apart = paths[1] - paths[0]  # (n, F, 3)
    apart = apart - np.einsum("nfi,ni->nf", apart, contacts.normal)[..., None] * contacts.normal[:, None]
    drift = apart[:, -1] - apart[:, 0]
    length = np.linalg.norm(drift, axis=1)
    gone = np.einsum("nfi,ni->nf", np.diff(apart, axis=1), drift / np.maximum(length, 1e-300)[:, None])
    rounding = 2.0 * FLOAT32 * float(np.abs(evidence.body_q[frames, :, :3]).max(initial=0.0))  # of both ends
    rate = length / (time[-1] - time[0])
    steady = gone.min(axis=1) > EACH * length / INTERVALS
    steady &= (rate > np.maximum(CREEP, _soft(evidence, touching, contacts))) & (rate < 2.0 * STILL)
    steady &= length > INTERVALS * rounding
    relative, absolute = _turned(evidence, contacts, first, last)
    steady &= (relative < TURN) & (absolute < ROUND)
    # Resisted rolling shares the cone with the slip, and goes with one: friction is then inside it.
    friction, rolling = touching.laws(contacts.shapes)
    arm = Books.of(evidence).size[np.where(contacts.two >= 0, contacts.two, contacts.one)]
    steady &= np.maximum(rolling, np.pi * friction * rolling) * arm * relative <= SHARED * friction * length
    return np.where(steady[:, None], drift, 0.0)


def _soft(evidence: Evidence, touching: Touching, contacts: Contacts) -> Floats:
    """The slip that another engine's soft friction leaves to what is pressed by all that is there, (n,) [m/s]."""
    motion, friction = evidence.motion, touching.laws(contacts.shapes)[0]
    lightest = min(motion.mass[rows[rows >= 0]].min(initial=np.inf) for rows in (contacts.one, contacts.two))
    loads = motion.mass[~motion.kinematic].sum() / lightest
    found: Floats = evidence.world.give.creep * friction * evidence.gravity * loads
    return found


def _path(evidence: Evidence, touching: Touching, contacts: Contacts, side: int, frames: NDArray[np.intp]) -> Floats:
    """Where the material point that is at a contact in the middle frame is in each frame, (n, F, 3) [m]."""
    rows, middle = (contacts.two if side else contacts.one), frames[len(frames) // 2]
    belt = touching.surface_velocity[contacts.shapes[:, side]]
    since = evidence.time[frames] - evidence.time[middle]
    at = np.maximum(rows, 0)
    if not evidence.body_q.shape[1]:
        return contacts.point[:, None] + since[:, None] * belt[:, None]
    q = evidence.body_q[frames][:, at].transpose(1, 0, 2)  # (n, F, 7)
    own = rotate(conjugate(evidence.body_q[middle, at, 3:]), contacts.point - evidence.body_q[middle, at, :3])
    moving = q[..., :3] + rotate(q[..., 3:], own[:, None] + since[:, None] * belt[:, None])
    found: Floats = np.where(
        (rows >= 0)[:, None, None], moving, contacts.point[:, None] + since[:, None] * belt[:, None]
    )
    return found


def _turned(evidence: Evidence, contacts: Contacts, first: int, last: int) -> tuple[Floats, Floats]:
    """By how much the bodies of each contact turn in a span, against each other and at most, (n,) each [rad]."""
    turns = []
    for rows in (contacts.one, contacts.two):
        q = evidence.body_q[[first, last]][:, np.maximum(rows, 0), 3:]
        turn = multiply(q[1], conjugate(q[0]))
        turns.append(np.where((rows >= 0)[:, None], turn, (0.0, 0.0, 0.0, 1.0)))
    relative = multiply(turns[1], conjugate(turns[0]))
    apart: Floats = 2.0 * np.linalg.norm(relative[:, :3], axis=1)
    most: Floats = 2.0 * np.maximum(*(np.linalg.norm(turn[:, :3], axis=1) for turn in turns))
    return apart, most
