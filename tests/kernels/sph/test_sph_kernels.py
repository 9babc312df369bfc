"""The kernel function's norm and slope, neighbour lists against brute force, walks against lists."""

import math

import numpy as np
import pytest
import warp as wp

from wsim.kernels.sph.density import Method
from wsim.kernels.sph.grid import Grid, wrap
from wsim.kernels.sph.pair_sums import make_pair_sums
from wsim.kernels.sph.programs import Programs
from wsim.kernels.sph.push import gather_bodies
from wsim.kernels.sph.species import BODIES, DRY, FLUID, WALLS, Species
from wsim.solvers.sph_config import ConfigSPH
from wsim.solvers.sph_domain import make_grid
from wsim.solvers.sph_particles import SortedParticles

DEVICE = "cpu"
OPEN = (False, False, False)
SUMS = make_pair_sums(lists=True, periodic=OPEN, branch=False, reach=(1, 1))
KINDS = ("fluid", "walls", "bodies")


@wp.kernel(enable_backward=False)
def _of_one_neighbor(water: Species, shape: wp.vec3, weight: wp.array(dtype=float), force: wp.array(dtype=wp.vec3)):
    """What a particle at the origin takes from the neighbour that particle k lists."""
    k = wp.tid()
    none = wp.vec3(0.0, 0.0, 0.0)
    sums = wp.static(SUMS.extrapolation)(Grid(), water, water, k, 0, shape, none, none, 0.0, none)
    weight[k] = sums[0]
    viscosity = wp.vec3(0.0, 0.0, 1.0)
    force[k] = wp.static(SUMS.force[FLUID])(Grid(), water, water, k, 0, shape, none, none, 1.0, viscosity)


@pytest.mark.parametrize("dimensions", [2, 3])
def test_kernel_integrates_to_one_and_the_force_follows_its_slope(dimensions):
    config = ConfigSPH(spacing=0.1, speed_of_sound=1.0, dimensions=dimensions)
    r = np.linspace(0.0, 1.2 * config.support, 4001)
    n, h = len(r), config.smoothing_length
    shape = wp.vec3(1.0 / config.support, -5.0 * config.kernel_norm / h**2, config.support**2)
    with wp.ScopedDevice(DEVICE):
        water = Species()
        water.point = wp.array(np.stack([r, 0 * r, 0 * r, 0 * r + 1.0], axis=1), dtype=wp.vec4)
        water.motion, water.entry = wp.zeros(n, dtype=wp.vec4), wp.array(np.arange(n), dtype=int)
        water.entry_count, water.capacity = wp.array(np.tile((1, 0, 0), (n, 1)), dtype=wp.vec3i), 1
        weight, force = wp.zeros(n, dtype=float), wp.zeros(n, dtype=wp.vec3)
        wp.launch(_of_one_neighbor, n, [water, shape], [weight, force])

    w = config.kernel_norm * weight.numpy().astype(float)
    shell = 4.0 * math.pi * r**2 if dimensions == 3 else 2.0 * math.pi * r
    assert np.trapezoid(shell * w, r) == pytest.approx(1.0, abs=1e-4)
    assert (w[r > config.support] == 0.0).all()
    # Unit volume and unit pressure: the force along x is -dW/dx of a neighbour at +x, that is +W'(r).
    derivative = np.gradient(w, r)
    inner = slice(10, -10)
    assert np.abs(force.numpy()[inner, 0] - derivative[inner]).max() < 2e-3 * np.abs(derivative).max()


def random_particles(periodic: bool):
    """Places and worlds of fluid, walls and bodies, in two worlds at one place, some of it outside an open grid."""
    rng = np.random.default_rng(7)
    ends = ((-0.5, 0.5),) * 3 if periodic else (None,) * 3
    config = ConfigSPH(spacing=0.1, speed_of_sound=1.0, smoothing_ratio=1.25, periodic=ends)
    places, worlds = [], []
    for kind, n in zip(KINDS, (500, 150, 80), strict=True):
        wide = 1.0 if periodic or kind == "fluid" else 1.8
        # Bodies are in one corner: much of the fluid is far from them.
        corner = 0.45 if kind == "bodies" else 0.0
        places.append((wide * rng.uniform(-0.5 + corner, 0.5, (n, 3))).astype(np.float32))
        worlds.append(rng.integers(0, 2, n))
    return config, places, worlds


