"""Drives that are so stiff that they get where they are set within a frame."""

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.judge.theory import ask, edited, only, with_world
from wsim.judge import judge
from wsim.judge.books.driven import given_within, held, settled
from wsim.judge.books.laws import Laws
from wsim.judge.checks.energy import CheckEnergy
from wsim.judge.checks.forces import CheckForces
from wsim.judge.checks.physics import CheckExplosion
from wsim.judge.checks.recorded_ties import CheckRecordedTies
from wsim.judge.evidence.evidence import Evidence
from wsim.recording import read
from wsim.scene import Drive, Scene
from wsim.scene.world import Motor
from wsim.sim import Simulation


def simulated(folder, build, seconds):
    scene = Scene()
    scene.simulation(duration=seconds)
    build(scene)
    Simulation(scene.save(folder / "stage.usda"), "cpu").run(folder / "run.rrd")
    return read(folder / "run.rrd")


def served(scene):
    """An arm that goes at up to 41 rad/s within 33 ms: w = 100 rad/s, at 0.7 of critical damping."""
    scene.simulation(gravity=(0, 0, 0), frame_rate=30)
    scene.box("arm", size=(0.3, 0.03, 0.03), position=(0.15, 0, 1), density=2700)
    scene.joint_revolute(
        "hinge", None, "arm", anchor=(0, 0, 1), axis="Z", drive=Drive(position=45, stiffness=200, damping=2.9)
    )


def test_what_a_drive_gives_within_a_frame_is_no_explosion(tmp_path):
    recording = simulated(tmp_path, served, 0.5)
    assert only(ask(CheckExplosion(), recording)).passed
    assert given_within(Evidence(recording))[0] == pytest.approx(0.5 * 200 * (math.pi / 4) ** 2, rel=1e-6)
    for frame in (0, 8):  # before it gave anything, and once it holds nothing any more
        late = edited(recording, "body_qd", (frame, 0, 1), 12.0)
        assert not only(ask(CheckExplosion(), late)).passed


def test_a_drive_at_its_greatest_effort_holds_what_that_works_over_the_way():
    at = np.array([0.0, 0.9, 1.0])
    assert held(Motor(stiffness=100.0, position=1.0), 1.0, at) == pytest.approx([50.0, 0.5, 0.0])
    assert held(Motor(stiffness=100.0, position=1.0, max_effort=20.0), 1.0, at) == pytest.approx([18.0, 0.5, 0.0])
    assert held(Motor(damping=3.0, velocity=2.0, max_effort=20.0), 0.0, at) == pytest.approx([0.0, 0.0, 0.0])


def hurled(scene):
    """As `served` is, at 0.66 of critical damping and 214 rad/s, of which a step takes a quarter."""
    scene.simulation(gravity=(0, 0, 0), frame_rate=60, time_step=1 / 900)
    scene.box("arm", size=(0.3, 0.03, 0.03), position=(0.15, 0, 1), density=2700)
    scene.joint_revolute(
        "hinge", None, "arm", anchor=(0, 0, 1), axis="Z", drive=Drive(position=45, stiffness=1000, damping=6.5)
    )


def test_what_a_joint_gives_in_the_first_step_is_recorded(tmp_path):
    """It was taken for what it began with: m l k q / I dt = 4.36 N s. The trapezoid misses c dt / 12 I of that."""
    recording, dt = simulated(tmp_path, hurled, 0.1), 1 / 900
    body = recording.world.bodies[0]
    about = body.mass * (0.15**2 + (0.3**2 + 0.03**2) / 12)
    first = body.mass * 0.15 * 1000 * (math.pi / 4) / about * dt
    off = recording.ties.impulse[1, 0, 1] - body.mass * recording.body_qd[1, 0, 1]
    assert abs(off) < 6.5 * dt / about / 12 * first


def thrown_up(scene):
    """A heavy arm about a level axis, whose drive swings it to and fro within a frame."""
    scene.simulation(frame_rate=24)
    scene.box("arm", size=(0.3, 0.03, 0.03), position=(0.15, 0, 1), density=2700)
    scene.joint_revolute(
        "hinge", None, "arm", anchor=(0, 0, 1), axis="Y", drive=Drive(position=-45, stiffness=200, damping=1)
    )


def test_a_drive_that_is_faster_than_frames_does_the_work_that_is_recorded(tmp_path):
    recording = simulated(tmp_path, thrown_up, 0.5)
    assert [finding.message for finding in ask(CheckEnergy(), recording) if not finding.passed] == []
    for change in (3.0, -3.0):  # of some 60 J
        work = recording.scalars["work/drives"].copy()
        work[4] += change
        told = replace(recording, scalars=recording.scalars | {"work/drives": work})
        assert not all(finding.passed for finding in ask(CheckEnergy(), told))


def closed(scene):
    """A door, whose drive closes it and damps it, that a ball hits."""
    scene.simulation(frame_rate=30)
    scene.box("door", size=(0.8, 0.04, 1.8), position=(0.4, 0, 1), mass=12)
    closer = Drive(position=0, stiffness=5, damping=4)
    scene.joint_revolute("hinge", None, "door", anchor=(0, 0, 1), axis="Z", drive=closer)
    scene.sphere("ball", radius=0.1, position=(0.5, -0.6, 1), velocity=(0, 3, 1.5), mass=3, restitution=0.2)


def carried(scene):
    """A plate on a driven slider, on which a ball falls."""
    scene.simulation(frame_rate=60, time_step=2.5e-4)
    scene.box("plate", size=(0.8, 0.8, 0.04), position=(0, 0, 0.6), mass=5)
    scene.joint_prismatic("rail", None, "plate", axis="Z", drive=Drive(stiffness=2000, damping=20))
    scene.sphere("ball", radius=0.1, position=(0, 0, 1.5), mass=3, restitution=0.3)


