"""Steps in one go are the steps one by one, bit for bit."""

from __future__ import annotations

import runpy
from pathlib import Path

import numpy as np
import pytest

from wsim.scene import Scene
from wsim.sim import Simulation

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.mark.parametrize("name", ["stack_and_ball", "double_pendulum", "breaking_chain", "pulleys"])
def test_a_frame_in_one_go_is_its_steps(tmp_path: Path, name: str) -> None:
    scene = Scene()
    runpy.run_path(str(EXAMPLES / f"{name}.py"))["build"](scene)
    scene.save(tmp_path / "stage.usda")
    at_once, one_by_one = (Simulation(tmp_path / "stage.usda", "cpu") for _ in range(2))
    assert at_once.rigid is not None
    assert at_once.rigid.alone
    for _ in range(12):
        at_once.advance_frame()
        for _ in range(one_by_one.substeps):
            one_by_one.step()
    assert at_once.time == one_by_one.time
    for array in ("body_q", "body_qd", "joint_q"):
        ours, theirs = (getattr(simulation.state, array).numpy() for simulation in (at_once, one_by_one))
        assert np.abs(theirs).max() > 0.0
        assert (ours == theirs).all(), array


@pytest.mark.parametrize("name", ["conveyor", "marble_run", "rack_and_pinion"])
def test_who_is_looked_at_between_frames_is_not_alone(tmp_path: Path, name: str) -> None:
    scene = Scene()
    runpy.run_path(str(EXAMPLES / f"{name}.py"))["build"](scene)
    scene.save(tmp_path / "stage.usda")
    simulation = Simulation(tmp_path / "stage.usda", "cpu")
    assert simulation.rigid is not None
    assert not simulation.rigid.alone
