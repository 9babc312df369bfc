"""Predicates of contact: gaps, loads, rolling and collisions of balls and boxes."""

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.judge.language.conftest import G, about_axis, moving, shape, solid, still, times
from tests.judge.theory import RADIUS, ball, bouncing, ground, record, with_world
from wsim.geometry.surfaces import box_surface
from wsim.judge.evidence.evidence import Evidence
from wsim.judge.evidence.recorded import MissingError
from wsim.judge.language import Signals, evaluate, parse
from wsim.recording.contacts import ContactTrack
from wsim.scene.world import Shape, Static, World

RATE = 100.0
TIME = times(1.0, RATE)
ONE = np.ones((len(TIME), 3))
X, Z = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
REACH = 0.02 * 0.2 + G / RATE**2 / 8  # within which a ball or box of 0.2 m touches [m]


def margin(text, signals, world=0):
    return evaluate(parse(text), signals).margin[world]


def ball_and_box(world, ball, box=(0.0, 3.0, 0.2), **given):
    return moving(world, TIME, ONE * ball, ONE * box, **given)


def test_what_is_struck_twice_within_a_frame_has_touched_what_struck_it():
    """Balls in a row, 6 % of their radius apart: each passes its speed of 1.5 m/s on to the next, of equal mass."""
    t, speed, apart = times(0.3, 60.0), 1.5, 0.06 * RADIUS
    start = np.arange(3) * (2.0 * RADIUS + apart) - [0.1, 0.0, 0.0]
    hits = np.array([0.1 + apart, 0.1 + 2.0 * apart]) / speed
    since, until = np.array([0.0, *hits]), np.array([*hits, np.inf])
    place, velocity = np.zeros((2, len(t), 3, 3))
    place[..., 0] = start + speed * (np.clip(t[:, None], since, until) - since)
    velocity[..., 0] = speed * ((t[:, None] >= since) & (t[:, None] < until))
    row = with_world(record([ball(name) for name in "abc"], place, velocity, t), gravity=(0.0, 0.0, 0.0))
    frame = np.searchsorted(t, hits)
    assert frame[0] == frame[1]  # within which both blows are
    by_ways = Signals.of(Evidence(row))
    sums = np.zeros((2, 16), dtype=np.float32)
    sums[:, 3] = speed * row.world.bodies[0].mass
    contacts = ContactTrack(frame.astype(np.int32), np.array([(0, 1), (1, 2)], dtype=np.int32), sums)
    as_recorded = Signals.of(Evidence(replace(row, contacts=contacts)))
    for pair in ("a, b", "b, c"):
        assert margin(f"touches({pair})", by_ways) < 0.0  # on from the frame before and back from the next they miss
        assert margin(f"touches({pair})", as_recorded) > 0.0
        assert margin(f"never_touches({pair})", as_recorded) < 0.0  # 0 would hold
    assert margin("collides_with(a, b)", by_ways) < 0.0 < margin("collides_with(a, b)", as_recorded)
    assert margin("touches(a, c)", as_recorded) < 0.0


@pytest.mark.parametrize("recorded", [True, False])
def test_what_presses_on_nothing_touches_nothing_where_contacts_are_recorded(recorded):
    """A ball hangs 1 mm over the ground: half of a hundredth of its size."""
    t = times(1.0)
    hung = record([ball()], np.tile([0.0, 0.0, RADIUS + 1e-3], (len(t), 1)), np.zeros((len(t), 3)), t,
                  statics=[ground()])  # fmt: skip
    none = ContactTrack(np.zeros(0, np.int32), np.zeros((0, 2), np.int32), np.zeros((0, 16), np.float32))
    signals = Signals.of(Evidence(replace(hung, contacts=none if recorded else None)))
    assert evaluate(parse("touches(ball, ground)"), signals).satisfied[0] != recorded
    assert evaluate(parse("touches(ball, ground, 2 mm)"), signals).satisfied[0]


