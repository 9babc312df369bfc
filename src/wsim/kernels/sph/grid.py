"""Uniform cell grid: particles sorted by cell, x fastest, so that a row of cells is one run of the sorted list.

The cells are a fraction of the kernel's support, and shorter along x: a search walks rows, each trimmed to the sphere
around the particle (`rows.py`), and the finer the cells along the row, the closer. Along an axis that is not periodic,
particles outside the grid belong to its rim: clamping brings cells no further apart, so the search stays exact there
and is only slower. Along a periodic axis the rows wrap.

Cell k along an axis spans [k, k + 1) * cell, whatever the grid's extent: a world is cut into the same cells alone and
in a batch, and its sums add up in the same order.
"""

import warp as wp

PARKED = wp.constant(-1)  # stage of a particle that is not in its world (`openings`)


@wp.struct
class Grid:
    """Where the cells are. Every world has its own copy of the same cells."""

    first: wp.vec3i  # index of the first cell along each axis
    count: wp.vec3i  # cells along each axis
    reach: wp.vec3i  # cells that a support spans; 0 across a plane
    blocks: wp.vec3i  # how many along each axis; a block has as many cells as the reach, or more
    cell: wp.vec3  # edges [m]
    inv_cell: wp.vec3  # [1/m]
    offset: wp.vec3  # where cell 0 begins [m]; not zero on periodic axes alone
    period: wp.vec3  # length of a periodic axis [m]; 0 is open
    inv_period: wp.vec3  # [1/m]; 0 is open
    support: float  # radius of the search [m]


@wp.func
def grid_axis(grid: Grid, x: float, axis: int) -> int:
    """Cell index along one axis, clamped to the grid. The float is clamped first: casting a huge one is undefined."""
    k = wp.floor((x - grid.offset[axis]) * grid.inv_cell[axis]) - float(grid.first[axis])
    return int(wp.clamp(k, 0.0, float(grid.count[axis] - 1)))


@wp.func
def block_axis(grid: Grid, k: int, axis: int) -> int:
    """Block that a cell belongs to, along one axis; the last one has what is left over too."""
    return wp.min(k / wp.max(grid.reach[axis], 1), grid.blocks[axis] - 1)


@wp.func
def grid_cell(grid: Grid, world: int, x: wp.vec3) -> int:
    """Cell of a position in a world's copy of the grid."""
    ix = grid_axis(grid, x[0], 0)
    iy = grid_axis(grid, x[1], 1)
    iz = grid_axis(grid, x[2], 2)
    return ((world * grid.count[2] + iz) * grid.count[1] + iy) * grid.count[0] + ix


@wp.func
def in_plane(grid: Grid) -> bool:
    """Whether the flow is one in the x-z plane."""
    return grid.reach[1] == 0


@wp.func
def nearest_image(d: wp.vec3, period: wp.vec3) -> wp.vec3:
    """The shortest of a difference's periodic images."""
    e = d
    for axis in range(3):
        if period[axis] > 0.0:
            e[axis] = d[axis] - period[axis] * wp.rint(d[axis] / period[axis])
    return e


@wp.func
def wrap(grid: Grid, x: wp.vec3) -> wp.vec3:
    """Bring a position back into the periodic box."""
    y = x
    for axis in range(3):
        if grid.period[axis] > 0.0:
            y[axis] = x[axis] - grid.period[axis] * wp.floor((x[axis] - grid.offset[axis]) / grid.period[axis])
    return y


@wp.kernel(enable_backward=False)
def assign_cells(
    # Data in:
    first: int,
    grid: Grid,
    order: wp.array(dtype=int),
    position: wp.array(dtype=wp.vec3),
    particle_world: wp.array(dtype=int),
    stage: wp.array(dtype=int),  # empty where none is ever parked
    # Data out:
    key: wp.array(dtype=int),
    value: wp.array(dtype=int),
    cell_count: wp.array(dtype=int),
):
    """Cell of each particle, in the present order, and how many particles each cell has.

    What is parked is in the last cell of its world, wherever it is: no other particle comes near that.
    """
    k = wp.tid()
    i = order[first + k]
    world = particle_world[i]
    cell = grid_cell(grid, world, position[i])
    if stage.shape[0] > 0:
        if stage[i] == PARKED:
            cell = (world + 1) * grid.count[0] * grid.count[1] * grid.count[2] - 1
    key[k] = cell
    value[k] = i
    wp.atomic_add(cell_count, cell, 1)


@wp.kernel(enable_backward=False)
def shift(
    # Data in:
    by: int,
    # Data in and out:
    cell_start: wp.array(dtype=int),
):
    """Move the beginnings of one world's cells to where its particles stand in the list of all."""
    c = wp.tid()
    cell_start[c] = cell_start[c] + by


@wp.kernel(enable_backward=False)
def gather_fluid(
    # Data in:
    order: wp.array(dtype=int),
    position: wp.array(dtype=wp.vec3),
    velocity: wp.array(dtype=wp.vec3),
    pressure: wp.array(dtype=float),
    mass: wp.array(dtype=float),
    particle_world: wp.array(dtype=int),
    rest_density: wp.array(dtype=float),
    full: wp.array(dtype=float),
    speed_of_sound: float,
    # Data out:
    point: wp.array(dtype=wp.vec4),
    motion: wp.array(dtype=wp.vec4),
    sorted_full: wp.array(dtype=float),
):
    """Copy positions, volumes, velocities and pressures into sorted order."""
    s = wp.tid()
    i = order[s]
    x = position[i]
    v = velocity[i]
    p = pressure[i]
    density = rest_density[particle_world[i]] + p / (speed_of_sound * speed_of_sound)
    point[s] = wp.vec4(x[0], x[1], x[2], mass[i] / density)
    motion[s] = wp.vec4(v[0], v[1], v[2], p)
    sorted_full[s] = full[i]


@wp.kernel(enable_backward=False)
def gather_solid(
    # Data in:
    order: wp.array(dtype=int),
    position: wp.array(dtype=wp.vec3),
    velocity: wp.array(dtype=wp.vec3),
    volume: wp.array(dtype=float),
    # Data out:
    point: wp.array(dtype=wp.vec4),
    motion: wp.array(dtype=wp.vec4),
):
    """Copy positions, volumes and velocities into sorted order."""
    s = wp.tid()
    i = order[s]
    x = position[i]
    v = velocity[i]
    point[s] = wp.vec4(x[0], x[1], x[2], volume[i])
    motion[s] = wp.vec4(v[0], v[1], v[2], 0.0)
