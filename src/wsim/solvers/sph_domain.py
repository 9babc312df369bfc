"""The cells that an SPH fluid is sorted into."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import warp as wp

from wsim.kernels.sph.grid import Grid
from wsim.solvers.shapes import OpenBox
from wsim.solvers.sph_config import ConfigSPH
from wsim.solvers.vessels import Vessel

Array = np.ndarray
MAX_CELLS = 2**30
REACH = {True: 2, False: 1}  # cells that a support spans across a row, on a CUDA device or a CPU
ALONG = 4  # times as many along it: at a reach of 2 a fifth fewer candidates


def domain_of(fluid: Array, containers: Sequence[OpenBox], vessels: Sequence[Vessel]) -> tuple[Array, Array]:
    """Lower and upper corner [m] of the fluid and its tanks; a free fluid gets as much room again on each side.

    Args:
        fluid: Positions [m], shape (n, 3).
        containers: Tanks of all worlds.
        vessels: What else holds it; with the room that they move in.
    """
    low, high = fluid.min(axis=0), fluid.max(axis=0)
    if not containers:
        room = np.full(3, float((high - low).max()))
        low, high = low - room, high + room
    for vessel in vessels:
        if vessel.goes is not None:
            low, high = np.minimum(low, vessel.goes[0]), np.maximum(high, vessel.goes[1])
    for box in containers:
        diagonal = np.full(3, float(np.linalg.norm(box.size)))
        half = 0.5 * (np.array(box.size) if box.rotation[3] == 1.0 else diagonal)
        low, high = np.minimum(low, np.array(box.center) - half), np.maximum(high, np.array(box.center) + half)
    return low, high


def make_grid(config: ConfigSPH, low: Array, high: Array, support: float, cuda: bool, world_count: int) -> Any:
    """Cells over a domain, the same in every world.

    Args:
        config: For dimensions, periodic axes and cells per support.
        low: Lower corner of the domain [m], shape (3,).
        high: Upper corner [m], shape (3,).
        support: Radius of the search [m].
        cuda: Whether a GPU will search it.
        world_count: Number of worlds.

    Raises:
        ValueError: If even the coarsest cells are too many.
    """
    finest = config.cells_per_support or REACH[cuda]
    for reach, along in [(finest, ALONG), *((reach, 1) for reach in range(finest, 0, -1))]:
        grid = _grid(config, low, high, support, reach, along)
        cells = cells_of(grid) * world_count
        if cells <= MAX_CELLS // 4 or (cells <= MAX_CELLS and (reach, along) == (1, 1)):
            return grid
    raise ValueError(f"SolverSPH: {cells} grid cells; use a coarser spacing or a smaller domain")


def cells_of(grid: Any) -> int:
    """Number of cells of one world."""
    return int(grid.count[0]) * int(grid.count[1]) * int(grid.count[2])


def blocks_of(grid: Any) -> int:
    """Number of blocks of one world."""
    return int(grid.blocks[0]) * int(grid.blocks[1]) * int(grid.blocks[2])


def _grid(config: ConfigSPH, low: Array, high: Array, support: float, reach: int, along: int) -> Grid:
    cell, offset, period = support / reach / np.array([along, 1, 1]), np.zeros(3), np.zeros(3)
    first, count, reaches = np.zeros(3, int), np.ones(3, int), reach * np.array([along, 1, 1])
    for axis, ends in enumerate(config.periodic):
        if axis == 1 and config.dimensions == 2:
            reaches[axis] = 0
        elif ends is not None:
            period[axis], offset[axis] = ends[1] - ends[0], ends[0]
            count[axis] = int(period[axis] / cell[axis])
            cell[axis] = period[axis] / count[axis]
        else:
            first[axis] = math.floor((low[axis] - support) / cell[axis])
            count[axis] = math.ceil((high[axis] + support) / cell[axis]) - first[axis]
    blocks = np.maximum(count // np.maximum(reaches, 1), 1)
    grid: Any = Grid()
    grid.first, grid.count = wp.vec3i(*first.tolist()), wp.vec3i(*count.tolist())
    grid.reach, grid.blocks = wp.vec3i(*reaches.tolist()), wp.vec3i(*blocks.tolist())
    grid.cell, grid.inv_cell = wp.vec3(*cell.tolist()), wp.vec3(*(1.0 / cell).tolist())
    grid.offset, grid.period = wp.vec3(*offset.tolist()), wp.vec3(*period.tolist())
    inverse = np.divide(1.0, period, out=np.zeros(3), where=period > 0.0)
    grid.inv_period, grid.support = wp.vec3(*inverse.tolist()), support
    return grid
