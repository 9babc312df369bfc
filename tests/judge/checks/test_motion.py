"""Motion from frame to frame, in the air and in its energy: mechanics passes, each planted fault is found."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.judge.theory import (
    RATE,
    STEP,
    G,
    ask,
    ball,
    bouncing,
    box,
    edited,
    ground,
    only,
    record,
    resting,
    sliding,
    swinging,
    thrown,
    times,
    with_world,
)
from wsim.geometry.rotations import conjugate, multiply, rotate
from wsim.judge.checks.continuity import CheckContinuity
from wsim.judge.checks.energy import CheckEnergy
from wsim.judge.checks.motion import CheckFreeFlight, CheckFreeTurning, CheckGravity
from wsim.rules.planner import plan as make_plan
from wsim.scene.world import Joint, Motor

SOUND = [thrown, resting, lambda: bouncing(0.8), lambda: sliding(0.5 * G), swinging]


@pytest.mark.parametrize("make", SOUND)
def test_sound_motion_passes_all(make):
    for check in (CheckContinuity(), CheckFreeFlight(), CheckFreeTurning(), CheckEnergy()):
        findings = ask(check, make())
        assert [f.message for f in findings if not f.passed] == []


# ---- from frame to frame
def test_a_teleport_for_one_frame_is_found_at_its_frame():
    wrong = edited(resting(), "body_q", (20, 0, 0), 0.03)
    finding = next(f for f in ask(CheckContinuity(), wrong) if not f.passed)
    assert finding.unit == "m" and finding.value == pytest.approx(0.03, rel=1e-3)
    assert finding.limit == pytest.approx(G / RATE**2, rel=1e-2)  # what may fall and be caught within a frame
    assert finding.span == (pytest.approx(19 / RATE), pytest.approx(20 / RATE))
    assert finding.target.kind == "program"


def test_the_limit_of_a_teleport_is_where_it_says():
    limit = G / RATE**2
    for size, passes in ((0.95 * limit, True), (1.05 * limit, False)):
        findings = ask(CheckContinuity(), edited(resting(), "body_q", (20, 0, 1), size))
        assert findings[0].passed == passes


def test_velocities_that_the_places_do_not_follow_are_found():
    wrong = edited(resting(), "body_qd", (slice(10, 30), 0, 0), 1.0)
    assert not ask(CheckContinuity(), wrong)[0].passed


def test_a_turn_for_one_frame_is_found():
    right = resting()
    q = right.body_q.copy()
    q[20, 0, 3:] = [0.0, 0.0, math.sin(math.radians(30)), math.cos(math.radians(30))]
    turn = ask(CheckContinuity(), replace(right, body_q=q))[1]
    assert not turn.passed and turn.value == pytest.approx(math.radians(60), rel=1e-3)
    q[20, 0, 3:] = [0.0, 0.0, math.sin(0.02), math.cos(0.02)]
    assert ask(CheckContinuity(), replace(right, body_q=q))[1].passed


def test_a_body_that_is_moved_by_hand_goes_by_its_velocity_as_well():
    """A lift that starts within a frame is half of its speed's change off; one that jumps, or outruns it, is found."""
    t = times(2.0)
    lift = [box(kinematic=True)]
    speed = np.where(t > 0.51, 0.8, 0.0)
    place, velocity = np.zeros((len(t), 3)), np.zeros((len(t), 3))
    place[:, 2], velocity[:, 2] = 0.8 * np.maximum(t - 0.51, 0.0), speed
    right = record(lift, place, velocity, t)
    assert [f.passed for f in ask(CheckContinuity(), right)] == [True, True, True]
    assert not ask(CheckContinuity(), edited(right, "body_q", (slice(20, None), 0, 0), 0.05))[0].passed
    fast = replace(right, body_qd=right.body_qd * np.float32(1.1))
    assert not all(f.passed for f in ask(CheckContinuity(), fast))


@given(speed=st.floats(2e-3, 0.1), seconds=st.sampled_from([2.0, 10.0]), away=st.sampled_from([0.0, 100.0]))
@settings(max_examples=20, deadline=None)
def test_what_stands_and_drifts_without_a_velocity_is_found(speed, seconds, away):
    """Each frame's way is far within what a fall and a catch would give; their sum is not, wherever it stands."""
    t = times(seconds)
    place = np.stack([away + 0.0 * t, speed * t, 0.1 + 0.0 * t], axis=1)
    findings = ask(CheckContinuity(), record([box()], place, np.zeros_like(place), t, statics=[ground()]))
    assert [f.passed for f in findings] == [True, True, False]
    assert findings[2].value == pytest.approx(speed * seconds, rel=1e-2, abs=1e-4)


