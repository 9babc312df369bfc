"""Joints that rub, are geared, break, close loops and hold at their stops: against theory, alone and in batches."""

import math
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, Usd
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicHermiteSpline

from wsim.geometry.rotations import rotate
from wsim.scene import Drive, Scene
from wsim.scene.describe import describe
from wsim.sim import Simulation
from wsim.sim.collect import collect

G = 9.81
RATE = 100.0  # [Hz]


class Run:
    """A world by frames: `q`, `v` and `w` by name, (frames, 3) each."""

    def __init__(self, folder: Path, device: str, worlds: int, build, seconds: float) -> None:
        scene = Scene()
        scene.simulation(frame_rate=RATE)
        build(scene)
        self.simulation = Simulation(scene.save(folder / "stage.usda"), device, worlds)
        names = [body.prim.rsplit("/", 1)[1] for body in self.simulation.world.bodies]
        states = [self._state()]
        for _ in range(round(seconds * RATE)):
            self.simulation.advance_frame()
            states.append(self._state())
        assert self.simulation.problems() == []
        all_states = np.array(states, dtype=np.float64)
        self.t = np.arange(len(states)) / RATE
        parts = {name: all_states[:, k] for k, name in enumerate(names)}
        self.q, self.turn, self.v, self.w = (
            {name: part[:, start:end] for name, part in parts.items()}
            for start, end in ((0, 3), (3, 7), (7, 10), (10, 13))
        )

    def _state(self):
        state, bodies = self.simulation.state, self.simulation.built.bodies
        return np.concatenate([state.body_q.numpy()[bodies], state.body_qd.numpy()[bodies]], axis=1)


DEVICES = [("cpu", 1), ("cpu", 2), pytest.param(("cuda:0", 2), marks=pytest.mark.cuda)]


@pytest.fixture(params=DEVICES, ids=["alone", "batch", "cuda"])
def simulate(request, tmp_path):
    """A run of what a function builds: MuJoCo in C, and MuJoCo Warp on both devices."""
    return partial(Run, tmp_path, *request.param)


# ---- dry friction
def test_friction_stops_a_flywheel_and_holds_it(simulate):
    """After I w / tau, exactly; below its limit it holds."""
    inertia, spin, torque = 0.5 * 10.0 * 0.2**2, 10.0, 4.0

    def build(scene):
        wheel = scene.cylinder(
            "wheel", radius=0.2, height=0.05, mass=10.0, angular_velocity_deg=(0, 0, math.degrees(spin)),
            position=(0, 0, 1),
        )  # fmt: skip
        scene.joint_revolute("axle", None, wheel, axis="Z", friction=torque)
        arm = scene.box("arm", size=(0.4, 0.02, 0.02), mass=1.0, position=(0.2, 1, 1))
        scene.joint_revolute("held", None, arm, anchor=(0, 1, 1), axis="Y", friction=1.01 * 1.0 * G * 0.2)
        cart = scene.box("cart", size=(0.1, 0.1, 0.1), mass=2.0, position=(0, 2, 1), velocity=(1.0, 0, 0))
        scene.joint_prismatic("rail", None, cart, axis="X", friction=5.0)

    run = simulate(build, 0.8)
    turned = np.interp(0.3, run.t, run.w["wheel"][:, 2])
    assert turned == pytest.approx(spin - torque * 0.3 / inertia, rel=1e-3)
    assert np.abs(run.w["wheel"][run.t > inertia * spin / torque + 0.01]).max() < 1e-6
    assert run.q["cart"][-1, 0] == pytest.approx(2.0 * 1.0 / (2 * 5.0), rel=5e-3)
    assert np.abs(run.v["cart"][-1]).max() < 1e-6
    assert abs(run.q["arm"][-1, 2] - 1.0) < 1e-5


