"""Faces of static shapes: which one a body is over, and what comes out of it."""

import math

import numpy as np
import pytest

from tests.judge.turned import any_turn
from wsim.geometry.rotations import multiply, rotate, upwards
from wsim.judge.evidence.faces import normal_under
from wsim.scene.world import Shape

SLOPE = np.array([0.0, math.sin(math.radians(10)), 0.0, math.cos(math.radians(10))])  # 20 degrees about Y
NORMAL = np.array([math.sin(math.radians(20)), 0.0, math.cos(math.radians(20))])
# The same ramp, its thin side along its own Z, X and Y.
OWN = {
    (4.0, 1.0, 0.1): (0.0, 0.0, 0.0, 1.0),
    (0.1, 1.0, 4.0): (0.0, math.sqrt(0.5), 0.0, math.sqrt(0.5)),
    (4.0, 0.1, 1.0): (math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)),
}


def ramp(size, turn=(0.0, 0.0, 0.0, 1.0)):
    own = multiply(np.array(turn), multiply(SLOPE, np.array(OWN[size])))
    return Shape(prim="/World/ramp/g", kind="box", size=size, rotation=tuple(own.tolist()))


@pytest.mark.parametrize("size", OWN)
def test_a_ramp_slopes_as_the_face_that_is_up_whatever_its_own_axes_are(size):
    up = np.array([0.0, 0.0, 1.0])
    for points in (np.array([[0.5, 0.0, 1.0]]), np.array([[0.0, 0.0, -9.0]])):  # over it, and over nothing
        assert normal_under([ramp(size)], points, up) == pytest.approx(NORMAL, abs=1e-9)
    q = any_turn(3)
    turned = normal_under([ramp(size, tuple(q))], rotate(q, np.array([[0.5, 0.0, 1.0]])), rotate(q, up))
    assert turned == pytest.approx(rotate(q, NORMAL), abs=1e-9)


def test_what_is_over_a_narrow_face_goes_down_that():
    """A steep board: seen from above its broad side is larger, and a body may stand on its edge."""
    board = ramp((4.0, 1.0, 0.1)).model_copy(update={"rotation": (0.0, math.sin(0.6), 0.0, math.cos(0.6))})
    end, broad = np.array([-math.cos(1.2), 0.0, math.sin(1.2)]), np.array([math.sin(1.2), 0.0, math.cos(1.2)])
    up = np.array([0.0, 0.0, 1.0])
    assert normal_under([board], np.array([2.2 * end]), up) == pytest.approx(end, abs=1e-9)
    assert normal_under([board], np.array([0.2 * broad]), up) == pytest.approx(broad, abs=1e-9)


@pytest.mark.parametrize("pull", [(0.0, 0.0, -9.81), (3.0, -4.0, 0.0), (0.0, 0.0, 0.0)])
def test_up_is_against_gravity(pull):
    assert upwards(pull) == pytest.approx(np.array([-0.6, 0.8, 0.0]) if any(pull[:2]) else np.array([0.0, 0.0, 1.0]))
