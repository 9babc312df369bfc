"""How a sum finds its neighbours: a walk over the cells around it, or a list made once and kept (Verlet 1967).

A GPU walks: fine cells trim the search close to the sphere, and no list takes memory. A CPU keeps lists: found once,
they serve every sum until a particle has moved half the skin. Both look the same to a sum, which loops over runs of
entries.
"""

from dataclasses import dataclass

import warp as wp

from wsim.kernels.sph.grid import Grid, nearest_image
from wsim.kernels.sph.pair_sums import OPTIONS, Pairs, PairSums
from wsim.kernels.sph.records import load_record
from wsim.kernels.sph.rows import Rows


@wp.struct
class Neighborhood:
    """What a search needs. A list entry is a sorted index; the list of particle s begins at `s * capacity`."""

    grid: Grid
    cell_start: wp.array(dtype=int)
    fluid_before: wp.array(dtype=int)  # how many fluid particles stand before each sorted index; for walks alone
    order: wp.array(dtype=int)  # sorted index -> original index
    particle_world: wp.array(dtype=int)
    entry: wp.array(dtype=int)
    entry_count: wp.array(dtype=int)
    capacity: int
    fluid_count: int


@wp.func
def _list_runs(nb: Neighborhood, x: wp.vec3) -> int:
    return 1


@wp.func
def _list_span(nb: Neighborhood, s: int, world: int, x: wp.vec3, run: int) -> wp.vec2i:
    base = s * nb.capacity
    return wp.vec2i(base, base + nb.entry_count[s])


@dataclass(frozen=True)
class Search:
    """The functions that a sum is built with.

    `runs(nb, x)`: how many runs there are; `span(nb, s, world, x, run)`: first and past-the-last entry of one;
    `fluid_span`: the same, empty where a run holds no fluid.
    """

    runs: wp.Function
    span: wp.Function
    fluid_span: wp.Function


def make_search(lists: bool, rows: Rows) -> Search:
    """Search by kept lists or by walking cells."""
    if lists:
        return Search(_list_runs, _list_span, _list_span)
    count, row_span = rows.count, rows.span

    @wp.func
    def runs(nb: Neighborhood, x: wp.vec3) -> int:
        return count(nb.grid, x)

    @wp.func
    def span(nb: Neighborhood, s: int, world: int, x: wp.vec3, run: int) -> wp.vec2i:
        return row_span(nb.grid, nb.cell_start, world, x, run)

    @wp.func
    def fluid_span(nb: Neighborhood, s: int, world: int, x: wp.vec3, run: int) -> wp.vec2i:
        row = row_span(nb.grid, nb.cell_start, world, x, run)
        if nb.fluid_before[row[0]] == nb.fluid_before[row[1]]:
            return wp.vec2i(0, 0)
        return row

    return Search(runs, span, fluid_span)


@wp.func
def pairs_of(
    nb: Neighborhood, point: wp.array(dtype=wp.vec4), motion: wp.array(dtype=wp.vec4), shape: wp.vec3
) -> Pairs:
    """What the loops over pairs read."""
    pairs = Pairs()
    pairs.entry = nb.entry
    pairs.point = point
    pairs.motion = motion
    pairs.shape = shape
    pairs.period = nb.grid.period
    pairs.inv_period = nb.grid.inv_period
    return pairs


def make_find_neighbors(rows: Rows, sums: PairSums) -> wp.Kernel:
    """The kernel that makes the lists."""
    count_runs, row_span, find = rows.count, rows.span, sums.find

    @wp.kernel(enable_backward=False, module="unique", module_options=OPTIONS)
    def find_neighbors(
        # Data in:
        first: int,
        nb: Neighborhood,
        point: wp.array(dtype=wp.vec4),
        # Data out:
        entry: wp.array(dtype=int),
        entry_count: wp.array(dtype=int),
        overflow: wp.array(dtype=int),
    ):
        """List what is within the grid's search radius of each particle; a boundary particle lists fluid alone."""
        s = first + wp.tid()
        p = load_record(point, s)
        x = wp.vec3(p[0], p[1], p[2])
        fluid = p[3] > 0.0
        world = nb.particle_world[nb.order[s]]
        pairs = pairs_of(nb, point, point, wp.vec3(0.0, 0.0, nb.grid.support * nb.grid.support))
        pairs.entry = entry
        base = s * nb.capacity
        count = int(0)
        for run in range(count_runs(nb.grid, x)):
            span = row_span(nb.grid, nb.cell_start, world, x, run)
            count = find(pairs, span[0], span[1], x, s, fluid, base, nb.capacity, count)
        entry_count[s] = wp.min(count, nb.capacity)
        if count > nb.capacity:
            wp.atomic_max(overflow, 0, count)

    return find_neighbors


@wp.kernel(enable_backward=False)
def find_boundary(
    # Data in:
    fluid_before: wp.array(dtype=int),
    # Data out:
    slot: wp.array(dtype=int),
):
    """Sorted indices of the boundary particles, in order: a sum over them alone fills a GPU's warps."""
    s = wp.tid()
    before = fluid_before[s]
    if fluid_before[s + 1] == before:
        slot[s - before] = s


@wp.kernel(enable_backward=False)
def largest_move(
    # Data in:
    nb: Neighborhood,
    point: wp.array(dtype=wp.vec4),
    point_at_build: wp.array(dtype=wp.vec4),
    # Data out:
    move2: wp.array(dtype=float),
):
    """Largest squared distance from where the lists of a world were made [m^2]; infinite if it is not a number."""
    s = wp.tid()
    p = point[s]
    q = point_at_build[s]
    d = nearest_image(wp.vec3(p[0] - q[0], p[1] - q[1], p[2] - q[2]), nb.grid.period)
    d2 = wp.dot(d, d)
    if not wp.isfinite(d2):
        d2 = wp.inf
    world = nb.particle_world[nb.order[s]]
    if d2 > move2[world]:
        wp.atomic_max(move2, world, d2)