def test_touches_and_never_touches_are_the_gap(tank_world):
    # 1 m/s towards the wall, whose face is at 1 m: the ball's front gets from 0.1 to 0.95 m, 0.05 m before it.
    near = ball_and_box(tank_world, (0.85 * TIME)[:, None] * X + 0.5 * Z)
    assert margin("touches(ball, wall, 0.06 m)", near) == pytest.approx(0.01)
    assert margin("touches(ball, wall, 0.04 m)", near) == pytest.approx(-0.01)
    assert margin("never_touches(ball, wall)", near) == pytest.approx(0.05, abs=1e-7)
    assert margin("never_touches(ball, wall, clearance 8 cm)", near) == pytest.approx(-0.03)
    # As far as a way between frames is known: 2 % of 0.85 m/s.
    assert margin("touches(ball, wall)", near) == pytest.approx(0.02 * 0.85 / RATE + REACH - 0.05)
    into = ball_and_box(tank_world, [0.92, 0.0, 0.5])
    assert margin("never_touches(ball, wall)", into) == pytest.approx(-0.02, abs=1e-7)
    assert margin("touches(ball, wall)", into) == pytest.approx(0.02 + REACH)


def against_a_wall(world, start, restitution, rate=30.0, speed=5.8, face=1.0):
    """A ball of 0.1 m that comes at a wall, and goes back from it; its least gap to it at a frame [m]."""
    t = times(0.5, rate)
    hit = (face - 0.1 - start) / speed
    x = np.where(t < hit, start + speed * t, face - 0.1 - restitution * speed * (t - hit))
    v = np.zeros((len(t), 2, 3))
    v[:, 0, 0] = np.where(t < hit, speed, -restitution * speed)
    world = world.model_copy(update={"gravity": (0.0, 0.0, 0.0)})
    signals = moving(world, t, x[:, None] * X + 0.5 * Z, np.ones((len(t), 3)) * [0.0, 3.0, 0.2], v=v)
    return signals, float((face - 0.1 - x).min())


@pytest.mark.parametrize("restitution", [0.2, 0.6, 1.0])
@pytest.mark.parametrize("start", [-0.05, 0.0, 0.02, 0.1])
def test_a_blow_between_two_frames_is_a_touch(tank_world, start, restitution):
    """At 5.8 m/s a ball goes 194 mm a frame: at every frame it is clear of the wall that it hits."""
    signals, gap = against_a_wall(tank_world, start, restitution)
    assert gap > 0.001
    assert margin("never_touches(ball, wall)", signals) == pytest.approx(0.0, abs=1e-6)
    assert margin("touches(ball, wall)", signals) > 0.0
    assert evaluate(parse("collides_with(ball, wall)"), signals).satisfied[0]


@pytest.mark.parametrize("before", [0.04, 0.1])
def test_what_is_thrown_back_before_a_wall_never_touched_it(tank_world, before):
    """It bounces off something else, so far before the wall: the way that it would have made counts for nothing."""
    signals, gap = against_a_wall(tank_world, 0.0, 0.6, face=1.0 - before)
    assert gap + before < 0.194  # within a frame's way
    assert margin("never_touches(ball, wall)", signals) == pytest.approx(before, abs=1e-6)
    assert not evaluate(parse("touches(ball, wall)"), signals).satisfied[0]


def test_parting_at_4_cm_is_no_touch(tank_world):
    parting = ball_and_box(tank_world, (0.86 - 5.8 * TIME)[:, None] * X + 0.5 * Z)
    assert not evaluate(parse("touches(ball, wall)"), parting).satisfied[0]


def pushed(held, away, speed=0.5, rate=60.0):
    """A block a of 0.2 m that goes along with b before it for some seconds; then b slides on ahead, a stops."""
    t = times(2.0, rate)
    world = World(bodies=[solid(name, shape("box", 0.2, 0.2, 0.2)) for name in "ab"])
    leaves = (t > held) & away
    a = np.where(leaves, speed * held, speed * t)
    b = 0.2 + speed * t
    v = np.zeros((len(t), 2, 3))
    v[:, 0, 0], v[:, 1, 0] = np.where(leaves, 0.0, speed), speed
    return moving(world, t, a[:, None] * X, b[:, None] * X, v=v)


