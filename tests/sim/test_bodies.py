"""Bodies move as they should: contact, friction, restitution, joints, starts; each against theory."""

import math
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from wsim.errors import UserError
from wsim.scene import Drive, Scene
from wsim.sim import Simulation

G = 9.81


class Run:
    """A world, stepped, with what its bodies did: `q` and `v` by name, (steps, 3) each."""

    def __init__(self, folder: Path, device: str, build, seconds: float, worlds: int = 1, time_step=None) -> None:
        scene = Scene()
        build(scene)
        self.simulation = Simulation(scene.save(folder / "stage.usda"), device, worlds, time_step)
        names = [body.prim.rsplit("/", 1)[1] for body in self.simulation.world.bodies]
        poses, twists = [], []
        while self.simulation.time < seconds - 1e-9:
            self.simulation.step()
            poses.append(self.simulation.state.body_q.numpy()[self.simulation.built.bodies])
            twists.append(self.simulation.state.body_qd.numpy()[self.simulation.built.bodies])
        assert self.simulation.problems() == []
        pose, twist = np.array(poses, dtype=np.float64), np.array(twists, dtype=np.float64)
        self.dt = self.simulation.dt
        self.q = {name: pose[:, k, :3] for k, name in enumerate(names)}
        self.turn = {name: pose[:, k, 3:] for k, name in enumerate(names)}
        self.v = {name: twist[:, k, :3] for k, name in enumerate(names)}
        self.w = {name: twist[:, k, 3:] for k, name in enumerate(names)}


@pytest.fixture(params=["cpu", pytest.param("cuda:0", marks=pytest.mark.cuda)])
def simulate(request, tmp_path):
    """A run of what a function builds, on each device."""
    return partial(Run, tmp_path, request.param)


@pytest.mark.parametrize(("worlds", "time_step"), [(1, None), (1, 2e-4), (2, None)])
def test_a_crate_slides_and_stays_down(simulate, worlds, time_step):
    """It stops after v^2 / 2 mu g, and hops by no micron."""

    def build(scene):
        scene.ground()
        scene.box("crate", size=(0.5,) * 3, density=600.0, position=(0, 0, 0.25), velocity=(2, 0, 0), friction=0.5)

    run = simulate(build, 0.6, worlds, time_step)
    height = run.q["crate"][:, 2] - 0.25
    assert height.max() < 2e-6 and height.min() > -1e-4
    assert run.q["crate"][-1, 0] == pytest.approx(
        4.0 / (2 * 0.5 * G), abs=0.6 * 2.0 * run.dt
    )  # first order in the step
    assert np.abs(run.v["crate"][-1]).max() < 1e-4


def test_a_block_hits_the_wall_on_the_floor(simulate):
    def build(scene):
        scene.ground()
        scene.box("wall", size=(0.2, 2, 1), position=(2, 0, 0.5), static=True)
        scene.box("block", size=(0.4,) * 3, density=2400.0, position=(0, 0, 0.2), velocity=(5, 0, 0), friction=0.4)

    run = simulate(build, 0.6)
    assert run.q["block"][:, 0].max() == pytest.approx(1.7, abs=1e-4)
    assert run.q["block"][:, 2].max() - 0.2 < 1e-5


@pytest.mark.parametrize(("ice", "wood"), [(0.05, 0.4), (0.4, 0.05), (None, 0.05)])
def test_the_smaller_friction_counts(simulate, ice, wood):
    angle = math.radians(20.0)

    def build(scene):
        scene.box("ramp", size=(4, 1, 0.2), rotation_deg=(0, 20, 0), static=True, friction=wood)
        at = (0.2 * math.sin(angle), 0.0, 0.2 * math.cos(angle))
        scene.box("ice", size=(0.2,) * 3, density=900.0, position=at, rotation_deg=(0, 20, 0), friction=ice)

    run = simulate(build, 0.5)
    speed = np.linalg.norm(run.v["ice"][-1])
    assert speed == pytest.approx(0.5 * G * (math.sin(angle) - 0.05 * math.cos(angle)), rel=2e-3)


