"""The books of a run: what drives, control and water do to bodies is what changes their energy and momentum."""

import math
from dataclasses import replace

import numpy as np
import pytest
from pxr import Sdf

from wsim.judge.books.recorded import RecordedContacts
from wsim.judge.checks.energy import CheckEnergy
from wsim.judge.checks.fluid_books import CheckFluidMomentum
from wsim.judge.checks.fluid_push import CheckFluidPush
from wsim.judge.checks.lift import CheckLift
from wsim.judge.checks.motion import CheckFreeTurning
from wsim.judge.evidence.evidence import Evidence
from wsim.recording import read
from wsim.scene import Drive, Scene
from wsim.sim import Simulation
from wsim.sim.control import ArrayController

G = 9.81


def run(tmp_path, build, **options):
    scene = Scene()
    build(scene)
    simulation = Simulation(scene.save(tmp_path / "stage.usda"), device="cpu", **options)
    simulation.run(tmp_path / "r.rrd")
    return read(tmp_path / "r.rrd")


def test_a_motors_work_is_the_energy_that_an_arm_gains(tmp_path):
    def build(scene):
        scene.simulation(duration=0.5, frame_rate=60.0)
        arm = scene.box("arm", size=(0.6, 0.05, 0.05), density=2700.0, position=(0.3, 0.0, 1.0))
        motor = Drive(position=-60.0, stiffness=200.0, damping=2.0)
        scene.joint_revolute("hinge", None, arm, anchor=(0.0, 0.0, 1.0), axis="Y", drive=motor)

    recording = run(tmp_path, build)
    motion = Evidence(recording).motion
    energy = (motion.kinetic + motion.potential)[:, 0]
    work, unsure = (np.cumsum(recording.scalars[name]) for name in ("work/drives", "work/drives_unsure"))
    assert np.ptp(work) > 5.0  # [J]
    assert np.all(np.abs(energy - energy[0] - work) < 0.01 * np.ptp(work) + unsure)
    assert unsure[-1] < 0.2 * np.ptp(work)
    drive = recording.world.joints[0].drive
    assert drive.stiffness == pytest.approx(200.0) and drive.damping == pytest.approx(2.0)
    angle = Evidence(recording).joint(recording.world.joints[0]).position
    effort = drive.stiffness * (drive.position - angle) - drive.damping * recording.body_qd[:, 0, 4]
    assert recording.scalars["drive/hinge"][1:] == pytest.approx(effort[1:], rel=0.05, abs=2.0)


def test_a_motors_work_beside_water_is_that_of_steps_of_first_order(tmp_path):
    """A lift at 0.6 m/s: the spring's stretch at a step's start carries the weight, at its end 8 N less."""

    def build(scene):
        scene.simulation(duration=0.5, frame_rate=24.0)
        lift = scene.box("lift", size=(0.3, 0.3, 0.1), density=500.0, position=(0.0, 0.0, 1.0))
        motor = Drive(position=0.0, stiffness=20_000.0, damping=500.0)
        slide = scene.joint_prismatic("slide", None, lift, axis="Z", drive=motor)
        scene.schedule("up", slide, "position", times=(0.05, 0.45), values=(0.0, 0.24))
        scene.fluid("water", size=(0.1, 0.1, 0.1), position=(1.0, 0.0, 0.05), spacing=0.02)
        scene.ground()

    recording = run(tmp_path, build)
    motion = Evidence(recording).motion
    energy = (motion.kinetic + motion.potential)[:, 0]
    work = np.cumsum(recording.scalars["work/drives"])
    assert np.ptp(energy) > 10.0  # [J]
    assert work - work[0] == pytest.approx(energy - energy[0], abs=0.01 * np.ptp(energy))


class Push:
    """Pushes the only body."""

    def __call__(self, t, simulation):
        simulation.control_force.assign(np.array([[3.0, 0.0, 50.0, 0.0, 0.2, 0.0]], dtype=np.float32))


def test_what_a_rotor_takes_of_a_motors_work_does_not_come_to_the_bodies(tmp_path):
    """A wheel that a motor spins up: its energy is the motor's work less that of the rotor."""
    own, rotor, speed = 0.5 * 2.0 * 0.2**2, 0.1, math.radians(180.0)

    def build(scene):
        scene.simulation(duration=1.0, frame_rate=60.0)
        wheel = scene.cylinder("wheel", radius=0.2, height=0.05, mass=2.0, position=(0.0, 0.0, 1.0))
        scene.joint_revolute("axle", None, wheel, axis="Z", drive=Drive(velocity=180.0, damping=1.0))
        axle = scene.stage.GetPrimAtPath("/World/axle")
        axle.AddAppliedSchema("NewtonJointAPI")
        axle.CreateAttribute("newton:armature", Sdf.ValueTypeNames.Float, False).Set(rotor)

    recording = run(tmp_path, build)
    reached = speed * (1.0 - math.exp(-1.0 / (own + rotor)))  # of I w' = c (u - w)
    work, unsure = (np.cumsum(recording.scalars[name]) for name in ("work/drives", "work/drives_unsure"))
    assert recording.body_qd[-1, 0, 5] == pytest.approx(reached, rel=1e-3)
    assert work[-1] == pytest.approx(0.5 * own * reached**2, abs=0.01 * 0.5 * rotor * reached**2 + unsure[-1])
    assert all(finding.passed for finding in CheckEnergy().run(Evidence(recording)))


