"""What went wrong, found on the device: one pass over the fluid, a few numbers of each world out."""

import warp as wp

from wsim.kernels.sph.grid import PARKED, Grid


@wp.kernel(enable_backward=False)
def inspect(
    # Data in:
    grid: Grid,
    particle_world: wp.array(dtype=int),
    position: wp.array(dtype=wp.vec3),
    velocity: wp.array(dtype=wp.vec3),
    pressure: wp.array(dtype=float),
    stage: wp.array(dtype=int),  # empty where none is ever parked
    # Data out:
    first_not_finite: wp.array(dtype=int),
    fastest2: wp.array(dtype=float),
    outside: wp.array(dtype=int),
):
    """Of each world the first particle that is not finite, how many have left the grid, the others' largest speed².

    What has left the grid may fall for as long as it likes.
    """
    i = wp.tid()
    world = particle_world[i]
    x = position[i]
    v = velocity[i]
    speed2 = wp.dot(v, v)
    if not wp.isfinite(wp.dot(x, x) + speed2 + pressure[i]):
        wp.atomic_min(first_not_finite, world, i)
        return
    if stage.shape[0] > 0:
        if stage[i] == PARKED:
            return
    for axis in range(3):
        k = wp.floor((x[axis] - grid.offset[axis]) * grid.inv_cell[axis]) - float(grid.first[axis])
        if grid.reach[axis] > 0 and (k < 0.0 or k >= float(grid.count[axis])):
            wp.atomic_add(outside, world, 1)
            return
    if speed2 > fastest2[world]:
        wp.atomic_max(fastest2, world, speed2)
