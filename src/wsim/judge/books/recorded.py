"""The books of what a recording says that contacts gave: they balance by themselves, and are such as contacts can give.

Where poses alone are known, contacts are unknowns and anything admissible may have acted (`wsim.judge.books.balance`).
Where the impulse of each pair is recorded there is nothing left to choose: what a body gained is gravity's, the
fluid's, control's and theirs, to the rounding of the solver.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import conjugate, rotate
from wsim.judge.books.laws import Laws
from wsim.judge.books.recorded_ties import RecordedTies
from wsim.judge.books.sampled import sampled
from wsim.judge.books.sharing import UPRIGHT, bend, lever, share
from wsim.judge.evidence.motion import FLOAT32
from wsim.judge.evidence.scheduled import belt, fastest, friction
from wsim.recording.contacts import shapes_of
from wsim.scene.contact import pair_law

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.evidence.motion import Motion
    from wsim.recording.contacts import ContactTrack

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]
    Rows = NDArray[np.intp]

SOLVED = 0.005  # of what moved a body: what a solver in double precision leaves of it


@dataclass(frozen=True)
class Balanced:
    """What contacts leave unexplained, for T - 1 intervals and B bodies."""

    force: Floats  # (T - 1, B, 3) over the mass [m/s^2]
    torque: Floats  # (T - 1, B, 3) over m R [m/s^2]
    moved: Floats  # (T - 1, B) what contacts and ties gave, over the mass, and the rounding of velocities [m/s^2]
    stepped: Floats  # (T - 1, B) what steps leave: one of first order, of what turns about another place [m/s^2]
    lagging: Floats  # (T - 1, B) what they leave of angular momentum, where ties turn with bodies [m/s^2]
    judged: Bools  # (B,)
    turned: Bools  # (B,) whether its torques are known, too


class RecordedContacts:
    """What pairs of shapes gave each other, as the recording has it."""

    def __init__(self, evidence: Evidence, track: ContactTrack) -> None:
        self._evidence, self.track = evidence, track
        ties = evidence.recording.ties
        self.ties = RecordedTies(evidence, ties) if ties is not None else None
        self.world, self.shapes = evidence.world, shapes_of(evidence.world)
        bodies = [i for i, body in enumerate(evidence.world.bodies) for _ in body.shapes]
        self._owner = np.array(bodies + [-1] * (len(self.shapes) - len(bodies)), dtype=np.intp)

    @property
    def motion(self) -> Motion:
        """Of the bodies."""
        return self._evidence.motion

    @cached_property
    def body(self) -> Rows:
        """The bodies of each row, (n, 2); -1 is the world."""
        return self._owner[self.track.pair]

    @cached_property
    def given(self) -> tuple[Floats, Floats]:
        """Impulse and angular impulse on each body since the frame before, (T, B, 3) each."""
        found = np.zeros((2, len(self._evidence.time), len(self._evidence.world.bodies), 3))
        for side, sign in ((0, -1.0), (1, 1.0)):
            moves = self.body[:, side] >= 0
            at = self.track.frame[moves], self.body[moves, side]
            np.add.at(found[0], at, sign * self.track.impulse[moves].astype(np.float64))
            np.add.at(found[1], at, self.track.turn[moves, side].astype(np.float64))
        return found[0], found[1]

    def balanced(self) -> Balanced:
        """The books of loose bodies, and where it is recorded what ties give, of those on joints, springs and ropes."""
        motion, recording = self._evidence.motion, self._evidence.recording
        push, turn = (array[1:] for array in self.given)
        moved, stepped = np.linalg.norm(push, axis=2), self._stepped()
        if self.ties is not None:
            push, turn = push + self.ties.given[0][1:], turn + self.ties.given[1][1:]
            moved = moved + self.ties.passed[1:]
        h, size = motion.h[:, None, None], np.maximum(motion.radius, 1e-9)
        force = motion.acceleration - motion.gravity - push / motion.mass[:, None] / h
        torque = (motion.torque - turn / h) / (motion.mass * size)[:, None]
        applied = np.zeros(push.shape[:2])
        if recording.applied_impulse is not None:
            applied = np.linalg.norm(np.asarray(recording.applied_impulse[1:], dtype=np.float64), axis=2)
        speed = motion.speed + np.linalg.norm(motion.w, axis=2) * motion.radius
        rounding = 8.0 * FLOAT32 * np.maximum(speed[1:], speed[:-1])
        moved = (moved + applied) / motion.mass / motion.h[:, None]
        loose = ~motion.kinematic & (~motion.jointed | (self.ties is not None))
        lagging, missed = np.zeros_like(stepped), np.zeros((*stepped.shape, 2))
        if self.ties is not None:
            lagging = self.ties.stepped(moved + self._evidence.gravity)
            missed = sampled(self._evidence, self.ties.laws)
        pushed = recording.applied_impulse is not None or bool(recording.metadata.get("controlled"))
        known = loose & (recording.applied_turn is not None or not pushed)
        of_steps = stepped + lagging + missed[..., 0], lagging + missed[..., 1]
        return Balanced(force, torque, moved + rounding / motion.h[:, None], *of_steps, loose, known)

    def _stepped(self) -> Floats:
        """The solver steps the velocity of a body's origin; that of its centre of mass at l is off, as of a joint's.

        By l dt (2 w w' + w^3 dt / 2) a step (`wsim.judge.books.steps`).
        """
        motion = self._evidence.motion
        length = np.array([float(np.linalg.norm(body.com)) for body in self._evidence.world.bodies])
        rate, change = np.linalg.norm(motion.w, axis=2), np.linalg.norm(np.diff(motion.w, axis=0), axis=2)
        fastest, dt = np.maximum(rate[1:], rate[:-1]), np.minimum(motion.dt, motion.h)[:, None]
        found: Floats = length * dt * (2.0 * fastest * change / motion.h[:, None] + 0.5 * fastest**3)
        return found

    @property
    def friction(self) -> Floats:
        """The coefficient of each row's pair, (n,)."""
        return self._law[0]

    @property
    def spread(self) -> Floats:
        """How far the coefficient is from that within the interval, (n,): presses weigh a schedule's as they come."""
        return self._law[2]

    @cached_property
    def _law(self) -> Floats:
        """Friction, rolling resistance and what friction is off its mean, of each row's pair, (3, n)."""
        world = self._evidence.world
        pairs, which = np.unique(self.track.pair, axis=0, return_inverse=True)
        laws = [pair_law(world, self.shapes[a], self.shapes[b]) for a, b in pairs.tolist()]
        each = np.array([(law.friction, law.rolling, 0.0) for law in laws], dtype=np.float64).reshape(-1, 3)
        found = each[which.ravel()].T
        for k, (a, b) in enumerate(pairs.tolist() if world.schedules else ()):
            by_time = friction(self._evidence, self.shapes[a], self.shapes[b], laws[k].friction)
            rows = np.flatnonzero(which.ravel() == k)
            if by_time is not None and len(rows):
                interval = np.maximum(self.track.frame[rows] - 1, 0)
                found[0, rows], found[2, rows] = by_time.means[interval, 0], by_time.spread[interval, 0]
        return np.asarray(found)

    def rubs(self, normal: Floats, speed: Floats) -> Floats:
        """The least and the most that friction is of each row's push, as its slip and its turning share it, (2, n).

        Args:
            normal: Of each row, (n, 3).
            speed: Of its slip at both ends, (n, 2) [m/s], known to within `rolled`.
        """
        friction, rolling, _ = self._law
        if not rolling.any():
            return np.stack([friction, friction])
        found = [self._shares(normal, speed[:, end], end, rolling) for end in (0, 1)]
        each = np.concatenate(found)
        return np.asarray(friction * np.stack([each.min(axis=0), each.max(axis=0)]))

    def _shares(self, normal: Floats, speed: Floats, end: int, rolling: Floats) -> Floats:
        """The shares of friction at one end of the interval, by the least and the most that the slip may be, (2, n)."""
        motion, frame = self._evidence.motion, np.maximum(self.track.frame - 1 + end, 0)
        turning, bends = np.zeros_like(normal), np.zeros(len(normal))
        for side, sign in ((0, -1.0), (1, 1.0)):
            moves, rows = self.body[:, side] >= 0, np.maximum(self.body[:, side], 0)
            turning += sign * np.where(moves[:, None], motion.w[frame, rows], 0.0)
            turn = np.where(moves[:, None], self._evidence.body_q[frame, rows, 3:], UPRIGHT)
            for k in np.unique(self.track.pair[:, side]):
                ours = np.flatnonzero(self.track.pair[:, side] == k)
                bends[ours] += bend(self.shapes[k], turn[ours], normal[ours], moves=bool(self._owner[k] >= 0))
        levers, off = lever(rolling, bends), self.rolled
        slips = np.maximum(speed - off, 0.0), speed + off
        return np.stack([share(self.friction, levers, slip, turning, normal) for slip in slips])

    @cached_property
    def rubbed(self) -> Floats:
        """The part of each row's impulse that is along the surfaces, (n,) [N s]."""
        return np.linalg.norm(self.track.impulse.astype(np.float64) - self.track.along, axis=1)

    @cached_property
    def loose(self) -> Bools:
        """Rows of which neither body hangs on a joint or a spring, (n,): links of a chain chatter between frames."""
        held = np.append(self._evidence.motion.jointed, False)
        return np.asarray(~held[self.body].any(axis=1))

    @cached_property
    def lasting(self) -> Bools:
        """Rows of pairs that press in the intervals before and after, too, (n,): no blow, which has another place."""
        pair = self.track.pair.astype(np.int64)
        key = self.track.frame * np.int64(len(self.shapes)) ** 2 + pair[:, 0] * len(self.shapes) + pair[:, 1]
        step = np.int64(len(self.shapes)) ** 2
        return np.asarray(np.isin(key - step, key) & np.isin(key + step, key))

    def landed(self, landed: Floats) -> Floats:
        """By how much the slip of each row may change, and back, as points land in its interval, (n,) [m/s].

        Args:
            landed: By how much each body's velocity may, (T - 1, B) [m/s].
        """
        interval, changes = np.maximum(self.track.frame - 1, 0), np.zeros(len(self.track.frame))
        for side in (0, 1):
            rows = self.body[:, side]
            changes += np.where(rows >= 0, landed[interval, np.maximum(rows, 0)], 0.0)
        return changes

    def knocked(self, rows: Rows, normal: Floats, change: Floats) -> Floats:
        """How far blows may take the slips of some rows beyond those of both ends, and back, (rows,) [m/s].

        What goes to and fro between others that it bounces off is struck several times between two frames; and what is
        hit by something else may lose its slip to the blow's friction, and be given it again. By what all of that
        changes its slip, less what the ends differ by, it goes there and back.

        Args:
            rows: Which.
            normal: Of every row, (n, 3).
            change: Of the slips of some rows, from end to end, (rows,) [m/s].
        """
        found, frame, hits = np.zeros(len(rows)), self.track.frame, self._bounce | ~self.lasting
        for at in np.flatnonzero(np.isin(frame[rows], frame[hits])):
            row = rows[at]
            for body in self.body[row][self.body[row] >= 0]:
                others = (frame == frame[row]) & (self.body == body).any(axis=1) & hits
                others[row] = False
                given = self.track.impulse[others].astype(np.float64)
                across = given - (given @ normal[row])[:, None] * normal[row]
                found[at] += float(np.linalg.norm(across, axis=1).sum()) / self._evidence.motion.mass[body]
        return np.asarray(0.5 * np.maximum(found - change, 0.0))

    @cached_property
    def _bounce(self) -> Bools:
        """Whether each row's pair bounces, (n,)."""
        world, pairs = self._evidence.world, self.track.pair
        each, which = np.unique(pairs, axis=0, return_inverse=True)
        found = [pair_law(world, self.shapes[a], self.shapes[b]).restitution > 0.0 for a, b in each.tolist()]
        return np.array(found, dtype=bool)[which.ravel()]

    @cached_property
    def slip(self) -> Floats:
        """Velocity of the second shape over the first at the place of each row, at both ends, (n, 2, 3) [m/s]."""
        found: Floats = self.speed(1) - self.speed(0)
        for side, sign in ((0, -1.0), (1, 1.0)):
            for k in np.unique(self.track.pair[:, side]):
                if any(fastest(self._evidence.world, self.shapes[k])):
                    ours = np.flatnonzero(self.track.pair[:, side] == k)
                    after = np.maximum(self.track.frame[ours], 1)
                    found[ours] += sign * self.belt(k)[np.stack([after - 1, after], axis=1)]
        return found

    def speed(self, side: int) -> Floats:
        """Velocity of the bodies of one side at the place of each row, at both ends, (n, 2, 3) [m/s].

        The place is that of the middle of the interval, relative to where the bodies are halfway; of a ball it is
        below its centre along the push, wherever in the interval it was hit: what spins may go several radii in one.
        """
        motion, point, frame = self._evidence.motion, self.track.point.astype(np.float64), self.track.frame
        found, rows = np.zeros((len(frame), 2, 3)), np.maximum(self.body[:, side], 0)
        if not len(motion.mass):
            return found
        moves, before = (self.body[:, side] >= 0)[:, None], np.maximum(frame - 1, 0)
        arm = point - 0.5 * (motion.com[before, rows] + motion.com[frame, rows])
        balls = np.array([self._ball_radius(k) for k in range(len(self.shapes))])[self.track.pair[:, side]]
        pressed = np.linalg.norm(self.track.along.astype(np.float64), axis=1)
        hit = (balls > 0.0) & (pressed > 0.0)
        normal = self.track.along[hit] / pressed[hit, None]
        arm[hit] = (1.0 - 2.0 * side) * balls[hit, None] * normal
        for end in (0, 1):
            at = np.maximum(frame - 1 + end, 0)
            found[:, end] = np.where(moves, motion.v[at, rows] + np.cross(motion.w[at, rows], arm), 0.0)
        return found

    def _ball_radius(self, k: int) -> float:
        """Of a shape that is a sphere about its body's centre of mass [m]; 0 of others."""
        shape, owner = self.shapes[k], int(self._owner[k])
        if shape.kind != "sphere" or owner < 0:
            return 0.0
        off = np.linalg.norm(np.array(shape.position) - np.array(self.world.bodies[owner].com))
        return float(shape.size[0]) if off <= FLOAT32 * shape.size[0] else 0.0

    def swing(self, normal: Floats, speed: Floats) -> Floats:
        """How far the slips of a pair's points may turn from their mean's way, (n,) [rad].

        Args:
            normal: Of each row, (n, 3).
            speed: Of its slip, (n,) [m/s].
        """
        motion, fastest = self._evidence.motion, np.zeros(len(speed))
        size = np.append(motion.radius, np.inf)[self.body].min(axis=1)  # the smaller body's: where both can touch
        for end in (0, 1):
            frame = np.maximum(self.track.frame - 1 + end, 0)
            spin = [
                np.where((self.body[:, side] >= 0)[:, None], motion.w[frame, np.maximum(self.body[:, side], 0)], 0.0)
                for side in (0, 1)
            ]
            fastest = np.maximum(fastest, np.abs(np.einsum("ni,ni->n", spin[1] - spin[0], normal)))
        found: Floats = fastest * size / np.maximum(speed, 1e-12)
        return found

    @cached_property
    def rolled(self) -> Floats:
        """By how much the slip of what turns may be off, as its arms turn within the interval, (n,) [m/s]."""
        motion, found = self._evidence.motion, np.zeros(len(self.track.frame))
        interval = np.maximum(self.track.frame - 1, 0)
        for side in (0, 1):
            rows = np.maximum(self.body[:, side], 0)
            rate = np.linalg.norm(
                np.maximum(np.abs(motion.w[interval, rows]), np.abs(motion.w[interval + 1, rows])), axis=1
            )
            off = rate * motion.radius[rows] * np.minimum(rate * motion.h[interval], 1.0)
            found += np.where(self.body[:, side] >= 0, off, 0.0)
        return found

    def belt(self, k: int) -> Floats:
        """How the surface of shape k runs by itself, (T, 3) [m/s]."""
        own, body = belt(self._evidence, self.shapes[k]), self._owner[k]
        return own if body < 0 or not own.any() else rotate(self._evidence.body_q[:, body, 3:], own)

    def gap(self, share: float) -> tuple[Floats, Floats]:
        """How far each row's place is from the surfaces that it is said to be of, and may be, (n,) each [m].

        It is taken at the nearer end of the interval, of the surface for which it is the more by what it may be: how
        far points of its body may go in the interval, and those of both bodies in a step, as contacts are found
        before surfaces meet; and a share of the smallest extent of the bodies.
        """
        track, motion = self.track, self._evidence.motion
        worst, most = np.zeros(len(track.frame)), np.ones(len(track.frame))
        farthest = np.full(len(track.frame), -1.0)  # of what it may be
        placed = {(shape.body, shape.shape.prim): shape for shape in self._evidence.placed}
        point, interval = track.point.astype(np.float64), np.maximum(track.frame - 1, 0)
        small = np.array([self._evidence.solid(i).smallest for i in range(len(motion.mass))] + [np.inf])
        reach = np.column_stack([motion.reach, np.zeros(len(motion.h))])
        of_step = (reach[interval[:, None], self.body] * (motion.dt / motion.h[interval])[:, None]).sum(axis=1)
        slop = share * small[self.body].min(axis=1) + of_step
        for side in (0, 1):
            for k in np.unique(track.pair[:, side]):
                rows = np.flatnonzero(track.pair[:, side] == k)
                shape = placed.get((int(self._owner[k]), self.shapes[k].prim))
                if shape is None or shape.shape.kind == "mesh":
                    continue
                off = np.full(len(rows), np.inf)
                for end in (0, 1):
                    frame = interval[rows] + end
                    at = rotate(conjugate(shape.rotation[frame]), point[rows] - shape.position[frame])
                    off = np.minimum(off, np.abs(shape.kind.depth(at)))
                limit = slop[rows] + reach[interval[rows], shape.body]
                ratio = off / limit
                worse = ~(ratio <= farthest[rows]) & ~np.isnan(farthest[rows])  # what is no number is worst of all
                taken = rows[worse]
                worst[taken], most[taken], farthest[taken] = off[worse], limit[worse], ratio[worse]
        return worst, most


def plain(evidence: Evidence) -> Bools:
    """Bodies of mechanisms of joints, ropes and springs, without a law that a record could break unseen, (T - 1, B).

    A spring's law frames must tell, which what is recorded of it is held to (`wsim.judge.checks.recorded_ties`).
    """
    world, motion = evidence.world, evidence.motion
    bound = []
    for joint in world.joints:
        stops = joint.low is not None or joint.high is not None
        if joint.drive or joint.friction or joint.moves or stops or world.gears:
            bound.append(joint.child)
    units = motion.unit[[i for i, body in enumerate(world.bodies) if body.prim in bound]]
    found = np.tile(motion.jointed & ~np.isin(motion.unit, units), (len(motion.h), 1))
    row = {body.prim: i for i, body in enumerate(world.bodies)}
    for spring, law in zip(world.springs, Laws(evidence).springs if world.springs else (), strict=True):
        held = [row[guide.body] for guide in spring.path if guide.body in row]
        found[:, np.isin(motion.unit, motion.unit[held])] &= law.known[:, None]
    return found


def told_by_record(copies: Sequence[Evidence], size: Floats, ks: Rows, judged: Bools) -> list[tuple[Floats, Floats]]:
    """What recorded impulses leave of some intervals, (K, B, 6), and may, (K, B, 2) [m/s^2]; none of several copies.

    How links whip after a blow frames do not tell, and what they pass on then has the arms of each instant. Whether
    contacts and ties can give what is recorded is asked by itself (`wsim.judge.checks.recorded`, `.recorded_ties`).

    Args:
        copies: One, if there is to be a record.
        size: That torques are counted by, (B,) [m].
        ks: The intervals, (K,).
        judged: Bodies of these, (K, B).
    """
    recording = copies[0].recording
    if len(copies) > 1 or recording.contacts is None or recording.ties is None:
        return []
    books = RecordedContacts(copies[0], recording.contacts).balanced()
    torque = books.torque * (np.maximum(copies[0].motion.radius, 1e-9) / size)[:, None]
    left = np.concatenate([books.force, torque], axis=2)[ks]
    may = SOLVED * books.moved[..., None] + np.stack([books.stepped, books.lagging], axis=2)
    return [(np.where(judged[..., None], left, 0.0), may[ks])]


def met(evidence: Evidence) -> Bools:
    """Whether a contact is recorded of a body with one of another mechanism in each interval, (T - 1, B).

    Frames do not show all who meet: a ball that is thrown on and caught within one interval is slow at both its ends.
    """
    motion, track = evidence.motion, evidence.recording.contacts
    found = np.zeros((len(evidence.time), len(motion.mass)), dtype=bool)
    if track is not None and len(track.frame):
        body = RecordedContacts(evidence, track).body
        other = (body >= 0).all(axis=1) & (motion.unit[body[:, 0]] != motion.unit[body[:, 1]])
        found[track.frame[other][:, None], body[other]] = True
    return found[1:]
