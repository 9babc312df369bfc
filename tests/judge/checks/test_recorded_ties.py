"""What joints, springs and ropes of real runs gave: as it is, by closed form, and with one thing of it changed."""

from dataclasses import replace

import numpy as np
import pytest

from tests.judge.theory import ask
from wsim.judge.books.recorded import RecordedContacts
from wsim.judge.checks.recorded import CheckRecordedForces
from wsim.judge.checks.recorded_ties import SAYS, CheckRecordedTies
from wsim.judge.evidence.evidence import Evidence
from wsim.recording import read
from wsim.recording.ties import cord_ends
from wsim.scene import Drive, Scene
from wsim.sim import Simulation

G, RATE = 9.81, 60.0
FRICTION, STRENGTH = 0.4, 12.0


def run(folder, build, rate=RATE):
    scene = Scene()
    scene.simulation(duration=0.6, frame_rate=rate)
    build(scene)
    Simulation(scene.save(folder / "stage.usda"), device="cpu").run(folder / "r.rrd")
    return read(folder / "r.rrd")


def swings(scene):
    """Nothing rubs or touches: two rods on hinges, a ball on a ball joint, a driven slider, a bob on a spring."""
    scene.box("upper", size=(0.4, 0.05, 0.05), mass=1.0, position=(0.2, 0, 2))
    scene.box("lower", size=(0.4, 0.05, 0.05), mass=0.5, position=(0.6, 0, 2))
    scene.joint_revolute("shoulder", None, "upper", anchor=(0, 0, 2), axis="Y")
    scene.joint_revolute("elbow", "upper", "lower", anchor=(0.4, 0, 2), axis="Y")
    scene.sphere("ball", radius=0.1, mass=2.0, position=(0.4, 1, 1.7))
    scene.joint_spherical("socket", None, "ball", anchor=(0, 1, 2))
    scene.box("cart", size=(0.2, 0.2, 0.2), mass=1.0, position=(0, 2, 1))
    drive = Drive(position=0.3, stiffness=60.0, damping=6.0, max_force=STRENGTH)
    scene.joint_prismatic("rail", None, "cart", axis="X", drive=drive)
    scene.sphere("bob", radius=0.1, mass=1.0, position=(0, 3, 1))
    scene.spring("coil", None, "bob", stiffness=80.0, damping=1.0, rest_length=0.6, anchor_a=(0, 3, 1.7))


def rubs(scene):
    """A sign on a weld, a wheel that its hinge slows, a flap that meets its stop, a ball on a rope."""
    scene.box("sign", size=(0.4, 0.1, 0.1), mass=3.0, position=(0.5, 0, 1))
    scene.joint_fixed("bracket", None, "sign", anchor=(0, 0, 1), break_force=1e5)
    scene.cylinder("wheel", radius=0.1, height=0.05, axis="Y", mass=2.0, position=(0, 1, 1),
                   angular_velocity_deg=(0, 2000, 0))  # fmt: skip
    scene.joint_revolute("axle", None, "wheel", anchor=(0, 1, 1), axis="Y", friction=FRICTION)
    scene.box("flap", size=(0.4, 0.05, 0.05), mass=1.0, position=(0.2, 2, 1))
    scene.joint_revolute("hinge", None, "flap", anchor=(0, 2, 1), axis="Y", limits_deg=(-90, 30))
    scene.sphere("weight", radius=0.1, mass=1.0, position=(0.3, 4, 1.6))
    scene.rope("rope", None, "weight", anchor_a=(0, 4, 2))


@pytest.fixture(scope="module")
def smooth(tmp_path_factory):
    return run(tmp_path_factory.mktemp("swings"), swings)


@pytest.fixture(scope="module")
def stopped(tmp_path_factory):
    return run(tmp_path_factory.mktemp("rubs"), rubs)


def joint(recording, name):
    return [each.prim for each in recording.world.joints].index(f"/World/{name}")


def wrong(recording):
    """The kinds of questions whose answer is wrong, by what the finding would say if it were right."""
    kinds = {fine: kind for kind, fine in SAYS.items()}
    found = ask(CheckRecordedTies(), recording)
    fine = {kinds[finding.message] for finding in found if finding.passed}
    return {asked for asked in kinds.values() if asked not in fine} if any(not f.passed for f in found) else set()


def unbalanced(recording):
    return {finding.unit for finding in ask(CheckRecordedForces(), recording) if not finding.passed}


def changed(recording, name, columns, by, add=0.0):
    """With some columns of a joint's sums scaled, and something added."""
    sums = recording.ties.joints.copy()
    sums[1:, joint(recording, name), columns] = by * sums[1:, joint(recording, name), columns] + add
    return replace(recording, ties=replace(recording.ties, joints=sums))


