"""How a sum finds its neighbours: a walk over the cells around it, or a list made once and kept (Verlet 1967).

A GPU walks: fine cells trim the search close to the sphere, and no list takes memory. A CPU keeps lists: found once,
they serve every sum until a particle has moved half the skin. `pair_sums` has the loops of both.
"""

from dataclasses import dataclass

import warp as wp

from wsim.kernels.sph.grid import Grid, nearest_image
from wsim.kernels.sph.pair_sums import PairSums
from wsim.kernels.sph.records import load_record
from wsim.kernels.sph.species import BODIES, WALLS, Species


@dataclass(frozen=True)
class Finders:
    """The kernels that make the lists of the particles of each kind."""

    of_fluid: wp.Kernel
    of_walls: wp.Kernel
    of_bodies: wp.Kernel


def make_finders(sums: PairSums, solids: tuple[int, ...]) -> Finders:
    """The kernels that list what is within the grid's search radius of each particle, given the kinds of solids."""
    find = sums.find

    @wp.kernel(**sums.options)
    def find_neighbors(
        # Data in:
        first: int,
        grid: Grid,
        walls: Species,
        bodies: Species,
        # Data in and out (lists are written):
        fluid: Species,
        # Data out:
        overflow: wp.array(dtype=int),
    ):
        """List the neighbours of each fluid particle: fluid, walls, bodies."""
        s = first + wp.tid()
        p = load_record(fluid.point, s)
        x = wp.vec3(p[0], p[1], p[2])
        world = fluid.world[fluid.order[s]]
        to_fluid = find(grid, fluid, fluid, s, world, x, s, 0)
        to_walls = to_fluid
        if wp.static(WALLS in solids):
            to_walls = find(grid, fluid, walls, s, world, x, -1, to_fluid)
        total = to_walls
        if wp.static(BODIES in solids):
            total = find(grid, fluid, bodies, s, world, x, -1, to_walls)
        if total > fluid.capacity:
            wp.atomic_max(overflow, 0, total)
        to_fluid, to_walls = wp.min(to_fluid, fluid.capacity), wp.min(to_walls, fluid.capacity)
        fluid.entry_count[s] = wp.vec3i(to_fluid, to_walls - to_fluid, wp.min(total, fluid.capacity) - to_walls)

    @wp.kernel(**sums.options)
    def find_fluid(
        # Data in:
        first: int,
        grid: Grid,
        fluid: Species,
        # Data in and out (lists are written):
        walls: Species,
        # Data out:
        overflow: wp.array(dtype=int),
    ):
        """List the fluid near each particle of a wall."""
        s = first + wp.tid()
        p = load_record(walls.point, s)
        x = wp.vec3(p[0], p[1], p[2])
        total = find(grid, walls, fluid, s, walls.world[walls.order[s]], x, -1, 0)
        if total > walls.capacity:
            wp.atomic_max(overflow, 0, total)
        walls.entry_count[s] = wp.vec3i(wp.min(total, walls.capacity), 0, 0)

    @wp.kernel(**sums.options)
    def find_all(
        # Data in:
        first: int,
        grid: Grid,
        fluid: Species,
        walls: Species,
        # Data in and out (lists are written):
        bodies: Species,
        # Data out:
        overflow: wp.array(dtype=int),
    ):
        """List the neighbours of each particle of a body: fluid, walls, and its own kind, itself left out."""
        s = first + wp.tid()
        p = load_record(bodies.point, s)
        x = wp.vec3(p[0], p[1], p[2])
        world = bodies.world[bodies.order[s]]
        to_fluid = find(grid, bodies, fluid, s, world, x, -1, 0)
        to_walls = to_fluid
        if wp.static(WALLS in solids):
            to_walls = find(grid, bodies, walls, s, world, x, -1, to_fluid)
        total = find(grid, bodies, bodies, s, world, x, s, to_walls)
        if total > bodies.capacity:
            wp.atomic_max(overflow, 0, total)
        to_fluid, to_walls = wp.min(to_fluid, bodies.capacity), wp.min(to_walls, bodies.capacity)
        bodies.entry_count[s] = wp.vec3i(to_fluid, to_walls - to_fluid, wp.min(total, bodies.capacity) - to_walls)

    return Finders(find_neighbors, find_fluid, find_all)


@wp.kernel(enable_backward=False)
def largest_move(
    # Data in:
    grid: Grid,
    species: Species,
    point_at_build: wp.array(dtype=wp.vec4),
    # Data out:
    move2: wp.array(dtype=float),
):
    """Largest squared distance from where the lists of a world were made [m^2]; infinite if it is not a number."""
    s = wp.tid()
    p = species.point[s]
    q = point_at_build[s]
    d = nearest_image(wp.vec3(p[0] - q[0], p[1] - q[1], p[2] - q[2]), grid.period)
    d2 = wp.dot(d, d)
    if not wp.isfinite(d2):
        d2 = wp.inf
    world = species.world[species.order[s]]
    if d2 > move2[world]:
        wp.atomic_max(move2, world, d2)
