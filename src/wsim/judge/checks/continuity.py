"""The check of poses against velocities: from frame to frame, and summed over the run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import numpy as np

from wsim.geometry.rotations import lengths
from wsim.judge.books.copies import told
from wsim.judge.books.hidden import hidden
from wsim.judge.books.laws import Laws
from wsim.judge.books.mobility import mobilities
from wsim.judge.checks.check import Check, Checks
from wsim.judge.checks.strangest import strangest
from wsim.judge.evidence.cords import track_of_spring
from wsim.judge.evidence.joints import anchors_of
from wsim.judge.evidence.motion import FLOAT32
from wsim.judge.evidence.scheduled import between, drive_is_set

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding
    from wsim.scene.world import Joint

    Floats = NDArray[np.float64]
    Pair = tuple[Floats, Floats]  # a value and its limit


SHAKEN = 2.0  # times the farthest that a link strays in an interval: what its swings to and fro add up to


@dataclass
class CheckContinuity(Check):
    """A body goes from frame to frame by its own velocity: it does not jump, does not turn at once, does not drift."""

    alias: float = 2.0  # [rad] a frame: beyond, a rotation cannot be told from its shorter way round
    roundings: float = 8.0  # of float32, in a position: one a step, half of them of one sign
    starts: int = 8  # moments from which a drift is summed
    steps: float = 2.0  # of gravity in a time step, that a contact may be late by

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """The place and the turn that the velocity explains least, and the farthest drift."""
        if len(evidence.motion.h) == 0 or len(evidence.motion.mass) == 0:
            return []
        if CheckContinuity not in evidence.kept:
            evidence.kept[CheckContinuity] = self._asked(evidence)
        (far, most), (turned, angle), drift = cast("tuple[Pair, Pair, Pair]", evidence.kept[CheckContinuity])
        change = "half the velocity's change about then, g h, and the speed of what may hit or drive it, over h"
        rate = (
            "its fastest rate then, half the rate's change, g h / r or a hit's v / r, and what it was caught with "
            "over its least radius of gyration, over the frame's h"
        )
        ends = (
            "what its ends and its blows leave of the trapezoidal rule, a time step of its change of velocity, and "
            "speeds that blows may have given and taken between two frames"
        )
        found = [
            self._worst(evidence, far, most, "m", "jumps by", change),
            self._worst(evidence, turned, angle, "rad", "turns by", rate),
        ]
        if not found[0].passed:
            return found  # what has jumped is not where its velocities take it, either
        if np.any(drift[0] > drift[1]) and told(evidence):  # heavy to work out, and asked of little
            drift = self._drift(evidence, self._strayed(evidence), _driven(evidence)[0] + hidden(evidence))
        return [*found, self._worst(evidence, *drift, "m", "has drifted by", ends)]

    def prepare(self, joined: Evidence, copies: Sequence[Evidence]) -> None:
        """What is asked of all copies at once."""
        world = joined.world
        tied = world.joints or world.springs or world.ropes or world.schedules
        if len(joined.motion.h) and world.bodies and not tied:
            asked = self._asked(joined)
            for n, evidence in enumerate(copies):
                evidence.kept[CheckContinuity] = tuple((value[n], limit[n]) for value, limit in asked)

    def _asked(self, evidence: Evidence) -> tuple[Pair, Pair, Pair]:
        """How far off places, turns and sums of ways are, and by how much they may be, (T - 1, B) each."""
        strayed = self._strayed(evidence)
        going, turning = _driven(evidence)
        faster, spinning = _whirling(evidence)
        handed = self._handed_on(evidence)
        place = lengths(strayed), self._place_limit(evidence, handed, going + faster)
        turn = self._turns(evidence, handed, turning + spinning)
        if evidence.world.schedules:  # which push and lead bodies within an interval, too
            sets, h = between(evidence), evidence.motion.h[:, None]
            place, turn, going = (place[0], place[1] + h * sets[0]), (turn[0], turn[1] + h * sets[1]), going + sets[0]
        return place, turn, self._drift(evidence, strayed, going)

    @staticmethod
    def _strayed(evidence: Evidence) -> Floats:
        """Ways (..., T - 1, B, 3) less what the mean of both ends' velocities gives [m]."""
        motion = evidence.motion
        return np.asarray(np.diff(motion.com, axis=-3) - 0.5 * _added(motion.v) * motion.h[:, None, None])

    def _place_limit(self, evidence: Evidence, handed: Floats, driven: Floats) -> Floats:
        motion, h = evidence.motion, evidence.motion.h[:, None]
        # Within a frame the velocity may be anything between its ends, a body may fall and be caught, one that is hit
        # may hand it on, and a drive that is faster than the frames may have come and gone.
        pulled = np.where(motion.kinematic, 0.0, evidence.gravity * h + _pulled(evidence) + handed + driven)
        places = self._rounding(evidence)
        rounding = np.maximum(places[..., 1:, :], places[..., :-1, :])
        rounding = rounding + h * FLOAT32 * np.maximum(motion.speed[..., 1:, :], motion.speed[..., :-1, :])
        return np.asarray(h * (0.5 * _around(motion.v) + pulled) + rounding + self._by_hand(evidence))

    def _turns(self, evidence: Evidence, handed: Floats, driven: Floats) -> Pair:
        motion, h = evidence.motion, evidence.motion.h[:, None]
        q = motion.q[..., 3:]
        cosine = np.abs(np.einsum("...i,...i->...", q[..., 1:, :, :], q[..., :-1, :, :]))
        turned = 2.0 * np.arccos(np.clip(cosine, 0.0, 1.0))
        fastest = np.maximum(motion.rate[..., 1:, :], motion.rate[..., :-1, :])
        # A body that tips over an edge turns at most as g pulls its centre about it.
        pushed = (evidence.gravity * h + handed) / (motion.smallest / 2) + driven + _tipped(evidence)
        limit = h * (fastest + 0.5 * _around(motion.w) + np.where(motion.kinematic, 0.0, pushed)) + 1e-3
        return np.where(fastest * h > self.alias, 0.0, turned), limit

    def _drift(self, evidence: Evidence, strayed: Floats, driven: Floats) -> Pair:
        """How far places come from where velocities take them, from any of some moments to any later one.

        Of a smooth motion the trapezoidal rule's errors h^3 v'' / 12 add up to what its ends differ by, h^2 dv/dt / 12
        (Euler and Maclaurin), and steps of first order are off by dt / 2 of the change of velocity: neither grows with
        the run. What grows is as much as velocities bend from frame to frame, in blows, by twice the rule's error.
        """
        motion, h = evidence.motion, evidence.motion.h[:, None]
        change = lengths(np.diff(motion.v, axis=-3))
        ends = motion.late * lengths(np.ptp(motion.v, axis=-3)) + (h * change).max(axis=-2) / 6.0
        # What is set down settles by a step, also along a slope.
        ends = ends + self._rounding(evidence).max(axis=-2) + evidence.gravity * motion.dt**2
        ends = ends + np.where(_links(evidence), SHAKEN * lengths(strayed).max(axis=-2), 0.0)
        ends = (ends + self._by_hand(evidence).sum(axis=-2))[..., None, :]
        # A contact that flips from step to step tells of one phase of it, and the body stays.
        touched = motion.touched[..., 1:, :] | motion.touched[..., :-1, :]
        hides = np.where(touched, self.steps * evidence.gravity * motion.dt, 0.0)
        told = np.minimum(0.5 * lengths(_added(motion.v)), hides)
        unsure = np.cumsum(h * (_bends(motion.v) + driven + told), axis=-2)
        sums = np.cumsum(strayed, axis=-3)
        apart, limit = lengths(self._caught(evidence, sums)), unsure + ends
        for start in np.unique(np.linspace(0, len(h), self.starts, endpoint=False).astype(int))[1:]:
            before = slice(start - 1, start)
            off = lengths(self._caught(evidence, sums[..., start:, :, :] - sums[..., before, :, :]))
            most = unsure[..., start:, :] - unsure[..., before, :] + ends
            since, of = apart[..., start:, :], limit[..., start:, :]
            more = off * of > since * most
            since[...], of[...] = np.where(more, off, since), np.where(more, most, of)
        return apart, limit

    @staticmethod
    def _caught(evidence: Evidence, drift: Floats) -> Floats:
        """Drifts (T, B, 3) less one fall, g h^2 / 2 at most, that began and was caught between two frames.

        On a slope it goes aside, too, until friction has it: by no farther than it fell.
        """
        fallen = np.clip(-(drift @ evidence.up), 0.0, 0.5 * evidence.gravity * float(evidence.motion.h.max()) ** 2)
        fallen = np.where(evidence.motion.kinematic, 0.0, fallen)
        aside = drift + fallen[..., None] * evidence.up
        far = lengths(aside)
        left = np.maximum(far - fallen, 0.0) / np.maximum(far, 1e-300)
        return np.asarray(aside * left[..., None])

    def _rounding(self, evidence: Evidence) -> Floats:
        """What single precision leaves of places, (T, B) [m]."""
        return np.asarray(self.roundings * FLOAT32 * np.abs(evidence.motion.com).max(axis=-1))

    @staticmethod
    def _by_hand(evidence: Evidence) -> Floats:
        """What goes by hand adds each step's way to its place, and may round one way each time, (T - 1, B) [m]."""
        motion = evidence.motion
        count = motion.h[:, None] / max(motion.dt, 1e-9)
        far = np.abs(motion.com[..., 1:, :, :]).max(axis=-1)
        return np.where(motion.kinematic, 0.5 * count * FLOAT32 * far, 0.0)

    @staticmethod
    def _handed_on(evidence: Evidence) -> Floats:
        """The speed of the fastest body, where another may hit a body within an interval, (T - 1, B) [m/s].

        Or what hangs together with it: joints hand on at once what hits one link.
        """
        motion = evidence.motion
        fastest = np.maximum(motion.speed[..., 1:, :], motion.speed[..., :-1, :]).max(axis=-1, keepdims=True)
        meets = motion.meets.copy()
        for unit in np.unique(motion.unit[motion.jointed]):
            rows = np.flatnonzero(motion.unit == unit)
            meets[..., rows] = meets[..., rows].any(axis=-1, keepdims=True)
        handed: Floats = np.where(meets, fastest, 0.0)
        if evidence.world.stepped == "joints":  # a stop or a contact of one link catches the others within a step
            for unit in np.unique(motion.unit[motion.jointed]):
                rows = np.flatnonzero(motion.unit == unit)
                apart = np.linalg.norm(motion.v[:, rows, None] - motion.v[:, None, rows], axis=3).max(axis=2)
                handed[:, rows] = np.maximum(handed[:, rows], np.maximum(apart[1:], apart[:-1]))
        return handed

    def _worst(self, evidence: Evidence, value: Floats, limit: Floats, unit: str, verb: str, source: str) -> Finding:
        share = np.divide(value, limit, out=np.where(value > 0.0, np.inf, 0.0), where=limit > 0.0)
        fine = "turns" if unit == "rad" else "stays with" if "drift" in verb else "moves by"
        return strangest(
            self, evidence, value, limit, unit, share=share, limit_from=source, expected=0.0 if unit == "m" else None,
            story=f"{{prim}} {verb} {{value:.3g}} {unit} more than its velocity gives, at {{time:.3f}} s",
            fine=f"Every body {fine}{' by' if unit == 'rad' else ''} its own velocity", why="its pose is set by hand",
        )  # fmt: skip


