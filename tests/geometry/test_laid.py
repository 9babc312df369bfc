"""A chain that is laid round a post lies on it, wherever its joints fall; where its way is straight it is straight."""

import math

import numpy as np
import pytest

from wsim.geometry.laid import laid


def round_a_post(ring: float, points: int, low: float, angle: float, turn: float) -> np.ndarray:
    """Up along a line, round by an angle and off along a line again, in a plane that is turned about the vertical."""
    bend = [(-ring * math.cos(a), ring * math.sin(a)) for a in np.linspace(0.0, angle, points + 1)]
    off = np.array([math.sin(angle), math.cos(angle)]) * low
    flat = np.array([(-ring, -low), *bend, bend[-1] + off])
    return np.column_stack([flat[:, 0] * math.cos(turn), flat[:, 0] * math.sin(turn), flat[:, 1]])


def nearest(joints: np.ndarray, turn: float) -> np.ndarray:
    """How near each link comes to the post's axis [m]."""
    flat = np.column_stack([joints[:, 0] * math.cos(turn) + joints[:, 1] * math.sin(turn), joints[:, 2]])
    start, way = flat[:-1], np.diff(flat, axis=0)
    share = np.clip(-(start * way).sum(axis=1) / (way**2).sum(axis=1), 0.0, 1.0)
    return np.linalg.norm(start + share[:, None] * way, axis=1)


@pytest.mark.parametrize("seed", range(60))
def test_links_lie_on_a_post_and_not_in_it(seed: int) -> None:
    """Joints on the way would put links into the post by up to R (1 - cos a / 2): 1.15 mm at 12 degrees round 21 cm."""
    rng = np.random.default_rng(seed)
    ring, angle, turn = rng.uniform(0.02, 0.3), rng.uniform(1.0, math.pi), rng.uniform(-3.0, 3.0)
    low = rng.uniform(0.3, 3.0) * ring
    links = math.ceil((ring * angle + 2.0 * low) / (ring * rng.uniform(0.1, 0.45)))
    fewest = math.ceil(2.1 * ring * angle / low)  # so that the lines are known from the arc's stretches
    way = round_a_post(ring, max(6, int(rng.integers(fewest, 60))), low, angle, turn)
    joints = laid(way, links)
    deep = ring - nearest(joints, turn)
    assert deep.max() < 1e-4 * ring
    touching = np.abs(deep) < 1e-4 * ring
    assert touching.sum() >= angle * ring / ((ring * angle + 2.0 * low) / links) - 2.0
    assert joints[[0, -1]] == pytest.approx(way[[0, -1]], abs=1e-12)
    long = np.linalg.norm(np.diff(joints, axis=0), axis=1)
    assert long.max() < 1.7 * long.mean()
    assert long.min() > 0.3 * long.mean()


def test_what_is_straight_stays_so_and_corners_stay_where_they_are() -> None:
    way = np.array([(0, 0, 0), (0.3, 0, 0), (1, 0, 0), (1, 0, 1), (1, 1, 1)], dtype=float)
    joints = laid(way, 30)
    assert np.linalg.norm(np.diff(joints, axis=0), axis=1) == pytest.approx(np.full(30, 0.1), abs=1e-9)
    assert joints[[10, 20]] == pytest.approx(way[[2, 3]], abs=1e-9)
    assert joints[:11, 1:] == pytest.approx(np.zeros((11, 2)), abs=1e-12)


def test_a_wave_is_followed() -> None:
    """Where it bends the other way tangents may meet nowhere near: its joints are then on the way."""
    x = np.linspace(0.0, 2.0, 81)
    way = np.column_stack([x, 0.0 * x, 0.05 * np.sin(4.0 * math.pi * x)])
    joints = laid(way, 60)
    assert np.abs(joints[:, 2] - 0.05 * np.sin(4.0 * math.pi * joints[:, 0])).max() < 2e-3


def test_a_helix_is_followed_from_outside() -> None:
    a = np.linspace(0.0, 6.0 * math.pi, 200)
    joints = laid(np.column_stack([0.1 * np.cos(a), 0.1 * np.sin(a), 0.02 * a]), 90)
    middles = 0.5 * (joints[1:] + joints[:-1])
    assert np.hypot(middles[1:-1, 0], middles[1:-1, 1]) == pytest.approx(np.full(88, 0.1), rel=1e-4)
