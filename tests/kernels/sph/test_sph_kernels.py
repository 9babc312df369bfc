"""The kernel's norm, the neighbour search against brute force, the equation of state."""

import math

import numpy as np
import pytest
import warp as wp

from wsim.kernels.sph.density import density_at, pressure_of
from wsim.kernels.sph.grid import Grid, assign_cells
from wsim.kernels.sph.neighbors import find_neighbors
from wsim.kernels.sph.wendland import wendland, wendland_slope


@wp.kernel
def _evaluate(r: wp.array(dtype=float), h: float, norm: float, w: wp.array(dtype=float), slope: wp.array(dtype=float)):
    i = wp.tid()
    w[i] = wendland(r[i], h, norm)
    slope[i] = wendland_slope(r[i], h, norm)


@wp.kernel
def _round_trip(pressure: wp.array(dtype=float), back: wp.array(dtype=float)):
    i = wp.tid()
    back[i] = pressure_of(density_at(pressure[i], 1000.0, 20.0), 1000.0, 20.0)


def test_wendland_integrates_to_one_and_its_slope_is_its_derivative():
    h = 0.1
    r = np.linspace(0.0, 0.25, 5001)
    w, slope = wp.zeros(len(r), dtype=float, device="cpu"), wp.zeros(len(r), dtype=float, device="cpu")
    norm = 21.0 / (16.0 * math.pi * h**3)
    wp.launch(_evaluate, len(r), [wp.array(r, dtype=float, device="cpu"), h, norm, w, slope], device="cpu")
    assert np.trapezoid(4.0 * math.pi * r**2 * w.numpy(), r) == pytest.approx(1.0, abs=1e-4)
    derivative = np.gradient(w.numpy().astype(float), r)
    inner = slice(10, -10)
    assert np.abs(slope.numpy()[inner] * r[inner] - derivative[inner]).max() < 2e-3 * np.abs(derivative).max()
    assert (w.numpy()[r > 2.0 * h] == 0.0).all()


def test_pressure_and_density_are_inverse():
    pressure = np.linspace(0.0, 20_000.0, 50)
    back = wp.zeros(len(pressure), dtype=float, device="cpu")
    wp.launch(_round_trip, len(pressure), [wp.array(pressure, dtype=float, device="cpu"), back], device="cpu")
    assert back.numpy() == pytest.approx(pressure, abs=0.05)  # float32: 1e-7 of rho c^2 = 400 kPa


@pytest.mark.parametrize("reach", [1, 2, 3])
def test_neighbour_lists_equal_brute_force(reach):
    """Also for particles far outside the grid, and with two worlds at the same place."""
    rng = np.random.default_rng(7)
    fluid = rng.uniform(-0.6, 0.6, (400, 3)).astype(np.float32)  # the grid covers half of it
    boundary = rng.uniform(-0.5, 0.5, (150, 3)).astype(np.float32)
    world = np.concatenate([rng.integers(0, 2, 400), rng.integers(0, 2, 150)]).astype(np.int32)
    support, n = 0.15, 550
    grid = Grid()
    grid.origin, grid.support, grid.reach = wp.vec3(-0.3, -0.3, -0.3), support, reach
    grid.cell = support / reach
    grid.inv_cell = 1.0 / grid.cell
    grid.nx = grid.ny = grid.nz = math.ceil(0.6 / grid.cell)
    cells = 2 * grid.nx**3
    device = "cpu"
    key, order = (wp.empty(2 * n, dtype=int, device=device) for _ in range(2))
    histogram, start = (wp.zeros(cells + 1, dtype=int, device=device) for _ in range(2))
    worlds = wp.array(world, dtype=int, device=device)
    arrays = [wp.array(fluid, dtype=wp.vec3, device=device), wp.array(boundary, dtype=wp.vec3, device=device)]
    wp.launch(assign_cells, n, [grid, 400, *arrays, worlds], [key, order, histogram], device=device)
    wp.utils.array_scan(histogram, start, inclusive=False)
    wp.utils.radix_sort_pairs(key, order, n)

    sorted_index = order.numpy()[:n]
    everything = np.concatenate([fluid, boundary])[sorted_index]
    kind = (sorted_index >= 400).astype(np.int32)
    point = wp.array(np.pad(everything, ((0, 0), (0, 1))), dtype=wp.vec4, device=device)
    capacity = 200
    found, count, overflow = (
        wp.zeros(n * capacity, dtype=int, device=device),
        wp.zeros(n, dtype=int, device=device),
        wp.zeros(1, dtype=int, device=device),
    )
    inputs = [0, grid, start, order, worlds, point, wp.array(kind, dtype=int, device=device)]
    inputs += [capacity, wp.vec2i(capacity, 1)]
    wp.launch(find_neighbors, n, inputs, [found, count, overflow], device=device)

    assert overflow.numpy()[0] == 0
    distance = np.linalg.norm(everything[:, None].astype(float) - everything[None].astype(float), axis=2)
    same_world = world[sorted_index][:, None] == world[sorted_index][None]
    useful = (kind[:, None] == 0) | (kind[None] == 0)
    expected = (distance < support) & same_world & useful & ~np.eye(n, dtype=bool)
    lists = found.numpy().reshape(n, capacity)
    for s in range(n):
        entries = lists[s, : count.numpy()[s]]
        indices = np.where(entries < 0, ~entries, entries)
        assert sorted(indices) == list(np.flatnonzero(expected[s]))
        assert ((entries < 0) == (kind[indices] == 1)).all()


def test_overflow_is_reported_and_nothing_is_written_past_the_list():
    n, capacity, device = 50, 10, "cpu"
    point = wp.zeros(n, dtype=wp.vec4, device=device)
    grid = Grid()
    grid.support, grid.cell, grid.inv_cell, grid.reach = 1.0, 1.0, 1.0, 1
    grid.nx = grid.ny = grid.nz = 1
    start = wp.array([0, n], dtype=int, device=device)
    zeros = wp.zeros(n, dtype=int, device=device)
    order = wp.array(np.arange(n), dtype=int, device=device)
    found = wp.full(n * capacity, -77, dtype=int, device=device)
    count, overflow = wp.zeros(n, dtype=int, device=device), wp.zeros(1, dtype=int, device=device)
    inputs = [0, grid, start, order, zeros, point, zeros, capacity - 2, wp.vec2i(capacity, 1)]
    wp.launch(find_neighbors, n, inputs, [found, count, overflow], device=device)
    assert overflow.numpy()[0] == n - 1
    assert (count.numpy() == capacity - 2).all()
    assert (found.numpy().reshape(n, capacity)[:, capacity - 2 :] == -77).all()
