"""Walls, friction and rest: each planted fault of a size is found, and what mechanics does is not."""

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.judge.theory import (
    EDGE,
    RADIUS,
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
    slab,
    sliding,
    thrown,
    times,
    with_world,
)  # fmt: skip
from wsim.judge.checks.contact import CheckSupport, CheckTunnelling
from wsim.judge.checks.forces import CheckForces
from wsim.judge.checks.rest import CheckJitter, CheckRestForce


def shot(speed, height=0.5, wall=0.02, other=None):
    """A ball that flies at a wall in the plane x = 0.05 as if it were not there."""
    t = times(1.0)
    zero = np.zeros_like(t)
    place = np.stack([speed * (t - 0.5), zero, zero + height], axis=1)
    velocity = np.stack([zero + speed, zero, zero], axis=1)
    sheet = slab("wall", (wall, 2.0, 1.0), (0.05, 0.0, 0.5))
    return record([ball()], place, velocity, t, statics=[ground(), sheet])


# ---- through walls
def test_a_ball_that_is_through_a_wall_in_a_frame_is_found():
    finding = only(ask(CheckTunnelling(), shot(6.0)))
    assert not finding.passed and finding.prim == "/World/ball" and "/World/wall" in finding.message
    assert finding.span == (pytest.approx(0.5), pytest.approx(0.5 + 1 / RATE))
    assert finding.value == pytest.approx(6.0 / RATE, rel=1e-4)
    assert finding.target.kind == "time step" and finding.target.suggested == pytest.approx(0.25 * 0.02 / 6.0)


@pytest.mark.parametrize("sound", [lambda: shot(6.0, height=1.4), lambda: shot(-0.0), resting, thrown])
def test_over_a_wall_or_at_rest_before_it_nothing_is_passed_through(sound):
    assert only(ask(CheckTunnelling(), sound())).passed


def test_a_ball_that_comes_back_from_a_wall_has_not_passed_it():
    right = shot(6.0)
    x = right.body_q[:, 0, 0]
    back = edited(right, "body_q", (slice(None), 0, 0), -2.0 * np.maximum(x + 0.05, 0.0))
    assert only(ask(CheckTunnelling(), back)).passed


def test_a_ball_that_cuts_a_corner_has_not_passed_it():
    """In by the top and out by the side: it may have gone round the edge between."""
    t = times(1.0)
    zero = np.zeros_like(t)
    place = np.stack([6.0 * (t - 0.5), zero, 1.0 - 3.0 * (t - 0.515)], axis=1)
    corner = record([ball()], place, np.tile([6.0, 0.0, -3.0], (len(t), 1)), t, statics=[
        slab("wall", (0.4, 2.0, 1.0), (-0.15, 0.0, 0.5)),
    ])  # fmt: skip
    assert only(ask(CheckTunnelling(), corner)).passed


def test_two_bodies_that_pass_through_each_other_are_found():
    t = times(1.0)
    x = np.stack([8.0 * (t - 0.51), -8.0 * (t - 0.51)], axis=1)
    place = np.stack([x, 0.0 * x, 0.0 * x + 1.0], axis=2)
    velocity = np.tile([[8.0, 0.0, 0.0], [-8.0, 0.0, 0.0]], (len(t), 1, 1))
    wrong = record([ball(), box(size=(0.1, 0.1, 0.1))], place, velocity, t)
    assert {f.prim for f in ask(CheckTunnelling(), wrong) if not f.passed} & {"/World/ball", "/World/box"}
    missed = edited(wrong, "body_q", (slice(None), 0, 1), 0.5)
    assert only(ask(CheckTunnelling(), missed)).passed


