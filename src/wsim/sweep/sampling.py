"""Candidates' parameters: points of the space that the axes span."""

from __future__ import annotations

import csv
import itertools
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import numpy as np
from scipy.stats import qmc

from wsim.errors import UserError
from wsim.sweep.axis import Axis

Method = Literal["sobol", "latin", "random", "grid", "saltelli", "cma"]
Point = dict[str, float]
MOST = 1_000_000  # points of a grid
LEAST_ROWS = 8  # of Saltelli's design: of fewer the indices say nothing


def sample(axes: Sequence[Axis], method: Method, count: int, seed: int = 0) -> list[Point]:
    """Points of the space.

    Sobol' numbers are scrambled (Owen 1998, "Scrambling Sobol' and Niederreiter-Xing points"), Latin hypercubes
    as McKay, Beckman and Conover (1979) draw them. Both fill the space more evenly than random points do. What
    Saltelli draws tells which parameter a result hangs on (`wsim.sweep.sensitivity`).

    Args:
        axes: At least one.
        method: A grid has as many values along each axis as make `count` points in all, or the axis' own list; the
            number of its points is then that of their product.
        count: How many; of "saltelli" at most.
        seed: Of the draw; the same points for the same seed.

    Raises:
        UserError: If `count` is too few for the method.
        ValueError: If the method draws from what it is told: that is `wsim.sweep.search`'s.
    """
    if method == "cma":
        raise ValueError("method: cma asks for points batch by batch; use wsim.sweep.search.Search")
    if method == "grid":
        free = sum(not axis.values for axis in axes)
        listed = math.prod(len(axis.values) or 1 for axis in axes)
        # A hair is added so that the cube root of 27 is 3.
        along = max(2, math.floor((count / listed) ** (1.0 / free) + 1e-9)) if free else 1
        size = math.prod(len(axis.values) or along for axis in axes)
        if size > MOST:
            raise UserError(
                f"--method grid: {size:,} points, of {along} values or more along each of {len(axes)} parameters, are "
                f"more than {MOST:,}; vary fewer, walk some together (--zip), or draw --samples (--method sobol)"
            )
        return points_at(axes, np.array(list(itertools.product(*(axis.shares(along) for axis in axes)))))
    return points_at(axes, _shares(method, len(axes), count, seed))


def points_at(axes: Sequence[Axis], shares: np.ndarray) -> list[Point]:
    """The points at shares of each axis: (points, axes). What goes with an axis has the same share."""
    columns = {each.name: each.at(shares[:, k]) for k, axis in enumerate(axes) for each in axis.parameters}
    rows = np.stack(list(columns.values()), axis=1).tolist()
    return [dict(zip(columns, row, strict=True)) for row in rows]


def _shares(method: Method, dimensions: int, count: int, seed: int) -> np.ndarray:
    if method == "sobol":
        # Balanced in powers of two; the first of them are as even as can be.
        drawn = qmc.Sobol(dimensions, rng=seed).random_base2(max(0, math.ceil(math.log2(count))))
        return np.asarray(drawn[:count])
    if method == "saltelli":
        return saltelli(dimensions, count, seed)
    if method == "latin":
        return np.asarray(qmc.LatinHypercube(dimensions, rng=seed).random(count))
    return np.random.default_rng(seed).random((count, dimensions))


def saltelli(dimensions: int, count: int, seed: int) -> np.ndarray:
    """Points in [0, 1) whose rows of d + 2 are a point, a second one, and the first with each coordinate of the second.

    A. Saltelli et al. (2010), "Variance based sensitivity analysis of model output", Comput. Phys. Commun. 181.

    Args:
        dimensions: d.
        count: Points in all, at most; as many rows as a power of two are drawn, of Sobol' numbers.
        seed: Of the scrambling.

    Raises:
        UserError: If they are too few.
    """
    each = dimensions + 2
    if count < LEAST_ROWS * each:
        raise UserError(
            f"--samples {count}: --method saltelli takes {each} candidates a row for {dimensions} parameters, and "
            f"{LEAST_ROWS} rows or more; give --samples {LEAST_ROWS * each} "
            f"(256 rows, --samples {256 * each}, tell much more)"
        )
    power = (count // each).bit_length() - 1
    a, b = np.split(qmc.Sobol(2 * dimensions, rng=seed).random_base2(power), 2, axis=1)
    swapped = [np.where(np.arange(dimensions) == k, b, a) for k in range(dimensions)]
    return np.stack([a, b, *swapped], axis=1).reshape(-1, dimensions)


def read_points(path: Path) -> list[Point]:
    """Points from a CSV file: a line of parameters' names, then a line of numbers for each candidate.

    Raises:
        UserError: Naming file, line and column of what is wrong.
    """
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            reader = csv.reader(file)
            rows = [(reader.line_num, row) for row in reader if any(cell.strip() for cell in row)]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise UserError(f"--points {path}: {error}; give a CSV file with a line of names") from error
    if len(rows) < 2:
        raise UserError(f"--points {path}: no candidates; give a line of names, then a line of numbers for each")
    first, *rest = rows
    names = [name.strip() for name in first[1]]
    odd = [name for name in names if not name.isidentifier() or names.count(name) > 1]
    if odd:
        raise UserError(f"--points {path}, line {first[0]}: {odd[0]!r} is no name of a parameter, or is there twice")
    return [_point(path, line, names, row) for line, row in rest]


def _point(path: Path, line: int, names: list[str], row: list[str]) -> Point:
    if len(row) != len(names):
        raise UserError(f"--points {path}, line {line}: {len(row)} numbers for {len(names)} names")
    point = {}
    for name, cell in zip(names, row, strict=True):
        try:
            point[name] = float(cell)
        except ValueError:
            point[name] = math.nan
        if not math.isfinite(point[name]):
            raise UserError(f"--points {path}, line {line}: {name} is {cell!r}; it must be a finite number")
    return point
