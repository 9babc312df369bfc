"""A sentence becomes a judged world: the six artefacts, in order."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from wsim.pipeline import Settings, run_in_folder
from wsim.progress import Progress, silent
from wsim.runs import RunFolder, write_whole

if TYPE_CHECKING:
    from wsim.judge.verdict import Verdict
    from wsim.plan.schema import Plan

BUILTIN = "builtin"


@dataclass
class Generated:
    """A finished run."""

    run: RunFolder
    plan: Plan
    verdict: Verdict | None  # None: the plan was not approved
    report: Path | None


def generate(
    prompt: str,
    runs: Path = Path("runs"),
    settings: Settings | None = None,
    approve: Callable[[Plan], bool] = lambda plan: True,
    plan: Plan | None = None,
    progress: Progress = silent,
) -> Generated:
    """Plan a world, write its program, build, simulate and judge it, and keep all of it in a run folder.

    Args:
        prompt: What the world must be.
        runs: Where run folders go.
        settings: Device, parameters, limits.
        approve: Shown the plan before anything is built.
        plan: A plan to use as it is, in place of the planner's.
        progress: Told how far it is.

    Raises:
        NotUnderstood: If the planner cannot ground the prompt; nothing is left behind.
    """
    from wsim.plan.drawing.picture import draw_picture
    from wsim.program.compose import compose
    from wsim.report import write as write_report

    plan = plan or make_plan(prompt)
    run = RunFolder.create(runs, plan.title)
    run.record(prompt=prompt, title=plan.title, models={"planner": BUILTIN, "coder": BUILTIN})
    run.say("planner", BUILTIN, prompt, plan.model_dump(mode="json"))
    write_whole(run.path / "plan.json", plan.model_dump_json(indent=2) + "\n")
    draw_picture(plan, run.path / "plan.png")
    if not approve(plan):
        run.record(status="not approved")
        return Generated(run, plan, None, None)

    iteration = run.iteration(1)
    program = compose(plan)
    run.say("coder", BUILTIN, "plan.json", program)
    write_whole(iteration / "program.py", program)

    verdict = run_in_folder(run, iteration / "program.py", plan, settings, progress)
    return Generated(run, plan, verdict, write_report(run.path))


def make_plan(prompt: str) -> Plan:
    """The builtin planner's plan of a prompt."""
    from wsim.plan.planner import plan

    return plan(prompt)