def kite(scene):
    scene.simulation(duration=0.5)
    scene.box("kite", size=(0.4, 0.4, 0.1), mass=2.0, position=(0.0, 0.0, 1.0))


def test_a_push_of_control_is_in_the_books(tmp_path):
    recording = run(tmp_path, kite, controller=Push())
    motion = Evidence(recording).motion
    time = recording.time
    assert np.cumsum(recording.applied_impulse[:, 0], axis=0) == pytest.approx(
        np.outer(time, [3.0, 0.0, 50.0]), abs=1e-4
    )
    assert np.array_equal(recording.control_impulse, recording.applied_impulse)
    assert np.cumsum(recording.applied_turn[:, 0], axis=0) == pytest.approx(np.outer(time, [0.0, 0.2, 0.0]), abs=1e-5)
    energy = (motion.kinetic + motion.potential)[:, 0]
    assert np.cumsum(recording.applied_work[:, 0]) == pytest.approx(energy - energy[0], abs=0.01 * np.ptp(energy))
    assert motion.acceleration[:, 0] == pytest.approx(np.tile([0.0, 0.0, -G], (len(time) - 1, 1)), abs=1e-2)
    assert recording.metadata["controlled"]


def test_still_water_carries_a_block_with_its_buoyancy(tmp_path):
    def build(scene):
        scene.simulation(duration=0.2, frame_rate=20.0)
        tank = scene.tank("tank", inner_size=(0.3, 0.3, 0.3))
        scene.fluid("water", fills=tank, level=0.18, spacing=0.03)
        scene.box("block", size=(0.12, 0.12, 0.09), density=600.0, position=(0.0, 0.0, 0.191))

    recording = run(tmp_path, build)
    lift = recording.applied_impulse[1:, 0, 2] * 20.0
    assert lift.mean() == pytest.approx(600.0 * 0.12 * 0.12 * 0.09 * G, rel=0.25)
    change = 600.0 * 0.12 * 0.12 * 0.09 * (recording.body_qd[-1, 0, 2] / 0.2 + G)
    assert lift.mean() == pytest.approx(change, rel=0.01)  # momentum: what it gained is what it was given
    finding = CheckFluidMomentum().run(Evidence(recording))[0]
    assert finding.passed and finding.value < 0.1 * finding.limit
    lighter = replace(recording, applied_impulse=0.99 * recording.applied_impulse)
    assert not CheckFluidMomentum().run(Evidence(lighter))[0].passed
    assert CheckLift(least=2).run(Evidence(recording))[0].passed
    # Three quarters of it gone, and said to be in the walls: 1.4 of the draft's 1.8 spacings.
    gone = 0.75 * recording.applied_impulse
    hidden = replace(recording, applied_impulse=recording.applied_impulse - gone)
    hidden = replace(hidden, wall_impulse=recording.wall_impulse + gone.sum(axis=1))
    assert CheckFluidMomentum().run(Evidence(hidden))[0].passed
    assert not CheckLift(least=2).run(Evidence(hidden))[0].passed


@pytest.mark.parametrize("shape", ["box", "sphere", "cylinder", "capsule"])
def test_what_water_gives_is_what_its_particles_give(tmp_path, shape):
    """Bodies three spacings high that bob, tilted: the books' mean is what the particles of 19 frames tell."""

    def build(scene):
        scene.simulation(duration=0.3, frame_rate=60.0)
        tank = scene.tank("tank", inner_size=(0.3, 0.3, 0.3))
        scene.fluid("water", fills=tank, level=0.18, spacing=0.03)
        size = {"box": {"size": (0.12, 0.105, 0.09)}, "sphere": {"radius": 0.055}}
        round_one = {"radius": 0.045, "height": 0.09 if shape == "cylinder" else 0.04}
        add = getattr(scene, shape)
        add("float", density=600.0, position=(0.01, 0.0, 0.185), rotation_deg=(20, 0, 10), **size.get(shape, round_one))

    recording = run(tmp_path, build)
    finding = CheckFluidPush().run(Evidence(recording))[0]
    assert finding.passed
    weight = recording.world.bodies[0].mass * G
    assert finding.limit < 0.5 * weight
    gone = 0.6 * recording.applied_impulse
    hidden = replace(recording, applied_impulse=recording.applied_impulse - gone)
    assert not CheckFluidPush().run(Evidence(hidden))[0].passed


