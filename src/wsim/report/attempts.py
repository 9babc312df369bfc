"""The iterations of a run as the page shows them: how far each came, its patch, and what became of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from wsim.judge.repair.order import suggestions
from wsim.report.diff import Diff, make_diff
from wsim.report.fixes import describe

if TYPE_CHECKING:
    from wsim.report.contents import Iteration, RunContents
    from wsim.runs.records import Tried

PASSES = ("validation", "build", "frames", "physics", "recording", "review")
WORDS = {
    "validation": "the check of its text",
    "build": "its build",
    "frames": "the first frame of its cameras",
    "physics": "its physics",
    "recording": "its full recording",
    "review": "review and acceptance",
}
FILES = ("program.py", "patch.diff", "verdict.json", "review.json", "checks.json", "stage.usda", "recording.rrd",
         "video.mp4", "frames")  # fmt: skip


@dataclass(frozen=True)
class AttemptRow:
    """One iteration."""

    number: str  # "02"
    shown: bool
    outcome: str  # "accepted", "kept", "undone", "not finished"; or the verdict, where run.json says nothing of it
    passes: list[tuple[str, str]]  # (name, "came past" | "failed" | "not tried"); empty where run.json says nothing
    reached: str
    failed: list[str]  # checks
    summary: str
    repair: str  # what the judge wants mended first
    judged: bool  # its model said so; else the checks ask for it
    skills: list[str]
    patch: Diff | None
    patched: str  # the number of the iteration that the patch starts from
    files: list[tuple[str, str]]  # (name, link)


def make_attempts(contents: RunContents) -> list[AttemptRow]:
    """All iterations of a run in their order; none for a run whose only one was made without a model."""
    if len(contents.iterations) < 2 and not contents.loop.asked:
        return []
    return [_row(contents, item) for item in contents.iterations]


def _row(contents: RunContents, item: Iteration) -> AttemptRow:
    loop, verdict = contents.loop, item.verdict
    tried = loop.tried(item.index)
    base = max((row.number for row in loop.iterations if row.kept and row.number < item.index), default=None)
    failures = verdict.failures if verdict else []
    return AttemptRow(
        number=item.number,
        shown=item is contents.shown,
        outcome=_outcome(tried, contents, item),
        passes=_passes(tried) if tried else [],
        reached=_reached(tried) if tried else "",
        failed=tried.failed if tried else list(dict.fromkeys(finding.check for finding in failures)),
        summary=tried.summary if tried else verdict.summary if verdict else "",
        repair=tried.repair if tried and tried.repair else _asked_by_checks(item),
        judged=tried is not None and bool(tried.repair),
        skills=loop.skills.get(item.number, []),
        patch=make_diff(item.patch) if item.patch else None,
        patched=f"{base:02d}" if base is not None else "",
        files=_files(contents, item),
    )


def _outcome(tried: Tried | None, contents: RunContents, item: Iteration) -> str:
    if tried is None:
        return "not finished" if contents.loop.looped or item.verdict is None else item.verdict.status
    return "accepted" if tried.status == "accepted" else "kept" if tried.kept else "undone"


def _passes(tried: Tried) -> list[tuple[str, str]]:
    if tried.reached not in (*PASSES, "all"):
        return []
    at = PASSES.index(tried.reached) if tried.reached != "all" else len(PASSES)
    return [(name, "came past" if k < at else "failed" if k == at else "not tried") for k, name in enumerate(PASSES)]


def _reached(tried: Tried) -> str:
    if tried.reached == "all":
        return "through all passes"
    return f"failed at {WORDS.get(tried.reached, tried.reached)}"


def _asked_by_checks(item: Iteration) -> str:
    """What is to be tried first: the change, where physics or the plan gives one, else what is wrong."""
    first = next(iter(suggestions(item.verdict)), None) if item.verdict else None
    if first is None or first.target is None:
        return ""
    return describe([first.target]) if first.target.direction else first.message


def _files(contents: RunContents, item: Iteration) -> list[tuple[str, str]]:
    here = item.folder.relative_to(contents.run.path).as_posix()
    found = [name for name in FILES if (item.folder / name).exists()]
    return [(f"{here}/", f"{here}/"), *((name, f"{here}/{name}") for name in found)]
