"""What the worlds of a simulation with fluid leave, frame by frame, as arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.recording.recording import FluidTrack
from wsim.sim.measure import measure_fluids

if TYPE_CHECKING:
    from wsim.sim.simulation import Simulation
    from wsim.solvers.solver_sph import SolverSPH

Array = np.ndarray


class FluidTracks:
    """Particles of every world, what they give to the walls, and what went wrong.

    Args:
        simulation: At its start.
        solver: Its fluid's.
        time: (T,) [s], filled in as frames are taken.

    Attributes:
        tracks: Of each world, by the fluid's prim.
        scalars: By the name that a recording has for it, (W, T).
        wall_impulse: On all that stands still since the frame before, (W, T, 3) [N s].
    """

    def __init__(self, simulation: Simulation, solver: SolverSPH, time: Array) -> None:
        self._simulation, self._solver, self._time = simulation, solver, time
        self.tracks = [
            {prim: _empty(time, part.stop - part.start, solver.openings is not None) for prim, part in fluids.items()}
            for fluids in simulation.built.fluids
        ]
        self._faults = [""] * len(self.tracks)
        self.scalars: dict[str, Array] = {}
        self.wall_impulse = np.zeros((len(self.tracks), len(time), 3), dtype=np.float32)

    def take(self, frame: int) -> None:
        """Keep the present state as a frame."""
        simulation, built = self._simulation, self._simulation.built
        worlds = range(len(self.tracks))
        for w, (fluids, told) in enumerate(measure_fluids(built, simulation.state, self._solver, worlds)):
            for prim, made in fluids.items():
                kept = self.tracks[w][prim]
                kept.position[frame], kept.velocity[frame], kept.density[frame] = (
                    made.position, made.velocity, made.density,
                )  # fmt: skip
                if kept.present is not None and made.present is not None:
                    kept.present[frame] = made.present
                    for each in (kept.position, kept.velocity, kept.density):
                        each[frame, ~made.present] = np.nan
            for name, number in told.items():
                self.scalars.setdefault(name, np.zeros((len(self.tracks), len(self._time))))[w, frame] = number
        self.wall_impulse[:, frame] = self._solver.take_wall_impulse()
        self._faults = [a or b for a, b in zip(self._faults, self._solver.faults(simulation.state), strict=True)]

    @property
    def problems(self) -> list[list[str]]:
        """What went wrong in each world's fluid first."""
        return [[fault] if fault else [] for fault in self._faults]


def _empty(time: Array, count: int, comes: bool) -> FluidTrack:
    shape = len(time), count
    position, velocity = (np.zeros((*shape, 3), dtype=np.float32) for _ in range(2))
    present = np.zeros(shape, dtype=bool) if comes else None
    return FluidTrack(time, position, velocity, np.zeros(shape, dtype=np.float32), present)
