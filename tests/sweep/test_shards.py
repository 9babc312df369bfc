"""Whatever workers do, each item ends once: with its result, or as lost for a reason."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.cluster import Cluster, Costs, Faults, simulate
from wsim.sweep.shards import Attempt, Dealer, Heard, Latest, Lost, run

NONE = Faults(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
often = st.sampled_from([0.0, 1.0, 60.0, 600.0])  # [1/h]; a candidate takes a second
sometimes = st.sampled_from([0.0, 0.05, 0.3])


@st.composite
def clusters(draw: st.DrawFn, quiet: bool = False) -> tuple[Cluster, int, int, int]:
    """A cluster with what goes wrong in it, and the numbers of a sweep."""
    count = draw(st.integers(0, 80))
    items = st.sets(st.integers(0, max(0, count - 1)), max_size=4) if count else st.just(set())
    guilty, stuck = draw(items), draw(items)
    faults = Faults(draw(often), draw(often), draw(often), draw(sometimes), draw(sometimes), draw(sometimes), 0.3)
    costs = Costs(parts=draw(st.integers(1, 8)))
    seed, workers = draw(st.integers(0, 10_000)), draw(st.integers(1, 9))
    cluster = Cluster(workers, costs, NONE if quiet else faults, seed, guilty, stuck - guilty)
    return cluster, count, draw(st.integers(1, 32)), draw(st.integers(1, 8))


@settings(max_examples=300, deadline=None)
@given(clusters())
def test_nothing_is_lost_and_nothing_counts_twice(asked: tuple[Cluster, int, int, int]) -> None:
    cluster, count, most, least = asked
    told = simulate(cluster, count, most, least)
    assert (told.done, told.twice, told.wrong) == (count, 0, 0)
    assert told.lost.keys() >= {*cluster.guilty, *cluster.stuck}
    assert all(lost.reason for lost in told.lost.values())


@settings(max_examples=200, deadline=None)
@given(clusters(quiet=True))
def test_only_who_is_to_blame_is_lost(asked: tuple[Cluster, int, int, int]) -> None:
    """Where nothing else goes wrong, those who kill or hang are found out, and nobody beside them."""
    cluster, count, most, least = asked
    told = simulate(cluster, count, most, least)
    assert told.lost.keys() == {*cluster.guilty, *cluster.stuck}


@pytest.mark.parametrize("seed", range(2))
def test_a_million_on_a_thousand_workers_take_no_more_than_a_twentieth_beyond_the_ideal(seed: int) -> None:
    cluster = Cluster(1000, Costs(), Faults(), seed, guilty={123_456})
    told = simulate(cluster, 1_000_000, most=64, least=8)
    assert (told.done, told.twice, told.wrong, set(told.lost)) == (1_000_000, 0, 0, {123_456})
    assert cluster.seen["given up"] > 0 and cluster.seen["message lost"] > 0 and cluster.seen["message repeated"] > 0
    assert 0.0 < told.overhead < 0.05


class Told:
    """Workers who say what they are told to say: by place, a list of answers to what they are given; a `Workers`."""

    def __init__(self, count: int) -> None:
        self.places, self.clock, self.busy = range(count), 0.0, dict[int, Attempt]()
        self.given, self.ended = list[tuple[int, tuple[int, ...]]](), list[int]()
        self.stopped = False

    def now(self) -> float:
        return self.clock

    def idle(self) -> Sequence[int]:
        return [place for place in self.places if place not in self.busy]

    def give(self, attempt: Attempt, task: Any) -> None:
        self.busy[attempt.place] = attempt
        self.given.append((attempt.place, attempt.items))

    def hear(self, until: float) -> Sequence[Heard]:
        raise NotImplementedError

    def end(self, place: int) -> None:
        self.ended.append(place)
        del self.busy[place]

    def stop(self) -> None:
        self.stopped = True


class Loses(Told):
    """The first worker loses whatever it is given."""

    def hear(self, until: float) -> Sequence[Heard]:
        if not self.busy:
            self.clock = until
            return []
        self.clock += 1.0
        place, attempt = next(iter(self.busy.items()))
        del self.busy[place]
        if place == 0:
            return [Heard(attempt.ticket, over=True, lost=Lost("it broke", again=True))]
        return [Heard(attempt.ticket, [(item, item) for item in attempt.items]), Heard(attempt.ticket, over=True)]


def test_what_a_place_loses_is_tried_elsewhere_and_the_place_rests() -> None:
    workers = Loses(2)
    found = [pair for some in run(Dealer(40, 2, 60.0), range(40), lambda items: None, workers) for pair in some]
    assert sorted(found) == [(k, k) for k in range(40)]
    lost = [items for place, items in workers.given if place == 0]
    assert len(lost) == len(set(lost)) < 10  # without a rest it would be given every second one of twenty
    assert workers.stopped


def test_a_place_that_is_alone_has_its_second_try() -> None:
    found = [pair for some in run(Dealer(1, 1, 60.0), ["a"], lambda items: None, Loses(1)) for pair in some]
    assert found == [("a", Lost("it broke", again=True))]


def _deal(dealer: Dealer, place: int, now: float, places: int = 2) -> Attempt:
    (attempt,), _ = dealer.assign([place], places, now)
    return attempt


def test_shares_grow_smaller_towards_the_end() -> None:
    dealer, sizes = Dealer(100, 16, 60.0, 2), []
    while sum(sizes) < 100:
        sizes.append(len(_deal(dealer, 0, 0.0, 4).items))
    assert sizes[0] == 13 and sizes[-2:] == [2, 2] and sizes == sorted(sizes, reverse=True)


@pytest.mark.parametrize(("count", "most", "places"), [(5, 16, 4), (8, 1024, 8), (2500, 1024, 1), (1, 16, 3)])
def test_nobody_is_left_without_work_while_there_is_some(count: int, most: int, places: int) -> None:
    dealer = Dealer(count, most, 60.0, max(1, most // 8))
    given, _ = dealer.assign(range(places), places, 0.0)
    assert len(given) == min(count, places)
    assert {place for attempt in given for place in [attempt.place]} == set(range(len(given)))


def test_who_is_silent_for_long_is_late_by_what_others_took() -> None:
    """Shards of ten that take 30 s: after four times as long one is given up, not after its patience of 6,000 s."""
    dealer = Dealer(100, 10, 600.0, 10)
    slow = _deal(dealer, 0, 0.0)
    for k in range(4):
        quick = _deal(dealer, 1, 30.0 * k)
        dealer.heard(Heard(quick.ticket, [(item, item) for item in quick.items]), 30.0 * (k + 1))
        dealer.heard(Heard(quick.ticket, over=True), 30.0 * (k + 1))
    assert dealer.late(119.0) == []
    assert dealer.late(121.0) == [slow]


def test_one_by_itself_has_all_of_its_patience() -> None:
    dealer = Dealer(2, 1, 600.0, elsewhere=False)
    slow, quick = _deal(dealer, 0, 0.0), _deal(dealer, 1, 0.0)
    dealer.heard(Heard(quick.ticket, [(1, 1)], over=True), 0.1)
    assert dealer.late(599.0) == []
    assert dealer.late(601.0) == [slow]


def test_a_late_answer_counts_once_and_is_not_asked_for_again() -> None:
    dealer = Dealer(4, 4, 10.0)
    gone = _deal(dealer, 0, 0.0, places=1)
    assert gone.items == (0, 1, 2, 3)
    assert dealer.late(41.0) == [gone]
    assert dealer.give_up(gone, 41.0) == []
    assert dealer.heard(Heard(gone.ticket, [(0, "late"), (1, "late")]), 42.0) == [(0, "late"), (1, "late")]
    second = _deal(dealer, 1, 43.0)
    assert second.items == (2, 3)
    assert dealer.heard(Heard(gone.ticket, [(2, "later")]), 44.0) == [(2, "later")]
    assert dealer.heard(Heard(second.ticket, [(2, "twice"), (3, "once")], over=True), 45.0) == [(3, "once")]
    assert dealer.done


def test_who_is_free_runs_a_copy_of_what_takes_long_and_only_one() -> None:
    dealer = Dealer(3, 1, 600.0)
    slow, quick = _deal(dealer, 0, 0.0, 3), _deal(dealer, 1, 0.0, 3)
    dealer.heard(Heard(quick.ticket, [(1, 1)], over=True), 2.0)
    third = _deal(dealer, 1, 2.0, 3)
    dealer.heard(Heard(third.ticket, [(2, 2)], over=True), 4.0)
    assert dealer.assign([1, 2], 3, 3.9) == ([], 4.0)
    copy = _deal(dealer, 1, 4.0, 3)
    assert copy.items == slow.items == (0,)
    assert dealer.assign([2], 3, 10.0)[0] == []
    assert dealer.heard(Heard(copy.ticket, [(0, "copy")], over=True), 11.0) == [(0, "copy")]
    assert dealer.heard(Heard(slow.ticket, [(0, "slow")], over=True), 12.0) == []
    assert dealer.done


@given(st.lists(st.floats(0.0, 1e6), min_size=1, max_size=40), st.integers(1, 12), st.sampled_from([0.5, 0.98, 1.0]))
def test_the_latest_are_those(values: list[float], most: int, share: float) -> None:
    latest = Latest(most)
    for value in values:
        latest.add(value)
    kept = sorted(values[-most:])
    assert latest.quantile(share) == kept[math.ceil(share * len(kept)) - 1]


def test_nobody_waits_for_a_place_that_has_no_worker() -> None:
    """Of two places one has lost its machine: what the other one loses is tried there again."""
    dealer = Dealer(1, 1, 60.0)
    first = _deal(dealer, 0, 0.0)
    assert dealer.heard(Heard(first.ticket, over=True, lost=Lost("it broke", again=True)), 1.0) == []
    second = _deal(dealer, 0, 2.0)
    assert second.items == first.items


def test_what_was_lost_in_company_counts_against_nobody_who_is_alone() -> None:
    dealer, broke = Dealer(2, 2, 60.0), Lost("it broke", again=True)
    both = _deal(dealer, 0, 0.0, 1)
    assert both.items == (0, 1)
    assert dealer.heard(Heard(both.ticket, [(0, "done")]), 1.0) == [(0, "done")]
    assert dealer.heard(Heard(both.ticket, over=True, lost=broke), 2.0) == []
    alone = _deal(dealer, 0, 10.0, 1)
    assert alone.items == (1,)
    assert dealer.heard(Heard(alone.ticket, over=True, lost=broke), 11.0) == []
    again = _deal(dealer, 0, 100.0, 1)
    assert dealer.heard(Heard(again.ticket, over=True, lost=broke), 101.0) == [(1, broke)]
    assert dealer.done
