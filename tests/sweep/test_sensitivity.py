"""Sobol' indices against those that theory and SciPy give, through a sweep's own points and outcomes."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from scipy import stats
from typer.testing import CliRunner

from wsim.cli import app
from wsim.errors import UserError
from wsim.sweep.axis import Axis
from wsim.sweep.candidate import Outcome
from wsim.sweep.sensitivity import ROOM, sensitivities
from wsim.sweep.spec import Spec

A, B = 7.0, 0.1  # of Ishigami and Homma (1990), "An importance quantification technique"
# Their variances: V1 = (1 + b pi^4 / 5)^2 / 2, V2 = a^2 / 8, V13 = 8 b^2 pi^8 / 225.
V1, V2, V13 = 0.5 * (1.0 + B * math.pi**4 / 5.0) ** 2, A**2 / 8.0, 8.0 * B**2 * math.pi**8 / 225.0
V = V1 + V2 + V13
FIRST = {"x": V1 / V, "y": V2 / V, "z": 0.0}  # 0.314, 0.442, 0
TOTAL = {"x": (V1 + V13) / V, "y": V2 / V, "z": V13 / V}  # 0.558, 0.442, 0.244

FALL = """
from wsim.scene import Scene
def build(scene: Scene) -> None:
    scene.simulation(duration=0.1)
    scene.ground()
    scene.sphere("ball", radius=0.1, density=500.0, position=(0, 0, scene.param("height", 0.5, low=0.2, high=1.0)))
"""


def spec_of(samples: int, repeats: int = 1) -> Spec:
    axes = [Axis(name=name, low=-math.pi, high=math.pi) for name in "xyz"]
    return Spec(axes=axes, method="saltelli", samples=samples, repeats=repeats)


def outcomes_of(spec: Spec) -> list[Outcome]:
    found = []
    for candidate in spec.candidates():
        x, y, z = (candidate.params.get(name, 0.0) for name in "xyz")
        value = math.sin(x) + A * math.sin(y) ** 2 + B * z**4 * math.sin(x)
        found.append(Outcome(candidate=candidate, status="accepted", slack=value / 20.0, margins={"far": value}))
    return found


def test_ishigami_has_the_indices_that_theory_gives() -> None:
    spec = spec_of(5 * 2048)
    room, far = sensitivities(spec, outcomes_of(spec)[::-1])  # in whatever order they were done
    assert (room.result, far.result, room.rows, room.lost) == (ROOM, "far", 2048, 0)
    assert [index.name for index in room.indices] == ["x", "y", "z"]  # the greatest total first
    for index, same in zip(room.indices, far.indices, strict=True):
        assert index.first == pytest.approx(FIRST[index.name], abs=0.02)
        assert index.total == pytest.approx(TOTAL[index.name], abs=0.02)
        assert index.first_between[0] <= FIRST[index.name] <= index.first_between[1]
        assert index.total_between[0] <= TOTAL[index.name] <= index.total_between[1]
        assert same.total == pytest.approx(index.total)  # a unit changes nothing


def test_they_are_scipys() -> None:
    spec = spec_of(5 * 64)
    outcomes = outcomes_of(spec)
    rows = np.array([outcome.margins["far"] for outcome in outcomes[1:]]).reshape(64, 5).T
    theirs = stats.sobol_indices(func={"f_A": rows[None, 0], "f_B": rows[None, 1], "f_AB": rows[2:, None]}, n=64)
    for index in sensitivities(spec, outcomes)[1].indices:
        k = "xyz".index(index.name)
        assert index.first == pytest.approx(theirs.first_order[k], abs=1e-9)
        assert index.total == pytest.approx(theirs.total_order[k], abs=1e-9)


def test_a_row_that_lost_a_candidate_is_left_out() -> None:
    spec = spec_of(5 * 64, repeats=2)
    outcomes = outcomes_of(spec)
    lost = [2 + 10 * 3 + 4, 2 + 10 * 7, 2 + 10 * 7 + 1]  # one of row 3, two of row 7; two stand as they are
    kept = [outcome for outcome in outcomes if outcome.candidate.number not in lost]
    kept.append(Outcome(candidate=outcomes[lost[0]].candidate, status="failed"))
    room = sensitivities(spec, kept)[0]
    assert (room.rows, room.lost) == (62, 2)


def test_points_of_another_design_and_results_that_do_not_vary_have_none() -> None:
    spec = spec_of(5 * 8)
    assert sensitivities(spec.model_copy(update={"method": "sobol"}), outcomes_of(spec)) == []
    same = [each.model_copy(update={"slack": 0.5, "margins": {}}) for each in outcomes_of(spec)]
    assert sensitivities(spec, same) == []


def test_too_few_are_refused_with_how_many_it_takes() -> None:
    with pytest.raises(UserError, match=r"--samples 39: .* --samples 40 "):
        spec_of(39).candidates()
    assert spec_of(100).count == 1 + 16 * 5 == len(spec_of(100).candidates())


def test_the_command_refuses_too_few_before_it_makes_a_folder(tmp_path: Path) -> None:
    program = tmp_path / "fall.py"
    program.write_text(FALL, encoding="utf-8")
    command = ["sweep", str(program), "--method", "saltelli", "-n", "20", "--runs", str(tmp_path / "runs")]
    ended = CliRunner().invoke(app, command)
    assert isinstance(ended.exception, UserError) and "give --samples 24" in str(ended.exception)
    assert not (tmp_path / "runs").exists()
