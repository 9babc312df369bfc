"""Lattices against the solids that they stand for."""

import numpy as np
import pytest

from wsim.geometry.filled import box_lattice
from wsim.solvers.sampling import container_walls, layers_within


def test_a_boxs_lattice_has_its_volume():
    samples = box_lattice(np.array([0.2, 0.3, 0.05]), 0.03)
    assert samples.volume.sum() == pytest.approx(0.2 * 0.3 * 0.05, rel=1e-9)
    assert np.abs(samples.position.mean(axis=0)).max() < 1e-9


ALL_BUT_THE_LID = np.array([[True, True], [True, True], [True, False]])


def test_container_walls_carry_on_the_fluids_lattice():
    inner, spacing = np.array([0.3, 0.2, 0.1]), 0.05
    walls = container_walls(inner, spacing, 0.13, ALL_BUT_THE_LID)
    outside = (np.abs(walls.position) > 0.5 * inner).any(axis=1)
    assert outside.all()
    # Two layers on each of five sides around 6 x 4 x 2 cells, none above the rim.
    assert len(walls.position) == 10 * 8 * 4 - 6 * 4 * 2
    assert walls.position[:, 2].max() < 0.05
    nearest = np.abs(walls.position[:, 0]).min()
    assert nearest == pytest.approx(0.025)


def test_closed_container_has_a_lid_and_periodic_sides_none():
    inner, spacing = np.array([0.3, 0.2, 0.1]), 0.05
    closed = container_walls(inner, spacing, 0.13, np.full((3, 2), True))
    assert len(closed.position) == 10 * 8 * 6 - 6 * 4 * 2
    channel = container_walls(inner, spacing, 0.13, np.array([[False, False], [False, False], [True, True]]))
    assert len(channel.position) == 6 * 4 * 4
    assert np.abs(channel.position[:, 0]).max() < 0.15


def test_a_plane_has_one_layer_that_stands_for_the_depth():
    walls = container_walls(np.array([0.3, 1.0, 0.1]), 0.05, 0.13, ALL_BUT_THE_LID & [[1], [0], [1]], plane=True)
    assert (walls.position[:, 1] == 0.0).all()
    assert len(walls.position) == 10 * 4 - 6 * 2
    assert walls.volume == pytest.approx(0.05 * 0.05 * 1.0)
    box = box_lattice(np.array([0.2, 1.0, 0.1]), 0.05, plane=True)
    assert (box.position[:, 1] == 0.0).all()
    assert box.volume.sum() == pytest.approx(0.02)


@pytest.mark.parametrize(
    ("support", "layers"), [(0.13, 2), (0.15, 2), (0.16, 3), (0.2, 3), (0.204, 3), (0.25, 4), (0.06, 1)]
)
def test_the_layers_are_those_that_water_half_a_spacing_off_the_wall_sees(support, layers):
    assert layers_within(support, 0.05) == layers
    seen = np.arange(1, 9) * 0.05  # from half a spacing before the wall to the middle of each layer
    pull = np.maximum(1.0 - seen / support, 0.0) ** 3 * seen  # Wendland's, up to a factor
    assert pull[layers:].sum() <= 3e-4 * pull[0]
