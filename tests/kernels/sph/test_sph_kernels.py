"""The kernel function's norm and slope, neighbour lists against brute force, walks against lists."""

import math

import numpy as np
import pytest
import warp as wp

from wsim.kernels.sph.density import Method
from wsim.kernels.sph.grid import Grid, assign_cells, wrap
from wsim.kernels.sph.neighbors import Neighborhood
from wsim.kernels.sph.pair_sums import Pairs, make_pair_sums
from wsim.kernels.sph.programs import Programs
from wsim.solvers.sph_config import ConfigSPH
from wsim.solvers.sph_domain import make_grid

DEVICE = "cpu"
OPEN = (False, False, False)
SUMS = make_pair_sums(lists=True, periodic=OPEN, branch=False, bodies=True)


@wp.kernel(enable_backward=False)
def _of_one_neighbor(
    entry: wp.array(dtype=int),
    point: wp.array(dtype=wp.vec4),
    motion: wp.array(dtype=wp.vec4),
    shape: wp.vec3,
    weight: wp.array(dtype=float),
    force: wp.array(dtype=wp.vec3),
):
    """What a particle at the origin takes from neighbour k alone."""
    k = wp.tid()
    none = wp.vec3(0.0, 0.0, 0.0)
    pairs = Pairs()
    pairs.entry = entry
    pairs.point = point
    pairs.motion = motion
    pairs.shape = shape
    sums = wp.static(SUMS.extrapolation)(pairs, k, k + 1, none, none)
    weight[k] = sums[0]
    force[k] = wp.static(SUMS.force)(pairs, k, k + 1, none, none, 1.0, wp.vec3(0.0, 0.0, 1.0), 1.0)


@pytest.mark.parametrize("dimensions", [2, 3])
def test_kernel_integrates_to_one_and_the_force_follows_its_slope(dimensions):
    config = ConfigSPH(spacing=0.1, speed_of_sound=1.0, dimensions=dimensions)
    r = np.linspace(0.0, 1.2 * config.support, 4001)
    n, h = len(r), config.smoothing_length
    point = wp.array(np.stack([r, 0 * r, 0 * r, 0 * r + 1.0], axis=1), dtype=wp.vec4, device=DEVICE)
    motion, entry = wp.zeros(n, dtype=wp.vec4, device=DEVICE), wp.array(np.arange(n), dtype=int, device=DEVICE)
    weight, force = wp.zeros(n, dtype=float, device=DEVICE), wp.zeros(n, dtype=wp.vec3, device=DEVICE)
    shape = wp.vec3(1.0 / config.support, -5.0 * config.kernel_norm / h**2, config.support**2)
    wp.launch(_of_one_neighbor, n, [entry, point, motion, shape], [weight, force], device=DEVICE)

    w = config.kernel_norm * weight.numpy().astype(float)
    shell = 4.0 * math.pi * r**2 if dimensions == 3 else 2.0 * math.pi * r
    assert np.trapezoid(shell * w, r) == pytest.approx(1.0, abs=1e-4)
    assert (w[r > config.support] == 0.0).all()
    # Unit volume and unit pressure: the force along x is -dW/dx of a neighbour at +x, that is +W'(r).
    derivative = np.gradient(w, r)
    inner = slice(10, -10)
    assert np.abs(force.numpy()[inner, 0] - derivative[inner]).max() < 2e-3 * np.abs(derivative).max()