@pytest.mark.parametrize(("beside", "passes"), [(0.25, False), (0.0, True)])
def test_what_stands_beside_a_ball_that_spins_does_not_go_through_it(beside, passes):
    """Seen from a ball that turns by 2.6 rad a frame it goes round it, and the chord of that goes through the ball."""
    t, rate = times(0.5), 2.6 * RATE
    none, along = 0.0 * t, 8.0 * t
    spins = np.stack([along, none, none], 1)
    still = np.stack([along + beside if beside else none + 20.0 / RATE, none, none], 1)
    angle = 0.5 * rate * t
    turn = np.stack([np.stack([none, np.sin(angle), none, np.cos(angle)], 1),
                     np.tile([0.0, 0.0, 0.0, 1.0], (len(t), 1))], 1)  # fmt: skip
    place = np.stack([spins, still], 1)
    velocity = np.gradient(place, t, axis=0)
    found = record([ball(), ball("other")], place, velocity, t, rotation=turn)
    assert any(not finding.passed for finding in ask(CheckTunnelling(), found)) == passes


# ---- friction
@pytest.mark.parametrize("pull", [0.28, 0.02, 0.36, 0.48, 0.52, 0.6, 0.65, 1.0])
def test_a_box_that_slides_is_slowed_as_its_friction_has_it(pull):
    """Friction 4 % off is found; what is left over is how far the force is from the edge of the cone."""
    sound, wrong = ask(CheckForces(), sliding(0.5 * G)), ask(CheckForces(), sliding(pull * G))
    assert all(finding.passed for finding in sound)
    assert not wrong[0].passed
    assert wrong[0].value == pytest.approx(4.0 * G * abs(pull - 0.5) / math.hypot(1.0, 0.5), rel=0.02)


def test_a_table_carries_and_slows_as_far_as_it_goes():
    right = sliding(0.5 * G)
    for middle, passes in ((0.0, True), (-6.5, False)):
        table = slab("table", (12.0, 1.0, 0.1), (middle, 0.0, -0.05))
        on_it = right.world.model_copy(update={"statics": [table]})
        assert ask(CheckForces(), replace(right, world=on_it))[0].passed == passes


# ---- carried
@pytest.mark.parametrize(("share", "passes"), [(1.0, True), (0.95, True), (0.85, False), (1.15, False), (1 / 3, False)])
def test_what_rests_is_carried_by_its_weight(share, passes):
    right = resting()
    finding = only(ask(CheckRestForce(), replace(right, contact_force=np.float32(share) * right.contact_force)))
    assert finding.passed == passes
    assert finding.value == pytest.approx(abs(1 - share) * 4.0 * G, abs=1e-3)
    if not passes:
        assert finding.target.suggested == pytest.approx(share * 4.0, rel=1e-3)


def test_a_fluid_carries_its_share():
    right = resting()
    half = replace(right, contact_force=np.float32(0.5) * right.contact_force)
    impulse = np.zeros((len(half.time), 1, 3), dtype=np.float32)
    impulse[1:, 0, 2] = 0.5 * 4.0 * G / RATE
    work = np.zeros((len(half.time), 1), dtype=np.float32)
    assert not only(ask(CheckRestForce(), half)).passed
    assert only(ask(CheckRestForce(), replace(half, applied_impulse=impulse, applied_work=work))).passed


def test_what_moves_or_is_not_touched_need_not_be_carried():
    assert ask(CheckRestForce(), sliding(0.1 * G, speed=6.0)) == []
    assert ask(CheckRestForce(), thrown()) == []


# ---- trembling
def trembling(amplitude, seconds=2.0):
    right = resting(seconds)
    flips = amplitude * (-1.0) ** np.arange(len(right.time))
    return edited(right, "body_q", (slice(None), 0, 0), flips)


@pytest.mark.parametrize(("share", "passes"), [(0.9, True), (1.1, False), (5.0, False)])
def test_a_body_that_trembles_is_found_from_two_steps_of_gravity_on(share, passes):
    speed = 2.0 * G * STEP  # by the limit
    finding = only(ask(CheckJitter(), trembling(share * speed / RATE / 2.0)))
    assert finding.passed == passes == (finding.target is None) and finding.value == pytest.approx(
        share * speed, rel=0.02
    )


def test_a_tremble_of_two_millimetres_is_found_and_velocities_count_too():
    assert not only(ask(CheckJitter(), trembling(0.002))).passed
    right = resting()
    flips = 0.05 * (-1.0) ** np.arange(len(right.time))
    assert not only(ask(CheckJitter(), edited(right, "body_qd", (slice(None), 0, 2), flips))).passed


