"""The room to the limit against each parameter: where acceptance ends, and what it hangs on."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from wsim.sweep.candidate import ORDER, Outcome
from wsim.sweep.table import parameters

COLORS = {"accepted": "#2a9d5c", "rejected": "#c8443c", "blocked": "#c9a227", "failed": "#7d5ba6"}
PANEL = (3.6, 2.8)  # [in]


def draw(outcomes: Sequence[Outcome], folder: Path) -> Path | None:
    """margins.png: a panel for each parameter and each draw; None where no candidate has any."""
    from matplotlib.figure import Figure  # heavy: a sweep without parameters draws nothing

    names = parameters(outcomes)
    if not names:
        return None
    columns = min(3, len(names))
    rows = -(-len(names) // columns)
    figure = Figure((PANEL[0] * columns, PANEL[1] * rows), dpi=120, layout="constrained")
    for k, name in enumerate(names, start=1):
        axes = figure.add_subplot(rows, columns, k)
        axes.axhline(0.0, color="#888", linewidth=0.8)
        for status in ORDER:
            points = [
                (outcome.candidate.values[name], np.nan if outcome.slack is None else outcome.slack)
                for outcome in outcomes
                if outcome.status == status and name in outcome.candidate.values
            ]
            if points:
                across, up = np.transpose(points)
                axes.scatter(across, up, s=12, color=COLORS[status], label=status, linewidths=0)
        axes.set_xlabel(name)
        axes.set_ylabel("room to the limit")
        axes.set_ylim(-1.05, 1.05)
        if k == 1:
            axes.legend(fontsize=7, frameon=False)
    path = folder / "margins.png"
    partial = path.with_name(path.name + ".partial")
    figure.savefig(partial, format="png")
    return partial.replace(path)
