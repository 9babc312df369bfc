"""What happens by time or after an event, against theory; in C, and side by side in Warp."""

import math
from functools import partial

import numpy as np
import pytest

from tests.sim.test_bodies import Run
from wsim.scene import Drive, Event, Scene
from wsim.sim import Simulation

G = 9.81
BOTH = pytest.mark.parametrize("worlds", [1, 2])  # MuJoCo in C, and in Warp


@pytest.fixture(params=["cpu", pytest.param("cuda:0", marks=pytest.mark.cuda)])
def simulate(request, tmp_path):
    """A run of what a function builds, on each device."""
    return partial(Run, tmp_path, request.param)


def at(run, seconds):
    """The number of the step that ends then."""
    return round(seconds / run.dt) - 1


@BOTH
def test_a_push_against_friction_and_efforts_on_joints(simulate, worlds):
    """(F / m - mu g) t while it lasts, and mu g t less after it; a rotor gains t / I, a motor has its speed at once."""

    def build(scene):
        scene.ground(friction=0.2)
        scene.box("block", size=(0.2,) * 3, mass=10.0, position=(0, 0, 0.1), friction=0.2)
        scene.schedule("push", "block", "force", times=[0.1, 0.3], values=[(40, 0, 0), (0, 0, 0)])
        for name, y in (("rotor", 2), ("wheel", 4)):
            scene.cylinder(name, radius=0.2, height=0.05, mass=2.0, position=(0, y, 1))
        axle = scene.joint_revolute("axle", None, "rotor", axis="Z")
        scene.schedule("spin", axle, "effort", times=[0.05, 0.25], values=[0.1, 0])
        motor = scene.joint_revolute("motor", None, "wheel", axis="Z", drive=Drive(velocity=90, damping=5))
        scene.schedule("turn", motor, "velocity", times=[0.15, 0.3], values=[180, -90])

    run = simulate(build, 0.45, worlds)
    for t in (0.1, 0.2, 0.3, 0.4):
        pushed = min(max(t - 0.1, 0.0), 0.2)
        expected = (4.0 - 0.2 * G) * pushed - 0.2 * G * max(t - 0.3, 0.0)
        assert run.v["block"][at(run, t), 0] == pytest.approx(expected, abs=4.0 * run.dt)
    gained = 0.1 * 0.2 / (0.5 * 2.0 * 0.04)
    assert run.w["rotor"][-1, 2] == pytest.approx(gained, rel=2e-4)
    for t, speed in ((0.14, 90), (0.29, 180), (0.44, -90)):
        assert math.degrees(run.w["wheel"][at(run, t), 2]) == pytest.approx(speed, rel=1e-3)


def swung(t, mass, stiffness, damping, speed):
    """Where a slider is that starts at rest on its drive's position, and follows a velocity beside it [m]."""
    end, fades = damping * speed / stiffness, damping / (2.0 * mass)
    rate = math.sqrt(stiffness / mass - fades**2)
    return end * (1.0 - math.exp(-fades * t) * (math.cos(rate * t) + fades / rate * math.sin(rate * t)))


@BOTH
def test_a_servo_follows_a_velocity_by_its_damping_and_is_pulled_back_by_its_stiffness(simulate, worlds):
    """m q'' = -k q + c (v - q'), with v stated or from a key on; a bound cuts the sum off, not each of the two."""

    def build(scene):
        scene.simulation(gravity=(0, 0, 0))
        for y, name in enumerate(("stated", "late", "bound")):
            scene.box(name, size=(0.2,) * 3, mass=2.0, position=(0, y, 1))
            speed, at = 0.0 if name == "late" else 0.5, -0.1 if name == "bound" else 0.0
            most = 2.0 if name == "bound" else None  # its parts give -4 N and 3 N at the start
            drive = Drive(position=at, stiffness=40.0, damping=6.0, velocity=speed, max_force=most)
            rail = scene.joint_prismatic(f"rail_{name}", None, name, axis="X", drive=drive)
            if name == "late":
                scene.schedule("go", rail, "velocity", times=[0.1], values=[0.5])

    run = simulate(build, 0.5, worlds)
    law = 2.0, 40.0, 6.0, 0.5
    pulled = 2.0, 40.0, 6.0, 0.5 - 4.0 / 6.0
    for t in (0.2, 0.35, 0.5):
        assert run.q["stated"][at(run, t), 0] == pytest.approx(swung(t, *law), rel=5e-3)
        assert run.q["bound"][at(run, t), 0] == pytest.approx(swung(t, *pulled), rel=5e-3)
        assert run.q["late"][at(run, t), 0] == pytest.approx(swung(t - 0.1, *law), rel=2e-2)


