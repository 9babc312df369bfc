"""What a sweep is asked for, as data: it lies in the sweep's folder, and a sweep goes on from there."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from wsim.sweep.axis import Axis
from wsim.sweep.candidate import Candidate
from wsim.sweep.sampling import Point, sample


class Spec(BaseModel):
    """What is run.

    Attributes:
        programs: Files in the sweep's folder; each is run with each point.
        axes: What candidates differ in.
        points: Points that were given instead of drawn.
        method: How points are drawn.
        samples: How many points are drawn.
        seed: Of the draw.
        repeats: Worlds for each point: the first as the stage states it, the others each with a seed.
        device: Where worlds are run.
        time_step: Upper bound of the step [s]; None: chosen.
        isolation: Of the programs.
        patience: Seconds after which a candidate is given up [s].
    """

    model_config = ConfigDict(extra="forbid")

    programs: list[str] = Field(default=["program.py"], min_length=1)
    axes: list[Axis] = Field(default_factory=list)
    points: list[Point] = Field(default_factory=list)
    method: Literal["sobol", "latin", "random", "grid"] = "sobol"
    samples: int = Field(default=16, ge=1, le=1_000_000)
    seed: int = Field(default=0, ge=0)
    repeats: int = Field(default=1, ge=1, le=10_000)
    device: str = "cpu"
    time_step: float | None = None
    isolation: str = "auto"
    patience: float = Field(default=600.0, gt=0.0)

    def candidates(self) -> list[Candidate]:
        """All worlds: every program as it stands, then with each point, in the order in which they are drawn."""
        drawn = self.points or (sample(self.axes, self.method, self.samples, self.seed) if self.axes else [])
        cases = [
            (program, point, seed)
            for point in [{}, *drawn]
            for program in self.programs
            for seed in range(self.repeats)
        ]
        return [
            Candidate(number=number, params=point, seed=seed, program=program)
            for number, (program, point, seed) in enumerate(cases)
        ]
