"""Workers that die, hang or raise lose what they were at, and nothing else."""

from __future__ import annotations

import gc
import os
import signal
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.children import started
from tests.processes import below, lives
from wsim import helpers
from wsim.sweep.pool import Pool, each
from wsim.sweep.shards import Dealer, Lost, run


def double(task: int) -> int:
    return 2 * task


def dies_at_three(task: int) -> int:
    if task == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    return task


def dies_once(task: str) -> str:
    """The first who comes leaves a file, and dies."""
    if not Path(task).exists():
        Path(task).touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return "done"


def sleeps_at_two(task: int) -> int:
    time.sleep(600.0 if task == 2 else 0.0)
    return task


def raises(task: int) -> int:
    raise LookupError(str(task))


def searched(task: int) -> tuple[int, int, bool]:
    """What a worker keeps from the search for garbage, what it searches, and whether it does."""
    return gc.get_freeze_count(), len(gc.get_objects()), gc.isenabled()


def test_what_a_worker_loads_is_kept_from_the_search_for_garbage() -> None:
    ((_, (kept, looked_at, collects)),) = each(searched, [0], 1, 60.0)
    assert kept > 20 * looked_at
    assert collects


def waiting(_: object) -> Iterator[list[tuple[int, list[int]]]]:
    """What processes a worker has, and that it can ask as many."""
    there = helpers.free()
    pids = list(below(os.getpid()))
    assert len(pids) == (there.count if there else 0)
    yield [(0, pids)]


@pytest.mark.parametrize(("cores", "count"), [(1, 0), (3, 3)])
def test_a_worker_of_several_cores_has_helpers_that_end_with_it(cores: int, count: int) -> None:
    pool = Pool(waiting, 1, cores=cores)
    ((_, pids),) = [each for came in run(Dealer(1, 1, 600.0), [0], lambda _: 0, pool) for each in came]
    assert len(pids) == count
    late = time.monotonic() + 60.0
    while any(map(lives, pids)) and time.monotonic() < late:
        time.sleep(0.01)
    assert not any(map(lives, pids))


def test_every_task_has_its_result() -> None:
    assert sorted(each(double, range(9), 2, 60.0)) == [(k, 2 * k) for k in range(9)]
    assert list(each(double, [], 2, 60.0)) == []


def test_who_kills_two_workers_is_lost_and_the_others_are_not() -> None:
    results = dict(each(dies_at_three, range(7), 2, 60.0))
    lost = results.pop(3)
    assert isinstance(lost, Lost)
    assert "signal 9" in lost.reason
    assert results == {k: k for k in range(7) if k != 3}


def test_who_dies_once_is_tried_again(tmp_path) -> None:
    assert [result for _, result in each(dies_once, [str(tmp_path / "was here")], 1, 60.0)] == ["done"]


def test_who_hangs_is_given_up() -> None:
    started = time.monotonic()
    results = dict(each(sleeps_at_two, range(4), 2, 4.0))
    assert results[2] == Lost("took more than 4 s")
    assert [results[k] for k in (0, 1, 3)] == [0, 1, 3]
    assert time.monotonic() - started < 60.0


def test_work_that_raises_is_lost_with_what_it_says_and_its_worker_goes_on() -> None:
    assert list(each(raises, [1, 2], 1, 60.0)) == [
        (1, Lost("LookupError: 1")),
        (2, Lost("LookupError: 2")),
    ]


def in_turn(tasks: tuple[int, ...]) -> Iterator[list[tuple[int, int]]]:
    for place, task in enumerate(tasks):
        yield [(place, sleeps_at_two(task))]


def test_who_stops_listening_leaves_no_process_behind() -> None:
    pool = Pool(in_turn, 2)
    results = run(Dealer(3, 1, 600.0), [0, 2, 2], lambda items: items, pool)
    assert next(results) == [(0, 0)]
    workers = [worker.process for worker in pool._workers.values()]
    results.close()
    assert workers and not any(worker.is_alive() for worker in workers)


def in_turn_and_dies(tasks: tuple[int, ...]) -> Iterator[list[tuple[int, int]]]:
    for place, task in enumerate(tasks):
        yield [(place, dies_at_three(task))]


def test_what_a_worker_had_done_before_it_died_is_kept(tmp_path) -> None:
    """Of six to a shard the fourth kills: three are done once, the guilty one alone is lost."""
    asked: list[tuple[int, ...]] = []

    def pack(items: tuple[int, ...]) -> tuple[int, ...]:
        asked.append(items)
        return items

    found = dict(pair for some in run(Dealer(6, 6, 60.0), range(6), pack, Pool(in_turn_and_dies, 1)) for pair in some)
    lost = found.pop(3)
    assert isinstance(lost, Lost) and "signal 9" in lost.reason
    assert found == {k: k for k in (0, 1, 2, 4, 5)}
    assert asked == [(0, 1, 2, 3, 4, 5), (3, 4, 5), (3,), (3,), (4,), (5,)]


def its_gpu(tasks: tuple[int, ...]) -> Iterator[list[tuple[int, str]]]:
    time.sleep(0.5)  # so that each place has one
    yield [(place, os.environ["CUDA_VISIBLE_DEVICES"]) for place, _ in enumerate(tasks)]


def test_each_place_sees_its_own_gpu() -> None:
    pool = Pool(its_gpu, 2, [{"CUDA_VISIBLE_DEVICES": "4"}, {"CUDA_VISIBLE_DEVICES": "7"}])
    found = [pair for some in run(Dealer(2, 1, 60.0), range(2), lambda items: items, pool) for pair in some]
    assert sorted(found) == [(0, "4"), (1, "7")]
    assert "CUDA_VISIBLE_DEVICES" not in os.environ


def test_no_more_processes_than_tasks() -> None:
    pool = Pool(in_turn, 3)
    results = run(Dealer(1, 1, 60.0), [1], lambda items: items, pool)
    assert next(results) == [(1, 1)]
    assert len(pool._workers) == 1
    results.close()


def test_a_process_does_not_outlive_who_started_it() -> None:
    """It would keep a GPU, or a core, for as long as what it is at takes."""
    text = "import time; from wsim.sweep.pool import each; list(each(time.sleep, [600.0], 1, 600.0))"
    with started([sys.executable, "-c", text]) as parent:
        until = time.monotonic() + 60.0
        while not (own := [pid for pid, name in below(parent.pid).items() if "spawn_main" in name]):
            assert time.monotonic() < until
            time.sleep(0.1)
        time.sleep(3.0)  # it has loaded, and sleeps
        parent.kill()
        parent.wait()
        until = time.monotonic() + 10.0
        while any(map(lives, own)) and time.monotonic() < until:
            time.sleep(0.1)
        assert not any(map(lives, own))
