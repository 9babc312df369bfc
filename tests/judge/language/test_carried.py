"""Predicates about what carries a body: gaps seen from above, and the weight that contacts bear."""

import math

import numpy as np
import pytest

from tests.judge.language.conftest import G, moving, shape, solid, still, times
from wsim.judge.language import Signals, evaluate, parse
from wsim.scene.world import Joint, Shape, World

TIME = times(2.0)
HEIGHT = 0.4


def found(text, signals):
    return evaluate(parse(text), signals)


def standing(gap, along=0.0, force=8.0 * G, **more):
    """A box of 8 kg and 0.2 x 0.2 x 0.4 m over a table that is 0.5 m high, with a gap (T,) or (W, T) [m]."""
    table = still("table", shape("box", 1.0, 1.0, 0.5, position=(0.0, 0.0, 0.25)))
    ground = still("ground", Shape(prim="/g", kind="plane", size=()))
    world = World(bodies=[solid("box", shape("box", 0.2, 0.2, HEIGHT), 8.0)], statics=[ground, table], **more)
    gaps = np.atleast_2d(gap) + 0.0 * TIME
    path = np.stack([along + 0.0 * gaps, 0.0 * gaps, 0.7 + gaps], axis=-1)
    return moving(world, TIME, path, v=np.zeros(3), force=np.array([0.0, 0.0, force]))


@pytest.mark.parametrize("gap", [0.0, 0.01, -0.015, 0.03, -0.05])
def test_what_lies_on_something_is_that_near_to_it_from_above(gap):
    signals = standing(gap)
    assert found("lies_on(box, table)", signals).margin[0] == pytest.approx(0.05 * HEIGHT - abs(gap), abs=1e-6)
    assert found("stays_on(box, table)", signals).margin[0] == pytest.approx(0.1 * HEIGHT - abs(gap), abs=1e-6)
    assert found("stays_on(box, table, within 1 cm)", signals).satisfied[0] == (abs(gap) <= 0.01)


@pytest.mark.parametrize(("along", "over"), [(0.0, True), (0.45, True), (0.55, False), (2.0, False)])
def test_what_is_beside_something_is_not_on_it(along, over):
    signals = standing(0.0, along)
    for text in ("lies_on(box, table)", "stays_on(box, table)", "rests_on(box, table)"):
        assert found(text, signals).satisfied[0] == over
        # As far from being on it as it is high, at least.
        assert over or found(text, signals).margin[0] <= (0.1 - 1.0) * HEIGHT + 1e-9


def test_what_lies_moves_as_it_likes_and_what_rests_does_not():
    signals = standing(0.0)
    signals.body_qd[..., 0] = 0.5
    assert found("lies_on(box, table)", signals).satisfied[0]
    assert found("rests_on(box, table)", signals).units == ["m/s"]
    assert not found("rests_on(box, table)", signals).satisfied[0]


def test_it_stays_at_each_frame():
    hops = standing(np.where(np.abs(TIME - 0.5) < 0.02, 0.06, 0.0))
    assert found("lies_on(box, table)", hops).satisfied[0]  # at the end
    outcome = found("stays_on(box, table)", hops)
    assert not outcome.satisfied[0] and outcome.moment[0] == pytest.approx(0.5)


def test_the_mean_of_what_has_two_limits_is_held_against_both():
    """A gap that goes from one side of its limits to the other is within them in the mean, and one on one side not."""
    swing = 0.03 * np.where(np.arange(len(TIME)) % 2, 1.0, -1.0)
    signals = standing(np.stack([swing, swing + 0.025, swing - 0.025]))
    assert not found("finally(lies_on(box, table))", signals).satisfied.any()
    outcome = found("mean(lies_on(box, table))", signals)
    assert outcome.satisfied.tolist() == [True, False, False]
    assert outcome.margin == pytest.approx([0.02, -0.005, -0.005], abs=1.1e-3)


@pytest.mark.parametrize("share", [1.0, 0.8, 0.7, 1.2, 1.3])
def test_what_weighs_on_something_is_carried_with_its_weight(share):
    outcome = found("weighs_on(box, table)", standing(0.0, force=share * 8.0 * G))
    assert outcome.margin[0] == pytest.approx((0.25 - abs(share - 1.0)) * 8.0 * G) and outcome.units == ["N"]
    assert outcome.measures[0].expected == pytest.approx(8.0 * G)
    strict = found("weighs_on(box, table, share 10 %)", standing(0.0, force=share * 8.0 * G))
    assert strict.satisfied[0] == (abs(share - 1.0) < 0.1)


def test_what_is_fixed_together_weighs_as_one():
    box = solid("box", shape("box", 0.2, 0.2, HEIGHT), 8.0)
    other = solid("other", shape("box", 0.2, 0.2, HEIGHT), 4.0)
    weld = Joint(prim="/World/weld", kind="fixed", parent="/World/box", child="/World/other")
    table = still("table", shape("box", 1.0, 1.0, 0.5, position=(0.0, 0.0, 0.25)))
    places = [np.broadcast_to([x, 0.0, 0.7], (len(TIME), 3)) for x in (0.0, 0.2)]
    force = np.zeros((2, 3))
    force[0, 2] = 12.0 * G
    for joints, holds in (([weld], True), ([], False)):
        signals = moving(World(bodies=[box, other], statics=[table], joints=joints), TIME, *places, force=force)
        assert found("weighs_on(box, table)", signals).satisfied[0] == holds


def test_the_fluid_carries_its_part(pool):
    case = pool()
    signals = Signals.of_recording(case.recording)
    outcome = found("weighs_on(steel_ball, tank)", signals)
    weight = 7850 * 4 / 3 * math.pi * 0.06**3 * G
    assert outcome.satisfied[0] and outcome.measures[0].expected[0] == pytest.approx(6850 / 7850 * weight, rel=1e-3)
    lost = Signals.of_recording(case.changed(contact_force=0.6 * case.recording.contact_force).recording)
    assert not found("weighs_on(steel_ball, tank)", lost).satisfied[0]
