"""The fluid's push on bodies, that of water in gaps too narrow for a particle with it."""

import warp as wp

from wsim.kernels.sph.density import Method
from wsim.kernels.sph.grid import Grid
from wsim.kernels.sph.momentum import viscosities
from wsim.kernels.sph.pair_sums import PairSums
from wsim.kernels.sph.records import load_record
from wsim.kernels.sph.species import BODIES, DRY, FLUID, WALLS, Species, is_near

# Steps that pressure seeps on from the water that it came from: two spacings in each, far more than a face has. Where
# that water has left, it grows with each step, until nothing is left of the pressure either.
MOST_HOPS = wp.constant(64.0)


@wp.kernel(enable_backward=False)
def gather_bodies(
    # Data in:
    order: wp.array(dtype=int),
    owner: wp.array(dtype=int),
    handed: wp.array(dtype=wp.vec2),
    # Data out:
    facing: wp.array(dtype=wp.vec4),
    across: wp.array(dtype=wp.vec4),
    seeped: wp.array(dtype=float),
):
    """Copy whose particles they are, and what they handed on in the last step, into sorted order."""
    s = wp.tid()
    i = order[s]
    facing[s] = wp.vec4(0.0, 0.0, 0.0, float(owner[i]))
    across[s] = wp.vec4(0.0, 0.0, 0.0, handed[i][1])
    seeped[s] = handed[i][0]


def make_look_across(sums: PairSums, solids: tuple[int, ...]) -> wp.Kernel:
    """The kernel that finds where other solids are, given the kinds of solids."""
    of_walls, of_bodies = sums.way[WALLS], sums.way[BODIES]

    @wp.kernel(**sums.options)
    def look_across(
        # Data in:
        first: int,
        grid: Grid,
        method: Method,
        walls: Species,
        bodies: Species,
        # Data in and out:
        across: wp.array(dtype=wp.vec4),
    ):
        """The way from each particle of a body across the gap, if there is one, to walls and other bodies, of length 1.

        sum W (x_s - x_b), as the way to the fluid is found.
        """
        s = first + wp.tid()
        p = load_record(bodies.point, s)
        x, at_rest = wp.vec3(p[0], p[1], p[2]), wp.vec3(0.0, 0.0, 0.0)
        world = bodies.world[bodies.order[s]]
        way = of_bodies(grid, bodies, bodies, s, world, method.shape, x, at_rest, 0.0, at_rest)
        if wp.static(WALLS in solids):
            if is_near(grid, walls, world, x):
                way += of_walls(grid, bodies, walls, s, world, method.shape, x, at_rest, 0.0, at_rest)
        way = wp.normalize(way)
        across[s] = wp.vec4(way[0], way[1], way[2], across[s][3])

    return look_across


def make_push(sums: PairSums, solids: tuple[int, ...]) -> wp.Kernel:
    """The kernel that sums the fluid's forces on the particles of bodies, given the kinds of solids."""
    of_fluid, of_walls, of_bodies = sums.force[FLUID], sums.force_in_gap[WALLS], sums.force_in_gap[BODIES]
    seeping = sums.seeping

    @wp.kernel(**sums.options)
    def push(
        # Data in:
        first: int,
        grid: Grid,
        method: Method,
        rest_density: wp.array(dtype=float),
        viscosity: wp.array(dtype=float),
        gravity: wp.array(dtype=wp.vec3),
        fluid: Species,
        walls: Species,
        bodies: Species,
        # Data out:
        force: wp.array(dtype=wp.vec3),
        on_walls: wp.array(dtype=wp.vec3),
        handed: wp.array(dtype=wp.vec2),
    ):
        """The fluid's force on each particle of a body, and its share of that on the walls [N], in original order.

        The opposite of what the fluid feels, and in a gap too narrow for a particle the pressure of the water in there:

        F_b = -V_b sum V_s (p_b + p_s) grad W

        over walls and other bodies. Near them half of the neighbours of b are none of the fluid's: without these a ball
        on the floor has two fifths of its lift. A pair counts where none of the two has its fluid behind it, seen
        across the gap: what lies on the bottom of a hull is not lifted through that.

        Water gets between faces that touch, farther than the fluid is within reach of: a particle there takes its
        pressure from those of its body that are at the gap, too, as it would from fluid, one step after the other. A
        dry particle of a wall has the pressure of the one that it pushes, but for the height between them.

        `handed` is the pressure that it hands on, and over how many others it came; `DRY` if it has none, or at no gap.
        """
        s = first + wp.tid()
        p = load_record(bodies.point, s)
        m = load_record(bodies.motion, s)
        a = load_record(bodies.across, s)
        x, v = wp.vec3(p[0], p[1], p[2]), wp.vec3(m[0], m[1], m[2])
        i = bodies.order[s]
        world = bodies.world[i]
        weight_of_water = rest_density[world] * gravity[world]
        wet = m[3] > 0.5 * DRY
        pressure = m[3] if wet else bodies.seeped[s]
        own = pressure + 2.0 * method.background_pressure
        total, in_gap = wp.vec3(0.0, 0.0, 0.0), wp.vec3(0.0, 0.0, 0.0)
        to_hand = wp.vec2(DRY, 0.0)
        if wet:
            viscous = viscosities(method, rest_density[world], viscosity[world])
            total = of_fluid(grid, bodies, fluid, s, world, method.shape, x, v, own, viscous)
        if a[0] != 0.0 or a[1] != 0.0 or a[2] != 0.0:
            given = wp.vec3(pressure, -method.background_pressure, 0.0)
            others = of_bodies(grid, bodies, bodies, s, world, method.shape, x, given, own, weight_of_water)
            partners = others[3]
            if wp.static(WALLS in solids):
                if is_near(grid, walls, world, x):
                    at_wall = of_walls(grid, bodies, walls, s, world, method.shape, x, given, own, weight_of_water)
                    in_gap = wp.vec3(at_wall[0], at_wall[1], at_wall[2])
                    partners += at_wall[3]
            if pressure > 0.5 * DRY:
                total += wp.vec3(others[0], others[1], others[2])
            else:
                in_gap = wp.vec3(0.0, 0.0, 0.0)
            if partners > 0.0 and wet:
                to_hand = wp.vec2(pressure, 0.0)
            elif partners > 0.0:
                near = seeping(grid, bodies, bodies, s, world, method.shape, x, given, own, weight_of_water)
                if near[0] > 0.0 and near[2] < MOST_HOPS:
                    to_hand = wp.vec2(wp.max(near[1] / near[0], -method.background_pressure), near[2] + 1.0)
        handed[i] = to_hand
        force[i] = p[3] * (total + in_gap)
        if wp.static(WALLS in solids):
            on_walls[i] = -p[3] * in_gap

    return push
