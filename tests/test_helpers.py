"""Forks that wait to be asked: they answer in order, with errors, for as long as who asks, and are asked again."""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections.abc import Iterator
from functools import partial
from multiprocessing.connection import Connection

import pytest

from tests.processes import lives
from wsim import helpers
from wsim.errors import UserError
from wsim.forks import LostForkError, shared_out


@pytest.fixture(autouse=True)
def three() -> Iterator[None]:
    helpers.start(3)
    yield
    helpers.end()


def who(_: int) -> int:
    return os.getpid()


def much(length: int, k: int) -> tuple[int, str]:
    return k, "x" * length  # more than a pipe holds


def refuses_three(k: int) -> int:
    if k == 3:
        raise UserError(f"number {k}")
    return k


def misses_a_file(k: int) -> int:
    raise FileNotFoundError(f"no file {k}")


def dies_at_four(k: int) -> int:
    if k == 4:
        os.kill(os.getpid(), signal.SIGKILL)
    return k


def test_the_same_are_asked_again() -> None:
    first, second = (set(shared_out(who, range(40), 3)) for _ in range(2))
    assert first | second == set(shared_out(who, range(40), 3)) | first
    assert len(first | second) == 3
    assert os.getpid() not in first
    assert len(set(shared_out(who, range(40), 2))) <= 2


@pytest.mark.parametrize("processes", [2, 3, 40])
def test_all_comes_in_order(processes: int) -> None:
    items = ["y" * 100_000] * 5
    assert list(shared_out(len, items, processes)) == [100_000] * 5
    assert [k for k, _ in shared_out(partial(much, 300_000), range(17), processes)] == list(range(17))


def test_what_cannot_be_sent_to_them_is_forked() -> None:
    known = set(shared_out(who, range(40), 3))
    here = {k: k * k for k in range(5)}
    assert list(shared_out(lambda k: here[k], range(5), 3)) == list(here.values())
    assert not known & set(shared_out(lambda _: os.getpid(), range(5), 3))


def test_what_is_raised_there_is_raised_here_and_they_are_started_again() -> None:
    with pytest.raises(UserError, match="number 3"):
        list(shared_out(refuses_three, range(6), 3))
    helpers.start(3)
    assert list(shared_out(refuses_three, range(3), 3)) == [0, 1, 2]


def test_an_error_of_the_system_that_a_call_raises_is_not_taken_for_a_lost_helper() -> None:
    with pytest.raises(FileNotFoundError, match="no file"):
        list(shared_out(misses_a_file, range(6), 3))


def test_who_is_killed_is_told_of_and_nobody_is_left() -> None:
    pids = set(shared_out(who, range(40), 3))
    with pytest.raises(LostForkError):
        list(shared_out(dies_at_four, range(6), 3))
    assert not any(map(lives, pids))
    assert list(shared_out(who, range(6), 3)) != []  # by forks


def test_who_asks_for_no_more_leaves_nobody_behind() -> None:
    pids = set(shared_out(who, range(40), 3))
    found = shared_out(partial(much, 300_000), range(100), 3)
    assert next(found)[0] == 0
    found.close()
    assert not any(map(lives, pids))


def test_who_asks_while_they_are_asked_forks() -> None:
    known = set(shared_out(who, range(40), 3))
    found = shared_out(partial(much, 10), range(9), 3)
    assert next(found)[0] == 0
    assert not known & set(shared_out(who, range(6), 3))
    assert [k for k, _ in found] == list(range(1, 9))


def _owner(pipe: Connection) -> None:
    helpers.start(2)
    pipe.send(list(shared_out(who, range(9), 2)))
    signal.pause()


def test_they_end_with_who_asks() -> None:
    ours, theirs = multiprocessing.Pipe()
    process = multiprocessing.get_context("spawn").Process(target=_owner, args=(theirs,), daemon=True)
    process.start()
    pids = set(ours.recv())
    assert pids
    process.kill()
    process.join()
    for pid in pids:
        for _ in range(1000):
            if not lives(pid):
                break
            signal.sigtimedwait([], 0.01)
        assert not lives(pid)