def told(recording, name, **fields):
    """Of a world that states something else of a joint."""
    joints = [each.model_copy(update=fields) if each.prim == f"/World/{name}" else each
              for each in recording.world.joints]  # fmt: skip
    return replace(recording, world=recording.world.model_copy(update={"joints": joints}))


@pytest.mark.parametrize("which", ["smooth", "stopped"])
def test_what_is_recorded_adds_up(which, request):
    recording = request.getfixturevalue(which)
    assert not wrong(recording)
    assert not unbalanced(recording)
    balance = ask(CheckRecordedForces(), recording)[:2]
    assert all(finding.value < 0.5 * finding.limit for finding in balance)


def test_smooth_steps_close_each_books_to_a_thousandth(smooth):
    """Of gravity and of what ties give: a fifth of what is asked for, where the limit knows of no step's order."""
    books = RecordedContacts(Evidence(smooth), smooth.contacts).balanced()
    assert (np.linalg.norm(books.force, axis=2) / (G + books.moved)).max() < 1e-3
    assert (np.linalg.norm(books.torque, axis=2) / (G + books.moved)).max() < 1e-3


def test_a_weld_carries_weight_and_moment(stopped):
    ties, h, k = stopped.ties, 1.0 / RATE, joint(stopped, "bracket")
    assert ties.impulse[20:, k] / h == pytest.approx(np.tile([0, 0, 3.0 * G], (17, 1)), abs=0.01)
    assert ties.about_anchor[20:, k] / h == pytest.approx(np.tile([0, -3.0 * G * 0.5, 0], (17, 1)), abs=0.01)


def test_friction_and_stops_give_what_they_take(stopped):
    ties, h, k = stopped.ties, 1.0 / RATE, joint(stopped, "axle")
    assert ties.friction[1:, k] / h == pytest.approx(-FRICTION, rel=1e-4)
    rate = np.array([stopped.angular_velocity("/World/flap")[:, 1]]).ravel()
    k, hit = joint(stopped, "hinge"), int(np.argmin(np.diff(rate)))
    turned = 1.0 * (0.4**2 + 0.05**2) / 12.0 + 0.2**2  # about the hinge [kg m^2]
    weighs = 1.0 * G * 0.2 * h  # at most
    assert ties.stop[hit + 1, k] == pytest.approx(turned * (rate[hit + 1] - rate[hit]), abs=weighs)


def test_springs_pull_by_their_law(smooth):
    """k x + c x' along the spring."""
    assert [smooth.world.bodies[row].prim for _, row in cord_ends(smooth.world)] == ["/World/bob"]
    long, rate = 1.7 - smooth.position("/World/bob")[:, 2], -smooth.velocity("/World/bob")[:, 2]
    expected = 80.0 * (long - 0.6) + rate
    assert smooth.ties.tension[1:, 0] * RATE == pytest.approx(0.5 * (expected[1:] + expected[:-1]), abs=0.05)


def test_ropes_pull_by_what_swings_on_them(stopped):
    """A tension of m (g cos a + v^2 / l)."""
    at, speed = stopped.position("/World/weight") - [0, 4, 2], np.linalg.norm(stopped.velocity("/World/weight"), axis=1)
    expected = G * -at[:, 2] / 0.5 + speed**2 / 0.5
    assert stopped.ties.tension[1:, 0] * RATE == pytest.approx(0.5 * (expected[1:] + expected[:-1]), rel=5e-3)


@pytest.mark.parametrize("name", ["shoulder", "elbow", "socket", "rail"])
@pytest.mark.parametrize("by", [1.1, 0.0], ids=["a tenth more", "missing"])
def test_a_reaction_that_is_another_does_not_explain_the_motion(smooth, name, by):
    assert "N" in unbalanced(changed(smooth, name, slice(0, 12), by))


def test_what_passes_along_a_free_axis(smooth):
    """Told or not told: as a number that nothing gives, or as a moment that the impulse does not have."""
    assert "passes" in wrong(changed(smooth, "elbow", 12, 1.0, 1e-3))
    assert "passes" in wrong(changed(smooth, "socket", 9, 1.0, 5e-2))
    assert "places" in wrong(changed(smooth, "elbow", 7, 1.0, 5e-3))


def test_drives_keep_to_their_law_and_their_strength(smooth):
    drive = smooth.world.joints[joint(smooth, "rail")].drive
    assert "drive" in wrong(told(smooth, "rail", drive=drive.model_copy(update={"stiffness": 66.0})))
    assert "cap" in wrong(told(smooth, "rail", drive=drive.model_copy(update={"max_effort": 0.9 * STRENGTH})))
    assert "drive" in wrong(told(smooth, "rail", drive=None))


