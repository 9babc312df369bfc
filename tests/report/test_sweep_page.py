"""The page of a sweep: what it says of the outcomes, that it draws each, and that no script runs but its own."""

from __future__ import annotations

import base64
import hashlib
import re
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from wsim.report.sweep_charts import MOST, draw
from wsim.report.sweep_page import MOST_ROWS, reasons, write
from wsim.sweep.axis import Axis
from wsim.sweep.candidate import Outcome
from wsim.sweep.folder import SweepFolder
from wsim.sweep.sensitivity import sensitivities
from wsim.sweep.spec import Spec

AXES = [Axis(name="density", low=300.0, high=900.0), Axis(name="level", low=0.01, high=1.0, scale="log")]
HOSTILE = '<script>alert("x")</script>'


def outcomes_of(spec: Spec) -> list[Outcome]:
    found = []
    for candidate in spec.candidates():
        density, level = candidate.params.get("density", 600.0), candidate.params.get("level", 0.1)
        room = (600.0 - density) / 300.0 + 0.2 * np.log10(level / 0.1)
        slack = float(np.clip(room, -1.0, 1.0))
        status = "accepted" if slack >= 0.0 else "rejected"
        failures = [] if slack >= 0.0 else [HOSTILE]
        found.append(
            Outcome(candidate=candidate, status=status, slack=slack, reason=HOSTILE, failures=failures, seconds=1.5)
        )
    return found


@pytest.fixture
def folder(tmp_path: Path) -> SweepFolder:
    program = tmp_path / "tank.py"
    program.write_text("", encoding="utf-8")
    spec = Spec(axes=AXES, method="saltelli", samples=64)
    return SweepFolder.create(tmp_path / "runs", "tank", spec, [program])


def fill(folder: SweepFolder, count: int | None = None) -> list[Outcome]:
    done = outcomes_of(folder.spec)[:count]
    for outcome in done:
        folder.add(outcome)
    return done


def test_the_page_has_counts_rows_marks_and_reasons(folder: SweepFolder) -> None:
    done = fill(folder)
    folder.finish(done)
    html = write(folder).read_text(encoding="utf-8")
    accepted = sum(outcome.status == "accepted" for outcome in done)
    assert f'<dt>accepted</dt><dd class="accepted">{accepted}</dd>' in html
    assert html.count('<td class="status">') == len(done) + 1  # a row each, and the one reason
    varied = len(done) - 1
    assert html.count('<g class="mark ') == 3 * varied + 3  # room by density and level, one by the other; the key
    assert html.count('<polyline class="way ') == varied
    assert "What the room to the limit hangs on" in html
    assert "sweep --resume" not in html


def test_a_sweep_that_was_stopped_says_how_to_go_on(folder: SweepFolder) -> None:
    assert "0 of 65 candidates are done" in write(folder).read_text(encoding="utf-8")
    fill(folder, 10)
    html = write(folder).read_text(encoding="utf-8")
    assert "10 of 65 candidates are done" in html
    assert f"wsim sweep --resume {folder.path}" in html


def test_nothing_runs_but_the_script_that_the_policy_names(folder: SweepFolder) -> None:
    fill(folder)
    html = write(folder).read_text(encoding="utf-8")
    scripts = re.findall(r"<script>(.*?)</script>", html, re.DOTALL)
    assert len(scripts) == 1
    digest = base64.b64encode(hashlib.sha256(scripts[0].encode()).digest()).decode()
    assert f"script-src 'sha256-{digest}'" in html
    assert "http://" not in html and "https://" not in html


def test_drawings_are_of_finite_numbers_whatever_the_outcomes() -> None:
    for seed, method in enumerate(("random", "grid", "latin")):
        spec = Spec(axes=AXES, method=method, samples=20, seed=seed)
        outcomes = outcomes_of(spec)
        outcomes[3] = Outcome(candidate=outcomes[3].candidate, status="failed", reason="lost")
        same = [each for each in outcomes if each.candidate.params][:1]
        for given in (outcomes, same, []):
            for drawing in draw(given, AXES, sensitivities(spec, given)):
                ElementTree.fromstring(str(drawing.svg))  # it is well formed
                assert "nan" not in drawing.svg and "inf" not in drawing.svg


def test_of_very_many_the_best_and_the_worst_are_drawn_and_it_is_said(tmp_path: Path) -> None:
    spec = Spec(axes=AXES, method="random", samples=MOST + 10)
    (tmp_path / "a.py").write_text("", encoding="utf-8")
    folder = SweepFolder.create(tmp_path / "runs", "many", spec, [tmp_path / "a.py"])
    outcomes = sorted(outcomes_of(spec), key=lambda outcome: outcome.rank)
    drawing = draw(outcomes, AXES, [])[0]
    assert drawing.svg.count("<g ") == MOST and f"of {MOST + 10}" in drawing.note
    lines = "\n".join(outcome.model_dump_json() for outcome in outcomes)
    (folder.path / "outcomes.jsonl").write_text(lines, encoding="utf-8")
    html = write(folder).read_text(encoding="utf-8")
    assert f"{MOST_ROWS} of {MOST + 11}, all are in" in html


def test_reasons_are_grouped_by_what_failed_the_most_frequent_first() -> None:
    spec = Spec(axes=AXES, samples=8)
    outcomes = [
        Outcome(candidate=c, status="rejected", failures=["a"] if c.number % 3 else ["a", "b"], reason=str(c.number))
        for c in spec.candidates()
    ]
    found = reasons(outcomes)
    assert [(each.failures, each.count, each.example.candidate.number) for each in found] == [
        (["a"], 6, 1),
        (["a", "b"], 3, 0),
    ]


def test_where_nothing_was_asked_there_is_no_empty_plot_but_a_word(folder: SweepFolder) -> None:
    for outcome in outcomes_of(folder.spec):
        folder.add(outcome.model_copy(update={"slack": None}))
    html = write(folder).read_text(encoding="utf-8")
    assert "no plan asks anything of it" in html
    assert "Room to the limit against" not in html and "level against density" in html
