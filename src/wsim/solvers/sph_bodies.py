"""The particles of bodies: they go where their bodies go, which feel what pushes on them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import warp as wp

from wsim.kernels.sph import boundary as boundary_kernels
from wsim.solvers.shapes import Boundary
from wsim.solvers.sph_wall_impulse import LEAST_LANES


class BodyParticles:
    """Particles of all bodies of a model, on its device.

    Args:
        model: The `newton.Model`.
        sampled: They, at the start.

    Attributes:
        count: How many.
        local: Where, in their bodies' frames [m].
        volume: Of each [m^3].
        owner: Body of each.
        first: First particle of each body, and past the last one's.
        position: Where they are [m].
        velocity: Theirs [m/s].
        wrench: Of the fluid on each body: force [N], torque about its centre of mass [N m], world frame.
    """

    def __init__(self, model: Any, sampled: Boundary) -> None:
        self._model, self.sampled = model, sampled
        self.count = len(sampled.local)
        self.local = wp.array(sampled.local, dtype=wp.vec3)
        self.volume = wp.array(sampled.volume, dtype=float)
        self.owner = wp.array(sampled.owner, dtype=int)
        self.first = wp.array(sampled.first, dtype=int)
        self.position = wp.zeros(self.count, dtype=wp.vec3)
        self.velocity = wp.zeros(self.count, dtype=wp.vec3)
        # As many lanes as each has particles of the largest body to add up, and add_body_wrench lanes.
        self._lanes = max(LEAST_LANES, math.isqrt(int(np.diff(sampled.first).max(initial=0))))
        self._lane_wrench = wp.zeros((model.body_count, self._lanes), dtype=wp.spatial_vector)
        self.wrench = wp.zeros(model.body_count, dtype=wp.spatial_vector)

    def move(self, grid: Any, state: Any) -> None:
        """Take the particles to where the bodies of a state are."""
        if self.count:
            wp.launch(
                boundary_kernels.move_bodies,
                dim=self.count,
                inputs=[grid, self.local, self.owner, state.body_q, state.body_qd, self._model.body_com],
                outputs=[self.position, self.velocity],
            )

    def push(self, grid: Any, force: wp.array, body_q: wp.array, body_f: wp.array) -> None:
        """Add up the forces on the particles of each body, at poses `body_q`, and add the wrenches to `body_f`."""
        if not self.count:
            return
        wp.launch(
            boundary_kernels.sum_body_lanes,
            dim=(self._model.body_count, self._lanes),
            inputs=[grid, self.first, force, self.local, body_q, self._model.body_com],
            outputs=[self._lane_wrench],
        )
        wp.launch(
            boundary_kernels.add_body_wrench,
            dim=self._model.body_count,
            inputs=[self._lane_wrench],
            outputs=[self.wrench, body_f],
        )
