"""Where sensors are: their frames on their bodies, in all worlds."""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wsim.geometry.rotations import multiply, rotate
from wsim.sim.joint_arrays import in_every_world

if TYPE_CHECKING:
    from wsim.sim.model import Built

Floats = NDArray[np.float64]


class Mount:
    """A sensor's frame in W worlds.

    Args:
        built: The model.
        k: Which of the world's sensors it is.

    Attributes:
        stated: What each world states of it, (W,).
        bodies: The model's indices of the bodies that it is fixed to, (W,); None: it is fixed to the world.
        position: Its place in their frames [m], (W, 3).
        rotation: Its turn in them, (W, 4), xyzw.
    """

    def __init__(self, built: Built, k: int) -> None:
        worlds = max(1, built.model.world_count)
        self.stated: list[Any] = [built.world_of(w).sensors[k] for w in range(worlds)]
        self.bodies: NDArray[np.int64] | None = None
        body = self.stated[0].body
        if body is not None:
            row = [each.prim for each in built.world.bodies].index(body)
            self.bodies = in_every_world(built.bodies[[row]], worlds, built.model.body_count)[:, 0]
        self.position = np.array([each.position for each in self.stated])
        self.rotation = np.array([each.rotation for each in self.stated])

    def generators(self, built: Built, seeds: Sequence[int]) -> list[np.random.Generator]:
        """Of its noise, one for each world: by its own seed or the stage's, the world's among `seeds`, and its name."""
        return [
            np.random.default_rng(
                [built.world_of(w).seed if each.seed is None else each.seed, seeds[w], zlib.crc32(each.prim.encode())]
            )
            for w, each in enumerate(self.stated)
        ]

    def frames(self, state: Any) -> tuple[Floats, Floats]:
        """Places [m] and turns of the sensor in the world, (W, 3) and (W, 4)."""
        if self.bodies is None:
            return self.position, self.rotation
        pose = state.body_q.numpy()[self.bodies].astype(np.float64)
        return pose[:, :3] + rotate(pose[:, 3:], self.position), multiply(pose[:, 3:], self.rotation)
