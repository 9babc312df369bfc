"""Workers that die, hang or raise lose what they were at, and nothing else."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path

import pytest

from wsim.sweep.pool import Lost, Pool


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


def test_every_task_has_its_result() -> None:
    assert sorted(Pool(double, 2, lambda task: 60.0).run(range(9))) == [(k, 2 * k) for k in range(9)]
    assert list(Pool(double, 2, lambda task: 60.0).run([])) == []


def test_who_kills_two_workers_is_lost_and_the_others_are_not() -> None:
    results = dict(Pool(dies_at_three, 2, lambda task: 60.0).run(range(7)))
    lost = results.pop(3)
    assert isinstance(lost, Lost)
    assert "signal 9" in lost.reason
    assert results == {k: k for k in range(7) if k != 3}


def test_who_dies_once_is_tried_again(tmp_path) -> None:
    assert [result for _, result in Pool(dies_once, 1, lambda task: 60.0).run([str(tmp_path / "was here")])] == ["done"]


def test_who_hangs_is_given_up() -> None:
    started = time.monotonic()
    results = dict(Pool(sleeps_at_two, 2, lambda task: 4.0).run(range(4)))
    assert results[2] == Lost("took more than 4 s")
    assert [results[k] for k in (0, 1, 3)] == [0, 1, 3]
    assert time.monotonic() - started < 60.0


def test_work_that_raises_is_lost_with_what_it_says_and_its_worker_goes_on() -> None:
    assert list(Pool(raises, 1, lambda task: 60.0).run([1, 2])) == [
        (1, Lost("LookupError: 1")),
        (2, Lost("LookupError: 2")),
    ]


def test_who_stops_listening_leaves_no_process_behind() -> None:
    pool = Pool(sleeps_at_two, 2, lambda task: 600.0)
    results = pool.run([0, 2, 2])
    assert next(results) == (0, 0)
    workers = [worker.process for worker in pool._workers]
    results.close()
    assert not any(worker.is_alive() for worker in workers)


@pytest.mark.parametrize("workers", [1, 3])
def test_more_workers_than_tasks_are_not_started(workers: int) -> None:
    pool = Pool(double, workers, lambda task: 60.0)
    results = pool.run([1])
    assert next(results) == (1, 2)
    assert len(pool._workers) == 1
    results.close()
