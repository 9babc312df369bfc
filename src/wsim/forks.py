"""One call on many things, shared out to forked processes: they see what is there uncopied, and send back results."""

from __future__ import annotations

import contextlib
import ctypes
import gc
import multiprocessing
import os
import signal
from collections.abc import Callable, Generator, Iterator, Sequence
from multiprocessing.connection import Connection
from typing import Any, TypeVar

Item = TypeVar("Item")
Value = TypeVar("Value")

_PR_SET_PDEATHSIG = 1  # of prctl(2)
_LIBC = ctypes.CDLL(None)


class LostForkError(RuntimeError):
    """A forked process ended before it had sent what it was to."""


def shared_out(call: Callable[[Item], Value], items: Sequence[Item], processes: int) -> Generator[Value, None, None]:
    """`call` of each item, in order. What it gives is pickled; what it raises is raised here.

    A process whose own parent may have no children by `multiprocessing` (a daemon) has these all the same. They live no
    longer than the thread that asks, nor than the iterator. A child has only the thread that forked it, so `call` is to
    need no lock that another thread may hold, and no device; nor does it collect its parent's garbage, some of which
    may lie on one.

    Args:
        call: Also a closure; one child works off every n-th item.
        items: They.
        processes: How many; with one, or where a system cannot fork, all is done here.

    Raises:
        LostForkError: If a child dies.
    """
    count = min(processes, len(items))
    if count < 2 or not hasattr(os, "fork"):
        yield from map(call, items)
        return
    children: list[tuple[int, Connection]] = []
    try:
        for first in range(count):
            children.append(_fork(call, items[first::count], [pipe for _, pipe in children]))
        for k in range(len(items)):
            yield _taken(children[k % count][1])
    finally:
        for pid, pipe in children:
            pipe.close()
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
            os.waitpid(pid, 0)


@contextlib.contextmanager
def uncollected() -> Iterator[None]:
    """No garbage is looked for within: it would be among all that is kept, again and again while more of it is made."""
    was = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was:
            gc.enable()


def _taken(pipe: Connection) -> Any:
    try:
        done, value = pipe.recv()
    except (EOFError, OSError) as error:
        raise LostForkError("a forked process ended before its work was done") from error
    if not done:
        raise value
    return value


def _fork(call: Callable[[Item], Value], items: Sequence[Item], others: Sequence[Connection]) -> tuple[int, Connection]:
    ours, theirs = multiprocessing.Pipe(duplex=False)
    parent = os.getpid()
    pid = os.fork()
    if pid:
        theirs.close()
        return pid, ours
    try:
        gc.freeze()
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, signal.SIG_DFL)
        if hasattr(_LIBC, "prctl"):
            _LIBC.prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
        if os.getppid() == parent:
            for pipe in (ours, *others):
                pipe.close()
            _send_all(call, items, theirs)
    finally:
        os._exit(0)  # nothing that the parent has open is flushed or cleaned up twice


def _send_all(call: Callable[[Item], Value], items: Sequence[Item], pipe: Connection) -> None:
    found: tuple[bool, Value | Exception]
    for item in items:
        try:
            found = (True, call(item))
        except Exception as error:  # noqa: BLE001 - raised again where it was asked for
            found = (False, error)
        pipe.send(found)
