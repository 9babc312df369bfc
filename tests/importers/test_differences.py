"""Velocities from poses alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.importers.runs import FLOOR, verdict_of
from wsim.importers.differences import smooth_rates

PULL = np.array([0.0, 0.0, -9.81])
BALL = '<body name="a" pos="0 0 {z}"><freejoint/><geom {geom} solref="0.004 1"/></body>'


def rates_of(height: np.ndarray, time: np.ndarray) -> np.ndarray:
    """Mean vertical rates between frames, (T - 1, 1, 3)."""
    found = np.zeros((len(time) - 1, 1, 3))
    found[:, 0, 2] = np.diff(height) / np.diff(time)
    return found


def test_a_parabola_is_exact_to_its_ends() -> None:
    time = np.cumsum([0.0, 0.01, 0.02, 0.01, 0.03, 0.01])  # uneven frames
    height = 3.0 * time - 4.0 * time**2
    found = smooth_rates(time, rates_of(height, time), np.zeros(3))[:, 0, 2]
    assert found == pytest.approx(3.0 - 8.0 * time)


@pytest.mark.parametrize("phase", np.linspace(0.0, 3.0, 7))
def test_a_swing_is_known_to_its_ends(phase: float) -> None:
    """At p rad a frame a parabola to one side misses p^2 / 3, and a fall that is taken for it up to p / 3."""
    p = 0.15
    angle = p * np.arange(20) + phase
    found = smooth_rates(np.arange(20.0), rates_of(np.sin(angle), np.arange(20.0)), np.zeros(3))[:, 0, 2]
    assert np.abs(found / p - np.cos(angle)).max() < 0.75 * p**2 / 3.0
    assert np.abs((found / p) ** 2 - np.cos(angle) ** 2)[2:-2].max() < 0.5 * p**2 / 3.0


@pytest.mark.parametrize("shares", [(0.25, 0.25), (0.33, 0.3), (0.4, 0.1)])
def test_between_two_blows_a_fall_is_a_parabola(shares: tuple[float, float]) -> None:
    """Three frames between two blows, whose shares bend two frames each: nothing is made good."""
    time = np.arange(20.0)
    first, second = 7.0 - shares[0], 10.0 + shares[1]
    height = -0.5 * time**2 + 5.0 * np.maximum(time - first, 0.0) - 4.0 * np.maximum(time - second, 0.0)
    found = smooth_rates(time, rates_of(height, time), np.array([0.0, 0.0, -1.0]))[:, 0, 2]
    assert found == pytest.approx(-time + 5.0 * (time > first) - 4.0 * (time > second), abs=1e-9)


def test_a_force_that_comes_at_once_is_as_before() -> None:
    """A push that begins at a frame: the jerks on both sides of it do not agree, and none is made good."""
    time = np.arange(20.0)
    height = np.where(time > 9.0, (time - 9.0) ** 2, 0.0)
    found = smooth_rates(time, rates_of(height, time), np.zeros(3))[:, 0, 2]
    assert found == pytest.approx(np.where(time > 9.0, 2.0 * (time - 9.0), 0.0), abs=1e-12)


@pytest.mark.parametrize("bounce", [0.021, 0.15, 0.21, 0.475])
def test_a_bounce_between_frames_leaves_the_velocities_on_both_sides_as_they_are(bounce: float) -> None:
    time = np.arange(31) / 60.0
    since = time - bounce
    leaves = np.where(since < 0.0, -3.0, 2.0)
    height = leaves * since - 0.5 * 9.81 * since**2
    found = smooth_rates(time, rates_of(height, time), PULL)[:, 0, 2]
    assert found == pytest.approx(leaves - 9.81 * since, abs=1e-9)


@pytest.mark.parametrize("z", [0.4, 0.7, 1.0, 1.313])
@pytest.mark.parametrize("geom", ['type="sphere" size="0.1"', 'type="box" size="0.1 0.08 0.06"'])
def test_a_bounce_in_a_trajectory_of_poses_is_not_rejected(tmp_path: Path, z: float, geom: str) -> None:
    verdict = verdict_of(tmp_path, FLOOR + BALL.format(z=z, geom=geom), speeds={0: 0.7, 4: 3.0}, poses=True)
    assert verdict.status == "accepted", verdict.summary


def test_poses_alone_under_another_gravity_are_rejected(tmp_path: Path) -> None:
    bodies = BALL.format(z=5, geom='type="sphere" size="0.1"')
    verdict = verdict_of(tmp_path, bodies, poses=True, gravity=0.9 * 9.81, seconds=0.8)
    assert "CheckFreeFlight" in {finding.check for finding in verdict.failures}


def test_a_pendulum_that_swings_through_at_the_end_gains_nothing(tmp_path: Path) -> None:
    """Let go level, 60 frames a second, 0.1 rad a frame where it ends."""
    arm = """<body name="arm" pos="0 0 1"><joint axis="0 1 0"/><geom type="capsule" fromto="0 0 0 .6 0 0" size=".03"/>
      <geom pos=".6 0 0" size=".05"/></body>"""
    for seconds in (0.45, 1.1, 1.35, 2.0):
        verdict = verdict_of(tmp_path, arm, poses=True, seconds=seconds)
        assert verdict.status == "accepted", verdict.summary
