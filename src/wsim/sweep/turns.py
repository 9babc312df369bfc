"""Turns at a device: workers that share one step their worlds one after another, and do all else meanwhile.

What is before and after a batch is stepped (building programs, set-up, judging) takes a CPU, and stepping it a GPU.
One worker leaves the one idle while it is at the other; of two, one steps while the other builds. Without turns both
would build, then both step.
"""

from __future__ import annotations

import contextlib
import fcntl
import os
from collections.abc import Iterator, Mapping
from pathlib import Path

SHARING = 2  # workers of a GPU
TURNS = "WSIM_TURNS"  # the variable with the file that those who share a device lock


def sharing(folder: Path, device: str) -> Mapping[str, str]:
    """The variables of workers that take turns at a device.

    Args:
        folder: Of the turns of all devices, for as long as there are workers.
        device: Its name.
    """
    return {TURNS: str(folder / device.replace(":", "-"))}


@contextlib.contextmanager
def turn() -> Iterator[None]:
    """Wait for this process's turn at its device, and keep it within; at once where it shares none.

    The turn of a process that ends, in whatever way, ends with it; its forks have no part in it (fcntl(2)).
    """
    file = os.environ.get(TURNS)
    if not file:
        yield
        return
    with Path(file).open("wb") as opened:
        fcntl.lockf(opened, fcntl.LOCK_EX)
        yield
