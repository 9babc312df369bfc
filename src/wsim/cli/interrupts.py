"""Ctrl-C that is never dropped: neither by an object that is being deleted, nor by the report of what that raised."""

from __future__ import annotations

import signal
import sys
from types import FrameType

LATER = 0.02  # [s]: by then the object is gone


def keep_interrupts() -> None:
    """Raise a Ctrl-C again that came while an object was being deleted: Python drops what `__del__` raises.

    It reports what it drops by a hook. What is raised in there, by a Ctrl-C too, it would print and drop as well, so
    that one waits until the hook is left. A clock's signal brings it back: a thread cannot be started at every place
    where a signal may come.
    """
    report = sys.unraisablehook

    def hook(dropped: sys.UnraisableHookArgs) -> None:
        if dropped.exc_type is KeyboardInterrupt:
            signal.setitimer(signal.ITIMER_REAL, LATER)
        else:
            report(dropped)

    def stop(number: int, frame: FrameType | None) -> None:
        while frame is not None:
            if frame.f_code is hook.__code__:
                signal.setitimer(signal.ITIMER_REAL, LATER)
                return
            frame = frame.f_back
        raise KeyboardInterrupt

    sys.unraisablehook = hook
    for number in (signal.SIGINT, signal.SIGALRM):
        signal.signal(number, stop)


def ignore_interrupts() -> None:
    """Nothing is left to stop but Python's own end, which is to keep the exit code.

    A Ctrl-C that comes within an `exec` of text, as dataclasses are made by, leaves a mark in the interpreter, though
    it was caught long ago: started by `-m`, Python would end itself by that signal. The next `exec` of text clears it.
    """
    exec("")
    for number in (signal.SIGINT, signal.SIGALRM):
        signal.signal(number, signal.SIG_IGN)
