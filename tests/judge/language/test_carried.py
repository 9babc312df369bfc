"""Predicates about what carries a body: gaps seen from above, and the weight that contacts bear."""

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.judge.language.conftest import G, moving, shape, solid, still, times
from tests.judge.theory import box, ground, record, slab, with_world
from wsim.judge.language import Signals, evaluate, parse
from wsim.recording.contacts import ContactTrack
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


def piled(recorded, loads, joints=()):
    """A box of 4 kg on another on the ground, beside a wall; and what each pair is given upwards, over 4 g."""
    t = times(2.0)
    bodies = [box("top"), box("under")]
    place = np.tile([[0.0, 0.0, 0.3], [0.0, 0.0, 0.1]], (len(t), 1, 1))
    force = np.zeros((len(t), 2, 3))
    sums = np.zeros((len(loads), 16), np.float32)
    for row, ((under, over), load) in zip(sums, loads.items(), strict=True):
        row[2], row[3] = load * 4.0 * G / 30.0, load * 4.0 * G / 30.0  # on the second of the pair, between frames
        for which, sign in ((under, -1.0), (over, 1.0)):
            if which < 2:
                force[:, which, 2] += sign * load * 4.0 * G
    frames = np.repeat(np.arange(1, len(t)), len(loads)).astype(np.int32)
    pairs = np.tile(np.array(list(loads), np.int32), (len(t) - 1, 1))
    still = [ground(), slab("wall", (0.2, 1.0, 1.0), (0.2, 0.0, 0.5))]
    case = record(bodies, place, 0.0 * place, t, force=force, statics=still)
    contacts = ContactTrack(frames, pairs, np.tile(sums, (len(t) - 1, 1))) if recorded else None
    return Signals.of_recording(with_world(replace(case, contacts=contacts), joints=list(joints)))


STACK = {(1, 0): 1.0, (2, 1): 2.0}  # shapes of top and under, then ground's and the wall's


@pytest.mark.parametrize("recorded", [True, False])
def test_what_weighs_on_another_is_carried_by_that(recorded):
    stack = piled(recorded, STACK)
    for text, holds in (("top, under", True), ("under, ground", True), ("top, ground", False), ("top, wall", False),
                        ("under, wall", False), ("under, top", False)):  # fmt: skip
        assert found(f"weighs_on({text})", stack).satisfied[0] == holds
        assert found(f"supported_by({text})", stack).satisfied[0] == holds


@pytest.mark.parametrize(("x", "z", "bears"), [(0.8, 0.3, True), (1.1005, 0.35, False), (0.8, 0.29, False)])
def test_a_plank_is_borne_by_trestles_near_its_ends(x, z, bears):
    """One that ends beside it, or stands lower, bears nothing of it."""
    t = times(1.0)
    plank = box("plank", (2.0, 0.2, 0.05), 8.0)
    stands = [slab("left", (0.2, 0.2, 0.6), (-0.8, 0.0, 0.3)), slab("right", (0.2, 0.2, 0.6), (x, 0.0, z))]
    place = np.tile([0.0, 0.0, 0.625], (len(t), 1))
    lies = record([plank], place, 0.0 * place, t, force=np.tile([0.0, 0.0, 8.0 * G], (len(t), 1)), statics=stands)
    signals = Signals.of_recording(lies)
    assert found("supported_by(plank, left)", signals).satisfied[0]
    assert found("supported_by(plank, right)", signals).satisfied[0] == bears


@pytest.mark.parametrize(("leans", "holds"), [(0.03, False), (0.07, True), (0.5, True)])
def test_what_is_borne_by_several_weighs_on_each_that_bears_of_it(leans, holds):
    """A part of it is borne by the wall's friction; what is less than a twentieth is no more than a touch."""
    shared = piled(True, {(1, 0): 1.0, (2, 1): 2.0 - leans, (3, 1): leans})
    assert found("weighs_on(under, ground)", shared).satisfied[0]
    assert found("weighs_on(under, wall)", shared).satisfied[0] == holds


def test_what_is_fixed_together_is_borne_as_one():
    weld = Joint(prim="/World/weld", kind="fixed", parent="/World/top", child="/World/under")
    one = piled(True, {(2, 1): 2.0}, [weld])
    assert found("weighs_on(top, ground)", one).satisfied[0] and found("weighs_on(under, ground)", one).satisfied[0]
    assert not found("weighs_on(top, ground)", piled(True, {(2, 1): 2.0})).satisfied[0]


def test_what_is_fixed_together_weighs_as_one():
    own = solid("box", shape("box", 0.2, 0.2, HEIGHT), 8.0)
    other = solid("other", shape("box", 0.2, 0.2, HEIGHT), 4.0)
    weld = Joint(prim="/World/weld", kind="fixed", parent="/World/box", child="/World/other")
    table = still("table", shape("box", 1.0, 1.0, 0.5, position=(0.0, 0.0, 0.25)))
    places = [np.broadcast_to([x, 0.0, 0.7], (len(TIME), 3)) for x in (0.0, 0.2)]
    force = np.zeros((2, 3))
    force[0, 2] = 12.0 * G
    for joints, holds in (([weld], True), ([], False)):
        signals = moving(World(bodies=[own, other], statics=[table], joints=joints), TIME, *places, force=force)
        assert found("weighs_on(box, table)", signals).satisfied[0] == holds


@pytest.mark.parametrize(
    ("apart", "load", "holds"),
    [(True, 12.0, True), (True, 8.0, True), (True, 15.0, False), (True, 5.0, False),
     (False, 12.0, True), (False, 8.0, False), (False, 16.0, False)],
)  # fmt: skip
def test_what_hangs_on_it_may_weigh_on_it_and_its_own_doors_do(apart, load, holds):
    """A box of 8 kg with a door of 4 kg on a hinge: a body of its own, that may stand elsewhere, or a part of it."""
    stand, door = ("box", "door") if apart else ("box/stand", "box/door")
    bodies = [solid(stand, shape("box", 0.2, 0.2, HEIGHT), 8.0), solid(door, shape("box", 0.2, 0.2, HEIGHT), 4.0)]
    table = still("table", shape("box", 1.0, 1.0, 0.5, position=(0.0, 0.0, 0.25)))
    hinge = Joint(prim="/World/hinge", kind="revolute", parent=f"/World/{stand}", child=f"/World/{door}")
    places = [np.broadcast_to([x, 0.0, 0.7], (len(TIME), 3)) for x in (0.0, 0.2)]
    force = np.zeros((2, 3))
    force[0, 2] = load * G
    world = World(bodies=bodies, statics=[table], joints=[hinge])
    outcome = found("weighs_on(box, table)", moving(world, TIME, *places, force=force))
    assert outcome.satisfied[0] == holds
    assert outcome.measures[0].expected == pytest.approx((8.0 if apart else 12.0) * G)


def test_the_fluid_carries_its_part(pool):
    case = pool()
    signals = Signals.of_recording(case.recording)
    outcome = found("weighs_on(steel_ball, tank)", signals)
    weight = 7850 * 4 / 3 * math.pi * 0.06**3 * G
    assert outcome.satisfied[0] and outcome.measures[0].expected[0] == pytest.approx(6850 / 7850 * weight, rel=1e-3)
    lost = Signals.of_recording(case.changed(contact_force=0.6 * case.recording.contact_force).recording)
    assert not found("weighs_on(steel_ball, tank)", lost).satisfied[0]
