"""Vessels that start empty and are filled by a tap: they hold all that comes, until they run over."""

import math
from pathlib import Path

import numpy as np
import pytest

from tests.sim import vessel_shapes as shapes
from tests.sim.test_vessels_moving import HALF, HIGH, WALL, bucket
from wsim import recording
from wsim.judge.decide import judge
from wsim.scene import Scene
from wsim.sim import Simulation

DP, FRAMES = 0.02, 20


def filled(folder: Path, moves: bool, rate: float, seconds: float, ground: bool = True) -> Simulation:
    """A bucket that stands on the ground or still as a cup 1 mm thick, under a tap from 0 s on."""
    scene = Scene()
    scene.ground()
    if moves:
        vessel = bucket(scene, mass=2.0, position=(0.0, 0.0, WALL))
    else:
        shapes.cup(HALF, HIGH, 0.001).export(folder / "cup.stl")
        vessel = scene.mesh("cup", file=folder / "cup.stl", static=True, position=(0.0, 0.0, 0.002))
    water = scene.fluid("water", fills=vessel, level=0.0, spacing=DP)
    scene.tap("tap", water, rate=rate, position=(0.0, 0.0, HIGH + 0.05), radius=0.03)
    scene.simulation(duration=seconds, frame_rate=FRAMES)
    return Simulation(scene.save(folder / "filled.usda"), "cpu")


@pytest.mark.parametrize("moves", [False, True])
def test_a_tap_fills_an_empty_vessel(tmp_path: Path, moves: bool) -> None:
    simulation = filled(tmp_path, moves, 2e-3, 0.6)
    result = simulation.run(tmp_path / "filled.rrd")
    assert result.problems == []
    recorded = recording.read(tmp_path / "filled.rrd")
    assert [finding.message for finding in judge(recorded).failures] == []
    scalars, place = recorded.scalars, recorded.fluids["/World/water"].position[-1]
    come, held = scalars["fluid/mass_in"], scalars["fluid/mass_held"]
    assert come[0] == 0.0 and come[-1] == pytest.approx(1000.0 * 2e-3 * 0.6, abs=4 * 1000.0 * DP**3)
    assert np.abs(held - come).max() < 1e-4 * come[-1]
    place = place[np.isfinite(place).all(axis=1)]
    aside = np.abs(place[:, :2]).max(axis=1) if moves else np.hypot(place[:, 0], place[:, 1])
    assert (aside < HALF * 1.01).all() and (place[:, 2] > 0.0).all()


def test_it_runs_over_when_it_is_full(tmp_path: Path) -> None:
    """pi R^2 H is 2.0 kg, and 3.6 kg come: what it does not hold is outside, and has gone over the rim."""
    simulation = filled(tmp_path, False, 6e-3, 0.6)
    result = simulation.run(tmp_path / "full.rrd")
    assert result.problems == []
    recorded = recording.read(tmp_path / "full.rrd")
    track = recorded.fluids["/World/water"]
    place = track.position[-1][track.present[-1]]
    inside = (np.hypot(place[:, 0], place[:, 1]) < HALF * 1.01) & (place[:, 2] < HIGH + 0.002)
    mass, most = 1000.0 * DP**3, 1000.0 * math.pi * HALF**2 * HIGH
    assert recorded.scalars["fluid/mass_held"][-1] == pytest.approx(len(place) * mass, rel=1e-4)
    assert 0.7 * most < inside.sum() * mass < 1.1 * most
    assert (~inside).sum() > 20
    assert "CheckFluidContained" not in {finding.check for finding in judge(recorded).failures}
