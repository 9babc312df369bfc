"""What sums over steps miss of drives' efforts that change within them."""

from dataclasses import replace

import numpy as np
import pytest

from tests.judge.theory import ask
from wsim.judge.books.laws import Laws
from wsim.judge.books.sampled import sampled
from wsim.judge.checks.recorded import CheckRecordedForces
from wsim.judge.evidence.evidence import Evidence
from wsim.recording import read
from wsim.scene import Drive, Scene
from wsim.sim import Simulation


def started(scene):
    """A damper takes a third of what a ball lacks of its speed in a step."""
    scene.simulation(duration=0.3, frame_rate=30)
    scene.sphere("ball", radius=0.064, position=(0, 0, 1), mass=1.4)
    scene.joint_prismatic("rail", None, "ball", axis="Y", drive=Drive(damping=370, velocity=0.76))


def rejected(run):
    return not all(finding.passed for finding in ask(CheckRecordedForces(), run))


def test_the_steps_of_a_damper_miss_a_twelfth_of_the_share_squared(tmp_path):
    """x = c dt / m = 0.32: x^2 / 12 of m v is missed as it starts, and nothing once it has its speed."""
    scene = Scene()
    started(scene)
    Simulation(scene.save(tmp_path / "stage.usda"), "cpu").run(tmp_path / "run.rrd")
    run = read(tmp_path / "run.rrd")
    assert not rejected(run)
    evidence, body = Evidence(run), run.world.bodies[0]
    may = sampled(evidence, Laws(evidence))[:, 0, 0] * evidence.motion.h * body.mass
    off = run.ties.impulse[1:, 0, 1] - body.mass * np.diff(run.body_qd[:, 0, 1])
    share = 370.0 * run.metadata["time_step"] / body.mass
    assert off[0] == pytest.approx(share**2 / 12.0 * body.mass * 0.76, rel=0.05)
    assert may[0] == pytest.approx(float(off[0]), rel=0.05)
    assert np.all(may[2:] < 1e-6)
    ties = run.ties
    for k, more in ((1, 1.03), (4, 0.0)):  # of an impulse as it starts; and one at its speed
        joints = ties.joints.copy()
        joints[k, 0, 1] = more * joints[k, 0, 1] + (0.1 if k == 4 else 0.0)
        assert rejected(replace(run, ties=replace(ties, joints=joints)))
