"""What a fluid's push on bodies follows from, beside the fluid: settings of the method, and the solids' particles."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from wsim.recording.solids import SolidParticles, Solids

if TYPE_CHECKING:
    from wsim.sim.model import Built
    from wsim.solvers.solver_sph import SolverSPH


def method_of(built: Built, solver: SolverSPH, w: int) -> dict[str, Any]:
    """Settings of the SPH, and how many particles each body of world w has."""
    config = solver.config
    counts = np.diff(solver.bodies.sampled.first)[_bodies(built, solver, w)].tolist()
    return {
        "smoothing_length": config.smoothing_length,
        "artificial_viscosity": config.artificial_viscosity,
        "laminar_factor": config.laminar_factor,
        "background_pressure": config.background_pressure,
        "body_particles": dict(zip((body.prim for body in built.world.bodies), counts, strict=True)),
    }


def solids_of(built: Built, solver: SolverSPH, w: int) -> Solids:
    """Particles of all that the fluid of world w meets."""
    first, last = solver.search.walls.world_first[w : w + 2]
    walls = SolidParticles(solver.wall_position.numpy()[first:last], solver.wall_volume.numpy()[first:last])
    place, volume, starts = (a.numpy() for a in (solver.bodies.local, solver.bodies.volume, solver.bodies.first))
    found = {}
    for body, k in zip(built.world.bodies, _bodies(built, solver, w), strict=True):
        part = slice(int(starts[k]), int(starts[k + 1]))
        if part.stop > part.start:
            found[body.prim] = SolidParticles(place[part], volume[part])
    return Solids(walls, found)


def _bodies(built: Built, solver: SolverSPH, w: int) -> Any:
    """The solver's numbers of world w's bodies."""
    return built.bodies + w * ((len(solver.bodies.first) - 1) // solver.world_count)
