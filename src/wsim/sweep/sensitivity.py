"""Which parameter a result hangs on: Sobol' indices, from candidates that Saltelli's design drew.

Of a result's variance over the ranges, a parameter's first-order index is the share that it makes by itself, and its
total index the share that would be left were all others known. What lies between the two it makes together with others.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.sweep.sampling import LEAST_ROWS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.sweep.candidate import Outcome
    from wsim.sweep.spec import Spec

    Values = NDArray[np.float64]

DRAWS = 400  # of the bootstrap
SURE = 95.0  # [%] of the draws that an interval holds
ROOM = "room to the limit"


@dataclass(frozen=True)
class Index:
    """A parameter's indices of one result, each with its interval of `SURE` %."""

    name: str
    first: float
    first_between: tuple[float, float]
    total: float
    total_between: tuple[float, float]


@dataclass(frozen=True)
class Sensitivity:
    """Of one result: the indices, the greatest total first, and how many rows of the design they are from."""

    result: str
    indices: list[Index]
    rows: int
    lost: int  # rows with a candidate that has no such result


def indices(names: Sequence[str], values: Values) -> list[Index]:
    """Sobol' indices of a result, the greatest total first; none where it does not vary.

    The estimators are those of Saltelli et al. (2010), table 2 (b) and (f), of centred values; the intervals are
    percentiles of a bootstrap over rows.

    Args:
        names: Of the d parameters.
        values: (rows, d + 2), as `wsim.sweep.sampling.saltelli` orders its points.
    """
    if not np.ptp(values) > 0.0:
        return []
    picks = np.random.default_rng(0).integers(len(values), size=(DRAWS, len(values)))
    drawn = [shares for shares in (_shares(values[pick]) for pick in picks) if np.isfinite(shares).all()]
    first, total = _shares(values)
    low, high = np.percentile(drawn, [50.0 - SURE / 2.0, 50.0 + SURE / 2.0], axis=0)
    found = [
        Index(name, float(first[k]), (low[0][k], high[0][k]), float(total[k]), (low[1][k], high[1][k]))
        for k, name in enumerate(names)
    ]
    return sorted(found, key=lambda index: -index.total)


def sensitivities(spec: Spec, outcomes: Sequence[Outcome]) -> list[Sensitivity]:
    """Of the room to the limit, then of each objective's margin; none where the points are not of Saltelli's design.

    Of several programs or seeds at a point the mean counts.
    """
    if spec.method != "saltelli" or spec.points or not spec.axes:
        return []
    by_number = {outcome.candidate.number: outcome for outcome in outcomes}
    each, points = spec.each, spec.count // spec.each - 1
    margins = dict.fromkeys(name for outcome in outcomes for name in outcome.margins)
    found = []
    for result in (ROOM, *margins):
        of_each = np.array([_result(by_number.get(number), result) for number in range(each, (points + 1) * each)])
        rows = of_each.reshape(-1, len(spec.axes) + 2, each).mean(axis=2)
        whole = rows[np.isfinite(rows).all(axis=1)]
        told = indices([axis.label for axis in spec.axes], whole) if len(whole) >= LEAST_ROWS else []
        if told:
            found.append(Sensitivity(result, told, len(whole), len(rows) - len(whole)))
    return found


def _result(outcome: Outcome | None, result: str) -> float:
    if outcome is None:
        return np.nan
    margins: Mapping[str, float] = outcome.margins
    value = outcome.slack if result == ROOM else margins.get(result)
    return np.nan if value is None else value


def _shares(values: Values) -> Values:
    """(2, d): first-order and total."""
    values = values - values[:, :2].mean()
    a, b, swapped = values[:, 0], values[:, 1], values[:, 2:].T
    with np.errstate(divide="ignore", invalid="ignore"):
        variance = values[:, :2].var()
        first, total = (b * (swapped - a)).mean(axis=1), 0.5 * ((a - swapped) ** 2).mean(axis=1)
        return np.stack([first, total]) / variance
