"""Drives that are faster than the frames: what they did is recorded together, or known to lie within bounds."""

from dataclasses import replace

import numpy as np
import pytest

from tests.judge.theory import ask, edited, with_world
from wsim.judge import judge
from wsim.judge.checks.continuity import CheckContinuity
from wsim.judge.checks.energy import CheckEnergy
from wsim.judge.checks.forces import CheckForces
from wsim.judge.checks.recorded_ties import CheckRecordedTies
from wsim.judge.evidence.evidence import Evidence
from wsim.recording import read
from wsim.scene import Drive, Scene
from wsim.sim import Simulation


def swung(scene):
    """A box on a slider, with another upon it, and one apart: drives swing both an odd number of times a frame."""
    scene.simulation(duration=0.5, frame_rate=24)
    scene.box("a", size=(0.2, 0.2, 0.2), position=(0, 0, 1), mass=5)
    scene.joint_prismatic("rail", None, "a", axis="X", drive=Drive(stiffness=90e3, damping=60, position=0.15))
    scene.box("b", size=(0.2, 0.2, 0.2), position=(0, 0, 1.5), mass=9)
    weak = Drive(stiffness=700, damping=8, position=0.1, max_force=300, saturates=True)
    scene.joint_prismatic("post", "a", "b", axis="X", drive=weak)
    scene.box("c", size=(0.3, 0.3, 0.3), position=(0, 2, 1), mass=20)
    scene.joint_prismatic("other", None, "c", axis="Z", drive=Drive(stiffness=200e3, damping=400, position=0.05))


def carried(scene):
    """A deck, whose drive pushes with all its strength as frames show it, on a base that swings between them."""
    scene.simulation(duration=0.35, frame_rate=24)
    scene.box("base", size=(0.3, 0.3, 0.3), position=(0, 0, 1), mass=65)
    scene.joint_prismatic("rail", None, "base", axis="X", drive=Drive(stiffness=366e3, damping=5300, position=-0.1))
    scene.box("deck", size=(0.3, 0.3, 0.3), position=(0.5, 0, 1), mass=70)
    belt = Drive(damping=5700, velocity=0.84, max_force=690, saturates=True)
    scene.joint_prismatic("deck_rail", "base", "deck", axis="X", drive=belt)
    scene.sphere("bob", radius=0.06, position=(-0.3, 0, 1.2), mass=3.3)
    soft = Drive(stiffness=440, damping=37, max_force=60, saturates=True)
    scene.joint_prismatic("bob_rail", "base", "bob", axis="Z", drive=soft)


def shaken(scene):
    """A wheel on an axle whose slow drive is shaken by a bob on a stiff slider."""
    scene.simulation(duration=0.3, frame_rate=60)
    scene.cylinder("wheel", radius=0.07, height=0.25, position=(0, 0, 1), mass=1)
    slow = Drive(stiffness=0.3, damping=0.02, position=-8)
    scene.joint_revolute("axle", None, "wheel", axis="X", drive=slow)
    scene.sphere("bob", radius=0.05, position=(0.5, 0.1, 1.2), mass=0.3)
    scene.joint_prismatic("slide", "wheel", "bob", axis="Y", drive=Drive(stiffness=1500, damping=1, position=0.02))


def lifted(scene):
    """A ball that a stiff drive lifts at once; nothing but the work of drives is recorded of that."""
    scene.simulation(duration=0.3, frame_rate=24)
    scene.sphere("ball", radius=0.08, position=(0, 0, 1), mass=3.4)
    lift = Drive(stiffness=32e3, damping=2800, position=0.14)
    scene.joint_prismatic("post", None, "ball", axis="Z", drive=lift)


BUILDS = {build.__name__: build for build in (swung, carried, shaken, lifted)}


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    made = {}
    for name, build in BUILDS.items():
        folder, scene = tmp_path_factory.mktemp(name), Scene()
        build(scene)
        Simulation(scene.save(folder / "stage.usda"), "cpu").run(folder / "run.rrd")
        made[name] = read(folder / "run.rrd")
    return made


def bare(run):
    """As another simulator's trajectory: neither contacts, ties nor a step."""
    return replace(with_world(run, time_step=0.0), metadata={"complete": True}, contacts=None, ties=None)


@pytest.mark.parametrize("name", BUILDS)
def test_sound_drives_that_frames_do_not_follow_are_accepted(runs, name):
    """As they were recorded, and by their motion alone."""
    for run in (runs[name], bare(runs[name])):
        assert [(finding.check, finding.message) for finding in judge(run).failures] == []


def rejected(check, run):
    return not all(finding.passed for finding in ask(check, run))


def test_work_that_is_not_recorded_is_found(runs):
    """What drives of one mechanism gave they gave together."""
    moving = float(Evidence(runs["shaken"]).motion.kinetic.sum(axis=1).max())
    for change in (0.3 * moving, -0.3 * moving):
        work = runs["shaken"].scalars["work/drives"].copy()
        work[5] += change
        told = replace(runs["shaken"], scalars=runs["shaken"].scalars | {"work/drives": work})
        assert rejected(CheckEnergy(), told)


def test_what_a_drive_cannot_have_given_is_found(runs):
    """Of a body apart from others that are driven, too: twice the 250 J that its drive held."""
    motion = Evidence(runs["swung"]).motion
    faster = np.sqrt(2.0 * 500.0 / motion.mass[2]) + float(motion.speed[:, 2].max())
    assert rejected(CheckEnergy(), edited(runs["swung"], "body_qd", (slice(8, 10), 2, 2), faster))


def test_a_joint_that_goes_farther_than_it_may_swing_is_found(runs):
    """By 0.5 m, where it swings by less than 0.05 m about where its drive is set to."""
    assert rejected(CheckContinuity(), edited(runs["swung"], "body_q", (6, 0, 0), 0.5))


def test_a_deck_that_something_else_pulls_is_found(runs):
    """By half of what its drive gives, once its base has come to rest."""
    run = runs["carried"]
    heavy = [b.model_copy(update={"mass": 2.0 * b.mass}) if b.prim.endswith("deck") else b for b in run.world.bodies]
    assert rejected(CheckForces(), bare(with_world(run, bodies=heavy)))


def test_a_slow_drive_that_is_shaken_is_held_to_its_law(runs):
    """A tenth of its effort more is found."""
    run = runs["shaken"]
    joints = run.ties.joints.copy()
    joints[:, 0, 13] *= 1.1
    assert rejected(CheckRecordedTies(), replace(run, ties=replace(run.ties, joints=joints)))
