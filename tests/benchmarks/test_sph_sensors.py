"""Sensors in a tank's walls, and what is made of their pressures."""

import math

import numpy as np
import pytest

from benchmarks.sph_cases import dam_break_impact, dam_break_impact_300
from benchmarks.sph_cases.case import Value
from benchmarks.sph_cases.sensors import WallSensors
from benchmarks.sph_cases.water import add_fluid, lattice, make_builder, simulate
from wsim.solvers.shapes import OpenBox
from wsim.solvers.solver_sph import SolverSPH

RHO, G, DEPTH, WIDTH, SPACING = 1000.0, 9.81, 0.3, 0.4, 0.02


def test_sensors_read_the_weight_of_still_water():
    builder = make_builder((0.0, 0.0, -G))
    cells = lattice((0.0, 0.0, 0.0), (WIDTH, 0.0, DEPTH), SPACING, plane=True)
    add_fluid(builder, cells, RHO * SPACING**2, RHO * G * (DEPTH - cells[:, 2]))
    model = builder.finalize(device="cpu")
    tank = OpenBox(center=(0.5 * WIDTH, 0.0, 0.5 * DEPTH + 0.1), size=(WIDTH, 1.0, DEPTH + 0.2))
    config = SolverSPH.Config(spacing=SPACING, speed_of_sound=10.0 * math.sqrt(G * DEPTH), dimensions=2)
    solver, state = SolverSPH(model, config, (tank,)), model.state()
    heights = np.array([0.005, 0.03, 0.06, 0.1, 0.2])
    points = np.stack([np.full(5, WIDTH), np.zeros(5), heights], axis=1)
    high = np.array([WIDTH, 0.5, DEPTH + 0.2])
    sensors = WallSensors(solver, points, np.tile([-1.0, 0.0, 0.0], (5, 1)), high * (0, -1, 0), high)
    read = []
    steps = math.ceil(0.01 / config.max_time_step)
    simulate(
        solver,
        state,
        1.0,
        samples=100,
        observe=lambda t: read.append(sensors.read(steps)),
        after_step=lambda: sensors.feel(state.particle_q),
    )
    off = np.mean(read[50:], axis=0) / (RHO * G * (DEPTH - heights)) - 1.0
    # Beside the floor the water stands closer than on its lattice: measured 6 %, and at most 1.2 % from three on.
    assert np.abs(off[0]) < 0.1
    assert np.abs(off[2:]).max() < 0.02
    assert sensors.read(1) == pytest.approx(np.zeros(5))  # reading starts anew


def test_impact_of_a_triangle():
    t = np.linspace(0.0, 1.0, 1001)
    p = 1000.0 * np.maximum(1.0 - np.abs(t - 0.4) / 0.1, 0.0)
    impact = dam_break_impact.impact_of(t, p)
    assert (impact.peak, impact.at) == pytest.approx((1000.0, 0.4))
    assert impact.rise == pytest.approx(0.1, abs=0.003)
    assert dam_break_impact.impulse_of(t, p, 0.4) == pytest.approx(50.0, rel=1e-3)
    assert dam_break_impact.impact_of(t, p, until=0.35).peak == pytest.approx(500.0, rel=0.03)


def test_a_value_says_how_far_off_it_is():
    value = Value(12.0, 10.0, 9.0, 14.0, "Pa")
    assert (value.percent, value.spreads) == pytest.approx((20.0, 0.5))
    assert Value(8.0, 10.0, 9.0, 14.0, "Pa").spreads == pytest.approx(2.0)
    assert str(value) == "12 / 10 / 9 to 14 Pa"
    assert Value.within(11.0, -10.0, 5.0, "m").low == pytest.approx(-10.5)


def test_a_dam_break_gives_the_wall_the_impulse_of_the_experiment():
    """At 3 and 80 mm over the floor the reach, 15 %, is missed: the sheet is one or two particles thick there."""
    found = dam_break_impact_300.run("cpu", 0.01, seconds=0.75)
    # Measured: 27, 14, 4.9 and 21 %. With walls that compress what comes to them P1 is 80 % short.
    for name, limit in {"P1": 35.0, "P2": 18.0, "P3": 15.0, "P4": 26.0}.items():
        assert found.errors[f"{name} impulse"] < limit
    assert found.errors["front"] < 5.0  # measured: 2.2 %