# ---- gears
def test_gears_reduce_inertia_and_keep_their_ratio(simulate):
    """Under a torque on the first of three wheels and a rack: tau / (I1 + n2^2 I2 + ...)."""
    radii, torque = (0.1, 0.2, 0.15), 1.0
    mass = [20.0 * r for r in radii]

    def build(scene):
        x = 0.0
        for k, r in enumerate(radii):
            x += r + radii[k - 1] if k else 0.0
            wheel = scene.cylinder(f"w{k}", radius=r, height=0.05, mass=mass[k], position=(x, 0, 1))
            motor = Drive(velocity=1e5, damping=1e-3, max_force=torque) if k == 0 else None
            scene.joint_revolute(f"j{k}", None, wheel, axis="Z", drive=motor)
        rack = scene.box("rack", size=(0.1, 0.05, 0.05), mass=3.0, position=(x + 0.1, radii[2] + 0.025, 1))
        scene.joint_prismatic("rail", None, rack, axis="X")
        scene.gear("g1", "j1", "j2", ratio=-radii[1] / radii[2])
        scene.gear("g0", "j0", "j1", ratio=-radii[0] / radii[1])
        scene.gear("pinion", "j2", "rail", ratio=-radii[2])

    run = simulate(build, 0.3)
    inertia = sum(0.5 * m * radii[0] ** 2 for m in mass) + 3.0 * radii[0] ** 2
    spin = torque * 0.3 / inertia
    for k, r in enumerate(radii):
        assert run.w[f"w{k}"][-1, 2] == pytest.approx((-1) ** k * spin * radii[0] / r, rel=2e-3)
    assert run.v["rack"][-1, 0] == pytest.approx(-spin * radii[0], rel=2e-3)
    assert run.v["rack"][-1, 0] == pytest.approx(-radii[2] * run.w["w2"][-1, 2], rel=1e-4)


def two_wheels(scene, **follower):
    """Two that mesh, 1 : 2, of one moment of inertia as the first feels it; it starts with 2 rad/s."""
    scene.simulation(gravity=(0, 0, 0))
    spins = math.degrees(2.0), -math.degrees(1.0)
    for k, (radius, mass) in enumerate(((0.1, 2.0), (0.2, 2.0))):
        scene.cylinder(
            f"wheel{k}", radius=radius, height=0.05, axis="Y", mass=mass, position=(0.5 * k, 0, 1),
            angular_velocity_deg=(0, spins[k], 0),
        )  # fmt: skip
    scene.joint_revolute("leader", None, "wheel0", axis="Y")
    scene.joint_revolute("follower", None, "wheel1", axis="Y", **follower)
    scene.gear("mesh", "leader", "follower", ratio=-0.5)


def test_a_stop_of_one_wheel_stops_what_meshes_with_it(simulate):
    """At twice the angle, and both stay there."""
    run = simulate(partial(two_wheels, limits_deg=(-10.0, 0.0)), 0.3)
    for name, end in (("wheel0", 20.0), ("wheel1", -10.0)):
        turned = np.degrees(2.0 * np.arctan2(run.turn[name][-5:, 1], run.turn[name][-5:, 3]))
        assert turned == pytest.approx(end, abs=0.01)
        assert np.abs(run.w[name][-5:]).max() < 1e-3


def test_friction_of_one_wheel_slows_what_meshes_with_it(simulate):
    """I0 + I1 / 4 = 0.02 kg m^2 as the first feels it, and half of 0.04 N m."""
    run = simulate(partial(two_wheels, friction=0.04), 0.5)
    slowed = 2.0 - 0.02 / 0.02 * run.t
    assert run.w["wheel0"][:, 1] == pytest.approx(slowed, abs=2e-3)
    assert run.w["wheel1"][:, 1] == pytest.approx(-0.5 * slowed, abs=2e-3)


