"""Processes that tests start: each hears Ctrl-C however the tests were started, and leaves none of its own behind."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
from collections.abc import Iterator, Sequence
from typing import Any


def start(command: Sequence[str], **given: Any) -> subprocess.Popen[str]:
    """Start a command as the first of its own process group.

    A shell starts what it puts in the background with SIGINT ignored, and a process hands that on to its children: a
    child would not end at the Ctrl-C that a test sends. So SIGINT has a handler while the child is made; a handler is
    not handed on, and the child begins with the default.
    """
    before = signal.getsignal(signal.SIGINT)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        return subprocess.Popen(command, text=True, start_new_session=True, **given)
    finally:
        signal.signal(signal.SIGINT, before)


def end_group(process: subprocess.Popen[str]) -> None:
    """Kill what is left of a started command and of all that it started, and close its pipes."""
    with contextlib.suppress(ProcessLookupError):  # all of them have ended
        os.killpg(process.pid, signal.SIGKILL)
    process.communicate()


@contextlib.contextmanager
def started(command: Sequence[str], **given: Any) -> Iterator[subprocess.Popen[str]]:
    """A command that runs; whatever becomes of the test, nothing of it is left afterwards."""
    process = start(command, **given)
    try:
        yield process
    finally:
        end_group(process)
