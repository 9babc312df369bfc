"""Curves of detection: the share of a family's faults that the judge finds, by their size."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.judge_families.family import Family
from benchmarks.judge_families.register import FAMILIES
from benchmarks.judge_families.trial import Outcome
from benchmarks.judge_worlds.tables import interval, rate

FOUND = 0.9  # of the draws: the least size of which so many are found is a family's
BEGIN, END = "<!-- curves:begin -->", "<!-- curves:end -->"


@dataclass(frozen=True)
class Point:
    """How many of a size are found."""

    size: float
    found: int
    draws: int

    @property
    def share(self) -> float:
        """0 to 1."""
        return self.found / max(self.draws, 1)

    @property
    def bounds(self) -> tuple[float, float]:
        """Wilson's, of 95 %."""
        return interval(self.found, self.draws)


@dataclass(frozen=True)
class CurveOf:
    """A family's curve, and what caught it."""

    family: Family
    half: str
    points: list[Point]
    by: list[str]  # checks, the most frequent first

    @property
    def least(self) -> float | None:
        """The least size from which on nine in ten are found; None if not even of the largest."""
        least = None
        for point in reversed(self.points):
            if point.share < FOUND:
                break
            least = point.size
        return least

    @property
    def missed(self) -> tuple[int, int]:
        """False accepts among the sizes that an engineer would call wrong, and their draws."""
        wrong = [point for point in self.points if point.size >= self.family.limit * (1 - 1e-9)]
        return sum(p.draws - p.found for p in wrong), sum(p.draws for p in wrong)


def judged(outcomes: Sequence[Outcome]) -> list[Outcome]:
    """Those that the judge was asked about: a fault without effect is none."""
    return [outcome for outcome in outcomes if not outcome.error and outcome.status != "no effect"]


def curves(outcomes: Sequence[Outcome]) -> list[CurveOf]:
    """One of each family that was tried, in the order of the families."""
    made = []
    for name, family in FAMILIES.items():
        here = [outcome for outcome in judged(outcomes) if outcome.family == name]
        if not here:
            continue
        sizes = [(size, [o for o in here if o.size == size]) for size in family.sizes]
        points = [Point(size, sum(not o.accepted for o in part), len(part)) for size, part in sizes if part]
        by = Counter(check for outcome in here for check in outcome.checks)
        made.append(CurveOf(family, here[0].half, points, [check for check, _ in by.most_common(3)]))
    return made


def tables(outcomes: Sequence[Outcome]) -> str:
    """The families' table, the sound worlds', and the rates, as Markdown."""
    found = curves(outcomes)
    rows = [("family", "unit", "found of draws, by size", "least found", "wrong from", "false accepts there", "by")]
    rows.append(("---",) * len(rows[0]))
    for curve in found:
        points = ", ".join(f"{p.size:g}: {p.found}/{p.draws}" for p in curve.points)
        missed, draws = curve.missed
        least = "none" if curve.least is None else f"{curve.least:g}"
        star = "" if curve.half == "tuning" else " *"
        rows.append((curve.family.name + star, curve.family.unit, points, least, f"{curve.family.limit:g}",
                     f"{missed} of {draws}", ", ".join(curve.by)))  # fmt: skip
    missed, draws = (sum(curve.missed[k] for curve in found) for k in range(2))
    parts = ["".join(f"| {' | '.join(row)} |\n" for row in rows)]
    parts.append(_sound_table(outcomes))
    parts.append(f"False accepts at sizes that an engineer would call wrong: {rate(missed, draws)}.")
    for half in ("tuning", "held-out"):
        missed, draws = (sum(curve.missed[k] for curve in found if curve.half == half) for k in range(2))
        if draws:
            parts[-1] += f" Of the {half} half: {rate(missed, draws)}."
    sound = [outcome for outcome in judged(outcomes) if not outcome.family]
    parts[-1] += (
        f" False rejects: {rate(sum(not o.accepted for o in sound), len(sound))}. In brackets: 95 % (Wilson).\n"
    )
    return "\n".join(parts)


def _sound_table(outcomes: Sequence[Outcome]) -> str:
    rows = [("sound worlds", "runs", "false rejects", "rejected by"), ("---",) * 4]
    sound = [outcome for outcome in judged(outcomes) if not outcome.family]
    for name in dict.fromkeys(outcome.mechanism for outcome in sound):
        here = [outcome for outcome in sound if outcome.mechanism == name]
        wronged = [outcome for outcome in here if not outcome.accepted]
        by = Counter(check for outcome in wronged for check in outcome.checks)
        rows.append((name, str(len(here)), str(len(wronged)), ", ".join(f"{c} {n}" for c, n in by.most_common(4))))
    return "".join(f"| {' | '.join(row)} |\n" for row in rows)


def put(document: str, text: str) -> str:
    """A document with the tables between its two marks; ValueError if it has none."""
    before, begin, rest = document.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end:
        raise ValueError(f"the document has no {BEGIN} followed by {END}; add the two lines where the tables go")
    return f"{before}{begin}\n{text}{end}{after}"


COLUMNS = 7


def draw(outcomes: Sequence[Outcome], path: Path) -> Path:
    """One small panel a family: the share that is found over the size, with its interval; wrong from the line on."""
    from matplotlib.figure import Figure

    found = curves(outcomes)
    rows = -(-len(found) // COLUMNS)
    figure = Figure(figsize=(1.75 * COLUMNS, 1.35 * rows), dpi=72, layout="constrained")
    panels = figure.subplots(rows, COLUMNS, squeeze=False, sharey=True).ravel()
    for curve, axes in zip(found, panels, strict=False):
        x = [point.size for point in curve.points]
        low, high = zip(*(point.bounds for point in curve.points), strict=True)
        color = "#0072b2" if not curve.missed[0] else "#d55e00"
        axes.fill_between(x, low, high, color=color, alpha=0.2, linewidth=0)
        axes.plot(x, [point.share for point in curve.points], "o-", color=color, markersize=3, linewidth=1.2)
        axes.axvline(curve.family.limit, color="#999999", linewidth=1.0, linestyle=":")
        axes.set(xscale="log", ylim=(-0.05, 1.05), yticks=(0, 0.5, 1))
        axes.set_title(curve.family.name, fontsize=7, pad=2)
        axes.set_xlabel(curve.family.unit, fontsize=6, labelpad=0)
        axes.tick_params(labelsize=5, length=2, pad=1, which="both")
        axes.minorticks_off()
    for axes in panels[len(found) :]:
        axes.set_axis_off()
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, metadata={"Title": "Share of faults found by size"})
    return path
