"""Which worker does what next, where workers may die, hang, run out of memory, or answer late and twice.

Nothing here knows what a worker is: `Workers` may be processes, actors of a cluster, or a simulation of one
(benchmarks/cluster.py), and the clock is theirs. Items are cut into shards that grow smaller towards the end (guided
self-scheduling, Polychronopoulos & Kuck 1987), and who has nothing left to do runs a copy of what takes longest, of
which the first answer counts (backup tasks, Dean & Ghemawat 2004).
"""

from __future__ import annotations

import bisect
import math
from collections import deque
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol, TypeVar

Item = TypeVar("Item")

TRIES = 2  # a worker may be lost to what another one uses, or to its machine; who loses two is to blame
PIECES = 4  # into which a share is cut that loses two: as many shares as by halves until one is alone, in half the time
SHARES = 2  # shards that each worker would still have, of what is left: the last ones are short
LATE = 4.0  # times the usual silence: a shard that is silent for longer hangs
USUAL = 0.98  # of the last silences are no longer: a few that a network made so do not count
REMEMBERED = 512
SILENCE = 60.0  # [s] that no machine is blamed for: it may be busy, or suspended
COPIED = 2.0  # times what shards of its size take, after which a worker that is free runs a copy
REST = 1.0  # [s] for which a place rests that has lost two shards in a row; twice as long for each further one
LONGEST_REST = 60.0


@dataclass(frozen=True)
class Lost:
    """Why an item has no result, and whether another try may have one."""

    reason: str
    again: bool = False


@dataclass(frozen=True)
class Heard:
    """What a worker says: results, by item; that it is done with a shard; or why it will not be."""

    ticket: int
    results: Sequence[tuple[int, Any]] = ()
    over: bool = False
    lost: Lost | None = None


@dataclass(eq=False)
class Share:
    """Items that go to a worker together.

    Attributes:
        items: They.
        strikes: How many workers were lost over it.
        avoid: Where.
        at: How many workers are at it.
        copied: Whether a worker that was free has been given it too: once, or copies of what hangs would never end.
    """

    items: tuple[int, ...]
    strikes: int = 0
    avoid: frozenset[int] = frozenset()
    at: int = 0
    copied: bool = False


@dataclass(eq=False)
class Attempt:
    """A shard that is given to a worker, with what of it was still to do."""

    ticket: int
    place: int
    share: Share
    items: tuple[int, ...]
    started: float  # [s]
    heard: float = field(init=False)  # [s], the last sign of progress

    def __post_init__(self) -> None:
        self.heard = self.started


class Latest:
    """The latest of some numbers, in order.

    Args:
        most: How many are remembered.
    """

    def __init__(self, most: int) -> None:
        self._most, self._came, self._sorted = most, deque[float](), list[float]()

    def add(self, value: float) -> None:
        """Remember a number, and forget the oldest."""
        self._came.append(value)
        bisect.insort(self._sorted, value)
        if len(self._came) > self._most:
            del self._sorted[bisect.bisect_left(self._sorted, self._came.popleft())]

    def quantile(self, share: float) -> float | None:
        """The one than which such a share is no greater; None where there is none."""
        return self._sorted[math.ceil(share * len(self._sorted)) - 1] if self._sorted else None


class Workers(Protocol):
    """Places that each hold one worker. One that ends, whether by itself or by `end`, is replaced where that can be."""

    @property
    def places(self) -> Collection[int]:
        """All of them."""

    def now(self) -> float:
        """Their clock [s]."""

    def idle(self) -> Sequence[int]:
        """Places whose worker waits for work."""

    def give(self, attempt: Attempt, task: Any) -> None:
        """Send a task to the attempt's place."""

    def hear(self, until: float) -> Sequence[Heard]:
        """What workers say, as soon as one does; nothing when it is so late [s]."""

    def end(self, place: int) -> None:
        """Stop the worker, whatever it is at."""

    def stop(self) -> None:
        """Stop all of them."""


