"""Which shapes meet in an interval between frames, and the impulses that they may then exert.

Contacts are looked for at both ends of an interval, and where something is hit at places between them, too.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import multiply, rotate
from wsim.judge.books.forces import ONE_WAY, STILL, Columns, Poses, pushes, slip
from wsim.judge.books.landing import keeps_way, landing
from wsim.judge.books.sharing import of_contacts
from wsim.judge.books.touching import NEAR, Contacts, together, touching_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]
    Rows = NDArray[np.intp]

PARTS = 4  # of an interval with a blow in it: where shapes meet is looked for at each
LOADS = 3.0  # of its weight, that a body in motion may press with
FAST = 0.3  # [m]: no blow is looked for beyond


class Meeting:
    """What touches in some intervals of W copies, N = W (T - 1) of B bodies each."""

    def __init__(self, copies: Sequence[Evidence], sizes: Floats) -> None:
        """`sizes` (W, B) [m] are those that torques are counted by."""
        motions = [evidence.motion for evidence in copies]
        self._frames, self._world, self._sizes = len(copies[0].time), copies[0].world, sizes
        self._touching = touching_of(copies)
        self._unit = max(float(np.linalg.norm(motions[0].gravity)), 1.0)  # [m/s^2]
        self._mechanism = motions[0].unit  # (B,), of all copies
        self._mass = np.stack([motion.mass for motion in motions])  # (W, B)
        # Frames, (W T, B, ...), and intervals, (N, ...)
        self._q = np.concatenate([evidence.body_q for evidence in copies])
        self._com, self._v, self._w = (
            np.concatenate([getattr(motion, name) for motion in motions]) for name in ("com", "v", "w")
        )
        self._h = np.concatenate([motion.h for motion in motions])
        self._copy = np.repeat(np.arange(len(copies)), len(motions[0].h))
        self._first = np.arange(len(self._copy)) + self._copy  # frame of each interval: one more in each copy
        self._far = np.minimum(np.concatenate([motion.reach for motion in motions]), FAST)
        self.caught = np.zeros(self._far.shape, dtype=bool)  # whose slip a blow may have ended, (N, B)
        self.landed = np.zeros(self._far.shape)  # by how much landings may change velocities, (N, B) [m/s]

    def pushes(self, ks: Rows, asked: Bools, hit: Bools, between: Bools, aside: Bools) -> list[Columns]:
        """The impulses of contacts of some intervals, a body in an interval being one of K B.

        Args:
            ks: The intervals, (K,).
            asked: Bodies that contacts are looked for of, (K, B).
            hit: Bodies that something hits, (K, B).
            between: Bodies that may touch between the frames alone, (K, B).
            aside: Bodies that take no impulse of those asked for, (K, B).
        """
        h, frames = self._h[ks], self._first[ks]
        ends = self._poses(frames), self._poses(frames + 1)
        moves, slight = np.any(between, axis=1), self._unit * h**2
        some, far = np.flatnonzero(moves), np.pad(self._far[ks], ((0, 0), (0, 1)))
        reach = self._reach(np.where(moves[:, None], far, slight[:, None]), ks)
        most = NEAR + np.where(moves, far.max(axis=1), 2.0 * slight)
        found = []
        for side, contacts in enumerate(self._at_frames(frames, reach, most, asked)):
            contacts = contacts.only(self._within_reach(contacts, ends[side], h, 0.0, between))
            if len(contacts):
                found.append((contacts, ends[side], side))
        for side, share in ((side, share) for side in (0, 1) for share in np.linspace(0.0, 1.0, PARTS + 1)[1:]):
            if not len(some):
                break
            moved = _moved(ends[side], np.repeat((share if side == 0 else -share) * h, hit.shape[1]))
            poses = moved.q.reshape(len(ks), -1, 7)[some]
            reach = self._reach(far[some] / PARTS, ks[some])
            contacts = self._touching.of_many(poses, reach, some, self._copy[ks[some]], between[some])
            contacts = contacts.only(_any(asked, contacts) & self._within_reach(contacts, moved, h, share, between))
            if len(contacts):
                found.append((contacts, moved, side))
        columns = []
        for (contacts, moved, _), along in zip(found, self._lasting(found, ends, hit, ks), strict=True):
            ours = np.flatnonzero(~_any(aside, contacts))
            contacts, along = contacts.only(ours), along[ours]
            friction, rolling = self._touching.laws(contacts.shapes)
            rolling = self._rolling(contacts, rolling, friction, self._copy[ks])
            near = (contacts.gap <= NEAR) | _any(hit, contacts)
            columns.append(pushes(contacts, moved, friction, along, rolling, near))
        return columns

    def _reach(self, far: Floats, ks: Rows) -> Floats:
        """How far the shapes of each body, and of the world, are looked for, (K, B + 1) [m]: as belts run, too."""
        belts, shapes = np.zeros(far.shape[1]), self._touching.shapes
        runs = np.linalg.norm(self._touching.surface_velocity, axis=1)
        np.maximum.at(belts, np.array([row for row, _, _ in shapes], dtype=np.intp), runs)
        found: Floats = 0.5 * NEAR + far + self._h[ks, None] * belts
        return found

    def _at_frames(self, firsts: Rows, reach: Floats, most: Floats, asked: Bools) -> tuple[Contacts, Contacts]:
        """Contacts at both ends of some intervals; a frame that ends one and begins another is looked at once.

        Args:
            firsts: Their first frames, (K,).
            reach: How far shapes are looked for, (K, B + 1) [m].
            most: The widest gap that counts, (K,) [m].
            asked: Whose contacts, (K, B).
        """
        frames, which = np.unique(np.concatenate([firsts, firsts + 1]), return_inverse=True)
        sides, bodies = which.reshape(2, -1), max(self._q.shape[1], 1)
        far, about = np.zeros((len(frames), reach.shape[1])), np.zeros((len(frames), asked.shape[1]), dtype=bool)
        for side in sides:
            far[side], about[side] = np.maximum(far[side], reach), about[side] | asked
        every = self._touching.of_many(self._q[frames], far, np.arange(len(frames)), frames // self._frames, about)
        frame = np.maximum(every.one, every.two) // bodies
        first = np.searchsorted(frame, np.arange(len(frames) + 1))
        found = []
        for side in sides:
            counts = first[side + 1] - first[side]
            row = np.repeat(np.arange(len(firsts)), counts)
            at = np.arange(counts.sum()) + np.repeat(first[side] - np.cumsum(counts) + counts, counts)
            chosen, by = every.only(at), (row - frame[at]) * bodies
            one, two = (np.where(rows >= 0, rows + by, rows) for rows in (chosen.one, chosen.two))
            contacts = replace(chosen, one=one, two=two)
            found.append(contacts.only((chosen.gap <= most[row]) & _any(asked, contacts)))
        return found[0], found[1]

    def _within_reach(self, contacts: Contacts, poses: Poses, h: Floats, share: float, between: Bools) -> Bools:
        """Contacts whose gap may close within the part of the interval that a pose stands for."""
        speed = np.abs(np.einsum("ni,ni->n", slip(self._touching, contacts, poses), contacts.normal))
        length = h[np.maximum(contacts.one, contacts.two) // between.shape[1]]
        part = length / PARTS if share > 0.0 else length
        close = contacts.gap <= NEAR + (speed + self._unit * length) * part
        return np.asarray(close & (_any(between, contacts) | (share == 0.0)))

    def _lasting(
        self, found: list[tuple[Contacts, Poses, int]], ends: tuple[Poses, Poses], hit: Bools, ks: Rows
    ) -> list[Floats]:
        """The ways of each contact's slip where its pair slips one way from one frame to the next, else 0.

        Of each contact two, (n, 2, 3): at its end of the interval, and halfway to that of the other end; as long as the
        share of friction's most that acts against it, which is all where nothing resists rolling.
        """
        if not found:
            return []
        copy, masses = self._copy[ks], self._mass[self._copy[ks]].ravel()
        landed = np.zeros(len(masses))
        flat: list[Floats] = []
        later: list[Floats] = []
        shares: list[Floats] = []
        for contacts, there, end in found:
            lands = landing(self._touching, contacts, there, np.repeat(self._h[ks], hit.shape[1]), masses, end)
            landed = np.maximum(landed, lands)
            carried = _carried(contacts, ends[end], ends[1 - end])
            for kept, touching, poses in ((flat, contacts, ends[end]), (later, carried, ends[1 - end])):
                u = slip(self._touching, touching, poses)
                kept.append(u - np.einsum("ni,ni->n", u, contacts.normal)[:, None] * contacts.normal)
                shares.append(of_contacts(self._touching, touching, poses, kept[-1]))
        self.landed[ks] = np.maximum(self.landed[ks], landed.reshape(hit.shape))
        every, own, then = together([contacts for contacts, _, _ in found]), np.concatenate(flat), np.concatenate(later)
        side = np.repeat([end for _, _, end in found], [len(contacts) for contacts, _, _ in found])
        rows = len(ends[0].v) + 1
        pair, which = np.unique((every.one + 1) * rows + every.two + 1, return_inverse=True)
        touches = np.zeros((2, len(pair)), dtype=bool)
        touches[side, which] = True
        then = np.where(touches[1 - side, which][:, None], then, 0.0)
        speed, speed_then = np.linalg.norm(own, axis=1), np.linalg.norm(then, axis=1)
        # It lasts where it would have a frame longer: what sticks may have stuck, or come loose, within the interval.
        slowest, change = np.minimum(speed, speed_then), np.linalg.norm(own - then, axis=1)
        lasts = (slowest > np.maximum(self._creep(every, copy), change)) & (
            np.sum(own * then, axis=1) > ONE_WAY * speed * speed_then
        )
        lasts &= ~self._touching.changing[every.shapes].any(axis=1)
        lasts &= ~_any(self.caught[ks], every) & keeps_way(every, slowest, landed)
        ways = np.stack([own / np.maximum(speed, 1e-300)[:, None], then / np.maximum(speed_then, 1e-300)[:, None]])
        ways[1] += ways[0]
        ways /= np.maximum(np.linalg.norm(ways, axis=2, keepdims=True), 1e-300)
        both = np.stack([np.concatenate(shares[0::2]), np.concatenate(shares[1::2])])
        if self._world.cone == "pyramid":  # its edges are up to 45 degrees off the slip, its sides nearer
            across = np.cross(every.normal, ways)
            ways = np.concatenate([ways, *((ways + side * across) * np.sqrt(0.5) for side in (-1.0, 0.0, 1.0))])
        else:
            ways *= np.stack([both[0], both.mean(axis=0)])[..., None]
        along = np.where(lasts[:, None, None], ways.transpose(1, 0, 2), 0.0)
        return np.split(along, np.cumsum([len(contacts) for contacts, _, _ in found])[:-1])

    def _creep(self, contacts: Contacts, copy: Rows) -> Floats:
        """The slip of each contact that soft friction may leave, (n,) [m/s]; of intervals (K,) of some copies.

        It takes the acceleration mu N / m of the body alone, which may be pressed by thrice all that hangs on it.
        """
        if self._world.give.creep == 0.0:
            return np.full(len(contacts), STILL)
        friction = self._touching.laws(contacts.shapes)[0]
        of = self._mechanism[:, None] == self._mechanism[None]
        total = (self._mass @ of / self._mass)[copy].ravel()
        rows = np.stack([contacts.one, contacts.two])
        loads = np.where(rows >= 0, total[np.maximum(rows, 0)], 0.0).max(axis=0)
        taken = LOADS * friction * self._unit * loads
        found: Floats = np.maximum(STILL, self._world.give.creep * taken)
        return found

    def _rolling(self, contacts: Contacts, rolling: Floats, friction: Floats, copy: Rows) -> Floats:
        """The torque that resists turning, for a push of one [m]: rolling's, or spinning's, which is the greater."""
        rows = np.where(contacts.two >= 0, contacts.two, contacts.one)
        found: Floats = np.maximum(rolling, np.pi * friction * rolling) * self._sizes[copy].ravel()[rows]
        return found

    def _poses(self, frames: Rows) -> Poses:
        q, com, v, w = self._q[frames], self._com[frames], self._v[frames], self._w[frames]
        return Poses(q.reshape(-1, 7), com.reshape(-1, 3), v.reshape(-1, 3), w.reshape(-1, 3))


def _carried(contacts: Contacts, here: Poses, there: Poses) -> Contacts:
    """Contacts at the other end of an interval, where the body goes that touches: a box that spins slips all round."""
    rows = np.where(contacts.two >= 0, contacts.two, contacts.one)
    way = np.where((rows >= 0)[:, None], there.com[np.maximum(rows, 0)] - here.com[np.maximum(rows, 0)], 0.0)
    return replace(contacts, point=contacts.point + way)


def _moved(poses: Poses, dt: Floats) -> Poses:
    """Where bodies are by their velocities `dt` (B,) [s] on."""
    if not dt.any():
        return poses
    angle = poses.w * dt[:, None]
    size = np.linalg.norm(angle, axis=1, keepdims=True)
    turn = np.concatenate([angle / np.maximum(size, 1e-12) * np.sin(0.5 * size), np.cos(0.5 * size)], axis=1)
    com = poses.com + poses.v * dt[:, None]
    place = com + rotate(turn, poses.q[:, :3] - poses.com)
    return Poses(np.concatenate([place, multiply(turn, poses.q[:, 3:])], axis=1), com, poses.v, poses.w)


def _any(bodies: Bools, contacts: Contacts) -> Bools:
    """Whether either body of a contact is one of some (K, B)."""
    rows = np.stack([contacts.one, contacts.two])
    return np.asarray((bodies.ravel()[np.maximum(rows, 0)] & (rows >= 0)).any(axis=0))
