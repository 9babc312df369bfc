"""What processes of this machine have started."""

from __future__ import annotations

from pathlib import Path


def below(root: int) -> dict[int, str]:
    """All processes that a process has started, and those that they have, with how they are called."""
    parents, found = _parents(), dict[int, str]()
    grown = True
    while grown:
        new = {pid: name for pid, (parent, name) in parents.items() if parent in {root, *found} and pid not in found}
        grown = bool(new)
        found |= new
    return found


def lives(pid: int) -> bool:
    """Whether a process runs; one that has ended, and that nobody has asked for, does not."""
    return pid in _parents()


def _parents() -> dict[int, tuple[int, str]]:
    found = {}
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            after = (folder / "stat").read_text().rsplit(")", 1)[1].split()
            if after[0] != "Z":
                found[int(folder.name)] = int(after[1]), (folder / "cmdline").read_bytes().decode(errors="replace")
        except OSError:
            continue
    return found
