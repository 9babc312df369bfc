"""Predicates about the way that a body makes: each against what mechanics says of it, in several worlds at once."""

import math

import numpy as np
import pytest

from tests.judge.language.conftest import G, about_axis, moving, shape, solid, still, times
from wsim.judge.evidence.recorded import MissingError
from wsim.judge.language import evaluate, parse
from wsim.plan.schema.formula import Mean
from wsim.scene.world import Shape, World

TIME = times(2.0)
SLOPE, RADIUS = math.radians(20.0), 0.1
GROUND = still("ground", Shape(prim="/g", kind="plane", size=()))
TURN = tuple(about_axis("y", np.array(SLOPE)).tolist())
RAMP = still("ramp", shape("box", 8.0, 2.0, 0.2, position=(0.0, 0.0, 2.0), rotation=TURN))
ALONG = np.array([math.cos(SLOPE), 0.0, -math.sin(SLOPE)])
NORMAL = np.array([math.sin(SLOPE), 0.0, math.cos(SLOPE)])


def found(text, signals):
    return evaluate(parse(text), signals)


def gone(*ways, **more):
    """A box in several worlds, along x by as much (T,) [m]."""
    box = solid("box", shape("box", 0.2, 0.2, 0.4), 8.0)
    paths = np.stack([np.stack([way, 0.0 * way, 0.2 + 0.0 * way], axis=1) for way in ways])
    return moving(World(bodies=[box], statics=[GROUND]), TIME, paths, **more)


def test_moves_is_the_level_way_and_has_a_direction():
    there_and_back = np.where(TIME < 1.0, TIME, 2.0 - TIME)
    signals = gone(TIME, -TIME, there_and_back)
    assert found("finally[0](moves(box, 1.5 m))", signals).margin == pytest.approx([0.5, 0.5, -1.5])
    assert found("finally[0](moves(box, 1.5 m, front))", signals).margin == pytest.approx([0.5, -3.5, -1.5])
    # By itself it is where it ends, as the kind `moves` has it: what goes on need not have been there for long.
    assert found("moves(box, 1.5 m)", signals).margin == pytest.approx([0.5, 0.5, -1.5])
    assert found("moves(box, 1.9 m, front)", signals).margin == pytest.approx([0.1, -3.9, -1.9])
    assert found("eventually(moves(box, 0.9 m, front))", signals).satisfied.tolist() == [True, False, True]
    # Left open, it is half of its smallest extent; up is no way on the level.
    assert found("eventually(moves(box))", signals).margin == pytest.approx([1.9, 1.9, 0.9])
    rising = gone(0.0 * TIME)
    rising.body_q[..., 2] += TIME[None, :, None]
    assert found("eventually(moves(box))", rising).margin == pytest.approx([-0.1])


def down_the_ramp(acceleration, share=1.0, radius=RADIUS):
    """A ball let go on a ramp of 20 degrees, which turns as fast as a share of its rolling, in worlds (W,)."""
    ball = solid("ball", shape("sphere", radius))
    a = np.atleast_1d(np.asarray(acceleration, dtype=float))[:, None]
    way, speed = 0.5 * a * TIME**2, a * TIME
    path = np.array([0.0, 0.0, 2.0]) + (0.1 + radius) * NORMAL + way[..., None] * ALONG
    spin = np.zeros((*speed.shape, 1, 3))
    spin[..., 0, 1] = share * speed / radius
    v = (speed[..., None] * ALONG)[:, :, None]
    return moving(World(bodies=[ball], statics=[GROUND, RAMP]), TIME, path, v=v, w=spin)


def test_a_ball_rolls_down_by_five_sevenths():
    rolling, sliding = 5.0 / 7.0 * G * math.sin(SLOPE), G * math.sin(SLOPE)
    balls = down_the_ramp([rolling, 0.85 * rolling, sliding])
    assert found("rolls_freely(ball, ramp)", balls).satisfied.tolist() == [True, False, False]
    assert found("rolls_freely(ball, ramp)", balls).measures[0].expected == pytest.approx(rolling)
    assert found("rolls_freely(ball, ramp, share 20 %)", balls).satisfied.tolist() == [True, True, False]
    assert found("goes_down(ball, ramp, 3 m)", balls).margin == pytest.approx(2.0 * np.array(
        [rolling, 0.85 * rolling, sliding]) - 3.0, rel=1e-6)  # fmt: skip
    with pytest.raises(MissingError, match="no ball"):
        found("rolls_freely(box, ramp)", moving(World(bodies=[solid("box", shape("box", 0.2, 0.2, 0.2))],
                                                     statics=[RAMP]), TIME, np.zeros((len(TIME), 3))))  # fmt: skip


