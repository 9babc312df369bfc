"""What `wsim generate` does before it asks a model, as tools: start or open a run, plan it, draft its program."""

from __future__ import annotations

from pydantic import Field

from wsim.agents.models import BUILTIN
from wsim.agents.transcript import Transcript
from wsim.errors import UserError
from wsim.judge.verdict import Verdict
from wsim.mcp.desk import Desk
from wsim.plan.drawing.picture import draw_picture
from wsim.plan.store import save
from wsim.program.compose import compose
from wsim.rules.planner import plan as plan_of
from wsim.runs.folder import RunFolder
from wsim.tools.base import Arguments, Result, Tool, Workspace
from wsim.tools.plan import ReadPlan, read_plan


class MakePlan(Arguments):
    """A world to plan."""

    prompt: str = Field(description="what the world must be, in one or a few plain sentences", min_length=1)


class NewRun(Arguments):
    """A run with nothing in it."""

    title: str = Field(description="a few words that name the world; they name the run's folder", min_length=1)


class OpenRun(Arguments):
    """A run that exists."""

    run: str = Field("", description="name of the run's folder, as make_plan and new_run say it; the newest by default")


class DraftProgram(Arguments):
    """Nothing to choose: the plan says it all."""


def run_tools(desk: Desk) -> dict[str, Tool]:
    """The tools that choose the desk's run, and the one that drafts a program from its plan."""

    def make_plan(_: Workspace, asked: MakePlan) -> Result:
        return _planned(desk, asked.prompt)

    def new_run(_: Workspace, asked: NewRun) -> Result:
        return Result(f"run {desk.start(asked.title).path.name} is open; it has no plan and no program yet")

    def open_run(_: Workspace, asked: OpenRun) -> Result:
        return Result(_about(desk.open(asked.run)))

    tools = (
        Tool(
            "make_plan", "Start a new run with the builtin planner's plan of a prompt. It knows tanks of water and "
            "other liquids, taps, rain, the ground, tables, ramps and pendulums; of other words it says which it does "
            "not know.",
            MakePlan, make_plan, writes=True, needs_run=False, narrow="read_plan with one part shows the rest",
        ),
        Tool(
            "new_run", "Start a new run with nothing in it, for a plan of your own (write_plan).",
            NewRun, new_run, writes=True, needs_run=False,
        ),
        Tool(
            "open_run", "Open a run that exists; the other tools then work on it.",
            OpenRun, open_run, needs_run=False,
        ),
        Tool(
            "draft_program", "Make the program that the plan composes a new iteration: a first draft, to patch.",
            DraftProgram, draft_program, writes=True,
        ),
    )  # fmt: skip
    return {tool.name: tool for tool in tools}


def draft_program(workspace: Workspace, _: DraftProgram) -> Result:
    """The plan as a program, in a new iteration."""
    plan = workspace.plan
    if plan is None:
        raise UserError("the run has no plan; write one with write_plan")
    folder = workspace.run.add(compose(plan))
    return Result(f"iterations/{folder.name}/program.py written, not run yet; read_program shows it")


def _planned(desk: Desk, prompt: str) -> Result:
    """A new run, with the builtin planner's plan in it, drawn."""
    plan = plan_of(prompt)
    run = desk.start(plan.title)
    run.record(prompt=plan.prompt, models={"planner": BUILTIN})
    Transcript(run.path).builtin("planner", prompt, plan.model_dump(mode="json"))
    save(plan, run.path / "plan.json")
    draw_picture(plan, run.path / "plan.png")
    tables = (read_plan(Workspace(run), ReadPlan(part=part)).text for part in ("all", "assumptions"))
    return Result("\n".join([f"run {run.path.name} is open", *tables]), image=run.path / "plan.png")


def _about(run: RunFolder) -> str:
    """Which run it is, and how far it came."""
    title, iterations = run.facts().get("title") or "no title", run.iterations()
    verdict = iterations[-1] / "verdict.json" if iterations else None
    status = "not judged yet"
    if verdict is not None and verdict.is_file():
        status = Verdict.model_validate_json(verdict.read_text(encoding="utf-8")).status
    programs = f"{len(iterations)} iteration{'s' * (len(iterations) != 1)}, the newest {status}"
    return f"run {run.path.name} is open: {title}; {programs if iterations else 'no iterations'}"
