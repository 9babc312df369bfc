"""What ties bodies together: joints by the ways that they hold, springs by their line, ropes along their way."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import rotate
from wsim.judge.books.forces import Columns, holds
from wsim.judge.books.gears import Gears
from wsim.judge.books.laws import Laws
from wsim.judge.books.ropes import Ropes
from wsim.judge.books.touching import WORLD
from wsim.judge.evidence import compound
from wsim.judge.evidence.joints import AXES, anchors_of, broken, track_of

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from wsim.judge.books.struck import Ends
    from wsim.judge.evidence.evidence import Evidence
    from wsim.scene.world import Joint, Spring

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]

TORN = 1.01  # of its strength: what a solver's iterations and single precision may let it bear
NEAR_STOP = 0.02  # [rad or m]: a stop that is nearer may push


@dataclass(frozen=True)
class Acting:
    """A joint, and in which intervals something acts along its own motion, (T - 1,) each."""

    joint: Joint
    free: Bools  # a drive or dry friction that the frames do not tell
    most: Floats  # what they may give there at most [N or N m]
    low: Bools  # the stop at its lower end, which pushes up
    high: Bools
    gone: Bools  # it is broken


class Ties:
    """The impulses of all joints, springs and ropes of a world in any interval between frames."""

    def __init__(self, evidence: Evidence) -> None:
        self._evidence = evidence
        world = evidence.world
        self._row = {body.prim: i for i, body in enumerate(world.bodies)}
        self.laws = Laws(evidence)
        self.ropes = Ropes(evidence)
        self._moves: dict[str, list[compound.Placed | None]] = {}
        self._gears = Gears(evidence)
        self._joints = [acting for joint in world.joints if (acting := self._acting(joint))]

    def _acting(self, joint: Joint) -> Acting | None:
        track = track_of(self._evidence, joint)
        if track is None:
            return None
        laws, none = self.laws.joints[joint.prim], np.zeros(len(self._evidence.time) - 1, dtype=bool)
        free = none.copy()
        most = np.zeros(len(none))
        for law in laws:
            free |= ~law.known
            most += law.beside
        untold = joint.prim in self._gears.untold
        if joint.kind == "spherical":  # no law for what turns a ball joint, nor where its stop is
            untold |= joint.drive is not None or joint.friction > 0.0 or joint.high is not None
        if untold:
            free[:], most[:] = True, np.inf
        at, h = track.position, self._evidence.motion.h
        near = NEAR_STOP + 2.0 * np.abs(np.diff(at)) + self._evidence.gravity * h**2
        lowest, highest = np.minimum(at[1:], at[:-1]), np.maximum(at[1:], at[:-1])
        low = none if joint.low is None else lowest <= joint.low + near
        high = none if joint.high is None else highest >= joint.high - near
        return Acting(joint, free, most, low, high, broken(self._evidence, joint)[:-1])

    @property
    def any(self) -> bool:
        """Whether there are any."""
        return bool(self._joints or self._evidence.world.springs or self.ropes.ropes)

    @cached_property
    def arms(self) -> Floats:
        """How far from its centre of mass each body is held, at most, (B,) [m]."""
        world = self._evidence.world
        far = np.zeros(len(world.bodies))
        held = [(joint.parent, joint.parent_anchor) for joint in world.joints]
        held += [(joint.child, joint.child_anchor) for joint in world.joints]
        held += [
            (guide.body, guide.position) for spring in world.springs for guide in (spring.path[0], spring.path[-1])
        ]
        for prim, place in held:
            if prim in self._row and place is not None:
                row = self._row[prim]
                far[row] = max(far[row], float(np.linalg.norm(np.subtract(place, world.bodies[row].com))))
        return np.maximum(far, self.ropes.arms)

    @property
    def jerks(self) -> list[tuple[Iterable[int], Bools]]:
        """Rows of bodies, and when a stop or a rope may jerk them, (T - 1,)."""
        row = self._row
        stops = [([row.get(each.joint.parent or "", WORLD), row[each.joint.child]], each.low | each.high)
                 for each in self._joints]  # fmt: skip
        return [*stops, *((pull.rows, pull.jerks) for pull in self.ropes.pulls)]

    def columns(self, k: int, ends: Ends) -> list[Columns]:
        """What may act between frames k and k + 1, as bodies are at two poses."""
        found = [columns for joint in self._joints if not joint.gone[k] for columns in self._joint(joint, k, ends)]
        springs = zip(self._evidence.world.springs, self.laws.springs, strict=True)
        found += [self._spring(spring, ends) for spring, law in springs if not law.known[k]]
        return found + self.ropes.columns(k) + self._gears.columns(k)

    def _joint(self, acting: Acting, k: int, ends: Ends) -> list[Columns]:
        joint, acts = acting.joint, bool(acting.free[k])
        one, two = self._row.get(joint.parent or "", WORLD), self._row[joint.child]
        anchors = [_place(ends, two, joint.child_anchor or (0.0, 0.0, 0.0), end) for end in (0, 1)]
        arms = _arm(ends, one, anchors), _arm(ends, two, anchors)
        if joint.kind == "compound":
            return [self._compound(joint, (one, two), anchors, arms, k)]
        axes = _axes(ends, one, joint)
        along = AXES[joint.axis]
        across = np.delete(axes, along, axis=0)
        none = np.zeros((0, 3))
        forces, torques = axes, none
        if joint.kind == "fixed" or (joint.kind == "spherical" and acts):
            torques = axes
        elif joint.kind == "revolute":
            torques = across
        elif joint.kind == "prismatic":
            forces, torques = across, axes
        found = [replace(holds(one, two, arms, forces, torques), cap=_strength(joint, len(forces), len(torques)))]
        own = (axes[along][None], none) if joint.kind == "prismatic" else (none, axes[along][None])
        if acts and joint.kind in ("revolute", "prismatic"):
            found.append(replace(holds(one, two, arms, *own), cap=acting.most[k : k + 1]))
        for way, stops in ((1.0, acting.low[k]), (-1.0, acting.high[k])):
            if stops and (not acts or np.isfinite(acting.most[k])):
                stop = holds(one, two, arms, way * own[0], way * own[1])
                found.append(replace(stop, both=np.zeros(1, dtype=bool)))
        return found

    def _compound(
        self, joint: Joint, rows_of: tuple[int, int], anchors: list[Floats], arms: tuple[Floats, Floats], k: int
    ) -> Columns:
        """All forces and torques that give no power to a motion that nothing pushes along."""
        free = np.zeros((0, 6))
        if joint.prim not in self._moves:
            self._moves[joint.prim] = compound.placed(joint, anchors_of(self._evidence, joint))
        for move, at in zip(joint.moves, self._moves[joint.prim], strict=True):
            if at is None or move.acts:
                continue
            axis = at.axis[k] + at.axis[k + 1]
            axis /= np.linalg.norm(axis)
            if move.kind == "prismatic":
                way = [axis, np.zeros(3)]
            else:  # seen from the child's anchor
                arm = 0.5 * (anchors[0] + anchors[1] - at.point[k] - at.point[k + 1])
                way = [np.cross(axis, arm), axis]
            free = np.concatenate([free, np.concatenate(way)[None]])
        _, size, rows = np.linalg.svd(free)
        held = rows[int((size > 1e-6).sum()) :]
        moments = [held[:, 3:] + np.cross(arm, held[:, :3]) for arm in arms]
        on_one, on_two = (np.concatenate([held[:, :3], moment], axis=1) for moment in moments)
        one, two = (np.full(len(held), row, dtype=np.intp) for row in rows_of)
        return Columns(one, two, -on_one, on_two, np.ones(len(held), dtype=bool))

    def _spring(self, spring: Spring, ends: Ends) -> Columns:
        guides = spring.path[0], spring.path[-1]
        rows = [self._row.get(guide.body or "", WORLD) for guide in guides]
        at = [[_place(ends, row, guide.position, end) for end in (0, 1)]
              for row, guide in zip(rows, guides, strict=True)]  # fmt: skip
        line = np.mean(at[1], axis=0) - np.mean(at[0], axis=0)
        line /= max(float(np.linalg.norm(line)), 1e-12)
        arms = _arm(ends, rows[0], at[0]), _arm(ends, rows[1], at[1])
        return holds(rows[0], rows[1], arms, line[None], np.zeros((0, 3)))


def _strength(joint: Joint, forces: int, torques: int) -> Floats:
    """The most that it passes on along each of its ways as a mean, (f + t,) [N], [N m]: with more it breaks."""
    most = [np.inf if each is None else TORN * each for each in (joint.break_force, joint.break_torque)]
    return np.repeat(most, (forces, torques))


def _place(ends: Ends, row: int, position: tuple[float, float, float], end: int) -> Floats:
    """Where a point of a body is at one of two poses, (3,) [m]."""
    if row < 0:
        return np.array(position)
    q = ends.q[end, row]
    place: Floats = q[:3] + rotate(q[3:], np.array(position))
    return place


def _arm(ends: Ends, row: int, places: list[Floats]) -> Floats:
    """From a body's centre of mass to a point, halfway between two poses."""
    if row < 0:
        return np.zeros(3)
    arm: Floats = 0.5 * (places[0] - ends.com[0, row] + places[1] - ends.com[1, row])
    return arm


def _axes(ends: Ends, one: int, joint: Joint) -> Floats:
    """The parent anchor's axes in the world, halfway, as rows (3, 3)."""
    own = rotate(np.array(joint.parent_turn), np.eye(3))
    if one < 0:
        return np.asarray(own)
    axes = rotate(ends.q[0, one, 3:], own) + rotate(ends.q[1, one, 3:], own)
    found: Floats = axes / np.maximum(np.linalg.norm(axes, axis=1, keepdims=True), 1e-12)
    return found
