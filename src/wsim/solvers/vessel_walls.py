"""The walls of all vessels of a model, as particles, and where nothing else has any."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from wsim.geometry.filled import Samples
from wsim.geometry.rotations import rotate
from wsim.solvers.vessels import Vessel, own_label

Array = np.ndarray
CLEAR = 0.9  # spacings between what is a vessel's wall and what is not


@dataclass(frozen=True)
class _Wall:
    """One vessel's in one world: `own` in its frame, of a body or, -1, the world's; `tree` where they start."""

    world: int
    body: int
    own: Samples
    tree: cKDTree


class VesselWalls:
    """The walls of each vessel in each of its worlds.

    What of anything else is in them at the start is no particle: through a thin wall it would count twice.

    Args:
        model: The `newton.Model`.
        vessels: What holds fluid beside tanks.
        spacing: Between particles [m].

    Attributes:
        bodies: Those that are vessels.

    Raises:
        ValueError: If a vessel has no hollow.
    """

    def __init__(self, model: Any, vessels: Sequence[Vessel], spacing: float) -> None:
        self._clear = CLEAR * spacing
        self._shapes = frozenset().union(*(vessel.shapes for vessel in vessels))
        poses = model.body_q.numpy().astype(float) if model.body_count else np.zeros((0, 7))
        self._walls: list[_Wall] = []
        for vessel in vessels:
            own = vessel.walls(spacing)
            for world, body in vessel.homes(model):
                place = own.position if body < 0 else rotate(poses[body, 3:], own.position) + poses[body, :3]
                self._walls.append(_Wall(world, body, own, cKDTree(place)))
        self.bodies = frozenset(wall.body for wall in self._walls if wall.body >= 0)

    def made_of(self, label: Any) -> bool:
        """Whether the model's shape of a label is a wall, or a convex part of one."""
        return own_label(str(label)) in self._shapes

    def of(self, world: int, body: int = -1) -> list[Samples]:
        """Walls of a body in its frame, or of what stands still in a world."""
        return [wall.own for wall in self._walls if (wall.world, wall.body) == (world, body)]

    def beside(self, samples: Samples, world: int, body: int = -1, pose: Array | None = None) -> Samples:
        """Samples of something, but for those that are in the walls of the vessels of its world at the start.

        Args:
            samples: In the frame of `body`, at `pose` (7,) [m, xyzw]; in the world's where it stands still.
            world: The world that it is in.
            body: That it belongs to, whose own walls are not asked.
            pose: Of its frame; None is the world's.
        """
        place = samples.position if pose is None else rotate(pose[3:], samples.position) + pose[:3]
        keep = np.ones(len(place), dtype=bool)
        for wall in self._walls:
            if wall.world == world and (body < 0 or wall.body != body):
                keep &= wall.tree.query(place)[0] > self._clear
        return Samples(samples.position[keep], samples.volume[keep])