def test_a_push_is_no_blow_and_a_blow_no_push():
    long = pushed(1.0, away=True)
    assert evaluate(parse("pushes(a, b)"), long).satisfied[0]
    assert margin("pushes(a, b, 0.5 s)", long) == pytest.approx(0.5, abs=2.0 / 60.0)
    assert not evaluate(parse("pushes(a, b, 1.2 s)"), long).satisfied[0]
    assert not evaluate(parse("pushes(b, a)"), long).satisfied[0]  # b is ahead of a
    # That the two part at 0.5 m/s is no blow: nothing came at anything.
    assert not evaluate(parse("collides_with(a, b)"), long).satisfied[0]
    still_ = pushed(1.0, away=False, speed=0.0)
    assert not evaluate(parse("pushes(a, b)"), still_).satisfied[0]  # it moves nothing


def test_the_gap_of_turned_boxes_is_from_corner_to_face():
    world = World(bodies=[solid("a", shape("box", 1.0, 1.0, 1.0)), solid("b", shape("box", 1.0, 1.0, 1.0))])
    q = np.zeros((len(TIME), 2, 4))
    q[:, 0, 3] = 1.0
    q[:, 1] = about_axis("z", np.full(len(TIME), math.pi / 4))
    signals = moving(world, TIME, 0.0 * ONE, ONE * X * 1.5, q=q)
    assert margin("never_touches(a, b)", signals) == pytest.approx(1.5 - 0.5 - math.sqrt(0.5))
    assert margin("never_touches(b, a)", signals) == pytest.approx(1.5 - 0.5 - math.sqrt(0.5))


def test_what_cannot_touch_is_no_silent_success():
    mesh = Shape(prim="/m", kind="mesh", size=(1.0, 1.0, 1.0), vertices=[(0, 0, 0), (1, 0, 0), (0, 1, 0)])
    ghost = shape("sphere", 0.1, collides=False)
    world = World(bodies=[solid("a", mesh), solid("b", mesh), solid("ghost", ghost)])
    signals = moving(world, TIME, 0.0 * ONE, 5.0 * ONE, 9.0 * ONE)
    for text, why in (("never_touches(a, b)", "both a mesh"), ("never_touches(a, ghost)", "nothing that collides"),
                      ("never_touches(a, a)", "named twice")):  # fmt: skip
        with pytest.raises(MissingError, match=why):
            evaluate(parse(text), signals)


@pytest.mark.parametrize(
    ("height", "speed", "expected"), [(0.21, 0.0, 0.02 - 0.01), (0.25, 0.0, 0.02 - 0.05), (0.17, 0.0, 0.02 - 0.03)]
)
def test_rests_on_is_a_gap_from_above(tank_world, height, speed, expected):
    # The box is 0.4 m high: 5 % is 0.02 m.
    signals = ball_and_box(tank_world, [3.0, 0.0, 0.1], [0.0, 0.0, height], v=np.full(3, speed))
    found = evaluate(parse("rests_on(box, ground)"), signals)
    assert min(found.robustness[0], 1.0) == pytest.approx(expected / 0.02)


def test_rests_on_wants_it_over_the_other_and_still(tank_world):
    over = ball_and_box(tank_world, [0.05, 0.0, 0.5], [0.0, 0.0, 0.2])
    assert evaluate(parse("rests_on(ball, box)"), over).satisfied[0]
    beside = ball_and_box(tank_world, [0.25, 0.0, 0.5], [0.0, 0.0, 0.2])
    assert not evaluate(parse("rests_on(ball, box)"), beside).satisfied[0]
    # 5 % of sqrt(g L), L = 0.2 m, is 0.07 m/s; together they may move as they like.
    for slip, holds in ((0.06, True), (0.08, False)):
        v = np.zeros((len(TIME), 2, 3))
        v[:, 0, 0], v[:, 1, 0] = 1.0 + slip, 1.0
        found = evaluate(parse("rests_on(ball, box)"), ball_and_box(tank_world, [0.05, 0, 0.5], [0, 0, 0.2], v=v))
        assert found.satisfied[0] == holds
        if not holds:
            assert found.units == ["m/s"] and found.margin[0] == pytest.approx(0.05 * math.sqrt(0.2 * G) - slip)


