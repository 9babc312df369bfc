"""From what a run left to one HTML file."""

from __future__ import annotations

import math
import shlex
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from markupsafe import Markup

from wsim.judge.evidence.evidence import Evidence
from wsim.judge.verdict import Finding, Verdict
from wsim.report import text
from wsim.report.asked import sentence_of
from wsim.report.attempts import make_attempts
from wsim.report.chart import Chart
from wsim.report.clauses import make_clauses, make_seen
from wsim.report.contents import RunContents, gather
from wsim.report.cost import make_cost
from wsim.report.diff import Diff, difference, make_diff
from wsim.report.ending import which_is_shown, why_it_ended
from wsim.report.facts import make_facts, make_parameters
from wsim.report.fixes import command, describe, make_fixes
from wsim.report.media import MOST_VIDEO_BYTES, Picture, find_moment, find_reference, find_stills, find_video
from wsim.report.moments import moment_chart
from wsim.report.plots import make_charts
from wsim.report.source import SourceLine, source_lines, statement
from wsim.report.templates import source, template
from wsim.runs.folder import write_whole

STATUS_WORDS = {"accepted": "Accepted", "rejected": "Rejected", "blocked": "Blocked"}
PARTS = (
    "macros.html",
    "acceptance.html",
    "clauses.html",
    "iterations.html",
    "models.html",
    "review.html",
)  # of template.html
MOST_CARDS = 8


@dataclass(frozen=True)
class Row:
    """A finding as the page shows it."""

    index: int  # as `wsim view --finding` counts
    finding: Finding
    numbers: dict[str, str]
    measures: list[tuple[str, str]]
    prim: str
    line: int | None  # of the shown program
    code: str  # the statement there
    command: str  # opens Rerun at the finding's time and prim; empty without a recording
    moment: Picture | None = None
    chart: Chart | None = None
    fix: str = ""  # what to change
    try_it: str = ""  # the command that does


def write(run_dir: str | Path, most_video_bytes: int = MOST_VIDEO_BYTES) -> Path:
    """Write `report.html` in the folder of a run, from what the run left there.

    A run that failed early has no recording, video or plan: the report shows what there is.

    Args:
        run_dir: The run's folder.
        most_video_bytes: A longer video is left out.

    Returns:
        The report's path.

    Raises:
        UserError: There is no such folder.
    """
    run_dir = Path(run_dir)
    contents = gather(run_dir)
    html = render(context(contents, most_video_bytes))
    path = run_dir / "report.html"
    # A lone surrogate in some program's message has no bytes.
    write_whole(path, html.encode("utf-8", "replace").decode("utf-8"))
    return path


def make_ready() -> None:
    """Do what a first page takes beside its run: its templates, and the patterns by which a program is coloured."""
    for name in ("template.html", *PARTS):
        template(name)
    source_lines("", {})


def render(values: dict[str, Any]) -> str:
    """The template with its values."""
    return template("template.html").render(style=Markup(source("style.css")), text=text, **values)


def context(contents: RunContents, most_video_bytes: int) -> dict[str, Any]:
    """What the template is given."""
    shown, verdict, recording = contents.shown, contents.verdict, contents.recording
    rows = make_rows(contents)
    # A measured objective says more to a person than a check that fails beside it.
    failed = sorted(
        (row for row in rows if not row.finding.passed),
        key=lambda row: row.finding.objective is None or row.finding.value is None,
    )
    charts: list[Chart] = []
    if recording is not None:
        charts = make_charts(recording, [row.finding for row in rows])
    cards = _illustrated(failed[:MOST_CARDS], contents)
    world = recording.world if recording is not None else None
    status = _status(contents)
    return {
        "title": _title(contents),
        "status": status,
        "badge": STATUS_WORDS.get(status, status.capitalize()),
        "summary": _summary(verdict, failed) if verdict else _unjudged(contents, status),
        "prompt": str(contents.facts.get("prompt") or (contents.plan.prompt if contents.plan else "")),
        "ending": why_it_ended(contents),
        "which": which_is_shown(contents),
        "notes": contents.notes,
        "rows": rows,
        "failed": failed,
        "crashes": verdict.crashes if verdict else [],
        "passed": [row for row in rows if row.finding.passed],
        "closest": _closest(rows),
        "cards": cards,
        "fixes": make_fixes([(row.index, row.finding) for row in failed], world, contents.target),
        "judged": _judged(contents, status),
        "video": find_video(shown.folder, contents.run.path, most_video_bytes) if shown else None,
        "reference": find_reference(contents.run.path),
        "stills": find_stills(shown.folder) if shown else [],
        "charts": charts,
        "plan": contents.plan,
        "objectives": _objectives(contents),
        "clauses": make_clauses(contents.plan),
        "seen_clauses": make_seen(contents.plan, shown.review if shown else None),
        "replans": contents.loop.replans,
        "plan_diff": make_diff(contents.plan_diff) if contents.plan_diff else None,
        "source": _source(contents, failed),
        "output": str(shown.build().get("log") or "") if shown else "",
        "log": [line for line in recording.log if line.level not in ("TRACE", "DEBUG")] if recording else [],
        "facts": make_facts(contents),
        "parameters": make_parameters(contents),
        "attempts": make_attempts(contents),
        "looped": contents.loop.looped,
        "review": shown.review if shown else None,
        "acceptance": contents.acceptance,
        "stripped": _stripped(contents),
        "cost": make_cost(contents.loop, status),
        "model_notes": contents.loop.notes,
        "view": _view(contents),
        "folder": contents.run.path.resolve().name,
    }