@pytest.mark.parametrize("degrees", [-1.0, 1.0])
def test_a_box_holds_to_the_angle_of_friction(simulate, degrees):
    tilt = math.degrees(math.atan(0.364)) + degrees
    angle = math.radians(tilt)

    def build(scene):
        scene.box("ramp", size=(4, 1, 0.2), rotation_deg=(0, tilt, 0), static=True)
        at = (0.2 * math.sin(angle), 0.0, 0.2 * math.cos(angle))
        scene.box("box", size=(0.2,) * 3, density=600.0, position=at, rotation_deg=(0, tilt, 0), friction=0.364)

    run = simulate(build, 1.0)
    way = np.linalg.norm(run.q["box"][-1] - run.q["box"][0])
    slides = G * (math.sin(angle) - 0.364 * math.cos(angle))
    assert way == pytest.approx(0.5 * slides if degrees > 0 else 0.0, abs=1e-3)


@pytest.mark.parametrize("time_step", [5e-4, 1.25e-3, 4e-3])
@pytest.mark.parametrize(("ball", "floor", "e"), [(0.9, None, 0.9), (0.5, 0.9, 0.5), (0.3, 0.3, 0.3), (0.9, 0.0, 0.0)])
def test_a_ball_bounces_as_its_pair_has_it(simulate, ball, floor, e, time_step):
    def build(scene):
        scene.simulation(time_step=time_step, frame_rate=30.0)
        scene.ground(restitution=floor)
        scene.sphere("ball", radius=0.1, density=600.0, position=(0, 0, 0.6), restitution=ball)

    run = simulate(build, 0.95)
    height, speed = run.q["ball"][:, 2] - 0.1, run.v["ball"][:, 2]
    landed = int(np.argmax(height < 0.01))
    up = landed + int(np.argmax(speed[landed:] > 0.0)) if e > 0.0 else landed + 20
    rise = height[up : up + 1 + int(np.argmax(np.diff(height[up:]) < 0.0))].max() if e > 0.0 else height[up:].max()
    assert rise == pytest.approx(0.5 * e**2, rel=2e-3, abs=1e-3 if e == 0.0 else 0.0)


def test_a_ball_bounces_in_batched_worlds(simulate):
    def build(scene):
        scene.ground()
        scene.sphere("ball", radius=0.1, density=600.0, position=(0, 0, 0.3), restitution=0.8)

    run = simulate(build, 0.3, worlds=2)
    speed = run.v["ball"][:, 2]
    met = int(np.argmax(speed > 0.0))
    assert speed[met] / -speed[met - 1] == pytest.approx(0.8, rel=0.01)


@pytest.mark.parametrize("worlds", [1, 2])
def test_a_log_in_a_groove_is_rubbed_on_both_sides(simulate, worlds):
    """It slows at sqrt(2) mu g in a groove of 90 degrees, in single precision as well: no search ends too early."""

    def build(scene):
        for name, side in (("left", 1.0), ("right", -1.0)):
            middle = (0, side * 0.6 / math.sqrt(2.0), 0.4 / math.sqrt(2.0))
            scene.box(name, size=(6, 1, 0.2), position=middle, rotation_deg=(side * 45, 0, 0), static=True)
        scene.cylinder("log", radius=0.05, height=0.4, axis="X", mass=2.0, position=(-1, 0, 0.05 * math.sqrt(2.0)),
                       velocity=(2, 0, 0), friction=0.3)  # fmt: skip

    speed = simulate(build, 0.1, worlds).v["log"][:, 0]
    assert (2.0 - speed[-1]) / 0.1 == pytest.approx(math.sqrt(2.0) * 0.3 * G, rel=1e-3)