def sorted_world(config: ConfigSPH, fluid, boundary, world, lists: bool):
    """A neighbourhood over particles on the CPU, its records, and the original index of each."""
    n, worlds = len(fluid) + len(boundary), int(world.max()) + 1
    grid = make_grid(config, fluid.min(axis=0), fluid.max(axis=0), config.support, not lists, worlds)
    cells = math.prod(grid.count) * worlds
    order = wp.array(np.argsort(world, kind="stable"), dtype=int, device=DEVICE)
    key, value = (wp.empty(2 * n, dtype=int, device=DEVICE) for _ in range(2))
    histogram, start = (wp.zeros(cells + 1, dtype=int, device=DEVICE) for _ in range(2))
    places = [wp.array(x.astype(np.float32), dtype=wp.vec3, device=DEVICE) for x in (fluid, boundary)]
    world_of = wp.array(world, dtype=int, device=DEVICE)
    inputs = [0, grid, len(fluid), order, *places, world_of]
    wp.launch(assign_cells, n, inputs, [key, value, histogram], device=DEVICE)
    wp.utils.array_scan(histogram, start, inclusive=False)
    wp.utils.radix_sort_pairs(key, value, n)
    index = value.numpy()[:n]
    rng = np.random.default_rng(3)
    volume = np.where(np.arange(n) < len(fluid), 1.0, -1.0) * rng.uniform(0.5, 1.5, n) * config.spacing**3
    records = np.column_stack([np.concatenate([fluid, boundary]), volume]).astype(np.float32)[index]
    motions = rng.normal(size=(n, 4)).astype(np.float32)[index]
    nb = Neighborhood()
    nb.grid, nb.cell_start, nb.particle_world = grid, start, world_of
    nb.order, nb.fluid_count, nb.capacity = wp.array(index, dtype=int, device=DEVICE), len(fluid), 300
    nb.fluid_before = wp.array(np.append(0, np.cumsum(index < len(fluid))), dtype=int, device=DEVICE)
    nb.entry = wp.zeros(n * nb.capacity if lists else 0, dtype=int, device=DEVICE)
    nb.entry_count = wp.zeros(n if lists else 0, dtype=int, device=DEVICE)
    point, motion = (wp.array(a, dtype=wp.vec4, device=DEVICE) for a in (records, motions))
    reach = int(grid.reach[1]), int(grid.reach[2])
    programs = Programs.make(lists, tuple(map(bool, config.periodic)), not lists, reach, bodies=lists)
    if lists:
        overflow = wp.zeros(1, dtype=int, device=DEVICE)
        outputs = [nb.entry, nb.entry_count, overflow]
        wp.launch(programs.find_neighbors, n, [0, nb, point], outputs, device=DEVICE)
        assert overflow.numpy()[0] == 0
    return nb, point, motion, index, programs


def random_particles(periodic: bool):
    """Fluid and boundary of two worlds at the same place, some of it outside an open grid's extent."""
    rng = np.random.default_rng(7)
    fluid, boundary = rng.uniform(-0.5, 0.5, (500, 3)), rng.uniform(-0.5, 0.5, (200, 3))
    if not periodic:
        boundary *= 1.8
    world = np.concatenate([rng.integers(0, 2, 500), rng.integers(0, 2, 200)]).astype(np.int32)
    ends = ((-0.5, 0.5),) * 3 if periodic else (None,) * 3
    config = ConfigSPH(spacing=0.1, speed_of_sound=1.0, smoothing_ratio=1.25, periodic=ends)
    return config, fluid.astype(np.float32), boundary.astype(np.float32), world


@pytest.mark.parametrize("periodic", [False, True])
def test_neighbour_lists_equal_brute_force(periodic):
    config, fluid, boundary, world = random_particles(periodic)
    nb, _, _, index, _ = sorted_world(config, fluid, boundary, world, lists=True)
    n = len(index)
    place = np.concatenate([fluid, boundary])[index].astype(float)
    apart = place[:, None] - place[None]
    if periodic:
        apart -= np.rint(apart)
    is_fluid = index < len(fluid)
    expected = np.linalg.norm(apart, axis=2) < config.support
    expected &= (
        (world[index][:, None] == world[index][None]) & (is_fluid[:, None] | is_fluid[None]) & ~np.eye(n, dtype=bool)
    )
    lists, count = nb.entry.numpy().reshape(n, nb.capacity), nb.entry_count.numpy()
    assert expected.sum() > 5000
    for s in range(n):
        assert sorted(lists[s, : count[s]]) == list(np.flatnonzero(expected[s]))


