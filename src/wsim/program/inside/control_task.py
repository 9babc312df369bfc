"""Call a program's `control` each time the parent asks, on arrays in shared memory."""

from __future__ import annotations

import mmap
import os
import traceback
from typing import Any

from wsim.program.control_world import ControlLayout
from wsim.program.inside.load import explain, function, load


def run(job: dict[str, Any]) -> dict[str, Any]:
    """Answer one byte with one byte until the parent hangs up or the program raises."""
    layout = ControlLayout(**job["layout"])
    arrays = layout.views(mmap.mmap(job["memory_fd"], layout.size))
    program, ask, answer = job["program"], job["ask_fd"], job["answer_fd"]
    try:
        worlds = layout.worlds(arrays)
        calls = [(function(load(program), "control", "world, t"), world) for world in worlds]
        time = arrays["t"]
        os.write(answer, b"r")
        while os.read(ask, 1):
            for call, world in calls:
                call(world, float(time[0]))
            os.write(answer, b"d")
    except BaseException as error:  # noqa: BLE001 - whatever a program raises is a finding
        traceback.clear_frames(error.__traceback__)
        return explain(error, program)
    return {"outcome": "ok"}
