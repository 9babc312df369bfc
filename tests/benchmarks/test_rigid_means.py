"""The comparison of what bodies could be stepped by measures what it says."""

import pytest

from benchmarks.rigid_means import COLUMNS, MEANS, crate, slip


def test_wsim_is_near_what_is_known_and_stiff_contacts_hop() -> None:
    way, hop = crate(MEANS["wsim"])
    assert way == pytest.approx(1.529, rel=1e-3)
    assert hop < 0.01
    assert crate(MEANS["… contacts of 2.5 steps"])[1] > 10.0
    assert slip(MEANS["wsim"])[0] == pytest.approx(15 / 7, rel=1e-3)


def test_each_number_of_a_world_has_its_column() -> None:
    assert all(len(names) == len(known) for _, names, known in COLUMNS)
