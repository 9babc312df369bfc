"""Numbers by time: values, integrals and means against sums of small parts."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wsim.geometry.profiles import Profile

KEYS = st.lists(st.tuples(st.floats(0.01, 2.0), st.floats(-10, 10)), min_size=1, max_size=6)


@given(KEYS, st.booleans(), st.floats(0.0, 12.0))
@settings(max_examples=60, deadline=None)
def test_an_integral_is_the_sum_of_small_parts(keys, linear, end):
    times = np.cumsum([gap for gap, _ in keys])
    profile = Profile.of(times, [(value,) for _, value in keys], linear)
    t = np.linspace(0.0, end, 20_001)
    middles = 0.5 * (t[1:] + t[:-1])
    parts = profile.at(middles)[:, 0] * np.diff(t)
    assert profile.sum_to([end])[0, 0] == pytest.approx(parts.sum(), abs=20.0 * len(keys) * end / 20_000 + 1e-9)


def test_before_its_first_key_it_is_nothing_and_after_its_last_what_that_says():
    profile = Profile.of([1.0, 2.0], [(2.0,), (4.0,)], True)
    assert profile.at([0.5, 1.0, 1.5, 2.0, 9.0])[:, 0].tolist() == [0.0, 2.0, 3.0, 4.0, 4.0]
    assert profile.sum_to([0.5, 1.5, 3.0])[:, 0].tolist() == [0.0, 1.25, 7.0]
    assert profile.means([0.0, 1.0, 2.0])[:, 0].tolist() == [0.0, 3.0]
