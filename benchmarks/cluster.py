"""A cluster of a thousand workers that die, hang, run out of memory, are slow, and lose or repeat what they say.

    .venv/bin/python benchmarks/cluster.py
    .venv/bin/python benchmarks/cluster.py --candidates 1000000 --seeds 3
    .venv/bin/python benchmarks/cluster.py --faults 5 --guilty 20
    .venv/bin/python benchmarks/cluster.py --workers 100 --most 1024 --least 128 --parts 1 --seconds 0.02 --shard 10

Workers and clock are simulated; who does what is dealt out by the code that a sweep uses (`wsim.sweep.shards`). Each
fault is drawn at a rate in time. The ideal is what the workers would take, at the speeds that they have, had none of
them ever to wait, to start, or to do a thing twice, with shards of full size: overhead is what passes beyond it.
`guilty` and `innocent` are candidates that ended as failed.
"""

from __future__ import annotations

import argparse
import heapq
import itertools
import math
import random
import time
from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from typing import Any

from wsim.sweep.shards import Attempt, Dealer, Heard, Lost, run

KILLED, NO_ROOM = "its process ended with signal 9", "out of memory"


@dataclass(frozen=True)
class Costs:
    """What a shard takes on a worker of speed 1 [s]."""

    shard: float = 2.0  # set-up: sandbox, model
    candidate: float = 1.0
    start: float = 15.0  # of a worker
    parts: int = 4  # messages in which a shard's results come


@dataclass(frozen=True)
class Faults:
    """How often what goes wrong. Rates are of one worker [1/h], shares are of one message or of all workers."""

    deaths: float = 0.05
    hangs: float = 0.02
    no_room: float = 0.05
    lost: float = 0.0005
    repeated: float = 0.005
    late: float = 0.001  # comes a minute later than it should, perhaps of a worker that was given up
    slow: float = 0.02  # of workers
    slowness: float = 3.0

    def times(self, factor: float) -> Faults:
        """All of them so many times as often."""
        more = {
            name: factor * getattr(self, name) for name in ("deaths", "hangs", "no_room", "lost", "repeated", "late")
        }
        return Faults(**more, slow=self.slow, slowness=self.slowness)


@dataclass
class Worker:
    """One, at its place; `life` tells it from those before it there."""

    speed: float
    life: int = 0
    ready: float = 0.0  # [s]
    ticket: int | None = None


@dataclass
class Cluster:
    """Simulated workers; a `wsim.sweep.shards.Workers`."""

    count: int
    costs: Costs
    faults: Faults
    seed: int = 0
    guilty: Collection[int] = ()  # items that kill who is at them
    stuck: Collection[int] = ()  # items that hang
    clock: float = 0.0
    seen: Counter[str] = field(default_factory=Counter)

    def __post_init__(self) -> None:
        """Draw who is slow."""
        self.random = random.Random(self.seed)
        slow = set(self.random.sample(range(self.count), round(self.faults.slow * self.count)))
        self.workers = [Worker(1.0 / self.faults.slowness if k in slow else 1.0) for k in range(self.count)]
        self._free = dict.fromkeys(range(self.count))
        self._events: list[tuple[float, int, int, int, Heard | None]] = []
        self._order = itertools.count()

    @property
    def places(self) -> Collection[int]:
        """One for each worker."""
        return range(self.count)

    @property
    def speed(self) -> float:
        """Of all workers together."""
        return sum(worker.speed for worker in self.workers)

    def now(self) -> float:
        """The simulated clock [s]."""
        return self.clock

    def idle(self) -> Sequence[int]:
        """Who waits for work."""
        return list(self._free)

    def give(self, attempt: Attempt, task: Any) -> None:
        """Lay out what this attempt will say, and when, or what ends it."""
        worker = self.workers[attempt.place]
        worker.ticket = attempt.ticket
        del self._free[attempt.place]
        fault, ends = self._fault(attempt)
        when = max(self.clock, worker.ready) + self.costs.shard / worker.speed
        size = math.ceil(len(attempt.items) / self.costs.parts)
        for first in range(0, len(attempt.items), size):
            part = attempt.items[first : first + size]
            culprit = next((k for k, item in enumerate(part) if item in self.guilty or item in self.stuck), None)
            if culprit is not None and part[culprit] in self.stuck:
                return
            if culprit is not None:
                ends, fault = min((ends, fault), (when + self.costs.candidate * culprit / worker.speed, KILLED))
            when += self.costs.candidate * len(part) / worker.speed
            if when >= ends:
                break
            self._say(when, attempt, Heard(attempt.ticket, [(item, 7 * item) for item in part]))
        if when < ends:
            self._say(when, attempt, Heard(attempt.ticket, over=True))
        elif fault != "hangs":
            self._at(ends, attempt, Heard(attempt.ticket, over=True, lost=Lost(fault, again=True)))

    def hear(self, until: float) -> Sequence[Heard]:
        """What is said next; the clock moves on to then, or to `until`."""
        if not self._events or self._events[0][0] > until:
            assert math.isfinite(until), "nobody is left who would say anything"
            self.clock = max(self.clock, until)
            return []
        self.clock, _, place, life, said = heapq.heappop(self._events)
        if said is None:  # a place has its worker back
            self._free[place] = None
            return []
        worker = self.workers[place]
        own = worker.life == life and worker.ticket == said.ticket
        if said.lost and not own:
            return []  # it was given up before it died
        if said.over and own:
            worker.ticket = None
            if said.lost:
                self._renew(place)
            else:
                self._free[place] = None
        return [said]

    def end(self, place: int) -> None:
        """Stop a worker; another one takes its place."""
        self.seen["given up"] += 1
        self._renew(place)

    def stop(self) -> None:
        """Nothing is left to do."""

    def _renew(self, place: int) -> None:
        worker = self.workers[place]
        worker.life, worker.ticket = worker.life + 1, None
        worker.ready = self.clock + self.costs.start
        heapq.heappush(self._events, (worker.ready, next(self._order), place, worker.life, None))

    def _fault(self, attempt: Attempt) -> tuple[str, float]:
        rates = {KILLED: self.faults.deaths, "hangs": self.faults.hangs, NO_ROOM: self.faults.no_room}
        drawn = {name: self.random.expovariate(rate / 3600.0) if rate else math.inf for name, rate in rates.items()}
        first = min(drawn, key=drawn.__getitem__)
        return first, attempt.started + drawn[first]

    def _say(self, when: float, attempt: Attempt, said: Heard) -> None:
        if self.random.random() < self.faults.lost:
            self.seen["message lost"] += 1
            return
        if self.random.random() < self.faults.late:
            self.seen["message late"] += 1
            when += 60.0 + 3600.0 * self.random.random() ** 4
        self._at(when, attempt, said)
        if self.random.random() < self.faults.repeated:
            self.seen["message repeated"] += 1
            self._at(when + 120.0 * self.random.random(), attempt, said)

    def _at(self, when: float, attempt: Attempt, said: Heard) -> None:
        if said.lost:
            self.seen[said.lost.reason] += 1
        life = self.workers[attempt.place].life
        heapq.heappush(self._events, (when, next(self._order), attempt.place, life, said))


