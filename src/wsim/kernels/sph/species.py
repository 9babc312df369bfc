"""The three kinds of particles, fluid, walls and bodies, each sorted by cell on its own.

What a pair exchanges depends on the kinds of its two ends. With a list for each kind no sum asks a neighbour what it
is; walls, which never move, are sorted once; and a particle far from solids walks over fluid alone.
"""

import warp as wp

from wsim.kernels.sph.grid import Grid, block_axis, grid_axis

FLUID = 0
WALLS = 1  # what does not move
BODIES = 2  # what does
KINDS = (FLUID, WALLS, BODIES)

DRY = wp.constant(-1.0e30)  # pressure of a particle of a solid that no fluid is near [Pa]


@wp.struct
class Species:
    """Particles of one kind. A list entry is a sorted index; the lists of particle s begin at `s * capacity`."""

    order: wp.array(dtype=int)  # sorted index -> original index
    world: wp.array(dtype=int)  # of each, in original order
    point: wp.array(dtype=wp.vec4)  # x, y, z, V
    motion: wp.array(dtype=wp.vec4)  # vx, vy, vz and a pressure, or what a wall gives back
    liquid: wp.array(dtype=wp.vec2)  # rest density, viscosity; of solids what is near; empty with one liquid
    creep: wp.array(dtype=wp.vec4)  # velocity that the laminar viscosity takes (`yielding`), where a liquid yields
    stage: wp.array(dtype=int)  # of fluid with openings, in original order: see `openings`
    full: wp.array(dtype=float)  # of fluid: 1 with all around it filled, 0 at a surface
    facing: wp.array(dtype=wp.vec4)  # of solids: the way to the fluid, of length 1; 0 if there is none
    across: wp.array(dtype=wp.vec4)  # of bodies: the way to other solids, likewise
    handed: wp.array(dtype=wp.vec4)  # of bodies: what the last step handed on (`push.make_push`), and the body
    cell_start: wp.array(dtype=int)  # of each cell in the sorted list
    near: wp.array(dtype=wp.uint8)  # blocks within reach of any; for walks alone, and not marked for fluid
    entry: wp.array(dtype=int)  # neighbours: fluid, then walls, then bodies; for lists alone
    entry_count: wp.array(dtype=wp.vec3i)  # of each kind
    capacity: int


@wp.func
def is_near(grid: Grid, other: Species, world: int, x: wp.vec3) -> bool:
    """Whether any of the others may be within reach of a position; lists know it better."""
    if other.near.shape[0] == 0:
        return True
    bx = block_axis(grid, grid_axis(grid, x[0], 0), 0)
    by = block_axis(grid, grid_axis(grid, x[1], 1), 1)
    bz = block_axis(grid, grid_axis(grid, x[2], 2), 2)
    return other.near[((world * grid.blocks[2] + bz) * grid.blocks[1] + by) * grid.blocks[0] + bx] != wp.uint8(0)


@wp.kernel(enable_backward=False)
def mark_near(
    # Data in:
    grid: Grid,
    position: wp.array(dtype=wp.vec3),
    world: wp.array(dtype=int),
    # Data out:
    near: wp.array(dtype=wp.uint8),
):
    """Mark the blocks within reach of each particle.

    A block is at least as wide as the reach: of the cells a reach before, at and a reach after the particle's own, one
    lies in each block that the support touches.
    """
    i, part = wp.tid()
    x = position[i]
    at = wp.vec3i(0, 0, 0)
    rest = part
    for axis in range(3):
        k = grid_axis(grid, x[axis], axis) + (rest % 3 - 1) * grid.reach[axis]
        rest = rest / 3
        if grid.period[axis] > 0.0:
            k = (k + grid.count[axis]) % grid.count[axis]
        at[axis] = block_axis(grid, wp.clamp(k, 0, grid.count[axis] - 1), axis)
    near[((world[i] * grid.blocks[2] + at[2]) * grid.blocks[1] + at[1]) * grid.blocks[0] + at[0]] = wp.uint8(1)