def _pulled(evidence: Evidence) -> Floats:
    """By how much springs speed their bodies up at most in an interval, (..., T - 1, B) [m/s]."""
    motion, world = evidence.motion, evidence.world
    found = np.zeros(motion.reach.shape)
    for spring in world.springs:
        pull = np.abs(track_of_spring(evidence, spring).pull)
        for row in {evidence.index(guide.body) for guide in spring.path if guide.body is not None}:
            found[:, row] += motion.h * np.maximum(pull[1:], pull[:-1]) / motion.mass[row]
    return found


def _tipped(evidence: Evidence) -> Floats:
    """How fast bodies may have turned between two frames as something caught them, (..., T - 1, B) [rad/s].

    A box that lands on a corner turns till it lies, and may show a turning at neither frame. It came with m u^2 / 2 to
    what caught it, u what beside gravity changed its velocity, and no blow makes more of that: k w <= u, k its least
    radius of gyration.
    """
    motion = evidence.motion
    least = np.maximum(np.linalg.eigvalsh(motion.inertia)[..., 0], 1e-300)
    caught = lengths(motion.acceleration - motion.gravity) * motion.h[:, None]
    return np.asarray(caught * np.sqrt(motion.mass / least))


def _added(rate: Floats) -> Floats:
    """A rate (..., T, B, 3) at both ends of each interval, added, (..., T - 1, B, 3)."""
    return rate[..., 1:, :, :] + rate[..., :-1, :, :]


