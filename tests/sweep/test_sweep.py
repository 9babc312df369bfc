"""A sweep from program to table: a crate on a ramp stays where its friction is above the slope's tangent."""

from __future__ import annotations

import json
import math
import shutil
from pathlib import Path

import PIL.Image
import pyarrow.parquet
import pytest

from wsim.errors import UserError
from wsim.program.compose import compose
from wsim.rules.planner import plan as make_plan
from wsim.sweep.again import in_full, run_again, telling
from wsim.sweep.axis import Axis
from wsim.sweep.declared import axes_of, declared_by
from wsim.sweep.folder import SweepFolder
from wsim.sweep.picture import draw
from wsim.sweep.run import sweep
from wsim.sweep.spec import Spec
from wsim.sweep.table import ranked

SLOPE = 20.0  # [deg]
FAR, LONG = 0.9, 1.2  # what the sentence asks for [m], in this time [s]
# s = g (sin a - mu cos a) t^2 / 2
GREATEST = math.tan(math.radians(SLOPE)) - 2.0 * FAR / (9.80665 * LONG**2 * math.cos(math.radians(SLOPE)))  # 0.228
SENTENCE = f"An ice block slides down a wooden ramp of {SLOPE:g} degrees."
VALUES = (0.05, 0.2, 0.25, 0.8)


@pytest.fixture(scope="module")
def swept(tmp_path_factory: pytest.TempPathFactory) -> SweepFolder:
    base, plan = tmp_path_factory.mktemp("sweep"), make_plan(SENTENCE)
    plan.simulation.duration = LONG
    ramp = next(item for item in plan.objects if item.name == "wooden_ramp")
    assert ramp.material
    ramp.material.friction = 1.0  # of a pair the smaller one holds
    program = base / "ramp.py"
    text = compose(plan).replace("friction=0.05", 'friction=scene.param("friction", 0.05, low=0.0, high=1.0)')
    program.write_text(text, encoding="utf-8")
    axes = axes_of(declared_by([program]), [Axis(name="friction", low=0.05, high=0.8, values=VALUES)])
    spec = Spec(axes=axes, method="grid")
    folder = SweepFolder.create(base / "runs", "ramp", spec, [program], plan.model_dump_json())
    sweep(folder, workers=2)
    return folder


def test_the_boundary_is_where_theory_puts_it(swept: SweepFolder) -> None:
    outcomes = swept.outcomes()
    assert sorted(outcomes) == [0, 1, 2, 3, 4]
    assert outcomes[0].status == "accepted", outcomes[0].reason
    slides = {o.candidate.params["friction"]: o.status == "accepted" for k, o in outcomes.items() if k}
    assert slides == {friction: friction < GREATEST for friction in VALUES}
    assert outcomes[4].decided_by == "ice_block slides down wooden_ramp."


def test_a_sweep_goes_on_where_it_was_stopped(swept: SweepFolder, tmp_path: Path) -> None:
    again = SweepFolder(shutil.copytree(swept.path, tmp_path / "again"))
    lines = (again.path / "outcomes.jsonl").read_text().splitlines()
    (again.path / "outcomes.jsonl").write_text("\n".join(lines[:4]) + "\n" + lines[4][:40])
    assert len(again.outcomes()) == 4
    rows = sweep(again, workers=1)
    assert [row.candidate.number for row in rows] == [
        o.candidate.number for o in ranked(list(swept.outcomes().values()))
    ]
    table = pyarrow.parquet.read_table(again.path / "table.parquet")
    assert table["candidate"].to_pylist() == [row.candidate.number for row in rows]


def test_what_tells_most_is_run_again_and_is_the_same(swept: SweepFolder) -> None:
    rows = ranked(list(swept.outcomes().values()))
    chosen = telling(rows)
    assert chosen[0] == rows[0]
    assert {row.candidate.params.get("friction") for row in chosen} >= {0.2, 0.25, 0.8}
    asked = next(row for row in chosen if row.candidate.params.get("friction") == 0.25)
    run, own = run_again(swept, asked, pictures=False)
    assert run.facts()["same"] is True
    assert (own.status, own.values, own.note) == (asked.status, asked.values, "")
    assert (run.last_iteration() / "recording.rrd").is_file()


