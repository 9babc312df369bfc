"""Stage → Newton model of one or many worlds → stepped → recorded. Newton takes seconds to load: see `wsim.door`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsim.door import door

if TYPE_CHECKING:
    from wsim.sim.collect import collect as collected
    from wsim.sim.devices import known_device, pick_device, start_warp
    from wsim.sim.result import SimulationResult
    from wsim.sim.simulation import Simulation
    from wsim.sim.stills import Stills, cameras_of
    from wsim.sim.warmup import fill as fill_cache

__all__ = [
    "Simulation",
    "SimulationResult",
    "Stills",
    "cameras_of",
    "collected",
    "fill_cache",
    "known_device",
    "pick_device",
    "start_warp",
]

__getattr__ = door(
    __name__,
    {
        "Simulation": "simulation",
        "SimulationResult": "result",
        "Stills": "stills",
        "cameras_of": "stills",
        "collected": "collect.collect",
        "fill_cache": "warmup.fill",
        "known_device": "devices",
        "pick_device": "devices",
        "start_warp": "devices",
    },
)