@BOTH
def test_any_hinge_of_a_loop_takes_an_effort(simulate, worlds):
    """In a parallelogram the coupler goes as fast as the arms' ends: M = (2 I + m L^2) a, I of an arm about its pin."""
    arm, coupler, length, torque = 1.0, 2.0, 0.5, 0.3

    def build(scene):
        scene.simulation(gravity=(0, 0, 0))
        for name, x in (("left", 0.0), ("right", 1.0)):
            scene.box(name, size=(0.05, 0.05, length), mass=arm, position=(x, 0, length / 2))
        scene.box("bar", size=(1, 0.05, 0.05), mass=coupler, position=(0.5, 0, length))
        pins = {"a": (None, "left", 0, 0), "b": ("left", "bar", 0, length), "c": ("bar", "right", 1, length)}
        for name, (parent, child, x, z) in (pins | {"d": (None, "right", 1, 0)}).items():
            scene.joint_revolute(name, parent, child, anchor=(x, 0, z), axis="Y")
        scene.schedule("turn", "d", "effort", times=[0.0], values=[torque])

    run = simulate(build, 0.3, worlds)
    own = arm * (length**2 + 0.05**2) / 12.0 + arm * length**2 / 4.0
    expected = torque / (2.0 * own + coupler * length**2) * 0.3
    assert run.w["right"][-1, 1] == pytest.approx(expected, rel=5e-3)
    assert run.w["left"][-1, 1] == pytest.approx(expected, rel=5e-3)


@BOTH
def test_a_force_acts_where_it_is_applied_and_as_long_as_its_keys_say(simulate, worlds):
    """Between keys that no step meets, too: the impulse is exact. Off the centre it turns by F r t / I."""

    def build(scene):
        scene.simulation(gravity=(0, 0, 0), time_step=1e-3)
        scene.box("bar", size=(1, 0.1, 0.1), mass=2.0, position=(0, 0, 1))
        scene.box("cube", size=(0.2,) * 3, mass=1.0, position=(0, 3, 1))
        scene.schedule(
            "tip", "bar", "force", times=[0.01033, 0.02071], values=[(0, 3, 0), (0, 0, 0)], point=(0.5, 0, 0)
        )
        scene.schedule(
            "swell",
            "cube",
            "force",
            times=[0.00517, 0.10551, 0.15],
            values=[(0,) * 3, (8, 0, 0), (0,) * 3],
            linear=True,
        )
        scene.schedule("twist", "cube", "torque", times=[0.0, 0.05], values=[(0, 0, 0.01), (0, 0, 0)])

    run = simulate(build, 0.152, worlds)
    impulse = 3.0 * (0.02071 - 0.01033)
    assert run.v["bar"][-1, 1] == pytest.approx(impulse / 2.0, rel=1e-5)
    assert run.w["bar"][-1, 2] == pytest.approx(0.5 * impulse / (2.0 / 12.0 * 1.01), rel=1e-3)
    assert run.v["cube"][-1, 0] == pytest.approx(0.5 * 8.0 * (0.15 - 0.00517), rel=1e-4)
    assert run.w["cube"][-1, 2] == pytest.approx(0.01 * 0.05 / (0.04 / 6.0), rel=1e-4)


