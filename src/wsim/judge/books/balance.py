"""For each interval between frames: what change of momentum no admissible impulse explains.

The change of momentum and of angular momentum of each body, less gravity and what fluid and control gave it, must be a
sum of impulses that the world can exert: of contacts where shapes touch or may have met in the interval, pushing only
and inside the cone of the pair's friction, on its edge against a slip that lasts; of joints and springs along what they
hold. What no sum of them gives is the finding.

The copies of a world, or of worlds that differ in sizes and coefficients alone, are worked out at once: their intervals
stand one after another, N = W (T - 1) of them, and their frames, W T. A recording by itself is one copy.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.books import arms, jolts
from wsim.judge.books.admissible import explain
from wsim.judge.books.differences import followed, unknown
from wsim.judge.books.forces import Columns, turns
from wsim.judge.books.landing import caught
from wsim.judge.books.meeting import Meeting
from wsim.judge.books.recorded import plain, told_by_record
from wsim.judge.books.repeats import Repeats
from wsim.judge.books.steps import step_error
from wsim.judge.books.struck import Struck
from wsim.judge.books.ties import Ties
from wsim.judge.evidence.motion import FLOAT32

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]
    Rows = NDArray[np.intp]

SOFT = 2.0  # times gravity's pull over the interval: what changes a velocity by less is no blow
ENOUGH = 0.001  # of gravity: a rest that is as good as none
AGAIN = 0.003  # of gravity: where more is left, contacts are looked for between the frames
CHUNK = 4000  # bodies times intervals worked out at once


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
        self._copies = copies
        self._ties = [Ties(evidence) for evidence in copies]
        self._known: dict[bytes, Floats] = {}  # strengths of large problems: many are asked again
        self._struck: list[Struck] = []  # of each copy, as soon as it is known what was hit
        motions = [evidence.motion for evidence in copies]
        count = len(motions[0].h)
        self._unit = max(float(np.linalg.norm(motions[0].gravity)), 1.0)  # [m/s^2]
        self._kinematic, self._mechanism = motions[0].kinematic, motions[0].unit  # (B,), of all copies
        self._jointed = motions[0].jointed
        self._mass = np.stack([motion.mass for motion in motions])  # (W, B)
        held = np.stack([ties.arms for ties in self._ties])
        self._sizes = np.maximum(np.maximum(np.stack([motion.radius for motion in motions]), held), 1e-4)  # (W, B)
        self._meeting = Meeting(copies, self._sizes)
        self._h = np.concatenate([motion.h for motion in motions])  # (N,)
        self._angles = [arms.turned(evidence, size) for evidence, size in zip(copies, self._sizes, strict=True)]
        self._pressed = np.concatenate([jolts.struck(evidence, ()) for evidence in copies]) & self._jointed  # (N, B)
        self._plain = np.concatenate([plain(evidence) for evidence in copies])  # (N, B)
        # The share that is wrong of what an arm taken halfway gives.
        bent = zip(copies, self._angles, strict=True)
        self._bent = np.concatenate([angle**2 / 12.0 + arms.shaken(evidence) for evidence, angle in bent])
        self._copy = np.repeat(np.arange(len(copies)), count)

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
        hits = list(zip(self._copies, np.split(hit, len(laws)), strict=True))
        self._struck = [Struck(*each) for each in hits]
        self._meeting.caught = np.concatenate([caught(*each) for each in hits])
        left, turned = self._worked_out(wanted, judged, hit)
        pulled = np.concatenate([ties.ropes.error() for ties in self._ties])
        stepped = np.concatenate([step_error(evidence) for evidence in self._copies])
        turned += (wrong + pulled) / np.stack([mass, arm], axis=2) + stepped
        turned += self._changing(wanted, hit)[..., None]
        changes = np.split(both, len(self._copies))
        turned += np.concatenate([unknown(*each) for each in zip(self._copies, changes, strict=True)])
        found = left[..., :3], left[..., 3:], blow, turned, judged, hit, wanted, self._meeting.landed
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
        repeats = Repeats(self._copies, wanted, hit, self._sizes, self._unit)
        due = np.flatnonzero(repeats.anew.any(axis=1))
        while len(due):
            for ks in _parts(due, hit.shape[1]):
                anew = repeats.anew[ks]
                asked, aside = judged[ks] & anew, judged[ks] & ~anew
                left[ks], turned[ks], repeats.apart[ks] = self._explained(
                    ks, wanted[ks], asked, hit[ks], hit[ks] & anew, aside=aside
                )
                ready = ~repeats.lacking(ks)
                some = ks[ready]
                self._otherwise(some, wanted[some], asked[ready], hit[some], left, turned)
            due = repeats.stale()
        self._meeting.landed = np.maximum(self._meeting.landed, repeats.again(self._meeting.landed))
        return repeats.again(left, wanted), repeats.again(turned)

    def _otherwise(self, ks: Rows, wanted: Floats, asked: Bools, hit: Bools, left: Floats, turned: Floats) -> None:
        """Explain in other ways what is left of some intervals where that is much, and take what leaves less."""
        much = (np.linalg.norm(left[ks], axis=2) > AGAIN * self._unit) & asked
        between = (hit | much) & asked
        strange = (much & ~hit).any(axis=1)
        if strange.any():  # they may have touched between the frames alone
            some = ks[strange], wanted[strange], asked[strange], hit[strange], between[strange]
            left[some[0]], turned[some[0]] = self._explained(*some)[:2]
        struck = much.any(axis=1) & (hit & self._jointed).any(axis=1)
        if struck.any():  # and ties may have passed on all that they did as their arms were at one instant
            some = ks[struck], wanted[struck], asked[struck], hit[struck], between[struck]
            for course in (0, 1):
                self._where_less(some[0], self._explained(*some, course=course)[:2], left, turned)
        # How links and bobs swing between two frames these do not tell: what it gives is recorded.
        swings = (much & self._plain[ks]).any(axis=1)
        swings |= much.any(axis=1) & (self._pressed[ks] & hit).any(axis=1)
        if swings.any():
            for told in told_by_record(self._copies, self._sizes[0], ks[swings], asked[swings]):
                self._where_less(ks[swings], told, left, turned)

    @staticmethod
    def _where_less(ks: Rows, tried: tuple[Floats, Floats], left: Floats, turned: Floats) -> None:
        """Take what is left of some intervals by another explanation, and may be missing, where that is less."""
        less = np.sum(tried[0] ** 2, axis=(1, 2)) < np.sum(left[ks] ** 2, axis=(1, 2))
        left[ks[less]], turned[ks[less]] = tried[0][less], tried[1][less]

    def _explained(
        self, ks: Rows, change: Floats, judged: Bools, hit: Bools, between: Bools, *, course: int | None = None,
        aside: Bools | None = None,
    ) -> tuple[Floats, Floats, Bools]:  # fmt: skip
        """What is left of the changes (K, B, 6) of some intervals, and what may be missing of it, (K, B, 2).

        Contacts are looked for `between` the frames, too, of some bodies, of which some are `hit`, (K, B). A body in an
        interval is one of K B, so that all intervals are worked out at once. Of what is hit ties have the arms halfway,
        or those of the blow by the `course` to it (0) or from it (1). What is put `aside` takes no impulses.

        Returns:
            These, and whether it took impulses of what is apart, or is not explained, (K, B).
        """
        count, bodies = judged.shape
        rest = np.where(judged[..., None], change, 0.0).reshape(-1, 6)
        missing, apart = np.zeros((len(rest), 2)), judged.ravel()
        none = np.zeros_like(judged)
        columns = self._meeting.pushes(ks, judged, hit, between, none if aside is None else aside)
        for n, k in enumerate(ks) if self._ties[0].any else ():
            copy, frame = divmod(int(k), len(self._copies[0].motion.h))
            ties = self._ties[copy].columns(frame, self._struck[copy].ends(frame, course))
            columns += [each.shifted(n * bodies) for each in ties]
        if columns:
            turned = np.flatnonzero(np.stack([unseen(evidence) for evidence in self._copies])[self._copy[ks]])
            all_ = Columns.of([*columns, turns(turned)] if len(turned) else columns)
            scale, enough, bent = self._scale(ks).reshape(-1, 6), ENOUGH * self._unit, self._bent[ks].ravel()
            rest, missing, apart = explain(all_, judged.ravel(), rest, scale, enough, bent, hit.ravel(), self._known)
        return rest.reshape(count, bodies, 6), missing.reshape(count, bodies, 2), apart.reshape(count, bodies)


def _parts(ks: Rows, bodies: int) -> list[Rows]:
    """Intervals by as many as are worked out at once."""
    return [] if not len(ks) else np.array_split(ks, -(-len(ks) * bodies // CHUNK))


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
