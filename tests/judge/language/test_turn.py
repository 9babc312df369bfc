"""Predicates of turning, going, bouncing and counting, on motions that theory gives."""

import math

import numpy as np
import pytest

from tests.judge.language.conftest import G, about_axis, moving, shape, solid, still, times
from wsim.geometry.rotations import multiply, rotate
from wsim.judge.language import evaluate, parse
from wsim.scene.world import Shape, World

TIME = times(2.0, 50.0)
ONE = np.ones((len(TIME), 3))


def margin(text, signals):
    return evaluate(parse(text), signals).margin[0]


def turning(rate, carried=0.0):
    """A door a that turns about z at a rate [rad/s], on a frame b that turns at another."""
    world = World(bodies=[solid(name, shape("box", 0.8, 0.04, 1.0)) for name in "ab"])
    q = np.stack([about_axis("z", rate * TIME), about_axis("z", carried * TIME)], axis=1)
    w = np.zeros((len(TIME), 2, 3))
    w[:, 0, 2], w[:, 1, 2] = rate, carried
    return moving(world, TIME, 0.0 * ONE, 2.0 * ONE, q=q, w=w)


@pytest.mark.parametrize("rate", [0.5, -0.5, 4.0, 20.0])
def test_turned_between_counts_on_beyond_a_turn_and_has_a_sign(rate):
    end = math.degrees(2.0 * rate)
    inside = f"eventually[2, 2](turned_between(a, z, {end - 10} deg, {end + 20} deg))"
    assert margin(inside, turning(rate)) == pytest.approx(10.0)
    assert margin(inside.replace("turned_between(a, z", "turned_between(a, x"), turning(rate)) < 0.0
    other = f"eventually[2, 2](turned_between(a, z, {-end - 5} deg, {-end + 5} deg))"
    assert margin(other, turning(rate)) == pytest.approx(5.0 - 2 * abs(end))


def test_an_angle_and_a_rate_against_another_are_a_joints():
    signals = turning(1.5, carried=0.5)
    assert margin("eventually[2, 2](turned_between(a, z, 2 rad, 3 rad, of b))", signals) == pytest.approx(0.0, abs=1e-6)
    assert margin("spin_between(a, z, 0.5 rad/s, 2 rad/s, of b)", signals) == pytest.approx(math.degrees(0.5))
    assert margin("spin_between(a, z, 0 deg/s, 100 deg/s)", signals) == pytest.approx(100.0 - math.degrees(1.5))
    assert margin("spin_between(a, x, -1 deg/s, 1 deg/s)", signals) == pytest.approx(1.0)


def test_gone_between_is_a_way_along_an_axis_and_seen_from_another():
    """A cart a goes at 1 m/s, and a load b with it and by 0.3 m/s backwards on it."""
    world = World(bodies=[solid(name, shape("box", 0.2, 0.2, 0.2)) for name in "ab"])
    signals = moving(
        world, TIME, TIME[:, None] * [1.0, 0.0, 0.0], 0.7 * TIME[:, None] * [1.0, 0.0, 0.0] + [0.0, 0.0, 0.2]
    )
    assert margin("eventually[2, 2](gone_between(b, x, 1.3 m, 2 m))", signals) == pytest.approx(0.1)
    assert margin("eventually[2, 2](gone_between(b, x, -0.7 m, -0.4 m, of a))", signals) == pytest.approx(0.1)
    assert margin("gone_between(b, z, -1 mm, 1 mm, of a)", signals) == pytest.approx(0.001)


