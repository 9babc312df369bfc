"""`wsim generate`, and `wsim run` of what it made: real runs of a small tank of coarse water."""

from __future__ import annotations

import hashlib
import json
import re
from pathlib import Path

import numpy as np

from wsim.plan.schema import Plan
from wsim.recording import read

ALWAYS = {
    "run.json",
    "plan.json",
    "plan.png",
    "transcript.jsonl",
    "report.html",
    "iterations/01/program.py",
    "iterations/01/checks.json",
    "iterations/01/stage.usda",
    "iterations/01/recording.rrd",
    "iterations/01/verdict.json",
}
ACCEPTED = {"accepted/program.py", "accepted/stage.usda", "accepted/acceptance.json", "accepted/SHA256SUMS"}
PICTURES = {"iterations/01/video.mp4", "iterations/01/review.json"}


def files(run: Path) -> set[str]:
    return {str(path.relative_to(run)) for path in run.rglob("*") if path.is_file()}


def test_a_block_floats_and_its_run_is_whole(floating) -> None:
    assert floating.code == 0, floating.out + floating.err
    assert floating.err == ""
    assert floating.verdict["status"] == "accepted"
    assert files(floating.run) == ALWAYS | ACCEPTED
    for line in (floating.run / "accepted" / "SHA256SUMS").read_text().splitlines():
        digest, name = line.split()
        assert hashlib.sha256((floating.run / "accepted" / name).read_bytes()).hexdigest() == digest
    facts = json.loads((floating.run / "run.json").read_text())
    assert facts["status"] == "accepted"
    assert facts["seconds"] > 0.0
    assert Plan.model_validate_json((floating.run / "plan.json").read_text()).prompt == facts["prompt"]


def test_the_floating_block_lies_as_deep_as_archimedes_says(floating) -> None:
    recording = read(floating.run / "iterations" / "01" / "recording.rrd")
    water = recording.fluids["/World/water"].position[-1]
    spacing, half_height = 0.05, 0.07
    surface = np.quantile(water[:, 2], 0.98) + spacing / 2
    draft = surface - (recording.position("/World/wooden_block")[-5:, 2].mean() - half_height)
    assert abs(draft - 0.6 * 2 * half_height) < spacing


def test_with_pictures_every_file_is_there(pictured) -> None:
    assert pictured.code == 0, pictured.out + pictured.err
    found = files(pictured.run)
    frames = {name for name in found if name.startswith("iterations/01/frames/")}
    assert found - frames == ALWAYS | PICTURES | ACCEPTED
    assert len(frames) == 3 * 2  # frames, cameras
    assert all(name.endswith(".png") for name in frames)
    iteration = pictured.run / "iterations" / "01"
    lines = [json.loads(line) for line in (pictured.run / "transcript.jsonl").read_text().splitlines()]
    assert [line["role"] for line in lines] == ["planner", "coder"]
    assert lines[1]["reply"] == (iteration / "program.py").read_text()
    shares = json.loads((iteration / "review.json").read_text())["share_of_picture"]
    assert {look["camera"] for look in shares} == {"/World/side", "/World/top"}
    assert all(0.0 < look["objects"]["/World/wooden_block"] < 1.0 for look in shares)
    checks = json.loads((iteration / "checks.json").read_text())
    assert sorted(checks["simulation"]["stills"]) == sorted(Path(name).name for name in frames)
    recording = read(iteration / "recording.rrd")
    assert len(recording.images["/World/side"].time) == 3
    assert len(recording.time) == 3


def test_the_same_program_run_again_is_the_same_bit_for_bit(floating, reruns) -> None:
    again, _ = reruns
    assert again.code == 0, again.out + again.err
    assert again.verdict == floating.verdict
    first, second = (read(run / "iterations" / "01" / "recording.rrd") for run in (floating.run, again.run))
    assert first.body_q.tobytes() == second.body_q.tobytes()
    assert first.body_qd.tobytes() == second.body_qd.tobytes()
    for name in ("position", "velocity", "density"):
        one, two = (getattr(r.fluids["/World/water"], name) for r in (first, second))
        assert len(one) == 21
        assert one.tobytes() == two.tobytes()


def test_heavy_wood_is_rejected_with_the_evidence(floating, reruns) -> None:
    _, heavy = reruns
    assert heavy.code == 1, heavy.err
    mass, failure = (finding for finding in heavy.verdict["findings"] if not finding["passed"])
    assert (mass["check"], failure["check"]) == ("CheckMass", "ObjectiveFloats")
    assert mass["target"]["parameter"] == failure["target"]["parameter"] == "density"
    assert failure["prim"] == "/World/wooden_block"
    assert 0.0 < failure["time"] < 2.0
    assert failure["value"] > failure["limit"] >= 0.14 - 1e-6
    depth = (288 * 0.05**3 + 0.2 * 0.2 * 0.14) / 0.4**2  # of the water with the block in it
    assert abs(failure["expected"] - depth) < 1e-3
    assert abs(failure["value"] - depth) < 0.01
    number = int(re.fullmatch(r"program\.py:(\d+)", failure["line"])[1])
    program = (heavy.run / "iterations" / "01" / "program.py").read_text()
    call = "\n".join(program.splitlines()[number - 1 : number + 3])
    assert call.lstrip().startswith("scene.box(")
    assert '"wooden_block"' in call
    assert "with 2500 kg/m^3 Archimedes has it on the floor" in " ".join(heavy.out.split())
    assert program == (floating.run / "accepted" / "program.py").read_text()
    assert not (heavy.run / "accepted").exists()
    assert json.loads((heavy.run / "run.json").read_text())["params"] == {"wood_density": 2500.0}
    assert "wooden_block" in (heavy.run / "report.html").read_text()


def test_a_parameter_that_the_program_lacks_is_named_with_those_it_has(wsim, floating) -> None:
    ended = wsim("run", floating.run, "--set", "wood_densty=700", "--no-pictures")
    assert ended.code == 2
    assert ended.err == "wsim: --set wood_densty=700: the program has no parameter 'wood_densty'; it has wood_density\n"
    assert not ended.runs.exists()


def test_a_program_that_builds_with_the_value_alone_is_run(wsim, tmp_path: Path) -> None:
    (tmp_path / "program.py").write_text(
        "def build(scene):\n"
        "    scene.simulation(duration=0.1)\n"
        "    edge = scene.param('edge', 0.0, low=0.0, high=1.0)\n"
        "    scene.box('crate', size=(edge, edge, edge), position=(0, 0, 1))\n"
    )
    ended = wsim("run", "program.py", "--set", "edge=0.2", "--no-pictures", "--device", "cpu")
    assert ended.code == 0, ended.err + ended.out


def test_a_plan_that_is_none_is_said_in_one_line(wsim, tmp_path: Path) -> None:
    (tmp_path / "plan.json").write_text('{"title": 1}')
    ended = wsim("generate", "--plan", "plan.json", "--yes")
    assert ended.code == 2
    assert ended.err.startswith("wsim: plan.json: not a plan")
    assert ended.err.count("\n") == 1
    assert not ended.runs.exists()
