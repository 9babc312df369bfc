"""The tool that accepts an iteration: stripped, run again, compared, stamped."""

from __future__ import annotations

import json

from wsim.errors import UserError
from wsim.judge.verdict import Verdict
from wsim.report import write as write_report
from wsim.runs.accept import accept as stamp
from wsim.runs.iteration import Iteration
from wsim.tools.base import Result, Tool, Workspace
from wsim.tools.iterations import OfIteration, file_of
from wsim.tools.text import number


class Accept(OfIteration):
    """The iteration to accept."""


def accept(workspace: Workspace, asked: Accept) -> Result:
    """Accept an iteration whose verdict is accepted."""
    path = file_of(workspace, asked.iteration, "verdict.json", "run_program with the pass physics or full judges it")
    verdict = Verdict.model_validate_json(path.read_text(encoding="utf-8"))
    if verdict.status != "accepted":
        raise UserError(f"iterations/{path.parent.name} is {verdict.status}; read_verdict says what fails")
    run = workspace.run
    bare = stamp(run, Iteration(path.parent, workspace.plan, workspace.settings, workspace.progress))
    run.record(status=bare.status, summary=bare.summary)
    write_report(run.path)
    if bare.status != "accepted":
        lines = [f"not accepted: {bare.summary}", *(finding.message for finding in bare.failures)]
        return Result("\n".join(lines), ok=False)
    facts = json.loads((run.path / "accepted" / "acceptance.json").read_text(encoding="utf-8"))
    stripped = "what only served the review was taken out" if facts["stripped"] else "nothing had to be taken out"
    apart = number(facts["largest_distance_m"])
    return Result(
        f"accepted/program.py and stage.usda are stamped: {stripped}; the second run was {apart} m off at most\n"
        "report.html tells of the run"
    )


TOOLS = (
    Tool(
        "accept", "Accept an iteration that passed: strip what only served the review, run again, compare, stamp.",
        Accept, accept, writes=True,
    ),
)  # fmt: skip