def test_joints_rub_and_stop_where_they_are_stated_to(stopped):
    assert "friction" in wrong(told(stopped, "axle", friction=0.9 * FRICTION))
    assert "friction" in wrong(told(stopped, "axle", friction=1.1 * FRICTION))
    assert "stop" in wrong(told(stopped, "hinge", high=np.radians(80.0)))
    assert "stop" in wrong(changed(stopped, "hinge", [12, 15], -1.0))


def small(scene):
    """A centimetre's slider on an arm that its drive hurls round: what it passes on turns within a frame."""
    scene.box("arm", size=(0.02, 0.003, 0.002), mass=8e-4, position=(0.01, 0, 0))
    scene.joint_revolute("hub", None, "arm", anchor=(0, 0, 0), axis="Z",
                         drive=Drive(position=40.0, stiffness=6e-4, damping=9e-5))  # fmt: skip
    scene.box("cart", size=(0.02, 0.003, 0.002), mass=5e-4, position=(0.02, 0.004, 0))
    drive = Drive(position=0.004, stiffness=0.02, damping=0.005)
    scene.joint_prismatic("rail", "arm", "cart", axis="X", drive=drive)


def test_a_small_slider_is_held_as_closely_as_a_large_one(tmp_path):
    """Its force along its rail is told as a moment by its own lever, and half of what it bears is found there."""
    recording = run(tmp_path, small, 24.0)
    assert wrong(recording) == set()
    passed = np.linalg.norm(recording.ties.impulse[1:, joint(recording, "rail")], axis=1).max()
    assert "places" in wrong(changed(recording, "rail", 12, 1.0, 0.5 * passed))


def pulling(recording, by, column=slice(None)):
    cords = recording.ties.cords.copy()
    cords[1:, 0, column] *= by
    return replace(recording, ties=replace(recording.ties, cords=cords))


def test_cords_that_push_or_pull_otherwise(smooth, stopped):
    assert "rope" in wrong(pulling(stopped, -1.0))
    assert "way" in wrong(pulling(stopped, 0.9, 0))
    assert "spring" in wrong(pulling(smooth, 0.9))
    assert "N" in unbalanced(pulling(smooth, 1.1))
    assert "N" in unbalanced(pulling(stopped, 1.1))
    slack = stopped.world.ropes[0].model_copy(update={"length": 0.6})
    assert "rope" in wrong(replace(stopped, world=stopped.world.model_copy(update={"ropes": [slack]})))


def test_of_recordings_of_before_nothing_is_asked(smooth):
    before = replace(smooth, ties=None)
    assert not ask(CheckRecordedTies(), before)
    assert not unbalanced(before)


# ---- blows
def cradle(scene):
    """Three balls in a row, each welded to a rod on a hinge, 1 mm apart; the first swings at the others."""
    for k, angle in enumerate((20.0, 0.0, 0.0)):
        turn, x, height = np.radians(angle), 0.101 * k, 0.8
        down, rod, bob = np.array([-np.sin(turn), 0.0, -np.cos(turn)]), 0.25, 0.3
        place = [tuple(np.array([x, 0.0, height]) + far * down) for far in (rod / 2, bob)]
        scene.cylinder(f"rod_{k}", radius=0.005, height=rod, mass=0.1, position=place[0], rotation_deg=(0, angle, 0))
        scene.sphere(f"ball_{k}", radius=0.05, mass=4.0, position=place[1], restitution=0.9)
        scene.joint_revolute(f"pivot_{k}", None, f"rod_{k}", anchor=(x, 0, height), axis="Y")
        joint = tuple(np.array([x, 0.0, height]) + rod * down)
        scene.joint_fixed(f"hold_{k}", f"rod_{k}", f"ball_{k}", anchor=joint)


@pytest.fixture(scope="module")
def hit(tmp_path_factory):
    return run(tmp_path_factory.mktemp("cradle"), cradle)


def test_blows_within_a_frame_act_with_the_arms_of_their_instants(hit):
    """The second ball is hit and hits the third one in one interval; what its rod holds it with comes and goes."""
    evidence = Evidence(hit)
    ties = RecordedContacts(evidence, hit.contacts).ties
    row = evidence.index("/World/ball_1")
    taken = ties._uneven[:, row]
    assert taken.max() > 2.0  # of 4 kg at 0.6 m/s
    assert all(finding.passed for finding in ask(CheckRecordedTies(), hit))
    k, hold = int(np.argmax(taken)), joint(hit, "hold_1")
    joints = hit.ties.joints.copy()
    joints[k + 1, hold, 3:9] *= 1.5  # both angular impulses, of neither arm
    assert not all(f.passed for f in ask(CheckRecordedTies(), replace(hit, ties=replace(hit.ties, joints=joints))))