@pytest.mark.parametrize("named", ["pinion first", "rack first"])
def test_a_rack_hangs_on_the_friction_of_its_pinion(simulate, named):
    """Of 5 mm and 10 g, which 0.06 N m hold against 0.049: gears named either way are as hard as all else."""

    def build(scene):
        scene.cylinder("pinion", radius=0.005, height=0.01, axis="Y", mass=0.01, position=(0, 0, 2))
        scene.box("rack", size=(0.1,) * 3, mass=1.0, position=(0.3, 0, 2))
        scene.joint_revolute("axle", None, "pinion", axis="Y", friction=0.06)
        scene.joint_prismatic("rail", None, "rack", axis="Z")
        pair, ratio = (("axle", "rail"), 0.005) if named == "pinion first" else (("rail", "axle"), 200.0)
        scene.gear("mesh", *pair, ratio=ratio)

    run = simulate(build, 0.2)
    assert run.q["rack"][:, 2] == pytest.approx(2.0, abs=5e-5)


# ---- joints that break
LOADS = {
    "pulled fixed": ("joint_fixed", (0, 0, 2), {"break_force": 2.0 * G}),
    "pulled ball": ("joint_spherical", (0, 0, 2), {"break_force": 2.0 * G}),
    "pulled hinge": ("joint_revolute", (0, 0, 2), {"break_force": 2.0 * G}),
    "bent fixed": ("joint_fixed", (-0.5, 0, 2), {"break_torque": 2.0 * G * 0.5}),
    "bent hinge": ("joint_revolute", (-0.5, 0, 2), {"break_torque": 2.0 * G * 0.5}),
}


def test_joints_break_at_their_strength(simulate):
    """One that bears 1.01 times the load holds, one that bears 0.99 of it breaks, and what it held falls."""

    def build(scene):
        for k, (name, (kind, anchor, strength)) in enumerate(LOADS.items()):
            for j, share in enumerate((0.99, 1.01)):
                y = 2.0 * k + j
                box = scene.box(f"{name}_{j}".replace(" ", "_"), size=(0.1,) * 3, mass=2.0, position=(0, y, 2))
                most = {key: share * value for key, value in strength.items()}
                getattr(scene, kind)(f"joint_{k}_{j}", None, box, anchor=(anchor[0], y, 2), **most)

    run = simulate(build, 0.2)
    for name in LOADS:
        weak, strong = (run.q[f"{name}_{j}".replace(" ", "_")][-1, 2] for j in (0, 1))
        # Where a box hangs by its side, its turning inertia is a hundredth of what the joint bears: it takes some steps
        # of 1 % each until the joint bears it all.
        late = 0.01 if name.startswith("pulled") else 0.1
        assert 0.0 < weak - (2.0 - G * 0.2**2 / 2) + 2e-3 < late, name
        assert strong == pytest.approx(2.0, abs=5e-5), name


def test_what_slides_on_a_carriage_breaks_across_its_rail(simulate):
    """A slider cannot break; what is fixed to one that bears 0.99 of its weight falls as it slides, 1.01 holds it."""
    speed, seconds = 0.5, 0.2

    def build(scene):
        for k, share in enumerate((0.99, 1.01)):
            at = {"position": (0, k, 2), "velocity": (speed, 0, 0)}
            carriage = scene.box(f"carriage{k}", size=(0.1,) * 3, mass=0.2, **at)
            load = scene.box(f"load{k}", size=(0.1,) * 3, mass=2.0, **(at | {"position": (0, k, 1.8)}))
            scene.joint_prismatic(f"rail{k}", None, carriage, axis="X")
            scene.joint_fixed(f"latch{k}", carriage, load, break_force=share * 2.0 * G)

    run = simulate(build, seconds)
    weak, strong = (run.q[f"load{k}"][-1] for k in (0, 1))
    assert 0.0 < weak[2] - (1.8 - G * seconds**2 / 2) + 2e-3 < 0.025
    assert strong[2] == pytest.approx(1.8, abs=5e-5)
    for k in (0, 1):
        assert run.q[f"carriage{k}"][-1] == pytest.approx((speed * seconds, k, 2), abs=1e-4)
        assert run.q[f"load{k}"][-1, 0] == pytest.approx(speed * seconds, abs=1e-4)


