"""Call a program's `build` once for each of several sets of parameters, each on a scene and a module of its own."""

from __future__ import annotations

import contextlib
import os
from typing import Any

from wsim.program.inside.build_task import author


def run(job: dict[str, Any]) -> dict[str, Any]:
    """Copy each stage to its descriptor; what fails leaves its own empty, and is told of by who builds it alone."""
    for each in job["each"]:
        try:
            author({**job, **each}, job["program"])
        except BaseException:  # noqa: BLE001 - whatever a program raises
            with contextlib.suppress(OSError):
                os.ftruncate(each["stage_fd"], 0)
    return {"outcome": "ok"}