def make_rows(contents: RunContents) -> list[Row]:
    """The findings of the verdict that is reported, in its order."""
    if contents.verdict is None:
        return []
    findings = contents.verdict.findings
    program = (contents.shown.program or "") if contents.shown else ""
    count = len(program.splitlines())
    world = contents.recording.world if contents.recording is not None else None
    # A program that ran in its author's process keeps its own name.
    names = {"program.py", Path(str(contents.facts.get("program") or "program.py")).name}
    rows = []
    for index, finding in enumerate(findings, start=1):
        line = text.program_line(finding, names, count)
        rows.append(
            Row(
                index=index,
                finding=finding,
                numbers=text.table_numbers(finding),
                measures=text.measures(finding),
                prim=text.prim_name(finding.prim or ""),
                line=line,
                code=statement(program, line) if line else "",
                command=f"{_view(contents)} --finding {index}" if _view(contents) else "",
                fix=describe([finding.target]) if finding.target is not None else "",
                try_it=command(finding.target, world, contents.target) if finding.target is not None else "",
            )
        )
    return rows


def _illustrated(rows: list[Row], contents: RunContents) -> list[Row]:
    """Rows with a plot and a picture of their moment, where the recording has them."""
    if contents.recording is None:
        return rows
    evidence = Evidence(contents.recording, contents.plan)
    return [
        replace(
            row,
            chart=moment_chart(evidence, row.finding, row.index),
            moment=find_moment(contents.recording, row.finding),
        )
        for row in rows
    ]


def _closest(rows: list[Row]) -> Row | None:
    """The finding that passed with the least of its limit to spare."""

    def spare(row: Row) -> float:
        margin, limit, expected = row.finding.margin, row.finding.limit, row.finding.expected
        room = abs(limit - expected) if limit is not None and expected is not None else abs(limit or 0.0)
        return margin / room if margin is not None and room else math.inf

    return min((row for row in rows if row.finding.passed and math.isfinite(spare(row))), key=spare, default=None)


def _view(contents: RunContents) -> str:
    return f"wsim view {shlex.quote(str(contents.target))}" if contents.recording is not None else ""


def _source(contents: RunContents, failed: list[Row]) -> list[SourceLine]:
    if contents.shown is None or contents.shown.program is None:
        return []
    named: dict[int, list[int]] = {}
    for row in failed:
        if row.line is not None:
            named.setdefault(row.line, []).append(row.index)
    return source_lines(contents.shown.program, named)


def _stripped(contents: RunContents) -> Diff | None:
    """What acceptance took from the program; None where it took nothing."""
    accepted, shown = contents.acceptance, contents.shown
    if accepted is None or not accepted.stripped or shown is None:
        return None
    return difference(shown.program or "", accepted.program)


def _objectives(contents: RunContents) -> list[tuple[str, bool | None]]:
    """(sentence, passed) of each objective of the plan; None where no finding answers it."""
    if contents.plan is None:
        return []
    findings = contents.verdict.findings if contents.verdict else []
    rows: list[tuple[str, bool | None]] = []
    for item in contents.plan.objectives:
        sentence = sentence_of(item)
        answers = [finding.passed for finding in findings if finding.objective == sentence]
        rows.append((sentence, all(answers) if answers else None))
    return rows


def _judged(contents: RunContents, status: str) -> tuple[str, str] | None:
    """What the judge's model wants mended first in the iteration that is shown: (kind and thing, why)."""
    tried = contents.loop.tried(contents.shown.index) if contents.shown else None
    if tried is None or not tried.repair or status == "accepted":
        return None
    what, _, why = tried.repair.replace("/World/", "").partition(": ")
    return what, why


def _status(contents: RunContents) -> str:
    """How the run ended: as the iteration that is shown was judged, unless it went on and did not come to an end."""
    said = str(contents.facts.get("status") or "unfinished")
    cut_short = bool(contents.loop.cause) or (contents.loop.looped and said not in STATUS_WORDS)
    return contents.verdict.status if contents.verdict and not cut_short else said


def _title(contents: RunContents) -> str:
    title = contents.facts.get("title") or (contents.plan.title if contents.plan else None)
    program = contents.facts.get("program")
    name = Path(str(program)).name if program else contents.facts.get("prompt")
    return str(title or name or contents.run.path.resolve().name)


def _summary(verdict: Verdict, cards: list[Row]) -> str:
    """The verdict's sentence without what stands beside it: the status, and the message of the first card."""
    text = verdict.summary.removeprefix(f"{STATUS_WORDS[verdict.status]}: ")
    if cards:
        text = text.replace(f"; {cards[0].finding.message.rstrip('.')}", "")
    return text[:1].upper() + text[1:]


def _unjudged(contents: RunContents, status: str) -> str:
    if status == "not approved":
        return "The plan was not approved: nothing was built."
    if contents.shown is None:
        return "The run ended before its program was written."
    if contents.recording is None:
        return "The run ended before its world was simulated and judged."
    return "The run ended before its world was judged."
