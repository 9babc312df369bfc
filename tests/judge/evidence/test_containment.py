"""Which particles a container holds."""

import math

import numpy as np
import pytest

from wsim.geometry.rotations import rotate
from wsim.judge.evidence.containment import Containment, falls_beside, local
from wsim.scene.world import Container
from wsim.scene.world_openings import Tap

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


TANK = Container(
    prim="/World/tank", inner_size=(1.0, 1.0, 0.6), inner_center=(0.0, 0.0, 0.3), rotation=(0.0, 0.0, 0.0, 1.0)
)


def test_rain_that_falls_beside_a_tank_has_not_left_it_and_what_was_in_it_has():
    """One falls in, one beside, one falls in and comes out through a wall, one comes only later and falls beside."""
    gone = (np.nan, np.nan, np.nan)
    frames = [
        [(0.0, 0.0, 2.0), (2.0, 0.0, 2.0), (0.0, 0.0, 2.0), gone],
        [(0.0, 0.0, 0.1), (2.0, 0.0, 0.1), (0.0, 0.0, 0.1), (2.0, 0.0, 2.0)],
        [(0.0, 0.0, 0.1), (2.0, 0.0, 0.1), (0.7, 0.0, 0.1), (2.0, 0.0, 0.1)],
    ]
    found = Containment.of(TANK, np.array(frames, dtype=np.float32), slack=0.05, poured=True, beside=True)
    assert found.strayed[2].tolist() == [False, False, True, False]
    assert found.beside[2].tolist() == [False, True, False, True]
    assert found.outside == pytest.approx([0.0, 0.0, 0.25])
    assert found.inside() == pytest.approx([0.0, 0.5, 0.25])
    assert found.elsewhere[2] == pytest.approx(0.75)


@pytest.mark.parametrize(
    ("tap", "beside"),
    [
        ({"position": (0.0, 0.0, 1.0), "radius": 0.4}, False),
        ({"position": (0.3, 0.0, 1.0), "radius": 0.4}, True),
        ({"position": (0.0, 0.0, 1.0), "size": (1.0, 0.8)}, False),
        ({"position": (0.0, 0.0, 1.0), "size": (1.4, 0.8)}, True),
        ({"position": (0.0, 0.0, 1.0), "size": (1.4, 0.1), "direction": (1.0, 0.0, 0.0)}, True),
    ],
)
def test_what_a_mouth_pours_may_fall_beside_what_it_is_not_wholly_over(tap, beside):
    made = Tap(prim="/World/tap", fluid="/World/water", rate=1e-3, **tap)
    assert falls_beside(TANK, [made]) == beside