def _around(rate: Floats) -> Floats:
    """The greatest change of a rate (..., T, B, 3) over an interval or its neighbours, (..., T - 1, B)."""
    return _most_about(lengths(np.diff(rate, axis=-3)))


def _most_about(each: Floats) -> Floats:
    """The greatest of each and its neighbours in time, (..., T - 1, B)."""
    around = each.copy()
    around[..., 1:, :] = np.maximum(around[..., 1:, :], each[..., :-1, :])
    around[..., :-1, :] = np.maximum(around[..., :-1, :], each[..., 1:, :])
    return around


def _links(evidence: Evidence) -> NDArray[np.bool_]:
    """Bodies between two ball joints, (B,): links of a chain."""
    row = {body.prim: i for i, body in enumerate(evidence.world.bodies)}
    held = np.zeros(len(row), dtype=int)
    for joint in evidence.world.joints:
        for end in (joint.parent, joint.child):
            if joint.kind == "spherical" and end in row:
                held[row[end]] += 1
    return np.asarray(held >= 2)


def _bends(rate: Floats) -> Floats:
    """The greatest difference of second order of a rate (..., T, B, 3) about each interval, (..., T - 1, B)."""
    change = np.diff(rate, axis=-3)
    bend = lengths(np.diff(change, axis=-3))
    if not bend.shape[-2]:
        return lengths(change)
    return _most_about(np.concatenate([bend, bend[..., -1:, :]], axis=-2))