@pytest.mark.parametrize("device", ["cpu", pytest.param("cuda:0", marks=pytest.mark.cuda)])
def test_each_world_breaks_by_itself(tmp_path, device):
    """Of two worlds the one whose bob is jerked down breaks, and the collected worlds say so."""
    scene = Scene()
    scene.simulation(duration=0.2, frame_rate=RATE)
    bob = scene.sphere("bob", radius=0.05, mass=1.0, position=(0, 0, 1))
    scene.joint_spherical("pin", None, bob, anchor=(0, 0, 2), break_force=1.1 * G)
    simulation = Simulation(scene.save(tmp_path / "stage.usda"), device, 2)
    speeds = simulation.state.joint_qd.numpy()
    speeds[6 + 2] = -0.05
    simulation.state.joint_qd.assign(speeds)
    found = collect(simulation)
    broken = found.scalars["broken/pin"]
    assert not broken[0].any() and broken[1, 1:].all()
    assert found.scalars["force/pin"][0].max() == pytest.approx(G, rel=1e-3)
    assert found.body_q[0, -1, 0, 2] == pytest.approx(1.0, abs=1e-5)
    assert found.recording(1).scalars["broken/pin"].shape == (21,)


def test_a_joint_that_breaks_passes_on_no_blow(simulate):
    """A brittle joint takes nothing from what tears it off in a step."""

    def build(scene):
        scene.simulation(gravity=(0, 0, 0))
        held = scene.box("held", size=(0.2,) * 3, mass=1.0, position=(0, 0, 1))
        scene.joint_fixed("glue", None, held, break_force=50.0)
        scene.sphere("ball", radius=0.1, mass=1.0, position=(-0.5, 0, 1), velocity=(3.0, 0, 0), restitution=1.0)

    run = simulate(build, 0.4)
    assert run.v["held"][-1, 0] == pytest.approx(3.0, rel=2e-3)
    assert abs(run.v["ball"][-1, 0]) < 5e-3


def test_a_chain_breaks_at_its_weakest_link(simulate):
    """A blow that is too much for each of three links breaks one, which relieves the others."""

    def build(scene):
        above = None
        for k, most in enumerate((500.0, 50.0, 500.0)):
            link = scene.box(f"link{k}", size=(0.02, 0.02, 0.1), mass=0.1, position=(0, 0, 1.95 - 0.1 * k))
            scene.joint_spherical(f"pin{k}", above, link, anchor=(0, 0, 2 - 0.1 * k), break_force=most)
            above = link
        pan = scene.box("pan", size=(0.3, 0.3, 0.02), mass=1.0, position=(0, 0, 1.69))
        scene.joint_fixed("hook", above, pan, anchor=(0, 0, 1.7))
        scene.sphere("ball", radius=0.05, mass=1.0, position=(0.08, 0, 1.78), velocity=(0, 0, -2.0))

    run = simulate(build, 0.2)
    broken = run.simulation.rigid.breakage()
    assert [bool(broken[f"broken/pin{k}"][0]) for k in range(3)] == [False, True, False]
    assert run.q["link0"][-1, 2] == pytest.approx(1.95, abs=1e-3)


# ---- loops
R, L = 0.1, 0.4  # crank and rod [m]


def crank_slider(scene, order, crank=None, **slider):
    """Joints in any order; `crank` is its drive."""
    bodies = {
        "crank": scene.box("crank", size=(R, 0.02, 0.02), mass=0.2, position=(R / 2, 0, 1)),
        "rod": scene.box("rod", size=(L, 0.02, 0.02), mass=0.2, position=(R + L / 2, 0.05, 1)),
        "piston": scene.box("piston", size=(0.1,) * 3, mass=0.5, position=(R + L, 0.2, 1)),
    }
    calls = {
        "axle": lambda: scene.joint_revolute("axle", None, bodies["crank"], anchor=(0, 0, 1), axis="Y", drive=crank),
        "pin": lambda: scene.joint_revolute("pin", bodies["crank"], bodies["rod"], anchor=(R, 0, 1), axis="Y"),
        "wrist": lambda: scene.joint_revolute("wrist", bodies["rod"], bodies["piston"], anchor=(R + L, 0, 1), axis="Y"),
        "rail": lambda: scene.joint_prismatic("rail", None, bodies["piston"], axis="X", **slider),
    }
    for name in order:
        calls[name]()


