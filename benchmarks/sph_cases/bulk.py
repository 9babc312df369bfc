"""Millions of particles into a Newton model, past the builder's Python lists."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import newton
import numpy as np
import warp as wp


def set_particles(
    model: newton.Model,
    position: np.ndarray,
    mass: float,
    pressure: np.ndarray | float = 0.0,
    world: np.ndarray | int = 0,
) -> Any:
    """Replace a finalized model's particles, and return a state of them.

    Args:
        model: Its builder needs one particle at least.
        position: Positions [m], shape (n, 3).
        mass: Of each [kg].
        pressure: Of each [Pa].
        world: Of each.

    Returns:
        What `SolverSPH.step` reads and writes of a `newton.State`.
    """
    n = len(position)
    with wp.ScopedDevice(model.device):
        model.particle_count = n
        model.particle_q = wp.array(position.astype(np.float32), dtype=wp.vec3)
        model.particle_mass = wp.full(n, mass, dtype=float)
        model.particle_world = wp.array(np.broadcast_to(world, n).astype(np.int32), dtype=int)
        model.particle_qd = model.particle_inv_mass = model.particle_radius = model.particle_flags = None
        whole = model.state() if model.body_count else None
        return SimpleNamespace(
            particle_q=wp.clone(model.particle_q),
            particle_qd=wp.zeros(n, dtype=wp.vec3),
            sph=SimpleNamespace(pressure=wp.array(np.broadcast_to(pressure, n).astype(np.float32), dtype=float)),
            body_q=None if whole is None else whole.body_q,
            body_qd=None if whole is None else whole.body_qd,
            body_f=None if whole is None else whole.body_f,
        )
