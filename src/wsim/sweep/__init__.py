"""Candidates: many worlds of one program, drawn, run, judged and ranked.

axes = [Axis.parse("wood_density=300:900"), Axis.parse("level=0.4,0.5,0.6")]
outcomes = sweep(SweepFolder.create("runs", "blocks"), Spec(programs=["floating.py"], axes=axes, samples=64))
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsim.door import door

if TYPE_CHECKING:
    from wsim.sweep.axis import Axis
    from wsim.sweep.candidate import Candidate, Outcome
    from wsim.sweep.folder import SweepFolder
    from wsim.sweep.run import sweep
    from wsim.sweep.spec import Spec

__all__ = ["Axis", "Candidate", "Outcome", "Spec", "SweepFolder", "sweep"]

__getattr__ = door(
    __name__,
    {
        "Axis": "axis",
        "Candidate": "candidate",
        "Outcome": "candidate",
        "Spec": "spec",
        "SweepFolder": "folder",
        "sweep": "run",
    },
)
