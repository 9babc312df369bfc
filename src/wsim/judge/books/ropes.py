"""What ropes pull: along their way, with one tension, and only where they are taut.

A rope without mass and friction has one tension T >= 0 all along, and pulls each body by -T dL/dx, x its place and
turning and L the length of the rope's way: at each end of a straight strand by T towards its other end. Over an
interval its impulse is the mean of that, by Simpson's rule over both frames and the pose between them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.ropes import path_length, strands
from wsim.geometry.rotations import conjugate, multiply, rotate
from wsim.judge.books.forces import shared
from wsim.judge.books.phases import COARSEST
from wsim.judge.evidence.motion import FLOAT32
from wsim.scene.cord_paths import moving_stops

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.books.forces import Columns
    from wsim.judge.evidence.evidence import Evidence
    from wsim.scene.world import Rope

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]

SLACK = 1e-4  # of its length, and single precision: a way that is shorter by less may be a taut rope's


@dataclass(frozen=True)
class Pull:
    """A rope's pull through time, for a tension of one, on the bodies of some rows."""

    rows: NDArray[np.intp]  # (n,), each once
    first: Floats  # in each interval at its first frame, on each of them about its centre of mass, (T - 1, n, 6)
    last: Floats  # at its last
    mean: Floats  # over it
    taut: Bools  # (T - 1,), whether it may pull there
    jerks: Bools  # whether it comes taut or goes slack within


