"""What flies: loose bodies tumble as Euler's equations have it, and go as far as their velocity takes them."""

import math
from functools import partial

import newton
import numpy as np
import pytest

from tests.sim.test_bodies import G, Run
from wsim.geometry.rotations import rotate
from wsim.scene import Part

BOTH = pytest.mark.parametrize("worlds", [1, 2])  # MuJoCo in C, and in Warp
SPIN = 80.0 * np.array([0.3, 0.8, 0.5])  # [rad/s]


@pytest.fixture(params=["cpu", pytest.param("cuda:0", marks=pytest.mark.cuda)])
def simulate(request, tmp_path):
    """A run of what a function builds, on each device."""
    return partial(Run, tmp_path, request.param)


def _kept(run, name):
    """Angular momentum about the centre of mass and energy of rotation of a body, a row a step."""
    k = run.simulation.built.bodies[list(run.q).index(name)]
    inertia = run.simulation.model.body_inertia.numpy()[k].astype(float)
    turn, spin = run.turn[name], run.w[name]
    own = rotate(turn * (-1, -1, -1, 1), spin)
    return rotate(turn, own @ inertia), 0.5 * np.einsum("ti,ij,tj->t", own, inertia, own)


@BOTH
def test_what_tumbles_keeps_its_momentum_and_energy(simulate, worlds):
    """Beside a crate that stands on the ground; the axes of one are oblique, and its centre of mass is off."""

    def build(scene):
        scene.ground()
        scene.box("crate", size=(0.4,) * 3, mass=5.0, position=(3, 0, 0.2))
        spin = tuple(np.degrees(SPIN).tolist())
        scene.box("box", size=(0.4, 0.2, 0.1), mass=1.0, position=(0, 0, 50), angular_velocity_deg=spin)
        parts = [
            Part("box", size=(0.4, 0.2, 0.1), mass=1.0, rotation_deg=(10, 20, 30)),
            Part("sphere", radius=0.03, mass=0.4, position=(0.1, 0.1, 0.05)),
        ]
        scene.compound("odd", parts=parts, position=(0, 5, 50), angular_velocity_deg=spin)

    run = simulate(build, 0.1, worlds)
    for name in ("box", "odd"):
        momentum, energy = _kept(run, name)
        assert np.linalg.norm(momentum - momentum[0], axis=1).max() < 1e-4 * np.linalg.norm(momentum[0])
        assert np.abs(energy / energy[0] - 1).max() < 1e-4
    aside = run.v["odd"][:, :2]
    assert np.abs(aside - aside[0]).max() < 1e-4  # its centre of mass falls straight


def _spins(moments, start, h, steps, parts=10):
    """Spins in the body's axes by Euler's equations, integrated by Runge and Kutta, after each step."""

    def change(w):
        return np.cross(moments * w, w) / moments

    w, s, found = np.array(start), h / parts, []
    for k in range(steps * parts):
        a = change(w)
        b = change(w + 0.5 * s * a)
        c = change(w + 0.5 * s * b)
        w = w + s / 6 * (a + 2 * b + 2 * c + change(w + s * c))
        if k % parts == parts - 1:
            found.append(w)
    return np.array(found)


@BOTH
@pytest.mark.parametrize("size", [(0.4, 0.2, 0.1), (0.6, 0.02, 0.02), (0.3, 0.3, 0.02)])
def test_what_tumbles_follows_euler(simulate, worlds, size):
    """A brick, a rod and a plate: the spins in their own axes."""

    def build(scene):
        scene.simulation(gravity=(0, 0, 0))
        scene.box("box", size=size, mass=1.0, angular_velocity_deg=tuple(np.degrees(SPIN).tolist()))

    run = simulate(build, 0.15, worlds)
    squares = np.square(size)
    known = _spins((squares.sum() - squares) / 12, SPIN, run.dt, len(run.w["box"]))
    own = rotate(run.turn["box"] * (-1, -1, -1, 1), run.w["box"])
    assert np.abs(own - known).max() < 1e-3 * np.linalg.norm(SPIN)


@BOTH
def test_a_push_on_what_tumbles_gives_its_impulse(simulate, worlds):
    """A torque for 0.1 s changes the angular momentum by as much, a force the momentum."""

    def build(scene):
        scene.simulation(gravity=(0, 0, 0))
        scene.box("box", size=(0.4, 0.2, 0.1), mass=1.0, angular_velocity_deg=tuple(np.degrees(SPIN).tolist()))

    run = simulate(build, 0.01, worlds)
    simulation, wrench = run.simulation, np.array((1.0, 0, 0, 0, 0, 2.0))
    push = np.tile(wrench, (simulation.model.body_count, 1)).astype(np.float32)
    simulation.control_force.assign(push)
    simulation._steered = True
    k = simulation.built.bodies[0]
    inertia = simulation.model.body_inertia.numpy()[k].astype(float)

    def momentum():
        turn, spin = simulation.state.body_q.numpy()[k, 3:], simulation.state.body_qd.numpy()[k, 3:]
        return rotate(turn, rotate(turn * (-1, -1, -1, 1), spin) @ inertia)

    before, steps = momentum(), round(0.1 / simulation.dt)
    for _ in range(steps):
        simulation.step()
    assert momentum() - before == pytest.approx(wrench[3:] * steps * simulation.dt, abs=2e-3)
    assert simulation.state.body_qd.numpy()[k, :3] == pytest.approx(wrench[:3] * steps * simulation.dt, abs=1e-5)


