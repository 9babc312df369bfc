"""Checks of springs and ropes: a spring pulls as it is stretched, and a rope gets no longer than it is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.checks.check import Check, Checks
from wsim.judge.evidence.cords import length_of_rope, track_of_spring
from wsim.judge.verdict import RepairTarget

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding
    from wsim.scene.world import Body

    Floats = NDArray[np.float64]


@dataclass
class CheckRopes(Check):
    """A rope holds: its way is never longer than it is."""

    share: float = 0.005  # of its length

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each rope."""
        found = []
        for rope in evidence.world.ropes:
            over = length_of_rope(evidence, rope) - rope.length
            limit = self.share * rope.length
            wrong = over > limit
            at = int(np.argmax(wrong)) if wrong.any() else int(np.argmax(over))
            value = float(max(over.max(), 0.0))
            found.append(
                self.measured(
                    f"{rope.prim} is stretched by {value * 1e3:.3g} mm, {value / rope.length:.2%} of its length",
                    value, limit, "m", fine=f"{rope.prim} holds", prim=rope.prim, time=float(evidence.time[at]),
                    expected=0.0, limit_from=f"{self.share:g} of its {rope.length:.3g} m",
                    target=RepairTarget(kind="program", prim=rope.prim, why="it does not hold what pulls on it"),
                )
            )  # fmt: skip
        return found


@dataclass
class CheckSprings(Check):
    """What hangs on springs alone is moved by gravity and their forces, and by nothing else."""

    share: float = 0.02  # of the largest of gravity and the springs' pull on it
    coarsest: float = 1.0  # omega times the time between frames, beyond which they do not show an oscillation

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each body that springs hold, and neither joint nor rope, where it touches nothing."""
        motion, world = evidence.motion, evidence.world
        unknown = evidence.recording.metadata.get("controlled") and evidence.recording.applied_impulse is None
        tied = {end for joint in world.joints for end in (joint.parent, joint.child)}
        tied |= {guide.body for rope in world.ropes for guide in rope.path}
        if unknown or len(motion.h) == 0 or world.fluids:
            return []
        found = []
        for body in world.bodies:
            pulled = any(guide.body == body.prim for spring in world.springs for guide in spring.path)
            if pulled and body.prim not in tied and not body.kinematic:
                found += self._held(evidence, body)
        return found

    def _held(self, evidence: Evidence, body: Body) -> list[Finding]:
        motion, i = evidence.motion, evidence.index(body.prim)
        force, stiffness, damping = np.zeros((len(evidence.time), 3)), 0.0, 0.0
        for spring in evidence.world.springs:
            track = track_of_spring(evidence, spring)
            for guide, sign in zip(spring.path, (1.0, -1.0), strict=True):
                if guide.body == body.prim:
                    force += sign * track.pull[:, None] * track.along
                    stiffness, damping = stiffness + spring.stiffness, damping + spring.damping
        # Four times: a point off the centre of mass yields as that much less mass, and the other end moves, too.
        rate = np.sqrt(4.0 * stiffness / body.mass) + 4.0 * damping / body.mass
        coarse = rate * motion.h
        free = ~(motion.touched[1:, i] | motion.touched[:-1, i]) & (coarse < self.coarsest)
        free &= ~evidence.motion.near(i, np.arange(len(motion.h)))
        if not free.any():
            return []
        # The mean of both ends of an interval is off by at most a twelfth of the square of the phase it spans.
        pull = 0.5 * (force[1:] + force[:-1]) / body.mass
        most = np.linalg.norm(force, axis=1).max() / body.mass
        off = np.linalg.norm(motion.acceleration[:, i] - motion.gravity - pull, axis=1)
        limit = self.share * max(evidence.gravity, float(most), 1e-3) + most * coarse**2 / 12.0
        k = int(np.argmax(np.where(free, off / limit, 0.0)))
        story = f"{body.prim} is accelerated by {off[k]:.3g} m/s^2 besides gravity and its springs, at"
        return [
            self.measured(
                f"{story} {evidence.time[k + 1]:.3f} s",
                float(off[k]), float(limit[k]), "m/s^2", fine=f"{body.prim} moves as its springs pull it",
                prim=body.prim, time=float(evidence.time[k + 1]), expected=0.0,
                limit_from=f"{self.share:g} of gravity or of the springs' largest pull, and what frames do not show",
                target=RepairTarget(kind="program", prim=body.prim, why="its springs do not pull as they are stated"),
            )
        ]  # fmt: skip


CHECKS: Checks = (CheckRopes, CheckSprings)