@pytest.mark.parametrize("restitution", [0.5, 0.7, 0.9])
def test_bounces_to_the_square_of_the_restitution(restitution):
    """From 1 m a ball comes up to e^2, then e^4 metres."""
    rate = 60.0
    t = times(1.7, rate)
    fall = math.sqrt(2.0 / G)
    up = restitution * G * fall
    first, second = t - fall, t - fall - 2 * up / G
    z = np.where(first < 0.0, 1.0 - G * t**2 / 2, up * first - G * first**2 / 2)
    v = np.where(first < 0.0, -G * t, up - G * first)
    late = second > 0.0
    z = np.where(late, restitution * up * second - G * second**2 / 2, z)
    v = np.where(late, restitution * up - G * second, v)
    keep = t < fall + 2 * up / G + 2 * restitution * up / G
    world = World(
        bodies=[solid("ball", shape("sphere", 0.1))], statics=[still("ground", Shape(prim="/g", kind="plane", size=()))]
    )
    path = np.stack([0.0 * z, 0.0 * z, z + 0.1], axis=1)[keep]
    speed = np.zeros((int(keep.sum()), 1, 3))
    speed[:, 0, 2] = v[keep]
    signals = moving(world, t[keep], path, v=speed)
    assert margin(f"bounces_to(ball, ground, {restitution**2} m, within 2 cm)", signals) == pytest.approx(
        0.02, abs=0.005
    )
    assert margin(f"bounces_to(ball, ground, {restitution**4} m, within 2 cm)", signals) == pytest.approx(
        0.02, abs=0.005
    )
    assert not evaluate(parse("bounces_to(ball, ground, 1 m, within 5 cm)"), signals).satisfied[0]  # nor the start
    # Where the recording breaks off on the way up, that is no height that it bounces to.
    until = signals.time < fall + up / G - 0.1
    broken = moving(world, signals.time[until], path[until], v=speed[until])
    here = path[until][-1, 2] - 0.1
    assert not evaluate(parse(f"bounces_to(ball, ground, {here} m)"), broken).satisfied[0]


def test_counts_what_is_in_a_vessel(tank_world):
    ball, box = [5.0, 0.0, 0.3], [5.0, 0.2, 0.32]
    both = moving(tank_world, TIME, ONE * ball, ONE * box)
    one = moving(tank_world, TIME, ONE * ball, ONE * [3.0, 0.0, 0.2])
    assert margin("counts(tank, 2, ball, box)", both) == 0.0
    assert margin("counts(tank, 2, ball, box)", one) == -1.0
    assert margin("counts(tank, 1, ball, box)", one) == 0.0


@pytest.mark.parametrize("tumble", [0.0, 0.4, 3.0])
def test_a_spin_about_an_own_axis_goes_with_the_body(tumble):
    """A wheel on an axle along its own y, which is itself carried round the world's z: w = carried z + spin y'."""
    spin = 2.0
    own, carried = about_axis("y", spin * TIME), about_axis("z", tumble * TIME)
    q = multiply(carried, own)
    w = np.array([0.0, 0.0, tumble]) + spin * rotate(carried, np.broadcast_to([0.0, 1.0, 0.0], ONE.shape))
    world = World(bodies=[solid("wheel", shape("cylinder", 0.3, 0.1))])
    signals = moving(world, TIME, 0.0 * ONE, q=q[:, None], w=w[:, None])
    assert margin("own_spin_between(wheel, y, 1.5 rad/s, 2.5 rad/s)", signals) == pytest.approx(math.degrees(0.5))
    assert margin("own_spin_between(wheel, y, -3 rad/s, 0 rad/s)", signals) == pytest.approx(-math.degrees(2.0))
    # About the world's y it turns by the cosine of how far it was carried: after half a turn backwards.
    least = math.degrees(spin * np.cos(tumble * TIME).min())
    assert margin("spin_between(wheel, y, 0 deg/s, 999 deg/s)", signals) == pytest.approx(least, abs=0.1)


@pytest.mark.parametrize("angle", [-40.0, 25.0, 110.0])
def test_a_tilt_has_a_sign(angle):
    """About +y what pointed up leans towards +x, about +x towards -y, by the angle of the turn."""
    turn = np.radians(np.linspace(0.0, angle, len(TIME)))
    world = World(bodies=[solid("box", shape("box", 0.2, 0.2, 0.4))])
    to_x = moving(world, TIME, 0.0 * ONE, q=about_axis("y", turn)[:, None])
    to_y = moving(world, TIME, 0.0 * ONE, q=about_axis("x", turn)[:, None])
    end = "eventually[2, 2](tilt_between(box, {}, {} deg, {} deg))"
    assert margin(end.format("x", angle - 3, angle + 9), to_x) == pytest.approx(3.0)
    assert margin(end.format("y", -angle - 3, -angle + 9), to_y) == pytest.approx(3.0)
    assert margin(end.format("x", -angle - 3, -angle + 3), to_x) < 0.0  # the other way is another tilt
    about_itself = moving(world, TIME, 0.0 * ONE, q=about_axis("z", turn)[:, None])
    assert margin("always(tilt_between(box, x, -1 deg, 1 deg))", about_itself) == pytest.approx(1.0)