@BOTH
def test_a_push_below_single_precision_is_none(simulate, worlds):
    """A GPU flushes such numbers in one sum and not in another: what it leaves, 1e-38 N m, costs a fall no parabola."""
    run = simulate(lambda scene: scene.box("box", size=(0.2,) * 3, mass=1.0), 0.005, worlds)
    simulation = run.simulation
    simulation.control_force.assign(np.full((simulation.model.body_count, 6), 1e-39, dtype=np.float32))
    simulation._steered = True
    while simulation.time < 0.1:
        simulation.step()
    place = simulation.state.body_q.numpy()[simulation.built.bodies[0], 2]
    assert place == pytest.approx(-0.5 * G * simulation.time**2, abs=1e-6)


@BOTH
def test_what_is_slow_and_far_away_goes_its_way(simulate, worlds):
    """At 300 m a step of 1 cm/s is less than half of what single precision can add to the place."""

    def build(scene):
        scene.simulation(gravity=(0, 0, 0))
        scene.sphere("ball", radius=0.05, mass=1.0, position=(300, 0, 0), velocity=(0.01, 0, 0))

    run = simulate(build, 0.2, worlds)
    assert run.q["ball"][-1, 0] - 300 == pytest.approx(0.002, abs=2e-5)  # a place is known to 1.5e-5 m there


@BOTH
def test_a_state_that_is_set_counts(simulate, worlds):
    """What a caller writes between two steps is where the next one starts."""

    def build(scene):
        scene.simulation(gravity=(0, 0, 0))
        scene.sphere("ball", radius=0.05, mass=1.0, velocity=(1, 0, 0))
        scene.sphere("other", radius=0.05, mass=1.0, position=(0, 1, 0), velocity=(1, 0, 0))

    run = simulate(build, 0.01, worlds)
    simulation, state = run.simulation, run.simulation.state
    before = state.body_q.numpy()[:, :3].copy()
    joint = int(np.flatnonzero(simulation.model.joint_child.numpy() == simulation.built.bodies[0])[0])
    first, free = (
        int(start.numpy()[joint]) for start in (simulation.model.joint_q_start, simulation.model.joint_qd_start)
    )
    place, speed = state.joint_q.numpy(), state.joint_qd.numpy()
    place[first + 2] = 5.0
    speed[free + 2] = 2.0
    state.joint_q.assign(place)
    state.joint_qd.assign(speed)
    newton.eval_fk(simulation.model, state.joint_q, state.joint_qd, state)
    simulation.step()
    ball, other = (simulation.state.body_q.numpy()[k, :3] for k in simulation.built.bodies)
    assert ball == pytest.approx((before[0, 0] + simulation.dt, 0.0, 5.0 + 2.0 * simulation.dt), abs=1e-6)
    assert other == pytest.approx((before[1, 0] + simulation.dt, 1.0, 0.0), abs=1e-6)


@BOTH
def test_a_hinged_pair_that_tumbles_beside_a_crate_keeps_its_energy(simulate, worlds):
    """It touches nothing; by steps of the first order it blew up."""

    def build(scene):
        scene.ground()
        scene.box("crate", size=(0.4,) * 3, mass=5.0, position=(5, 0, 0.2))
        spin = (1000, 1500, 2000)
        scene.box("one", size=(0.3, 0.04, 0.05), mass=1.0, position=(0, 0, 50), angular_velocity_deg=spin)
        scene.box("two", size=(0.3, 0.04, 0.05), mass=0.1, position=(0.3, 0, 50), angular_velocity_deg=spin)
        scene.joint_revolute("hinge", "one", "two", anchor=(0.15, 0, 50), axis="Z")

    run = simulate(build, 0.5, worlds)
    energy, momentum = 0.0, 0.0
    for name, mass in (("one", 1.0), ("two", 0.1)):
        energy = energy + 0.5 * mass * (run.v[name] ** 2).sum(axis=1) + _kept(run, name)[1]
        energy = energy + mass * 9.81 * (run.q[name][:, 2] - 50.0)
        momentum = momentum + mass * run.v[name]
    assert np.abs(run.q["crate"] - run.q["crate"][0]).max() < 1e-5
    assert energy == pytest.approx(np.full(len(energy), energy[0]), rel=1e-3)
    assert momentum[:, :2] == pytest.approx(np.broadcast_to(momentum[0, :2], (len(momentum), 2)), abs=1e-3)


@BOTH
@pytest.mark.parametrize("slides", [True, False])
def test_what_spins_about_a_centre_off_its_origin_keeps_its_momentum(simulate, worlds, slides):
    """On a floor without friction, and struck: its origin's velocity turns with it."""

    def build(scene):
        scene.simulation(gravity=(0, 0, -9.81 if slides else 0))
        if slides:
            scene.ground(friction=0.0)
        off = (0.0, 0.0, 0.0), (0.6, 0.0, 0.0)
        parts = [Part("box", size=(0.2, 0.2, 0.2), position=place, friction=0.0) for place in off]
        scene.compound("double", parts=parts, mass=3.0, position=(0, 0, 0.1), velocity=(0, -40.0 * 0.3, 0),
                       angular_velocity_deg=(0, 0, math.degrees(40.0)))  # fmt: skip
        if not slides:
            scene.sphere("ball", radius=0.1, mass=1.0, position=(-2, 0.05, 0.1), velocity=(4, 0, 0), restitution=0.5)

    run = simulate(build, 0.6, worlds)
    momentum = 3.0 * run.v["double"] + (0.0 if slides else run.v["ball"])
    assert momentum[:, :2] == pytest.approx(np.broadcast_to(momentum[0, :2], (len(momentum), 2)), abs=2e-4)