def post(form: str) -> tuple[Shape, float]:
    """What stands still, and how high it is at its origin: a bar laid on its side, a pill, a slab off its origin."""
    if form == "bar":  # upright it is 1 m high
        q = (math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5))
        return shape("box", 0.3, 0.3, 1.0, position=(0.0, 0.0, 0.15), rotation=q), 0.3
    if form == "pill":
        return shape("capsule", 0.2, 0.6, position=(0.0, 0.0, 0.5)), 1.0
    slab = box_surface((1.0, 3.0, 0.2))
    corners = (slab.vertices + np.array([0.0, 0.0, 0.1])).tolist()
    return shape("mesh", 1.0, 3.0, 0.2, vertices=corners, triangles=slab.triangles.tolist()), 0.2


@pytest.mark.parametrize(("form", "beside"), [("bar", 0.4), ("pill", 0.0), ("slab", 1.4)])
def test_rests_on_what_is_turned_capped_or_a_mesh(tank_world, form, beside):
    still_shape, top = post(form)
    world = tank_world.model_copy(update={"statics": [still("post", still_shape)]})
    on, into_it = ([0.0, beside, top + 0.1 - sunk] for sunk in (0.0, 0.05))
    found = evaluate(parse("rests_on(ball, post)"), ball_and_box(world, on))
    assert found.robustness[0] == pytest.approx(1.0)  # the whole of its limit is left
    assert margin("rests_on(ball, post)", ball_and_box(world, into_it)) == pytest.approx(0.05 * 0.2 - 0.05)
    off = [0.0, 1.6, top + 0.1]
    assert not evaluate(parse("rests_on(ball, post)"), ball_and_box(world, off)).satisfied[0]


@pytest.mark.parametrize(("height", "rests"), [(0.52, True), (1.02, True), (0.1, False), (0.75, False)])
def test_rests_on_is_the_board_that_is_below(tank_world, height, rests):
    boards = [shape("box", 1.0, 1.0, 0.04, position=(0.0, 0.0, z)) for z in (0.5, 1.0)]
    look = shape("box", 2.0, 2.0, 3.0, collides=False)  # what is seen of it carries nothing
    shelf = Static(prim="/World/shelf", shapes=[look, *boards], line="program.py:1")
    world = tank_world.model_copy(update={"statics": [shelf]})
    found = evaluate(parse("rests_on(ball, shelf)"), ball_and_box(world, [0.3, 0.0, height + 0.1]))
    assert found.satisfied[0] == rests


def test_supported_by_is_the_load_of_what_it_touches(tank_world):
    for share, holds in ((1.0, True), (0.51, True), (0.49, False)):
        force = np.zeros((len(TIME), 2, 3))
        force[:, 1, 2] = share * 2.0 * G  # the box weighs 2 kg
        signals = ball_and_box(tank_world, [3.0, 0.0, 0.1], [0.0, 0.0, 0.2], force=force)
        found = evaluate(parse("supported_by(box, ground)"), signals)
        assert found.satisfied[0] == holds
        if found.units == ["N"]:
            assert found.margin[0] == pytest.approx((share - 0.5) * 2.0 * G)
    assert found.units == ["N"]
    # Carried, but not by that; and pressed down.
    aloft = ball_and_box(tank_world, [3.0, 0.0, 0.1], [0.0, 0.0, 1.2], force=2.0 * G * Z)
    assert margin("supported_by(box, ground)", aloft) == pytest.approx(REACH - 1.0)
    pressed = ball_and_box(tank_world, [3.0, 0.0, 0.1], [0.0, 0.0, 0.2], force=-2.0 * G * Z)
    assert not evaluate(parse("supported_by(box, ground)"), pressed).satisfied[0]
    assert margin("supported_by(box, ground, share 0.9)", ball_and_box(
        tank_world, [3.0, 0.0, 0.1], [0.0, 0.0, 0.2], force=1.9 * G * Z)) == pytest.approx(0.1 * G)  # fmt: skip