class Ropes:
    """The impulses of all ropes of a world in any interval between frames."""

    def __init__(self, evidence: Evidence) -> None:
        self._evidence, self._motion = evidence, evidence.motion
        self._row = {body.prim: i for i, body in enumerate(evidence.world.bodies)}
        self.ropes = evidence.world.ropes

    @cached_property
    def pulls(self) -> list[Pull]:
        """Of each rope."""
        return [self._pull(rope) for rope in self.ropes]

    @cached_property
    def arms(self) -> Floats:
        """How far from its centre of mass ropes pull at each body, at most, (B,) [m]."""
        far = np.zeros(len(self._row))
        for pull in self.pulls:
            push, turn = (np.linalg.norm(pull.mean[..., part], axis=2) for part in (slice(3), slice(3, 6)))
            np.maximum.at(far, pull.rows, (turn / np.maximum(push, 1e-9)).max(axis=0, initial=0.0))
        return far

    def columns(self, k: int) -> list[Columns]:
        """What may act between frames k and k + 1; what pulls at several bodies does so with one strength."""
        found = []
        for pull in self.pulls:
            if pull.taut[k] and len(pull.rows):
                ways = (pull.first, pull.mean, pull.last) if pull.jerks[k] else (pull.mean,)
                found += [shared(pull.rows, way[k]) for way in ways]
        return found

    def error(self) -> Floats:
        """How much of each body's force and torque the mean of a pull may miss, (T - 1, B, 2) [N, N m].

        A tension that changes by dT over an interval while its direction changes by dG leaves dT dG / 12; and a step
        pulls as the rope was at its start, or will be at its end, not as it goes meanwhile.
        """
        motion, step = self._motion, self._motion.step or min(self._motion.dt, COARSEST)
        late = 0.5 * np.minimum(step / motion.h, 1.0)
        found = np.zeros((len(motion.h), len(self._row), 2))
        for pull, tension in zip(self.pulls, self._tensions().T, strict=True):
            change = np.abs(np.gradient(tension)) if len(tension) > 1 else np.abs(tension)
            turned = np.linalg.norm((pull.last - pull.first).reshape(*pull.mean.shape[:2], 2, 3), axis=3)
            found[:, pull.rows] += (change / 12.0 + late * np.abs(tension))[:, None, None] * turned
        return found

    def _tensions(self) -> Floats:
        """About what each rope bears in each interval, if bodies were pulled by ropes alone, (T - 1, ropes) [N]."""
        motion, pulls = self._motion, self.pulls
        root = np.sqrt(motion.mass)[:, None]
        wanted = root * (motion.acceleration - motion.gravity)
        found = np.zeros((len(motion.h), len(pulls)))
        for k in range(len(motion.h) if pulls else 0):
            matrix = np.zeros((len(motion.mass), 3, len(pulls)))
            for n, pull in enumerate(pulls):
                if pull.taut[k]:
                    matrix[pull.rows, :, n] = pull.mean[k, :, :3] / root[pull.rows]
            found[k] = np.linalg.lstsq(matrix.reshape(-1, len(pulls)), wanted[k].ravel(), rcond=1e-9)[0]
        return found

    # ---- one rope
    def _pull(self, rope: Rope) -> Pull:
        held = sorted({self._row[guide.body] for guide in rope.path if guide.body is not None})
        rows = np.array([row for row in held if not self._motion.kinematic[row]], dtype=np.intp)
        q, com = self._evidence.body_q, self._motion.com
        at_frames = self._generalised(rope, rows, q, com)
        between = self._generalised(rope, rows, *self._halfway())
        first, last = at_frames[:-1], at_frames[1:]
        mean = (first + 4.0 * between + last) / 6.0
        way = path_length(moving_stops(rope.path, self.poses(rope, q)))
        rate = self.rate(rope)
        rounding = 8.0 * FLOAT32 * np.abs(q[..., :3]).max(initial=0.0)
        long = rope.length * (1.0 - SLACK) - rounding
        near = way >= long
        # It may have come taut on the way, or gone slack.
        come, left = way[:-1] + rate[:-1] * self._motion.h, way[1:] - rate[1:] * self._motion.h
        taut = near[:-1] | near[1:] | (np.maximum(come, left) >= long)
        return Pull(rows, first, last, mean, taut, taut & ~(near[:-1] & near[1:]))

    def _generalised(self, rope: Rope, rows: NDArray[np.intp], q: Floats, com: Floats) -> Floats:
        """-dL/dx of each body at each pose (T, B, 7), (T, n, 6)."""
        place = {int(row): n for n, row in enumerate(rows)}
        found = np.zeros((len(q), len(rows), 6))
        for strand in strands(moving_stops(rope.path, self.poses(rope, q))):
            for stop, at, along in zip(
                strand.stops, (strand.start, strand.end), (strand.along, -strand.along), strict=True
            ):
                body = rope.path[stop].body
                if body is not None and (n := place.get(self._row[body])) is not None:
                    found[:, n, :3] += along
                    found[:, n, 3:] += np.cross(at - com[:, self._row[body]], along)
        return found

    def rate(self, rope: Rope) -> Floats:
        """How fast its way gets longer, (T,) [m/s]."""
        motion = self._motion
        rows = np.array(sorted({self._row[guide.body] for guide in rope.path if guide.body is not None}), dtype=np.intp)
        pull = self._generalised(rope, rows, self._evidence.body_q, motion.com)
        found: Floats = -np.einsum("tni,tni->t", pull, np.concatenate([motion.v, motion.w], axis=2)[:, rows])
        return found

    def poses(self, rope: Rope, q: Floats) -> dict[str, Floats]:
        """Poses (T, 7) of the bodies on its way, of those of all (T, B, 7)."""
        held = {guide.body for guide in rope.path if guide.body is not None}
        return {prim: q[:, self._row[prim]] for prim in held}

    def _halfway(self) -> tuple[Floats, Floats]:
        """Poses (T - 1, B, 7) and centres of mass halfway between frames, by places and velocities at both."""
        motion, q = self._motion, self._evidence.body_q
        h = motion.h[:, None, None]
        com = 0.5 * (motion.com[1:] + motion.com[:-1]) - h * np.diff(motion.v, axis=0) / 8.0
        near = np.where(np.sum(q[1:, :, 3:] * q[:-1, :, 3:], axis=2, keepdims=True) < 0.0, -1.0, 1.0)
        turn = q[:-1, :, 3:] + near * q[1:, :, 3:]
        turn /= np.linalg.norm(turn, axis=2, keepdims=True)
        angle = -h * np.diff(motion.w, axis=0) / 8.0
        small = np.concatenate([0.5 * angle, np.ones((*angle.shape[:2], 1))], axis=2)
        turn = multiply(small / np.linalg.norm(small, axis=2, keepdims=True), turn)
        own = rotate(conjugate(q[:-1, :, 3:]), motion.com[:-1] - q[:-1, :, :3])
        return np.concatenate([com - rotate(turn, own), turn], axis=2), com
