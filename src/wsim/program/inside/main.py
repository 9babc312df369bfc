"""The first and only module that a sandboxed process is started with: confine, then do the one task.

The parent's command line calls `main` with the job. What it reports is written to a descriptor that the
parent opened; the parent reads it as it would read anything that the program itself wrote.
"""

from __future__ import annotations

import importlib
import json
import os
import sys
from typing import Any

from wsim.program.inside.confine import confine


def main(job: dict[str, Any]) -> None:
    """Do the task that the job names; the process ends here."""
    confine(job)
    os.chdir(job["scratch"])
    # Each loads what it needs only here, after the process is confined.
    task = importlib.import_module(f"wsim.program.inside.{job['task']}_task")
    report = task.run(job)
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except (OSError, ValueError, AttributeError):  # the program closed or replaced it
            continue
    os.write(job["report_fd"], json.dumps(report).encode())
    # Not sys.exit: threads and exit handlers of the program have no say in when it ends.
    os._exit(0)
