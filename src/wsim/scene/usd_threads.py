"""Whether a process that reads stages may be forked."""

from __future__ import annotations

from pxr import Work

LIMIT = "PXR_WORK_THREAD_LIMIT"  # of the environment; USD reads it when it is loaded


def forks(processes: int) -> int:
    """As many as are asked for where USD works in one thread; else one: a fork has not the threads that hold its locks.

    A process that is to be forked is started with `LIMIT` = 1.
    """
    return processes if Work.GetConcurrencyLimit() == 1 else 1
