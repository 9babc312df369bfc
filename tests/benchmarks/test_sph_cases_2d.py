"""The plane cases of the fluid solver at their coarsest, on the CPU; and the parts that they measure with.

Limits are what was measured, with room for another compiler's rounding, where a case's reach is out of a coarse run's;
each says what was measured.
"""

import math

import numpy as np
import pytest

from benchmarks.sph_cases import (
    dam_break,
    dam_break_koshizuka,
    dam_break_martin_moyce,
    poiseuille,
    standing_wave,
    taylor_green,
)


def test_standing_wave_has_the_period_of_linear_theory():
    found = standing_wave.run("cpu", 0.05, periods=4)
    assert found.errors["period"] < standing_wave.CASE.reach["period"]  # measured: 0.4 %
    assert found.figures["amplitude [% of theory]"] == pytest.approx(100.0, abs=5.0)  # measured: 101.6


def test_poiseuille_flow_becomes_a_parabola():
    found = poiseuille.run("cpu", 0.01)
    assert found.errors["velocity rms"] < 1.0  # measured: 0.63 % of the fastest
    assert found.figures["velocity across, rms [% of fastest]"] < 0.1  # measured: 0.02; the rows keep


def test_taylor_green_vortices_decay_by_viscosity():
    found = taylor_green.run("cpu", 0.02)
    assert found.errors["decay rate"] < taylor_green.CASE.reach["decay rate"]  # measured: 1.6 %
    assert found.figures["farthest from any particle at the end [spacings]"] < 1.2  # measured: 0.9; no voids


@pytest.mark.parametrize(
    ("case", "spacing", "limits"),
    [
        # Measured: 8.3 % off the experiment, whose gate takes its time, 4.1 % behind potential flow, which has none.
        (dam_break_koshizuka, 0.05, (8.6, 4.0, 6.0)),
        # Measured: 12.0 and 7.5 %. The end of the sheet is thinner than a spacing; any coarser, it tears.
        (dam_break_martin_moyce, dam_break_martin_moyce.WIDTH / 32, (13.0, 7.0, 11.0)),
    ],
)
def test_dam_break_front_lies_between_the_experiment_and_potential_flow(case, spacing, limits):
    found = case.run("cpu", spacing)
    off, delayed, behind = limits
    assert found.errors["front"] < off
    assert found.figures["mean error with that delay [%]"] < delayed
    assert found.errors["ideal"] < behind
    assert found.figures["mean of the signed error [%]"] > 0.0


def test_pressure_at_release_is_that_of_a_column_without_its_gate():
    width, height, e = 1.0, 2.0, 1e-3
    x, z = np.full(50, width), np.linspace(0.01, height, 50)
    weight = dam_break.RHO * dam_break.G
    assert dam_break.pressure_at_release(x, z, width, height) == pytest.approx(np.zeros(50), abs=0.005 * weight)
    inside = [(0.5, 1.0), (0.5 + e, 1.0), (0.5 - e, 1.0), (0.5, 1.0 + e), (0.5, 1.0 - e)]
    p = dam_break.pressure_at_release(*np.array(inside).T, width, height)
    assert abs(p[1:].sum() - 4.0 * p[0]) / e**2 < 1e-3 * weight  # harmonic
    # Far from the gate of a wide column it is hydrostatic.
    far = dam_break.pressure_at_release(np.zeros(1), np.array([0.5]), 20.0, height)
    assert far[0] == pytest.approx(weight * 1.5, rel=1e-3)


def test_front_leaves_out_a_drop_that_flew_off():
    spacing = 0.1
    x, z = np.meshgrid((np.arange(20) + 0.5) * spacing, (np.arange(3) + 0.5) * spacing)
    bulk = np.stack([x.ravel(), np.zeros(x.size), z.ravel()], axis=1)
    drop = np.array([[2.5, 0.0, 0.05], [2.6, 0.0, 0.05]])
    assert dam_break.front_of(np.concatenate([drop, bulk]), spacing) == pytest.approx(2.0)


def test_fit_finds_the_period_of_a_damped_swing():
    t = np.linspace(0.0, 6.0, 200)
    swing = standing_wave.damped(t, 0.02, 0.1, 5.5, -0.5 * math.pi, 0.001, 1e-4)
    assert standing_wave.fit_swing(t, swing)[0][2] == pytest.approx(5.5, rel=1e-6)