def _driven(evidence: Evidence) -> tuple[Floats, Floats]:
    """How fast bodies may have gone and turned by drives that are faster than the frames, (T - 1, B) each.

    As fast as the joint has gone; where it is known what the drive is set to, towards that, or as far as it swings.
    What swings by a radian or more between two frames may as well not have gone at all at the rates that they show.
    """
    motion, world = evidence.motion, evidence.world
    going, turning = (np.zeros((len(motion.h), len(world.bodies))) for _ in range(2))
    if not any(joint.drive for joint in world.joints):
        return going, turning
    laws_of = Laws(evidence)
    laws = laws_of.joints
    for joint in world.joints:
        track = None if joint.drive is None else evidence.joint(joint)
        if track is None or not laws[joint.prim]:
            continue
        known = np.all([law.known for law in laws[joint.prim]], axis=0)
        rate, swings = np.abs(np.diff(track.position)) / motion.h, ~known & _swings(evidence, joint)
        there = _towards(evidence, joint, track.position) | (swings & _reached(evidence, joint, track.position))
        rate = np.where(~known & there, rate, 0.0)
        goes = laws_of.rate(joint)
        rate = rate + np.where(swings, 0.5 * np.abs(goes[1:] + goes[:-1]), 0.0)
        child = evidence.index(joint.child)
        rows = np.flatnonzero(motion.unit == motion.unit[child])
        if joint.kind == "prismatic":
            going[:, rows] += rate[:, None]
            continue
        anchor = np.subtract(joint.child_anchor or (0.0, 0.0, 0.0), world.bodies[child].com)
        arms = np.linalg.norm(motion.com[:, rows] - motion.com[:, [child]], axis=2) + np.linalg.norm(anchor)
        going[:, rows] += rate[:, None] * np.maximum(arms[1:], arms[:-1])
        turning[:, rows] += rate[:, None]
    return going, turning


def _whirling(evidence: Evidence) -> tuple[Floats, Floats]:
    """How much faster bodies on joints and ropes may have gone and turned between frames as they whip, (T - 1, B) each.

    The velocities of a mechanism's bodies against each other turn by as much as its fastest link does, or its shortest
    rope, and so does what they hand on: by all of it where that is a radian or more.
    """
    motion, world = evidence.motion, evidence.world
    going, turning = (np.zeros((len(motion.h), len(world.bodies))) for _ in range(2))
    if not world.joints and not world.ropes:
        return going, turning
    rate = np.maximum(motion.rate[1:], motion.rate[:-1])
    hung: set[str | None] = {j.child for j in world.joints if j.parent is None}
    hung |= {guide.body for rope in world.ropes if any(end.body is None for end in rope.path) for guide in rope.path}
    for unit in np.unique(motion.unit[motion.jointed]):
        rows = np.flatnonzero(motion.unit == unit)
        v = motion.v[:, rows]
        apart = np.linalg.norm(v[:, :, None] - v[:, None], axis=3).max(axis=2)
        if any(world.bodies[row].prim in hung for row in rows):
            apart = np.maximum(apart, motion.speed[:, rows])
        apart, fastest = np.maximum(apart[1:], apart[:-1]), rate[:, rows].max(axis=1, keepdims=True)
        held = {world.bodies[row].prim for row in rows}
        ropes = [rope.length for rope in world.ropes if held & {guide.body for guide in rope.path}]
        swings = apart.max(axis=1, keepdims=True) / min(ropes, default=np.inf)
        share = np.minimum(np.maximum(fastest, swings) * motion.h[:, None], 1.0)
        going[:, rows], turning[:, rows] = share * apart, share * fastest
    return going, turning


