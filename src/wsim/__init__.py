"""A sentence becomes a physical world: planned, built as OpenUSD, simulated on Newton, judged against physics."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from wsim.scene import Scene

__version__ = "0.1.0"
__all__ = ["__version__", "run"]


def run(build: Callable[[Scene], None]) -> None:
    """Build, simulate, record and judge a program in this process, as `python program.py` does.

    Leaves a run folder under ./runs with the stage, the recording, the video, the verdict and a report.
    Unlike `wsim run`, nothing is sandboxed: it is the caller's own program.
    """
    from wsim.cli.in_process import run_in_process  # the simulator, which only a program that runs needs

    run_in_process(build)
