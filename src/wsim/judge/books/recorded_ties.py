"""What a recording says that joints, springs and ropes gave: to whom, and how it should have been by frames and laws.

Between two frames a reaction's arm and axis turn by the angle t that its bodies turn. An impulse taken at the arm of
the middle is off by t^2 / 12 of it where both change evenly; where it all comes at one end, as in a blow, by t / 2.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.books import arms, jolts
from wsim.judge.books.laws import RESOLVED, Laws
from wsim.judge.books.ropes import Ropes
from wsim.judge.books.thrown import thrown
from wsim.judge.evidence.cords import track_of_spring
from wsim.judge.evidence.joints import anchors_of, broken
from wsim.judge.evidence.motion import FLOAT32
from wsim.recording.ties import cord_ends

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.recording.ties import TieTrack
    from wsim.scene.world import Joint

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]

WORLD = -1
OWN = ("revolute", "prismatic")  # kinds with one motion of their own
EVEN = 0.05  # of its way, that something misses which goes on evenly
EASED = 1e-3  # of dry friction: what gives less holds, or slips for a part of the interval


@dataclass(frozen=True)
class Stated:
    """What a law gives over each interval, (T - 1,) each [N or N m]."""

    mean: Floats
    unsure: Floats  # by which it may be another, as frames tell it
    known: Bools


class RecordedTies:
    """The recorded impulses of joints and cords."""

    def __init__(self, evidence: Evidence, track: TieTrack) -> None:
        self._evidence, self.track = evidence, track
        self._row = {body.prim: i for i, body in enumerate(evidence.world.bodies)}
        self.ends = cord_ends(evidence.world)
        self.joints = evidence.world.joints
        self.pairs = [(self._row.get(joint.parent or "", WORLD), self._row[joint.child]) for joint in self.joints]
        self.laws = Laws(evidence)
        self.ropes = Ropes(evidence)

    @property
    def intervals(self) -> Floats:
        """Lengths of the intervals between frames, (T - 1,) [s]."""
        return self._evidence.motion.h

    # ---- sums
    @cached_property
    def given(self) -> tuple[Floats, Floats]:
        """Impulse and angular impulse on each body since the frame before, (T, B, 3) each."""
        found = np.zeros((2, len(self._evidence.time), len(self._row), 3))
        for k, pair in enumerate(self.pairs):
            for side, (row, sign) in enumerate(zip(pair, (-1.0, 1.0), strict=True)):
                if row >= 0:
                    found[0][:, row] += sign * self.track.impulse[:, k]
                    found[1][:, row] += self.track.turn[:, k, side]
        for k, (_, row) in enumerate(self.ends):
            found[0][:, row] += self.track.cords[:, k, :3]
            found[1][:, row] += self.track.cords[:, k, 3:6]
        return found[0], found[1]

    @cached_property
    def passed(self) -> Floats:
        """Sizes of all impulses on each body, of angular ones by its radius, (T, B) [N s]."""
        radius = np.maximum(self._evidence.motion.radius, 1e-9)
        found = np.zeros((len(self._evidence.time), len(self._row)))
        for k, pair in enumerate(self.pairs):
            for side, row in enumerate(pair):
                if row >= 0:
                    found[:, row] += np.linalg.norm(self.track.impulse[:, k], axis=1)
                    found[:, row] += np.linalg.norm(self.track.turn[:, k, side], axis=1) / radius[row]
        for k, (_, row) in enumerate(self.ends):
            found[:, row] += np.linalg.norm(self.track.cords[:, k, :3], axis=1)
        return found

    def stepped(self, moved: Floats) -> Floats:
        """What steps of the first order leave of momentum, (T - 1, B) [m/s^2].

        By l dt (2 w w' + w^3 / 2) a body at l from the joint that it turns about (`wsim.judge.books.steps`); l w' and
        l w^2 are at most what moves it, w is that of the fastest body of its mechanism. The first of the two is the
        more where w dt is below 1.

        Args:
            moved: What moves each body, over its mass, (T - 1, B) [m/s^2].
        """
        motion, rate = self._evidence.motion, self._turning
        fastest = np.zeros_like(rate)
        for unit in np.unique(motion.unit[motion.jointed]):
            rows = np.flatnonzero(motion.unit == unit)
            fastest[:, rows] = rate[:, rows].max(axis=1, keepdims=True)
        found: Floats = 2.0 * np.minimum(motion.dt, motion.h)[:, None] * fastest * moved
        return found

    @cached_property
    def _turning(self) -> Floats:
        """The faster rate at which each body turns at both ends of an interval, (T - 1, B) [rad/s].

        Or that by which it turned meanwhile: what a stop catches may show no rate before or after.
        """
        motion = self._evidence.motion
        rate, turn = np.linalg.norm(motion.w, axis=2), motion.q[..., 3:]
        # By half-angles' sines: the cosine of a small one is lost in rounding.
        apart = np.minimum(*(np.linalg.norm(turn[1:] + sign * turn[:-1], axis=2) for sign in (-1.0, 1.0)))
        turned = 4.0 * np.arcsin(np.minimum(0.5 * apart, 1.0))
        found: Floats = np.maximum(np.maximum(rate[1:], rate[:-1]), turned / motion.h[:, None])
        return found

    @cached_property
    def _shaken(self) -> Floats:
        return arms.shaken(self._evidence)

    # ---- joints
    def along(self, k: int) -> tuple[Floats, Floats]:
        """What joint k passes on along its own motion that no effort gives, and all of it, (T - 1,) [N s or N m s]."""
        track = self.track
        efforts = track.joints[1:, k, 13:17].astype(np.float64)
        all_ = np.abs(efforts).sum(axis=1)
        if self.joints[k].kind == "spherical":
            return np.linalg.norm(track.about_anchor[1:, k], axis=1), np.zeros(len(all_))
        return np.abs(track.along[1:, k] - efforts.sum(axis=1)), all_

    def misplaced(self, k: int) -> tuple[Floats, Floats]:
        """By how much joint k's angular impulses are not those of its impulse at its anchor, and may be, (T - 1,).

        [N m s]; on both bodies, and about and along its axis. What a push is more or less than before or after may have
        come all at one end of the interval, as a blow does.
        """
        motion, joint, track = self._evidence.motion, self.joints[k], self.track
        anchors = anchors_of(self._evidence, joint)
        push, about = (array[1:, k].astype(np.float64) for array in (track.impulse, track.about_anchor))
        reach, off, moved = np.linalg.norm(about, axis=1), np.zeros(len(push)), np.zeros(len(push))
        slides, at, longest = np.zeros(len(push)), self._evidence.joint(joint), 0.0
        if at is not None and joint.kind == "prismatic":  # an arm that swings between frames
            slides = jolts.strayed(at.position, self.laws.rate(joint), motion.h)
        for side, (row, sign) in enumerate(zip(self.pairs[k], (-1.0, 1.0), strict=True)):
            if row < 0:
                continue
            arms = anchors.below - motion.com[:, row]
            arm = 0.5 * (arms[1:] + arms[:-1])
            expected = sign * (about + np.cross(arm, push))
            off = np.maximum(off, np.linalg.norm(track.turn[1:, k, side] - expected, axis=1))
            uneven = self._uneven[:, row] + 0.5 * _turn(push)
            strays = slides * np.linalg.norm(push, axis=1)
            moved = np.maximum(moved, np.linalg.norm(np.diff(arms, axis=0), axis=1) * uneven + strays)
            longest = max(longest, float(np.linalg.norm(arms, axis=1).max()))
            reach = np.maximum(reach, longest * np.linalg.norm(push, axis=1))
        if joint.kind in OWN:
            axes = self.laws.axis(joint)
            axis = axes[1:] + axes[:-1]
            axis /= np.maximum(np.linalg.norm(axis, axis=1, keepdims=True), 1e-12)
            own = np.einsum("ti,ti->t", push if joint.kind == "prismatic" else about, axis)
            gap, row = np.abs(own - track.along[1:, k]), self.pairs[k][1]
            if joint.kind == "prismatic":  # a force, where all else here is a moment
                lever = max(longest, float(motion.radius[row]))
                reach = np.maximum(reach, lever * np.linalg.norm(push, axis=1))
                gap = lever * gap
            off = np.maximum(off, gap)
            # What a blow twists a joint by, the whirl after it may twist back: each is about the axis of its own time.
            twisted = self._uneven[:, row] * motion.radius[row]
            moved = np.maximum(moved, np.linalg.norm(np.diff(axes, axis=0), axis=1) * twisted)
        return off, self._turned(k) * reach + moved

    @cached_property
    def _uneven(self) -> Floats:
        """What of contacts' and drives' impulses on each body's mechanism counts as if all came at an end, (T - 1, B).

        A ball that is hit and hits the next one shows next to nothing of either blow on the whole, and each passed
        through its joints with the arms of its own instant. Of impulses whose sizes add up to s and whose sum is p,
        no part is more than (s + p) / 2, and (s - p) / 2 of it is taken back. Of a blow, which is what s is more than
        before or after, the sum as well has the arms of one instant, which are half of their way off at most.
        """
        motion, contacts = self._evidence.motion, self._evidence.recording.contacts
        sums, sizes = np.zeros((len(motion.h), len(motion.mass), 3)), np.zeros((len(motion.h), len(motion.mass)))
        hurled = thrown(self._evidence, self.laws)
        if contacts is None:
            return hurled
        owner = np.array([i for i, body in enumerate(self._evidence.world.bodies) for _ in body.shapes], dtype=np.intp)
        impulse = contacts.impulse.astype(np.float64)
        for side, sign in ((0, -1.0), (1, 1.0)):
            ours = np.flatnonzero((contacts.pair[:, side] < len(owner)) & (contacts.frame > 0))
            at = contacts.frame[ours] - 1, owner[contacts.pair[ours, side]]
            np.add.at(sums, at, sign * impulse[ours])
            np.add.at(sizes, at, np.linalg.norm(impulse[ours], axis=1))
        for unit in np.unique(motion.unit):
            rows = np.flatnonzero(motion.unit == unit)
            whole = np.linalg.norm(sums[:, rows].sum(axis=1), axis=1)
            size = sizes[:, rows].sum(axis=1)
            around = np.pad(size, 1)
            blow = np.minimum(np.maximum(size - np.minimum(around[:-2], around[2:]), 0.0), whole)
            sizes[:, rows] = 0.5 * (size - whole + blow)[:, None]
        return sizes + hurled

    def _turned(self, k: int) -> Floats:
        """The share of joint k's impulses that arms taken halfway may miss, (T - 1,)."""
        motion = self._evidence.motion
        rows = [row for row in self.pairs[k] if row >= 0]
        hangs = np.isin(motion.unit, motion.unit[rows])  # what one link does another may pass on between frames
        rate = np.pad(self._turning[:, hangs].max(axis=1), 1, mode="edge")
        angle = np.max([rate[:-2], rate[1:-1], rate[2:]], axis=0) * motion.h
        size = np.linalg.norm(self.track.joints[1:, k, :12].astype(np.float64), axis=1)
        change = _turn(size[:, None]) / np.maximum(size, 1e-30)
        shaken = self._shaken[:, rows].max(axis=1, initial=0.0)
        found: Floats = np.minimum(angle**2 / 12.0 + 0.5 * angle * np.minimum(change, 1.0) + shaken, 2.0)
        return np.where(angle > RESOLVED, 2.0, found)  # they may point anywhere

    def drive(self, k: int) -> Stated | None:
        """What joint k's drive gives by its law; None where it has none, or somebody sets it while the world runs."""
        joint = self.joints[k]
        drive = joint.drive
        if drive is None or joint.kind not in OWN or not self.laws.joints[joint.prim]:
            return None
        law, at = self.laws.joints[joint.prim][0], self._evidence.joint(joint)
        rate = self.laws.rate(joint)
        if at is None or not drive.told or self._evidence.recording.metadata.get("controlled"):
            return None
        pull, most = self.laws.effort(joint), np.inf if drive.max_effort is None else drive.max_effort
        full = np.where(np.abs(pull) >= most, np.sign(pull), 0.0)
        rounding = 8.0 * FLOAT32 * (drive.stiffness * self._extent(k) + drive.damping * np.abs(rate).max())
        known = (law.error < RESOLVED**2 / 12.0) & (full[1:] == full[:-1]) | (full[1:] * full[:-1] > 0.0)
        known &= ~broken(self._evidence, joint)[1:]
        aims = self.laws.aims(joint)
        if drive.max_effort is not None:
            known &= ~aims.jumps
        mean, found = 0.5 * (pull[1:] + pull[:-1]), self.laws.mean_of_drive(joint)
        unsure = self._by_frames(pull) + np.where(full[1:] * full[:-1] > 0.0, law.error * np.abs(mean), 0.0)
        if found is not None:
            # What another drive shakes faster than frames tell is damped by how far it went, too.
            stray = jolts.strayed(at.position, rate, self.intervals)
            shaken = drive.damping * stray / self.intervals > unsure
            hit = self._stuck[:, self.pairs[k][1]] | shaken | aims.jumps
            may = found[1] + drive.stiffness * np.where(shaken, stray, 0.0)
            mean, unsure = (np.where(hit, *pair) for pair in ((found[0], mean), (may, unsure)))
            known &= found[2] | ~hit
        return Stated(mean, unsure + rounding, known)

    def _extent(self, k: int) -> float:
        """About how large the numbers are of which joint k's position is made [rad or m]."""
        places = np.abs(self._evidence.motion.com[:, [row for row in self.pairs[k] if row >= 0]])
        return float(places.max()) if self.joints[k].kind == "prismatic" else float(np.pi)

    def _by_frames(self, force: Floats) -> Floats:
        """By how much the mean of a force at both ends of an interval may miss that over it, (T - 1,).

        The trapezoidal rule misses h^2 / 12 of the second derivative, here the larger of those at both ends, twice as a
        precaution; and a step takes the force at its start, or at its end.
        """
        change = np.diff(force)
        bend = np.abs(np.diff(change, prepend=change[:1], append=change[-1:]))
        late = np.minimum(self._evidence.motion.dt / self._evidence.motion.h, 1.0) * np.abs(change)
        found: Floats = np.maximum(bend[1:], bend[:-1]) / 6.0 + late
        return found

    @cached_property
    def struck(self) -> Bools:
        """Where the speeds of each body's mechanism may jump, (T - 1, B)."""
        stops = [(pair, self.track.stop[1:, k] != 0.0) for k, pair in enumerate(self.pairs)]
        return jolts.struck(self._evidence, [*stops, *((pull.rows, pull.jerks) for pull in self.ropes.pulls)])

    @cached_property
    def _stuck(self) -> Bools:
        """Likewise, or change evenly no more, as dry friction in it comes to hold a joint or lets it go, (T - 1, B)."""
        holds = [np.abs(self.track.friction[1:, k]) < (1.0 - EASED) * joint.friction * self.intervals
                 for k, joint in enumerate(self.joints)]  # fmt: skip
        return self.struck | jolts.struck(self._evidence, list(zip(self.pairs, holds, strict=True)))

    def rubs(self, k: int) -> tuple[Floats, Bools, Floats]:
        """Joint k's direction of motion, (T - 1,), where it has it all through an interval, and the most of it for
        which a blow may have turned it back, a share.

        It has it where friction could not stop what the joint holds in the interval, or not in a step where both rates
        tell how far it went there and in the intervals beside: who turns back and again goes less far.
        """
        rate, joint, h = self.laws.rate(self.joints[k]), self.joints[k], self._evidence.motion.h
        known, at = np.all([law.known for law in self.laws.joints[joint.prim]], axis=0), self._evidence.joint(joint)
        if at is not None and joint.drive is None:
            fast = np.abs(rate) > self.laws.slowing(joint) * self._evidence.motion.dt
            evenly = _evenly(rate, np.diff(at.position), h) & fast[1:] & fast[:-1]
            known |= evenly & ~broken(self._evidence, joint)[1:]
        lasts = known & (rate[1:] * rate[:-1] > 0.0) & (h > 0.0)
        back = np.zeros(len(h)) if at is None else jolts.reversed_share(at.position, rate, h, self._evidence.motion.dt)
        return np.sign(rate[1:]), lasts, np.where(self.struck[:, self.pairs[k][1]], back, 0.0)

    def pushed_off(self, k: int, near: float) -> Floats:
        """Where joint k's stops may not push: 1 upwards, 2 downwards, 3 both, (T - 1,)."""
        joint, track = self.joints[k], self._evidence.joint(self.joints[k])
        if track is None:
            return np.zeros(len(self._evidence.motion.h))
        at, h = track.position, self._evidence.motion.h
        reach = near + np.abs(self.laws.rate(joint))[:-1] * h + 2.0 * np.abs(np.diff(at))
        low = np.inf if joint.low is None else np.minimum(at[1:], at[:-1]) - joint.low
        high = np.inf if joint.high is None else joint.high - np.maximum(at[1:], at[:-1])
        found: Floats = 1.0 * (low > reach) + 2.0 * (high > reach)
        return found

    # ---- cords
    def cord(self, k: int) -> tuple[Floats, Floats, Floats]:
        """Of end k of a cord: by how much its wrench is not its tension's along its way, and may be; and its size.

        (T - 1,) each [N s], torques by the arm.
        """
        evidence, (cord, row) = self._evidence, self.ends[k]
        given, tension = self.track.cords[1:, k, :6].astype(np.float64), self.track.tension[1:, k].astype(np.float64)
        first, last, mean = self._ways(cord, row)
        arm = max(float(np.linalg.norm(mean[:, 3:], axis=1).max(initial=0.0)), float(evidence.motion.radius[row]), 1e-9)
        scale = np.repeat([1.0, 1.0 / arm], 3)
        off = np.linalg.norm((given - tension[:, None] * mean) * scale, axis=1)
        turned = np.maximum(np.linalg.norm((last - first) * scale, axis=1), self._swept(cord, row, arm))
        change = np.where(self._jerks(cord), np.abs(tension), _turn(tension[:, None]))
        late = 0.5 * np.minimum(evidence.motion.dt / evidence.motion.h, 1.0)
        # One that goes from push to pull is next to nothing on the whole, and yet gives by how far its way turns: at
        # most an eighth of its change, where that comes at once halfway, and a twelfth where it comes evenly.
        uneven = np.maximum(0.5 * np.minimum(change, np.abs(tension)), self._swings(cord) / 8.0)
        may = (uneven + (late + turned / 12.0) * np.abs(tension)) * turned
        springs = evidence.world.springs
        if cord < len(springs):  # a ninth of what its way bends by, where that swings by 1.2 rad a frame
            along = track_of_spring(evidence, springs[cord]).along
            may = may + 0.5 * np.abs(tension) * arms.bent(np.tile(along, 2))[:, 0]
        return off, may, np.abs(tension)

    def _jerks(self, cord: int) -> Bools:
        """Where a rope comes taut or goes slack, (T - 1,): all that it pulls it may pull at one end of the interval."""
        springs = len(self._evidence.world.springs)
        return self.ropes.pulls[cord - springs].jerks if cord >= springs else np.zeros(len(self.intervals), dtype=bool)

    def _swept(self, cord: int, row: int, arm: float) -> Floats:
        """How far a spring's way on a body turns within each interval, there and back too, (T - 1,).

        As fast as the body turns at its ends or in the intervals beside, and by what it shakes; torques by the arm. Or
        as far as its ends take it, and it bends there.
        """
        springs, evidence = self._evidence.world.springs, self._evidence
        if cord >= len(springs):
            return np.zeros(len(evidence.motion.h))
        com = np.array(evidence.world.bodies[row].com)
        held = [guide.position for guide in springs[cord].path if self._row.get(guide.body or "", WORLD) == row]
        far = max(float(np.linalg.norm(np.subtract(place, com))) for place in held)
        rate = np.pad(self._turning[:, row], 1, mode="edge")
        angle = np.max([rate[:-2], rate[1:-1], rate[2:]], axis=0) * evidence.motion.h + self._shaken[:, row]
        track = track_of_spring(evidence, springs[cord])
        length, turn = track.length, np.linalg.norm(np.diff(track.along, axis=0), axis=1)
        found: Floats = angle * far * (1.0 / arm + 1.0 / np.maximum(np.minimum(length[1:], length[:-1]), arm))
        return np.minimum(np.maximum(found, turn + arms.bent(np.tile(track.along, 2))[:, 0]), 2.0)

    def _swings(self, cord: int) -> Floats:
        """By how much the impulse of a spring's law changes where it turns from push to pull, or back, (T - 1,)."""
        springs, h = self._evidence.world.springs, self._evidence.motion.h
        if cord >= len(springs):
            return np.zeros(len(h))
        pull = track_of_spring(self._evidence, springs[cord]).pull
        found: Floats = np.where(pull[1:] * pull[:-1] < 0.0, np.abs(np.diff(pull)) * h, 0.0)
        # Of two that range over a and b the mean of the product is less than a b / 4 off that of the means (Gruess).
        fast = self.laws.springs[cord].error > RESOLVED**4 / 720.0
        return np.maximum(found, np.where(fast, 2.0 * arms.ranging(pull) * h, 0.0))

    def _ways(self, cord: int, row: int) -> tuple[Floats, Floats, Floats]:
        """What a tension of one gives a body at the start, at the end and as a mean of each interval, (T - 1, 6)."""
        springs = self._evidence.world.springs
        if cord >= len(springs):
            pull = self.ropes.pulls[cord - len(springs)]
            at = np.flatnonzero(pull.rows == row)
            if len(at):
                return pull.first[:, at[0]], pull.last[:, at[0]], pull.mean[:, at[0]]
            none = np.zeros((len(self._evidence.motion.h), 6))  # a kinematic body, of which nothing is asked
            return none, none, none
        along = track_of_spring(self._evidence, springs[cord]).along
        way = np.zeros((len(along), 6))
        for guide, sign in zip(springs[cord].path, (1.0, -1.0), strict=True):
            if self._row.get(guide.body or "", WORLD) == row:
                arm = self.laws.arm(row, self.laws.end(guide))
                way += sign * np.concatenate([along, np.cross(arm, along)], axis=1)
        return way[:-1], way[1:], 0.5 * (way[1:] + way[:-1])

    def spring(self, cord: int) -> Stated:
        """What a spring pulls by its law."""
        motion, law = self._evidence.motion, self.laws.springs[cord]
        spring = self._evidence.world.springs[cord]
        track = track_of_spring(self._evidence, spring)
        far, fast = np.abs(motion.com).max(initial=0.0), motion.speed.max(initial=0.0)
        rounding = 8.0 * FLOAT32 * (spring.stiffness * far + spring.damping * fast)
        mean, unsure = 0.5 * (track.pull[1:] + track.pull[:-1]), self._by_frames(track.pull)
        rows = [row for end, row in self.ends if end == cord]
        fast = law.error > RESOLVED**4 / 720.0  # what its length and its rate tell better than its pull at both ends
        hit = self.struck[:, rows].any(axis=1) | fast
        if hit.any():
            gains, stretch = (spring.stiffness, spring.damping), track.length - spring.rest_length
            jolted, may = jolts.mean_force(gains, stretch, track.rate, motion.h, motion.dt)
            may = (
                may + 8.0 * FLOAT32 * spring.damping * far / motion.h + np.where(fast, law.error * np.abs(jolted), 0.0)
            )
            mean, unsure = np.where(hit, jolted, mean), np.where(hit, may, unsure)
        return Stated(mean, unsure + rounding, law.known)

    def slack(self, cord: int) -> Bools:
        """Where a rope cannot be taut, (T - 1,)."""
        return ~self.ropes.pulls[cord - len(self._evidence.world.springs)].taut

    def effective(self, joint: Joint) -> bool:
        """Whether nothing but what is recorded acts along a joint's own motion."""
        return joint.armature == 0.0 and joint.kind != "compound"


def _turn(vectors: Floats) -> Floats:
    """By how much each of some vectors in a row differs from one beside it, at most, (n,); (n, 3) of them."""
    if len(vectors) < 2:
        return np.asarray(np.linalg.norm(vectors, axis=1))
    step = np.linalg.norm(np.diff(vectors, axis=0), axis=1)
    found: Floats = np.maximum(np.append(step, 0.0), np.append(0.0, step))
    return found


def _evenly(rate: Floats, way: Floats, h: Floats) -> Bools:
    """Where rates at frames (T,) tell how far something went, (T - 1,), there and in the intervals beside."""
    told = np.abs(way - 0.5 * (rate[1:] + rate[:-1]) * h) < EVEN * np.abs(way)
    told &= rate[1:] * rate[:-1] > 0.0
    around = np.pad(told, 1)
    return told & around[2:] & around[:-2]
