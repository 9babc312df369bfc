"""What a running process uses of that which no rlimit bounds, seen from outside through /proc.

All of these give 0 for a process that is gone or cannot be seen.
"""

from __future__ import annotations

import contextlib
import os
import stat
import sys
from pathlib import Path

_DELETED = b" (deleted)"
_FILES = 10_000  # of a scratch folder; more are too many, whatever their size


def threads(pid: int | None) -> int:
    """The number of a process's threads."""
    with contextlib.suppress(OSError):
        return len(os.listdir(f"/proc/{pid}/task"))  # noqa: PTH208 - of strings; many are looked at, and often
    return 0


def folder_bytes(folder: str) -> int:
    """Bytes of the files of a flat folder; without end if there are too many of them."""
    total = 0
    with contextlib.suppress(OSError), os.scandir(folder) as entries:
        for count, entry in enumerate(entries):
            if count > _FILES:
                return sys.maxsize
            with contextlib.suppress(OSError):
                total += entry.stat(follow_symlinks=False).st_size
    return total


def deleted_bytes(pid: int | None, folder: str, most: int) -> int:
    """Bytes of a folder's files that a process keeps after deleting their last name: open, or mapped and closed.

    Args:
        pid: The process.
        folder: Where the files were made.
        most: Bytes that a file can have, which a mapped one counts as where its size cannot be seen.
    """
    sizes = {}
    with contextlib.suppress(OSError), os.scandir(f"/proc/{pid}/fd") as entries:
        for entry in entries:
            with contextlib.suppress(OSError):
                found = entry.stat()
                if stat.S_ISREG(found.st_mode) and found.st_nlink == 0:
                    sizes[found.st_ino] = found.st_size
    with contextlib.suppress(OSError), open(f"/proc/{pid}/maps", "rb", buffering=0) as maps:  # noqa: PTH123
        text = maps.read()
        if _DELETED in text:  # of some hundred lines few or none end so
            for line in text.split(b"\n"):
                if line.endswith(_DELETED) and f" {folder}/".encode() in line:
                    place, _, _, _, inode, _ = line.decode(errors="replace").split(maxsplit=5)
                    if int(inode) not in sizes:
                        sizes[int(inode)] = _mapped_bytes(pid, place, most)
    return sum(sizes.values())


def _mapped_bytes(pid: int | None, place: str, most: int) -> int:
    """Size of the file mapped at a range of addresses; only root may look at more than its name."""
    with contextlib.suppress(OSError):
        return Path(f"/proc/{pid}/map_files/{place}").stat().st_size
    return most


def many_files(pid: int | None, mount: str) -> int:
    """Without end if a file system of a process's own holds too many files, else 0."""
    with contextlib.suppress(OSError):
        found = os.statvfs(f"/proc/{pid}/root{mount}")
        if found.f_files - found.f_ffree > _FILES:
            return sys.maxsize
    return 0
