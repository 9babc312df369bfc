"""`wsim mcp` with three more tools: one that prints in every way there is, one that takes its time, one that breaks."""

import ctypes
import os
import subprocess
import time

import warp as wp
from pydantic import Field

from wsim.cli import main
from wsim.tools import TOOLS
from wsim.tools.base import Arguments, Result, Tool, Workspace


class Nothing(Arguments):
    """No arguments."""


class Wait(Arguments):
    """How long, and where it is noted."""

    seconds: float = Field(description="how long", gt=0.0)
    name: str = Field(description="of the file that notes beginning and end")


@wp.kernel
def say(number: int):
    wp.printf("printed by a Warp kernel\n")


def loud(workspace: Workspace, asked: Nothing) -> Result:
    wp.launch(say, dim=1, inputs=[0], device="cpu")  # flushes what C printed
    subprocess.run(["echo", "printed by a child process"], check=True)
    os.write(1, b"printed to the descriptor\n")
    ctypes.CDLL(None).puts(b"printed by a C library")
    print("printed by Python")  # noqa: T201
    return Result("said")


def wait(workspace: Workspace, asked: Wait) -> Result:
    note = workspace.run.path / asked.name
    note.write_text("began")
    others = [path.name for path in workspace.run.path.glob("*.wait") if path != note and path.read_text() == "began"]
    started = time.monotonic()
    try:
        while (gone := time.monotonic() - started) < asked.seconds:
            workspace.progress("waiting", gone, asked.seconds)
            time.sleep(0.02)
        workspace.progress("resting", 0, 1)
    except BaseException as error:
        note.write_text(f"stopped by {type(error).__name__}")
        raise
    note.write_text("ended")
    return Result(f"beside {others}")


def broken(workspace: Workspace, asked: Nothing) -> Result:
    raise RuntimeError("the disk is on fire")


for tool in (
    Tool("loud", "Prints.", Nothing, loud, needs_run=False),
    Tool("wait", "Waits.", Wait, wait, writes=True),
    Tool("broken", "Breaks.", Nothing, broken, needs_run=False),
):
    TOOLS[tool.name] = tool

if __name__ == "__main__":
    main()
