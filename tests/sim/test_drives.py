"""Motors at their largest effort, and where they leave it: against closed forms, alone and in batches."""

import math
from functools import partial

import numpy as np
import pytest

from tests.sim.test_bodies import Run as SteppedBy
from tests.sim.test_joints import DEVICES, Run
from wsim.scene import Drive

INERTIA = 0.5 * 1.0 * 0.1**2  # of a wheel of 1 kg [kg m^2]
H = 1.25e-3  # [s], the step of these worlds
TORQUE = 0.025  # [N m]


@pytest.fixture(params=DEVICES, ids=["alone", "batch", "cuda"])
def simulate(request, tmp_path):
    """A run of what a function builds: MuJoCo in C, and MuJoCo Warp on both devices."""
    return partial(Run, tmp_path, *request.param)


def wheel(scene, name, place, share, speed, ratio=0.0, **limits):
    """A wheel whose motor takes so many times its inertia away in a step, in mesh with one of `ratio` its inertia."""
    scene.cylinder(name, radius=0.1, height=0.05, mass=1.0, position=(0, place, 1))
    motor = Drive(velocity=math.degrees(speed), damping=share * INERTIA / H, **limits)
    scene.joint_revolute(f"axle_{name}", None, name, axis="Z", drive=motor)
    if ratio:
        scene.cylinder(f"far_{name}", radius=0.1, height=0.05, mass=ratio, position=(1, place, 1))
        scene.joint_revolute(f"far_axle_{name}", None, f"far_{name}", axis="Z")
        scene.gear(f"gear_{name}", f"axle_{name}", f"far_axle_{name}", ratio=-1.0)


@pytest.mark.parametrize("touching", [False, True])
def test_a_motor_gives_its_largest_effort_at_any_gain(simulate, touching):
    """tau t / I, where steps are of the fourth order (the first alone), and where something touches."""
    shares = (0.3, 5.0, 500.0) if touching else (0.3,)

    def build(scene):
        for k, share in enumerate(shares):
            wheel(scene, f"w{k}", k, share, 1e4, max_force=TORQUE)
        if touching:
            scene.ground()
            scene.box("brick", size=(0.1,) * 3, mass=1.0, position=(0, -1, 0.05))
            cart = scene.box("cart", size=(0.1,) * 3, mass=1.0, position=(0, -2, 1))
            scene.joint_prismatic("rail", None, cart, axis="X", drive=Drive(velocity=100, damping=1e3, max_force=2.0))

    run = simulate(build, 0.2)
    for k in range(len(shares)):
        assert run.w[f"w{k}"][-1, 2] == pytest.approx(TORQUE * 0.2 / INERTIA, rel=1e-4)
    if touching:
        assert run.v["cart"][-1, 0] == pytest.approx(2.0 * 0.2, rel=1e-4)


def test_a_motor_turns_a_heavy_wheel_by_a_gear_with_its_largest_effort(simulate):
    """37000 times its own inertia: tau t / (I + I2), in mesh."""
    ratio = 37000.0

    run = simulate(lambda scene: wheel(scene, "w", 0, 50.0, 1e4, ratio=ratio, max_force=(1.0 + ratio) * TORQUE), 0.2)
    assert run.w["w"][-1, 2] == pytest.approx(TORQUE * 0.2 / INERTIA, rel=1e-3)
    assert run.w["far_w"][-1, 2] == pytest.approx(-run.w["w"][-1, 2], rel=1e-3)


def test_a_motor_leaves_its_largest_effort_and_keeps_its_speed(simulate):
    """It reaches its speed after I w / tau, does not exceed it, and nothing rattles."""
    shares = (0.3, 5.0, 500.0)

    def build(scene):
        for k, share in enumerate(shares):
            wheel(scene, f"w{k}", k, share, 1.0, max_force=TORQUE)

    run = simulate(build, 0.4)
    for k, share in enumerate(shares):
        speed = run.w[f"w{k}"][:, 2]
        late = TORQUE / (share * INERTIA / H)  # the effort falls only from there on
        reached = run.t > INERTIA * 1.0 / TORQUE + 0.01
        assert speed.max() < 1.0 + 1e-5
        assert np.interp(0.1, run.t, speed) == pytest.approx(TORQUE * 0.1 / INERTIA, rel=1e-4)
        assert speed[reached].min() > 1.0 - 1.01 * late - 1e-5
        assert np.diff(speed).min() > -1e-5


