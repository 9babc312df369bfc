"""Work that is shared out to forks comes back in order, with its errors, and leaves nobody behind."""

from __future__ import annotations

import gc
import multiprocessing
import os
import signal
from multiprocessing.connection import Connection

import pytest

from wsim.errors import UserError
from wsim.forks import LostForkError, shared_out


@pytest.mark.parametrize("processes", [1, 2, 5, 40])
def test_all_comes_in_order(processes: int) -> None:
    known = {k: "x" * (k * 5000) for k in range(17)}  # more than a pipe holds
    assert list(shared_out(lambda k: known[k], range(17), processes)) == list(known.values())
    assert list(shared_out(lambda k: known[k], [], processes)) == []


def test_it_is_done_elsewhere_and_nobody_is_left() -> None:
    pids = list(shared_out(lambda _: os.getpid(), range(6), 3))
    assert len(set(pids)) == 3
    assert os.getpid() not in pids
    for pid in pids:
        with pytest.raises(ProcessLookupError):
            os.kill(pid, 0)


def test_what_is_raised_there_is_raised_here() -> None:
    def call(k: int) -> int:
        if k == 3:
            raise UserError(f"number {k}")
        return k

    found = shared_out(call, range(6), 2)
    assert [next(found) for _ in range(3)] == [0, 1, 2]
    with pytest.raises(UserError, match="number 3"):
        next(found)


def test_who_is_killed_is_told_of() -> None:
    def call(k: int) -> int:
        if k == 4:
            os.kill(os.getpid(), signal.SIGKILL)
        return k

    with pytest.raises(LostForkError):
        list(shared_out(call, range(6), 3))


def test_what_cannot_be_sent_is_told_of() -> None:
    with pytest.raises(LostForkError):
        list(shared_out(lambda k: lambda: k, range(4), 2))


def test_who_asks_for_no_more_leaves_nobody_behind() -> None:
    found = shared_out(lambda _: (os.getpid(), "x" * 100_000), range(100), 2)
    pids = [next(found)[0], next(found)[0]]
    found.close()  # type: ignore[attr-defined]
    for pid in pids:
        with pytest.raises(ProcessLookupError):
            os.kill(pid, 0)


def _daemon(pipe: Connection) -> None:
    pipe.send(list(shared_out(lambda k: k * k, range(4), 2)))


def test_a_daemon_may_have_forks() -> None:
    ours, theirs = multiprocessing.Pipe()
    process = multiprocessing.get_context("spawn").Process(target=_daemon, args=(theirs,), daemon=True)
    process.start()
    assert ours.poll(60.0)
    assert ours.recv() == [0, 1, 4, 9]
    process.join()


class _Held:
    """Something of a cycle that says, as it is thrown away, in which process it is."""

    def __init__(self, told: list[int]) -> None:
        self.told, self.itself = told, self

    def __del__(self) -> None:
        self.told.append(os.getpid())


def test_a_parents_garbage_is_left_to_it() -> None:
    """What lies on a GPU can be given back by the process alone that has it."""
    told: list[int] = []
    gc.disable()
    try:
        _Held(told)  # garbage from here on

        def call(_: int) -> list[int]:
            gc.collect()
            return list(told)

        assert list(shared_out(call, range(2), 2)) == [[], []]
        gc.collect()
        assert told == [os.getpid()]
    finally:
        gc.enable()
