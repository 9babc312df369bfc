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
    assert long.max() < 1.5 * long.mean()
    assert long.min() > 0.5 * long.mean()


@pytest.mark.parametrize("seed", range(20))
def test_a_pull_goes_evenly_round_a_post(seed: int) -> None:
    """By the balance of moments of each link about where it touches, without friction: each bears as much as the next.

    What comes leaning by b at d from there leaves by c at e, d sin b = e sin c; along the lines it leans by nothing.
    """
    rng = np.random.default_rng(seed)
    ring, angle, low, turn = rng.uniform(0.02, 0.3), rng.uniform(1.5, math.pi), rng.uniform(1.0, 3.0), 0.2
    joints = laid(round_a_post(ring, 48, low * ring, angle, 0.0), math.ceil((angle + 2.0 * low) / turn))
    way = np.diff(joints, axis=0)
    long = np.linalg.norm(way, axis=1)
    tilt = np.unwrap(np.arctan2(way[:, 2], way[:, 0]))
    touch = -(joints[:-1] * way).sum(axis=1) / long  # along each link, from where it begins
    bent = np.flatnonzero(np.diff(tilt) < -1e-3)
    lean, borne = 0.0, []
    for link in range(bent[0] + 1, bent[-1] + 1):
        comes = tilt[link - 1] - tilt[link] - lean
        lean = math.asin(touch[link] * math.sin(comes) / (long[link] - touch[link]))
        borne.append(comes + lean)
    turned = tilt[bent[-1]] - tilt[bent[-1] + 1]
    assert lean == pytest.approx(turned, rel=0.03)
    assert np.array(borne[1:-1]) == pytest.approx(np.full(len(borne) - 2, np.mean(borne[1:-1])), rel=0.03)


def test_links_half_round_a_post_are_even() -> None:
    """Of those on the bend the first and the last are (1 + 1 / sqrt 2) / 2; the worst was 42 % off the mean."""
    long = np.linalg.norm(np.diff(laid(round_a_post(0.21, 36, 0.23, math.pi, 0.0), 26), axis=0), axis=1)
    assert long.min() / long.max() == pytest.approx(0.5 + math.sqrt(0.125), rel=0.01)
    assert np.abs(long / long.mean() - 1.0).max() < 0.15


def test_a_chain_of_fewer_links_than_bends_is_laid() -> None:
    way = round_a_post(0.2, 12, 0.4, math.pi, 0.0)
    for links in (2, 3, 4):
        joints = laid(way, links)
        assert joints.shape == (links + 1, 3)
        assert joints[[0, -1]] == pytest.approx(way[[0, -1]], abs=1e-12)


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