ORDERS = (("axle", "pin", "wrist", "rail"), ("rail", "axle", "wrist", "pin"), ("wrist", "pin", "rail", "axle"))


@pytest.mark.parametrize("order", ORDERS, ids=" ".join)
def test_a_loop_of_a_slider_and_a_driven_crank_in_any_order(simulate, order):
    """The piston is where r cos a + sqrt(l^2 - r^2 sin^2 a) says, though both need a coordinate."""
    run = simulate(lambda scene: crank_slider(scene, order, Drive(velocity=360.0, damping=5.0), friction=2.0), 0.8)
    turn = run.turn["crank"]
    angle = 2.0 * np.arctan2(turn[:, 1], turn[:, 3])
    reach = R * np.cos(angle) + np.sqrt(L**2 - (R * np.sin(angle)) ** 2)
    assert np.abs(run.q["piston"][:, 0] - reach).max() < 3e-4  # the motor starts with a jerk
    assert np.ptp(np.unwrap(angle)) > 4.0


def test_legs_lift_a_platform(simulate):
    """Three legs of a hinge, a driven slider and a ball each close loops between the platform and the world."""
    base, top, height, lift = 0.5, 0.3, 0.6, 0.1

    def build(scene):
        platform = scene.cylinder("platform", radius=0.35, height=0.05, mass=1.0, position=(0, 0, height))
        for k in range(3):
            out = np.array([math.cos(2.1 * k), math.sin(2.1 * k), 0.0])
            foot, head = base * out, top * out + [0, 0, height]
            way = (head - foot) / np.linalg.norm(head - foot)
            parts = [
                scene.sphere(f"{name}{k}", radius=0.03, mass=0.1, position=tuple(foot + share * (head - foot)))
                for name, share in (("lower", 0.3), ("upper", 0.7))
            ]
            scene.joint_revolute(f"hinge{k}", None, parts[0], anchor=tuple(foot), axis=(-out[1], out[0], 0.0))
            motor = Drive(position=lift, stiffness=2000.0, damping=100.0)
            scene.joint_prismatic(f"ram{k}", parts[0], parts[1], axis=tuple(way), drive=motor)
            scene.joint_spherical(f"ball{k}", parts[1], platform, anchor=tuple(head))

    run = simulate(build, 1.0)
    length = math.hypot(height, base - top) + lift
    assert run.q["platform"][-1, 2] == pytest.approx(math.sqrt(length**2 - (base - top) ** 2), abs=4e-3)
    assert np.abs(run.q["platform"][:, :2]).max() < 5e-3


def test_a_kinematic_crank_drives_a_loop(simulate):
    def build(scene):
        crank = scene.box(
            "crank", size=(R, 0.02, 0.02), position=(0, 0, 1), kinematic=True, angular_velocity_deg=(0, 180, 0)
        )
        rod = scene.box("rod", size=(L, 0.02, 0.02), mass=0.2, position=(R + L / 2, 0.05, 1))
        piston = scene.box("piston", size=(0.1,) * 3, mass=0.5, position=(R + L, 0.2, 1))
        scene.joint_prismatic("rail", None, piston, axis="X")
        scene.joint_revolute("wrist", rod, piston, anchor=(R + L, 0, 1), axis="Y")
        scene.joint_revolute("pin", rod, crank, anchor=(R, 0, 1), axis="Y")

    run = simulate(build, 1.0)
    angle = math.pi * run.t
    reach = R * np.cos(angle) + np.sqrt(L**2 - (R * np.sin(angle)) ** 2)
    assert np.abs(run.q["piston"][:, 0] - reach).max() < 1e-3