def _towards(evidence: Evidence, joint: Joint, position: Floats) -> NDArray[np.bool_]:
    """Whether a driven joint comes nearer to what its drive is set to in each interval, as far as that is known."""
    drive = joint.drive
    set_ = bool(evidence.recording.metadata.get("controlled")) or drive_is_set(evidence.world, joint)
    if drive is None or not drive.told or drive.stiffness <= 0.0 or set_:
        return np.ones(len(position) - 1, dtype=bool)
    off = np.abs(position - drive.position)
    return np.asarray(off[1:] <= off[:-1])


def _swings(evidence: Evidence, joint: Joint) -> NDArray[np.bool_]:
    """Where a drive's stiffness makes its joint swing by a radian or more, (T - 1,)."""
    stiffness = 0.0 if joint.drive is None else joint.drive.stiffness
    loose = mobilities(evidence).get(joint.prim, np.inf) if stiffness else 0.0
    return np.asarray(stiffness * loose * evidence.motion.h**2 >= 1.0)


def _reached(evidence: Evidence, joint: Joint, position: Floats) -> NDArray[np.bool_]:
    """Whether a driven joint is as far from what its drive is set to as it may swing, (T - 1,).

    With what it held and how fast all that hangs together moved against itself, and about where it bears a load.
    """
    assert joint.drive is not None
    motion, stiffness = evidence.motion, max(joint.drive.stiffness, 1e-12)
    unit = np.flatnonzero(motion.unit == motion.unit[evidence.index(joint.child)])
    off, moving = np.abs(position - joint.drive.position), motion.kinetic[:-1, unit].sum(axis=1)
    rows, held = _hung(evidence, joint, unit)
    if not held:  # what it does as one brings no joint anywhere
        mass = motion.mass[unit]
        mean = np.einsum("b,tbi->ti", mass, motion.v[:-1, unit]) / mass.sum()
        moving = moving - 0.5 * mass.sum() * np.sum(mean**2, axis=1)
    far = np.ones(len(rows))
    if joint.kind == "revolute":
        far = lengths(motion.com[:, rows] - anchors_of(evidence, joint).below[:, None]).max(axis=0)
    sags = evidence.gravity * float(motion.mass[rows] @ far) / stiffness
    return np.asarray(off[1:] <= np.sqrt(off[:-1] ** 2 + 2.0 * np.maximum(moving, 0.0) / stiffness) + 2.0 * sags)


def _hung(evidence: Evidence, joint: Joint, rows: NDArray[np.intp]) -> tuple[NDArray[np.intp], bool]:
    """Which bodies of a mechanism hang on one of its joints, and whether the mechanism is held by something still.

    Those on the side that nothing holds; of two such the lighter one. All of them where the joint closes a loop.
    """
    motion, names = evidence.motion, [body.prim for body in evidence.world.bodies]
    links = [each for each in evidence.world.joints if each.child in {names[row] for row in rows}]
    still = {body.prim for body in evidence.world.bodies if body.kinematic}
    fixed = {each.child for each in links if each.parent is None or each.parent in still}
    near, grown = {joint.child}, True
    while grown:
        reached = {
            end for each in links if each.prim != joint.prim and near & {each.child, each.parent}
            for end in (each.child, each.parent) if end is not None
        }  # fmt: skip
        grown, near = not reached <= near, near | reached
    if joint.parent in near:
        return rows, bool(fixed)
    inside = np.array([names[row] in near for row in rows])
    held = [bool((fixed - ({joint.child} if joint.parent is None else set())) & near), bool(fixed - near)]
    held[1] |= joint.parent is None or joint.parent in still
    if held[0] == held[1]:
        light = motion.mass[rows[inside]].sum() <= motion.mass[rows[~inside]].sum()
        return (rows if held[0] else rows[inside if light else ~inside]), bool(fixed)
    return rows[~inside if held[0] else inside], bool(fixed)


CHECKS: Checks = (CheckContinuity,)
