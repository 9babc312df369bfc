"""Search for the point with the most room to the limit: whole batches are asked for, and told how they came out.

CMA-ES (Hansen 2016, "The CMA Evolution Strategy: A Tutorial") needs no gradient, bears plateaus and noise, and ranks
what it is told: a slack has no scale that it would hang on. The reference implementation, `cma`, is its author's.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from wsim.sweep.axis import Axis
from wsim.sweep.candidate import Outcome
from wsim.sweep.sampling import Point, points_at

if TYPE_CHECKING:
    from numpy.typing import NDArray

FIRST_STEP = 0.3  # of each range, as its authors advise for a cube
FINE = 1e-3  # of a range: steps below it tell nothing that a user can set
NO_VERDICT = 2.0  # worse than any slack


class Search:
    """Asks for points, is told what came of them, and narrows in.

    Args:
        axes: What differs.
        seed: Of the draw; the same answers make the same questions.
        batch: The least number of points a time: as many as run side by side.
    """

    def __init__(self, axes: Sequence[Axis], seed: int, batch: int = 1) -> None:
        import cma  # loads slowly; only a search needs it

        self._axes = axes
        dimensions = max(2, len(axes))  # it cannot search a line; the second number is not looked at
        start = np.full(dimensions, 0.5)
        start[: len(axes)] = [axis.share(axis.start) if axis.start is not None else 0.5 for axis in axes]
        self._strategy = cma.CMAEvolutionStrategy(
            start,
            FIRST_STEP,
            {
                "bounds": [0.0, 1.0],
                "seed": (seed + 1) % 2**32 or 1,  # its 0 draws a seed from the clock, and it has no greater one
                "popsize": max(batch, 4 + math.floor(3 * math.log(dimensions))),
                "tolx": FINE,
                "tolfun": 0.0,
                "tolfunhist": 0.0,
                "verbose": -9,
            },
        )
        self._asked: list[NDArray[np.float64]] = []

    @property
    def done(self) -> bool:
        """Whether it has narrowed in as far as it can."""
        return bool(self._strategy.stop())

    def ask(self) -> list[Point]:
        """The next points."""
        self._asked = self._strategy.ask()
        return points_at(self._axes, np.asarray(self._asked))

    def tell(self, outcomes: Sequence[Outcome]) -> None:
        """What came of the points that were asked for last, in their order."""
        self._strategy.tell(self._asked, [cost(outcome) for outcome in outcomes])


def cost(outcome: Outcome) -> float:
    """What is made small: the slack turned round, which is above 0 where the world is rejected."""
    if outcome.status in ("accepted", "rejected"):
        return -(outcome.slack or 0.0)
    return NO_VERDICT
