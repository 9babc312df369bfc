"""The iterations of a run, or the candidates of a sweep, as the viewer shows them side by side."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from wsim.errors import UserError
from wsim.judge.evidence.evidence import Evidence
from wsim.judge.verdict import Verdict
from wsim.plan.store import load
from wsim.recording import read
from wsim.recording.side_by_side import MOST, Course, Part, write_side_by_side
from wsim.report.signals import find_signal
from wsim.runs.folder import RunFolder
from wsim.sweep.folder import SweepFolder

if TYPE_CHECKING:
    from wsim.judge.verdict import Finding
    from wsim.plan.schema import Plan

COURSES = 3  # of an iteration, the failed ones first: more than that nobody tells apart


def recorded(folder: Path) -> list[tuple[str, Path]]:
    """What a run's or a sweep's folder has recordings of: names, and folders with recording.rrd.

    Of more than `MOST` the first and the last ones.
    """
    runs = sorted((folder / "candidates").glob("[0-9]*"))
    found = [(_candidate(folder, run), each) for run in runs for each in _iterations(run)]
    found += [(f"iteration {int(each.name)}", each) for each in _iterations(folder)]
    return found if len(found) <= MOST else [*found[: MOST // 2], *found[-(MOST - MOST // 2) :]]


def side_by_side(folder: Path, target: Path | None = None) -> Path:
    """One recording of all of them; findings stand at their times, and what was judged beside its limit.

    Args:
        folder: A run's or a sweep's.
        target: Where it goes; by default into the temporary folder.

    Raises:
        UserError: If nothing was recorded.
    """
    found = recorded(folder)
    if not found:
        raise UserError(f"{folder} has no recordings: nothing in it was simulated")
    plan_file = folder / "plan.json"
    plan = load(plan_file) if plan_file.is_file() else None
    made = target or Path(tempfile.mkdtemp(prefix="wsim-view-")) / f"{folder.name}.rrd"
    return write_side_by_side([_part(name, each, plan) for name, each in found], made)


def _candidate(sweep: Path, run: Path) -> str:
    """What a candidate is called; of several programs, which one it is of."""
    several = (sweep / "sweep.json").is_file() and len(SweepFolder(sweep).spec.programs) > 1
    program = RunFolder(run).facts().get("program") if several else None
    return f"candidate {int(run.name)}" + (f", {program}" if program else "")


def _iterations(run: Path) -> list[Path]:
    found = [path for path in (run / "iterations").glob("[0-9]*") if (path / "recording.rrd").is_file()]
    return sorted(found, key=lambda path: int(path.name))


def _part(name: str, folder: Path, plan: Plan | None) -> Part:
    path, verdict_file = folder / "recording.rrd", folder / "verdict.json"
    if not verdict_file.is_file():
        return Part(f"{name}: not judged", path)
    verdict = Verdict.model_validate_json(verdict_file.read_text(encoding="utf-8"))
    shown = [*verdict.failures, *(f for f in verdict.findings if f.passed and f.objective)]
    marks = [
        (_time(finding), "INFO" if finding.passed else "ERROR", f"{'✓' if finding.passed else '✗'} {finding.message}")
        for finding in shown
    ]
    return Part(f"{name}: {verdict.status}", path, sorted(marks), _courses(path, plan, shown))


def _time(finding: Finding) -> float:
    if finding.time is not None:
        return max(0.0, finding.time)
    return max(0.0, finding.span[0]) if finding.span else 0.0


def _courses(path: Path, plan: Plan | None, findings: Sequence[Finding]) -> list[Course]:
    evidence = Evidence(read(path), plan)
    courses: list[Course] = []
    for finding in findings:
        signal = find_signal(evidence, finding) if finding.value is not None else None
        if signal is not None and signal.how and len(courses) < COURSES:
            title = f"{finding.objective or finding.check} {signal.title} [{signal.unit}]"
            courses.append(Course(title, signal.time, signal.value, finding.limit))
    return courses
