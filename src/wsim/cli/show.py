"""What the terminal shows: progress with time left, a plan, a verdict."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TaskID, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.table import Table
from rich.text import Text

from wsim.plan.asked.covered import not_checked
from wsim.plan.cost import cost_of
from wsim.plan.drawing.text import draw_text
from wsim.plan.unheeded import unheeded

if TYPE_CHECKING:
    from wsim.judge.verdict import Finding, Verdict
    from wsim.plan.schema import Plan
    from wsim.rules.questions import Question

PIPED_WIDTH = 1000  # a file or a pipe gets each finding on one line
console = Console(highlight=False, width=None if sys.stdout.isatty() else PIPED_WIDTH)
STATUS_STYLE = {"accepted": "bold green", "rejected": "bold red", "blocked": "bold yellow"}


class ConsoleProgress:
    """A bar with the time left for each stage of a run; a `wsim.progress.Progress`.

    Where the output is no terminal, each stage is one line when it ends.
    """

    def __init__(self) -> None:
        self._bars = Progress(
            SpinnerColumn(finished_text="✓"),
            TextColumn("{task.description}"),
            BarColumn(bar_width=24),
            TextColumn("{task.percentage:>3.0f}%"),
            TimeElapsedColumn(),
            TextColumn("left"),
            TimeRemainingColumn(),
            console=console,
            disable=not console.is_terminal,
        )
        self._tasks: dict[str, TaskID] = {}
        self._finished: set[str] = set()

    def __enter__(self) -> ConsoleProgress:
        """Show the bars."""
        self._bars.__enter__()
        return self

    def __exit__(self, *error: Any) -> None:
        """Leave the finished bars on the screen."""
        self._bars.__exit__(*error)

    @contextlib.contextmanager
    def aside(self) -> Iterator[None]:
        """Take the bars away while something else is shown, or asked."""
        self._bars.stop()
        try:
            yield
        finally:
            self._bars.start()

    def __call__(self, stage: str, done: float, total: float) -> None:
        """Move the stage's bar."""
        if stage not in self._tasks:
            self._tasks[stage] = self._bars.add_task(stage, total=total)
            if not console.is_terminal:
                console.print(f"{stage} …")
        self._bars.update(self._tasks[stage], completed=done, total=total)


def show_plan(plan: Plan, questions: Sequence[Question] = (), picture: Path | None = None) -> None:
    """Print all that a person reads before saying yes.

    Args:
        plan: A laid-out plan.
        questions: What may be answered first.
        picture: Where the drawings were written as a picture.
    """
    console.print(_objects(plan))
    for item in plan.objects:
        if item.relations:
            console.print(f"  {item.name}: {'; '.join(row.sentence() for row in item.relations)}", markup=False)
    for objective in plan.objectives:
        console.print(f"  must: {objective.sentence or f'{objective.object} {objective.kind}'}", markup=False)
    for line in not_checked(plan):
        console.print(f"  not checked: {line}", style="yellow", markup=False)
    if plan.stands_in_for:
        console.print(f"  stands in for: {plan.stands_in_for}", style="yellow", markup=False)
    for assumption in plan.assumptions:
        console.print(
            f"  assumed: {assumption.subject}: {assumption.choice} ({assumption.why})", style="dim", markup=False
        )
    for line in unheeded(plan):
        console.print(f"  not done: {line}", markup=False)
    console.print(draw_text(plan, min(console.width, 100)), markup=False, no_wrap=True, emoji=False)
    console.print(f"  cost: {cost_of(plan).sentence()}", markup=False)
    if picture:
        console.print(f"picture: {picture}", soft_wrap=True, markup=False)
    for number, question in enumerate(questions, start=1):
        choices = ", ".join(question.choices)
        console.print(
            f"  question {number}, {question.id}: {question.text} {choices} … [{question.default}]", markup=False
        )