def test_what_water_gives_a_ball_on_the_floor_is_what_its_particles_give(tmp_path):
    """Lead, four spacings across: the water in the gap has a part in its lift, and a fifth of that more is found."""

    def build(scene):
        scene.simulation(duration=0.4, frame_rate=60.0)
        tank = scene.tank("tank", inner_size=(0.36, 0.36, 0.3))
        scene.fluid("water", fills=tank, level=0.24, spacing=0.03)
        scene.sphere("ball", radius=0.06, density=11340.0, position=(0.01, 0.0, 0.06 + 1e-4))

    recording = run(tmp_path, build)
    lift = 1000.0 * G * 4.0 / 3.0 * math.pi * 0.06**3
    finding = CheckFluidPush().run(Evidence(recording))[0]
    assert finding.passed and finding.limit < 0.2 * lift
    for wrong in (0.8, 1.2):
        said = replace(recording, applied_impulse=wrong * recording.applied_impulse)
        assert not CheckFluidPush().run(Evidence(said))[0].passed
    assert not CheckFluidPush().run(Evidence(replace(recording, solids=None)))[0].passed


def test_what_nothing_drives_keeps_no_books(tmp_path):
    def build(scene):
        scene.simulation(duration=0.1)
        scene.ground()
        scene.box("box", size=(0.2, 0.2, 0.2), mass=2.0, position=(0.0, 0.0, 0.1))

    recording = run(tmp_path, build)
    assert recording.applied_impulse is None and "work/drives" not in recording.scalars


@pytest.mark.parametrize("by", ["target", "force"])
def test_the_work_of_a_steered_joint_is_in_the_books(tmp_path, by):
    """A target that jumps at each call makes the effort jump: it is the new one from the step's start on."""

    def steer(t, state):
        answer = {name: np.zeros((1, 1), dtype=np.float32) for name in ("joint_target", "joint_force")}
        if by == "target":
            answer["joint_target"][:] = 0.3 * np.sin(6.0 * t)
        else:
            answer["joint_force"][:] = 5.0 * np.cos(6.0 * t)
        return {**answer, "body_force": np.zeros((1, 1, 6), dtype=np.float32)}

    def build(scene):
        scene.simulation(duration=1.0, frame_rate=60.0)
        trolley = scene.box("trolley", size=(0.2, 0.2, 0.1), mass=2.0, position=(0.0, 0.0, 1.0))
        motor = Drive(stiffness=2000.0, damping=120.0) if by == "target" else None
        scene.joint_prismatic("rail", None, trolley, axis="X", drive=motor)

    recording = run(tmp_path, build, controller=ArrayController(steer))
    evidence = Evidence(recording)
    kinetic, work = evidence.motion.kinetic[:, 0], np.cumsum(recording.scalars["work/drives"])
    assert kinetic.max() > 0.1  # [J]
    assert work == pytest.approx(kinetic, abs=0.02 * kinetic.max())
    assert all(finding.passed for finding in CheckEnergy().run(evidence))


def test_what_control_turns_is_not_turned_by_nothing(tmp_path):
    """The torque of the kite is in the books; ten times of it is not."""
    recording = run(tmp_path, kite, controller=Push())
    told = recording.applied_turn
    assert all(finding.passed for finding in CheckFreeTurning().run(Evidence(recording)))
    wrong = replace(recording, applied_turn=10.0 * told)
    assert not all(finding.passed for finding in CheckFreeTurning().run(Evidence(wrong)))


def test_what_joints_give_under_an_effort_that_grows_is_summed_by_both_ends_of_a_step(tmp_path):
    """A double pendulum whose elbow is turned ever harder: its momenta are what is recorded, to 1e-4 of that."""

    def build(scene):
        scene.simulation(duration=0.3, frame_rate=60.0, time_step=1.0 / 400.0)
        upper, lower = (
            scene.box(name, size=(0.4, 0.04, 0.04), mass=1.0, position=(x, 0.0, 2.0))
            for name, x in (("upper", 0.2), ("lower", 0.6))
        )
        scene.joint_revolute("shoulder", None, upper, anchor=(0.0, 0.0, 2.0), axis="Y")
        scene.joint_revolute("elbow", upper, lower, anchor=(0.4, 0.0, 2.0), axis="Y")
        scene.schedule("twist", "elbow", "effort", times=(0.0, 0.3), values=(0.0, 4.5), linear=True)

    evidence = Evidence(run(tmp_path, build))
    contacts = RecordedContacts(evidence, evidence.recording.contacts)
    left = np.linalg.norm(contacts.balanced().force, axis=2)
    passed = np.linalg.norm(contacts.ties.given[0], axis=2)[1:] / evidence.motion.h[:, None]
    assert passed.max() > 20.0  # [N]
    assert left.max() < 1e-4 * passed.max()
