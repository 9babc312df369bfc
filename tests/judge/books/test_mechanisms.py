"""What the steps of mechanisms leave of the books, at their stops and in closed loops."""

import numpy as np
import pytest

from tests.judge.theory import ask, with_world
from wsim.judge.books.balance import Books
from wsim.judge.checks.forces import CheckForces
from wsim.judge.checks.recorded_ties import CheckRecordedTies
from wsim.judge.evidence.evidence import Evidence
from wsim.recording import read
from wsim.scene import Scene
from wsim.sim import Simulation

STEPS = (1.25e-3, 6.25e-4)  # [s]


def recorded(folder, scene, step):
    simulation = Simulation(scene.save(folder / "stage.usda"), device="cpu", time_step=step)
    simulation.run(folder / "r.rrd")
    return read(folder / "r.rrd")


@pytest.fixture(scope="module")
def elbows(tmp_path_factory):
    """A double pendulum that falls with its elbow at its stop, and near it; by two steps."""
    found = []
    for step in STEPS:
        scene = Scene()
        scene.simulation(duration=0.4, frame_rate=200.0)
        for name, length, mass, x in (("upper", 0.5, 1.0, 0.25), ("lower", 0.4, 0.5, 0.7)):
            scene.box(name, size=(0.04, 0.04, length), mass=mass, position=(x, 0, 2), rotation_deg=(0, -90, 0))
        scene.joint_revolute("shoulder", None, "upper", anchor=(0, 0, 2), axis="Y")
        scene.joint_revolute("elbow", "upper", "lower", anchor=(0.5, 0, 2), axis="Y", limits_deg=(-10, 10))
        found.append(recorded(tmp_path_factory.mktemp("elbows"), scene, step))
    return found


@pytest.fixture(scope="module")
def crank(tmp_path_factory):
    """A flywheel drives a light slider with dry friction through a rod, without gravity."""
    scene, radius, length, rate, friction = Scene(), 0.1, 0.3, 10.0, 10.0
    scene.simulation(gravity=(0, 0, 0), duration=0.5, frame_rate=200.0)
    far, lean = np.sqrt(length**2 - radius**2), np.degrees(np.arcsin(-radius / length))
    along = {"velocity": (-rate * radius, 0, 0)}
    spin = (0, 0, np.degrees(rate))
    scene.cylinder("wheel", radius=0.2, height=0.03, mass=10, position=(0, 0, 1), angular_velocity_deg=spin)
    scene.box(
        "rod", size=(length, 0.02, 0.02), mass=0.05, position=(far / 2, radius / 2, 1.05), rotation_deg=(0, 0, lean),
        **along,
    )  # fmt: skip
    scene.box("ram", size=(0.05, 0.05, 0.05), mass=0.05, position=(far, 0, 1.1), **along)
    scene.joint_revolute("axle", None, "wheel", axis="Z")
    scene.joint_revolute("pin", "wheel", "rod", anchor=(0, radius, 1.03), axis="Z")
    scene.joint_revolute("head", "rod", "ram", anchor=(far, 0, 1.07), axis="Z")
    scene.joint_prismatic("guide", None, "ram", axis="X", friction=friction)
    return recorded(tmp_path_factory.mktemp("crank"), scene, STEPS[0])


def off(recording, check=CheckForces):
    return [finding for finding in ask(check(), recording) if not finding.passed]


def test_an_elbow_at_its_stop_leaves_nothing(elbows):
    """By steps of the first order it left 0.018 and 0.009 N of 15, half a step's turn of that, now 2e-5 of it."""
    books = [Books.of(Evidence(each)) for each in elbows]
    calm = slice(60, 70)  # the elbow leaves its stop, by 0.01 rad
    for each in books:
        assert np.linalg.norm(each.force[calm], axis=2).max() < 5e-4
        assert np.all(np.linalg.norm(each.force[calm], axis=2) < each.turned[calm, :, 0])


def test_sound_mechanisms_are_accepted(elbows, crank):
    assert not any(off(each) for each in (*elbows, crank))


@pytest.mark.parametrize("share", [0.97, 1.03, 1.2])
def test_a_gravity_that_is_another_is_found_beside_a_stop(elbows, share):
    assert off(with_world(elbows[0], gravity=(0.0, 0.0, -share * 9.81)))


@pytest.mark.parametrize("share", [0.67, 0.9, 1.1, 1.33, 2.0])
def test_a_friction_that_is_another_is_found_in_a_linkage(crank, share):
    joints = [joint.model_copy(update={"friction": share * joint.friction}) for joint in crank.world.joints]
    told = with_world(crank, joints=joints)
    assert off(told, CheckRecordedTies)
    assert bool(off(told, CheckForces)) == (share < 1.0)  # joints may rub less: what is recorded of them explains it


def test_a_push_on_a_linkage_is_found(crank):
    """0.2 g along the guide, which the world is told to have."""
    assert off(with_world(crank, gravity=(1.962, 0.0, 0.0)))