@pytest.mark.parametrize("mass", [1e-3, 1e3])
def test_what_a_kinematic_body_weighs_does_not_matter_to_what_hangs_on_it(simulate, mass):
    """A bob of 100 kg swings as on a post; held by a weld, one of 10 g let it fall 26 % too slowly."""

    def build(scene):
        scene.box("post", size=(0.1,) * 3, mass=mass, position=(0, 0, 2), kinematic=True)
        scene.sphere("bob", radius=0.15, mass=100.0, position=(0.5 * math.sin(0.9), 0, 2 - 0.5 * math.cos(0.9)))
        scene.joint_revolute("pin", "post", "bob", anchor=(0, 0, 2), axis="Y")

    run = simulate(build, 0.5)
    moment = 0.5**2 + 0.4 * 0.15**2
    swing = solve_ivp(lambda _, y: (y[1], -G * 0.5 * math.sin(y[0]) / moment), (0, 0.5), (0.9, 0), rtol=1e-9)
    bob = run.q["bob"][-1]
    assert math.atan2(bob[0], 2 - bob[2]) == pytest.approx(swing.y[0, -1], abs=1e-4)


def test_a_pendulum_feels_how_its_kinematic_pivot_is_accelerated(simulate):
    """θ'' I = -(g + z'') l sin θ - x'' l cos θ, with the pivot's path; within a lag of half a step."""
    times, places = (0.0, 0.4, 0.8), ((0, 0, 2), (0.3, 0, 2), (0.3, 0, 2.3))

    def build(scene):
        scene.box("pivot", size=(0.1,) * 3, position=(0, 0, 2), kinematic=True)
        scene.path("pivot", times=times, positions=places)
        scene.sphere("bob", radius=0.1, mass=10.0, position=(0.5 * math.sin(0.6), 0, 2 - 0.5 * math.cos(0.6)))
        scene.joint_revolute("pin", "pivot", "bob", anchor=(0, 0, 2), axis="Y")

    run = simulate(build, 0.8)
    pull = CubicHermiteSpline(times, places, np.zeros((3, 3))).derivative(2)  # at rest at each key
    moment = 0.5**2 + 0.4 * 0.1**2

    def swing(t, y):
        x, _, z = pull(t)
        return y[1], -0.5 * ((G + z) * math.sin(y[0]) + x * math.cos(y[0])) / moment

    known = solve_ivp(swing, (0, run.t[-1]), (0.6, 0), t_eval=run.t, rtol=1e-9, max_step=1e-3).y[0]
    arm = run.q["bob"] - run.q["pivot"]
    assert np.ptp(known) > 1.0
    assert np.abs(np.arctan2(arm[:, 0], -arm[:, 2]) - known).max() < 0.01


def test_what_hangs_on_a_kinematic_body_goes_with_it_from_the_first_step(simulate):
    """Started with the speeds that the crank asks for, the rod's pin stays in the crank's."""
    speed = 4.0

    def build(scene):
        scene.box(
            "crank", size=(R, 0.02, 0.02), position=(0, 0, 1), kinematic=True,
            angular_velocity_deg=(0, math.degrees(speed), 0),
        )  # fmt: skip
        scene.box(
            "rod", size=(L, 0.02, 0.02), mass=0.2, position=(R + L / 2, 0.05, 1), velocity=(0, 0, -speed * R / 2),
            angular_velocity_deg=(0, -math.degrees(speed * R / L), 0),
        )  # fmt: skip
        scene.box("piston", size=(0.1,) * 3, mass=0.5, position=(R + L, 0.2, 1))
        scene.joint_revolute("pin", "crank", "rod", anchor=(R, 0, 1), axis="Y")
        scene.joint_revolute("wrist", "rod", "piston", anchor=(R + L, 0, 1), axis="Y")
        scene.joint_prismatic("rail", None, "piston", axis="X")

    run = simulate(build, 0.1)
    angle = speed * run.t
    turn = run.turn["rod"]
    lean = 2.0 * np.arctan2(turn[:, 1], turn[:, 3])
    pin = run.q["rod"][:, [0, 2]] - L / 2 * np.stack([np.cos(lean), -np.sin(lean)], axis=1)
    there = np.stack([R * np.cos(angle), 1.0 - R * np.sin(angle)], axis=1)
    assert np.abs(pin - there).max() < 2e-5  # one step of the crank's is 5e-4 m