@pytest.mark.parametrize("sound", [resting, lambda: sliding(0.5 * G), lambda: bouncing(0.6, 4.0), thrown])
def test_rest_sliding_and_bounces_that_die_away_are_no_tremble(sound):
    assert only(ask(CheckJitter(), sound())).passed


@pytest.mark.parametrize("rate", [0.5, 2.0, 4.0, 6.0])
@pytest.mark.parametrize("speed", [0.02, 0.3])
def test_a_swing_of_many_frames_is_no_tremble(rate, speed):
    """A marble in a gutter of 7 mm swings six times a second, ten frames each."""
    right = resting(2.0)
    t = right.time
    phase = 2.0 * np.pi * rate * t
    reach = speed / (2.0 * np.pi * rate)
    swung = edited(right, "body_q", (slice(None), 0, 0), reach * np.sin(phase))
    swung = edited(swung, "body_qd", (slice(None), 0, 0), speed * np.cos(phase))
    assert only(ask(CheckJitter(), swung)).passed
    flips = 0.05 * (-1.0) ** np.arange(len(t))
    shaken = edited(swung, "body_qd", (slice(None), 0, 0), speed * np.cos(phase) + flips)
    assert not only(ask(CheckJitter(), shaken)).passed


def test_hits_once_in_a_while_are_no_tremble():
    """In each quarter of the window one frame is hit: the second order's median does not see it."""
    right = resting(6.0)
    hit = np.zeros(len(right.time))
    hit[7::15] = 0.2
    assert only(ask(CheckJitter(), edited(right, "body_qd", (slice(None), 0, 2), hit))).passed


def bowled(share=1.0, speed=8.0, spin=0.0):
    """A ball that slides on the ground with a share of the friction that it should have, and is turned by it."""
    t = times(0.5)
    pull, zero = share * 0.5 * G, np.zeros_like(t)
    slip = speed - spin * RADIUS
    on = np.minimum(t, slip / (3.5 * pull)) if pull > 0.0 else t
    v = speed - pull * on
    place = np.stack([speed * t - pull * on * (t - on / 2), zero, zero + RADIUS], axis=1)
    turning = np.stack([zero, spin + 2.5 * pull * on / RADIUS, zero], axis=1)
    force = np.stack([zero - 4.0 * pull * (on == t), zero, zero + 4.0 * G], axis=1)
    velocity = np.stack([v, zero, zero], axis=1)
    return record([ball()], place, velocity, t, spin=turning, force=force, statics=[ground()])


@pytest.mark.parametrize(("share", "passes"), [(1.0, True), (0.95, False), (0.65, False), (0.0, False), (1.4, False)])
def test_a_ball_that_slides_is_slowed_until_it_rolls(share, passes):
    assert all(finding.passed for finding in ask(CheckForces(), bowled(share))) == passes


def test_a_ball_that_rolls_has_no_friction_to_lose():
    assert all(finding.passed for finding in ask(CheckForces(), bowled(spin=8.0 / RADIUS)))


# ---- pressed on by what is there
@pytest.mark.parametrize(
    ("gap", "passes"), [(-0.001, True), (0.0, True), (0.0019, True), (0.0022, False), (0.03, False)]
)
def test_a_body_that_is_carried_by_nothing_is_found(gap, passes):
    wrong = edited(resting(), "body_q", (slice(None), 0, 2), gap)
    finding = only(ask(CheckSupport(), wrong))
    assert finding.passed == passes and finding.value == pytest.approx(max(gap, 0.0), abs=1e-7)
    # A hundredth of its size, and what it falls by in two steps.
    assert finding.limit == pytest.approx(0.01 * EDGE + 4.0 * G * STEP**2, rel=1e-3)
    assert passes or finding.span == (0.0, pytest.approx(2.0))
    assert ask(CheckSupport(), replace(wrong, contact_force=np.zeros_like(wrong.contact_force))) == []


