"""Drives that end at their full effort: wrong, unless it is said that they are to; and never weaker than stated."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.judge.theory import with_world
from wsim.judge import judge
from wsim.recording import Recording, read
from wsim.scene import Drive, Scene
from wsim.sim import Simulation

Build = Callable[[Scene, bool], None]


def slips(scene: Scene, saturates: bool) -> None:
    """A winch of 80 N under a load of 10 kg, which it lets down at g - F / m = 1.81 m/s^2."""
    scene.simulation(duration=1.2)
    scene.box("load", size=(0.2, 0.2, 0.2), mass=10.0, position=(0.0, 0.0, 3.0))
    drive = Drive(velocity=1.0, damping=1000.0, max_force=80.0, saturates=saturates)
    scene.joint_prismatic("winch", None, "load", axis="Z", drive=drive)


def stalls(scene: Scene, saturates: bool) -> None:
    """An actuator of 10 N that drives 2 kg into its stop at 0.5 m, and is held there."""
    scene.simulation(duration=3.0)
    scene.box("rod", size=(0.2, 0.1, 0.1), mass=2.0, position=(0.0, 0.0, 1.0))
    drive = Drive(velocity=1.0, damping=50.0, max_force=10.0, saturates=saturates)
    scene.joint_prismatic("winch", None, "rod", axis="X", limits=(0.0, 0.5), drive=drive)


def run(folder: Path, build: Build, saturates: bool) -> Recording:
    scene = Scene()
    build(scene, saturates)
    Simulation(scene.save(folder / "stage.usda"), "cpu").run(folder / "run.rrd")
    return read(folder / "run.rrd")


@pytest.fixture(scope="module", params=[slips, stalls])
def meant(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Recording:
    """A drive that is said to saturate, and does."""
    return run(tmp_path_factory.mktemp("meant"), request.param, True)


def test_a_drive_may_end_at_its_full_effort_where_it_is_meant_to(meant: Recording) -> None:
    if meant.time[-1] < 2.0:  # the winch
        fallen = meant.body_q[0, 0, 2] - meant.body_q[-1, 0, 2]
        assert fallen == pytest.approx(0.5 * (9.81 - 8.0) * 1.2**2, rel=1e-3)
    verdict = judge(meant, None)
    assert verdict.status == "accepted", [finding.message for finding in verdict.failures]


@pytest.mark.parametrize("build", [slips, stalls])
def test_without_the_word_it_is_too_weak(tmp_path: Path, build: Build) -> None:
    verdict = judge(run(tmp_path, build, False), None)
    assert [finding.check for finding in verdict.failures] == ["CheckDrives"]
    assert verdict.failures[0].target is not None
    assert verdict.failures[0].target.parameter == "drive.max_force"


@pytest.mark.parametrize("share", [0.7, 1.4])
def test_with_the_word_a_drive_of_another_strength_is_found(meant: Recording, share: float) -> None:
    """What is stated is `share` times what acted: the books of its body do not balance."""
    joint = meant.world.joints[0]
    assert joint.drive is not None and joint.drive.max_effort is not None
    drive = joint.drive.model_copy(update={"max_effort": share * joint.drive.max_effort})
    wrong = with_world(meant, joints=[joint.model_copy(update={"drive": drive})])
    failed = {finding.check for finding in judge(wrong, None).failures}
    assert failed & {"CheckForces", "CheckEnergy", "CheckRecordedTies", "CheckRecordedForces", "CheckCatches"}, failed
    assert "CheckDrives" not in failed
