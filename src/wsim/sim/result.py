"""How the run of a simulation went."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path


@dataclass
class SimulationResult:
    """How a run went. `problems` are what makes it fail; empty means that it can be judged."""

    problems: list[str]
    frames: int
    steps: int
    dt: float  # [s]
    wall_seconds: float
    particles: int
    boundary_particles: int
    device: str
    stills: list[Path] = field(default_factory=list)
    seconds: dict[str, float] = field(default_factory=dict)  # by phase [s]
    compiled: dict[str, float] = field(default_factory=dict)  # by module, several at once [s]