def test_the_verdict_of_its_own_run_is_the_one_that_counts(swept: SweepFolder, tmp_path: Path) -> None:
    """A batch that had accepted, as its best, a crate which does not slide: its own run says so, and ranks it."""
    folder = SweepFolder(shutil.copytree(swept.path, tmp_path / "batch"))
    rows = list(folder.outcomes().values())
    wrong = next(row for row in rows if row.candidate.params.get("friction") == 0.8)
    praised = wrong.model_copy(update={"status": "accepted", "slack": 0.99, "together": 64})
    found = in_full(folder, [praised if row is wrong else row for row in rows], pictures=False)
    assert [row.candidate.number for row in found] == [row.candidate.number for row in ranked(rows)]
    own = next(row for row in found if row.candidate == wrong.candidate)
    assert (own.status, own.together) == ("rejected", 1)
    assert own.note == "accepted when it was simulated with 63 others"
    assert found[0].status == "accepted" and found[0].together == 1
    assert (folder.path / "candidates" / f"{found[0].candidate.number:04d}" / "run.json").is_file()
    table = pyarrow.parquet.read_table(folder.path / "table.parquet")
    assert table["note"].to_pylist()[[row.candidate for row in found].index(wrong.candidate)] == own.note
    assert folder.outcomes()[wrong.candidate.number] == own


def test_whose_own_run_is_there_is_not_run_once_more(swept: SweepFolder, tmp_path: Path) -> None:
    """As after Ctrl-C between the runs in full and the page; one that was stopped midway is run again."""
    folder = SweepFolder(shutil.copytree(swept.path, tmp_path / "stopped"))
    found = in_full(folder, list(folder.outcomes().values()), pictures=False)
    runs = sorted((folder.path / "candidates").glob("*/run.json"))
    assert len(runs) > 1
    facts = json.loads(runs[0].read_text())
    del facts["same"]
    runs[0].write_text(json.dumps(facts))
    before = [path.stat().st_mtime_ns for path in runs]
    again = in_full(folder, list(folder.outcomes().values()), pictures=False)
    assert [path.stat().st_mtime_ns != old for path, old in zip(runs, before, strict=True)] == [
        path is runs[0] for path in runs
    ]
    assert [row.candidate for row in again] == [row.candidate for row in found]


def test_a_picture_has_a_panel_for_the_parameter(swept: SweepFolder) -> None:
    path = draw(ranked(list(swept.outcomes().values())), swept.path)
    assert path is not None
    assert PIL.Image.open(path).size == (432, 336)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ([Axis(name="fricton", low=0, high=1)], "no parameter 'fricton'; it has ice_density, friction"),
        ([Axis(name="friction", low=0.5, high=2)], "2 is outside friction's range, 0 to 1"),
    ],
)
def test_what_the_program_would_refuse_is_refused_first(swept: SweepFolder, given: list[Axis], said: str) -> None:
    with pytest.raises(UserError, match=said):
        axes_of(declared_by([swept.path / "ramp.py"]), given)


def test_a_folder_without_a_sweep_is_said(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="no sweep"):
        SweepFolder.open(tmp_path)
    (tmp_path / "sweep.json").write_text('{"repeats": 0}')
    with pytest.raises(UserError, match=r"repeats: .*greater than or equal to 1"):
        _ = SweepFolder.open(tmp_path).spec


BREAKS = """
from wsim.scene import Scene
def build(scene: Scene) -> None:
    height = scene.param("height", 1.0, low=0.5, high=2.0)
    scene.simulation(duration=0.1)
    scene.ground()
    if height > 1.2:
        raise ValueError(f"the shelf at {height:.2f} m is above the lamp")
    scene.sphere("ball", radius=0.1, density=500.0, position=(0, 0, height))
"""


def test_what_a_program_raised_is_in_its_row(tmp_path: Path) -> None:
    program = tmp_path / "shelf.py"
    program.write_text(BREAKS, encoding="utf-8")
    axes = axes_of(declared_by([program]), [Axis(name="height", low=0.5, high=2.0, values=(1.63,))])
    folder = SweepFolder.create(tmp_path / "runs", "shelf", Spec(axes=axes, method="grid"), [program])
    sweep(folder, workers=1)
    said = {number: outcome.reason for number, outcome in folder.outcomes().items()}
    assert said[0].startswith("Accepted")
    assert "ValueError: the shelf at 1.63 m is above the lamp" in said[1]