@pytest.mark.parametrize("away", [0.0, 10.0])
@pytest.mark.parametrize("seconds", [2.0, 40.0])
def test_the_limit_of_a_drift_grows_with_no_run(seconds, away):
    """A ball that swings to and fro as cosine, by steps of first order: late by half a step of its speed."""
    t = times(seconds)
    place = np.stack([away + 0.3 * np.cos(4.0 * t), 0.0 * t, 0.1 + 0.0 * t], axis=1)
    velocity = np.stack([-1.2 * np.sin(4.0 * (t + STEP / 2)), 0.0 * t, 0.0 * t], axis=1)
    findings = ask(CheckContinuity(), record([ball()], place, velocity, t))
    assert [f.passed for f in findings] == [True, True, True]
    slow = replace(record([ball()], place, 0.97 * velocity + [0.02, 0.0, 0.0], t))
    assert not ask(CheckContinuity(), slow)[2].passed


def driven(shift, toward=0.1):
    """A slider whose drive takes it over within a frame, with no speed at either end."""
    t = times(1.0)
    x = np.where(t > 0.4, shift, 0.0)
    place = np.stack([x, 0.0 * t, 0.1 + 0.0 * t], axis=1)
    slider = Joint(
        prim="/World/slide", kind="prismatic", parent=None, child="/World/box", axis="X", parent_anchor=(0, 0, 0.1),
        child_anchor=(0, 0, 0), drive=Motor(stiffness=1e6, damping=4e3, position=toward),
    )  # fmt: skip
    return record([box()], place, np.zeros_like(place), t, joints=[slider])


def test_a_drive_faster_than_the_frames_may_come_and_go_between_two():
    assert [f.passed for f in ask(CheckContinuity(), driven(0.096))] == [True, True, True]
    assert not ask(CheckContinuity(), driven(-0.096))[0].passed  # away from what it is set to
    slow = with_world(driven(0.096), joints=[])
    assert not ask(CheckContinuity(), slow)[0].passed


# ---- in the air
@pytest.mark.parametrize("factor", [0.8, 1.2])
def test_gravity_a_fifth_off_is_found_in_the_air(factor):
    strange, gravity = ask(CheckFreeFlight(), thrown(g=factor * G))
    assert not strange.passed and strange.value == pytest.approx(0.2 * G, rel=0.01)
    assert not gravity.passed and gravity.value == pytest.approx(factor * G, rel=1e-3)
    assert gravity.expected == pytest.approx(G) and gravity.limit == pytest.approx(G * (1.02 if factor > 1 else 0.98))
    assert gravity.target.parameter == "gravity" and gravity.target.direction == ("lower" if factor > 1 else "raise")


@pytest.mark.parametrize(("factor", "passes"), [(1.015, True), (0.985, True), (1.025, False), (0.975, False)])
def test_gravity_is_known_to_two_per_cent(factor, passes):
    assert ask(CheckFreeFlight(), thrown(g=factor * G))[1].passed == passes


def test_a_push_with_nothing_there_to_push_is_found():
    t = times(1.0)
    right = thrown()
    kick = np.where(t >= 0.5, 1.0, 0.0)
    wrong = edited(right, "body_qd", (slice(None), 0, 1), kick)
    wrong = edited(wrong, "body_q", (slice(None), 0, 1), np.maximum(t - 0.5, 0.0))
    strange = ask(CheckFreeFlight(), wrong)[0]
    assert not strange.passed and strange.time == pytest.approx(0.5) and strange.value == pytest.approx(RATE, rel=0.05)


def test_a_push_that_is_recorded_is_no_mystery():
    pushed = edited(thrown(), "body_qd", (slice(15, None), 0, 1), 1.0)
    impulse = np.zeros((31, 1, 3), dtype=np.float32)
    impulse[15, 0, 1] = 4.0
    told = replace(pushed, applied_impulse=impulse, applied_work=np.zeros((31, 1), dtype=np.float32))
    assert ask(CheckFreeFlight(), told)[0].passed
    assert not ask(CheckFreeFlight(), replace(told, applied_impulse=-impulse))[0].passed


def test_a_bounce_within_a_frame_is_no_mystery_and_one_in_mid_air_is():
    right = bouncing(0.8)
    assert ask(CheckFreeFlight(), right)[0].passed
    raised = edited(right, "body_q", (slice(None), 0, 2), 2.0)
    assert not ask(CheckFreeFlight(), raised)[0].passed


def test_control_that_is_not_recorded_leaves_nothing_to_say():
    assert ask(CheckFreeFlight(), replace(thrown(g=5.0), metadata={"controlled": True})) == []


