"""What makes a world's fluid worthless, in words."""

from __future__ import annotations

from collections.abc import Iterable

import newton
import numpy as np
import warp as wp

from wsim.kernels.sph.status import inspect
from wsim.solvers.sph_search import ParticleSearch


def inspected(search: ParticleSearch, state: newton.State) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of each world the first particle that is not finite, the largest speed [m/s], and how many are outside."""
    count, worlds, fluid = search.fluid.count, search.world_count, search.fluid
    with wp.ScopedDevice(state.particle_q.device):
        broken = wp.full(worlds, count, dtype=int)
        fastest2, outside = wp.zeros(worlds, dtype=float), wp.zeros(worlds, dtype=int)
        wp.launch(
            inspect,
            dim=count,
            inputs=[search.grid, fluid.world, state.particle_q, state.particle_qd, state.sph.pressure, fluid.stage],
            outputs=[broken, fastest2, outside],
        )
    return broken.numpy(), np.sqrt(fastest2.numpy()), outside.numpy()


def in_words(found: Iterable[tuple[int, float, int]], count: int, sound: float, room: int) -> list[str]:
    """Of each world a text that says what to change, empty where its fluid is sound.

    Args:
        found: Of each world its first particle that is not finite, `count` if there is none; the largest speed [m/s];
            and the most neighbours of a particle, where there are more than fit, else 0.
        count: Fluid particles of a world.
        sound: The speed of sound [m/s].
        room: Neighbours that fit.
    """
    return [_fault(world, *each, count, sound, room) for world, each in enumerate(found)]


def _fault(world: int, particle: int, speed: float, most: int, count: int, sound: float, room: int) -> str:
    if particle < count:
        return (
            f"SolverSPH: fluid particle {particle} of world {world} is not finite; "
            "use a smaller time step or a higher speed of sound"
        )
    if speed > sound:
        return (
            f"SolverSPH: a fluid particle moves at {speed:.4g} m/s, faster than sound at speed_of_sound = "
            f"{sound:.4g} m/s: the fluid is not nearly incompressible; use a speed of sound ten times the "
            "largest expected speed"
        )
    if most:
        return (
            f"SolverSPH: {most} neighbours where {room} fit: the fluid has collapsed; "
            "use a smaller time step or a higher speed of sound"
        )
    return ""
