"""Millions of particles into a Newton model, past the builder's Python lists."""

from __future__ import annotations

import newton
import numpy as np
import warp as wp


def set_particles(
    model: newton.Model,
    position: np.ndarray,
    mass: float,
    pressure: np.ndarray | float = 0.0,
    world: np.ndarray | int = 0,
) -> newton.State:
    """Replace a finalized model's particles, and return a state of them.

    Args:
        model: Its builder needs one particle at least.
        position: Positions [m], shape (n, 3).
        mass: Of each [kg].
        pressure: Of each [Pa].
        world: Of each.
    """
    n, state = len(position), model.state()
    with wp.ScopedDevice(model.device):
        model.particle_count = n
        model.particle_q = wp.array(position.astype(np.float32), dtype=wp.vec3)
        model.particle_mass = wp.full(n, mass, dtype=float)
        model.particle_world = wp.array(np.broadcast_to(world, n).astype(np.int32), dtype=int)
        state.particle_q, state.particle_qd = wp.clone(model.particle_q), wp.zeros(n, dtype=wp.vec3)
        state.sph.pressure = wp.array(np.broadcast_to(pressure, n).astype(np.float32), dtype=float)
    return state
