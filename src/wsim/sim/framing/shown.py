"""What a view shows of its subjects: in frame, how large, how much of their motion; by projection, nothing is drawn."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import line_of_sight
from wsim.scene.following import as_at_start
from wsim.sim.framing.rooms import Walls

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsim.scene.world import Camera, World
    from wsim.sim.framing.motion import Motion
    from wsim.sim.framing.subjects import Subject

Array = np.ndarray
SPECK, LARGE = 0.01, 0.12  # of the picture's width: what is no more is not seen, what is more is seen well
USEFUL = 12.0 / 640.0  # of the picture's width: what is less is not told from others
DOT = 1e-4  # likewise, of what is marked in a view of all the way
IN = 0.9  # of a subject's points that are in the picture when it is: all of a box's corners
EDGE = 0.97  # of half of the picture: what is farther off is at its edge, and counts as out of it
MISSED = 12  # power of the share of stills that show their subjects: one of six that does not takes nine tenths
NEAR = 3.0  # times its distance, that a camera which goes along is above ground that shows how it goes
MOVING = 0.7  # of what a view is worth that shows no motion, of one that shows all of it


@dataclass(frozen=True)
class Scenario:
    """What views are held against: a world's subjects, at some frames, which matter more or less.

    Attributes:
        world: What the stage states.
        motion: At those frames.
        subjects: Likewise.
        weight: Of each frame, (F,), 1 together.
        stills: Which frames stills are taken of, (F,).
    """

    world: World
    motion: Motion
    subjects: Sequence[Subject]
    weight: Array
    stills: Array

    @cached_property
    def walls(self) -> Walls:
        """What stands between."""
        return Walls.of(self.world)

    @property
    def shares(self) -> Array:
        """Weight of each subject, (S,), 1 together."""
        weights = np.array([subject.weight for subject in self.subjects])
        return np.asarray(weights / weights.sum())


@dataclass(frozen=True)
class Shown:
    """What a view shows.

    Attributes:
        inside: (F, S) share of each subject's points that are in the picture.
        size: (F, S) the longer edge of its box in the picture, in widths of the picture.
        box: (F, S, 4) that box, left, top, right and bottom, in halves of the picture from its middle, cut at its
            edges.
        motion: Share of the subjects' motion that is across the picture.
    """

    inside: Array
    size: Array
    box: Array
    motion: float

    @property
    def seen(self) -> Array:
        """(F, S) whether a subject is in the picture, and no speck."""
        return np.asarray((self.inside >= IN) & (self.size >= USEFUL))

    @property
    def ever(self) -> Array:
        """(S,) whether any of a subject is in the picture at any time."""
        return np.asarray((self.inside > 0.0).any(axis=0))

    def worth(self, scenario: Scenario, hidden: Array | float = 0.0) -> float:
        """How good the view is, of 1.

        Args:
            scenario: That it is of.
            hidden: (S,) share of each subject that others hide.
        """
        size = np.log(np.maximum(self.size, 1e-9) / SPECK) / math.log(LARGE / SPECK)
        value = self.inside**3 * np.clip(size, 0.0, 1.0)  # what is cut off is hardly seen
        there = (1.0 - np.asarray(hidden)) ** 2
        main = np.array([subject.main for subject in scenario.subjects])
        in_stills = self.seen[scenario.stills][:, main].mean() * np.broadcast_to(there, main.shape)[main].mean()
        each = scenario.weight @ value * there
        return float(each @ scenario.shares) * float(in_stills) ** MISSED * (1.0 - MOVING + MOVING * self.motion)

    def worth_of_all(self, scenario: Scenario, hidden: Array | float = 0.0) -> float:
        """How good it is as the view of all the way, in which things may be as small as they have to be, of 1."""
        main = np.array([subject.main for subject in scenario.subjects])
        size = np.log(np.maximum(self.size[:, main], 1e-9) / DOT) / math.log(LARGE / DOT)
        value = self.inside[:, main] ** 3 * np.clip(size, DOT, 1.0)
        there = (1.0 - np.broadcast_to(hidden, main.shape)[main]) ** 2
        all_in = float((scenario.weight @ (self.inside[:, main] >= IN)).mean()) ** MISSED
        return float((scenario.weight @ value * there).mean()) * all_in * (1.0 - MOVING + MOVING * self.motion)


def shown(camera: Camera, scenario: Scenario) -> Shown:
    """What a camera shows of a scenario."""
    points = [_as_seen(camera, scenario, subject.points) for subject in scenario.subjects]
    starts = np.cumsum([0, *(each.shape[1] for each in points[:-1])])
    eye = np.array(camera.eye)
    right, ahead = line_of_sight(camera.eye, camera.target, camera.up)
    local = np.concatenate(points, axis=1) - eye
    depth = local @ ahead
    half = math.tan(math.radians(camera.fov) / 2.0)
    tall = half * camera.height / camera.width
    before = np.maximum(depth, 1e-6)
    x, y = local @ right / (half * before), local @ np.cross(ahead, right) / (tall * before)
    there = (depth > 0.0) & (np.abs(x) <= EDGE) & (np.abs(y) <= EDGE)
    counts = np.array([each.shape[1] for each in points])
    inside = np.add.reduceat(there, starts, axis=1, dtype=float) / counts
    x, y = np.clip(x, -1.0, 1.0), np.clip(y, -1.0, 1.0)
    box = np.stack(
        [
            np.minimum.reduceat(x, starts, axis=1), np.minimum.reduceat(y, starts, axis=1),
            np.maximum.reduceat(x, starts, axis=1), np.maximum.reduceat(y, starts, axis=1),
        ], axis=2,
    )  # fmt: skip
    across, down = box[..., 2] - box[..., 0], (box[..., 3] - box[..., 1]) * camera.height / camera.width
    size = np.where(inside > 0.0, 0.5 * np.maximum(across, down), 0.0)
    return Shown(inside, size, box, _motion(points, scenario, ahead))


def passes(camera: Camera, scenario: Scenario, ground: float) -> float:
    """Of a camera that goes along, on which share of its way anything shows that it goes: what stands, or the ground.

    Args:
        camera: That follows a body.
        scenario: With that body.
        ground: Height of the ground [m].
    """
    row = [body.prim for body in scenario.world.bodies].index(camera.follows or "")
    place = scenario.motion.body_q[:, row, :3]
    way = np.linalg.norm(np.gradient(place, axis=0), axis=1) if len(place) > 1 else np.zeros(1)
    rise = place[:, 2] - scenario.world.bodies[row].position[2]
    low = camera.eye[2] + rise - ground <= NEAR * math.dist(camera.eye, camera.target)
    standing = np.array([not (each.able or each.main) for each in scenario.subjects])
    by = low | (shown(camera, scenario).inside[:, standing] > 0.0).any(axis=1)
    return float(way @ by / way.sum()) if way.sum() > 0.0 else 1.0


def _as_seen(camera: Camera, scenario: Scenario, points: Array) -> Array:
    if camera.follows is None:
        return points
    row = [body.prim for body in scenario.world.bodies].index(camera.follows)
    return as_at_start(camera, scenario.world, scenario.motion.body_q[:, row], points)


def _motion(points: Sequence[Array], scenario: Scenario, ahead: Array) -> float:
    """Share of the way of the main subjects that is across the picture, and not along the line of sight."""
    across = whole = 0.0
    for subject, seen in zip(scenario.subjects, points, strict=True):
        if subject.main:
            way = seen.mean(axis=1)
            way = way - way.mean(axis=0)
            own = subject.centre - subject.centre.mean(axis=0)
            scale = subject.weight / max(subject.size, 1e-9) ** 2
            whole += scale * float((own**2).sum())
            across += scale * float((way**2).sum() - ((way @ ahead) ** 2).sum())
    return min(1.0, math.sqrt(across / whole)) if whole > 1e-12 else 1.0