def sorted_world(config: ConfigSPH, places, worlds, lists: bool, several: bool = False):
    """The three kinds on the CPU, sorted, with random motions and volumes, and the kernels for them."""
    fluid = places[0]
    grid = make_grid(config, fluid.min(axis=0), fluid.max(axis=0), config.support, not lists, 2)
    rng, kinds = np.random.default_rng(3), []
    with wp.ScopedDevice(DEVICE):
        for place, world, name in zip(places, worlds, (FLUID, WALLS, BODIES), strict=True):
            kind = SortedParticles(world, grid, 2, 400 if lists else 0, name, several=several)
            position = wp.array(place, dtype=wp.vec3)
            kind.sort(position, 0, 2)
            if not lists:
                kind.mark(position)
            order = kind.order.numpy()
            volume = rng.uniform(0.5, 1.5, kind.count) * config.spacing**3
            kind.point.assign(np.column_stack([place, volume]).astype(np.float32)[order])
            kind.motion.assign(rng.normal(size=(kind.count, 4)).astype(np.float32)[order])
            if several:
                liquid = np.stack([rng.choice([700.0, 1000.0], kind.count), rng.uniform(0.0, 3.0, kind.count)], axis=1)
                kind.liquid.assign(liquid.astype(np.float32)[order])
            if kind.full.shape[0]:
                kind.full.assign(rng.uniform(size=kind.count).astype(np.float32)[order])
            kinds.append(kind)
        reach = int(grid.reach[1]), int(grid.reach[2])
        programs = Programs.make(lists, tuple(map(bool, config.periodic)), not lists, reach, (WALLS, BODIES), several)
        if lists:
            overflow = wp.zeros(1, dtype=int)
            water, walls, bodies = (kind.species for kind in kinds)
            wp.launch(programs.find.of_fluid, kinds[0].count, [0, grid, walls, bodies], [water, overflow])
            finders = ((programs.find.of_walls, [water]), (programs.find.of_bodies, [water, walls]))
            for kind, (find, others) in zip(kinds[1:], finders, strict=True):
                wp.launch(find, kind.count, [0, grid, *others], [kind.species, overflow])
            assert overflow.numpy()[0] == 0
    return grid, kinds, programs


@pytest.mark.parametrize("periodic", [False, True])
def test_neighbour_lists_equal_brute_force(periodic):
    config, places, worlds = random_particles(periodic)
    _, kinds, _ = sorted_world(config, places, worlds, lists=True)
    found = 0
    for own, kind in enumerate(kinds):
        entry = kind.species.entry.numpy().reshape(kind.count, -1)
        counts = kind.species.entry_count.numpy()
        first = np.cumsum(counts, axis=1) - counts
        for other, others in enumerate(kinds):
            here, there = kind.order.numpy(), others.order.numpy()
            apart = places[own][here][:, None].astype(float) - places[other][there][None]
            if periodic:
                apart -= np.rint(apart)
            expected = np.linalg.norm(apart, axis=2) < config.support
            expected &= worlds[own][here][:, None] == worlds[other][there][None]
            if own == other:
                np.fill_diagonal(expected, False)
            if KINDS[own] == "walls" and other:  # they list the fluid alone
                expected[:] = False
            for s in range(kind.count):
                listed = entry[s, first[s, other] : first[s, other] + counts[s, other]]
                assert sorted(listed) == list(np.flatnonzero(expected[s]))
            found += expected.sum()
    assert found > 5000


def test_a_walk_passes_over_blocks_that_are_far_from_bodies():
    config, places, worlds = random_particles(periodic=False)
    _, (_, _, bodies), _ = sorted_world(config, places, worlds, lists=False)
    near = bodies.near.numpy()
    assert 0 < near.sum() < 0.8 * len(near)


@pytest.mark.parametrize(("periodic", "several"), [(False, False), (True, False), (False, True)])
def test_walking_the_cells_gives_the_sums_of_the_lists(periodic, several):
    """The walk is what a GPU does; here it runs on the CPU, over other cells."""
    config, places, worlds = random_particles(periodic)
    results = []
    for lists in (True, False):
        grid, kinds, programs = sorted_world(config, places, worlds, lists, several)
        fluid, walls, bodies = (kind.species for kind in kinds)
        n, method = kinds[0].count, Method()
        method.h, method.speed_of_sound, method.diffusion = config.smoothing_length, 3.0, 0.1
        method.shape = wp.vec3(1.0 / config.support, -5.0 * config.kernel_norm / method.h**2, config.support**2)
        method.artificial_viscosity, method.laminar_factor = 0.1, 10.0
        with wp.ScopedDevice(DEVICE):
            density, viscosity = (wp.full(2, v, dtype=float) for v in (1000.0, 2.0))
            gravity = wp.array([(0.0, 0.0, -9.8)] * 2, dtype=wp.vec3)
            pressure, pushes = wp.zeros(n, dtype=float), [wp.zeros(kinds[2].count, dtype=wp.vec3) for _ in range(2)]
            owner, handed = handed_on(kinds[2])
            moved, mass = [wp.zeros(n, dtype=wp.vec3) for _ in range(3)], wp.full(n, 0.1, dtype=float)
            shared = [0, grid, method, density]
            wp.launch(programs.compress, kinds[1].count, [*shared, gravity, fluid, walls], [walls.motion])
            given_back = original(kinds[1], walls.motion)[:, 3]
            assert (given_back != 0.0).any()
            inputs = [*shared, gravity, fluid, walls, bodies, 1e-3]
            full = wp.zeros(n, dtype=float)
            wp.launch(programs.continuity, n, inputs, [pressure, full])
            wp.launch(gather_bodies, kinds[2].count, [bodies.order, owner, handed], [bodies.handed])
            for kind in kinds[1:]:
                inputs = [*shared, viscosity, gravity, fluid, kind.species]
                wp.launch(programs.extrapolate, kind.count, inputs, [kind.motion, kind.facing, kind.liquid])
            parch(kinds[2])
            inputs = [*shared, viscosity, gravity, fluid, walls, bodies, mass, 1e-3]
            wp.launch(programs.momentum, n, inputs, moved)
            wp.launch(programs.look_across, kinds[2].count, [0, grid, method, walls, bodies], [bodies.across])
            inputs = [*shared, viscosity, gravity, fluid, walls, bodies]
            wp.launch(programs.push, kinds[2].count, inputs, [*pushes, handed])
            seeped = np.maximum(handed.numpy(), -1e3)
            assert 5 < np.count_nonzero(seeped[:, 1]) < np.count_nonzero(seeped[:, 0] > -1e3) < kinds[2].count
        solid = [original(kind, kind.facing) for kind in kinds[1:]]
        solid += [np.maximum(original(kind, kind.motion), -1e3) for kind in kinds[1:]]
        if several:
            solid += [original(kind, kind.liquid) for kind in kinds[1:]]
        found = [given_back, original(kinds[0], pressure), *solid, original(kinds[2], bodies.across), *seeped.T]
        results.append([*found, *(a.numpy() for a in (*moved, *pushes))])
    for of_lists, of_walk in zip(*results, strict=True):
        assert np.abs(of_walk - of_lists).max() < 2e-5 * np.abs(of_lists).max()