# ---- holding
def test_a_motor_does_not_push_through_a_stop(simulate):
    def build(scene):
        arm = scene.box("arm", size=(0.4, 0.02, 0.02), mass=1.0, position=(0.2, 0, 1))
        push = Drive(velocity=720.0, damping=5.0, max_force=200.0)
        scene.joint_revolute("hinge", None, arm, anchor=(0, 0, 1), axis="Z", limits_deg=(0, 45), drive=push)

    run = simulate(build, 0.5)
    angle = 2.0 * np.arctan2(run.turn["arm"][:, 2], run.turn["arm"][:, 3])
    assert angle.max() < math.pi / 4 + 0.01
    assert angle[-1] == pytest.approx(math.pi / 4, abs=1e-3)


def test_a_chain_of_twenty_links_bears_a_load(simulate):
    """Each link of 50 g; the chain of joints that may break gives by less than a millimetre under 20 kg."""

    def build(scene):
        for y, most in ((0.0, None), (1.0, 1e5)):
            above = None
            for k in range(20):
                link = scene.box(
                    f"link{k}_{int(y)}", size=(0.02, 0.02, 0.1), mass=0.05, position=(0, y, 3.95 - 0.1 * k)
                )
                scene.joint_spherical(f"pin{k}_{int(y)}", above, link, anchor=(0, y, 4 - 0.1 * k), break_force=most)
                above = link
            load = scene.box(f"load{int(y)}", size=(0.2,) * 3, mass=20.0, position=(0, y, 1.9))
            scene.joint_fixed(f"hook{int(y)}", above, load, anchor=(0, y, 2))

    run = simulate(build, 0.5)
    assert abs(run.q["load0"][-1, 2] - 1.9) < 1e-5
    assert 0.0 < 1.9 - run.q["load1"][-1, 2] < 1e-3


def test_a_loop_that_starts_open_is_pulled_shut(tmp_path):
    """The closing pin of a bar on two links is stated 2 mm off: its gap fades in 0.02 s and does not stay."""
    scene = Scene()
    scene.simulation(frame_rate=100.0)
    for name, x in (("left", 0.0), ("right", 0.4)):
        scene.box(name, size=(0.03, 0.03, 0.3), mass=0.2, position=(x, 0.05, 0.85))
        scene.joint_revolute(f"{name}_top", None, name, anchor=(x, 0.05, 1.0), axis="Y")
    scene.box("bar", size=(0.4, 0.03, 0.03), mass=0.3, position=(0.2, 0.0, 0.7))
    scene.joint_revolute("left_pin", "left", "bar", anchor=(0.0, 0.0, 0.7), axis="Y")
    scene.joint_revolute("right_pin", "right", "bar", anchor=(0.4, 0.0, 0.7), axis="Y")
    stage = scene.save(tmp_path / "stage.usda")
    closing = next(joint.prim for joint in describe(stage).joints if joint.closing)
    opened = Usd.Stage.Open(str(stage))
    place = opened.GetPrimAtPath(closing).GetAttribute("physics:localPos1")
    place.Set(Gf.Vec3f(*place.Get()) + Gf.Vec3f(0.002, 0.0, 0.0))
    opened.GetRootLayer().Save()
    simulation = Simulation(stage, "cpu")
    (joint,) = (joint for joint in simulation.world.joints if joint.closing)
    rows = {body.prim: row for body, row in zip(simulation.world.bodies, simulation.built.bodies, strict=True)}

    def gap():
        ends = []
        for prim, anchor in ((joint.parent, joint.parent_anchor), (joint.child, joint.child_anchor)):
            pose = np.array([0, 0, 0, 0, 0, 0, 1.0]) if prim is None else simulation.state.body_q.numpy()[rows[prim]]
            ends.append(pose[:3] + rotate(pose[3:].astype(float), np.array(anchor)))
        return np.linalg.norm(ends[0] - ends[1])

    assert gap() == pytest.approx(0.002, rel=1e-3)
    for _ in range(30):
        simulation.advance_frame()
    assert simulation.problems() == []
    assert gap() < 2e-5