@pytest.mark.parametrize(("share", "rolls"), [(1.0, True), (0.6, True), (0.4, False), (0.0, False)])
def test_rolls_is_how_much_of_its_way_its_turning_makes(share, rolls):
    ball = down_the_ramp([3.0], share)
    for text in ("rolls(ball)", "rolls(ball, ramp)"):
        outcome = found(text, ball)
        assert outcome.satisfied[0] == rolls and outcome.margin[0] == pytest.approx(share - 0.5, abs=1e-6)
        assert found(f"not {text}", ball).satisfied[0] != rolls


def test_what_it_meets_below_the_ramp_is_another_story():
    """Over the ramp it rolls; from 1 s on it is carried off to the side, without turning."""
    ball = down_the_ramp([3.0])
    away = TIME > 1.0
    ball.body_q[:, away, 0, 1] += 5.0
    ball.body_qd[:, away, 0, 3:] = 0.0
    assert found("rolls(ball, ramp)", ball).margin[0] == pytest.approx(0.5, abs=0.01)
    # It turns for the first second of two: for a quarter of its way.
    assert found("rolls(ball)", ball).margin[0] == pytest.approx(0.25 - 0.5, abs=0.02)


def test_a_hop_as_it_is_set_down_does_not_end_its_rolling():
    """It comes down without turning, hops by its radius, and rolls after that."""
    ball = down_the_ramp([3.0])
    hops = (TIME > 0.1) & (TIME < 0.2)
    ball.body_q[:, hops, 0, :3] += RADIUS * NORMAL
    ball.body_qd[:, TIME < 0.2, 0, 3:] = 0.0
    assert found("rolls(ball, ramp)", ball).margin[0] == pytest.approx(0.5, abs=0.01)


def test_a_wheel_rolls_on_its_radius_however_thin_it_is():
    wheel = solid("ball", shape("cylinder", RADIUS, RADIUS / 5))
    rolling = down_the_ramp([3.0])
    rolling = moving(World(bodies=[wheel], statics=[GROUND, RAMP]), TIME, rolling.body_q[0, :, 0, :3],
                     v=rolling.body_qd[..., :3], w=rolling.body_qd[..., 3:])  # fmt: skip
    assert found("rolls(ball)", rolling).margin[0] == pytest.approx(0.5, abs=0.01)


def thrown(lands=2.0, off=0.0):
    """A ball thrown up, that touches something at a time, and drifts off its parabola by as much a second squared."""
    ball = solid("ball", shape("sphere", RADIUS), velocity=(2.0, 0.0, 8.0))
    zero = 0.0 * TIME
    path = np.stack([2.0 * TIME, off * TIME**2, 3.0 + 8.0 * TIME - G * TIME**2 / 2], axis=1)
    v = np.stack([2.0 + zero, 2.0 * off * TIME, 8.0 - G * TIME], axis=1)
    force = np.where(TIME[:, None] > lands, np.array([0.0, 0.0, 5.0]), 0.0)
    return moving(World(bodies=[ball], statics=[GROUND]), TIME, path, v=v[None, :, None], force=force[None, :, None])


@pytest.mark.parametrize(("lands", "longest"), [(2.0, 2.0), (1.5, 1.5), (0.05, 1.0 / 30.0)])
def test_a_flight_lasts_until_the_first_touch(lands, longest):
    outcome = found("flies(ball)", thrown(lands))
    assert outcome.margin[0] == pytest.approx(longest - 0.1, abs=1e-6) and outcome.units == ["s"]


def test_a_jolt_between_two_frames_ends_a_flight():
    ball = thrown()
    at = 1.0 + 0.4 / 30.0
    ball.body_qd[:, TIME > 1.0, 0, 0] = -2.0
    ball.body_q[:, TIME > 1.0, 0, 0] = 2.0 * at - 2.0 * (TIME[TIME > 1.0] - at)
    assert found("flies(ball)", ball).margin[0] == pytest.approx(at - 0.1, abs=1e-6)


@pytest.mark.parametrize(("off", "holds"), [(0.0, True), (0.03, True), (0.1, False)])
def test_what_falls_freely_keeps_to_its_parabola(off, holds):
    speed = np.hypot(2.0, 8.0 - G * TIME)
    way = float(np.sum((speed[1:] + speed[:-1]) / 2 * np.diff(TIME)))
    outcome = found("falls_freely(ball)", thrown(off=off))
    assert outcome.satisfied[0] == holds
    assert outcome.margin[0] == pytest.approx(0.02 * way - 4.0 * off, abs=2e-3)
    assert found("falls_freely(ball, within 5 cm)", thrown(off=off)).margin[0] == pytest.approx(0.05 - 4.0 * off)
    # What comes after the flight is not one of it.
    assert found("falls_freely(ball, within 5 cm)", thrown(lands=0.7, off=off)).satisfied[0]