def test_a_slipping_ball_comes_to_roll(simulate):
    def build(scene):
        scene.ground()
        scene.sphere("ball", radius=0.2, density=600.0, position=(0, 0, 0.2), velocity=(3, 0, 0), friction=0.4)

    run = simulate(build, 0.8)
    assert run.v["ball"][-1, 0] == pytest.approx(3 * 5 / 7, rel=1e-3)
    assert run.w["ball"][-1, 1] == pytest.approx(3 * 5 / 7 / 0.2, rel=1e-3)
    assert run.q["ball"][:, 2].max() - 0.2 < 1e-5


def test_what_nothing_rubs_keeps_its_speed(simulate):
    def build(scene):
        scene.ground(friction=0.0)
        scene.box("box", size=(0.3,) * 3, density=600.0, position=(0, 0, 0.15), velocity=(2, 0, 0), friction=0.0)

    run = simulate(build, 1.0)
    assert run.v["box"][:, 0].min() > 2.0 - 2e-4 and run.v["box"][:, 0].max() <= 2.0


def test_a_cradle_keeps_its_energy(simulate):
    def build(scene):
        for i in range(5):
            x = 0.2 * i
            at = (x, 0.0, 1.0) if i else (-math.sin(0.5), 0.0, 2.0 - math.cos(0.5))
            scene.sphere(f"ball_{i}", radius=0.1, density=7800.0, position=at, restitution=1.0, friction=0.0)
            scene.joint_revolute(f"hinge_{i}", None, f"ball_{i}", anchor=(x, 0.0, 2.0), axis="Y")

    run = simulate(build, 2.0)
    last = run.q["ball_4"]
    assert last[:, 2].max() - 1.0 == pytest.approx(1.0 - math.cos(0.5), rel=0.01)
    assert max(np.abs(run.q[f"ball_{k}"][: len(last) // 3, 0] - 0.2 * k).max() for k in (1, 2, 3)) < 0.02


def test_a_door_stops_at_its_stop(simulate):
    def build(scene):
        scene.simulation(gravity=(0, 0, 0))
        door = scene.box("door", size=(0.8, 0.05, 2.0), density=600.0, position=(0.4, 0, 1.5), restitution=0.5)
        scene.joint_revolute("hinge", None, door, anchor=(0, 0, 1.5), axis="Z", limits_deg=(-90, 0))
        scene.sphere("ball", radius=0.1, density=600.0, position=(0.6, 1.0, 1.5), velocity=(0, -8, 0), restitution=0.5)

    run = simulate(build, 1.5)
    turned = 2 * np.degrees(np.arctan2(run.turn["door"][:, 2], run.turn["door"][:, 3]))
    assert turned.min() == pytest.approx(-90.0, abs=0.05) and turned.max() < 0.01
    assert np.abs(run.w["door"][-1]).max() < 1e-3


def test_half_cylinders_on_a_hinge_lie_still(simulate):
    def build(scene):
        for k, x in enumerate((-0.4, 0.4)):
            scene.box(f"stone_{k}", size=(0.2, 0.6, 0.2), position=(x, 0, 0.1), static=True)
            scene.cylinder(f"half_{k}", radius=0.1, height=0.6, axis="X", density=600.0, position=(0.75 * x, 0, 0.3))
        scene.joint_revolute("hinge", "half_0", "half_1", anchor=(0, 0, 0.3), axis="Y")

    run = simulate(build, 2.4)
    assert max(np.abs(run.q[name] - run.q[name][0]).max() for name in run.q) < 1e-4


def test_a_barrel_on_a_pallet_comes_to_rest(simulate):
    """Its rim rubs: it stops after omega R / (2 mu g)."""

    def build(scene):
        scene.ground()
        scene.box("pallet", size=(1.2, 1.0, 0.15), density=400.0, position=(0, 0, 0.075))
        scene.cylinder(
            "barrel", radius=0.3, height=0.9, density=500.0, position=(0, 0, 0.6), angular_velocity_deg=(0, 0, 115)
        )

    run = simulate(build, 0.2)
    spin = np.abs(run.w["barrel"][:, 2])
    assert run.dt * np.argmax(spin < 1e-3) == pytest.approx(math.radians(115) * 0.3 / (2 * 0.5 * G), abs=0.005)
    assert spin[-1] < 1e-6 and run.q["barrel"][:, 2].max() - 0.6 < 1e-5


def test_jointed_bodies_start_as_stated(simulate):
    def build(scene):
        scene.simulation(gravity=(0, 0, 0))
        wheel = scene.cylinder(
            "wheel", radius=0.3, height=0.1, axis="Y", position=(0, 0, 1), angular_velocity_deg=(0, math.degrees(10), 0)
        )
        scene.joint_revolute("axle", None, wheel, axis="Y")
        top = scene.cylinder(
            "top", radius=0.1, height=0.02, position=(2, 0, 1), angular_velocity_deg=(0, 0, math.degrees(200))
        )
        scene.joint_spherical("ball", None, top, anchor=(2, 0, 0.9))
        cart = scene.box("cart", size=(0.1,) * 3, position=(4, 0, 1), velocity=(1, 0, 0))
        scene.joint_prismatic("rail", None, cart, axis="X")
        bob = scene.sphere("bob", radius=0.1, position=(6, 0, 1), velocity=(2, 0, 0))
        scene.joint_revolute("hook", None, bob, anchor=(6, 0, 2), axis="Y")
        scene.sphere("loose", radius=0.1, position=(8, 0, 1), velocity=(0, 1, 0))

    run = simulate(build, 0.3)
    assert run.w["wheel"][[0, -1], 1] == pytest.approx(10.0, rel=1e-4)
    assert run.w["top"][[0, -1], 2] == pytest.approx(200.0, rel=1e-4)
    assert run.v["cart"][[0, -1], 0] == pytest.approx(1.0, rel=1e-4)
    assert run.q["cart"][-1, 0] == pytest.approx(4.0 + run.simulation.time, abs=1e-3)
    assert run.w["bob"][[0, -1], 1] == pytest.approx(-2.0, rel=1e-3)  # its spin follows from its velocity
    assert run.v["loose"][-1] == pytest.approx((0, 1, 0), abs=1e-5)


def test_a_start_that_the_joints_forbid_is_refused(simulate):
    def build(scene):
        cart = scene.box("cart", size=(0.1,) * 3, position=(0, 0, 1), velocity=(0, 1, 0))
        scene.joint_prismatic("rail", None, cart, axis="X")

    with pytest.raises(UserError, match=r"/World/cart: its joints do not let it start with the velocity \(0.0, 1.0, 0"):
        simulate(build, 0.01)


@pytest.mark.parametrize("welds", [1, 2])
def test_a_start_of_a_world_of_welds_alone_is_refused(simulate, welds):
    def build(scene):
        held = None
        for k in range(welds):
            body = scene.box(f"b{k}", size=(0.1,) * 3, position=(0, 0, 1 + k), velocity=(float(k + 1 == welds), 0, 0))
            scene.joint_fixed(f"weld{k}", held, body)
            held = body

    with pytest.raises(UserError, match=rf"/World/b{welds - 1}: its joints do not let it start with the velocity"):
        simulate(build, 0.01)


def test_a_seed_turns_a_hinge(tmp_path):
    scene = Scene()
    bob = scene.sphere("bob", radius=0.1, position=(0, 0, 1))
    scene.joint_revolute("hook", None, bob, anchor=(0, 0, 2), axis="Y")
    stage = scene.save(tmp_path / "stage.usda")
    assert Simulation(stage, "cpu", seeds=[3]).state.joint_q.numpy()[0] != 0.0


def test_a_belt_moves_and_carries(simulate):
    def build(scene):
        scene.box("belt", size=(4, 0.5, 0.1), position=(0, 0, 0.5), kinematic=True, velocity=(1, 0, 0))
        scene.box("crate", size=(0.2,) * 3, density=600.0, position=(0, 0, 0.65), friction=0.5)

    run = simulate(build, 0.5)
    assert run.q["belt"][-1, 0] == pytest.approx(run.simulation.time, rel=1e-4)
    assert run.v["crate"][-1, 0] == pytest.approx(1.0, rel=1e-3)
    assert run.q["crate"][-1, 0] == pytest.approx(run.simulation.time - 1.0 / (2 * 0.5 * G), abs=2e-3)


def test_a_plough_pushes_and_a_turntable_turns(simulate):
    def build(scene):
        scene.ground(friction=0.5)
        scene.box("plough", size=(0.1, 1, 0.3), position=(-0.5, 0, 0.2), kinematic=True, velocity=(0.5, 0, 0))
        scene.box("box", size=(0.2,) * 3, density=600.0, position=(0, 0, 0.1))
        scene.cylinder(
            "table", radius=0.5, height=0.1, position=(3, 0, 0.5), kinematic=True, angular_velocity_deg=(0, 0, 90)
        )
        scene.box("load", size=(0.1,) * 3, density=600.0, position=(3.2, 0, 0.6))

    run = simulate(build, 1.0)
    assert run.v["box"][-1, 0] == pytest.approx(0.5, abs=1e-3)
    load = run.q["load"][-1] - (3, 0, 0.6)
    lag = 2.946  # [deg], by integration of Coulomb's friction on its four corners until it goes with the table
    assert math.degrees(math.atan2(load[1], load[0])) == pytest.approx(90.0 * run.simulation.time - lag, abs=0.1)
    assert np.linalg.norm(load[:2]) == pytest.approx(0.2, abs=0.01)


@pytest.mark.parametrize(("stiffness", "damping"), [(400.0, 1.0), (4000.0, 10.0), (4.0, 100.0)])
def test_a_stiff_drive_on_a_light_body_is_stable(simulate, stiffness, damping):
    def build(scene):
        arm = scene.box("arm", size=(0.05,) * 3, mass=0.05, position=(0.05, 0, 1))
        motor = Drive(position=20.0, stiffness=stiffness, damping=damping)
        scene.joint_revolute("hinge", None, arm, anchor=(0, 0, 1), axis="Y", drive=motor)

    run = simulate(build, 0.1)
    assert np.degrees(2 * np.arctan2(run.turn["arm"][:, 1], run.turn["arm"][:, 3])).max() < 21.0


def test_a_drive_too_stiff_for_any_step_is_refused(simulate):
    def build(scene):
        arm = scene.box("arm", size=(0.05,) * 3, mass=0.05, position=(0.05, 0, 1))
        motor = Drive(stiffness=1e6, damping=1.0)
        scene.joint_revolute("hinge", None, arm, anchor=(0, 0, 1), axis="Y", drive=motor)

    with pytest.raises(UserError, match=r"/World/hinge: drive.stiffness = 1e\+06 N m/rad .* give at most 9.1e\+04"):
        simulate(build, 0.01)


def test_a_given_time_step_is_a_bound(simulate):
    def build(scene):
        scene.simulation(time_step=0.02)
        scene.ground()
        scene.box("crate", size=(0.5,) * 3, position=(0, 0, 0.25))

    assert simulate(build, 0.01).dt <= 1 / 800


def test_a_stack_stands(simulate):
    def build(scene):
        scene.ground()
        for k in range(10):
            scene.box(f"box_{k}", size=(0.2,) * 3, density=600.0, position=(0, 0, 0.1 + 0.2 * k))

    run = simulate(build, 1.0)
    assert max(np.abs(run.q[name][-1] - run.q[name][0]).max() for name in run.q) < 1e-5


def test_a_seesaw_on_its_stone_does_not_explode(simulate):
    """Hinged at its centre of mass it yields to no push there: its contacts must not be hard without bound."""

    def build(scene):
        scene.ground()
        scene.box("base", size=(0.06, 0.3, 0.295), position=(0, 0, 0.1475), static=True, friction=0.4)
        scene.box("board", size=(2.0, 0.3, 0.04), density=600.0, position=(0, 0, 0.32), friction=0.4, restitution=0.1)
        scene.box("box", size=(0.2,) * 3, density=600.0, position=(0.8, 0, 0.74), friction=0.4, restitution=0.1)
        scene.joint_revolute("pivot", None, "board", axis="Y")

    run = simulate(build, 2.2)
    assert np.abs(run.v["box"][-100:]).max() < 0.01


@pytest.mark.parametrize("e", [0.1, 0.6])
def test_a_stack_that_bounces_comes_to_rest(simulate, e):
    def build(scene):
        scene.ground()
        for k in range(5):
            scene.box(f"box_{k}", size=(0.2,) * 3, density=600.0, position=(0, 0, 0.101 + 0.201 * k), restitution=e)

    run = simulate(build, 2.0)
    assert [run.q[f"box_{k}"][-1, 2] for k in range(5)] == pytest.approx([0.1 + 0.2 * k for k in range(5)], abs=1e-4)
    assert max(np.abs(run.v[name][-1]).max() for name in run.v) < 1e-3


def test_a_body_hinged_to_a_static_one_does_not_touch_it(simulate):
    def build(scene):
        post = scene.box("post", size=(0.1, 0.1, 2.0), position=(0, 0, 1), static=True)
        bob = scene.box("bob", size=(0.05, 0.05, 1.0), density=600.0, position=(0.5, 0, 1.5), rotation_deg=(0, 90, 0))
        scene.joint_revolute("hinge", post, bob, anchor=(0, 0, 1.5), axis="Y")

    run = simulate(build, 1.0)
    assert run.q["bob"][:, 2].min() == pytest.approx(1.0, abs=2e-3)  # it swings through the post
    assert run.q["bob"][:, 0].min() < -0.3


def test_a_heavy_belt_does_not_shake_its_load(simulate):
    def build(scene):
        scene.ground()
        scene.box("belt", size=(8, 1, 0.2), position=(0, 0, 0.1), kinematic=True, velocity=(1, 0, 0))
        scene.box("crate", size=(0.3,) * 3, density=300.0, position=(0, 0, 0.35), velocity=(1, 0, 0))

    run = simulate(build, 1.0)
    assert np.abs(run.v["crate"] - (1, 0, 0)).max() < 5e-4


@pytest.mark.parametrize("beside", [False, True])
@pytest.mark.parametrize("worlds", [1, 2])
def test_a_mechanism_above_the_ground_keeps_its_energy(simulate, worlds, beside):
    """A rod that swings by 90 degrees each way over a floor that it could touch and does not: steps of fourth order,
    also while a crate rests beside it."""

    def build(scene):
        scene.ground()
        if beside:
            scene.box("crate", size=(0.3,) * 3, density=300.0, position=(3, 0, 0.15))
        rod = scene.box("rod", size=(0.5, 0.02, 0.02), density=1000.0, position=(0.25, 0, 1))
        tip = scene.box("tip", size=(0.3, 0.02, 0.02), density=1000.0, position=(0.65, 0, 1))
        scene.joint_revolute("pivot", None, rod, anchor=(0, 0, 1), axis="Y")
        scene.joint_revolute("elbow", rod, tip, anchor=(0.5, 0, 1), axis="Y", limits_deg=(-170, 170))

    run = simulate(build, 0.6, worlds)
    energy = 0.0
    for name, length, share in (("rod", 0.5, 0.625), ("tip", 0.3, 0.375)):
        inertia = (length**2 + 0.02**2) / 12.0
        speed, spin = np.linalg.norm(run.v[name], axis=1), run.w[name][:, 1]
        energy = energy + share * (0.5 * speed**2 + 0.5 * inertia * spin**2 + G * (run.q[name][:, 2] - 1.0))
    assert np.abs(run.q["tip"][:, 2] - 1.0).max() > 0.5
    assert np.abs(energy).max() < 2e-5 * G * 0.5