def test_supported_by_knows_each_worlds_mass(tank_world):
    force = np.full((3, len(TIME), 2, 3), 0.0)
    force[..., 2] = 2.0 * G
    mass = np.array([[1.0, 2.0], [1.0, 8.0], [1.0, 3.0]])
    paths = [np.broadcast_to(place, (3, len(TIME), 3)) for place in ([3.0, 0.0, 0.1], [0.0, 0.0, 0.2])]
    signals = moving(tank_world, TIME, *paths, force=force, mass=mass)
    found = evaluate(parse("supported_by(box, ground)"), signals)
    assert found.satisfied.tolist() == [True, False, True]
    assert found.margin[1] == pytest.approx(2.0 * G - 4.0 * G)


def test_settles_is_the_speed_of_the_fastest_point(tank_world):
    # 2 % of sqrt(g L), L = 0.2 m; a turn of 0.2 rad/s moves its outside by 0.02 m/s.
    limit = 0.02 * math.sqrt(0.2 * G)
    spin = ball_and_box(tank_world, [0.0, 0.0, 0.1], v=np.zeros(3), w=0.2 * X)
    assert margin("settles(ball)", spin) == pytest.approx(limit - 0.02)
    fast = ball_and_box(tank_world, [0.0, 0.0, 0.1], v=0.02 * Z, w=0.2 * X)
    assert margin("settles(ball)", fast) == pytest.approx(limit - 0.04)
    assert margin("settles(ball, 0.05 m/s)", fast) == pytest.approx(0.01)


def test_rolls_without_slip_stands_still_where_it_touches(tank_world):
    # v = w x r: a ball of 0.1 m that rolls along +X turns about +Y.
    rest = 0.02 * math.sqrt(0.1 * G)
    for v, w, slip in ((1.0, 10.0, 0.0), (1.0, 9.0, 0.1), (1.0, -10.0, 2.0), (1.0, 0.0, 1.0), (0.0, 10.0, 1.0)):
        signals = ball_and_box(tank_world, [0.0, 0.0, 0.1], v=v * X, w=w * np.array([0.0, 1.0, 0.0]))
        assert margin("rolls_without_slip(ball)", signals) == pytest.approx(0.05 + rest - slip)
    # Turning about the vertical, as a top does, moves nothing where it stands.
    top = ball_and_box(tank_world, [0.0, 0.0, 0.1], v=0 * X, w=10.0 * Z)
    assert evaluate(parse("rolls_without_slip(ball)"), top).satisfied[0]


def test_rolls_on_a_slope():
    slope = math.radians(30.0)
    ramp = shape("box", 4.0, 1.0, 0.1, rotation=tuple(about_axis("y", np.array(slope))))
    world = World(bodies=[solid("ball", shape("sphere", 0.1))], statics=[still("ramp", ramp)])
    down = np.array([math.cos(slope), 0.0, -math.sin(slope)])
    signals = moving(world, TIME, ONE * 0.2, v=down, w=np.array([0.0, 10.0, 0.0]))
    assert margin("rolls_without_slip(ball, ramp)", signals) == pytest.approx(0.05 + 0.02 * math.sqrt(0.1 * G))
    # Against level ground its contact point would be elsewhere.
    assert not evaluate(parse("rolls_without_slip(ball)"), signals).satisfied[0]


