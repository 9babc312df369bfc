"""For each interval between frames: what change of momentum no admissible impulse explains.

The change of momentum and of angular momentum of each body, less gravity and what fluid and control gave it, must be a
sum of impulses that the world can exert: of contacts where shapes touch or may have met in the interval, pushing only
and inside the cone of the pair's friction, on its edge against a slip that lasts; of joints and springs along what they
hold. Non-negative least squares (Lawson and Hanson 1974) finds them, for what hangs together in the interval at once;
what is left over is the finding.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import nnls

from wsim.geometry.rotations import multiply, rotate
from wsim.judge.books.forces import ONE_WAY, STILL, Columns, Poses, pushes, slip
from wsim.judge.books.ties import Ties
from wsim.judge.books.touching import Contacts, Touching, together
from wsim.judge.evidence.motion import FLOAT32

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]

NEAR = 2e-3  # [m]: what is nearer than this touches
PARTS = 4  # of an interval with a blow in it: where shapes meet is looked for at each
SOFT = 2.0  # times gravity's pull over the interval: what changes a velocity by less is no blow
AGAIN = 0.03  # of gravity: where more is left, contacts are looked for between the frames
FAST = 0.3  # [m]: no blow is looked for beyond


@dataclass(frozen=True)
class Books:
    """What is left over, for T - 1 intervals and B bodies, and what was passed on."""

    force: Floats  # (T - 1, B, 3), of momentum over the interval's length and the mass [m/s^2]
    torque: Floats  # (T - 1, B, 3), of angular momentum over m R and the interval's length [m/s^2]
    blow: Floats  # (T - 1, B) change of velocity, of its surface too, that was to be explained [m/s]
    turned: Floats  # (T - 1, B, 2): what may be missing of both, as bodies turn while they are held [m/s^2]
    judged: Bools  # (T - 1, B)


class Balance:
    """Works the books out."""

    def __init__(self, evidence: Evidence) -> None:
        self._evidence, self._motion = evidence, evidence.motion
        self._touching = Touching(evidence.world)
        self._ties = Ties(evidence)
        motion = self._motion
        self._pull = float(np.linalg.norm(motion.gravity))
        self.size = np.maximum(np.maximum(motion.radius, self._ties.arms), 1e-4)

    def books(self) -> Books:
        """All intervals."""
        motion = self._motion
        force = motion.acceleration - motion.gravity
        arm = (motion.mass * self.size)[:, None]
        torque = np.diff(motion.angular_momentum, axis=0) / motion.h[:, None, None] / arm
        turning = np.linalg.norm(torque, axis=2)
        blow = (np.linalg.norm(force, axis=2) + turning) * motion.h[:, None]
        judged = ~self._left_out()
        left, turned = np.concatenate([force, torque], axis=2), np.zeros((*blow.shape, 2))
        rate = np.linalg.norm(motion.w, axis=2)
        for k in range(len(motion.h)):
            left[k], passed = self._interval(k, left[k], blow[k], judged[k])
            turn = float(np.max(np.maximum(rate[k], rate[k + 1]) * motion.h[k], initial=0.0))
            turned[k] = turn**2 / 12.0 * passed  # the error of an arm taken halfway
        return Books(left[..., :3], left[..., 3:], blow, turned, judged)

    def _left_out(self) -> Bools:
        """Bodies that nobody judges: what is moved by hand, hangs in a rope, or is near a surface of triangles."""
        motion, world = self._motion, self._evidence.world
        out = np.tile(motion.kinematic, (len(motion.h), 1))
        roped = {guide.body for rope in world.ropes for guide in rope.path}
        rows = [i for i, body in enumerate(world.bodies) if body.prim in roped or _hollow(body.shapes)]
        out[:, rows] = True
        reach = motion.radius + motion.reach
        for static in world.statics:
            for shape in (shape for shape in static.shapes if shape.collides and shape.exact):
                points = rotate(np.array(shape.rotation), np.array(shape.vertices)) + np.array(shape.position)
                low, high = points.min(axis=0), points.max(axis=0)
                apart = np.maximum(np.maximum(low - motion.com, motion.com - high), 0.0)
                apart = np.linalg.norm(apart, axis=2)
                out |= np.minimum(apart[1:], apart[:-1]) < reach
        return np.asarray(out)

    def _interval(self, k: int, change: Floats, blow: Floats, judged: Bools) -> tuple[Floats, Floats]:
        """What is left of a change (B, 6) over one interval, and how much ties passed on, (B, 2)."""
        hit = judged & (blow > SOFT * max(self._pull, 1.0) * float(self._motion.h[k]))
        rest, passed = self._explained(k, change, judged, hit, hit)
        odd = np.linalg.norm(rest, axis=1) > AGAIN * max(self._pull, 1.0)
        if not (odd & ~hit).any():
            return rest, passed
        return self._explained(k, change, judged, hit, hit | odd)  # they may have touched between the frames alone

    def _explained(self, k: int, change: Floats, judged: Bools, hit: Bools, between: Bools) -> tuple[Floats, Floats]:
        """The same, with contacts looked for `between` the frames too for some bodies, of which some are `hit`."""
        columns = [*self._pushes(k, hit, between), *self._ties.columns(k)]
        rest, passed = np.where(judged[:, None], change, 0.0), np.zeros((len(change), 2))
        if not columns:
            return rest, passed
        all_ = Columns.of(columns)
        for bodies, chosen in _groups(all_, judged):
            number = np.full(len(judged) + 1, -1)  # the last is the world's
            number[bodies] = np.arange(len(bodies))
            columns6 = np.zeros((len(chosen), len(bodies), 6))
            for which, on in ((all_.one, all_.on_one), (all_.two, all_.on_two)):
                n = number[which[chosen]]
                ours = np.flatnonzero(n >= 0)
                columns6[ours, n[ours]] += on[chosen[ours]]
            scale = np.repeat(1.0 / self._motion.mass[bodies], 6).reshape(-1, 6)
            scale[:, 3:] /= self.size[bodies][:, None]
            matrix = (columns6 * scale).reshape(len(chosen), -1).T
            wanted = rest[bodies].ravel()
            strength = _least(matrix, wanted, all_.both[chosen])
            rest[bodies] = (wanted - matrix @ strength).reshape(-1, 6)
            ties = all_.both[chosen]
            each = (np.abs(matrix[:, ties]) @ np.abs(strength[ties])).reshape(-1, 6) / scale
            most = np.array([each[:, :3].max(), each[:, 3:].max()])  # an error of one body's arm ends at any other
            passed[bodies] = most * scale[:, [0, 3]]
        return rest, passed

    # ---- contacts
    def _pushes(self, k: int, hit: Bools, between: Bools) -> list[Columns]:
        h = float(self._motion.h[k])
        ends = self._poses(k), self._poses(k + 1)
        fastest = float(np.max(self._motion.reach[k], initial=0.0))
        shares = np.linspace(0.0, 1.0, PARTS + 1) if between.any() else np.array([0.0])
        found = []
        for side, end in enumerate(ends):
            for share in shares:
                moved = self._moved(end, (share if side == 0 else -share) * h)
                contacts = self._touching.at(moved.q, NEAR + min(fastest, FAST))
                contacts = contacts.only(self._within_reach(contacts, moved, h, share, between))
                if len(contacts):
                    found.append((contacts, moved, side))
        if not found:
            return []
        lasting = self._lasting(found, ends, hit, h)
        columns = []
        for (contacts, moved, _), along in zip(found, lasting, strict=True):
            friction, rolling = self._touching.laws(contacts.shapes)
            columns.append(pushes(contacts, moved, friction, along, self._rolling(contacts, rolling, friction)))
        return columns

    def _within_reach(self, contacts: Contacts, poses: Poses, h: float, share: float, between: Bools) -> Bools:
        """Contacts whose gap may close within the part of the interval that a pose stands for."""
        speed = np.linalg.norm(slip(self._touching, contacts, poses), axis=1)
        part = h / PARTS if share > 0.0 else h
        close = contacts.gap <= NEAR + (speed + max(self._pull, 1.0) * h) * part
        rows = np.stack([contacts.one, contacts.two])
        asked = (between[np.maximum(rows, 0)] & (rows >= 0)).any(axis=0)
        return np.asarray(close & (asked | (share == 0.0)))

    def _lasting(
        self, found: list[tuple[Contacts, Poses, int]], ends: tuple[Poses, Poses], hit: Bools, h: float
    ) -> list[Floats]:
        """The unit way of each contact's slip where its pair slips one way from one frame to the next, else 0."""
        flat = []
        for contacts, _, end in found:
            u = slip(self._touching, contacts, ends[end])
            flat.append(u - np.einsum("ni,ni->n", u, contacts.normal)[:, None] * contacts.normal)
        every, own = together([contacts for contacts, _, _ in found]), np.concatenate(flat)
        side = np.repeat([end for _, _, end in found], [len(contacts) for contacts, _, _ in found])
        pair, which = np.unique(np.stack([every.one, every.two], axis=1), axis=0, return_inverse=True)
        which = which.ravel()
        mean, count = np.zeros((2, len(pair), 3)), np.zeros((2, len(pair)))
        np.add.at(mean, (side, which), own)
        np.add.at(count, (side, which), 1.0)
        then = (mean / np.maximum(count, 1.0)[..., None])[1 - side, which]
        speed, speed_then = np.linalg.norm(own, axis=1), np.linalg.norm(then, axis=1)
        friction, _ = self._touching.laws(every.shapes)
        slow = 3.0 * friction * max(self._pull, 1.0) * h + STILL
        lasts = (np.minimum(speed, speed_then) > slow) & (np.sum(own * then, axis=1) > ONE_WAY * speed * speed_then)
        rows = np.stack([every.one, every.two])
        lasts &= ~(hit[np.maximum(rows, 0)] & (rows >= 0)).any(axis=0)
        along = np.where(lasts[:, None], own / np.maximum(speed, 1e-300)[:, None], 0.0)
        return np.split(along, np.cumsum([len(contacts) for contacts, _, _ in found])[:-1])

    def _rolling(self, contacts: Contacts, rolling: Floats, friction: Floats) -> Floats:
        """The torque that resists turning, for a push of one [m]: rolling's, or spinning's, which is the greater."""
        rows = np.where(contacts.two >= 0, contacts.two, contacts.one)
        found: Floats = np.maximum(rolling, np.pi * friction * rolling) * self.size[rows]
        return found

    # ---- poses
    def _poses(self, frame: int) -> Poses:
        motion = self._motion
        return Poses(self._evidence.body_q[frame], motion.com[frame], motion.v[frame], motion.w[frame])

    def _moved(self, poses: Poses, dt: float) -> Poses:
        """Where bodies are `dt` [s] on, by their velocities and gravity."""
        if dt == 0.0:
            return poses
        angle = poses.w * dt
        size = np.linalg.norm(angle, axis=1, keepdims=True)
        turn = np.concatenate([angle / np.maximum(size, 1e-12) * np.sin(0.5 * size), np.cos(0.5 * size)], axis=1)
        rotation = multiply(turn, poses.q[:, 3:])
        arm = poses.q[:, :3] - poses.com
        com = poses.com + poses.v * dt
        return Poses(np.concatenate([com + rotate(turn, arm), rotation], axis=1), com, poses.v, poses.w)


