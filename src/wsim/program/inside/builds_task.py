"""Call a program's `build` once for each of several sets of parameters, each on a scene and a module of its own."""

from __future__ import annotations

import os
from collections.abc import Iterator
from typing import Any

from wsim.program.inside.build_task import author, copy, write

SIZE = 16  # digits ahead of each stage, which say how many bytes it has


def run(job: dict[str, Any]) -> dict[str, Any]:
    """Append each stage to `stages_fd`; of what fails a size of 0 alone, and it is told of by who builds it alone."""
    target = job["stages_fd"]
    for params in job["each"]:
        begin = os.lseek(target, 0, os.SEEK_END)
        try:
            copy(author({**job, "params": params}, job["program"]), target, head)
        except BaseException:  # noqa: BLE001 - whatever a program raises
            os.ftruncate(target, begin)
            os.lseek(target, begin, os.SEEK_SET)
            write(target, head(0))
    return {"outcome": "ok"}


def head(size: int) -> bytes:
    """What goes ahead of so many bytes."""
    return b"%0*d" % (SIZE, size)


def parts(target: int, count: int) -> Iterator[tuple[int, int]]:
    """Where each part of what a process appended begins, and its bytes; it ends where what is there does."""
    total, at = os.fstat(target).st_size, 0
    for _ in range(count):
        said = os.pread(target, SIZE, at)
        at += SIZE
        size = int(said) if len(said) == SIZE and said.isdigit() else total
        if at + size > total:
            return
        yield at, size
        at += size
