"""Principal axes give the inertia back, and rounding does not choose them."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from pxr import Gf
from scipy.spatial.transform import Rotation

from wsim.scene.principal import principal

Array = np.ndarray

MOMENTS = st.lists(st.sampled_from([1.0, 1.3, 1.9, 2.1]), min_size=3, max_size=3)
TURNS = st.tuples(*[st.floats(-180.0, 180.0)] * 3)


def of_parts(moments: Array, axes: Gf.Quatf) -> Array:
    turn = Rotation.from_quat([*axes.GetImaginary(), axes.GetReal()]).as_matrix()
    return turn @ np.diag(moments) @ turn.T


@given(MOMENTS, TURNS, st.floats(1e-6, 1e6), st.integers(0, 2**32))
def test_gives_the_inertia_back_whatever_rounding_left(
    moments: list[float], degrees: tuple[float, float, float], scale: float, seed: int
) -> None:
    turn = Rotation.from_euler("xyz", degrees, degrees=True).as_matrix()
    inertia = scale * turn @ np.diag(moments) @ turn.T
    found, axes = principal(inertia)
    np.testing.assert_allclose(of_parts(found, axes), inertia, atol=5e-6 * scale)
    noise = np.random.default_rng(seed).normal(size=(3, 3)) * 1e-15 * scale
    again, other = principal(inertia + noise + noise.T)
    np.testing.assert_allclose(again, found, rtol=1e-12)
    apart = np.array([*other.GetImaginary(), other.GetReal()]) - [*axes.GetImaginary(), axes.GetReal()]
    assert np.abs(apart).max() <= 1.01e-7  # a last digit, should one lie between two


def test_a_round_body_keeps_its_own_axes() -> None:
    moments, axes = principal(np.diag([2.0, 1.0, 2.0]) + 1e-12)
    assert moments.tolist() == [2.0 + 1e-12, 1.0 + 1e-12, 2.0 + 1e-12]
    assert axes == Gf.Quatf(1.0)


def test_a_rod_askew_turns_about_its_length_alone() -> None:
    along = np.array([0.6, 0.0, 0.8])
    moments, axes = principal(np.eye(3) - 0.9 * np.outer(along, along))
    np.testing.assert_allclose(moments, [0.1, 1.0, 1.0])
    turn = Rotation.from_quat([*axes.GetImaginary(), axes.GetReal()]).as_matrix()
    np.testing.assert_allclose(turn.T[0], along, atol=1e-6)
    np.testing.assert_allclose(turn.T[1], [0.0, 1.0, 0.0], atol=1e-6)  # of what is across, the axis that is the body's