class Dealer:
    """Who does what, until each item is done or lost.

    Args:
        count: Items, which are known by their index.
        most: Items of a shard.
        patience: How long a shard may be silent, for each item that it still has [s].
        least: Items of the last shards, where there are enough.
        elsewhere: Whether what a worker is late with may be at another one too, meanwhile or after.
    """

    def __init__(self, count: int, most: int, patience: float, least: int = 1, elsewhere: bool = True) -> None:
        self._count, self._most, self._least = count, max(1, most), max(1, least)
        self._patience, self._elsewhere = patience, elsewhere
        self._fresh, self._again = 0, deque[Share]()
        self._done: set[int] = set()
        self._at: dict[int, Attempt] = {}
        self._tickets = 0
        self._silences = Latest(REMEMBERED)
        self._spent = [0.0, 0.0]  # [s] of shards that came whole, and their items
        self._in_a_row: dict[int, int] = {}
        self._rests: dict[int, float] = {}
        self._look = math.inf  # [s], before which nothing is late

    @property
    def done(self) -> bool:
        """Whether every item has come to an end."""
        return len(self._done) == self._count

    def assign(self, idle: Sequence[int], places: int, now: float) -> tuple[list[Attempt], float]:
        """What the idle are to do, of so many places, and when to ask again [s] if nothing is heard before."""
        given, wake = list[Attempt](), math.inf
        there = {*idle, *(attempt.place for attempt in self._at.values())} if self._again else set[int]()
        for place in idle:
            if self._rests.get(place, now) > now:
                wake = min(wake, self._rests[place])
                continue
            share, later = self._next(place, places, there, now)
            wake = min(wake, later)
            if share:
                given.append(self._start(share, place, now))
            elif not self._again:
                break  # what there is none of for this one there is for no other
        return given, min(wake, self._look)

    def heard(self, said: Heard, now: float) -> list[tuple[int, Any]]:
        """Results that are new, in which a lost item has its `Lost`. Whoever says it may have been given up before."""
        new = [(item, result) for item, result in said.results if item not in self._done]
        self._done.update(item for item, _ in new)
        attempt = self._at.get(said.ticket)
        if attempt is None:
            return new
        if said.results or (said.over and not said.lost):
            self._measure(attempt, now)
        if said.lost:
            return new + self._lose(attempt, said.lost, now)
        if said.over:
            if self._left(attempt.items):
                return new + self._lose(attempt, Lost("left out by its worker", again=True), now)
            self._leave(attempt)
            self._spent = [self._spent[0] + now - attempt.started, self._spent[1] + len(attempt.items)]
        return new

    def late(self, now: float) -> list[Attempt]:
        """Who has been silent for too long."""
        if now < self._look:
            return []
        due = {ticket: self._due(attempt) for ticket, attempt in self._at.items()}
        self._look = min((when for when in due.values() if when > now), default=math.inf)
        return [self._at[ticket] for ticket, when in due.items() if when <= now]

    def give_up(self, attempt: Attempt, now: float) -> list[tuple[int, Any]]:
        """Count an attempt as lost because it is late; its items that are given up with it."""
        alone = len(attempt.items) == 1
        seconds = self._patience if alone else now - attempt.heard
        return self._lose(attempt, Lost(f"took more than {seconds:g} s", again=self._elsewhere), now)

    def _next(self, place: int, places: int, there: set[int], now: float) -> tuple[Share | None, float]:
        for share in list(self._again):
            if place in share.avoid and not there <= share.avoid:
                continue  # one of those who are there can try it elsewhere
            self._again.remove(share)
            if self._left(share.items):
                return share, math.inf
        if self._fresh < self._count:
            return self._cut(places), math.inf
        return self._copy(place, now) if self._elsewhere else (None, math.inf)

    def _cut(self, workers: int) -> Share:
        left = self._count - self._fresh
        fair = math.ceil(left / (SHARES * workers)) if workers > 1 else left
        least = min(self._least, self._count // workers)
        first, self._fresh = self._fresh, self._fresh + min(left, max(1, least, min(fair, self._most)))
        return Share(tuple(range(first, self._fresh)))

    def _copy(self, place: int, now: float) -> tuple[Share | None, float]:
        """What takes longest for its size and no second worker is at; or when the next one does."""
        seconds, items = self._spent
        if not items:
            return None, math.inf
        alone = [a for a in self._at.values() if not a.share.copied and place not in a.share.avoid]
        slow = {a.ticket: a.started + COPIED * seconds / items * len(a.items) for a in alone if self._left(a.items)}
        ticket = min(slow, key=slow.__getitem__, default=None)
        if ticket is None or slow[ticket] > now:
            return None, slow[ticket] if ticket else math.inf
        self._at[ticket].share.copied = True
        return self._at[ticket].share, math.inf

    def _start(self, share: Share, place: int, now: float) -> Attempt:
        self._tickets += 1
        share.at += 1
        attempt = Attempt(self._tickets, place, share, self._left(share.items), now)
        self._at[attempt.ticket] = attempt
        self._look = min(self._look, self._due(attempt))
        return attempt

    def _due(self, attempt: Attempt) -> float:
        """When it is too late [s]. By itself an item has all of its patience, however quick others are."""
        patience = self._patience * max(1, len(self._left(attempt.items)))
        usual = self._silences.quantile(USUAL)
        if len(attempt.items) > 1 and usual is not None:
            patience = min(patience, max(SILENCE, LATE * usual * 2**attempt.share.strikes))
        return attempt.heard + patience

    def _measure(self, attempt: Attempt, now: float) -> None:
        self._silences.add(now - attempt.heard)
        attempt.heard = now
        self._look = min(self._look, now + SILENCE)  # by what is known now others may be late sooner
        self._in_a_row.pop(attempt.place, None)

    def _lose(self, attempt: Attempt, lost: Lost, now: float) -> list[tuple[int, Any]]:
        share, place = attempt.share, attempt.place
        self._leave(attempt)
        if lost.again:
            self._rest(place, now)
        share.strikes, share.avoid = share.strikes + (1 if lost.again else TRIES), share.avoid | {place}
        left = self._left(share.items)
        if share.at or not left:
            return []
        alone = len(share.items) == 1
        if alone and share.strikes >= TRIES:
            self._done.update(left)
            return [(left[0], lost)]
        if share.strikes < TRIES and (alone or len(left) > 1):
            self._again.appendleft(Share(left, share.strikes, share.avoid))
        else:
            self._again.extendleft(reversed(_pieces(left, share.avoid)))
        return []

    def _rest(self, place: int, now: float) -> None:
        """A place that loses one shard after another gets the next one later: it may be out of order."""
        self._in_a_row[place] = row = self._in_a_row.get(place, 0) + 1
        if row > 1:
            self._rests[place] = now + min(LONGEST_REST, REST * 2.0 ** min(row - 2, 16))

    def _leave(self, attempt: Attempt) -> None:
        del self._at[attempt.ticket]
        attempt.share.at -= 1

    def _left(self, items: tuple[int, ...]) -> tuple[int, ...]:
        return tuple(item for item in items if item not in self._done)


def _pieces(items: tuple[int, ...], avoid: frozenset[int]) -> list[Share]:
    """One of them holds who is to blame: it is cut again when it loses a worker. By itself one has all tries."""
    size = math.ceil(len(items) / PIECES)
    pieces = [items[first : first + size] for first in range(0, len(items), size)]
    return [Share(piece, TRIES - 1 if len(piece) > 1 else 0, avoid) for piece in pieces]


def run(
    dealer: Dealer, items: Sequence[Item], pack: Callable[[tuple[Item, ...]], Any], workers: Workers
) -> Iterator[list[tuple[Item, Any]]]:
    """Each item with its result or its `Lost`, some at a time, as they come; every item comes once.

    Args:
        dealer: Of as many items.
        items: They.
        pack: What is sent to a worker, of some items.
        workers: Who do it. They are stopped at the end, however that comes.
    """
    try:
        while not dealer.done:
            given, wake = dealer.assign(workers.idle(), len(workers.places), workers.now())
            for attempt in given:
                workers.give(attempt, pack(tuple(items[k] for k in attempt.items)))
            came = [new for said in workers.hear(wake) for new in dealer.heard(said, workers.now())]
            for attempt in dealer.late(workers.now()):
                workers.end(attempt.place)
                came += dealer.give_up(attempt, workers.now())
            if came:
                yield [(items[k], result) for k, result in came]
    finally:
        workers.stop()