def tumbling(torque=0.0, seconds=1.0):
    """A brick that flies and tumbles by Euler's equations; from 0.5 s on a torque [N m] along Z works on it."""
    right = thrown(seconds)
    brick = box("ball", (0.4, 0.2, 0.1), 4.0)
    moments = np.diag(np.array(brick.inertia).reshape(3, 3))
    q, spin, momentum = np.array([0.0, 0.0, 0.0, 1.0]), [], np.array([0.05, 0.4, 0.02])
    poses, steps = right.body_q.copy(), 40
    for k in range(len(right.time)):
        poses[k, 0, 3:] = q
        spin.append(rotate(q, rotate(conjugate(q), momentum) / moments))
        for _ in range(steps):
            w = rotate(q, rotate(conjugate(q), momentum) / moments)
            q = q + 0.5 / (RATE * steps) * multiply(np.array([*w, 0.0]), q)
            q /= np.linalg.norm(q)
        momentum = momentum + np.array([0.0, 0.0, torque if right.time[k] >= 0.5 else 0.0]) / RATE
    speeds = right.body_qd.copy()
    speeds[:, 0, 3:] = spin
    return with_world(replace(right, body_q=poses, body_qd=speeds), bodies=[brick])


def test_what_tumbles_in_the_air_keeps_its_angular_momentum():
    finding = only(ask(CheckFreeTurning(), tumbling()))
    assert finding.passed and finding.value < 1e-3
    w = np.linalg.norm(tumbling().body_qd[:, 0, 3:], axis=1)
    assert np.ptp(w) > 0.02 * w.mean()  # it is not the rate that is kept


def test_a_torque_from_nowhere_is_found():
    still = 0.02 * 4.0 * G * math.hypot(0.4, 0.2, 0.1) / 2
    finding = only(ask(CheckFreeTurning(), tumbling(torque=1.5 * still)))
    assert not finding.passed and finding.value == pytest.approx(1.5 * still, rel=0.01)
    assert finding.time >= 0.5 and still < finding.limit < 1.5 * still
    controlled = replace(tumbling(torque=1.5 * still), metadata={"controlled": True})
    assert ask(CheckFreeTurning(), controlled) == []
    landed = edited(tumbling(torque=1.5 * still), "body_q", (slice(None), 0, 2), -3.7)
    assert only(ask(CheckFreeTurning(), landed)).passed  # the ground may have turned it


@pytest.mark.parametrize(("g", "passes"), [(9.78, True), (9.81, True), (9.7, False), (10.0, False), (0.8 * G, False)])
def test_the_world_has_the_earths_gravity(g, passes):
    finding = only(ask(CheckGravity(), with_world(thrown(), gravity=(0.0, 0.0, -g)), make_plan("A ball is thrown")))
    assert finding.passed == passes and finding.value == pytest.approx(g)
    assert finding.target is None or finding.target.suggested == 9.81


def test_gravity_points_down():
    slant = with_world(thrown(), gravity=(9.81 * math.sin(0.05), 0.0, -9.81 * math.cos(0.05)))  # 2.9 degrees
    finding = only(ask(CheckGravity(), slant, make_plan("A ball is thrown")))
    assert not finding.passed and finding.value == pytest.approx(math.degrees(0.05)) and finding.unit == "deg"


def test_elsewhere_gravity_is_the_places():
    moon = make_plan("A ball is thrown").model_copy(update={"prompt": "A ball is thrown on the moon"})
    assert only(ask(CheckGravity(), with_world(thrown(), gravity=(0.0, 0.0, -1.62)), moon)).passed
    assert not only(ask(CheckGravity(), thrown(), moon)).passed
    anywhere = moon.model_copy(update={"prompt": "A ball is thrown in a gravity of 3 m/s^2"})
    assert ask(CheckGravity(), with_world(thrown(), gravity=(0.0, 0.0, -3.0)), anywhere) == []
    assert ask(CheckGravity(), thrown()) == []  # without a plan nobody asked for the Earth's


# ---- energy
def test_a_pendulum_that_gains_two_per_cent_is_found():
    finding = only(ask(CheckEnergy(), swinging(growth=0.005)))  # 2 % in 4 s
    assert not finding.passed
    assert finding.value == pytest.approx(0.02 * 2.0 * G * 0.5 * (1 - math.cos(0.8)), rel=0.2)
    assert finding.prim == "/World/rod" and finding.span[0] < 0.5 < finding.span[1]
    assert ask(CheckEnergy(), swinging(growth=0.0015))[0].passed  # 0.6 %
    most = 0.01 * 2.0 * G * 0.5 * (1 - math.cos(0.8))
    assert ask(CheckEnergy(), swinging())[0].limit == pytest.approx(most, rel=0.005)  # nothing for contacts, or steps
    assert ask(CheckEnergy(), swinging(growth=-0.05))[0].passed  # friction in the hinge


