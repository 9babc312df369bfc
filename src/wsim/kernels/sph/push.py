"""The fluid's push on bodies, that of water in gaps too narrow for a particle with it."""

import warp as wp

from wsim.kernels.sph.density import Method
from wsim.kernels.sph.grid import Grid
from wsim.kernels.sph.momentum import viscosities
from wsim.kernels.sph.pair_sums import Gap, PairSums
from wsim.kernels.sph.records import load_record
from wsim.kernels.sph.species import BODIES, DRY, WALLS, Species, is_near

# Steps that pressure seeps on from the water that it came from: two spacings in each, far more than a face has. Where
# that water has left, it grows with each step, until nothing is left of the pressure either.
MOST_HOPS = wp.constant(64.0)


# Of the own sum of V grad W of a body: that of others across a gap so wide that water gets in is as small.
FAR_ACROSS = wp.constant(0.02)
# Share of that sum that fluid holds against it where its particles fit into a gap, so that none is missing there.
FILLED = wp.constant(0.25)


@wp.func
def _widening(sums: Gap, of_fluid: wp.vec3) -> float:
    """What the sum of V grad W over others across a gap is to be times, so that with all else it is nothing."""
    others, own = wp.vec3(sums[4], sums[5], sums[6]), wp.vec3(sums[7], sums[8], sums[9])
    own2 = wp.dot(own, own)
    needed = -wp.dot(own + of_fluid, others) / (wp.dot(others, others) + FAR_ACROSS * FAR_ACROSS * own2)
    held = -wp.dot(of_fluid, own) / wp.max(own2, 1.0e-30)
    share = wp.clamp(1.0 - held / FILLED, 0.0, 1.0)
    return wp.max(1.0 + share * (needed - 1.0), 0.0)


@wp.kernel(enable_backward=False)
def gather_bodies(
    # Data in:
    order: wp.array(dtype=int),
    owner: wp.array(dtype=int),
    handed: wp.array(dtype=wp.vec3),
    # Data out:
    sorted_handed: wp.array(dtype=wp.vec4),
):
    """Copy what particles handed on in the last step, and whose they are, into sorted order."""
    s = wp.tid()
    i = order[s]
    h = handed[i]
    sorted_handed[s] = wp.vec4(h[0], h[1], h[2], float(owner[i]))


@wp.kernel(enable_backward=False)
def spare_vessels(
    # Data in:
    order: wp.array(dtype=int),
    of_vessel: wp.array(dtype=int),
    # Data out:
    across: wp.array(dtype=wp.vec4),
):
    """Let no gap be at the walls of a vessel: their particles lie behind its inside, in what is next to it."""
    s = wp.tid()
    if of_vessel[order[s]] > 0:
        across[s] = wp.vec4(0.0, 0.0, 0.0, 0.0)


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
        # Data out:
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
        across[s] = wp.vec4(way[0], way[1], way[2], 0.0)

    return look_across


def make_push(sums: PairSums, solids: tuple[int, ...]) -> wp.Kernel:
    """The kernel that sums the fluid's forces on the particles of bodies, given the kinds of solids."""
    of_fluid, of_walls, of_bodies = sums.force_on_solid, sums.force_in_gap[WALLS], sums.force_in_gap[BODIES]
    gradient, seeping, creep_of_fluid = sums.gradient, sums.seeping, sums.creep_on_solid

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
        handed: wp.array(dtype=wp.vec3),
    ):
        """The fluid's force on each particle of a body, and its share of that on the walls [N], in original order.

        The opposite of what the fluid feels, and in a gap too narrow for a particle the pressure of the water in there:

        F_b = -V_b sum k_bs V_s (p_b + p_s) grad W

        over walls and other bodies. Near them half of the neighbours of b are none of the fluid's: without these a ball
        on the floor has two fifths of its lift. A pair counts where none of the two has its fluid behind it, seen
        across the gap: what lies on the bottom of a hull is not lifted through that.

        sum V grad W over all that is around b is nothing, but where a gap is open and no particle is in it. What is
        missing there is water at the same pressure: k_b makes the sum over the others so much longer, and a pair has
        the mean of both its ends', one with a wall the body's.

        Water gets between faces that touch, farther than the fluid is within reach of: a particle there takes its
        pressure from those of its body that are at the gap, too, as it would from fluid, one step after the other. A
        dry particle of a wall has the pressure of the one that it pushes, but for the height between them.
        A wet one hands on the mean of its fluid's and theirs: a single particle of fluid that is pressed in between
        faces has a pressure of its own, which says nothing about the gap.

        `handed` is the pressure that it hands on, `DRY` if it has none or is at no gap, over how many others it came,
        and k_b.
        """
        s = first + wp.tid()
        p = load_record(bodies.point, s)
        m = load_record(bodies.motion, s)
        e = load_record(bodies.across, s)
        x, v = wp.vec3(p[0], p[1], p[2]), wp.vec3(m[0], m[1], m[2])
        i = bodies.order[s]
        world = bodies.world[i]
        weight_of_water, least = rest_density[world] * gravity[world], -method.background_pressure
        if wp.static(sums.several):
            weight_of_water = bodies.liquid[s][0] * gravity[world]
        wet = m[3] > 0.5 * DRY
        pressure = m[3] if wet else load_record(bodies.handed, s)[0]
        own = pressure - 2.0 * least
        total, in_gap = wp.vec3(0.0, 0.0, 0.0), wp.vec3(0.0, 0.0, 0.0)
        to_hand = wp.vec3(DRY, 0.0, 1.0)
        if wet:
            viscous = viscosities(method, rest_density[world], viscosity[world])
            if wp.static(sums.several):
                viscous = viscosities(method, 1.0, wp.static(0.0 if sums.yields else 1.0))
            total = of_fluid(grid, bodies, fluid, s, world, method.shape, x, v, own, viscous)
            if wp.static(sums.yields):
                c = load_record(bodies.creep, s)
                u, creep = wp.vec3(c[0], c[1], c[2]), viscosities(method, 0.0, 1.0)
                total += creep_of_fluid(grid, bodies, fluid, s, world, method.shape, x, u, 0.0, creep)
        if e[0] != 0.0 or e[1] != 0.0 or e[2] != 0.0:
            given = wp.vec3(pressure, least, 0.0)
            others = of_bodies(grid, bodies, bodies, s, world, method.shape, x, given, own, weight_of_water)
            at_walls = Gap()
            if wp.static(WALLS in solids):
                if is_near(grid, walls, world, x):
                    at_walls = of_walls(grid, bodies, walls, s, world, method.shape, x, given, own, weight_of_water)
            if pressure > 0.5 * DRY:
                total += wp.vec3(others[0], others[1], others[2])
                in_gap = wp.vec3(at_walls[0], at_walls[1], at_walls[2])
            if others[3] + at_walls[3] > 0.0:
                near = seeping(grid, bodies, bodies, s, world, method.shape, x, given, own, weight_of_water)
                if wet:
                    of_water = load_record(bodies.facing, s)[3]
                    to_hand = wp.vec3((of_water * m[3] + near[1]) / (of_water + near[0]), 0.0, 1.0)
                elif near[0] > 0.0 and near[2] < MOST_HOPS:
                    to_hand = wp.vec3(wp.max(near[1] / near[0], least), near[2] + 1.0, 1.0)
                around = gradient(grid, bodies, fluid, s, world, method.shape, x, given, own, weight_of_water)
                to_hand[2] = _widening(others + at_walls, around)
        handed[i] = to_hand
        force[i] = p[3] * (total + in_gap)
        if wp.static(WALLS in solids):
            on_walls[i] = -p[3] * in_gap

    return push
