"""A cup that is tilted over a bowl, from a stage through a run and its recording to the verdict."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.sim.test_vessels_moving import bucket
from wsim import recording
from wsim.judge.decide import judge
from wsim.recording import Recording
from wsim.scene import Part, Scene
from wsim.scene.describe import describe
from wsim.sim import Simulation
from wsim.sim.fluids import expected_speed

G, DP, BOWL = 9.81, 0.015, 0.22
HIGH, TOP = 0.3, 0.08  # of the cup's floor, and of the water above it [m]


def bowl(scene: Scene, x: float) -> None:
    """A square bowl with walls as thick as the fluid needs to be kept by what it is not the vessel of."""
    wide, thick, high = 0.13, 2 * DP, 0.12
    side, out = wide + thick / 2, 2 * (wide + thick)
    parts = [Part("box", size=(out, out, thick), position=(0.0, 0.0, thick / 2))]
    for s in (-1.0, 1.0):
        parts.append(Part("box", size=(thick, 2 * wide, high), position=(s * side, 0.0, thick + high / 2)))
        parts.append(Part("box", size=(out, thick, high), position=(0.0, s * side, thick + high / 2)))
    scene.compound("bowl", parts=parts, static=True, position=(x, 0.0, 0.0))


def poured(folder: Path, turn: float = 110.0, x: float = BOWL, ground: bool = True, seconds: float = 1.2) -> Path:
    """The stage of a bucket that is turned so far [deg], beside a bowl at x [m]."""
    scene = Scene()
    if ground:
        scene.ground()
    cup = bucket(scene, kinematic=True, position=(0.0, 0.0, HIGH))
    scene.path(cup, times=[0.0, 0.1, 0.6, 2.0], rotations_deg=[(0.0, a, 0.0) for a in (0.0, 0.0, turn, turn)])
    bowl(scene, x)
    scene.fluid("water", fills=cup, level=TOP, spacing=DP)
    scene.simulation(duration=seconds, frame_rate=30)
    return scene.save(folder / "poured.usda")


def run(stage: Path) -> Recording:
    result = Simulation(stage, "cpu").run(stage.with_suffix(".rrd"))
    assert result.problems == []
    return recording.read(stage.with_suffix(".rrd"))


@pytest.fixture(scope="module")
def told(tmp_path_factory: pytest.TempPathFactory) -> Recording:
    return run(poured(tmp_path_factory.mktemp("poured")))


def failed(recorded: Recording) -> set[str]:
    return {finding.check for finding in judge(recorded).failures}


def test_what_is_poured_into_a_bowl_is_accepted_and_in_there(told: Recording) -> None:
    assert failed(told) == set()
    last = told.fluids["/World/water"].position[-1]
    in_bowl = (np.abs(last[:, 0] - BOWL) < 0.13) & (np.abs(last[:, 1]) < 0.13) & (last[:, 2] < 0.15)
    assert in_bowl.mean() > 0.95


def test_what_leaves_through_the_floor_is_not(told: Recording) -> None:
    """As through a hole: a particle in twenty is under the cup before it is tilted."""
    track = told.fluids["/World/water"]
    position = track.position.copy()
    position[2:, ::20, 2] -= 0.12
    assert "CheckFluidContained" in failed(replace(told, fluids={"/World/water": replace(track, position=position)}))


def test_what_misses_the_bowl_falls_for_ever_without_a_ground(tmp_path: Path) -> None:
    """Nothing that stands is near at the start."""
    assert "CheckLeak" in failed(run(poured(tmp_path, x=1.0, ground=False, seconds=0.9)))


@pytest.mark.parametrize("turn", [0.0, 25.0, 110.0])
def test_sound_is_as_fast_as_what_is_poured_falls(tmp_path: Path, turn: float) -> None:
    """The surface, 0.12 m wide, is 0.1 m under the rim: turned by 59 degrees it is there."""
    speed = expected_speed(describe(poured(tmp_path, turn)))
    falls = math.sqrt(2.0 * G * (HIGH + TOP))
    assert speed == pytest.approx(falls) if turn > 59.0 else speed < 0.6 * falls
