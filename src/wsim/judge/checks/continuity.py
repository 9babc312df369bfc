"""The check of poses against velocities: from frame to frame, and summed over the run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.books.laws import Laws
from wsim.judge.checks.check import Check, Checks
from wsim.judge.checks.strangest import strangest
from wsim.judge.evidence.motion import FLOAT32

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding
    from wsim.scene.world import Joint

    Floats = NDArray[np.float64]


@dataclass
class CheckContinuity(Check):
    """A body goes from frame to frame by its own velocity: it does not jump, does not turn at once, does not drift."""

    alias: float = 2.0  # [rad] a frame: beyond, a rotation cannot be told from its shorter way round
    roundings: float = 8.0  # of float32, in a position: one a step, half of them of one sign
    starts: int = 8  # moments from which a drift is summed
    steps: float = 2.0  # of gravity in a time step, that a contact may be late by

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """The place and the turn that the velocity explains least, and the farthest drift."""
        motion = evidence.motion
        if len(motion.h) == 0 or len(motion.mass) == 0:
            return []
        strayed = np.diff(motion.com, axis=0) - 0.5 * (motion.v[1:] + motion.v[:-1]) * motion.h[:, None, None]
        going, turning = _driven(evidence)
        found = [self._places(evidence, strayed, going), self._turns(evidence, turning)]
        # What has jumped is not where its velocities take it, either.
        return [*found, self._drift(evidence, strayed, going)] if found[0].passed else found

    def _places(self, evidence: Evidence, strayed: Floats, driven: Floats) -> Finding:
        motion, h = evidence.motion, evidence.motion.h[:, None]
        # Within a frame the velocity may be anything between its ends, a body may fall and be caught, one that is hit
        # may hand it on, and a drive that is faster than the frames may have come and gone.
        pulled = np.where(motion.kinematic, 0.0, evidence.gravity * h + self._handed_on(evidence) + driven)
        limit = h * (0.5 * _around(motion.v) + pulled) + self._rounding(evidence)[1:] + self._added(evidence)
        source = "half the velocity's change about then, g h, and the speed of what may hit or drive it, over h"
        return self._worst(evidence, np.linalg.norm(strayed, axis=2), limit, "m", "jumps by", source)

    def _turns(self, evidence: Evidence, driven: Floats) -> Finding:
        motion, h = evidence.motion, evidence.motion.h[:, None]
        q = evidence.body_q[:, :, 3:]
        cosine = np.abs(np.einsum("tbi,tbi->tb", q[1:], q[:-1]))
        turned = 2.0 * np.arccos(np.clip(cosine, 0.0, 1.0))
        rate = np.linalg.norm(motion.w, axis=2)
        fastest = np.maximum(rate[1:], rate[:-1])
        half = np.array([evidence.solid(i).smallest / 2 for i in range(len(motion.mass))])
        # A body that tips over an edge turns at most as g pulls its centre about it.
        pushed = (evidence.gravity * h + self._handed_on(evidence)) / half + driven
        limit = h * (fastest + 0.5 * _around(motion.w) + np.where(motion.kinematic, 0.0, pushed)) + 1e-3
        turned = np.where(fastest * h > self.alias, 0.0, turned)
        source = "its fastest rate then, half the rate's change, and g h / r or a hit's v / r, over the frame's h"
        return self._worst(evidence, turned, limit, "rad", "turns by", source)

    def _drift(self, evidence: Evidence, strayed: Floats, driven: Floats) -> Finding:
        """How far places come from where velocities take them, from any of some moments to any later one.

        Of a smooth motion the trapezoidal rule's errors h^3 v'' / 12 add up to what its ends differ by, h^2 dv/dt / 12
        (Euler and Maclaurin), and steps of first order are off by dt / 2 of the change of velocity: neither grows with
        the run. What grows is as much as velocities bend from frame to frame, in blows, by twice the rule's error.
        """
        motion, h = evidence.motion, evidence.motion.h[:, None]
        change = np.linalg.norm(np.diff(motion.v, axis=0), axis=2)
        ends = motion.late * np.linalg.norm(np.ptp(motion.v, axis=0), axis=1) + (h * change).max(axis=0) / 6.0
        # What is set down settles by a step, also along a slope.
        ends = ends + self._rounding(evidence).max(axis=0) + evidence.gravity * motion.dt**2
        ends = ends + self._added(evidence).sum(axis=0)
        # A contact that flips from step to step tells of one phase of it, and the body stays.
        told = 0.5 * np.linalg.norm(motion.v[1:] + motion.v[:-1], axis=2)
        hides = np.where(motion.touched[1:] | motion.touched[:-1], self.steps * evidence.gravity * motion.dt, 0.0)
        unsure = np.cumsum(h * (_bends(motion.v) + driven + np.minimum(told, hides)), axis=0)
        sums = np.cumsum(strayed, axis=0)
        apart, limit = np.linalg.norm(self._caught(evidence, sums), axis=2), unsure + ends
        for start in np.unique(np.linspace(0, len(h), self.starts, endpoint=False).astype(int))[1:]:
            off = np.linalg.norm(self._caught(evidence, sums[start:] - sums[start - 1]), axis=2)
            most = unsure[start:] - unsure[start - 1] + ends
            more = off * limit[start:] > apart[start:] * most
            apart[start:], limit[start:] = np.where(more, off, apart[start:]), np.where(more, most, limit[start:])
        source = "what its ends and its blows leave of the trapezoidal rule, and steps of first order of its change"
        return self._worst(evidence, apart, limit, "m", "has drifted by", source)

    @staticmethod
    def _caught(evidence: Evidence, drift: Floats) -> Floats:
        """Drifts (T, B, 3) less one fall, g h^2 / 2 at most, that began and was caught between two frames.

        On a slope it goes aside, too, until friction has it: by no farther than it fell.
        """
        fallen = np.clip(-(drift @ evidence.up), 0.0, 0.5 * evidence.gravity * float(evidence.motion.h.max()) ** 2)
        fallen = np.where(evidence.motion.kinematic, 0.0, fallen)
        aside = drift + fallen[..., None] * evidence.up
        far = np.linalg.norm(aside, axis=-1)
        left = np.maximum(far - fallen, 0.0) / np.maximum(far, 1e-300)
        return np.asarray(aside * left[..., None])

    def _rounding(self, evidence: Evidence) -> Floats:
        """What single precision leaves of places, (T, B) [m]."""
        return np.asarray(self.roundings * FLOAT32 * np.abs(evidence.motion.com).max(axis=2))

    @staticmethod
    def _added(evidence: Evidence) -> Floats:
        """What goes by hand adds each step's way to its place, and may round one way each time, (T - 1, B) [m]."""
        motion = evidence.motion
        count = motion.h[:, None] / max(motion.dt, 1e-9)
        return np.where(motion.kinematic, 0.5 * count * FLOAT32 * np.abs(motion.com[1:]).max(axis=2), 0.0)

    @staticmethod
    def _handed_on(evidence: Evidence) -> Floats:
        """The speed of the fastest body, where another may hit a body within an interval, (T - 1, B) [m/s]."""
        motion = evidence.motion
        fastest = np.maximum(motion.speed[1:], motion.speed[:-1]).max(axis=1, keepdims=True)
        handed: Floats = np.where(motion.meets, fastest, 0.0)
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


