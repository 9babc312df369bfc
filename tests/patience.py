"""How long a test waits for what it started. No test says how long a thing may take: benchmarks measure that."""

import time
from collections.abc import Callable

STUCK = 600.0  # [s] on a busy machine, too, what takes longer will never end; below the time-out of pyproject.toml
TRY_AGAIN = 0.02  # [s]


def until(true: Callable[[], object]) -> None:
    """Wait until something is so."""
    deadline = time.monotonic() + STUCK
    while not true():
        assert time.monotonic() < deadline, "it never came true"
        time.sleep(TRY_AGAIN)
