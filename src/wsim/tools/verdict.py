"""The tool that reads a verdict: what failed first, with what to change."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from pydantic import Field

from wsim.judge.repair.order import suggestions
from wsim.judge.verdict import Verdict
from wsim.tools.base import Result, Tool, Workspace
from wsim.tools.iterations import OfIteration, file_of
from wsim.tools.text import ROOT, name_of, number, table

if TYPE_CHECKING:
    from pathlib import Path

    from wsim.judge.verdict import Finding

HEAD = ("check", "prim", "value", "limit", "unit", "at [s]", "line")


class ReadVerdict(OfIteration):
    """The verdict on an iteration."""

    passed: bool = Field(False, description="the findings that passed as well, with their margins")


def read_verdict(workspace: Workspace, asked: ReadVerdict) -> Result:
    """What was found of an iteration."""
    path = file_of(workspace, asked.iteration, "verdict.json", "run_program with the pass physics or full judges it")
    return Result("\n".join(verdict_lines(path, asked.passed)))


def verdict_lines(path: Path, passed: bool = False) -> list[str]:
    """A verdict's findings: those that failed, with what to change, then those that passed.

    Args:
        path: The verdict.json.
        passed: Whether those that passed have rows of their own.
    """
    verdict = Verdict.model_validate_json(path.read_text(encoding="utf-8"))
    good = [finding for finding in verdict.findings if finding.passed]
    lines = [f"{verdict.status}: {len(verdict.failures)} of {len(verdict.findings)} findings fail"]
    first = next(iter(suggestions(verdict)), None)
    if first is not None and first.target is not None and len(verdict.failures) > 1:
        lines.append(f"try first: {first.target.sentence} ({first.check})".replace(ROOT, ""))
    if verdict.failures:
        lines += table(HEAD, [_row(finding) for finding in verdict.failures])
        lines += dict.fromkeys(line for finding in verdict.failures for line in _words(finding))  # each is said once
    lines += [f"{crash.message}; this is a fault of wsim's, not of the world" for crash in verdict.crashes]
    lines += [f"not checked: {line}" for line in verdict.not_checked]
    if good and passed:
        rows = [[*_row(finding), number(finding.margin)] for finding in good]
        lines += ["passed:", *table((*HEAD, "margin"), rows)]
    elif good:
        counts = Counter(finding.check for finding in good)
        lines.append("passed: " + ", ".join(f"{name} x{n}" if n > 1 else name for name, n in counts.items()))
    return lines


def _row(finding: Finding) -> list[str]:
    return [
        finding.check, name_of(finding.prim), number(finding.value), number(finding.limit), finding.unit,
        number(finding.time), finding.line or "",
    ]  # fmt: skip


def _words(finding: Finding) -> list[str]:
    """What a failed finding says, and what to change."""
    of = f"{finding.check}: " if not finding.objective else f"{finding.check} ({finding.objective}): "
    lines = [of + finding.message.replace(ROOT, "")]
    if finding.target is not None:
        why = f": {finding.target.why}" if finding.target.why else ""
        lines.append(f"  -> {finding.target.sentence}{why}".replace(ROOT, ""))
    return lines


TOOLS = (
    Tool(
        "read_verdict", "The verdict: failed findings first, each with value, limit, time, line and what to change.",
        ReadVerdict, read_verdict, narrow="what failed first comes first",
    ),
)  # fmt: skip