def test_a_damped_motor_and_its_gear_turn_as_one(simulate):
    """As steps that are implicit in the speed have it, w0 (1 - (1 + c h / (I + I2))^-n), with the gear in mesh."""
    share, ratio = 50.0, 999.0

    run = simulate(lambda scene: wheel(scene, "w", 0, share, 1.0, ratio=ratio), 0.1)
    steps = np.round(run.t / H)
    theory = 1.0 - (1.0 + share / (1.0 + ratio)) ** -steps
    gives = 1e-4 * share  # of the motor's speed: the gear's row reaches all but 1e-4 of what it is asked for
    assert run.w["w"][:, 2] == pytest.approx(theory, abs=gives)
    assert run.w["far_w"][1:, 2] == pytest.approx(-run.w["w"][1:, 2], abs=gives)


def test_a_servo_comes_to_its_place_with_its_largest_effort(simulate):
    """It speeds up at tau / I, and goes no farther than its place."""
    place = 0.5

    def build(scene):
        scene.cylinder("w", radius=0.1, height=0.05, mass=1.0, position=(0, 0, 1))
        servo = Drive(position=math.degrees(place), stiffness=10.0, damping=2.0, max_force=TORQUE)
        scene.joint_revolute("axle", None, "w", axis="Z", drive=servo)

    run = simulate(build, 1.2)
    angle = 2.0 * np.arctan2(run.turn["w"][:, 2], run.turn["w"][:, 3])
    assert run.w["w"][10, 2] == pytest.approx(TORQUE * 0.1 / INERTIA, rel=1e-3)
    assert angle.max() < place + 1e-4
    assert angle[-1] == pytest.approx(place, abs=5e-3)


@pytest.mark.parametrize("time_step", [1.25e-3, 6e-4, 2e-4])
def test_a_ram_of_bounded_effort_shoves_a_crate_alike_by_all_steps(tmp_path, time_step):
    """By (F - mu m g) / (m + M), 2.063 m/s^2, once it has hit it: nothing asks for friction on the ram's face.

    Coulomb allows others. Slips known to 3e-4 m/s alone picked 0.97, 0.93 and 1.06 m/s^2 here.
    """
    effort, mu, crate, ram = 80.0, 0.5, 10.0, 5.0

    def build(scene):
        scene.ground(friction=mu)
        scene.box("ram", size=(0.2, 0.3, 0.3), mass=ram, position=(-0.3, 0, 0.25), friction=mu)
        push = Drive(velocity=2.0, damping=1e4, max_force=effort)
        scene.joint_prismatic("rail", None, "ram", axis="X", drive=push)
        scene.box("crate", size=(0.4, 0.4, 0.4), mass=crate, position=(0.0001, 0, 0.2), friction=mu)

    run = SteppedBy(tmp_path, "cpu", build, 0.2, time_step=time_step)
    late = round(0.1 / run.dt)
    gained = (run.v["crate"][-1, 0] - run.v["crate"][late, 0]) / (run.dt * (len(run.v["crate"]) - 1 - late))
    assert gained == pytest.approx((effort - mu * crate * 9.81) / (crate + ram), rel=0.03)


def test_a_target_beyond_a_stop_is_driven_to(simulate):
    """By k (target - q), x = target (1 - cos omega t) until it meets the stop, and then pressed against it."""

    def build(scene):
        scene.simulation(gravity=(0, 0, 0))
        scene.box("jaw", size=(0.1,) * 3, mass=1.0)
        scene.joint_prismatic("rail", None, "jaw", axis="X", limits=(-0.3, 0.1), drive=Drive(0.2, stiffness=100.0))

    run = simulate(build, 0.2)
    k = round(0.25 * (len(run.q["jaw"]) - 1))  # after 0.05 s
    assert run.q["jaw"][k, 0] == pytest.approx(0.2 * (1.0 - math.cos(0.5)), rel=0.03)
    assert run.q["jaw"][-1, 0] == pytest.approx(0.1, abs=1e-3)
