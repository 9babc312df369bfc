"""The rows of cells around a position, each trimmed to the sphere that is searched.

A search visits tens of rows for some 150 candidates, so that what a row costs counts: how many there are and which
axes are periodic is compiled in, and a row's place takes a division by a constant.
"""

from dataclasses import dataclass

import warp as wp

from wsim.kernels.sph.grid import Grid, grid_axis
from wsim.kernels.sph.records import load_span


@dataclass(frozen=True)
class Rows:
    """The functions of one shape of search.

    `count(grid, x)`: how many runs of the sorted list a search around x visits: its rows, and again where they wrap
    around a periodic x. `span(grid, cell_start, world, x, run)`: first and past-the-last sorted index of the particles
    of one run that can lie within the support of x.
    """

    count: wp.Function
    span: wp.Function


@wp.func
def _beside(grid: Grid, x: float, index: int, axis: int) -> float:
    """Where x lies in its cell, in cells; what lies beyond the grid is in its rim, as near to the rest as can be."""
    u = (x - grid.offset[axis]) * grid.inv_cell[axis] - float(index + grid.first[axis])
    return wp.clamp(u, 0.0, 1.0)


@wp.func
def _gap(u: float, steps: int, cell: float) -> float:
    """Distance [m] from a place in a cell to the cell so many steps further on."""
    j = float(steps)
    return wp.max(wp.max(j - u, u - j - 1.0), 0.0) * cell


def make_rows(reach: tuple[int, int], periodic: tuple[bool, bool, bool]) -> Rows:
    """Rows for a search that reaches so many cells along y and z.

    Args:
        reach: Cells that the support spans along y and z.
        periodic: Which axes are.
    """
    reach_y, reach_z = reach
    width = 2 * reach_y + 1
    rows = width * (2 * reach_z + 1)
    around_x, around_y, around_z = periodic

    @wp.func
    def count(grid: Grid, x: wp.vec3) -> int:
        runs = int(wp.static(rows))
        if wp.static(around_x):
            u = x[0] - grid.offset[0]
            margin = grid.support + grid.cell[0]
            if u < margin or u > grid.period[0] - margin:
                runs = int(wp.static(2 * rows))
        return runs

    @wp.func
    def span(grid: Grid, cell_start: wp.array(dtype=int), world: int, x: wp.vec3, run: int) -> wp.vec2i:
        row = run
        if wp.static(around_x):
            row = run % wp.static(rows)
        step_y = row % wp.static(width) - wp.static(reach_y)
        step_z = row / wp.static(width) - wp.static(reach_z)
        iy, iz = grid_axis(grid, x[1], 1), grid_axis(grid, x[2], 2)
        gap_y = _gap(_beside(grid, x[1], iy, 1), step_y, grid.cell[1])
        gap_z = _gap(_beside(grid, x[2], iz, 2), step_z, grid.cell[2])
        left = grid.support * grid.support - gap_y * gap_y - gap_z * gap_z
        iy, iz = iy + step_y, iz + step_z
        if wp.static(around_y):
            iy = (iy + grid.count[1]) % grid.count[1]
        if wp.static(around_z):
            iz = (iz + grid.count[2]) % grid.count[2]
        if wp.min(wp.min(iy, iz), wp.min(grid.count[1] - 1 - iy, grid.count[2] - 1 - iz)) < 0:
            left = float(0.0)
        if left <= 0.0:
            return wp.vec2i(0, 0)
        # A little more, so that rounding never drops a neighbour at the edge of the support.
        half = (wp.sqrt(left) + 0.0005 * grid.support) * grid.inv_cell[0]
        nx = grid.count[0]
        base = ((world * grid.count[2] + iz) * grid.count[1] + iy) * nx
        u = (x[0] - grid.offset[0]) * grid.inv_cell[0] - float(grid.first[0])
        if wp.static(not around_x):
            end = float(nx - 1)
            first = int(wp.clamp(wp.floor(u - half), 0.0, end))
            last = int(wp.clamp(wp.floor(u + half), 0.0, end))
            return load_span(cell_start, base + first, base + last + 1)
        low, high = int(wp.floor(u - half)), int(wp.floor(u + half))
        if run >= wp.static(rows):
            if low < 0:
                return load_span(cell_start, base + low + nx, base + nx)
            if high >= nx:
                return load_span(cell_start, base, base + high - nx + 1)
            return wp.vec2i(0, 0)
        return load_span(cell_start, base + wp.max(low, 0), base + wp.min(high, nx - 1) + 1)

    return Rows(count, span)
