"""A drive that swings faster than the frames may be anywhere that it can reach, and no farther."""

import pytest

from tests.judge.theory import ask, edited
from wsim.judge.checks.continuity import CheckContinuity
from wsim.recording import read
from wsim.scene import Drive, Scene
from wsim.sim import Simulation


def flying(scene):
    """A bob on a stiff slider, on a base a hundred times as heavy that flies on."""
    scene.simulation(duration=0.5, frame_rate=60)
    scene.box("base", size=(0.5, 0.5, 0.3), position=(0, 0, 3), velocity=(10, 0, 0), mass=100)
    scene.box("bob", size=(0.1, 0.1, 0.1), position=(0, 0, 3.3), velocity=(10, 0, 0), mass=1)
    scene.joint_prismatic("rail", "base", "bob", axis="X", drive=Drive(stiffness=2e4, damping=20, position=0.02))


def turret(scene):
    """A light rod on a heavy base that stands."""
    scene.simulation(duration=0.5, frame_rate=60)
    scene.ground(friction=0.6)
    scene.box("base", size=(1, 1, 0.4), position=(0, 0, 0.2), mass=200)
    scene.box("bob", size=(0.3, 0.02, 0.02), position=(0.15, 0, 0.6), mass=0.1)
    drive = Drive(stiffness=20, damping=0.05)
    scene.joint_revolute("pivot", "base", "bob", axis="Z", anchor=(0, 0, 0.6), drive=drive)


@pytest.mark.parametrize(("build", "jump"), [(flying, (0.05, 0.0)), (flying, (0.2, 0.0)), (turret, (-0.0067, 0.0443))])
def test_what_is_where_its_drive_cannot_bring_it_is_found(tmp_path, build, jump):
    """Speeds of the mechanism as one and the weight of its base bring no joint anywhere."""
    scene = Scene()
    build(scene)
    Simulation(scene.save(tmp_path / "stage.usda"), device="cpu").run(tmp_path / "r.rrd")
    run = read(tmp_path / "r.rrd")
    assert all(finding.passed for finding in ask(CheckContinuity(), run))
    bob = next(k for k, body in enumerate(run.world.bodies) if body.prim == "/World/bob")
    moved = edited(run, "body_q", (15, bob, slice(0, 2)), jump)
    assert not all(finding.passed for finding in ask(CheckContinuity(), moved))