@pytest.mark.parametrize("periodic", [False, True])
def test_walking_the_cells_gives_the_sums_of_the_lists(periodic):
    """The walk is what a GPU does; here it runs on the CPU, over other cells, compiled for fixed walls alone."""
    config, fluid, boundary, world = random_particles(periodic)
    results = []
    for lists in (True, False):
        nb, point, motion, index, programs = sorted_world(config, fluid, boundary, world, lists)
        n, method = len(index), Method()
        method.h, method.speed_of_sound, method.diffusion = config.smoothing_length, 3.0, 0.1
        method.shape = wp.vec3(1.0 / config.support, -5.0 * config.kernel_norm / method.h**2, config.support**2)
        method.artificial_viscosity, method.laminar_factor = 0.1, 10.0
        per_world = [wp.full(2, v, dtype=float, device=DEVICE) for v in (1000.0, 2.0)]
        gravity = wp.array([(0.0, 0.0, -9.8)] * 2, dtype=wp.vec3, device=DEVICE)
        pressure = wp.zeros(n, dtype=float, device=DEVICE)
        slot = wp.array(np.arange(n), dtype=int, device=DEVICE)
        inputs = [0, slot, nb, method, per_world[0], gravity, point, len(boundary)]
        wp.launch(programs.compress, n, inputs, [motion], device=DEVICE)
        given_back = motion.numpy()[np.argsort(index)][len(fluid) :, 3]
        assert (given_back != 0.0).any()
        inputs = [0, nb, method, per_world[0], gravity, point, motion, 1e-3]
        wp.launch(programs.continuity, n, inputs, [pressure], device=DEVICE)
        wp.launch(programs.extrapolate, n, [0, slot, nb, method, *per_world, gravity, point], [motion], device=DEVICE)
        moved = [wp.zeros(len(fluid), dtype=wp.vec3, device=DEVICE) for _ in range(2)]
        force = wp.zeros(len(boundary), dtype=wp.vec3, device=DEVICE)
        mass = wp.full(len(fluid), 0.1, dtype=float, device=DEVICE)
        inputs = [0, nb, method, *per_world, gravity, point, motion, mass, 0, 1e-3]
        wp.launch(programs.momentum, n, inputs, [*moved, force], device=DEVICE)
        back = np.argsort(index)
        results.append(
            [given_back, pressure.numpy()[back], motion.numpy()[back], *(a.numpy() for a in (*moved, force))]
        )
    for of_lists, of_walk in zip(*results, strict=True):
        assert np.abs(of_walk - of_lists).max() < 2e-5 * np.abs(of_lists).max()


def test_overflow_is_reported_and_nothing_is_written_past_the_list():
    n, capacity = 50, 10
    nb, grid = Neighborhood(), Grid()
    grid.count, grid.reach, grid.cell = wp.vec3i(1, 1, 1), wp.vec3i(0, 0, 0), wp.vec3(1.0, 1.0, 1.0)
    grid.inv_cell, grid.support = wp.vec3(1.0, 1.0, 1.0), 1.0
    nb.grid, nb.cell_start = grid, wp.array([0, n], dtype=int, device=DEVICE)
    nb.order = wp.array(np.arange(n), dtype=int, device=DEVICE)
    nb.particle_world, nb.capacity = wp.zeros(n, dtype=int, device=DEVICE), capacity - 2
    found = wp.full(n * capacity, -77, dtype=int, device=DEVICE)
    count, overflow = wp.zeros(n, dtype=int, device=DEVICE), wp.zeros(1, dtype=int, device=DEVICE)
    point = wp.array([(0.5, 0.5, 0.5, 1.0)] * n, dtype=wp.vec4, device=DEVICE)
    programs = Programs.make(True, OPEN, False, (0, 0), bodies=False)
    wp.launch(programs.find_neighbors, n, [0, nb, point], [found, count, overflow], device=DEVICE)
    assert overflow.numpy()[0] == n - 1
    assert (count.numpy() == capacity - 2).all()
    assert (found.numpy()[n * (capacity - 2) :] == -77).all()


@wp.kernel
def _wrap(grid: Grid, x: wp.array(dtype=wp.vec3)):
    x[wp.tid()] = wrap(grid, x[wp.tid()])


def test_periodic_positions_come_back_into_the_box():
    config = ConfigSPH(spacing=0.05, speed_of_sound=1.0, periodic=((0.0, 1.0), None, (-2.0, 1.0)))
    grid = make_grid(config, np.zeros(3), np.ones(3), config.support, False, 1)
    x = wp.array([(1.25, 9.0, 1.5), (-0.25, -9.0, -2.5)], dtype=wp.vec3, device=DEVICE)
    wp.launch(_wrap, 2, [grid, x], device=DEVICE)
    assert x.numpy() == pytest.approx(np.array([(0.25, 9.0, -1.5), (0.75, -9.0, 0.5)]), abs=1e-6)
