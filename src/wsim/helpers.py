"""Processes that are forked once, and asked many times.

A fork takes as long as what the process holds is large: 60 ms of one that has loaded the simulator, and more of one
that is at a GPU. A worker that has sixteen of them judge each batch waits for that longer than for their verdicts.
Those that are forked at its start cost that once; what they are asked, and of what, is sent to them.
"""

from __future__ import annotations

import contextlib
import ctypes
import gc
import multiprocessing
import os
import pickle
import signal
import threading
from collections.abc import Callable, Generator, Sequence
from multiprocessing.connection import Connection, wait
from typing import Any

_PR_SET_PDEATHSIG = 1  # of prctl(2)
_LIBC = ctypes.CDLL(None)

Answer = tuple[bool, Any]  # whether it was found, and what; else what was raised


class LostForkError(RuntimeError):
    """A forked process ended before it had sent what it was to."""


class Helpers:
    """Forks of this process as it is now, each of which waits to be asked.

    Args:
        count: How many.
    """

    def __init__(self, count: int) -> None:
        self._owner, self._asked = os.getpid(), threading.Lock()
        self._those: list[tuple[int, Connection]] = []
        for _ in range(count):
            ours, theirs = multiprocessing.Pipe()
            others = [pipe for _, pipe in self._those]
            self._those.append((fork(lambda pipe=theirs: _serve(pipe), theirs, ours, others), ours))  # type: ignore[misc]

    @property
    def count(self) -> int:
        """How many there are."""
        return len(self._those)

    @property
    def free(self) -> bool:
        """Whether they can be asked now: from the thread that lives as long as they do, and by nobody else."""
        here = os.getpid() == self._owner and threading.current_thread() is threading.main_thread()
        return bool(here and self._those and not self._asked.locked())

    def each(self, call: bytes, items: Sequence[Any], most: int) -> Generator[Any, None, None]:
        """What a call gives of each item, in order; what it raises is raised here.

        Each helper has one item at a time. If it is left before all have come, or one dies, all of them end.

        Args:
            call: Pickled.
            items: They.
            most: Helpers that are asked.

        Raises:
            LostForkError: If a helper dies.
        """
        with self._asked:
            free, given, whole = [pipe for _, pipe in self._those[:most]], 0, False
            at, found = dict[Connection, int](), dict[int, Any]()
            try:
                for k in range(len(items)):
                    while k not in found:
                        while free and given < len(items):
                            pipe = free.pop()
                            _send(pipe, (call, items[given]))
                            at[pipe] = given
                            given += 1
                        ready = wait(list(at))
                        for pipe in [each for each in at if each in ready]:
                            found[at.pop(pipe)] = taken(pipe)
                            free.append(pipe)
                    yield found.pop(k)
                whole = True
            finally:
                if not whole:
                    self.end()

    def end(self) -> None:
        """End all of them, whatever they are at."""
        those, self._those = self._those, []
        for pid, pipe in those:
            pipe.close()
            with contextlib.suppress(ProcessLookupError, ChildProcessError):
                os.kill(pid, signal.SIGKILL)
                os.waitpid(pid, 0)


_waiting: list[Helpers] = []  # of this process, one at most


def start(count: int) -> None:
    """Have so many helpers wait from now on, if there are fewer. With one, or where a system cannot fork, have none."""
    if count < 2 or not hasattr(os, "fork") or any(each.free and each.count >= count for each in _waiting):
        return
    end()
    _waiting.append(Helpers(count))


def end() -> None:
    """Have none any more."""
    while _waiting:
        helpers = _waiting.pop()
        if helpers.free:
            helpers.end()


def free() -> Helpers | None:
    """Those that wait, and can be asked now."""
    return next((each for each in _waiting if each.free), None)


def packed(call: Callable[[Any], Any]) -> bytes:
    """A call as it is sent; empty where it cannot be, as it sees what is here alone."""
    try:
        return pickle.dumps(call) if _waiting else b""
    except (pickle.PicklingError, AttributeError, TypeError):
        return b""


def fork(run: Callable[[], None], theirs: Connection, ours: Connection, others: Sequence[Connection]) -> int:
    """Fork a process that runs something, and ends with the thread that forked it at the latest; its id.

    Args:
        run: What it does, with its end of a pipe.
        theirs: That end, which is closed here.
        ours: The other end, which is closed there.
        others: Ends of other forks' pipes, likewise.
    """
    parent = os.getpid()
    pid = os.fork()
    if pid:
        theirs.close()
        return pid
    try:
        gc.freeze()
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, signal.SIG_DFL)
        if hasattr(_LIBC, "prctl"):
            _LIBC.prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
        if os.getppid() == parent:
            for pipe in (ours, *others):
                pipe.close()
            run()
    finally:
        os._exit(0)  # nothing that the parent has open is flushed or cleaned up twice


def answered(call: Callable[[Any], Any], item: Any) -> Answer:
    """What comes of a call, as it is sent."""
    try:
        return True, call(item)
    except Exception as error:  # noqa: BLE001 - raised again where it was asked for
        return False, error


def _send(pipe: Connection, what: Any) -> None:
    try:
        pipe.send(what)
    except OSError as error:
        raise LostForkError("a helper ended before its work was done") from error


def taken(pipe: Connection) -> Any:
    """What was sent as `answered`. Raises that or, if who was to send it has ended, LostForkError."""
    try:
        done, value = pipe.recv()
    except (EOFError, OSError) as error:
        raise LostForkError("a forked process ended before its work was done") from error
    if not done:
        raise value
    return value


def _serve(pipe: Connection) -> None:
    """In a helper: answer until nobody is there to ask."""
    with contextlib.suppress(EOFError, OSError):
        while True:
            call, item = pipe.recv()
            pipe.send(answered(pickle.loads(call), item))