def _around(rate: Floats) -> Floats:
    """The greatest change of a rate (T, B, 3) over an interval or its neighbours, (T - 1, B)."""
    return _most_about(np.linalg.norm(np.diff(rate, axis=0), axis=2))


def _most_about(each: Floats) -> Floats:
    """The greatest of each and its neighbours, along the first axis."""
    around = each.copy()
    around[1:] = np.maximum(around[1:], each[:-1])
    around[:-1] = np.maximum(around[:-1], each[1:])
    return around


def _bends(rate: Floats) -> Floats:
    """The greatest difference of second order of a rate (T, B, 3) about each interval, (T - 1, B)."""
    change = np.diff(rate, axis=0)
    bend = np.linalg.norm(np.diff(change, axis=0), axis=2)
    if not len(bend):
        return np.linalg.norm(change, axis=2)
    return _most_about(np.concatenate([bend, bend[-1:]]))


def _driven(evidence: Evidence) -> tuple[Floats, Floats]:
    """How fast bodies may have gone and turned by drives that are faster than the frames, (T - 1, B) each.

    As fast as the joint has gone; where it is known what the drive is set to, towards that alone.
    """
    motion, world = evidence.motion, evidence.world
    going, turning = np.zeros((len(motion.h), len(motion.mass))), np.zeros((len(motion.h), len(motion.mass)))
    if not any(joint.drive for joint in world.joints):
        return going, turning
    laws = Laws(evidence).joints
    for joint in world.joints:
        track = None if joint.drive is None else evidence.joint(joint)
        if track is None or joint.prim not in laws:
            continue
        rate = np.where(laws[joint.prim].known, 0.0, np.abs(np.diff(track.position)) / motion.h)
        rate = np.where(_towards(evidence, joint, track.position), rate, 0.0)
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


def _towards(evidence: Evidence, joint: Joint, position: Floats) -> NDArray[np.bool_]:
    """Whether a driven joint comes nearer to what its drive is set to in each interval, as far as that is known."""
    drive = joint.drive
    if drive is None or not drive.told or drive.stiffness <= 0.0 or evidence.recording.metadata.get("controlled"):
        return np.ones(len(position) - 1, dtype=bool)
    off = np.abs(position - drive.position)
    return np.asarray(off[1:] <= off[:-1])


CHECKS: Checks = (CheckContinuity,)