def bounce(restitution: float) -> tuple[np.ndarray, np.ndarray]:
    """A ball of 0.1 m that falls from rest and comes back with a share of its speed; contact at 0.3955 s."""
    hit = 0.3955
    start, speed = 0.1 + G * hit**2 / 2, G * hit
    after = TIME - hit
    z = np.where(after < 0, start - G * TIME**2 / 2, 0.1 + restitution * speed * after - G * after**2 / 2)
    v = np.where(after < 0, -G * TIME, restitution * speed - G * after)
    return z[:, None] * Z, v


@pytest.mark.parametrize("restitution", [0.9, 0.5])
def test_collides_with_the_ground_at_its_restitution(tank_world, restitution):
    path, speed = bounce(restitution)
    v = np.zeros((len(TIME), 2, 3))
    v[:, 0, 2] = speed
    until = TIME < 0.39 + 0.06  # it falls again later
    signals = moving(tank_world, TIME[until], path[until], (ONE * [0.0, 3.0, 0.2])[until], v=v[until])
    found = evaluate(parse(f"collides_with(ball, ground, restitution {restitution})"), signals)
    assert found.satisfied[0] and found.moment[0] == pytest.approx(0.3955, abs=1.5 / RATE)
    assert evaluate(parse("collides_with(ball, ground)"), signals).satisfied[0]
    for wrong in (restitution - 0.25, min(restitution + 0.25, 1.0) if restitution < 0.7 else 0.5):
        assert not evaluate(parse(f"collides_with(ball, ground, restitution {wrong})"), signals).satisfied[0]


@pytest.mark.parametrize("rate", [24.0, 60.0])
@pytest.mark.parametrize("restitution", [0.4, 0.7, 0.88])
def test_the_first_clear_blow_shows_the_restitution_however_slow_later_ones_are(restitution, rate):
    recording = bouncing(restitution, 3.0, 1.0, rate)
    signals = Signals.of(Evidence(recording))
    for off, holds in ((-0.105, False), (-0.095, True), (0.095, True), (0.105, False)):
        asked = f"collides_with(ball, ground, restitution {restitution + off})"
        assert evaluate(parse(asked), signals).satisfied[0] == holds
    outcome = evaluate(parse(f"collides_with(ball, ground, restitution {restitution}, within 1 %)"), signals)
    assert outcome.satisfied[0] and np.ptp(outcome.measures[-1].value[0]) == pytest.approx(1.0 + restitution, abs=1e-4)


def test_restitution_is_along_the_normal_whatever_friction_does():
    """Thrown askew, it parts at 0.7 of its speed downwards, and friction takes 2/7 of that along the ground."""
    time, hit, speed = times(0.5, 30.0), 0.21, 3.0
    after = time > hit
    fall = speed + G * (time - hit)
    v = np.stack([np.where(after, 5.0 / 7.0, 1.0) * speed, 0.0 * time, np.where(after, 0.7 * speed - G * (time - hit),
                                                                              -fall)], axis=1)  # fmt: skip
    since = time - hit
    place = np.stack([v[:, 0] * since, 0.0 * time, RADIUS + np.where(after, 0.7, -1.0) * speed * since
                      - G * since**2 / 2], axis=1)  # fmt: skip
    spin = np.stack([0.0 * time, np.where(after, 5.0 / 7.0 * speed / RADIUS, 0.0), 0.0 * time], axis=1)
    signals = Signals.of(Evidence(record([ball()], place, v, time, spin=spin, statics=[ground()])))
    outcome = evaluate(parse("collides_with(ball, ground, restitution 0.7, within 2 %)"), signals)
    assert outcome.satisfied[0] and np.max(outcome.measures[-1].value) == pytest.approx(0.7, abs=1e-4)


def test_what_hits_a_wall_does_not_collide_with_what_it_rolls_on(tank_world):
    x = 0.4 + np.where(TIME < 0.5, TIME, 1.0 - TIME)
    v = np.zeros((len(TIME), 2, 3))
    v[:, 0, 0] = np.where(TIME < 0.5, 1.0, -1.0)
    rolls = ball_and_box(tank_world, np.stack([x, 0.0 * x, 0.1 + 0.0 * x], axis=1), v=v)
    assert evaluate(parse("collides_with(ball, wall, restitution 1)"), rolls).satisfied[0]
    assert not evaluate(parse("collides_with(ball, ground)"), rolls).satisfied[0]


