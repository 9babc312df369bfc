"""A sentence becomes a judged world: planned, written, tried, looked at, judged, and repaired until it is right."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from wsim import report
from wsim.agents.budget import BudgetError
from wsim.agents.failures import ModelError
from wsim.agents.models import BUILTIN, reach
from wsim.agents.planner import NO_OBJECTIVE
from wsim.errors import UserError
from wsim.judge.verdict import Verdict
from wsim.loop.making import Making
from wsim.loop.options import Generated, Options
from wsim.loop.start import keep_plan, picture_of, start
from wsim.phases import Phases
from wsim.plan.schema import Plan
from wsim.progress import Progress, silent
from wsim.rules.planner import plan as plan_by_rules


def generate(
    prompt: str,
    runs: Path = Path("runs"),
    options: Options | None = None,
    approve: Callable[[Plan], bool] | None = None,
    plan: Plan | None = None,
    progress: Progress = silent,
) -> Generated:
    """Plan a world, write its program, try it, repair it until the judge accepts, and keep all of it in a run folder.

    Args:
        prompt: What the world must be.
        runs: Where run folders go.
        options: Models, budget, device, limits.
        approve: Shown the plan before anything is built, and one that was changed on the way before it is;
            without it every plan is built but one that stands in for what cannot be simulated, unless options say so.
        plan: A plan to use as it is, in place of the planner's.
        progress: Told how far it is.

    Raises:
        NotUnderstood: If the builtin planner cannot ground the prompt; nothing is left behind.
        UserError: If a model cannot be reached by its name, or the picture is none; nothing is left behind.
    """
    options, phases = options or Options(), Phases()
    nearest = options.nearest
    approve = approve or (lambda plan: nearest or plan.stands_in_for is None)
    if options.replay is None:
        reach(options.models)
    picture = picture_of(options)
    if plan is None and options.models.planner == BUILTIN:
        plan = plan_by_rules(prompt)  # refused before there is a folder
    if plan is not None and not plan.objectives:
        raise UserError(NO_OBJECTIVE)
    run, crew = start(prompt, runs, plan, options, progress)
    making: Making | None = None
    try:
        with phases.phase("plan"):
            plan = keep_plan(run, crew, prompt, plan, picture)  # prompt → plan
        if not approve(plan):
            why = f"it would stand in for {plan.stands_in_for}" if plan.stands_in_for else ""
            run.record(status="not approved", summary=why, **crew.facts())
            return Generated(run, plan, None, None)
        with phases.phase("try"):
            making = Making(run, crew, plan, options, phases=phases, approve=approve)
            verdict = _world(making)  # plan → verdict
    except (ModelError, BudgetError) as error:  # of the planner: there is nothing to keep but the transcript
        run.record(cause=str(error))
        verdict = Verdict(status="blocked", summary=str(error))
    except BaseException as error:
        why = "interrupted" if isinstance(error, KeyboardInterrupt) else f"{type(error).__name__}: {error}"
        run.record(status="stopped", summary=why, **crew.facts())
        raise
    run.record(
        status=verdict.status,
        summary=verdict.summary,
        phases={"start-up": round(options.start_up, 3), **phases.rounded()},
        **crew.facts(),
    )
    return Generated(run, plan if making is None else making.plan, verdict, report.write(run.path))


def _world(making: Making) -> Verdict:
    """Try, look, judge, repair the best, until one is accepted or the run must end."""
    programs = [making.first_draft()]  # plan → program
    try:
        while True:
            tried = making.attempts(programs)  # programs → stages → recordings → verdicts
            making.keep(tried)
            if making.ends:
                return making.verdict
            programs = making.next(tried[0])  # verdict → programs, or another plan
            if not programs:
                return making.verdict
    except (ModelError, BudgetError) as error:
        return making.blocked(str(error))
