"""Check several stages that a program wrote; see `check_task`."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from pxr import Work

from wsim.scene.check import check_stage


def run(job: dict[str, Any]) -> dict[str, Any]:
    """Wait until the stages are there, then say which have no problem."""
    Work.SetConcurrencyLimit(1)
    if os.read(0, 1) != b"g":
        os._exit(0)
    roots = [Path(root) for root in job["roots"]]
    paths = [Path(path) for path in job["stages"]]
    return {
        "outcome": "ok",
        "sound": [
            k for k, path in enumerate(paths) if path.is_file() and path.stat().st_size and not check_stage(path, roots)
        ],
    }
