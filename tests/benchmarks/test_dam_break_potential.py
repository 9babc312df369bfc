"""The ideal dam break against itself: what it must conserve, how it starts, and the table that is kept of it."""

import math

import numpy as np
import pytest

from benchmarks.sph_cases import dam_break_potential as potential


def test_ideal_column_keeps_its_volume_and_energy_and_runs_as_the_table_says():
    t, toe, _, volume, energy = potential.solve(0.1, 2.0).T
    # Measured at this spacing: 2e-4 and 5e-4 over a run four times as long, fronts within 0.5 %.
    assert np.ptp(volume) < 1e-3
    assert np.ptp(energy) < 2e-3
    later = t > 0.2
    assert toe[later] == pytest.approx(potential.front(t[later]), rel=0.01)


def test_ideal_column_starts_with_the_acceleration_of_the_series():
    side, top = potential.release_errors(0.05)
    assert side < 1e-3
    assert top < 1e-3


def test_front_starts_at_the_gate_from_rest_and_refuses_times_beyond_its_table():
    assert potential.front(np.array([0.0, 1e-4])) == pytest.approx([1.0, 1.0], abs=1e-6)
    with pytest.raises(ValueError, match=r"9\.25"):
        potential.front(np.array([10.0 / math.sqrt(2.0) + 1.0]))
