"""Check a stage that a program wrote. In a sandbox of its own: a stage can be made to hang or crash what reads it."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from pxr import Work

from wsim.scene.check import check_stage

_TEXT, _COUNT = 1000, 50


def run(job: dict[str, Any]) -> dict[str, Any]:
    """Wait until the stage is there, then check it."""
    # Loading takes as long as a small program does; it is done while the program runs.
    Work.SetConcurrencyLimit(1)
    if os.read(0, 1) != b"g":
        os._exit(0)  # the program failed: there is nothing to check
    problems = check_stage(Path(job["stage"]), [Path(root) for root in job["roots"]])
    return {"outcome": "ok", "problems": [str(problem)[:_TEXT] for problem in problems[:_COUNT]]}
