"""The transfer curve of a screen."""

import numpy as np
import pytest

from wsim.geometry.colour import srgb_of


def test_srgb_of_linear_light() -> None:
    # IEC 61966-2-1: middle grey 0.2140 is half way up; the curve begins as a straight line of slope 12.92.
    assert srgb_of((0.0, 0.2140, 1.0)) == pytest.approx([0.0, 0.5, 1.0], abs=1e-4)
    assert srgb_of(0.001) == pytest.approx(0.01292)
    assert np.diff(srgb_of(np.linspace(0.003130, 0.003132, 9))).max() < 1e-5  # in one piece
