"""The examples for users of Newton alone: each runs by itself, and what it prints is held against physics."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.patience import STUCK

EXAMPLES = Path(__file__).parent.parent / "examples" / "newton"


def run(name: str, folder: Path) -> str:
    """Run an example in an empty folder; what it printed."""
    command = [sys.executable, str(EXAMPLES / name), "cpu"]
    ended = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=STUCK)
    assert ended.returncode == 0, ended.stdout + ended.stderr
    return ended.stdout


def test_box_floats_at_archimedes_draft(tmp_path: Path) -> None:
    printed = run("sph_floating_box.py", tmp_path)
    rows = [
        tuple(map(float, row)) for row in re.findall(r"^t = (\S+) s +draft +(\S+) mm +lift +(\S+) of", printed, re.M)
    ]
    assert [t for t, _, _ in rows] == pytest.approx([0.05 * (k + 1) for k in range(40)])
    drafts, lifts = [draft for _, draft, _ in rows], [lift for _, _, lift in rows]
    # It starts 10 mm above water that will rise by 14.2 mm and falls no faster than freely; it plunges and comes back.
    assert drafts[0] < 4.2 + 1e3 * 0.5 * 9.81 * 0.05**2 + 0.5
    assert 72.0 < max(drafts) < 120.0
    assert min(drafts[drafts.index(max(drafts)) :]) > 0.0
    ((mean, unrest, archimedes),) = re.findall(r"^draft (\S+) \+- (\S+) mm, Archimedes (\S+) mm$", printed, re.M)
    assert float(archimedes) == pytest.approx(120.0 * 600.0 / 1000.0)
    assert float(mean) == pytest.approx(float(archimedes), abs=0.2 * 20.0)  # a fifth of the particles' spacing
    assert float(unrest) < 20.0
    # Its momentum hardly changes over the last second, so that the lift carries the weight on average.
    assert sum(lifts[20:]) / 20 == pytest.approx(1.0, abs=0.1)
    assert re.search(r"^particles: 2916 of water, \d+ of tank and box; 0 spilled$", printed, re.M)


def test_every_example_is_tested() -> None:
    assert {path.name for path in EXAMPLES.iterdir() if path.suffix == ".py"} == {"sph_floating_box.py"}
