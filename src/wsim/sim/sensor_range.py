"""Range scans: Newton's rays against the shapes of all worlds, as they stand when a scan is taken."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import newton
import numpy as np
import warp as wp
from numpy.typing import NDArray

from wsim.geometry.rotations import rotate
from wsim.sim.sensor_mount import Mount

if TYPE_CHECKING:
    from wsim.sim.model import Built

Floats = NDArray[np.float64]


class Range:
    """Reads one scan in W worlds.

    Args:
        built: The model.
        k: Which of the world's sensors it is.
        interval: Between samples [s].
        seeds: What each world's noise differs by.

    Attributes:
        spans: Whether a sample tells of the time before it.
        points: What the last scan of the first world met [m], in the world, (n, 3).
    """

    spans = False

    def __init__(self, built: Built, k: int, interval: float, seeds: Sequence[int]) -> None:
        self._mount = Mount(built, k)
        stated = self._mount.stated
        shape = len(stated), len(stated[0].elevations), len(stated[0].azimuths)
        self._shape, rays = shape, shape[1] * shape[2]
        self._rays = np.array([_directions(each.azimuths, each.elevations) for each in stated])  # (W, rays, 3)
        self._limits = np.array([[[each.nearest], [each.farthest]] for each in stated])  # (W, 2, 1)
        self._noise = np.array([[each.noise] for each in stated])
        self._random = self._mount.generators(built, seeds)
        self.points: Floats = np.zeros((0, 3))
        self._model = self._seen(built.model)
        with wp.ScopedDevice(built.model.device):
            self._worlds = wp.array(np.repeat(np.arange(shape[0], dtype=np.int32), rays), dtype=int)
            self._found = wp.zeros(shape[0] * rays, dtype=float)

    def _seen(self, model: Any) -> Any:
        """The model as the sensor sees it: with a hierarchy of shapes of its own, without those that carry it.

        That of the model itself is what its pictures are drawn by, which leave the glass out.
        """
        seen = copy.copy(model)
        if not model.shape_count:
            return seen
        flags = model.shape_flags.numpy().copy()
        if self._mount.bodies is not None:
            flags[np.isin(model.shape_body.numpy(), self._mount.bodies)] &= ~int(newton.ShapeFlags.VISIBLE)
        seen.shape_flags = wp.array(flags, dtype=int, device=model.device)
        seen.bvh_build_shapes(model.state())
        return seen

    def __call__(self, t: float, simulation: Any) -> dict[str, Floats]:
        """`distance` [m], (W, layers, rays): infinite where nothing is met between the nearest and the farthest."""
        place, turn = self._mount.frames(simulation.state)
        directions = rotate(turn[:, None, :], self._rays)
        origins = np.broadcast_to(place[:, None, :], directions.shape)
        if self._model.shape_count:
            device = self._model.device
            begin, along = (
                wp.array(part.reshape(-1, 3).astype(np.float32), dtype=wp.vec3, device=device)
                for part in (origins, directions)
            )
            self._model.bvh_refit_shapes(simulation.state)
            newton.intersect_ray(
                self._model, ray_origins=begin, ray_directions=along, ray_worlds=self._worlds, out_dist=self._found,
                fast_math=False,
            )  # fmt: skip
            true = self._found.numpy().astype(np.float64).reshape(directions.shape[:2])
        else:
            true = np.full(directions.shape[:2], -1.0)
        told = true
        if self._noise.any():
            told = true + self._noise * np.array([each.standard_normal(true.shape[1]) for each in self._random])
        met = (true >= 0.0) & (told >= self._limits[:, 0]) & (told <= self._limits[:, 1])
        self.points = (origins + told[..., None] * directions)[0, met[0]]
        return {"distance": np.where(met, told, np.inf).reshape(self._shape)}


def _directions(azimuths: Sequence[float], elevations: Sequence[float]) -> Floats:
    """Unit vectors in the sensor's frame, a layer after the other, (rays, 3)."""
    up, across = (each.reshape(-1) for each in np.meshgrid(elevations, azimuths, indexing="ij"))
    return np.stack([np.cos(up) * np.cos(across), np.cos(up) * np.sin(across), np.sin(up)], axis=1)
