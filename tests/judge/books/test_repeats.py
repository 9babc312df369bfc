"""What stands is solved once: what is left over is the same, and what takes the ground away is seen at once."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.judge.theory import EDGE, G, box, edited, ground, record, resting, slab, times
from wsim.judge.books import repeats
from wsim.judge.books.balance import Balance
from wsim.judge.evidence.evidence import Evidence


def left(recording):
    """What is left of each body's force in each interval, and which were worked out anew."""
    asked = []
    keep = repeats.fresh
    repeats.fresh = lambda *given: asked.append(keep(*given)) or asked[-1]
    try:
        books = Balance(Evidence(recording)).books()
    finally:
        repeats.fresh = keep
    return np.linalg.norm(books.force, axis=2), asked[0][0]  # as they were at last


def all_left(recording):
    """What is left of each body's force in each interval where all are worked out anew."""
    keep = repeats.fresh
    repeats.fresh = lambda *given: tuple(np.ones_like(each) for each in keep(*given))
    try:
        return np.linalg.norm(Balance(Evidence(recording)).books().force, axis=2)
    finally:
        repeats.fresh = keep


def tower(away=0.0, seconds=2.0):
    """Two boxes on each other, and one that slides by itself."""
    t = times(seconds)
    slides = np.stack([2.0 + 3.0 * t - 0.25 * G * t**2, 0.0 * t, EDGE / 2 + 0.0 * t], axis=1)
    stand = [np.tile([away, 0.0, z], (len(t), 1)) for z in (EDGE / 2, 1.5 * EDGE)]
    place = np.stack([*stand, slides], axis=1)
    velocity = np.zeros_like(place)
    velocity[:, 2, 0] = 3.0 - 0.5 * G * t
    stops = t > 3.0 / (0.5 * G)
    velocity[stops, 2], place[stops, 2, 0] = 0.0, 2.0 + 9.0 / G
    return record([box("low"), box("high"), box("sled")], place, velocity, t, statics=[ground()])


@pytest.mark.parametrize("away", [0.0, 50.0])
def test_what_stands_is_worked_out_once_beside_what_moves(away):
    force, fresh = left(tower(away))
    assert force[fresh[:, 2]].max() < 1e-2 * G and fresh[:10, 2].all()
    assert fresh[0].all() and fresh[1:, :2].sum() == 0
    assert not fresh[-1].any()


@pytest.mark.parametrize("gap", [0.02, 1.0])  # beyond what it may fall by in an interval
def test_a_body_that_hovers_at_rest_lacks_its_weight_in_each_interval(gap):
    force, fresh = left(edited(resting(), "body_q", (slice(None), 0, 2), gap))
    assert fresh.sum() == 1
    assert force == pytest.approx(G, rel=1e-5)


def test_a_body_whose_support_is_taken_away_lacks_its_weight_from_then_on():
    right = tower()
    gone = edited(right, "body_q", (slice(30, None), 0, 1), 5.0)  # at 1 s the lower box jumps aside
    force, fresh = left(gone)
    assert fresh[29:31, 1].all()
    assert force[:28, 1].max() < 1e-2 * G and force[31:, 1] == pytest.approx(G, rel=1e-3)


@given(push=st.floats(0.0, 2.0), noise=st.sampled_from([0.0, 1e-8, 1e-6]), seed=st.integers(0, 99))
@settings(max_examples=15, deadline=None)
def test_repeating_leaves_what_solving_anew_leaves(push, noise, seed):
    """A force that swells on a standing box, and places that tremble in their last digits."""
    right, rng = tower(seconds=1.0), np.random.default_rng(seed)
    n = len(right.time)
    impulse = np.zeros((n, 3, 3), dtype=np.float32)
    impulse[n // 2 :, 1, 2] = push * 4.0 * G * np.diff(right.time)[0]
    place = right.body_q + rng.normal(0.0, noise, right.body_q.shape).astype(np.float32)
    told = replace(right, body_q=place, applied_impulse=impulse, applied_work=np.zeros((n, 3), dtype=np.float32))
    some = left(told)[0]
    every = all_left(told)
    assert some == pytest.approx(every, abs=2e-3 * G)
    assert (every[n // 2 + 2 :, 1].max() > 0.5 * G) == (push > 1.5) or 1.4 < push < 1.6


def test_a_belt_that_starts_is_told_from_one_that_stands():
    """The body on it stays where it is; what carries it has moved."""
    t = times(1.0)
    place = np.tile([[[0.0, 0.0, -0.05], [0.0, 0.0, EDGE / 2]]], (len(t), 1, 1))
    place[15:, 0, 0] += 0.5 * (t[15:] - t[14])
    velocity = np.zeros_like(place)
    velocity[15:, 0, 0] = 0.5
    lift = box("plate", (3.0, 1.0, 0.1), kinematic=True)
    force, fresh = left(record([lift, box()], place, velocity, t, statics=[slab("far", (1, 1, 1), (9, 0, 0))]))
    assert fresh[14:, 1].all() and not fresh[1:13, 1].any()
    assert force[:13, 1].max() < 1e-2 * G and force[20, 1] == pytest.approx(0.5 * G / np.hypot(1, 0.5), rel=0.05)


def passing(gap, hovers=0.0):
    """A box that stands, or hovers, and one that slides by it slowly at a distance."""
    t = times(1.0)
    stands = np.tile([0.0, 0.0, EDGE / 2 + hovers], (len(t), 1))
    slides = np.stack([EDGE + gap + 0.0 * t, 1.0 * t - 0.5, EDGE / 2 + 0.0 * t], axis=1)
    place, velocity = np.stack([stands, slides], axis=1), np.zeros((len(t), 2, 3))
    velocity[:, 1, 1] = 1.0
    return record([box("stands"), box("slides", friction=0.0)], place, velocity, t, statics=[ground()])


def test_what_stands_beside_what_passes_is_worked_out_once():
    """It might be touched, and is not: what carries both explains all."""
    told = passing(gap=0.005)
    force, fresh = left(told)
    assert fresh[:, 1].all() and fresh[1:, 0].sum() == 0
    assert force == pytest.approx(all_left(told), abs=2e-3 * G) and force.max() < 2e-3 * G


def test_what_hovers_beside_what_passes_is_looked_at_each_time():
    """Nothing that touches it explains it: what passes might hold it by friction."""
    told = passing(gap=0.005, hovers=0.05)
    force, fresh = left(told)
    assert fresh[2:-1, 0].all()  # while it is near
    assert force[:, 0] == pytest.approx(all_left(told)[:, 0], rel=1e-6)
    assert force[:, 0].min() > 0.9 * G
