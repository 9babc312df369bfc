"""Predicates of a whole motion: pendulums against their differential equation, and what is conserved."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tests.judge.language.conftest import G, about_axis, moving, shape, solid, times
from tests.judge.theory import bouncing
from wsim.judge.evidence.evidence import Evidence
from wsim.judge.evidence.pendulum import pivot_of, swing_stretch
from wsim.judge.language import Signals, evaluate, parse
from wsim.scene.world import Joint, World


def margin(text, signals):
    return evaluate(parse(text), signals).margin[0]


ARM, RADIUS = 1.0, 0.1


def pendulums(*amplitudes: float, duration: float = 8.0, mass: float = 1.0) -> Signals:
    """A ball on a rigid massless rod of 1 m about the axis Y through (2, 0, 3), let go at each angle [rad]."""
    time = times(duration, 60.0)
    inertia = 0.4 * RADIUS**2 + ARM**2  # of 1 kg about the hinge
    angles, rates = [], []
    for amplitude in amplitudes:
        found = solve_ivp(
            lambda t, y: [y[1], -G * ARM / inertia * math.sin(y[0])], (0, duration), [amplitude, 0.0],
            t_eval=time, rtol=1e-10, atol=1e-12,
        )  # fmt: skip
        angles.append(found.y[0])
        rates.append(found.y[1])
    angle, rate = np.array(angles), np.array(rates)
    arm = np.stack([-np.sin(angle), np.zeros_like(angle), -np.cos(angle)], axis=-1)
    spin = np.stack([np.zeros_like(rate), rate, np.zeros_like(rate)], axis=-1)
    world = World(bodies=[solid("bob", shape("sphere", RADIUS), mass)])
    return moving(
        world, time, np.array([2.0, 0.0, 3.0]) + ARM * arm, q=about_axis("y", angle)[:, :, None],
        v=np.cross(spin, ARM * arm)[:, :, None], w=spin[:, :, None],
    )  # fmt: skip


def test_the_period_at_an_amplitude_is_the_elliptic_one():
    # The series of T / T0 = 1 + a^2 / 16 + 11 a^4 / 3072 + 173 a^6 / 737280.
    a = math.radians(60.0)
    series = 1 + a**2 / 16 + 11 * a**4 / 3072 + 173 * a**6 / 737280 + 22931 * a**8 / 1321205760
    assert swing_stretch(a) == pytest.approx(series, rel=1e-5)
    assert swing_stretch(0.0) == 1.0


def test_the_pivot_is_what_the_body_turns_about():
    signals = pendulums(0.3, 1.0)
    pivot, axis = pivot_of(signals.centre("bob"), signals.qd("bob")[..., :3], signals.qd("bob")[..., 3:])
    assert pivot == pytest.approx(np.array([[2.0, 0.0, 3.0]] * 2), abs=1e-6)
    assert np.abs(axis) == pytest.approx(np.array([[0.0, 1.0, 0.0]] * 2), abs=1e-9)


def test_swings_with_the_period_of_theory_at_any_amplitude():
    signals = pendulums(0.1, 0.8, 1.5)
    found = evaluate(parse("swings(bob)"), signals)
    assert found.satisfied.all() and (found.robustness > 0.97).all()
    expected = found.measures[0].expected
    small = 2 * math.pi * math.sqrt((1.0 + 0.4 * RADIUS**2) / G)
    assert np.ravel(expected) == pytest.approx(small * swing_stretch(np.array([0.1, 0.8, 1.5])), rel=1e-4)


def test_a_bob_that_is_fixed_to_its_rod_swings_as_both():
    """A ball of 1 kg at the end of a thin rod of 2 kg: I = 2 L^2 / 3 + (2 / 5 r^2 + L^2), m d = 2 L / 2 + 1 L."""
    time, amplitude = times(8.0, 60.0), 0.5
    inertia, moment = 2.0 * ARM**2 / 3.0 + 0.4 * RADIUS**2 + ARM**2, 2.0 * ARM / 2.0 + ARM
    found = solve_ivp(
        lambda t, y: [y[1], -G * moment / inertia * math.sin(y[0])], (0, 8.0), [amplitude, 0.0], t_eval=time,
        rtol=1e-10, atol=1e-12,
    )  # fmt: skip
    arm = np.stack([-np.sin(found.y[0]), 0.0 * time, -np.cos(found.y[0])], axis=-1)
    spin = np.stack([0.0 * time, found.y[1], 0.0 * time], axis=-1)
    about = 2.0 * ARM**2 / 12.0
    rod = solid("rod", shape("box", 0.01, 0.01, ARM), 2.0, inertia=(about, 0, 0, 0, about, 0, 0, 0, 1e-4))
    hold = Joint(prim="/World/hold", kind="fixed", parent="/World/rod", child="/World/bob")
    for joints, swings in (([hold], True), ([], False)):
        world = World(bodies=[solid("bob", shape("sphere", RADIUS)), rod], joints=joints)
        v = np.stack([np.cross(spin, length * arm) for length in (ARM, ARM / 2)], axis=1)
        places = (np.array([2.0, 0.0, 3.0]) + length * arm for length in (ARM, ARM / 2))
        both = moving(world, time, *places, q=about_axis("y", found.y[0])[:, None], v=v, w=spin[:, None])
        outcome = evaluate(parse("swings(bob)"), both)
        assert outcome.satisfied[0] == swings
        small = 2 * math.pi * math.sqrt(inertia / (G * moment))
        assert not swings or outcome.measures[0].expected[0, 0] == pytest.approx(
            small * float(swing_stretch(amplitude)), rel=1e-3
        )


def test_a_pendulum_in_another_gravity_does_not_swing_as_it_should():
    signals = pendulums(0.3)
    signals.world = signals.world.model_copy(update={"gravity": (0.0, 0.0, -G * 1.2)})
    found = evaluate(parse("swings(bob)"), signals)
    assert not found.satisfied[0] and found.units == ["s"]


def test_swings_with_a_period_and_an_amplitude_that_are_asked():
    signals = pendulums(math.radians(20.0))
    small = 2 * math.pi * math.sqrt((1.0 + 0.4 * RADIUS**2) / G)
    period = small * float(swing_stretch(math.radians(20.0)))
    for factor, holds in ((1.0, True), (1.05, False), (0.95, False)):
        text = f"swings(bob, period {period * factor} s, amplitude 20 deg)"
        assert evaluate(parse(text), signals).satisfied[0] == holds
    for degrees, holds in ((20.5, True), (21.0, False), (19.0, False)):
        found = evaluate(parse(f"swings(bob, period {period} s, amplitude {degrees} deg)"), signals)
        assert found.satisfied[0] == holds
        if not holds:
            assert found.units == ["deg"]
            assert found.margin[0] == pytest.approx(0.03 * degrees - abs(20.0 - degrees), abs=0.02)


def test_what_hangs_still_does_not_swing():
    signals = pendulums(0.0)
    assert not evaluate(parse("swings(bob, period 2 s)"), signals).satisfied[0]
    assert evaluate(parse("not swings(bob, period 2 s)"), signals).satisfied[0]
    # Half a second tells nothing of a period of 2 s: neither that it swings nor that it does not.
    short = pendulums(0.3, duration=0.3)
    assert not evaluate(parse("swings(bob)"), short).satisfied[0]
    assert not evaluate(parse("not swings(bob)"), short).satisfied[0]


def test_a_swing_that_dies_is_found_in_its_window():
    signals = pendulums(0.3)
    dying = pendulums(0.3)
    late = signals.time > 5.0
    dying.body_q[:, late] = dying.body_q[:, late][:, :1]
    dying.body_qd[:, late] = 0.0
    period = evaluate(parse("swings(bob)"), signals).measures[0].expected[0, 0]
    assert evaluate(parse(f"always[0, 3](swings(bob, period {period} s))"), dying).satisfied[0]
    assert not evaluate(parse(f"swings(bob, period {period} s)"), dying).satisfied[0]


def test_energy_of_a_pendulum_is_conserved_and_a_gain_of_3_percent_is_not():
    signals = pendulums(0.5, 0.5)
    signals.body_qd[1, -100:] *= math.sqrt(1.03)
    found = evaluate(parse("conserves(energy, bob)"), signals)
    assert found.satisfied.tolist() == [True, False] and found.units == ["J", "J"]
    highest = G * (1 - math.cos(0.5))
    assert found.measures[0].scale[0, 0] == pytest.approx(highest, rel=1e-3)
    gained = 0.03 * (found.measures[0].scale[0, 0] - np.ptp(signals.centre("bob")[1, -1:, 2]))
    assert -gained < found.margin[1] < 0.0
    assert evaluate(parse("conserves(energy, bob, share 4 %)"), signals).satisfied.all()


def test_energy_counts_turning_and_goes_with_mass():
    time = times(1.0, 10.0)
    world = World(gravity=(0.0, 0.0, 0.0), bodies=[solid("a", shape("sphere", 0.5))])
    spin = np.zeros((2, len(time), 1, 3))
    spin[..., 2] = np.where(time < 0.5, 2.0, 1.0)[:, None]
    signals = moving(world, time, np.zeros((2, len(time), 3)), w=spin, mass=np.array([[1.0], [3.0]]))
    found = evaluate(parse("conserves(energy, a, share 0.5)"), signals)
    # I w^2 / 2 with I = 0.4 m r^2 = 0.1 kg m^2: from 0.2 to 0.05 J, of which half may go; three times that with 3 kg.
    assert found.margin == pytest.approx([0.1 - 0.15, 0.3 - 0.45])


def test_turning_energy_is_about_the_bodys_own_axes():
    time = times(1.0, 10.0)
    inertia = (1.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 5.0)
    world = World(gravity=(0.0, 0.0, 0.0), bodies=[solid("a", shape("sphere", 0.5), inertia=inertia)])
    spin = np.zeros((1, len(time), 1, 3))
    spin[..., 0] = 2.0
    # About the world's X: its own X at first, then, turned by 90 degrees about Y, its own Z.
    q = about_axis("y", np.where(time < 0.5, 0.0, math.pi / 2))[:, None]
    signals = moving(world, time, np.zeros((len(time), 3)), w=spin, q=q)
    found = evaluate(parse("conserves(energy, a, share 0.5)"), signals)
    assert found.margin[0] == pytest.approx(0.5 * 10.0 - (10.0 - 2.0))


def collision(restitution: float, other: float = 1.0) -> Signals:
    time = times(1.0, 50.0)
    world = World(bodies=[solid(name, shape("sphere", 0.1), mass) for name, mass in (("a", 1.0), ("b", 2.0))])
    v = np.zeros((len(time), 2, 3))
    late = time > 0.5
    # 1 kg at 3 m/s on 2 kg at rest: the common speed is 1 m/s.
    v[:, 0, 0] = np.where(late, 1.0 - 2.0 * restitution, 3.0)
    v[:, 1, 0] = np.where(late, (1.0 + restitution) * other, 0.0)
    return moving(world, time, np.zeros((len(time), 3)), np.ones((len(time), 3)), v=v)


@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
def test_momentum_is_conserved_whatever_the_restitution(restitution):
    found = evaluate(parse("conserves(momentum, a, b)"), collision(restitution))
    assert found.satisfied[0] and found.units == ["kg m/s"]
    lost = evaluate(parse("conserves(momentum, a, b)"), collision(restitution, other=0.9))
    assert lost.margin[0] == pytest.approx(0.02 * lost.measures[0].scale[0, 0] - 0.2 * (1.0 + restitution))
    assert not evaluate(parse("conserves(momentum, a)"), collision(restitution)).satisfied[0]
    # Energy is only where the collision is elastic.
    assert evaluate(parse("conserves(energy, a, b)"), collision(restitution)).satisfied[0] == (restitution == 1.0)


def test_gravity_takes_no_momentum_sideways():
    time = times(1.0, 50.0)
    world = World(bodies=[solid("a", shape("sphere", 0.1))])
    v = np.zeros((len(time), 1, 3))
    v[:, 0, 0], v[:, 0, 2] = 2.0, -G * time
    signals = moving(world, time, np.zeros((len(time), 3)), v=v)
    assert evaluate(parse("conserves(momentum)"), signals).satisfied[0]
    signals.world = world.model_copy(update={"gravity": (0.0, 0.0, 0.0)})
    assert not evaluate(parse("conserves(momentum)"), signals).satisfied[0]


@pytest.mark.parametrize("ratio", [0.02, 0.1])
def test_a_damped_swing_dies_down_by_its_decrement(ratio):
    """x = exp(-z w t) cos(w t): after each period exp(-2 pi z / sqrt(1 - z^2)) is left of it."""
    time = times(6.0, 100.0)
    damped = math.sqrt(1.0 - ratio**2)
    x = np.exp(-ratio * 5.0 * time) * np.cos(5.0 * damped * time)
    world = World(bodies=[solid("bob", shape("sphere", 0.1))])
    signals = moving(world, time, np.stack([x, 0.0 * x, 0.0 * x], axis=1))
    left = math.exp(-2.0 * math.pi * ratio / damped)
    assert margin("dies_down(bob, x, share 99 %)", signals) == pytest.approx(0.99 - left, abs=0.01)
    assert not evaluate(parse(f"dies_down(bob, x, share {left - 0.05})"), signals).satisfied[0]
    for_ever = moving(world, time, np.stack([np.cos(5.0 * time), 0.0 * x, 0.0 * x], axis=1))
    assert margin("dies_down(bob, x)", for_ever) == pytest.approx(-0.02, abs=0.005)
    assert not evaluate(parse("dies_down(bob, y)"), signals).satisfied[0]  # what stands still has no peaks


@pytest.mark.parametrize("restitution", [0.5, 0.8])
def test_a_bounce_climbs_to_the_square_of_its_restitution(restitution):
    time = times(1.2, 240.0)
    fall = math.sqrt(2.0 / G)
    after = time - fall
    z = np.where(after < 0.0, 1.0 - G * time**2 / 2, restitution * G * fall * after - G * after**2 / 2)
    keep = z >= 0.0
    world = World(bodies=[solid("ball", shape("sphere", 0.05))])
    signals = moving(world, time[keep], np.stack([0.0 * z, 0.0 * z, z + 0.05], axis=1)[keep])
    assert margin(f"climbs_to(ball, {restitution**2 - 0.1})", signals) == pytest.approx(0.1, abs=0.02)
    assert not evaluate(parse(f"climbs_to(ball, {restitution**2 + 0.05})"), signals).satisfied[0]


@pytest.mark.parametrize("rate", [24.0, 30.0, 60.0])
def test_lowest_and_highest_places_are_between_frames(rate):
    """A ball of e = 0.7 comes up to 0.49 of where it fell from, then to 0.24, whatever frames it is seen in."""
    signals = Signals.of(Evidence(bouncing(0.7, 1.6, 1.0, rate)))
    assert margin("climbs_to(ball, 49 %)", signals) == pytest.approx(0.0, abs=1e-4)
    assert margin("dies_down(ball, z, 50 %)", signals) == pytest.approx(0.01, abs=1e-4)


def test_how_far_a_swing_goes_is_between_frames():
    signals = pendulums(math.radians(20.0))
    every = slice(None, None, 3)  # 20 a second
    few = Signals(signals.world, signals.time[every], *(
        each[:, every] for each in (signals.body_q, signals.body_qd, signals.contact_force)))  # fmt: skip
    assert margin("swings(bob, amplitude 20 deg, share 0.1 %)", few) > 0.0
