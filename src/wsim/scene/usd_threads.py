"""Whether a process that reads stages may be forked."""

from __future__ import annotations

from pxr import Work

# Of the environment, for a process that is to be forked: USD reads it when it is loaded, and else says on the terminal
# that it did.
ONE_THREAD = {"PXR_WORK_THREAD_LIMIT": "1", "TF_ENV_SETTING_ALERTS_ENABLED": "0"}


def forks(processes: int) -> int:
    """As many as are asked for where USD works in one thread; else one: a fork has not the threads that hold its locks.

    A process that is to be forked is started with `ONE_THREAD` in its environment.
    """
    return processes if Work.GetConcurrencyLimit() == 1 else 1
