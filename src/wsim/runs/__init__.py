"""One program through its passes (attempt, accept), the pipeline, its reruns, the folder of a run."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsim.door import door

if TYPE_CHECKING:
    from wsim.runs.alone import run_in_folder
    from wsim.runs.iteration import Iteration, judge_recording

__all__ = ["Iteration", "judge_recording", "run_in_folder"]

__getattr__ = door(__name__, {"Iteration": "iteration", "judge_recording": "iteration", "run_in_folder": "alone"})
