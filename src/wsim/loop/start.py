"""How a run begins: its folder, who works on it, what a replay will need, its plan."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

from wsim import report
from wsim.agents.ask import Desk
from wsim.agents.budget import Ledger
from wsim.agents.crew import Crew
from wsim.agents.pictures import small_jpeg
from wsim.agents.transcript import Transcript
from wsim.door import do_beside
from wsim.loop.options import Options
from wsim.plan.drawing.picture import draw_picture
from wsim.plan.schema import Plan
from wsim.program.patch import diff
from wsim.progress import Progress
from wsim.runs.folder import RunFolder, write_whole
from wsim.tools import Workspace

REFERENCE = "reference.jpg"  # the small picture that the planner saw, in the run's folder


FIRST_PLAN = "plan-1.json"  # the plan before it was changed, in the run's folder


def picture_of(options: Options) -> bytes | None:
    """A reference picture as a small JPEG; the recorded one, byte for byte, in a replay."""
    if options.image is None:
        return None
    return small_jpeg(options.image) if options.replay is None else options.image.read_bytes()


def start(prompt: str, runs: Path, plan: Plan | None, options: Options, progress: Progress) -> tuple[RunFolder, Crew]:
    """A new run's folder, whose run.json has all that a replay needs besides the transcript, and its crew."""
    run = RunFolder.create(runs, plan.title if plan else prompt)
    ledger = Ledger(options.budget)

    ready: list[str] = []

    def watched(stage: str, done: float, total: float) -> None:
        ledger.check_time()  # a simulation that outlasts the run's time ends here
        if stage == "simulating" and not ready:  # which leaves Python idle
            ready.append(stage)
            do_beside(lambda: report.make_ready(), "makes the report ready")
        progress(stage, done, total)

    crew = Crew(
        Desk(options.models, Transcript(run.path), ledger, options.replay, options.fresh),
        Workspace(run, options.settings, watched),
    )
    run.record(
        prompt=prompt,
        models=options.models.facts(),
        settings=asdict(options.settings),
        budget=asdict(options.budget),
        confirm=options.confirm,
        candidates=options.candidates,
    )
    return run, crew


def keep_plan(run: RunFolder, crew: Crew, prompt: str, plan: Plan | None, picture: bytes | None) -> Plan:
    """The plan, made by the crew where there is none yet, kept in the run's folder with its drawing."""
    if plan is None:
        if picture is not None:
            (run.path / REFERENCE).write_bytes(picture)
        plan = crew.plan(prompt, [picture] if picture else [], REFERENCE if picture else "")
        run.record(title=plan.title)
    else:
        crew.desk.transcript.builtin("planner", prompt, plan.model_dump(mode="json"))
    _write(run, plan)
    return plan


def _write(run: RunFolder, plan: Plan) -> None:
    write_whole(run.path / "plan.json", plan.model_dump_json(indent=2) + "\n")
    draw_picture(plan, run.path / "plan.png")


def change_plan(run: RunFolder, old: Plan, new: Plan) -> None:
    """Another plan in place of a run's own: the old one stays beside it, with what was changed."""
    before, after = (plan.model_dump_json(indent=2) + "\n" for plan in (old, new))
    write_whole(run.path / FIRST_PLAN, before)
    write_whole(run.path / "plan.diff", diff(before, after, "plan.json"))
    _write(run, new)