def test_a_body_that_hits_a_wall_between_frames_was_there_a_step_ago():
    hit = shot(6.0)
    frame = int(np.argmin(np.abs(hit.body_q[:, 0, 0] + 0.06 + 6.0 * STEP)))
    force = hit.contact_force.copy()
    force[frame, 0, 0] = -100.0
    near = edited(hit, "body_q", (frame, 0, 0), -0.06 - 6.0 * STEP - hit.body_q[frame, 0, 0])
    assert only(ask(CheckSupport(), replace(near, contact_force=force))).passed
    far = edited(near, "body_q", (frame, 0, 0), -0.1)
    assert not only(ask(CheckSupport(), replace(far, contact_force=force))).passed


# ---- creeping
@pytest.mark.parametrize("speed", [1e-4, 2e-3, 0.01])
def test_a_box_that_creeps_is_found_at_a_tenth_of_a_millimetre_a_second(speed):
    told = edited(resting(), "body_qd", (slice(None), 0, 0), speed)
    wrong = edited(told, "body_q", (slice(None), 0, 0), speed * told.time)
    assert all(finding.passed for finding in ask(CheckForces(), resting()))
    assert not all(finding.passed for finding in ask(CheckForces(), wrong))


def test_what_turns_slowly_with_a_turntable_is_carried():
    """At 0.02 rad/s a box 0.3 m off the axis goes 6 mm/s, and slips over nothing."""
    t = times(2.0)
    angle, zero = 0.02 * t, 0.0 * t
    round_ = 0.3 * np.stack([np.cos(angle), np.sin(angle), zero], axis=1)
    along = 0.006 * np.stack([-np.sin(angle), np.cos(angle), zero], axis=1)
    place = np.stack([np.add(0.0 * round_, (0.0, 0.0, 0.05)), np.add(round_, (0.0, 0.0, 0.2))], axis=1)
    turn = np.stack([zero, zero, np.sin(angle / 2), np.cos(angle / 2)], axis=1)
    recording = record(
        [box("disc", (1.0, 1.0, 0.1), kinematic=True), box()], place, np.stack([0.0 * along, along], axis=1), t,
        rotation=np.stack([turn, turn], axis=1), spin=np.tile([0.0, 0.0, 0.02], (len(t), 2, 1)),
    )  # fmt: skip
    assert all(finding.passed for finding in ask(CheckForces(), recording))


@pytest.mark.parametrize(("spin", "passes"), [(0.5, True), (0.0, False)])
def test_a_ball_that_rolls_slowly_does_not_creep_and_one_that_slips_does(spin, passes):
    t = times(2.0)
    place = np.stack([0.5 * RADIUS * t, 0.0 * t, RADIUS + 0.0 * t], axis=1)
    turning, force = np.tile([0.0, spin, 0.0], (len(t), 1)), np.tile([0.0, 0.0, 4.0 * G], (len(t), 1))
    rolls = record([ball()], place, np.gradient(place, t, axis=0), t, spin=turning, force=force, statics=[ground()])
    assert all(finding.passed for finding in ask(CheckForces(), rolls)) == passes


@pytest.mark.parametrize("after", [1.02, 1.1, 1.3])
def test_a_box_that_stops_within_the_last_second_does_not_creep(after):
    """From 1 s on it goes some more millimetres under a friction far above the least in the world, and stands."""
    stopping = sliding(0.5 * G, speed=0.5 * G * after)
    slippery = slab("ice", (1.0, 1.0, 0.1), (0.0, 9.0, -0.05))
    slippery.shapes[0].friction = 0.05
    statics = [*stopping.world.statics, slippery]
    assert all(finding.passed for finding in ask(CheckForces(), with_world(stopping, statics=statics)))


def test_a_box_on_a_cart_is_carried():
    t = times(2.0)
    zero = np.zeros_like(t)
    place = np.stack([np.stack([0.2 * t, zero, zero + z], axis=1) for z in (0.1, 0.3)], axis=1)
    velocity = np.tile([[0.2, 0.0, 0.0]] * 2, (len(t), 1, 1))
    force = np.tile([[0.0, 0.0, 4.0 * G]] * 2, (len(t), 1, 1))
    both = record([box("cart", kinematic=True), box("load")], place, velocity, t, force=force, statics=[ground()])
    assert all(finding.passed for finding in ask(CheckForces(), both))
    assert math.isclose(both.body_q[-1, 1, 0], 0.4, rel_tol=1e-6)
