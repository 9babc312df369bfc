"""What a sweep is asked for, as data: it lies in the sweep's folder, and a sweep goes on from there."""

from __future__ import annotations

from collections.abc import Sequence

from pydantic import BaseModel, ConfigDict, Field

from wsim.sweep.axis import Axis
from wsim.sweep.candidate import Candidate
from wsim.sweep.draw import Draw
from wsim.sweep.sampling import Method, Point, sample

MOST = 10_000_000  # candidates of a sweep, which one machine holds and ranks
TOGETHER = 1024  # worlds at once on a CUDA device; fewer where its memory holds fewer


class Spec(BaseModel):
    """What is run.

    Attributes:
        programs: Files in the sweep's folder; each is run with each point.
        patched: Which of them are patches of another one of them: what of.
        lacks: Parameters that a program does not have: it is run without them, and once where nothing else differs.
        axes: What candidates differ in.
        draws: What is drawn for each candidate; without axes and points, `samples` of them differ in that alone.
        points: Points that were given instead of drawn.
        method: How points are drawn; "cma" searches for the one with the most room to the limit.
        samples: How many points are drawn; of a search, at most about as many. 0: the programs as they stand alone.
        seed: Of the draw.
        repeats: Worlds for each point: the first as the stage states it, the others each with a seed.
        device: Where worlds are run.
        time_step: Upper bound of the step [s]; None: chosen.
        isolation: Of the programs.
        batch: The least number of points of a search that run side by side.
        worlds: Worlds that are simulated at once; 0: one by one on a CPU, `TOGETHER` on a CUDA device.
        patience: Seconds after which a candidate is given up [s].
    """

    model_config = ConfigDict(extra="forbid")

    programs: list[str] = Field(default=["program.py"], min_length=1)
    patched: dict[str, str] = Field(default_factory=dict)
    lacks: dict[str, list[str]] = Field(default_factory=dict)
    axes: list[Axis] = Field(default_factory=list)
    draws: list[Draw] = Field(default_factory=list)
    points: list[Point] = Field(default_factory=list)
    method: Method = "sobol"
    samples: int = Field(default=16, ge=0, le=1_000_000)
    seed: int = Field(default=0, ge=0)
    repeats: int = Field(default=1, ge=1, le=10_000)
    device: str = "cpu"
    time_step: float | None = None
    isolation: str = "auto"
    batch: int = Field(default=1, ge=1, le=100_000)
    worlds: int = Field(default=0, ge=0, le=100_000)
    patience: float = Field(default=600.0, gt=0.0)

    @property
    def count(self) -> int:
        """Candidates in all; of a search, at most about as many."""
        if self._once:
            return len(self._cases([{}, *self._drawn()])) * self.repeats
        return (1 + self._points) * self.each

    @property
    def parameters(self) -> list[Axis]:
        """Every parameter that is varied, those that go with others too."""
        return [each for axis in self.axes for each in axis.parameters]

    @property
    def together(self) -> int:
        """Worlds that are simulated at once, where they are of one topology."""
        return self.worlds or (TOGETHER if self.device.startswith("cuda") else 1)

    @property
    def each(self) -> int:
        """Candidates for each point."""
        return len(self.programs) * self.repeats

    @property
    def _points(self) -> int:
        if self.points or (self.axes and self.method in ("grid", "saltelli")):
            return len(self._drawn())
        return self.samples if self.axes or self.draws else 0

    def candidates(self) -> list[Candidate]:
        """All worlds: every program as it stands, then with each point, in the order in which they are drawn."""
        return self.of([{}, *self._drawn()], 0)

    def of(self, points: Sequence[Point], first: int) -> list[Candidate]:
        """Every program with each of some points; they are numbered from `first`."""
        cases = [(*case, seed) for case in self._cases(points) for seed in range(self.repeats)]
        return [
            Candidate(number=number, params=point, draws=self._draws(number), seed=seed, program=program)
            for number, (point, program, seed) in enumerate(cases, start=first)
        ]

    @property
    def _once(self) -> bool:
        """Whether what is the same as one before it is left out: the same would come of it. Searches and Saltelli's
        design count on the places of their points."""
        if self.draws or (self.method in ("cma", "saltelli") and not self.points):
            return False
        return bool(self.points or self.lacks) or all(axis.values for axis in self.axes)

    def _cases(self, points: Sequence[Point]) -> list[tuple[Point, str]]:
        """Every program with each of some points, as far as it has their parameters."""
        cases = [(self._own(point, program), program) for point in points for program in self.programs]
        if not self._once:
            return cases
        first: dict[object, tuple[Point, str]] = {}
        for point, program in cases:
            first.setdefault((program, *point.items()), (point, program))
        return list(first.values())

    def _own(self, point: Point, program: str) -> Point:
        """What a program has of a point."""
        lacking = self.lacks.get(program)
        return {name: value for name, value in point.items() if name not in lacking} if lacking else point

    def _draws(self, number: int) -> dict[str, float]:
        """What is drawn for a candidate; nothing for the programs as they stand, which come first."""
        if number < self.each:
            return {}
        return {draw.name: draw.at(self.seed, number, index) for index, draw in enumerate(self.draws)}

    def _drawn(self) -> list[Point]:
        if self.points or not self.axes or not self.samples:
            return self.points or [{} for _ in range(self.samples if self.draws else 0)]
        return sample(self.axes, self.method, self.samples, self.seed)
