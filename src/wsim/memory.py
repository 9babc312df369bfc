"""How much memory this process may still take."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path

MEMINFO, GROUP = Path("/proc/meminfo"), Path("/sys/fs/cgroup")


def free_memory(meminfo: Path = MEMINFO, group: Path = GROUP) -> float:
    """What the machine has left, and the control group that the process is in [bytes]; the less of the two.

    Args:
        meminfo: Linux's own account of the machine.
        group: Where the control group (version 2) says what it may take and takes, as a container has one.
    """
    found = [float(os.sysconf("SC_AVPHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))]  # without what is cached of files
    with contextlib.suppress(OSError, ValueError, StopIteration):
        line = next(each for each in meminfo.read_text().splitlines() if each.startswith("MemAvailable:"))
        found = [1024.0 * float(line.split()[1])]
    with contextlib.suppress(OSError, ValueError):  # "max" is no bound
        most, taken = (float((group / f"memory.{name}").read_text()) for name in ("max", "current"))
        found.append(max(0.0, most - taken))
    return min(found)