def test_resting_and_flying_are_no_collisions(tank_world):
    rest = ball_and_box(tank_world, [0.0, 0.0, 0.1], v=np.zeros(3))
    found = evaluate(parse("collides_with(ball, ground)"), rest)
    assert not found.satisfied[0] and found.units == ["m/s"]
    by = ball_and_box(tank_world, (3.0 * TIME - 1.5)[:, None] * np.array([0.0, 1.0, 0.0]) + [0.895, 0.0, 0.5])
    assert not evaluate(parse("collides_with(ball, wall)"), by).satisfied[0]


def test_two_balls_collide_by_their_relative_speed():
    world = World(
        gravity=(0.0, 0.0, 0.0),
        bodies=[solid(name, shape("sphere", 0.1)) for name in "ab"],
    )
    hit = 0.5055
    after = np.maximum(TIME - hit, 0.0)[:, None]
    before = np.minimum(TIME - hit, 0.0)[:, None]
    # a comes at 2 m/s and leaves at 0.4, b from rest at 1.6: of equal mass with e = 0.6.
    a, b = (2.0 * before + 0.4 * after) * X, 1.6 * after * X + 0.2 * X
    late = after[:, 0] > 0.0
    v = np.zeros((len(TIME), 2, 3))
    v[:, 0, 0], v[:, 1, 0] = np.where(late, 0.4, 2.0), np.where(late, 1.6, 0.0)
    signals = moving(world, TIME, a, b, v=v)
    found = evaluate(parse("collides_with(a, b, restitution 0.6, within 0.01)"), signals)
    assert found.satisfied[0] and found.moment[0] == pytest.approx(hit, abs=1.0 / RATE)
    assert not evaluate(parse("collides_with(a, b, restitution 0.62, within 0.01)"), signals).satisfied[0]
    assert not evaluate(parse("collides_with(a, b, restitution 0.58, within 0.01)"), signals).satisfied[0]
    assert not evaluate(parse("pushes(a, b)"), signals).satisfied[0]
    # Out of each other's reach the same change of speed is none of theirs.
    apart = moving(world, TIME, a, b + 5.0 * X, v=v)
    assert not evaluate(parse("collides_with(a, b)"), apart).satisfied[0]


@pytest.mark.parametrize(("friction", "holds"), [(0.3, True), (0.22, True), (0.18, False), (0.1, False)])
def test_what_stops_before_a_wall_has_not_touched_it(tank_world, friction, holds):
    """At 2 m/s it goes v^2 / (2 mu g): 1.02 m at 0.2, which is the gap to the wall at 1 m; or it is stopped there."""
    time = times(3.0, 60.0)
    way = np.minimum(time, 2.0 / (friction * G))
    x = 2.0 * way - friction * G * way**2 / 2
    start = 1.0 - 0.1 - 4.0 / (2.0 * 0.2 * G)
    x = np.minimum(start + x, 0.9)  # at the wall it stays
    v = np.where(x < 0.9, 2.0 - friction * G * way, 0.0)
    ball = np.stack([x, 0.0 * x, 0.0 * x + 0.1], axis=1)
    speed = np.zeros((len(time), 2, 3))
    speed[:, 0, 0] = v
    signals = moving(tank_world, time, ball, np.broadcast_to([3.0, 0.0, 0.2], ball.shape), v=speed)
    outcome = evaluate(parse("stops_before(ball, wall)"), signals)
    assert outcome.satisfied[0] == holds
    gap = 0.9 - x[-1]
    assert evaluate(parse(f"stops_before(ball, wall, within {gap + 0.01} m)"), signals).satisfied[0] == holds
    assert not evaluate(parse(f"stops_before(ball, wall, within {max(gap - 0.01, 1e-3)} m)"), signals).satisfied[0]
