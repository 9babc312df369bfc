"""Operators against their definitions, frame by frame and world by world."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.judge.language.conftest import moving, shape, solid
from wsim.judge.evidence.recorded import MissingError
from wsim.judge.language import evaluate, parse
from wsim.judge.language.python import always, eventually, finally_, ordered, stays_within
from wsim.plan.schema.formula import Always, And, Eventually, Formula, Not, Or, Then, Until
from wsim.plan.schema.formula_place import StaysWithin
from wsim.scene.world import World

A, B = (stays_within(name, (0.0, 0.0, 0.0), radius=1.0) for name in "ab")
RATE = 4.0


def by_definition(formula: Formula, margins: dict[str, np.ndarray], i: int) -> float:
    """Robustness at frame i of one world, written out from the definition; a window is in frames of 1 / RATE."""
    n = len(margins["a"])

    def of(part: Formula, k: int) -> float:
        return by_definition(part, margins, k)

    def frames(window, after=0):
        low, high = window if window is not None else (0.0, None)
        last = n - 1 if high is None else i + round(high * RATE)
        assert last < n
        return range(max(i + round(low * RATE), i + after), last + 1)

    if isinstance(formula, StaysWithin):
        return float(margins[formula.object][i])
    if isinstance(formula, Not):
        return -of(formula.of, i)
    if isinstance(formula, And):
        return min(of(part, i) for part in formula.of)
    if isinstance(formula, Or):
        return max(of(part, i) for part in formula.of)
    if isinstance(formula, Always):
        return min(of(formula.of, k) for k in frames(formula.window))
    if isinstance(formula, Eventually):
        return max(of(formula.of, k) for k in frames(formula.window))
    assert isinstance(formula, Until)
    return max(min([of(formula.goal, k)] + [of(formula.hold, j) for j in range(i, k)]) for k in frames(formula.window))


windows = st.one_of(
    st.none(),
    st.tuples(st.integers(0, 4), st.integers(0, 3)).map(lambda w: (w[0] / RATE, (w[0] + w[1]) / RATE)),
    st.integers(0, 4).map(lambda w: (w / RATE, None)),
)
atoms = st.sampled_from([A, B])
# Unbounded windows over bounded ones end early; the definition above knows only one kind inside the other.
bounded = windows.filter(lambda window: window is None or window[1] is not None)
flat = st.recursive(
    atoms, lambda inner: st.one_of(inner.map(lambda f: ~f), st.tuples(inner, inner).map(lambda p: p[0] & p[1]),
                                   st.tuples(inner, inner).map(lambda p: p[0] | p[1])), max_leaves=4,
)  # fmt: skip
timed = st.one_of(
    st.tuples(flat, windows).map(lambda p: always(*p)),
    st.tuples(flat, windows).map(lambda p: eventually(*p)),
    st.tuples(flat, flat, windows).map(lambda p: p[0].until(p[1], p[2])),
)
nested = st.one_of(
    timed,
    st.tuples(timed, bounded.filter(bool)).map(lambda p: always(*p)),
    st.tuples(timed, bounded.filter(bool)).map(lambda p: eventually(*p)),
    st.tuples(flat, timed, bounded.filter(bool)).map(lambda p: p[0].until(p[1], p[2])),
    st.tuples(timed, timed).map(lambda p: ~p[0] | p[1]),
)
numbers = st.floats(-3, 1).map(lambda x: round(x, 3))


@settings(max_examples=150, deadline=None)
@given(nested, st.lists(st.tuples(*[numbers] * 4), min_size=16, max_size=20))
def test_robustness_is_that_of_the_definition_in_each_world(formula, rows):
    margins = np.array(rows).T.reshape(2, 2, -1)  # body, world, frame
    signals = balls(*margins)
    found = evaluate(formula, signals)
    for w in range(2):
        expected = by_definition(formula, {"a": margins[0, w], "b": margins[1, w]}, 0)
        assert found.robustness[w] == pytest.approx(expected, abs=1e-9)
        assert found.satisfied[w] == (found.robustness[w] >= 0.0)
        # The margin is of the frame that it points at.
        body = "ab".index(found.measures[found.measure[w]].prim[-1])
        assert abs(margins[body, w, round(found.moment[w] * RATE)]) == pytest.approx(abs(expected), abs=1e-9)


def balls(a: np.ndarray, b: np.ndarray):
    paths = [(1.0 - m)[..., None] * np.array([1.0, 0.0, 0.0]) for m in (a, b)]
    world = World(bodies=[solid("a", shape("sphere", 0.1)), solid("b", shape("sphere", 0.1))])
    return moving(world, np.arange(a.shape[-1]) / RATE, *paths, v=np.zeros(3))


@settings(max_examples=100, deadline=None)
@given(st.lists(st.tuples(numbers, numbers), min_size=4, max_size=15), st.integers(0, 2), st.integers(0, 3))
def test_then_is_one_frame_and_a_later_one_in_its_window(rows, low, width):
    a, b = np.array(rows).T
    n, high = len(a), low + width
    # A window closes with the last frame: what comes late in the run may still be followed by what it is to be.
    pairs = [(i, j) for i in range(n) for j in range(max(i + low, i + 1), min(i + high, n - 1) + 1)]
    formula = A.then(B, (low / RATE, high / RATE))
    if not pairs or high == 0 or n - high <= 0:
        return
    expected = max(min(a[i], b[j]) for i, j in pairs)
    assert evaluate(formula, balls(a, b)).robustness[0] == pytest.approx(expected)


def test_nothing_follows_the_last_frame(two_balls):
    """What comes true there is followed by nothing, however near to its limit that always is."""
    assert evaluate(A.then(B, (0, 1)), two_balls([-1, -1, -1, 0], [0, 0, 0, 0])).robustness[0] == pytest.approx(-1.0)


def test_then_chains_and_wants_the_order(two_balls):
    first, second = [-1, 0.5, -1, -1, -1], [-1, -1, -1, 0.25, -1]
    assert evaluate(A.then(B), two_balls(first, second)).margin[0] == pytest.approx(0.25)
    assert evaluate(B.then(A), two_balls(first, second)).margin[0] == pytest.approx(-1.0)
    assert isinstance(A.then(B).then(A), Then)
    assert evaluate(A.then(B).then(A), two_balls([-1, 0.5, -1, -1, 0.1], second)).margin[0] == pytest.approx(0.1)
    # In the same frame is not afterwards, and 2 s is too late for a window of 1 s.
    assert not evaluate(A.then(B), two_balls(first, first[:])).satisfied[0]
    assert not evaluate(A.then(B, (0, 1)), two_balls(first, second)).satisfied[0]
    assert evaluate(A.then(B, (0, 2)), two_balls(first, second)).satisfied[0]


def test_a_window_that_ends_with_the_run_is_as_long_as_it(two_balls):
    """An event at 1 s and another at 3 s, of a run of 4 s: within all of it, and within 4 s of each other."""
    first, second = [-1, 0.5, -1, -1, -1], [-1, -1, -1, 0.25, -1]
    assert evaluate(A.then(B, (0, 4)), two_balls(first, second)).margin[0] == pytest.approx(0.25)
    assert evaluate(eventually(A.then(B), (0, 4)), two_balls(first, second)).margin[0] == pytest.approx(0.25)
    assert not evaluate(eventually(B.then(A), (0, 4)), two_balls(first, second)).satisfied[0]


def test_finally_looks_at_the_last_seconds(two_balls):
    signals = two_balls([-1, -1, 0.2, 0.1, 0.3])
    assert evaluate(finally_(A, 2), signals).margin[0] == pytest.approx(0.1)
    assert evaluate(finally_(A, 2), signals).moment[0] == 3.0
    assert evaluate(finally_(A, 3), signals).margin[0] == pytest.approx(-1.0)
    with pytest.raises(MissingError, match="last 9 s are not covered"):
        evaluate(finally_(A, 9), signals)


def test_ordered_is_the_least_time_between_first_moments(two_balls):
    signals = two_balls([-1, 0.5, -1, 0.5, -1], [-1, -1, -1, -1, 0.5])
    found = evaluate(ordered(A, B), signals)
    # At 1 s and at 4 s; 0.5 s, half a frame, is the least that can be told.
    assert found.margin[0] == pytest.approx(3.0 - 0.5) and found.units == ["s"]
    assert evaluate(ordered(B, A), signals).margin[0] == pytest.approx(-3.0 - 0.5)
    never = ordered(A, B, stays_within("a", (9.0, 0.0, 0.0), 1.0))
    assert evaluate(never, signals).margin[0] == pytest.approx(-(4.0 + 1.0) - 0.5)
    assert not evaluate(ordered(A, A), signals).satisfied[0]
    # The third event is at 0 s: 3 s and -4 s, of which the least counts.
    first = stays_within("a", (2.0, 0.0, 0.0), 0.1)
    assert evaluate(ordered(A, B, first), signals).margin[0] == pytest.approx(-4.0 - 0.5)


@pytest.mark.parametrize(
    "text",
    ["always[2, 9](A)", "eventually[0, 9](A)", "A until[1, 9] B", "A then[0, 9] B", "always[9, end](A)",
     "always[0, 2](eventually[0, 3](A))", "always[2, 4](always[0, 1](A))", "not always[2, 9](A)"],
)  # fmt: skip
def test_a_window_that_the_recording_does_not_cover_is_an_error(text, two_balls):
    said = text.replace("A", "stays_within(a, (0, 0, 0), 1 m)").replace("B", "stays_within(b, (0, 0, 0), 1 m)")
    with pytest.raises(MissingError, match=r"not covered: the recording has \d s"):
        evaluate(parse(said), two_balls([0.5] * 5))


def test_a_window_between_two_frames_is_an_error(two_balls):
    with pytest.raises(MissingError, match=r"holds no frame: they are 1 s apart"):
        evaluate(always(A, (0.2, 0.7)), two_balls([0.5] * 5))


def test_a_recording_that_ends_half_a_frame_early_still_covers(two_balls):
    signals = two_balls([0.5] * 30, rate=30.0)  # its last frame is at 0.967 s
    assert evaluate(always(A, (0, 0.98)), signals).satisfied[0]
    with pytest.raises(MissingError):
        evaluate(always(A, (0, 1.0)), signals)


def test_always_over_a_bounded_window_looks_from_where_it_fits(two_balls):
    # The last second has none after it, and its bad frame is seen from the one before.
    good = [-1, 0.5, -1, 0.5, -1, 0.25]
    assert evaluate(always(eventually(A, (0, 1))), two_balls(good)).margin[0] == pytest.approx(0.25)
    assert not evaluate(always(eventually(A, (0, 1))), two_balls([*good[:-1], -1])).satisfied[0]


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("make", [always, eventually, finally_, lambda f: ~always(f), lambda f: ~eventually(f)])
def test_what_is_not_finite_is_never_satisfied(make, bad, two_balls):
    signals = two_balls([[0.5] * 5, [0.5] * 5, [-0.5] * 5], [[0.5] * 5] * 3)
    signals.body_q[1, 4, 0, 0] = bad
    found = evaluate(make(A), signals)
    assert found.margin[1] == -math.inf and found.robustness[1] == -math.inf and not found.satisfied[1]
    # In another world, or of a body that is not asked about, it does no harm.
    assert np.isfinite(found.margin[[0, 2]]).all() and found.satisfied[0] != found.satisfied[2]
    assert np.isfinite(evaluate(make(B), signals).margin).all()


def test_not_finite_until_and_or(two_balls):
    signals = two_balls([0.5, math.nan, 0.5], [-0.5, -0.5, 0.5])
    for formula in (A.until(B), A | B, B | A, always(A | B), A.then(B), ordered(A, B), ~ordered(B, A)):
        assert evaluate(formula, signals).margin[0] == -math.inf


def test_predicates_alone_are_read_with_their_own_time(two_balls):
    signals = two_balls([-0.5, 0.5, 0.25])
    assert evaluate(A, signals).margin[0] == evaluate(always(A), signals).margin[0] == pytest.approx(-0.5)
    touch, apart = parse("touches(a, b)"), parse("not touches(a, b)")
    assert evaluate(touch, signals).margin[0] == evaluate(eventually(touch), signals).margin[0]
    assert evaluate(apart, signals).margin[0] == -evaluate(eventually(touch), signals).margin[0]
    rest = parse("settles(a)")
    assert evaluate(rest, signals).margin[0] == evaluate(finally_(rest), signals).margin[0]


def test_one_unit_is_compared_as_it_is_and_mixed_units_as_shares(two_balls):
    signals = two_balls([0.5] * 4)
    wide = stays_within("a", (0.0, 0.0, 0.0), radius=10.5)  # 10 m left of 10.5
    near = stays_within("a", (0.0, 0.0, 0.0), radius=0.6)  # 0.1 m left of 0.6
    far = stays_within("a", (0.0, 0.0, 0.0), radius=1.0)  # 0.5 m left of 1
    assert evaluate(wide & near, signals).robustness[0] == pytest.approx(0.1)
    assert evaluate(always(far) | always(wide), signals).margin[0] == pytest.approx(10.0)
    # With an angle beside them: 0.1 of 0.6 is less than 0.05 of 0.06 degrees would be.
    slow = parse("speed_between(a, 0 m/s, 0.1 m/s)")
    mixed = evaluate(near & slow, signals)
    assert mixed.units == ["m/s"] and mixed.margin[0] == 0.0
    strict = evaluate(near & parse("settles(a, speed 0.001 m/s)"), signals)
    assert strict.units == ["m"] and strict.margin[0] == pytest.approx(0.1)
    assert strict.robustness[0] == pytest.approx(0.1 / 0.6)


def test_unknown_names_are_answered_with_those_that_are_there(two_balls):
    late = "ordered(settles(a), settles(c))"
    for text in ("settles(c)", "touches(a, c)", "reaches(a, c)", "conserves(energy, c)", late):
        with pytest.raises(MissingError, match=r"no 'c'; it has /World/a, /World/b"):
            evaluate(parse(text), two_balls([0.5] * 4))
    with pytest.raises(MissingError, match=r"no 'water'; it has"):
        evaluate(parse("submerged(a, water)"), two_balls([0.5] * 4))
