"""Blows by closed form: bodies part by the restitution that their pair states, or the check says so."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.judge.theory import EDGE, RADIUS, ask, ball, bouncing, box, ground, only, record, times, with_world
from wsim.judge.checks.impacts import CheckRestitution
from wsim.scene.world import Shape


def stated(recording, restitution):
    """The same motion where both surfaces state a restitution."""

    def bouncy(thing):
        shapes = [shape.model_copy(update={"restitution": restitution}) for shape in thing.shapes]
        return thing.model_copy(update={"shapes": shapes})

    world = recording.world
    return with_world(
        recording, bodies=[bouncy(b) for b in world.bodies], statics=[bouncy(static) for static in world.statics]
    )


@given(
    real=st.floats(0.0, 1.0), said=st.floats(0.0, 1.0), height=st.floats(0.3, 5.0), rate=st.sampled_from([24.0, 60.0])
)
@settings(max_examples=25, deadline=None)
def test_a_bounce_is_accepted_where_it_is_as_stated_and_nowhere_else(real, said, height, rate):
    findings = ask(CheckRestitution(), stated(bouncing(real, 1.5, height, rate), said))
    assert all(finding.passed for finding in ask(CheckRestitution(), stated(bouncing(real, 1.5, height, rate), real)))
    # What is to rebound for less than a frame may have bounced twice: no single blow is to be seen.
    approach = np.sqrt(2.0 * 9.81 * height)
    if abs(real - said) >= 0.1 and 2.0 * min(real, said) * approach / 9.81 > 2.0 / rate:
        finding = only(findings)
        assert not finding.passed
        assert finding.value / finding.expected == pytest.approx(real / said, rel=0.06)


def meeting(before, after, mass=4.0, gap=0.5, seconds=1.0):
    """Two balls on a line, weightless, that meet and go on at other speeds."""
    t = times(seconds)
    when = gap / (before[0] - before[1])
    x = [np.where(t < when, start + v * t, start + v * when + u * (t - when))
         for start, v, u in zip((0.0, gap + 2.0 * RADIUS), before, after, strict=True)]  # fmt: skip
    v = [np.where(t < when, a, b) for a, b in zip(before, after, strict=True)]
    place, speed = (np.stack([np.stack([each, 0 * t, 0 * t], axis=1) for each in rows], axis=1) for rows in (x, v))
    recording = record([ball("one", mass), ball("two", mass)], place, speed, t)
    return with_world(recording, gravity=(0.0, 0.0, 0.0))


@pytest.mark.parametrize(("after", "restitution", "sound"), [
    ((0.0, 2.0), 1.0, True), ((0.5, 1.5), 0.5, True), ((1.0, 1.0), 0.0, True),
    ((0.5, 1.5), 0.8, False), ((-0.2, 2.2), 1.0, False), ((1.0, 1.0), 0.5, False), ((0.0, 2.0), 0.5, False),
])  # fmt: skip
def test_two_balls_part_as_their_restitution_has_it(after, restitution, sound):
    finding = only(ask(CheckRestitution(), stated(meeting((2.0, 0.0), after), restitution)))
    assert finding.passed is sound


@pytest.mark.parametrize(("speed", "asked"), [(0.02, 0), (0.03, 1)])
def test_what_meets_by_less_than_a_step_s_fall_is_no_blow(speed, asked):
    """2 g dt, 0.0218 m/s at 1 / 900 s: slower surfaces do not bounce (docs/rigid.md)."""
    met = stated(meeting((speed, 0.0), (0.5 * speed, 0.5 * speed), gap=0.01), 0.5)
    assert [finding.passed for finding in ask(CheckRestitution(), met)] == [False] * asked


def test_what_is_gained_and_what_is_lost_are_told_apart():
    gained, lost = (
        only(ask(CheckRestitution(), stated(meeting((2.0, 0.0), after), 0.5))) for after in ((0.0, 2.0), (0.9, 1.1))
    )
    assert (gained.target.direction, lost.target.direction) == ("lower", "raise")


@pytest.mark.parametrize(("spin", "asked"), [(0.0, 1), (3.0, 0)])
def test_a_box_that_turns_as_it_lands_flat_is_no_single_blow(spin, asked):
    """One edge parts while the other still comes, and the frames do not show which came first."""
    t = times(0.5)
    turning = np.stack([0 * t, spin + 0 * t, 0 * t], axis=1)
    place = np.stack([0 * t, 0 * t, EDGE / 2 + np.where(t < 0.255, 3.0 * (0.255 - t), 0.0)], axis=1)
    speed = np.stack([0 * t, 0 * t, np.where(t < 0.255, -3.0, 0.0)], axis=1)
    recording = record([box()], place, speed, t, spin=turning, statics=[ground()])
    assert len(ask(CheckRestitution(), with_world(recording, gravity=(0.0, 0.0, 0.0)))) == asked


def knocked(real, lean=0.6, speed=3.0):
    """A smooth box that leans about Y, without gravity: one edge meets the ground, and the blow turns it.

    The edge is at (x, z) from the centre; an impulse J there gives J / m up and a spin of -x J / I, and its edge parts
    at e times the approach: J (1 / m + x^2 / I) = (1 + e) u.
    """
    t, when = times(0.3, 60.0), 0.205
    body = box()
    edge = EDGE / 2 * np.array([np.cos(lean) - np.sin(lean), -np.sin(lean) - np.cos(lean)])
    push = (1.0 + real) * speed / (1.0 / body.mass + edge[0] ** 2 / body.inertia[4])
    up, spin = -speed + push / body.mass, -edge[0] * push / body.inertia[4]
    after = t >= when
    z = -edge[1] + np.where(after, up, -speed) * (t - when)
    angle = lean + np.where(after, spin * (t - when), 0.0)
    none = 0.0 * t
    return record(
        [body], np.stack([none, none, z], axis=1), np.stack([none, none, np.where(after, up, -speed)], axis=1), t,
        rotation=np.stack([none, np.sin(angle / 2), none, np.cos(angle / 2)], axis=1),
        spin=np.stack([none, np.where(after, spin, 0.0), none], axis=1), statics=[ground()],
    )  # fmt: skip


@given(real=st.floats(0.1, 1.0), lean=st.floats(0.15, 1.4), said=st.floats(0.0, 1.0))
@settings(max_examples=15, deadline=None)
def test_an_edge_parts_as_its_restitution_has_it(real, lean, said):
    """The point that touches obeys the law, not the centre: by the impulse on an edge."""
    weightless = with_world(knocked(real, lean), gravity=(0.0, 0.0, 0.0))
    sound = only(ask(CheckRestitution(), stated(weightless, real)))
    assert sound.passed
    assert sound.value == pytest.approx(3.0 * real, rel=0.02)
    if abs(real - said) > 0.1:
        assert not only(ask(CheckRestitution(), stated(weightless, said))).passed


@pytest.mark.parametrize("lean", [0.3, 1.15, 1.25, 1.4])
@pytest.mark.parametrize("real", [0.3, 0.6, 1.0])
def test_what_spins_off_a_blow_is_asked_as_closely(real, lean):
    """At up to 40 rad/s; to 0.005 of the approach, where steps change nothing."""
    weightless = with_world(knocked(real, lean), gravity=(0.0, 0.0, 0.0))
    sound = only(ask(CheckRestitution(), stated(weightless, real)))
    assert sound.passed
    for said in (real - 0.007, real + 0.007):
        if said <= 1.0:
            assert not only(ask(CheckRestitution(), stated(weightless, said))).passed


def gripping(share, restitution, lean=0.7, along=0.5, down=2.0, friction=0.6):
    """A rod that leans about Y and grips the ground as it meets it, without gravity; it slips no more.

    Its push alone would turn its slip round: friction P_t gives it P_t v_t / 2. The law takes that from the rebound,
    P_n (v_n' - e v_n) = -P_t v_t; here `share` of it is taken.
    """
    t, when = times(0.3, 60.0), 0.205
    shape = Shape(prim="/World/rod/g", kind="capsule", size=(0.02, 0.5), friction=friction)
    rod = box("rod", size=(0.02, 0.02, 0.5), mass=1.0).model_copy(update={"shapes": [shape]})
    inertia = rod.inertia[4]
    x, z = -0.25 * np.sin(lean), -0.25 * np.cos(lean) - 0.02
    masses = np.linalg.inv([[1.0 + z**2 / inertia, -x * z / inertia], [-x * z / inertia, 1.0 + x**2 / inertia]])
    parting = restitution * down
    for _ in range(100):
        push = masses @ [-along, parting + down]
        parting = restitution * down - share * push[0] * along / push[1]
    assert 0.05 * push[1] < push[0] < friction * push[1]
    since, after = t - when, t >= when
    speed = np.where(after[:, None], np.array([along, -down]) + push, np.array([along, -down]))
    spin = np.where(after, (z * push[0] - x * push[1]) / inertia, 0.0)
    place, angle, none = speed * since[:, None] + [0.0, -z], lean + spin * since, 0.0 * t
    recording = record(
        [rod], np.stack([place[:, 0], none, place[:, 1]], axis=1), np.stack([speed[:, 0], none, speed[:, 1]], axis=1),
        t, rotation=np.stack([none, np.sin(angle / 2), none, np.cos(angle / 2)], axis=1),
        spin=np.stack([none, spin, none], axis=1), statics=[ground(friction)],
    )  # fmt: skip
    return stated(with_world(recording, gravity=(0.0, 0.0, 0.0)), restitution), parting


@pytest.mark.parametrize("restitution", [0.5, 0.8, 1.0])
def test_friction_that_turns_the_slip_round_is_paid_with_the_rebound(restitution):
    """Neither may it give energy (Kane and Levinson 1985), nor may more be missing than it gave."""
    for share, sound in ((1.0, True), (0.0, False), (0.5, False), (2.0, False)):
        recording, parting = gripping(share, restitution)
        finding = only(ask(CheckRestitution(), recording))
        assert finding.passed is sound, (share, finding.message)
        assert finding.value == pytest.approx(parting, rel=0.01)
