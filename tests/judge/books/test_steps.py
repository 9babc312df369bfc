"""What an engine's own step leaves: a pin that is a constraint pushes at its anchor of the step's begin."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from wsim.judge import judge
from wsim.judge.books.steps import step_error
from wsim.judge.evidence.evidence import Evidence
from wsim.recording import Recording, read
from wsim.scene import Scene
from wsim.scene.describe import describe
from wsim.scene.world import World
from wsim.sim import Simulation

SPIN, ARM, MASS = 10.0, 0.1, 2.0  # [rad/s], [m], [kg]


def spins(folder: Path, torque: float = 0.0) -> tuple[World, Recording]:
    """A bar that turns about an upright pin, which lets go late, beside what rests on the ground.

    Anything that touches has all steps be of the first order; no friction and no gravity act about the pin.
    """
    scene = Scene()
    scene.ground(friction=0.5)
    scene.box("rest", size=(0.2,) * 3, mass=2.0, position=(1.5, 0, 0.1))
    scene.box("bar", size=(0.4, 0.1, 0.1), mass=MASS, position=(ARM, 2, 1.5), velocity=(0, SPIN * ARM, 0),
              angular_velocity_deg=(0, 0, np.degrees(SPIN)))  # fmt: skip
    hook = scene.joint_revolute("hook", None, "bar", anchor=(0, 2, 1.5), axis="Z")
    scene.schedule("drop", hook, "release", times=[0.45])
    if torque:
        scene.schedule("twist", "bar", "torque", times=[0.1, 0.4], values=[(0, 0, torque), (0, 0, 0)])
    scene.simulation(duration=0.5, frame_rate=120)
    stage = scene.save(folder / "stage.usda")
    Simulation(stage, "cpu").run(folder / "run.rrd")
    return describe(stage), read(folder / "run.rrd")


@pytest.fixture(scope="module")
def run(tmp_path_factory: Any) -> tuple[World, Recording]:
    """As it is said to be."""
    return spins(tmp_path_factory.mktemp("pin"))


def test_a_pin_that_may_let_go_is_accepted_beside_what_rests(run: tuple[World, Recording]) -> None:
    verdict = judge(run[1])
    assert verdict.status == "accepted", [(f.check, f.message) for f in verdict.failures]


def test_the_arm_of_a_constraint_is_half_a_step_behind(run: tuple[World, Recording]) -> None:
    """l F w dt / 2 of torque, over m r: F / m = w^2 l, and g, which the pin bears, too."""
    evidence = Evidence(run[1])
    i, held = evidence.index("/World/bar"), evidence.time[1:] < 0.44
    radius = float(evidence.motion.radius[i])
    expected = 0.5 * evidence.motion.dt * SPIN * ARM / radius * np.hypot(SPIN**2 * ARM, evidence.gravity)
    assert step_error(evidence)[held, i, 1] == pytest.approx(expected, rel=0.02)
    assert step_error(evidence)[held, i, 0].max() == 0.0  # of the push itself nothing is missing
    assert step_error(evidence)[:, evidence.index("/World/rest")].max() == 0.0


def test_a_torque_of_unseen_hands_is_found_all_the_same(run: tuple[World, Recording], tmp_path: Path) -> None:
    (world, right), twisted = run, spins(tmp_path, torque=0.2)[1]
    hidden = {name: getattr(right, name) for name in ("scheduled", "applied_impulse", "applied_turn")}
    verdict = judge(replace(twisted, world=world, **hidden))
    assert verdict.status == "rejected" and not verdict.crashes
    assert "CheckForces" in {finding.check for finding in verdict.failures}
