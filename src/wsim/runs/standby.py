"""A process that loads the simulator while nobody knows yet what it is to run."""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
from types import TracebackType


class Standby:
    """A command that loads, and then waits for a program: the run that confirms another is ready as soon as that is.

    It is a command, and no fork: of a process that has a GPU none can be made, and a script that has no guard is not
    run twice. Half of the processors' threads are enough for it. What it runs is said once, by `give`; one that is
    given nothing ends as this closes, or as the process that made it does.

    Attributes:
        process: It.
    """

    def __init__(self) -> None:
        threads = {"WSIM_THREADS": str(max(1, len(os.sched_getaffinity(0)) // 2))}
        self.process = subprocess.Popen(
            [sys.executable, "-P", "-m", "wsim.runs.bare_run"],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            env={**threads, **os.environ},
        )

    def __enter__(self) -> Standby:
        """It loads already."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close it."""
        self.close()

    def close(self) -> None:
        """End it, whatever it is at."""
        self.process.kill()
        self.process.communicate()

    def give(self, work: bytes) -> None:
        """Hand it the pickled `Iteration` to run. If it has died, whoever waits for it finds that out."""
        assert self.process.stdin is not None
        with contextlib.suppress(BrokenPipeError):
            self.process.stdin.write(work)
            self.process.stdin.flush()

    def done(self) -> bool:
        """Wait for its end; whether it ran what it was given."""
        return self.process.wait() == 0
