"""For each interval between frames: what change of momentum no admissible impulse explains.

The change of momentum and of angular momentum of each body, less gravity and what fluid and control gave it, must be a
sum of impulses that the world can exert: of contacts where shapes touch or may have met in the interval, pushing only
and inside the cone of the pair's friction, on its edge against a slip that lasts; of joints and springs along what they
hold. What no sum of them gives is the finding.

The copies of a world, or of worlds that differ in sizes and coefficients alone, are worked out at once: their intervals
stand one after another, N = W (T - 1) of them, and their frames, W T. A recording by itself is one copy.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import multiply, rotate
from wsim.judge.books import arms, jolts
from wsim.judge.books.admissible import explain
from wsim.judge.books.differences import followed, unknown
from wsim.judge.books.forces import ONE_WAY, STILL, Columns, Poses, pushes, slip, turns
from wsim.judge.books.landing import keeps_way, landing
from wsim.judge.books.recorded import plain, told_by_record
from wsim.judge.books.repeats import again, fresh
from wsim.judge.books.sharing import of_contacts
from wsim.judge.books.steps import step_error
from wsim.judge.books.struck import Struck
from wsim.judge.books.ties import Ties
from wsim.judge.books.touching import Contacts, together, touching_of
from wsim.judge.evidence.motion import FLOAT32

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]
    Rows = NDArray[np.intp]

NEAR = 2e-3  # [m]: what is nearer than this touches
PARTS = 4  # of an interval with a blow in it: where shapes meet is looked for at each
SOFT = 2.0  # times gravity's pull over the interval: what changes a velocity by less is no blow
ENOUGH = 0.001  # of gravity: a rest that is as good as none
AGAIN = 0.003  # of gravity: where more is left, contacts are looked for between the frames
CHUNK = 4000  # bodies times intervals worked out at once
LOADS = 3.0  # of its weight, that a body in motion may press with
WHIPS = 0.05  # [rad]: what turns farther between frames passes on more than they tell
FAST = 0.3  # [m]: no blow is looked for beyond


@dataclass(frozen=True)
class Books:
    """What is left over, for T - 1 intervals and B bodies, and what was passed on."""

    force: Floats  # (T - 1, B, 3), of momentum over the interval's length and the mass [m/s^2]
    torque: Floats  # (T - 1, B, 3), of angular momentum over m R and the interval's length [m/s^2]
    blow: Floats  # (T - 1, B) change of velocity, of its surface too, that was to be explained [m/s]
    turned: Floats  # (T - 1, B, 2): what may be missing of both, as bodies turn while they are held [m/s^2]
    judged: Bools  # (T - 1, B)
    hit: Bools  # (T - 1, B), whether it is so much that something hit the body
    wanted: Floats  # (T - 1, B, 6), what contacts and ties were asked for, as what is left over
    landed: Floats  # (T - 1, B), by how much landings may change its velocity in between [m/s]
    size: Floats  # (B,) [m], that torques are counted by

    @staticmethod
    def of(evidence: Evidence) -> Books:
        """Of a recording, worked out once for all who ask."""
        if Books not in evidence.kept:
            evidence.kept[Books] = Balance(evidence).books()
        kept = evidence.kept[Books]
        assert isinstance(kept, Books)
        return kept


class Balance:
    """Works the books out, of one recording or of several over the same times, of worlds that are `similar`."""

    def __init__(self, *copies: Evidence) -> None:
        self._copies, self._world = copies, copies[0].world
        self._touching = touching_of(copies)
        self._ties = [Ties(evidence) for evidence in copies]
        self._struck: list[Struck] = []  # of each copy, as soon as it is known what was hit
        motions = [evidence.motion for evidence in copies]
        count = len(motions[0].h)
        self._unit = max(float(np.linalg.norm(motions[0].gravity)), 1.0)  # [m/s^2]
        self._kinematic, self._mechanism = motions[0].kinematic, motions[0].unit  # (B,), of all copies
        self._jointed = motions[0].jointed
        self._mass = np.stack([motion.mass for motion in motions])  # (W, B)
        held = np.stack([ties.arms for ties in self._ties])
        self._sizes = np.maximum(np.maximum(np.stack([motion.radius for motion in motions]), held), 1e-4)  # (W, B)
        # Frames, (W T, B, ...), and intervals, (N, ...)
        self._q = np.concatenate([evidence.body_q for evidence in copies])
        self._com, self._v, self._w = (
            np.concatenate([getattr(motion, name) for motion in motions]) for name in ("com", "v", "w")
        )
        self._h, self._reach = (
            np.concatenate([getattr(motion, name) for motion in motions]) for name in ("h", "reach")
        )
        self._angles = [arms.turned(evidence, size) for evidence, size in zip(copies, self._sizes, strict=True)]
        self._pressed = np.concatenate([jolts.struck(evidence, ()) for evidence in copies]) & self._jointed  # (N, B)
        self._whips = np.concatenate([plain(evidence) for evidence in copies]) & (np.concatenate(self._angles) > WHIPS)
        # The share that is wrong of what an arm taken halfway gives.
        self._bent = np.concatenate(
            [angle**2 / 12.0 + arms.early(*of) for *of, angle in zip(copies, self._angles, self._angles, strict=True)]
        )
        self._copy = np.repeat(np.arange(len(copies)), count)
        self._first = np.arange(len(self._copy)) + self._copy  # frame of each interval: one more in each copy

    def books(self) -> Books:
        """Of a recording by itself."""
        return self.every()[0]

    def every(self) -> list[Books]:
        """All intervals of each copy."""
        h, mass = self._h[:, None], self._mass[self._copy]
        gravity = self._copies[0].motion.gravity
        force = np.concatenate([evidence.motion.acceleration for evidence in self._copies]) - gravity
        arm = mass * self._sizes[self._copy]
        torque = np.concatenate([evidence.motion.torque for evidence in self._copies]) / arm[..., None]
        blow = (np.linalg.norm(force, axis=2) + np.linalg.norm(torque, axis=2)) * h
        judged = np.concatenate([followed(evidence) for evidence in self._copies]) & ~self._kinematic
        laws = [ties.laws.given() for ties in self._ties]
        given, wrong = (np.concatenate([law[n] for law in laws]) for n in range(2))
        both = np.concatenate([force, torque], axis=2) - given * self._scale(np.arange(len(h)))
        wanted = np.where(judged[..., None], both, 0.0)
        hit = judged & (blow > SOFT * self._unit * h)
        self._struck = [Struck(*each) for each in zip(self._copies, np.split(hit, len(laws)), strict=True)]
        self._landed = np.zeros(hit.shape)
        left, turned = self._worked_out(wanted, judged, hit)
        pulled = np.concatenate([ties.ropes.error() for ties in self._ties])
        stepped = np.concatenate([step_error(evidence) for evidence in self._copies])
        turned += (wrong + pulled) / np.stack([mass, arm], axis=2) + stepped[..., None]
        turned += self._changing(wanted, hit)[..., None]
        changes = np.split(both, len(self._copies))
        turned += np.concatenate([unknown(*each) for each in zip(self._copies, changes, strict=True)])
        found = left[..., :3], left[..., 3:], blow, turned, judged, hit, wanted, self._landed
        count = len(self._copies)
        parts = zip(*(np.split(array, count) for array in found), self._sizes, strict=True)
        return [Books(*part) for part in parts]

    def _changing(self, wanted: Floats, hit: Bools) -> Floats:
        """What arms that turn miss of forces that change, of what hangs on ties, (N, B) [m/s^2]."""
        struck = np.concatenate(
            [jolts.struck(*each) for each in zip(self._copies, (ties.jerks for ties in self._ties), strict=True)]
        )
        asked, blows = (np.split(each, len(self._copies)) for each in (wanted, hit & struck))
        parts = zip(asked, self._angles, self._mass, blows, strict=True)
        return np.concatenate([arms.changing(*part, self._mechanism) for part in parts])

    def _scale(self, ks: Rows) -> Floats:
        """What a force and a torque on each body count for in some intervals, (K, B, 6)."""
        scale = np.repeat(1.0 / self._mass[..., None], 6, axis=2)
        scale[..., 3:] /= self._sizes[..., None]
        return np.asarray(scale[self._copy[ks]])

    def _worked_out(self, wanted: Floats, judged: Bools, hit: Bools) -> tuple[Floats, Floats]:
        """What is left of all changes (N, B, 6), and what may be missing as bodies turn, (N, B, 2)."""
        left, turned = wanted.copy(), np.zeros((*hit.shape, 2))
        anew = fresh(self._copies, wanted, hit, self._sizes, self._unit)
        for ks in _parts(np.flatnonzero(anew.any(axis=1)), hit.shape[1]):
            asked = judged[ks] & anew[ks]
            left[ks], turned[ks] = self._explained(ks, wanted[ks], asked, hit[ks], hit[ks] & anew[ks])
            much = (np.linalg.norm(left[ks], axis=2) > AGAIN * self._unit) & asked
            between = (hit[ks] | much) & anew[ks]
            strange = (much & ~hit[ks]).any(axis=1)
            if strange.any():  # they may have touched between the frames alone
                some = ks[strange], wanted[ks[strange]], asked[strange], hit[ks[strange]], between[strange]
                left[some[0]], turned[some[0]] = self._explained(*some)
            struck = much.any(axis=1) & (hit[ks] & self._jointed).any(axis=1)
            if struck.any():  # and ties may have passed on all that they did as their arms were at one instant
                some = ks[struck], wanted[ks[struck]], asked[struck], hit[ks[struck]], between[struck]
                for course in (0, 1):
                    self._where_less(some[0], self._explained(*some, course=course), left, turned)
            whips = much.any(axis=1) & (self._whips[ks] | self._pressed[ks] & hit[ks]).any(axis=1)
            if whips.any():
                for told in told_by_record(self._copies, self._sizes[0], ks[whips], asked[whips]):
                    self._where_less(ks[whips], told, left, turned)
        self._landed = again(anew, self._landed)
        return again(anew, left, wanted), again(anew, turned)

    @staticmethod
    def _where_less(ks: Rows, tried: tuple[Floats, Floats], left: Floats, turned: Floats) -> None:
        """Take what is left of some intervals by another explanation, and may be missing, where that is less."""
        less = np.sum(tried[0] ** 2, axis=(1, 2)) < np.sum(left[ks] ** 2, axis=(1, 2))
        left[ks[less]], turned[ks[less]] = tried[0][less], tried[1][less]

    def _explained(
        self, ks: Rows, change: Floats, judged: Bools, hit: Bools, between: Bools, *, course: int | None = None
    ) -> tuple[Floats, Floats]:
        """What is left of the changes (K, B, 6) of some intervals, and what may be missing of it, (K, B, 2).

        Contacts are looked for `between` the frames, too, of some bodies, of which some are `hit`, (K, B). A body in an
        interval is one of K B, so that all intervals are worked out at once. Of what is hit ties have the arms halfway,
        or those of the blow by the `course` to it (0) or from it (1).
        """
        count, bodies = judged.shape
        rest = np.where(judged[..., None], change, 0.0).reshape(-1, 6)
        missing = np.zeros((len(rest), 2))
        columns = self._pushes(ks, judged, hit, between)
        for n, k in enumerate(ks) if self._ties[0].any else ():
            copy = int(self._copy[k])
            frame = int(self._first[k]) - copy * len(self._copies[0].time)
            ties = self._ties[copy].columns(frame, self._struck[copy].ends(frame, course))
            columns += [each.shifted(n * bodies) for each in ties]
        if columns:
            turned = np.flatnonzero(np.stack([unseen(evidence) for evidence in self._copies])[self._copy[ks]])
            all_ = Columns.of([*columns, turns(turned)] if len(turned) else columns)
            scale, enough, bent = self._scale(ks).reshape(-1, 6), ENOUGH * self._unit, self._bent[ks].ravel()
            rest, missing = explain(all_, judged.ravel(), rest, scale, enough, bent)
        return rest.reshape(count, bodies, 6), missing.reshape(count, bodies, 2)

    # ---- contacts
    def _pushes(self, ks: Rows, asked: Bools, hit: Bools, between: Bools) -> list[Columns]:
        h, frames = self._h[ks], self._first[ks]
        ends = self._poses(frames), self._poses(frames + 1)
        some = np.flatnonzero(between.any(axis=1))
        far = np.minimum(self._reach[ks].max(axis=1, initial=0.0), FAST)
        reach = NEAR + np.where(between.any(axis=1), far, 2.0 * self._unit * h**2)
        found = []
        for side, contacts in enumerate(self._at_frames(frames, reach)):
            contacts = contacts.only(_any(asked, contacts))
            contacts = contacts.only(self._within_reach(contacts, ends[side], h, 0.0, between))
            if len(contacts):
                found.append((contacts, ends[side], side))
        for side, share in ((side, share) for side in (0, 1) for share in np.linspace(0.0, 1.0, PARTS + 1)[1:]):
            if not len(some):
                break
            moved = _moved(ends[side], np.repeat((share if side == 0 else -share) * h, hit.shape[1]))
            poses = moved.q.reshape(len(ks), -1, 7)[some]
            contacts = self._touching.of_many(poses, reach[some], some, self._copy[ks[some]])
            contacts = contacts.only(_any(asked, contacts))
            contacts = contacts.only(self._within_reach(contacts, moved, h, share, between))
            if len(contacts):
                found.append((contacts, moved, side))
        if not found:
            return []
        lasting = self._lasting(found, ends, hit, ks)
        columns = []
        for (contacts, moved, _), along in zip(found, lasting, strict=True):
            friction, rolling = self._touching.laws(contacts.shapes)
            columns.append(
                pushes(contacts, moved, friction, along, self._rolling(contacts, rolling, friction, self._copy[ks]))
            )
        return columns

    def _at_frames(self, firsts: Rows, reach: Floats) -> tuple[Contacts, Contacts]:
        """Contacts at both ends of some intervals; a frame that ends one and begins another is looked at once."""
        frames, which = np.unique(np.concatenate([firsts, firsts + 1]), return_inverse=True)
        far, sides = np.zeros(len(frames)), which.reshape(2, -1)
        np.maximum.at(far, which.ravel(), np.tile(reach, 2))
        bodies = self._q.shape[1]
        copies = frames // len(self._copies[0].time)
        every = self._touching.of_many(self._q[frames], far, np.arange(len(frames)), copies)
        frame = np.maximum(every.one, every.two) // max(bodies, 1)
        first = np.searchsorted(frame, np.arange(len(frames) + 1))
        found = []
        for side in sides:
            counts = first[side + 1] - first[side]
            row = np.repeat(np.arange(len(firsts)), counts)
            at = np.arange(counts.sum()) + np.repeat(first[side] - np.cumsum(counts) + counts, counts)
            chosen, by = every.only(at), (row - frame[at]) * bodies
            one, two = (np.where(rows >= 0, rows + by, rows) for rows in (chosen.one, chosen.two))
            found.append(replace(chosen, one=one, two=two).only(chosen.gap <= reach[row]))
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
        self._landed[ks] = np.maximum(self._landed[ks], landed.reshape(hit.shape))
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
        lasts &= ~_any(hit, every) & keeps_way(every, slowest, landed)
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


def _parts(ks: Rows, bodies: int) -> list[Rows]:
    """Intervals by as many as are worked out at once."""
    return [] if not len(ks) else np.array_split(ks, -(-len(ks) * bodies // CHUNK))


def _any(bodies: Bools, contacts: Contacts) -> Bools:
    """Whether either body of a contact is one of some (K, B)."""
    rows = np.stack([contacts.one, contacts.two])
    return np.asarray((bodies.ravel()[np.maximum(rows, 0)] & (rows >= 0)).any(axis=0))


def unseen(evidence: Evidence) -> Bools:
    """Bodies that something turns by a torque that is not recorded, (B,): what a controller does to joints.

    In older recordings a fluid's torques, too, and all of a controller's.
    """
    recording, motion = evidence.recording, evidence.motion
    controlled = bool(recording.metadata.get("controlled"))
    if recording.applied_turn is not None:
        return ~motion.kinematic & motion.jointed & controlled
    if controlled:
        return ~motion.kinematic
    pushed, none = recording.applied_impulse, np.zeros(len(motion.mass), dtype=bool)
    return none if pushed is None else np.any(pushed != 0.0, axis=(0, 2))


def rounding(evidence: Evidence) -> Floats:
    """What single precision leaves of an acceleration, (T - 1, B) [m/s^2]."""
    motion = evidence.motion
    speed = motion.speed + np.linalg.norm(motion.w, axis=2) * motion.radius
    found: Floats = 8.0 * FLOAT32 * np.maximum(speed[1:], speed[:-1]) / motion.h[:, None]
    return found
