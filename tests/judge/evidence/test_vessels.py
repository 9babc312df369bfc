"""What has left a vessel through its walls, and what over its rim."""

import math

import numpy as np
import pytest

from wsim.judge.evidence.vessels import strayed
from wsim.scene.world import Shape

UP = np.array([0.0, 0.0, 1.0])
STILL = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
CUBE = [
    Shape(prim=f"/World/v/{k}", kind="box", size=size, position=place)
    for k, (size, place) in enumerate(
        [((0.2, 0.2, 0.02), (0, 0, 0.01))]
        + [((0.02, 0.2, 0.2), (s * 0.09, 0, 0.1)) for s in (-1, 1)]
        + [((0.2, 0.02, 0.2), (0, s * 0.09, 0.1)) for s in (-1, 1)]
    )
]


def of_way(*places: tuple[float, float, float], moves: bool, tapped: bool = False) -> list[bool]:
    """Whether one particle has strayed at each of its places."""
    position = np.array(places, dtype=np.float32)[:, None]
    return strayed(CUBE, np.tile(STILL, (len(places), 1)), position, 0.01, UP, moves, tapped)[:, 0].tolist()


def test_what_goes_through_a_wall_or_the_floor_has_strayed() -> None:
    for start, out in (((0.08, 0.0, 0.06), (0.14, 0.0, 0.06)), ((0.0, 0.0, 0.03), (0.0, 0.0, -0.03))):
        for moves in (True, False):
            assert of_way(start, out, moves=moves) == [False, True]


def test_what_is_poured_over_the_rim_of_one_that_moves_has_not() -> None:
    way = ((0.0, 0.0, 0.1), (0.05, 0.0, 0.22), (0.15, 0.0, 0.15), (0.2, 0.0, -0.3))
    assert of_way(*way, moves=True) == [False, False, False, False]
    assert of_way(*way, moves=False) == [False, False, True, True]


@pytest.mark.parametrize("moves", [False, True])
def test_what_a_tap_pours_strays_once_it_has_been_inside(moves: bool) -> None:
    nowhere, over = (math.nan, math.nan, math.nan), (0.3, 0.0, 0.4)
    runs_over = (nowhere, over, (0.0, 0.0, 0.25), (0.0, 0.0, 0.1), (0.05, 0.0, 0.21), (0.14, 0.0, 0.1))
    leaks = (nowhere, over, (0.0, 0.0, 0.25), (0.0, 0.0, 0.1), (0.04, 0.0, 0.07), (0.14, 0.0, 0.06))
    assert of_way(*runs_over, moves=moves, tapped=True) == [False] * 6
    assert of_way(*leaks, moves=moves, tapped=True) == [False] * 5 + [True]
