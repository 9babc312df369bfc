"""One call on many things, shared out to forked processes: they see what is there uncopied, and send back results."""

from __future__ import annotations

import contextlib
import gc
import multiprocessing
import os
import signal
from collections.abc import Callable, Generator, Iterator, Sequence
from multiprocessing.connection import Connection
from typing import TypeVar

from wsim import helpers
from wsim.helpers import LostForkError, answered, fork, taken

__all__ = ["LostForkError", "shared_out", "uncollected"]

Item = TypeVar("Item")
Value = TypeVar("Value")


def shared_out(call: Callable[[Item], Value], items: Sequence[Item], processes: int) -> Generator[Value, None, None]:
    """`call` of each item, in order. What it gives is pickled; what it raises is raised here.

    Where helpers wait (`wsim.helpers`), a call that can be pickled goes to them, item by item. Others are forked anew.

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
    if (packed := helpers.packed(call)) and (waiting := helpers.free()):
        with contextlib.closing(waiting.each(packed, items, count)) as found:
            yield from found
        return
    children: list[tuple[int, Connection]] = []
    try:
        for first in range(count):
            children.append(_fork(call, items[first::count], [pipe for _, pipe in children]))
        for k in range(len(items)):
            yield taken(children[k % count][1])
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


def _fork(call: Callable[[Item], Value], items: Sequence[Item], others: Sequence[Connection]) -> tuple[int, Connection]:
    ours, theirs = multiprocessing.Pipe(duplex=False)
    return fork(lambda: _send_all(call, items, theirs), theirs, ours, others), ours


def _send_all(call: Callable[[Item], Value], items: Sequence[Item], pipe: Connection) -> None:
    for item in items:
        pipe.send(answered(call, item))