@pytest.mark.parametrize(("restitution", "passes"), [(1.0, True), (0.5, True), (1.05, False)])
def test_a_ball_comes_up_no_higher_than_it_was(restitution, passes):
    assert ask(CheckEnergy(), bouncing(restitution, seconds=1.2))[0].passed == passes


def test_work_that_is_recorded_may_lift_and_work_that_is_not_may_not():
    t = times(2.0)
    zero = np.zeros_like(t)
    rising = record(
        [thrown().world.bodies[0]], np.stack([zero, zero, 1.0 + t], 1), np.stack([zero, zero, zero + 1], 1), t
    )
    assert not ask(CheckEnergy(), rising)[0].passed
    work = np.full((len(t), 1), 4.0 * G / RATE, dtype=np.float32)
    work[0] = 0.0
    impulse = np.zeros((len(t), 1, 3), dtype=np.float32)
    assert ask(CheckEnergy(), replace(rising, applied_work=work, applied_impulse=impulse))[0].passed
    assert not ask(CheckEnergy(), replace(rising, applied_work=0.9 * work, applied_impulse=impulse))[0].passed
    assert ask(CheckEnergy(), replace(rising, metadata={"controlled": True})) == []


def test_what_a_spring_of_a_contact_holds_comes_back():
    """In the midst of a hit a ball is slow and low; its energy is in the contact: force times depth."""
    right = bouncing(0.9, seconds=1.0, rate=100.0)
    hit = int(np.argmin(right.body_q[:, 0, 2]))
    deep = edited(right, "body_qd", (hit, 0, 2), -right.body_qd[hit, 0, 2])
    depth = np.zeros(len(right.time))
    depth[hit] = 0.01
    force = right.contact_force.copy()
    force[hit, 0, 2] = 4.0 * G * 1.0 / 0.01
    told = replace(deep, contact_force=force, scalars={"contact/penetration": depth})
    assert ask(CheckEnergy(), told)[0].passed
    assert not ask(CheckEnergy(), deep)[0].passed


def test_a_contact_that_flips_from_step_to_step_may_give_what_it_hides():
    """A body that stands still and tells of a speed is shaken by its contact; smooth motion hides nothing."""
    right = resting()
    share = np.linspace(0.0, 1.0, len(right.time), dtype=np.float32)
    shaken = edited(right, "body_qd", (slice(None), 0, 0), 0.5 * share)
    assert ask(CheckEnergy(), shaken)[0].passed
    assert not ask(CheckEnergy(), replace(shaken, contact_force=np.zeros_like(right.contact_force)))[0].passed


def test_a_body_that_stays_where_there_is_no_gravity_is_sound():
    """Nothing may move it at all, and nothing does: no limit, and no division by it."""
    t = times(1.0)
    still = with_world(record([box()], np.zeros((len(t), 3)), np.zeros((len(t), 3)), t), gravity=(0.0, 0.0, 0.0))
    with np.errstate(all="raise"):
        assert [f.passed for f in ask(CheckContinuity(), still)] == [True, True, True]
    jumps = edited(still, "body_q", (slice(10, None), 0, 0), 0.01)
    assert [f.passed for f in ask(CheckContinuity(), jumps)] == [False, True]


def test_what_goes_far_by_hand_rounds_at_each_step():
    """A plate at a constant 4 m/s, added up in single precision as the simulator does, 20 m from the origin."""
    t = times(3.0)
    steps, place = round(t[1] / STEP), [np.float32(20.0)]
    for _ in range(steps * (len(t) - 1)):
        place.append(np.float32(place[-1] - np.float32(4.0 * STEP)))
    track = np.zeros((len(t), 3))
    track[:, 0] = place[::steps]
    way = record([box(kinematic=True)], track, np.tile([-4.0, 0.0, 0.0], (len(t), 1)), t)
    assert abs(track[-1, 0] - 8.0) > 1.5e-5
    assert [f.passed for f in ask(CheckContinuity(), way)] == [True, True, True]
    off = replace(way, body_qd=way.body_qd * np.float32(1.001))
    assert not all(f.passed for f in ask(CheckContinuity(), off))


@pytest.mark.parametrize(("order", "passes"), [(1, True), (2, False)])
def test_places_of_first_order_are_a_step_late_only_where_steps_are(order, passes):
    """v += g h, x += v h falls g t h / 2 too far: 22 mm in 4 s."""
    t = times(4.0)
    zero = np.zeros_like(t)
    place = np.stack([zero, zero, 100.0 - 0.5 * G * t * (t + STEP)], axis=1)
    fallen = record([ball()], place, np.stack([zero, zero, -G * t], axis=1), t, metadata={"loose_order": order})
    assert all(finding.passed for finding in ask(CheckContinuity(), fallen)) == passes