def test_drops_is_a_share_of_its_height():
    box = gone(0.0 * TIME, 0.0 * TIME)
    box.body_q[..., 2] -= np.array([0.3, 0.1])[:, None, None] * np.minimum(TIME, 1.0)[:, None]
    assert found("drops(box)", box).margin == pytest.approx([0.3 - 0.2, 0.1 - 0.2])
    assert found("drops(box, share 20 %)", box).margin == pytest.approx([0.3 - 0.08, 0.1 - 0.08])


@pytest.mark.parametrize(("start", "angle"), [((1.0, 0.0, 1.2), 8.0), ((-1.0, 0.3, 1.2), 8.0), ((1.0, 0.0, 1.2), 4.0)])
def test_a_plank_tilts_to_the_side_where_the_other_started(start, angle):
    """Turned about y by a positive angle its +x side goes down by that angle; what is beside goes down by less."""
    turn = about_axis("y", math.radians(angle) * np.minimum(TIME, 1.0))
    q = np.stack([turn, np.broadcast_to([0.0, 0.0, 0.0, 1.0], turn.shape)], axis=1)[None]
    world = World(bodies=[solid("plank", shape("box", 2.0, 0.4, 0.04)), solid("box", shape("box", 0.2, 0.2, 0.2))])
    places = (np.broadcast_to(place, (len(TIME), 3)) for place in ([0.0, 0.0, 1.0], start))
    outcome = found("tilts_to(plank, box)", moving(world, TIME, *places, q=q))
    side = np.array([start[0], start[1]]) / math.hypot(start[0], start[1])
    down = math.degrees(math.asin(math.sin(math.radians(angle)) * side[0]))
    best = down if down > 0.0 else 0.0
    assert outcome.margin[0] == pytest.approx(best - 5.0, abs=1e-6)


def test_a_mean_forgives_what_each_frame_does_not():
    """A way that swings by 0.2 m about 1 m is at least 0.9 m in the mean, and not at each frame."""
    box = gone(1.0 - np.cos(2 * math.pi * TIME) * 0.2 - (1.0 - 0.2) * (TIME == 0.0))
    assert not found("finally(moves(box, 0.9 m))", box).satisfied[0]
    outcome = found("mean(moves(box, 0.9 m))", box)
    assert outcome.margin[0] == pytest.approx(0.1, abs=0.01) and outcome.moment[0] == pytest.approx(1.0)
    assert found("not mean(moves(box, 1.2 m))", box).margin[0] == pytest.approx(0.2, abs=0.01)
    # Of two limits it is the one on the mean's side, whatever side each frame is on.
    with pytest.raises(ValueError, match="it takes one predicate"):
        parse("mean(moves(box, 1 m) and settles(box))")
    with pytest.raises(MissingError, match="not covered"):
        found("mean[3](moves(box))", box)


def test_a_mean_over_a_window_is_of_its_frames_alone():
    """A way of 1 m and 0.2 m of swing from 0.5 s to 1.5 s, a whole period of it, and of 5 m before and after."""
    inside = (TIME >= 0.5) & (TIME <= 1.5)
    box = gone(np.where(inside, 1.0 - 0.2 * np.cos(2 * math.pi * TIME), 5.0 * (TIME > 0.0)))
    outcome = found("mean[0.5, 1.5](gone_between(box, x, 0.9 m, 1.05 m))", box)
    assert outcome.margin[0] == pytest.approx(0.05, abs=0.01) and outcome.moment[0] == pytest.approx(0.5)
    assert found("always[0, 1](mean[0.5, 1.5](gone_between(box, x, 0.9 m, 1.05 m)))", box).satisfied[0]
    assert not found("mean[0.5, 2](gone_between(box, x, 0.9 m, 1.05 m))", box).satisfied[0]
    assert found("mean[0, end](gone_between(box, x, 2 m, 4 m))", box).satisfied[0]
    with pytest.raises(MissingError, match="not covered"):
        found("mean[1, 3](moves(box))", box)
    with pytest.raises(MissingError, match="holds no frame"):
        found("mean[0.501, 0.502](moves(box))", box)
    with pytest.raises(ValueError, match="leave one of the two out"):
        Mean(of=parse("moves(box)"), seconds=1.0, window=(0.0, 1.0))
