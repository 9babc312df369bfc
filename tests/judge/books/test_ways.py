"""What a joint's way tells of its drive: by closed form, and on vehicles and robots whose ties nobody recorded."""

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.judge.theory import ask
from wsim.judge.books import jolts
from wsim.judge.books.mobility import mobilities
from wsim.judge.books.ways import Course, eased, off_the_way
from wsim.judge.checks.forces import CheckForces
from wsim.judge.evidence.evidence import Evidence
from wsim.judge.evidence.scheduled import Aims
from wsim.recording import read
from wsim.scene import Drive, Scene
from wsim.scene.world import Motor
from wsim.sim import Simulation

H, FRAMES = 1.0 / 60.0, 30


def told(drive, place, rate, mobility):
    """What the way tells of a drive that is set to 0, and by how much that may be off."""
    h = np.full(len(place) - 1, H)
    mean, may = jolts.mean_force((drive.stiffness, drive.damping), place, rate, h, 0.0)
    course = Course(place, rate, h, 1.0, mobility, 0.0)
    return -mean, off_the_way(drive, course, -mean, may, np.full(len(h), True), np.full(len(h), False))


@pytest.mark.parametrize("phase", [0.3, 1.0, 1.9])
def test_a_mode_that_swings_between_frames_is_told(phase):
    omega, drive = phase / H, Motor(stiffness=100.0, damping=0.0)
    t = np.arange(FRAMES) * H + 0.003
    mean, off = told(drive, np.sin(omega * t), omega * np.cos(omega * t), omega**2 / 100.0)
    true = -100.0 * np.diff(-np.cos(omega * t)) / phase
    assert np.all(np.abs(mean - true) <= off)
    assert phase > 1.0 or np.all(off < 0.1 * 100.0)


def test_a_mode_that_is_faster_is_not():
    omega, t = 2.2 / H, np.arange(FRAMES) * H
    _, off = told(Motor(stiffness=100.0), np.sin(omega * t), omega * np.cos(omega * t), omega**2 / 100.0)
    assert np.all(np.isinf(off))


def test_what_is_damped_away_within_an_interval_is_told_by_how_far_it_went():
    """A wheel that a step throws up, by 2 m/s within the interval, whose damper takes it back in a quarter of it."""
    fades, speed, when = 0.25 * H, 2.0, 10.3 * H
    t = np.arange(FRAMES) * H
    since = np.maximum(t - when, 0.0)
    place, rate = speed * fades * (1.0 - np.exp(-since / fades)), speed * np.exp(-since / fades) * (t > when)
    drive = Motor(stiffness=25e3, damping=36.0 / fades)
    mean, off = told(drive, place, rate, 1.0 / 36.0)
    whole = np.where(t > when, speed * fades * (since - fades * (1.0 - np.exp(-since / fades))), 0.0)
    true = -25e3 * np.diff(whole) / H - drive.damping * np.diff(place) / H
    assert np.all(np.abs(mean - true) <= off)
    assert np.all(off[:9] < 1e-3 * 36.0 * speed / H)


def test_a_drive_at_its_most_is_known_where_its_joint_goes_evenly():
    """A joint that goes evenly, and one that turned back for a tenth of an interval, by as much as it takes."""
    drive, h = Motor(damping=100.0, velocity=2.0, max_effort=50.0), np.full(9, 0.02)
    place, rate = 0.02 * np.arange(10.0), np.ones(10)
    still, asked = np.zeros(10), np.full(10, drive.velocity)
    aims = Aims(still, asked, still[1:], asked[1:], still[1:], np.zeros(9, dtype=bool), set=False)
    assert np.all(eased(drive, aims, place, rate, h) < 1e-12)
    place[5:] += 0.5 * 0.1 * 0.02  # 0.5 m/s faster for a tenth of it, at which it is asked for its most and no more
    assert eased(drive, aims, place, rate, h)[4] == pytest.approx(0.2)


# ---- worlds
def car(scene):
    scene.simulation(duration=0.7, frame_rate=60)
    scene.ground()
    scene.vehicle("car", speed=5.0)


def arm(scene):
    scene.simulation(duration=0.7, frame_rate=60)
    scene.ground()
    robot = scene.robot("arm", "desk_arm", joints={"lift": 10.0, "elbow": 80.0, "wrist": 30.0})
    robot.drive("lift", position=0.0)


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    made = {}
    for build in (car, arm):
        folder, scene = tmp_path_factory.mktemp(build.__name__), Scene()
        build(scene)
        Simulation(scene.save(folder / "stage.usda"), device="cpu").run(folder / "r.rrd")
        made[build.__name__] = without_ties(read(folder / "r.rrd"))
    return made


def without_ties(run):
    world = run.world.model_copy(update={"time_step": 0.0})
    return replace(run, world=world, metadata={"complete": True}, contacts=None, ties=None)