def turned_on(scene):
    """A wheel that a drive of 2 N m s keeps turning, on whose rim a ball falls."""
    scene.simulation(frame_rate=60)
    scene.cylinder("wheel", radius=0.3, height=0.1, axis="Y", position=(0, 0, 1), mass=5, friction=0.5)
    turning = Drive(velocity=180, damping=2)
    scene.joint_revolute("axle", None, "wheel", axis="Y", drive=turning)
    scene.sphere("ball", radius=0.05, position=(0.1, 0, 1.6), mass=2, friction=0.5, restitution=0.4)


@pytest.mark.parametrize(("build", "seconds"), [(closed, 0.6), (carried, 0.6), (turned_on, 0.6)])
def test_a_drive_that_is_struck_damps_by_how_far_it_went(tmp_path, build, seconds):
    """By c dq / h: the mean of the rates at both ends of the blow's interval says several times as much."""
    recording = simulated(tmp_path, build, seconds)
    checks = (CheckRecordedTies(), CheckForces())
    assert [f.message for check in checks for f in ask(check, recording) if not f.passed] == []
    q, drive = Evidence(recording).joint(recording.world.joints[0]), recording.world.joints[0].drive
    h, rate = np.diff(recording.time), Laws(Evidence(recording)).rate(recording.world.joints[0])
    blow = int(np.argmax(np.abs(np.diff(rate))))
    by_rates = 0.5 * drive.damping * (rate[blow] + rate[blow + 1])
    damped = drive.damping * np.diff(q.position)[blow] / h[blow]
    assert abs(by_rates - damped) > 1.9 or build is turned_on
    spring = drive.stiffness * (0.5 * (q.position[blow] + q.position[blow + 1]) - drive.position)
    late = drive.stiffness * h[blow] * abs(rate[blow + 1] - rate[blow]) / 8.0  # a jump halfway leaves that of the mean
    assert recording.ties.drive[blow + 1, 0] / h[blow] == pytest.approx(
        drive.damping * drive.velocity - damped - spring, abs=late + 0.05
    )
    if build is closed:  # where the ball strikes is not told as well of a spring of 2 kN/m
        joints = recording.ties.joints.copy()
        joints[blow + 1, 0, 13] -= 0.3 * (by_rates - damped) * h[blow]
        told = replace(recording, ties=replace(recording.ties, joints=joints))
        assert any("otherwise than by its drive's law" in f.message for f in ask(CheckRecordedTies(), told))


def four_bar(scene):
    """Links of 0.075, 0.2, 0.15 and 0.225 m, whose crank a servo turns to 1 rad within 33 ms."""
    scene.simulation(frame_rate=60)
    a, d, angle = np.array([0.0, 2.5]), np.array([0.225, 2.5]), 1.0
    b = a + 0.075 * np.array([math.cos(angle), math.sin(angle)])
    way = d - b
    r = float(np.hypot(*way))
    x = (0.2**2 - 0.15**2 + r * r) / (2.0 * r)
    c = b + x * way / r + math.sqrt(0.2**2 - x * x) * np.array([-way[1], way[0]]) / r
    links = {"crank": (a, b, 0.03, 0.0), "coupler": (b, c, 0.08, -0.015), "rocker": (d, c, 0.06, -0.03)}
    for name, (start, end, mass, y) in links.items():
        (x0, z0), (x1, z1) = start, end
        lean, length = math.degrees(math.atan2(z1 - z0, x1 - x0)), float(np.hypot(x1 - x0, z1 - z0))
        scene.box(name, size=(length, 0.01, 0.01), position=((x0 + x1) / 2, y, (z0 + z1) / 2), mass=mass,
                  rotation_deg=(0, -lean, 0))  # fmt: skip
    servo = Drive(position=math.degrees(1.0), stiffness=5, damping=0.05)
    pins = [("p1", None, "crank", a, servo), ("p2", "crank", "coupler", b, None), ("p3", "coupler", "rocker", c, None)]
    for name, parent, child, (x0, z0), drive in [*pins, ("p4", None, "rocker", d, None)]:
        scene.joint_revolute(name, parent, child, anchor=(x0, 0, z0), axis=(0, -1, 0), drive=drive)


def stiffer(recording, by):
    """The same motion, of a world whose drives are said to be stiffer."""

    def other(joint):
        drive = joint.drive and joint.drive.model_copy(update={"stiffness": by * joint.drive.stiffness})
        return joint.model_copy(update={"drive": drive})

    return with_world(recording, joints=[*map(other, recording.world.joints)])


@pytest.mark.parametrize("build", [served, thrown_up, four_bar])
def test_a_stiff_drive_is_sound_and_one_that_bears_a_load_at_a_tenth_more_or_less_is_found(tmp_path, build):
    """The frames do not show how it came where it is; there it holds the load by its law; one without shows none."""
    recording = simulated(tmp_path, build, 0.5)
    assert [(finding.check, finding.message) for finding in judge(recording).failures] == []
    for by in (0.9, 1.1) if build is not served else ():
        assert "CheckRecordedTies" in {finding.check for finding in judge(stiffer(recording, by)).failures}


def test_what_swings_faster_than_frames_is_not_at_rest():
    """A joint is seen at the same place each time, as it goes round once a frame, and a little less far each time."""
    drive, h = Motor(stiffness=100.0, damping=0.1, position=0.0), np.full(9, 0.1)
    swing = 0.01 * np.exp(-0.005 * np.arange(10))
    found = settled(h, swing, np.zeros(10), drive, np.ones(10))
    assert np.all(found > drive.stiffness * swing[:-1])
    assert np.all(settled(h, np.zeros(10), np.zeros(10), drive, np.ones(10)) == 0.0)