def _objects(plan: Plan) -> Table:
    """What there is, where, and of what."""
    table = Table(title=Text(plan.title), title_justify="left", show_edge=False)
    for column in ("object", "what", "material", "size [m]", "place [m]"):
        table.add_column(column)
    for item in plan.objects:
        what = item.primitive
        if item.construction.kind == "asset":
            what = f"asset {item.construction.asset}"
        elif item.construction.kind == "robot":
            what = f"robot {item.construction.robot}"
        elif item.construction.kind == "vehicle":
            what = f"vehicle {item.construction.vehicle}"
        elif item.construction.kind == "scatter":
            what = f"{item.construction.count} x {', '.join(item.construction.what)}"
        elif item.construction.kind == "terrain":
            what = "terrain {:g} x {:g} m".format(*item.construction.extent)
        elif item.construction.kind == "external":
            what = f"{item.construction.candidate} (for now: {item.primitive})"
        place = "" if item.pose is None else ", ".join(f"{x:.3g}" for x in item.pose.position)
        if item.pose is not None and any(item.pose.rotation_deg):
            place += " turned " + ", ".join(f"{x:.3g}" for x in item.pose.rotation_deg) + "°"
        size = " × ".join(f"{x:.3g}" for x in item.size)
        cells = (item.name, what, item.material.name if item.material else "", size, place)
        table.add_row(*(Text(cell) for cell in cells))
    return table


def show_verdict(verdict: Verdict, folder: Path, report: Path | None = None) -> None:
    """Print a verdict: each finding with its measured value and its limit; failures in full."""
    table = Table(show_edge=False, pad_edge=False)
    for column in ("", "check", "prim", "value", "limit", "unit", "time [s]"):
        justify: Literal["left", "right"] = "right" if column in ("value", "limit", "time [s]") else "left"
        table.add_column(column, justify=justify, overflow="fold")
    for finding in verdict.findings:
        table.add_row(*_row(finding))
    if verdict.findings:
        console.print(table)
    for finding in verdict.failures:
        where = f" [{finding.line}]" if finding.line else ""
        console.print(Text(f"✗ {finding.check}{where}: {finding.message}", style="red"))
        if finding.target is not None:
            console.print(Text(f"  → {finding.target.sentence}: {finding.target.why}".rstrip(": ")))
    for crash in verdict.crashes:
        console.print(Text(f"? {crash.message}", style="yellow"))
    if verdict.crashes:
        why = "a fault of wsim's, not of the world: report it with its traceback, which wsim judge --json prints"
        console.print(Text(f"  → {why}"))
    for line in verdict.not_checked:
        console.print(Text(f"not checked: {line}", style="yellow"))
    console.print(Text(verdict.status, style=STATUS_STYLE[verdict.status]), Text(f" {verdict.summary}"))
    console.print(f"run:    {folder}", soft_wrap=True)
    if report:
        console.print(f"report: {report}", soft_wrap=True)


def show_usage(facts: dict[str, Any]) -> None:
    """Print what models were asked and what it cost, where any was."""
    by_role = facts.get("usage", {}).get("by_role", {})
    for role, used in by_role.items():
        asked = f"{used['requests']} requests, {used['cached']} from the cache, {used['failed']} failed"
        cost = f", {used['dollars']:.3f} dollars" if "dollars" in used else ""
        tokens = f"{used['input_tokens']} + {used['output_tokens']} tokens, {used['seconds']:.0f} s"
        console.print(f"{role}: {asked}; {tokens}{cost}", markup=False)
    if by_role:
        console.print(f"tokens: {facts['usage']['tokens']} in all, in {len(facts.get('iterations', []))} iterations")
    for note in facts.get("notes", []):
        console.print(f"note: {note}", markup=False)


def _row(finding: Finding) -> list[Text]:
    def number(x: float | None) -> str:
        return "" if x is None else f"{x:.4g}"

    style = "" if finding.passed else "red"
    cells = ["✓" if finding.passed else "✗", finding.check, finding.prim or ""]
    cells += [number(finding.value), number(finding.limit), finding.unit, number(finding.time)]
    return [Text(cell, style=style) for cell in cells]
