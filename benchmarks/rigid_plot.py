"""Sheets of small pictures, one for each case of rigid motion: what was measured over what is known."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Protocol

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from benchmarks.rigid_cases.case import Case, Curve

COLUMNS, ROWS = 6, 5
KNOWN, MEASURED, MISSED = "#999999", "#0072b2", "#d55e00"


class Result(Protocol):
    """What the pictures need of a case that was run."""

    case: Case
    value: float
    expected: float
    curve: Curve | None

    @property
    def reached(self) -> bool:
        """Whether the value is near enough."""


def draw(runs: Sequence[Result], folder: Path, device: str) -> list[Path]:
    """Draw the cases, six by six a sheet, into `rigid_1.png`, `rigid_2.png`, …; older sheets go."""
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.glob("rigid_[0-9]*.png"):
        old.unlink()
    paths = []
    for first in range(0, len(runs), COLUMNS * ROWS):
        part = runs[first : first + COLUMNS * ROWS]
        rows = -(-len(part) // COLUMNS)
        figure = Figure(figsize=(2.0 * COLUMNS, 1.6 * rows), dpi=100, layout="constrained")
        panels = figure.subplots(rows, COLUMNS, squeeze=False).ravel()
        for run, axes in zip(part, panels, strict=False):
            _panel(axes, run)
        for axes in panels[len(part) :]:
            axes.set_axis_off()
        paths.append(folder / f"rigid_{len(paths) + 1}.png")
        figure.savefig(paths[-1], metadata={"Title": f"Rigid bodies on {device}"})
    return paths


def _panel(axes: Axes, run: Result) -> None:
    """One case: its curve on the known one, or its value within its reach."""
    axes.set_title(run.case.name, fontsize=7, pad=3, color="k" if run.reached else MISSED)
    axes.tick_params(labelsize=6, length=2, pad=1)
    axes.ticklabel_format(useOffset=False)
    axes.locator_params(nbins=4)
    axes.yaxis.get_offset_text().set_fontsize(6)  # a power of ten above the axis, beside the title
    color = MEASURED if run.reached else MISSED
    if run.curve is None:
        _point(axes, run, color)
        return
    curve = run.curve
    known = np.broadcast_to(np.asarray(curve.known, dtype=float), curve.x.shape)
    few = len(curve.x) < 15
    axes.plot(curve.x, known, color=KNOWN, linewidth=3.0)
    axes.plot(curve.x, curve.measured, color=color, linewidth=1.0, marker="o" if few else None, markersize=3)
    span = max(float(np.ptp(known)), float(np.nanmax(np.abs(curve.measured - known))))
    room = max(0.1 * span, 3.0 * run.case.bound(run.expected) if np.ptp(known) == 0.0 else 0.0)
    low = min(known.min(), float(np.nanmin(curve.measured))) - room
    axes.set_ylim(low, max(known.max(), float(np.nanmax(curve.measured))) + room)
    axes.set_xlabel(curve.names[0], fontsize=6, labelpad=1)
    axes.set_ylabel(curve.names[1], fontsize=6, labelpad=3)


def _point(axes: Axes, run: Result, color: str) -> None:
    """A value that is no function of anything, with the band of its reach."""
    bound = run.case.bound(run.expected) or 0.1 * max(abs(run.expected), 1.0)
    axes.axhspan(run.expected - bound, run.expected + bound, color=KNOWN, alpha=0.25, linewidth=0)
    axes.axhline(run.expected, color=KNOWN, linewidth=3.0)
    axes.plot([0.0], [run.value], "o", color=color, markersize=4)
    far = 2.0 * max(bound, abs(run.value - run.expected) if np.isfinite(run.value) else 0.0)
    axes.set(xlim=(-1, 1), ylim=(run.expected - far, run.expected + far), xticks=[])
    axes.set_ylabel(run.case.unit or "–", fontsize=6, labelpad=3)
