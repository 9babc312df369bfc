"""Joints start where their bodies stand, and drives go where they are set."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from wsim.recording import read
from wsim.scene import Drive, Scene
from wsim.scene.authoring import rotation, set_pose
from wsim.sim import Simulation


@pytest.mark.parametrize("angle", [30.0, -170.0, 120.0])
def test_a_hinge_and_a_slider_keep_where_their_bodies_were_moved_to(tmp_path: Path, angle: float) -> None:
    scene = Scene()
    scene.simulation(gravity=(0.0, 0.0, 0.0))
    arm = scene.box("arm", size=(1.0, 0.1, 0.1), position=(0.5, 0.0, 1.0))
    cart = scene.box("cart", size=(0.2, 0.2, 0.2), position=(0.0, 2.0, 1.0))
    scene.joint_revolute("hinge", None, arm, anchor=(0.0, 0.0, 1.0), axis="Y")
    scene.joint_prismatic("rail", None, cart, axis="X")
    turn = math.radians(angle)
    places = {"arm": (0.5 * math.cos(turn), 0.0, 1.0 - 0.5 * math.sin(turn)), "cart": (0.25, 2.0, 1.0)}
    for name, place in places.items():
        set_pose(scene.stage.GetPrimAtPath(f"/World/{name}"), place, rotation((0.0, angle if name == "arm" else 0, 0)))
    simulation = Simulation(scene.save(tmp_path / "stage.usda"), "cpu")
    names = [body.prim.rpartition("/")[2] for body in simulation.world.bodies]
    simulation.advance_frame()
    q = simulation.state.body_q.numpy()[simulation.built.bodies]
    for name, place in places.items():
        assert q[names.index(name), :3] == pytest.approx(np.array(place), abs=1e-5)
    labels = [str(label).rpartition("/")[2] for label in simulation.model.joint_label]
    starts = simulation.model.joint_q_start.numpy()
    found = {label: float(simulation.state.joint_q.numpy()[starts[k]]) for k, label in enumerate(labels)}
    assert found == pytest.approx({"hinge": turn, "rail": 0.25}, abs=1e-5)


def test_a_drive_presses_against_a_stop_that_it_is_to_go_beyond(tmp_path: Path) -> None:
    """With k (target - stop), as the spring of a preloaded hinge or a gripper does."""
    scene = Scene()
    scene.simulation(gravity=(0.0, 0.0, 0.0), duration=0.5)
    scene.box("jaw", size=(0.1, 0.1, 0.1), position=(0.0, 0.0, 1.0), mass=1.0)
    drive = Drive(position=0.2, stiffness=100.0, damping=20.0)
    scene.joint_prismatic("rail", None, "jaw", axis="X", limits=(-0.1, 0.1), drive=drive)
    Simulation(scene.save(tmp_path / "stage.usda"), "cpu").run(tmp_path / "r.rrd")
    run = read(tmp_path / "r.rrd")
    assert run.body_q[-1, 0, 0] == pytest.approx(0.1, abs=1e-5)
    assert run.ties is not None
    h = run.time[-1] - run.time[-2]
    assert run.ties.drive[-1, 0] == pytest.approx(10.0 * h, rel=1e-3)
    assert run.ties.stop[-1, 0] == pytest.approx(-10.0 * h, rel=1e-3)
