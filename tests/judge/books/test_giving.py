"""What is held by rows of constraints sags under its load, and holds what that takes."""

import numpy as np
import pytest

from tests.judge.test_turned import simulated
from tests.judge.theory import ask, edited, with_world
from wsim.judge import judge
from wsim.judge.books.giving import held_by_joints
from wsim.judge.books.recorded_ties import RecordedTies
from wsim.judge.checks.energy import CheckEnergy
from wsim.judge.evidence.evidence import Evidence


def cantilever(scene):
    scene.simulation(frame_rate=60)
    scene.box("bar", size=(1, 0.05, 0.05), position=(0.5, 0, 2), mass=2)
    scene.joint_fixed("weld", None, "bar", anchor=(0, 0, 2), break_force=1000)


def failed(recording):
    return [finding.message for finding in ask(CheckEnergy(), recording) if not finding.passed]


def test_a_cantilever_that_sags_at_the_start_loses_what_its_weld_holds(tmp_path):
    recording = simulated(tmp_path, cantilever, 0.5)
    evidence = Evidence(recording)
    sunk = float(recording.body_q[0, 0, 2] - recording.body_q[-1, 0, 2])
    assert 1e-5 < sunk < 3e-5
    held = held_by_joints(evidence, RecordedTies(evidence, recording.ties), np.array([0]))
    assert held == pytest.approx(2 * 9.81 * sunk, rel=0.15)  # and what places are rounded to
    assert failed(recording) == []
    jerked = edited(recording, "body_qd", (20, 0, 2), 0.05)  # m v^2 / 2 = 6.7 times that
    assert failed(jerked) != []


def test_a_cantilever_a_tenth_heavier_than_stated_is_found(tmp_path):
    """Its weld bears what the simulator's weighs, and not what the world says."""
    recording = simulated(tmp_path, cantilever, 0.5)
    assert judge(recording).failures == []
    bar = recording.world.bodies[0]
    for by in (0.9, 1.1):
        other = bar.model_copy(update={"mass": by * bar.mass, "inertia": tuple(by * each for each in bar.inertia)})
        assert judge(with_world(recording, bodies=[other])).status == "rejected"
