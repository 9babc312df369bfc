"""Stage → Newton model of one or many worlds → stepped → recorded."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from wsim.sim.simulation import Simulation, SimulationResult

__all__ = ["Simulation", "SimulationResult"]


def __getattr__(name: str) -> object:
    """Load the simulation when it is first used: it brings Newton and Warp."""
    if name in __all__:
        from wsim.sim import simulation

        return getattr(simulation, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
