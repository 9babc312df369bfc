"""A search finds where the room is greatest, whatever it is asked about."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wsim.sweep.axis import Axis
from wsim.sweep.candidate import Candidate, Outcome
from wsim.sweep.run import batches
from wsim.sweep.spec import Spec

X = Axis(name="x", low=-2.0, high=2.0, start=-1.5)
K = Axis(name="k", low=1.0, high=1e4, scale="log", start=2.0)


def searched(spec: Spec, slack: Callable[[dict[str, float]], float | None]) -> dict[int, Outcome]:
    """What a search asks about, answered by a function; None: no verdict."""
    done: dict[int, Outcome] = {}
    for batch in batches(spec, done):
        for candidate in batch:
            done[candidate.number] = answer(candidate, slack(candidate.params) if candidate.params else -0.5)
    return done


def answer(candidate: Candidate, slack: float | None) -> Outcome:
    status = "failed" if slack is None else "accepted" if slack >= 0.0 else "rejected"
    return Outcome(candidate=candidate, status=status, slack=slack)


def best(done: dict[int, Outcome]) -> Outcome:
    return min(done.values(), key=lambda outcome: outcome.rank)


@settings(max_examples=15)
@given(st.floats(-1.9, 1.9), st.floats(2.0, 5e3), st.integers(0, 3))
def test_the_best_of_two_numbers_is_found(x: float, k: float, seed: int) -> None:
    def slack(point: dict[str, float]) -> float:
        return 0.3 - abs(point["x"] - x) / 4 - abs(point["k"] / k - 1) / (1 + point["k"] / k)

    done = searched(Spec(axes=[X, K], method="cma", samples=400, seed=seed), slack)
    assert best(done).slack == pytest.approx(0.3, abs=0.02)


def test_one_number_is_enough_and_a_list_may_be_searched() -> None:
    done = searched(Spec(axes=[X], method="cma", samples=80), lambda p: 0.5 - abs(p["x"] - 1.3))
    assert best(done).candidate.params["x"] == pytest.approx(1.3, abs=0.01)
    count = Axis(name="n", low=1, high=9, values=(1.0, 3.0, 9.0), start=1.0)
    done = searched(Spec(axes=[count], method="cma", samples=40), lambda p: -abs(p["n"] - 9.0) / 10)
    assert best(done).candidate.params == {"n": 9.0}


def test_failures_and_plateaus_end_it_within_its_budget() -> None:
    for slack in (lambda p: None, lambda p: -1.0, lambda p: None if p["x"] < 0 else 0.1 * p["x"]):
        done = searched(Spec(axes=[X], method="cma", samples=60), slack)
        assert len(done) <= 61 + 6
    assert best(done).candidate.params["x"] > 1.9


def test_it_asks_the_same_again_so_that_it_can_go_on() -> None:
    spec = Spec(axes=[X, K], method="cma", samples=60, batch=10, seed=4)

    def slack(point: dict[str, float]) -> float:
        return 0.1 - abs(point["x"])

    whole = searched(spec, slack)
    kept = {number: outcome for number, outcome in whole.items() if number < 25}
    for batch in batches(spec, kept):
        for candidate in batch:
            kept.setdefault(candidate.number, answer(candidate, slack(candidate.params) if candidate.params else -0.5))
    assert kept == whole


def test_of_seeds_and_programs_at_a_point_the_worst_counts() -> None:
    spec = Spec(axes=[X], method="cma", samples=120, programs=["a.py", "b.py"], repeats=2)
    done: dict[int, Outcome] = {}
    for batch in batches(spec, done):
        for candidate in batch:
            x = candidate.params.get("x", 0.0)
            done[candidate.number] = answer(candidate, 0.9 - x if candidate.program == "a.py" else 0.5 + x)
    rows = list(done.values())
    points = [rows[k : k + spec.each] for k in range(spec.each, len(rows), spec.each)]
    chosen = max(points, key=lambda point: min(outcome.slack or 0.0 for outcome in point))
    assert chosen[0].candidate.params["x"] == pytest.approx(0.2, abs=0.02)  # where both have the same room
    assert len({str(outcome.candidate.params) for outcome in chosen}) == 1
