"""How the programs of a run are run."""

from __future__ import annotations

from dataclasses import dataclass, field

from wsim import sim
from wsim.program.sandbox import Limits
from wsim.program.sandbox.isolation import choose


@dataclass
class Settings:
    """How a program is run."""

    device: str = "auto"
    params: dict[str, float] = field(default_factory=dict)
    draws: dict[str, float] = field(default_factory=dict)  # set on the stage that is built (`wsim.runs.draws`)
    isolation: str = "auto"
    pictures: bool = True
    caption: bool = False  # time, and what is judged, below the video's pictures
    time_step: float | None = None  # [s]
    seed: int = 0  # of `wsim.sim.perturb`; 0: as the stage states
    verify: bool = False  # an accepted world is run again, computed more finely
    build_timeout: float = 30.0  # [s]
    build_memory: int = 4 * 2**30  # [bytes]

    def limits(self) -> Limits:
        """The sandbox's limits."""
        return Limits(wall_seconds=self.build_timeout, memory_bytes=self.build_memory)

    def check(self) -> None:
        """Look whether the sandbox and the device asked for are here, before a run's folder is made.

        Raises:
            UserError: If one is not.
        """
        choose(self.isolation)
        if self.device not in ("auto", "cpu"):
            sim.known_device(self.device)