def _least(matrix: Floats, wanted: Floats, both: Bools) -> Floats:
    """Strengths that leave least of what is wanted; those that do not act both ways are not negative."""
    length = np.maximum(np.linalg.norm(matrix, axis=0), 1e-300)
    matrix = matrix / length
    free, pushing = matrix[:, both], matrix[:, ~both]
    strength = np.zeros(len(both))
    if pushing.shape[1]:
        # What acts both ways takes all within its span: the others are asked for what is outside.
        basis, size, _ = np.linalg.svd(free, full_matrices=False) if free.shape[1] else (free, np.zeros(0), None)
        span = basis[:, : int((size > 1e-9 * size.max(initial=0.0)).sum())]
        outside = pushing - span @ (span.T @ pushing)
        strength[~both] = nnls(outside, wanted - span @ (span.T @ wanted), maxiter=100 * len(both))[0]
    if free.shape[1]:
        strength[both] = np.linalg.lstsq(free, wanted - pushing @ strength[~both], rcond=1e-9)[0]
    found: Floats = strength / length
    return found


def rounding(evidence: Evidence) -> Floats:
    """What single precision leaves of an acceleration, (T - 1, B) [m/s^2]."""
    motion = evidence.motion
    speed = motion.speed + np.linalg.norm(motion.w, axis=2) * motion.radius
    found: Floats = 8.0 * FLOAT32 * np.maximum(speed[1:], speed[:-1]) / motion.h[:, None]
    return found


def _hollow(shapes: list) -> bool:
    """Whether a body has a mesh: what collides of it need not be its hull."""
    return any(shape.kind == "mesh" and shape.collides for shape in shapes)


def _groups(columns: Columns, judged: Bools) -> list[tuple[NDArray[np.intp], NDArray[np.intp]]]:
    """Bodies that pass impulses to each other, and their columns; what is not judged passes nothing on."""
    count = len(judged)
    label = np.arange(count)
    inner = (columns.one >= 0) & (columns.two >= 0)
    inner[inner] &= judged[columns.one[inner]] & judged[columns.two[inner]]
    for a, b in {(int(a), int(b)) for a, b in zip(columns.one[inner], columns.two[inner], strict=True)}:
        if label[a] != label[b]:
            label[label == label[b]] = label[a]
    owner = np.full(len(columns.one), -1)
    for which in (columns.one, columns.two):
        own = (which >= 0) & judged[np.maximum(which, 0)]
        owner[own] = label[which[own]]
    return [(np.flatnonzero((label == group) & judged), np.flatnonzero(owner == group))
            for group in np.unique(owner[owner >= 0])]  # fmt: skip