def heavier(run, prim, share):
    """What its world says to weigh more: up to there a share of that weight is lifted by nothing."""
    bodies = [
        body.model_copy(update={"mass": body.mass / (1.0 - share)}) if body.prim == prim else body
        for body in run.world.bodies
    ]
    return replace(run, world=run.world.model_copy(update={"bodies": bodies}))


def accepted(run):
    return all(finding.passed for finding in ask(CheckForces(), run))


@pytest.mark.parametrize("name", ["car", "arm"])
def test_sound_runs_are_accepted(runs, name):
    assert accepted(runs[name])


@pytest.mark.parametrize(
    ("name", "prim", "share"),
    [("car", "/World/car", 0.15), ("car", "/World/car", 0.05)],
)
def test_a_lift_by_nothing_is_found_where_no_tie_was_recorded(runs, name, prim, share):
    """Its springs' laws tell what they carry, though what they damp is faster than the frames."""
    assert not accepted(heavier(runs[name], prim, share))


def leg(position, damping=800.0):
    """A spring and a damper throw a foot from its base, in free fall."""

    def build(scene):
        scene.simulation(duration=0.3, frame_rate=60)
        base = scene.box("base", size=(0.4, 0.4, 0.2), position=(0, 0, 1), density=300)
        foot = scene.box("foot", size=(0.1, 0.1, 0.1), position=(0, 0, 0.8), density=1000)
        drive = Drive(stiffness=3000, damping=damping, position=position)
        scene.joint_prismatic("leg", base, foot, axis="Z", drive=drive)

    return build


def cart(stiffness, damping, most):
    """A ball hits a cart, whose drive is at its most for a few milliseconds between two frames."""

    def build(scene):
        scene.simulation(duration=0.6, frame_rate=24)
        base = scene.box("base", size=(0.4, 0.4, 0.2), position=(0, 0, 3), density=300)
        moved = scene.box("cart", size=(0.1, 0.1, 0.1), position=(0, 0, 3.2), density=1000)
        drive = Drive(stiffness=stiffness, damping=damping, max_force=most)
        scene.joint_prismatic("rail", base, moved, axis="X", drive=drive)
        scene.sphere("ball", radius=0.05, position=(-0.35, 0, 3.2), velocity=(2, 0, 0), density=2000)

    return build


def rotor(scene):
    """It is at its speed after some steps, and turns on with a slider upon it."""
    scene.simulation(duration=0.5, frame_rate=24)
    scene.ground()
    base = scene.box("base", size=(0.4, 0.4, 0.2), position=(0, 0, 0.1), density=300)
    arm = scene.box("rotor", size=(0.3, 0.1, 0.1), position=(0, 0, 0.26), density=1000)
    scene.joint_revolute("axle", base, arm, axis="Z", drive=Drive(damping=50.0, velocity=200.0))
    bob = scene.box("bob", size=(0.06, 0.06, 0.06), position=(0.2, 0, 0.26), density=1000)
    drive = Drive(stiffness=20000, damping=400, position=0.05)
    scene.joint_prismatic("slide", arm, bob, axis="X", drive=drive, limits=(-0.02, 0.03))


STIFF = {
    "thrown": leg(-0.05), "thrown far": leg(-0.15), "thrown a little": leg(-0.02), "held back": leg(-0.1, 2000.0),
    "hit": cart(0.0, 1000.0, 250.0), "hit on a spring": cart(500.0, 300.0, 150.0), "turned": rotor,
}  # fmt: skip


@pytest.mark.parametrize("case", STIFF)
def test_what_is_damped_within_a_few_steps_is_accepted(tmp_path, case):
    """As it was recorded, and with neither contacts, ties nor a step."""
    scene = Scene()
    STIFF[case](scene)
    Simulation(scene.save(tmp_path / "stage.usda"), device="cpu").run(tmp_path / "r.rrd")
    run = read(tmp_path / "r.rrd")
    assert accepted(run)
    assert accepted(without_ties(run))


def test_a_joint_moves_what_hangs_on_it_and_no_less(runs):
    """A wheel's spring its hub and the wheel, a little less than 36 kg as the body gives way; an arm's lift its all."""
    of_car, of_arm = (mobilities(Evidence(runs[name])) for name in ("car", "arm"))
    body = 1300.0 - 4 * 36.0
    assert 1.0 / of_car["/World/car_spring_rear_left"] == pytest.approx(36.0, rel=0.15)
    assert 1.0 / of_car["/World/car_spring_rear_left"] > 1.0 / (1.0 / 36.0 + 4.0 / body)
    rotor = next(joint for joint in runs["arm"].world.joints if joint.prim.endswith("lift")).armature
    assert 1.0 / of_arm["/World/arm/joints/lift"] > rotor + 1.4 * 0.12**2 + 0.8 * 0.1**2
    assert math.isfinite(of_arm["/World/arm/joints/roll"])