@BOTH
def test_belts_gates_tables_joints_and_ice(simulate, worlds):
    """A block brakes with mu g on a belt that stops; a gate lifts by v t; a table turns by the area under its keys."""

    def build(scene):
        scene.ground(friction=0.3)
        belt = scene.box("belt", size=(6, 0.5, 0.2), position=(0, 3, 0.5), static=True, friction=0.3)
        scene.surface_velocity(belt, velocity=(1, 0, 0))
        scene.box("parcel", size=(0.2,) * 3, mass=2, position=(-1, 3, 0.7), friction=0.3, velocity=(1, 0, 0))
        scene.schedule("stop", belt, "surface_velocity", times=[0.1], values=[(0, 0, 0)])
        scene.box("gate", size=(0.1, 1, 1), position=(0, -3, 0.6), kinematic=True)
        scene.schedule("lift", "gate", "velocity", times=[0.05, 0.25], values=[(0, 0, 0.5), (0, 0, 0)])
        scene.cylinder("table", radius=0.5, height=0.1, position=(3, -3, 0.5), kinematic=True)
        scene.schedule(
            "spin",
            "table",
            "angular_velocity",
            times=[0.0, 0.1, 0.2],
            values=[(0,) * 3, (0, 0, 90), (0,) * 3],
            linear=True,
        )
        scene.sphere("weight", radius=0.1, mass=1, position=(-3, -3, 2))
        scene.schedule("drop", scene.joint_fixed("hook", None, "weight"), "release", times=[0.1])
        scene.box("sled", size=(0.3, 0.2, 0.1), mass=3, position=(-4, 0, 0.05), velocity=(2, 0, 0))
        scene.contact("sled", "ground", friction=0.3)
        scene.schedule("thaw", ("sled", "ground"), "friction", times=[0.1], values=[0.02])

    run = simulate(build, 0.3, worlds)
    assert run.v["parcel"][at(run, 0.1), 0] == pytest.approx(1.0, abs=1e-3)
    assert run.v["parcel"][-1, 0] == pytest.approx(1.0 - 0.3 * G * 0.2, abs=0.3 * G * 2 * run.dt)
    assert run.q["gate"][-1, 2] == pytest.approx(0.6 + 0.5 * 0.2, abs=1e-6)
    turned = 2.0 * math.atan2(run.turn["table"][-1, 2], run.turn["table"][-1, 3])
    assert math.degrees(turned) == pytest.approx(0.5 * 90 * 0.2, rel=1e-4)
    assert np.abs(run.q["weight"][at(run, 0.09), 2] - 2.0) < 1e-6
    assert run.v["weight"][-1, 2] == pytest.approx(-G * 0.2, abs=2 * G * run.dt)
    expected = 2.0 - 0.3 * G * 0.1 - 0.02 * G * 0.2
    assert run.v["sled"][-1, 0] == pytest.approx(expected, abs=0.3 * G * 2 * run.dt)


def falls(scene, height=1.0, delay=0.05):
    """A ball falls on a plate, whose touch lets another go; what passes a height, or an angle, starts more."""
    scene.simulation(time_step=1e-3)
    scene.box("plate", size=(1, 1, 0.1), position=(0, 0, 0.05), static=True)
    scene.sphere("ball", radius=0.05, mass=0.5, position=(0, 0, 0.15 + height), restitution=0.5)
    scene.sphere("held", radius=0.05, mass=0.5, position=(3, 0, 2))
    hook = scene.joint_fixed("hook", None, "held")
    touch = Event(touch=("ball", "plate"), delay=delay)
    scene.schedule("drop", hook, "release", times=[0.0], after=touch)
    scene.box("door", size=(1, 0.05, 1), mass=5, position=(-2.5, 0, 1))
    hinge = scene.joint_revolute("hinge", None, "door", anchor=(-3, 0, 1), axis="Z")
    half = Event(body="ball", axis="z", below=0.15 + height / 2)
    scene.schedule("open", hinge, "effort", times=[0.0, 0.1], values=[2.0, 0.0], after=half)
    scene.box("cart", size=(0.2,) * 3, mass=1, position=(0, 9, 0.5), kinematic=True)
    scene.schedule("go", "cart", "velocity", times=[0.0], values=[(1, 0, 0)], after=Event(joint=hinge, above=0.05))
    scene.box("last", size=(0.2,) * 3, mass=1, position=(0, 12, 0.5), kinematic=True)
    scene.schedule("end", "last", "velocity", times=[0.02], values=[(1, 0, 0)], after=Event(end="open", delay=0.01))
    scene.box("idle", size=(0.2,) * 3, mass=1, position=(0, 15, 0.5), kinematic=True)
    scene.schedule("never", "idle", "velocity", times=[0.0], values=[(1, 0, 0)], after=Event(touch=("ball", "held")))


def began(run):
    return {name.rsplit("/", 1)[1]: each for name, each in run.simulation.rigid.began().items()}