@dataclass(frozen=True)
class Told:
    """What a simulated sweep came to."""

    seconds: float
    ideal: float
    done: int
    lost: dict[int, Lost]
    twice: int
    wrong: int
    given: int
    seen: Counter[str]

    @property
    def overhead(self) -> float:
        """Time beyond the ideal, as a share of it."""
        return self.seconds / self.ideal - 1.0


def simulate(cluster: Cluster, count: int, most: int, least: int, patience: float = 600.0) -> Told:
    """Run so many candidates, and count what came of each."""
    came: dict[int, Any] = {}
    twice = given = 0

    def pack(items: tuple[int, ...]) -> None:
        nonlocal given
        given += len(items)

    for found in run(Dealer(count, most, patience, least), range(count), pack, cluster):
        for item, result in found:
            twice += item in came
            came[item] = result
    lost = {item: result for item, result in came.items() if isinstance(result, Lost)}
    wrong = sum(result != 7 * item for item, result in came.items() if item not in lost)
    work = count * (cluster.costs.candidate + cluster.costs.shard / most)
    return Told(cluster.clock, work / cluster.speed, len(came), lost, twice, wrong, given, cluster.seen)


def main() -> None:
    """Print a line for each seed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--workers", type=int, default=1000)
    parser.add_argument("--candidates", type=int, default=1_000_000)
    parser.add_argument("--most", type=int, default=64, help="candidates of a shard")
    parser.add_argument("--least", type=int, default=8, help="candidates of the last shards")
    parser.add_argument("--seconds", type=float, default=1.0, help="of a candidate in its shard")
    parser.add_argument("--shard", type=float, default=2.0, help="seconds that a shard takes besides")
    parser.add_argument("--start", type=float, default=15.0, help="seconds that a worker takes to start")
    parser.add_argument("--parts", type=int, default=4, help="messages in which a shard's results come")
    parser.add_argument("--faults", type=float, default=1.0, help="times as many of them")
    parser.add_argument("--guilty", type=int, default=3, help="candidates that kill their worker")
    parser.add_argument("--stuck", type=int, default=0, help="candidates that hang; each takes its patience twice")
    parser.add_argument("--seeds", type=int, default=3)
    given = parser.parse_args()
    print("seed  hours  ideal  worker-hours  overhead  done     guilty  innocent  twice  wrong  given again  faults")
    for seed in range(given.seeds):
        drawn = random.Random(seed).sample(range(given.candidates), given.guilty + given.stuck)
        bad = set(drawn)
        faults, costs = Faults().times(given.faults), Costs(given.shard, given.seconds, given.start, given.parts)
        cluster = Cluster(given.workers, costs, faults, seed, set(drawn[: given.guilty]), set(drawn[given.guilty :]))
        started = time.perf_counter()
        told = simulate(cluster, given.candidates, given.most, given.least)
        again = told.given / given.candidates - 1.0
        print(
            f"{seed:4}  {told.seconds / 3600:5.3f}  {told.ideal / 3600:5.3f}"
            f" {given.workers * told.seconds / 3600:13.1f}  {told.overhead:8.2%}  {told.done:8}"
            f" {len(told.lost.keys() & bad):7} {len(told.lost.keys() - bad):9} {told.twice:6} {told.wrong:6}"
            f"  {again:10.2%}  "
            + ", ".join(f"{n} {name}" for name, n in sorted(told.seen.items()))
            + f" ({time.perf_counter() - started:.0f} s)"
        )
        assert told.done == given.candidates and not told.twice and not told.wrong and bad <= told.lost.keys()


if __name__ == "__main__":
    main()
