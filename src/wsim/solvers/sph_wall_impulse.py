"""What an SPH fluid gives to all that stands still, world by world."""

from __future__ import annotations

import math

import numpy as np
import warp as wp

from wsim.kernels.sph.boundary import add_wall_impulse, sum_wall_lanes

LEAST_LANES = 32  # that sums over particles are split into


class WallImpulse:
    """The impulse on the walls of each world since it was last taken.

    Args:
        world_first: First fluid particle of each world, and past the last one's; Newton's worlds follow one another.
    """

    def __init__(self, world_first: list[int]) -> None:
        own = [max(LEAST_LANES, math.isqrt(count)) for count in np.diff(world_first).tolist()]
        self._world_first, self._lanes = wp.array(world_first, dtype=int), wp.array(own, dtype=int)
        self._sums = wp.zeros((len(own), max(own)), dtype=wp.vec3d)
        self._impulse = wp.zeros(len(own), dtype=wp.vec3d)

    def add(self, force: wp.array, dt: float, world_first: wp.array | None = None) -> None:
        """Add particles' forces on the walls [N] over a step of `dt` [s].

        Args:
            force: Of each particle, in the order of worlds.
            dt: Length of the step.
            world_first: First of each world's, where they are not the fluid's.
        """
        first = self._world_first if world_first is None else world_first
        wp.launch(sum_wall_lanes, dim=self._sums.shape, inputs=[force, first, self._lanes], outputs=[self._sums])
        wp.launch(add_wall_impulse, dim=len(self._impulse), inputs=[self._sums, dt], outputs=[self._impulse])

    def take(self) -> np.ndarray:
        """It, (W, 3) [N s]; counts from zero again."""
        impulse: np.ndarray = self._impulse.numpy().astype(np.float64)
        self._impulse.zero_()
        return impulse
