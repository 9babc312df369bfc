"""Which particles a container holds."""

import math

import numpy as np
import pytest

from wsim.geometry.rotations import rotate
from wsim.judge.evidence.containment import Containment, local
from wsim.scene.world import Container

YAW = (0.0, 0.0, math.sin(math.radians(15.0)), math.cos(math.radians(15.0)))
PLACES = np.array(
    [
        (0.0, 0.0, 0.0),  # in the middle
        (1.04, 0.0, 0.0),  # in the wall, by less than the slack
        (1.06, 0.0, 0.0),  # through it
        (0.0, -0.57, 0.0),
        (0.0, 0.0, -0.36),  # through the floor
        (0.0, 0.0, 0.36),  # over the rim
        (1.5, 0.0, 0.9),  # over the rim, and beside the container
    ]
)


@pytest.mark.parametrize("rotation", [(0.0, 0.0, 0.0, 1.0), YAW])
def test_what_is_beyond_walls_floor_and_rim(rotation) -> None:
    tank = Container(prim="/World/tank", inner_size=(2.0, 1.0, 0.6), inner_center=(3.0, -1.0, 0.5), rotation=rotation)
    world = (rotate(np.array(rotation), PLACES) + tank.inner_center).astype(np.float32)
    assert local(tank, world) == pytest.approx(PLACES, abs=1e-6)
    middle = np.broadcast_to(np.float32(tank.inner_center), world.shape)
    found = Containment.of(tank, np.stack([middle, world]), slack=0.05)
    assert not found.strayed[0].any()
    assert found.strayed[1].tolist() == [False, False, True, True, True, False, True]
    assert found.above[1].tolist() == [False, False, False, False, False, True, True]
    assert found.outside == pytest.approx([0.0, 4 / 7])
    assert found.inside() == pytest.approx([1.0, 2 / 7])
