"""Neighbour lists (Verlet 1967): found once, used by every sum until a particle has moved half the skin.

A list holds sorted indices. In a fluid particle's list a boundary neighbour j stands as ~j, so that a sum need not
look up what it is; a boundary particle lists fluid alone, since nothing else acts on it. Entry k of particle s is at
`s * stride[0] + k * stride[1]`: contiguous for each particle on a CPU, interleaved on a GPU.
"""

import warp as wp

from wsim.kernels.sph.grid import Grid, row_count, row_span


@wp.kernel(enable_backward=False)
def find_neighbors(
    # Data in:
    first: int,
    grid: Grid,
    cell_start: wp.array(dtype=int),
    order: wp.array(dtype=int),
    particle_world: wp.array(dtype=int),
    point: wp.array(dtype=wp.vec4),
    kind: wp.array(dtype=int),
    capacity: int,
    stride: wp.vec2i,
    # Data out:
    neighbor: wp.array(dtype=int),
    neighbor_count: wp.array(dtype=int),
    overflow: wp.array(dtype=int),
):
    """List the particles within the grid's search radius of each particle."""
    s = first + wp.tid()
    p = point[s]
    x = wp.vec3(p[0], p[1], p[2])
    fluid = kind[s] == 0
    world = particle_world[order[s]]
    radius2 = grid.support * grid.support
    base = s * stride[0]
    count = int(0)
    for row in range(row_count(grid)):
        span = row_span(grid, cell_start, world, x, row)
        for j in range(span[0], span[1]):
            q = point[j]
            dx = x[0] - q[0]
            dy = x[1] - q[1]
            dz = x[2] - q[2]
            if dx * dx + dy * dy + dz * dz < radius2 and j != s:
                other_is_fluid = kind[j] == 0
                if fluid or other_is_fluid:
                    if count < capacity:
                        neighbor[base + count * stride[1]] = wp.where(other_is_fluid, j, ~j)
                    count += 1
    neighbor_count[s] = wp.min(count, capacity)
    if count > capacity:
        wp.atomic_max(overflow, 0, count)


@wp.kernel(enable_backward=False)
def largest_move(
    # Data in:
    point: wp.array(dtype=wp.vec4),
    point_at_build: wp.array(dtype=wp.vec4),
    # Data out:
    move2: wp.array(dtype=float),
):
    """Largest squared distance from where the lists were made [m^2]."""
    s = wp.tid()
    p = point[s]
    q = point_at_build[s]
    dx = p[0] - q[0]
    dy = p[1] - q[1]
    dz = p[2] - q[2]
    d2 = dx * dx + dy * dy + dz * dz
    if d2 > move2[0]:
        wp.atomic_max(move2, 0, d2)
