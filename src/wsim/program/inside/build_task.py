"""Call a program's `build` and hand the stage to the parent."""

from __future__ import annotations

import errno
import functools
import os
import stat
import traceback
from collections.abc import Callable
from typing import Any

from pxr import Work

from wsim.program.inside.load import ProgramError, explain, function, load
from wsim.scene import Scene

_CHUNK = 1 << 20


def run(job: dict[str, Any]) -> dict[str, Any]:
    """Run the program's `build` and copy the stage that it authored to the parent's descriptor."""
    program = job["program"]
    try:
        copy(author(job, program), job["stage_fd"])
    except BaseException as error:  # noqa: BLE001 - whatever a program raises is a finding
        # What the program piled up hangs on its frames; without it there is memory to write the report with.
        traceback.clear_frames(error.__traceback__)
        return explain(error, program)
    return {"outcome": "ok"}


@functools.cache
def in_one_thread() -> None:
    """Keep USD to this thread: one address space is shared by all, and a large machine would start many.

    Once: to say it again takes 3 ms, a third of what a small program's build does.
    """
    Work.SetConcurrencyLimit(1)


def author(job: dict[str, Any], program: str) -> str:
    """Save the stage that a program makes of `params` and `seed`; its path. Raises what the program raises."""
    in_one_thread()
    module = load(program)
    call = function(module, "build", "scene")
    scene = Scene(params=job["params"], seed=job["seed"])
    before = {str(prim.GetPath()) for prim in scene.stage.TraverseAll()}
    call(scene)
    made = {str(prim.GetPath()) for prim in scene.stage.TraverseAll()} - before
    if not any(not path.startswith(("/World/PhysicsScene", "/World/Parameters", "/World/Looks")) for path in made):
        raise ProgramError(
            "build(scene) returned without making an object; call scene.ground(...), scene.box(...) or another"
        )
    path = os.path.join(job["scratch"], "stage.usda")  # noqa: PTH118
    try:
        scene.save(path)
    except Exception as error:
        text = str(error)
        if os.strerror(errno.EFBIG) in text or os.strerror(errno.ENOSPC) in text:
            limit = job["limits"]["file_bytes"]
            raise OSError(errno.EFBIG, f"the stage has more than the {limit} bytes that are allowed") from None
        raise
    return path


def copy(path: str, target: int, head: Callable[[int], bytes] | None = None) -> None:
    """Make a file all that a descriptor holds; or append it, behind what `head` makes of its size."""
    source = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
    try:
        status = os.fstat(source)
        if not stat.S_ISREG(status.st_mode):
            raise OSError(f"{path} is not a file")
        if head is None:
            os.ftruncate(target, 0)
            os.lseek(target, 0, os.SEEK_SET)
        else:
            write(target, head(status.st_size))
        while chunk := os.read(source, _CHUNK):
            write(target, chunk)
    finally:
        os.close(source)


def write(target: int, data: bytes) -> None:
    """Write all of it."""
    view = memoryview(data)
    while view:
        view = view[os.write(target, view) :]
