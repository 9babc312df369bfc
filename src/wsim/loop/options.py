"""What a run is asked for, and what comes of it."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from wsim.agents.budget import Budget
from wsim.agents.models import Models
from wsim.runs.folder import RunFolder
from wsim.runs.settings import Settings

if TYPE_CHECKING:
    from wsim.agents.relay import Replay
    from wsim.judge.verdict import Verdict
    from wsim.plan.schema import Plan
    from wsim.runs.standby import Standby


@dataclass
class Options:
    """How a world is made.

    Attributes:
        settings: How its programs are run.
        models: Who fills which role.
        budget: What may be used.
        image: A picture of what it must look like, for a planner that sees.
        candidates: Patches of an iteration that are tried side by side; the best of them goes on.
        confirm: Run the accepted program once more, bare, and compare.
        fresh: Ask models anew what they were asked before; else their kept replies answer.
        nearest: Build the nearest world of a prompt that cannot be simulated, where the planner has one.
        replay: A recorded run that answers in place of the models.
        start_up: What it took to come this far [s].
        standby: A process that loads beside this one, for the run that confirms the first draft.
    """

    settings: Settings = field(default_factory=Settings)
    models: Models = field(default_factory=Models)
    budget: Budget = field(default_factory=Budget)
    image: Path | None = None
    candidates: int = 1
    confirm: bool = True
    fresh: bool = False
    nearest: bool = False
    replay: Replay | None = None
    start_up: float = 0.0
    standby: Standby | None = None


@dataclass
class Generated:
    """A finished run."""

    run: RunFolder
    plan: Plan | None  # None: the planner's model gave none
    verdict: Verdict | None  # None: the plan was not approved
    report: Path | None