@BOTH
def test_clocks_start_at_events(simulate, worlds):
    """A ball that falls 1 m touches after sqrt(2 / g) = 0.4515 s, and is half way after sqrt(1 / g) = 0.3193 s."""
    run = simulate(falls, 0.55, worlds)
    begin, dt = began(run), run.dt
    assert begin["drop"] == pytest.approx(math.sqrt(2.0 / G) + 0.05, abs=2 * dt)
    half = math.sqrt(1.0 / G)
    assert begin["open"] == pytest.approx(half, abs=1.5 * dt) and (begin["open"] >= half).all()
    rate = 2.0 / (5.0 / 12.0 * (1.0 + 0.0025) + 5.0 * 0.25)
    assert begin["go"] == pytest.approx(begin["open"] + math.sqrt(2.0 * math.radians(0.05) / rate), abs=3 * dt)
    assert begin["end"] == pytest.approx(begin["open"] + 0.11, abs=1e-6)
    assert (begin["never"] == -1.0).all() and np.abs(run.q["idle"][:, 0]).max() == 0.0
    due = begin["drop"][0]
    assert run.v["held"][-1, 2] == pytest.approx(-G * (0.55 - due), abs=2 * G * dt)
    assert run.q["last"][-1, 0] == pytest.approx(0.55 - begin["end"][0] - 0.02, abs=dt)


def test_what_is_so_at_the_start_starts_a_clock_then(simulate):
    def build(scene):
        scene.box("cart", size=(0.2,) * 3, mass=1, position=(1, 0, 0.5), kinematic=True)
        here = Event(body="cart", axis="X", above=0.5, delay=0.01)
        scene.schedule("go", "cart", "velocity", times=[0.0], values=[(1, 0, 0)], after=here)

    run = simulate(build, 0.1)
    assert began(run)["go"] == pytest.approx(0.01, abs=run.dt)


@pytest.mark.parametrize("device", ["cpu", pytest.param("cuda:0", marks=pytest.mark.cuda)])
def test_worlds_of_a_batch_move_as_each_does_alone(tmp_path, device):
    """They differ in what is set, in their events' times, and so in which is let go when."""

    def path(name, height, delay, force):
        scene = Scene()
        falls(scene, height, delay)
        scene.box("block", size=(0.2,) * 3, mass=2, position=(6, 6, 3))
        scene.schedule("push", "block", "force", times=[0.02, 0.05 + 0.5 * height], values=[(force, 0, 0), (0, 0, 0)])
        scene.simulation(duration=0.2)
        return scene.save(tmp_path / f"{name}.usda")

    stages = [path("low", 0.05, 0.02, 4.0), path("high", 0.1, 0.0, -7.0)]

    def states(simulation):
        while simulation.time < 0.2 - 1e-9:
            simulation.step()
        found = simulation.state.body_q.numpy().reshape(max(1, simulation.model.world_count), -1, 7)
        return found, np.array(list(simulation.rigid.began().values()))

    together, begin = states(Simulation(stages, device))
    assert not np.allclose(begin[:, 0], begin[:, 1])
    for w, stage in enumerate(stages):
        alone, own = states(Simulation(stage, "cpu"))  # in C, in double precision
        assert np.allclose(together[w], alone[0], atol=1e-4) and np.allclose(begin[:, w], own[:, 0], atol=1e-4)


@BOTH
def test_a_run_that_starts_anew_goes_as_before(simulate, worlds):
    """Clocks, events, targets, belts, friction and joints that let go are as stated again."""

    def build(scene):
        falls(scene, 0.02, 0.0)
        wheel = scene.cylinder("wheel", radius=0.2, height=0.05, mass=2, position=(0, -6, 1))
        motor = scene.joint_revolute("motor", None, wheel, axis="Z", drive=Drive(velocity=90, damping=5))
        scene.schedule("turn", motor, "velocity", times=[0.05], values=[180])

    run = simulate(build, 0.08, worlds)
    simulation = run.simulation
    first = [simulation.state.body_q.numpy().copy(), began(run)]
    start = simulation.model.state()
    simulation.state.assign(start)
    simulation._forget()
    simulation.time, simulation.step_count = 0.0, 0
    assert began(run)["drop"][0] == -1.0
    while simulation.time < 0.08 - 1e-9:
        simulation.step()
    assert np.allclose(simulation.state.body_q.numpy(), first[0], atol=1e-5)
    assert all(np.array_equal(each, first[1][name]) for name, each in began(run).items())
