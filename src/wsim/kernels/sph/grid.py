"""Uniform cell grid: particles sorted by cell, x fastest, so that a row of cells is one run of the sorted list.

The cells are a fraction of the kernel's support. A neighbour search walks rows, each trimmed to the sphere around
the particle. Particles outside the grid belong to its rim: clamping brings cells no further apart, so the search
stays exact there and is only slower.
"""

import warp as wp


@wp.struct
class Grid:
    """Where the cells are. Every world has its own copy of the same cells."""

    origin: wp.vec3
    cell: float  # edge [m]
    inv_cell: float  # [1/m]
    reach: int  # cells that a support spans
    nx: int
    ny: int
    nz: int
    support: float  # [m]


@wp.func
def grid_axis(x: float, origin: float, inv_cell: float, count: int) -> int:
    """Cell index along one axis, clamped to the grid. The float is clamped first: casting a huge one is undefined."""
    return int(wp.clamp(wp.floor((x - origin) * inv_cell), 0.0, float(count - 1)))


@wp.func
def row_count(grid: Grid) -> int:
    """Number of rows that a search visits."""
    width = 2 * grid.reach + 1
    return width * width


@wp.func
def gap_to_row(x: float, low: float, cell: float) -> float:
    """Distance from x to the interval [low, low + cell] [m]."""
    return wp.max(wp.max(low - x, x - low - cell), 0.0)


@wp.func
def row_span(grid: Grid, cell_start: wp.array(dtype=int), world: int, x: wp.vec3, row: int) -> wp.vec2i:
    """First and past-the-last sorted index of the particles of one row that can lie within the support of x."""
    width = 2 * grid.reach + 1
    cy = grid_axis(x[1], grid.origin[1], grid.inv_cell, grid.ny)
    cz = grid_axis(x[2], grid.origin[2], grid.inv_cell, grid.nz)
    iy = cy + row % width - grid.reach
    iz = cz + row / width - grid.reach
    if iy < 0 or iz < 0 or iy >= grid.ny or iz >= grid.nz:
        return wp.vec2i(0, 0)
    # A rim cell also holds what lies beyond it, so it is never trimmed away.
    dy = float(0.0)
    dz = float(0.0)
    if iy > 0 and iy < grid.ny - 1:
        dy = gap_to_row(x[1], grid.origin[1] + float(iy) * grid.cell, grid.cell)
    if iz > 0 and iz < grid.nz - 1:
        dz = gap_to_row(x[2], grid.origin[2] + float(iz) * grid.cell, grid.cell)
    left = grid.support * grid.support - dy * dy - dz * dz
    if left <= 0.0:
        return wp.vec2i(0, 0)
    # A thousandth of a cell more, so that rounding never drops a neighbour at the edge of the support.
    half = wp.sqrt(left) + 0.001 * grid.cell
    first = grid_axis(x[0] - half, grid.origin[0], grid.inv_cell, grid.nx)
    last = grid_axis(x[0] + half, grid.origin[0], grid.inv_cell, grid.nx)
    base = ((world * grid.nz + iz) * grid.ny + iy) * grid.nx
    return wp.vec2i(cell_start[base + first], cell_start[base + last + 1])


@wp.kernel(enable_backward=False)
def assign_cells(
    # Data in:
    grid: Grid,
    fluid_count: int,
    fluid_position: wp.array(dtype=wp.vec3),
    boundary_position: wp.array(dtype=wp.vec3),
    particle_world: wp.array(dtype=int),
    # Data out:
    key: wp.array(dtype=int),
    order: wp.array(dtype=int),
    cell_count: wp.array(dtype=int),
):
    """Cell of each particle, and how many particles each cell has."""
    i = wp.tid()
    x = wp.vec3(0.0, 0.0, 0.0)
    if i < fluid_count:
        x = fluid_position[i]
    else:
        x = boundary_position[i - fluid_count]
    ix = grid_axis(x[0], grid.origin[0], grid.inv_cell, grid.nx)
    iy = grid_axis(x[1], grid.origin[1], grid.inv_cell, grid.ny)
    iz = grid_axis(x[2], grid.origin[2], grid.inv_cell, grid.nz)
    cell = ((particle_world[i] * grid.nz + iz) * grid.ny + iy) * grid.nx + ix
    key[i] = cell
    order[i] = i
    wp.atomic_add(cell_count, cell, 1)


@wp.kernel(enable_backward=False)
def gather(
    # Data in:
    fluid_count: int,
    order: wp.array(dtype=int),
    fluid_position: wp.array(dtype=wp.vec3),
    fluid_velocity: wp.array(dtype=wp.vec3),
    fluid_density: wp.array(dtype=float),
    boundary_position: wp.array(dtype=wp.vec3),
    boundary_velocity: wp.array(dtype=wp.vec3),
    rest_density: float,
    # Data out:
    point: wp.array(dtype=wp.vec4),
    motion: wp.array(dtype=wp.vec4),
):
    """Copy what changes each step into sorted order; a density that was never set is the rest density."""
    s = wp.tid()
    i = order[s]
    if i < fluid_count:
        x = fluid_position[i]
        v = fluid_velocity[i]
        point[s] = wp.vec4(x[0], x[1], x[2], 0.0)
        rho = fluid_density[i]
        motion[s] = wp.vec4(v[0], v[1], v[2], wp.where(rho > 0.0, rho, rest_density))
    else:
        b = i - fluid_count
        x = boundary_position[b]
        v = boundary_velocity[b]
        point[s] = wp.vec4(x[0], x[1], x[2], 0.0)
        motion[s] = wp.vec4(v[0], v[1], v[2], rest_density)


@wp.kernel(enable_backward=False)
def gather_constants(
    # Data in:
    fluid_count: int,
    order: wp.array(dtype=int),
    fluid_mass: wp.array(dtype=float),
    boundary_volume: wp.array(dtype=float),
    boundary_owner: wp.array(dtype=int),
    rest_density: float,
    # Data out:
    mass: wp.array(dtype=float),
    kind: wp.array(dtype=int),
):
    """Copy what a particle keeps into sorted order. kind: 0 fluid, 1 fixed wall, 2 moving body."""
    s = wp.tid()
    i = order[s]
    if i < fluid_count:
        mass[s] = fluid_mass[i]
        kind[s] = 0
    else:
        b = i - fluid_count
        mass[s] = rest_density * boundary_volume[b]
        kind[s] = wp.where(boundary_owner[b] >= 0, 2, 1)
