"""How far a program comes, and which of two came farther."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.agents.flies import BALL, GROUND, flies
from tests.crashing import CRASH
from wsim.judge.verdict import Finding, Verdict
from wsim.program.compose import compose
from wsim.runs.attempt import Attempt, Reached, attempt
from wsim.runs.folder import RunFolder
from wsim.runs.iteration import Iteration
from wsim.runs.settings import Settings

PLAN = flies()
PROGRAM = compose(PLAN)
QUIET = Settings(device="cpu", pictures=False)


def tried(folder: Path, text: str, settings: Settings = QUIET) -> Attempt:
    return attempt(Iteration(RunFolder(folder).add(text), PLAN, settings))


def test_a_program_with_mistakes_is_not_run(tmp_path: Path) -> None:
    made = tried(tmp_path, PROGRAM.replace("scene.sphere(", "scene.spere("))
    assert (made.reached, made.verdict.status) == (Reached.VALIDATION, "rejected")
    (finding,) = (one for one in made.verdict.findings if "spere" in one.message)
    assert finding.line == f"program.py:{PROGRAM[: PROGRAM.index('scene.sphere(')].count(chr(10)) + 1}"
    assert {path.name for path in made.folder.iterdir()} == {"program.py", "verdict.json"}


DEEP = "".join(f"{' ' * k}if 1:\n" for k in range(1, 200))


@pytest.mark.timeout(300)
@pytest.mark.parametrize(
    "text", ["", "\x00", "x = '?'", "(" * 5000, "-" * 50_000 + "1", f"def build(scene):\n{DEEP}{' ' * 200}pass"]
)
def test_what_is_no_program_is_said(tmp_path: Path, text: str) -> None:
    made = tried(tmp_path, text)
    assert (made.reached, made.verdict.status) == (Reached.VALIDATION, "rejected")
    assert made.verdict.findings
    assert made.rank < (1, -1, 0.0)


def test_a_program_that_raises_made_no_world(tmp_path: Path) -> None:
    made = tried(tmp_path, PROGRAM.replace("    scene.ground(", "    assert 1 + 1 == 3\n    scene.ground(", 1))
    assert (made.reached, made.verdict.status) == (Reached.BUILD, "rejected")
    assert not (made.folder / "recording.rrd").exists()
    assert json.loads((made.folder / "checks.json").read_text())["build"]["ok"] is False


def test_a_fixed_camera_that_sees_nothing_is_found_before_anything_moves(tmp_path: Path) -> None:
    away = PROGRAM.replace("target=(0.0, 0.0, 1.2)", "target=(0.0, -40.0, 30.0), fixed=True")
    assert away != PROGRAM
    made = tried(tmp_path, away, Settings(device="cpu"))
    assert (made.reached, made.verdict.status) == (Reached.FRAMES, "rejected")
    (finding,) = made.verdict.findings
    assert (finding.check, finding.prim) == ("CheckView", "/World/side")
    assert finding.target is not None
    assert (finding.target.kind, finding.target.parameter) == ("camera", "eye, target")
    assert not (made.folder / "recording.rrd").exists()
    assert [path.name for path in (made.folder / "frames").iterdir()] == ["side_00.000s.png"]
    # The picture from there shows it.
    eye, target = finding.target.vector[:3], finding.target.vector[3:]
    there = PROGRAM.replace("eye=(0.0, -4.0, 1.5), target=(0.0, 0.0, 1.2)", f"eye={eye}, target={target}, fixed=True")
    assert there != PROGRAM
    assert tried(tmp_path / "again", there, Settings(device="cpu")).reached > Reached.FRAMES


def test_another_camera_that_sees_nothing_is_corrected(tmp_path: Path) -> None:
    """What fails is what the world does; its stills, of what was recorded without pictures, show the ball."""
    away = PROGRAM.replace("target=(0.0, 0.0, 1.2)", "target=(0.0, -40.0, 30.0)")
    made = tried(tmp_path, away, Settings(device="cpu"))
    assert [finding.check for finding in made.verdict.failures] == ["ObjectiveMoves"]
    rows = json.loads((made.folder / "review.json").read_text())["share_of_picture"]
    assert len(rows) == len(list((made.folder / "frames").glob("side_*.png"))) == 3  # of three frames
    assert min(row["objects"].get("/World/ball", 0.0) for row in rows) > 0.001


def test_a_world_of_clear_things_alone_is_not_said_to_show_nothing(tmp_path: Path) -> None:
    """What is clear is in no picture of what is opaque, by which the pixels are counted."""
    glass = {"name": "glass", "density": 2500, "opacity": 0.3}
    plan = flies(objects=[GROUND, {**BALL, "material": glass}])
    made = attempt(Iteration(RunFolder(tmp_path).add(compose(plan)), plan, Settings(device="cpu")))
    assert made.reached > Reached.FRAMES and "CheckView" not in {f.check for f in made.verdict.findings}


def test_a_world_that_does_not_pass_has_stills_and_no_video(tmp_path: Path) -> None:
    made = tried(tmp_path, PROGRAM, Settings(device="cpu"))
    assert (made.reached, made.verdict.status) == (Reached.PHYSICS, "rejected")
    assert [finding.check for finding in made.verdict.failures] == ["ObjectiveMoves"]
    assert made.earlier is None
    assert (made.folder / "recording.rrd").is_file()
    assert not (made.folder / "video.mp4").exists()
    assert len(list((made.folder / "frames").glob("*.png"))) == 3  # as many as frames
    written = Verdict.model_validate_json((made.folder / "verdict.json").read_text())
    assert written == made.verdict


def rank(reached: Reached, *findings: Finding) -> tuple[int, int, float]:
    verdict = Verdict(status="rejected", summary="", findings=list(findings))
    return Attempt(Path("01"), "", reached, verdict).rank


def miss(by: float, check: str = "CheckRest", limit: float = 1.0) -> Finding:
    return Finding(check=check, passed=False, message="", value=limit + by, limit=limit, margin=-by)


def test_farther_is_better_then_fewer_then_nearer() -> None:
    worst_first = [
        rank(Reached.VALIDATION, miss(1.0)),
        rank(Reached.BUILD, miss(1.0), miss(1.0, "CheckMass")),
        rank(Reached.BUILD, miss(1.0)),
        rank(Reached.PHYSICS, *[miss(0.1, f"Check{k}") for k in range(3)]),
        rank(Reached.PHYSICS, miss(0.1), miss(0.1, "CheckMass")),
        rank(Reached.PHYSICS, Finding(check="CheckRest", passed=False, message="")),
        rank(Reached.PHYSICS, miss(1000.0)),
        rank(Reached.PHYSICS, miss(0.5)),
        rank(Reached.PHYSICS, miss(0.4)),
        rank(Reached.PHYSICS, miss(0.4, limit=100.0)),  # of a hundred
        rank(Reached.REVIEW, *[miss(9.0, f"Check{k}") for k in range(9)]),
        rank(Reached.ALL),
    ]
    assert worst_first == sorted(worst_first)
    assert len(set(worst_first)) == len(worst_first)


def test_a_patch_that_only_makes_a_check_crash_is_no_better() -> None:
    verdict = Verdict(status="blocked", summary="", findings=[], crashes=[CRASH])
    unknown = Attempt(Path("01"), "", Reached.PHYSICS, verdict).rank
    assert rank(Reached.PHYSICS, miss(0.1), miss(0.1, "CheckMass")) < unknown < rank(Reached.PHYSICS, miss(0.1))
    assert unknown == rank(Reached.PHYSICS, Finding(check="CheckRest", passed=False, message=""))


def test_one_cause_that_is_found_twice_counts_once() -> None:
    assert rank(Reached.PHYSICS, miss(0.1), miss(0.1))[1] == -1
    assert rank(Reached.PHYSICS, miss(0.1)) == rank(Reached.PHYSICS, miss(0.1))  # no better, so it is undone
