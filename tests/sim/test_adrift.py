"""Drives, dry friction and stops in mechanisms that touch, or nearly: by the fourth order; MuJoCo in C."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tests.sim.struck_worlds import Books
from wsim.scene import Drive

G = 9.81
CART, BOB, LENGTH, RADIUS = 2.0, 1.0, 0.5, 0.05  # [kg, kg, m, m]


@pytest.mark.parametrize("damping", [0.0, 0.5, 50.0])
def test_an_arm_adrift_keeps_its_momenta(tmp_path, damping):
    """Near its trunk, and pressed to it: none was kept to 1 % or 2.5 % of a link's. The last is stiffly damped."""

    def arm(scene):
        scene.simulation(gravity=(0, 0, 0))
        trunk = scene.box("trunk", size=(0.3, 0.2, 0.5), mass=10.0, position=(0, 0, 1))
        upper = scene.capsule("upper", radius=0.04, height=0.2, mass=1.0, position=(0.25, 0, 1.05))
        lower = scene.capsule("lower", radius=0.03, height=0.2, mass=0.5, position=(0.25, 0, 0.75))
        drives = (
            Drive(position=90, stiffness=30, damping=damping),
            Drive(position=-60, stiffness=10, damping=damping / 3),
        )
        scene.joint_revolute("shoulder", trunk, upper, anchor=(0.25, 0, 1.2), axis="Y", drive=drives[0])
        scene.joint_revolute("elbow", upper, lower, anchor=(0.25, 0, 0.9), axis="Y", drive=drives[1])

    books = Books(tmp_path, arm, 0.3)
    fastest = np.abs(books.v[:, 1:]).max()
    assert fastest > 0.1  # it moves
    assert np.linalg.norm(books.momentum, axis=-1).max() < 2e-5 * fastest
    assert np.linalg.norm(books.spin, axis=-1).max() < 2e-5 * fastest


@pytest.mark.parametrize("damping", [0.0, 1.0, 20.0])
def test_a_robot_adrift_whose_legs_meet_their_stops_keeps_its_momenta(tmp_path, damping):
    """Drives press them on, and some come off again: by the first order all of it gained up to 6 mm/s."""

    def robot(scene):
        scene.simulation(gravity=(0, 0, 0))
        trunk = scene.box("trunk", size=(0.4, 0.2, 0.15), mass=10.0, position=(0, 0, 2))
        for k, (x, goal) in enumerate(((-0.2, 50), (0.2, -40))):
            hip = Drive(position=goal, stiffness=60, damping=damping)
            knee = Drive(position=-1.5 * goal, stiffness=20, damping=damping / 3)
            upper = scene.capsule(f"upper_{k}", radius=0.03, height=0.2, mass=2.0, position=(x, 0.15, 1.87))
            lower = scene.capsule(f"lower_{k}", radius=0.025, height=0.2, mass=1.0, position=(x, 0.15, 1.57))
            for name, ends, z, limits, drive in (
                ("hip", (trunk, upper), 2.0, (-30, 35), hip),
                ("knee", (upper, lower), 1.72, (-70, 0.5 if k else 20), knee),
            ):
                at = {"anchor": (x, 0.15, z), "axis": "Y"}
                scene.joint_revolute(f"{name}_{k}", *ends, **at, limits_deg=limits, drive=drive)

    books = Books(tmp_path, robot, 0.6)
    assert np.linalg.norm(books.momentum, axis=-1).max() < 16.0 * 2e-6  # [kg m/s], found: 5e-7 m/s
    assert np.linalg.norm(books.spin, axis=-1).max() < 2e-5  # [kg m^2/s], found: 8e-6


@pytest.mark.parametrize("limits", [(-60, 0), (0, 60), (-5, 5)])
def test_a_knee_at_its_stop_gives_no_energy(tmp_path, limits):
    """It loses some where it meets a stop, and none while it is held there: of 3.6 J rounding alone gives 1e-5."""

    def leg(scene):
        for name, mass, x in (("upper", 1.0, 0.15), ("lower", 0.5, 0.45)):
            scene.box(name, size=(0.3, 0.03, 0.03), mass=mass, position=(x, 0, 2))
        scene.joint_revolute("hip", None, "upper", anchor=(0, 0, 2), axis="Y")
        scene.joint_revolute("knee", "upper", "lower", anchor=(0.3, 0, 2), axis="Y", limits_deg=limits)

    books = Books(tmp_path, leg, 2.0)
    lost = np.diff(books.energy) < -1e-5
    assert 0.0 < lost.sum() < 40  # [steps] of 1,680
    assert np.abs(np.diff(books.energy)[~lost].sum()) < 4e-5 and books.gain[0] < 5e-6


def swing(friction, times):
    """Where a cart is that rubs on its rail under a pendulum, which starts level, from stop to stop (n,) [m]."""
    inertia, moment = 0.4 * BOB * RADIUS**2 + BOB * LENGTH**2, BOB * LENGTH

    def held(y):  # what the rail must give, and the bob's turning, where the cart stands
        turn = -G * moment * math.sin(y[1]) / inertia
        return moment * (math.cos(y[1]) * turn - math.sin(y[1]) * y[3] ** 2), turn

    def rate(y, way):
        if not way:
            return [0.0, y[3], 0.0, held(y)[1]]
        mass = [[CART + BOB, moment * math.cos(y[1])], [moment * math.cos(y[1]), inertia]]
        pull = [moment * math.sin(y[1]) * y[3] ** 2 - way * friction, -G * moment * math.sin(y[1])]
        return [y[2], y[3], *np.linalg.solve(mass, pull)]

    t, y, way, found = 0.0, np.array([0.0, math.pi / 2, 0.0, 0.0]), 0, np.zeros(len(times))
    while t < times[-1]:

        def ends(t, y, way=way):
            return y[2] * way if way else friction - abs(held(y)[0])

        ends.terminal, ends.direction = True, -1
        part = solve_ivp(
            lambda t, y, way=way: rate(y, way), (t, times[-1]), y, events=ends, rtol=1e-10, atol=1e-12,
            max_step=0.01, dense_output=True,
        )  # fmt: skip
        now = (times >= t) & (times <= part.t[-1])
        found[now] = part.sol(times[now])[0]
        t, y = part.t[-1], part.y[:, -1]
        pull = -held(y)[0]
        sticks = bool(way) and abs(pull) <= friction
        way, y[2] = 0 if sticks else int(np.sign(pull)), 0.0
    return found


@pytest.mark.parametrize(("friction", "most"), [(4.0, 2e-4), (1.0, 1e-4)])
def test_a_cart_rubs_on_its_rail_under_a_pendulum(tmp_path, friction, most):
    """By steps of the first order it came 3.7 mm and 5.9 mm beside where it is [m]."""

    def build(scene):
        cart = scene.box("cart", size=(0.2, 0.1, 0.1), mass=CART, position=(0, 0, 2))
        scene.joint_prismatic("rail", None, cart, axis="X", friction=friction)
        scene.sphere("bob", radius=RADIUS, mass=BOB, position=(LENGTH, 0, 2))
        scene.joint_revolute("hinge", cart, "bob", anchor=(0, 0, 2), axis="Y")

    books = Books(tmp_path, build, 0.9)
    times = np.arange(len(books.center)) * books.simulation.dt
    assert books.center[:, 0, 0] == pytest.approx(swing(friction, times), abs=most)