def handed_on(kind: SortedParticles) -> tuple[wp.array, wp.array]:
    """Bodies of particles, four in all, and what these handed on: half of them nothing."""
    rng = np.random.default_rng(11)
    owner = wp.array(rng.integers(0, 4, kind.count).astype(np.int32), dtype=int)
    values = np.column_stack([rng.uniform(low, high, kind.count) for low, high in ((0, 2), (0, 70), (0.5, 3))])
    values[rng.random(kind.count) < 0.5] = DRY, 0.0, 1.0
    return owner, wp.array(values.astype(np.float32), dtype=wp.vec3)


def parch(kind: SortedParticles) -> None:
    """Take the fluid from half of the particles."""
    dry = (np.random.default_rng(13).random(kind.count) < 0.5)[kind.order.numpy()]
    motion, facing = kind.motion.numpy(), kind.facing.numpy()
    motion[dry, 3], facing[dry, :3] = DRY, 0.0
    kind.motion.assign(motion)
    kind.facing.assign(facing)


def original(kind: SortedParticles, values: wp.array) -> np.ndarray:
    """Sorted values in original order."""
    return values.numpy()[np.argsort(kind.order.numpy())]


def test_overflow_is_reported_and_nothing_is_written_past_the_list():
    n, capacity = 50, 10
    grid, fluid = Grid(), Species()
    grid.count, grid.reach, grid.cell = wp.vec3i(1, 1, 1), wp.vec3i(0, 0, 0), wp.vec3(1.0, 1.0, 1.0)
    grid.inv_cell, grid.support = wp.vec3(1.0, 1.0, 1.0), 1.0
    with wp.ScopedDevice(DEVICE):
        fluid.cell_start, fluid.order = wp.array([0, n], dtype=int), wp.array(np.arange(n), dtype=int)
        fluid.world, fluid.capacity = wp.zeros(n, dtype=int), capacity - 2
        fluid.entry, fluid.entry_count = wp.full(n * capacity, -77, dtype=int), wp.zeros(n, dtype=wp.vec3i)
        fluid.point = wp.array([(0.5, 0.5, 0.5, 1.0)] * n, dtype=wp.vec4)
        overflow = wp.zeros(1, dtype=int)
        programs = Programs.make(True, OPEN, False, (0, 0), ())
        wp.launch(programs.find.of_fluid, n, [0, grid, Species(), Species()], [fluid, overflow])
    assert overflow.numpy()[0] == n - 1
    assert (fluid.entry_count.numpy() == (capacity - 2, 0, 0)).all()
    assert (fluid.entry.numpy()[n * (capacity - 2) :] == -77).all()


@wp.kernel
def _wrap(grid: Grid, x: wp.array(dtype=wp.vec3)):
    x[wp.tid()] = wrap(grid, x[wp.tid()])


def test_periodic_positions_come_back_into_the_box():
    config = ConfigSPH(spacing=0.05, speed_of_sound=1.0, periodic=((0.0, 1.0), None, (-2.0, 1.0)))
    grid = make_grid(config, np.zeros(3), np.ones(3), config.support, False, 1)
    x = wp.array([(1.25, 9.0, 1.5), (-0.25, -9.0, -2.5)], dtype=wp.vec3, device=DEVICE)
    wp.launch(_wrap, 2, [grid, x], device=DEVICE)
    assert x.numpy() == pytest.approx(np.array([(0.25, 9.0, -1.5), (0.75, -9.0, 0.5)]), abs=1e-6)
