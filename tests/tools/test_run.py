"""Passes over a program: each leaves what it says, once, and the same every time."""

from __future__ import annotations

import hashlib
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tests.tools.conftest import RIGID, call_tool, done, refused, workspace_in
from wsim.recording import read
from wsim.sim.stills import Stills
from wsim.tools import Workspace


def folder_of(workspace: Workspace) -> Path:
    return workspace.run.path / "iterations" / "01"


def sums(folder: Path) -> dict[str, str]:
    return {
        path.relative_to(folder).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def test_build_tells_what_the_stage_holds(empty: Workspace) -> None:
    done(empty, "write_program", text=RIGID)
    text = done(empty, "run_program", passes="build")
    assert "ball    body    4.189      sphere 0.1             1, 0, 9" in text  # 4/3 pi r^3 of water
    assert "joint hinge: revolute, the world to arm" in text
    assert "cameras: side, wide" in text
    assert {path.name for path in folder_of(empty).iterdir()} == {"program.py", "stage.usda", "checks.json"}
    before = sums(folder_of(empty))
    assert done(empty, "run_program", passes="build") == text
    assert sums(folder_of(empty)) == before


@pytest.mark.parametrize(
    ("program", "said"),
    [
        ("def build(scene):\n    scene.box('a', size=(1, 2), density=1.0)\n", "[program.py:2]: SceneError: box"),
        ("def build(scene):\n    print('so far')\n    1 / 0\n", "ZeroDivisionError"),
        ("x = 1\n", "no function build(scene)"),
    ],
)
def test_a_program_that_makes_no_world_is_told_with_its_line(empty: Workspace, program: str, said: str) -> None:
    done(empty, "write_program", text=program, anyway=True)
    text = refused(empty, "run_program", passes="full")
    assert said in text
    assert ("so far" in program) == ("it printed:\nso far" in text)
    assert done(empty, "read_verdict").startswith("rejected: 1 of 1 findings fail")


def test_frames_simulate_nothing_and_are_as_the_stage_has_its_cameras(rigid: Workspace, tmp_path: Path) -> None:
    workspace = workspace_in(tmp_path / "runs" / "frames")
    done(workspace, "write_program", text=RIGID)
    result = call_tool(workspace, "run_program", passes="frames")
    assert result.image == folder_of(workspace) / "frames" / "side_00.000s.png"
    assert not (folder_of(workspace) / "recording.rrd").exists()
    (drawn,) = Stills(folder_of(rigid) / "stage.usda", "cpu").draw_start()[:1]  # by the camera as the program has it
    with Image.open(result.image) as picture:
        assert (np.asarray(picture) == drawn.rgb).all()
    shown = json.loads((folder_of(workspace) / "review.json").read_text())["share_of_picture"]
    assert {"/World/ground", "/World/block", "/World/arm"} == set(shown[0]["objects"])
    assert "no pixel (out of sight, or glass): ball" in result.text


def test_the_same_calls_answer_the_same_and_write_the_same(rigid: Workspace, tmp_path: Path) -> None:
    other = workspace_in(tmp_path / "runs" / "other")
    done(other, "write_program", text=RIGID)
    assert done(other, "run_program", passes="physics") == done(rigid, "run_program", passes="physics")
    asked = [
        ("query_recording", {"signal": "position", "prim": "arm"}),
        ("query_recording", {"signal": "energy/kinetic", "reduction": "max"}),
        ("read_verdict", {"passed": True}),
        ("still", {"time": 0.5}),
    ]
    for name, arguments in asked:
        mine, theirs = call_tool(rigid, name, **arguments), call_tool(other, name, **arguments)
        assert mine.text == theirs.text
        if mine.image and theirs.image:
            assert mine.image.read_bytes() == theirs.image.read_bytes()


def test_a_pass_that_was_made_is_not_made_again(rigid: Workspace) -> None:
    before = sums(folder_of(rigid))
    done(rigid, "run_program", passes="physics")
    done(rigid, "run_program", passes="build")
    assert {name: sums(folder_of(rigid))[name] for name in before} == before


def test_full_adds_pictures_and_what_is_seen(tank: Workspace) -> None:
    names = {path.name for path in folder_of(tank).iterdir()}
    assert names >= {"recording.rrd", "verdict.json", "video.mp4", "review.json", "frames"}
    assert len(read(folder_of(tank) / "recording.rrd").seen["/World/side"].time) == 7
    text = done(tank, "run_program", passes="full")
    assert "frames/top_00.300s.png" in text
    assert "256 particles" in text


def test_a_full_pass_that_is_stopped_leaves_the_recording_of_before(tmp_path: Path) -> None:
    workspace = workspace_in(tmp_path / "runs" / "stopped")
    program = RIGID.replace("duration=1.0", "duration=0.2")
    done(workspace, "write_program", text=program)
    done(workspace, "run_program", passes="physics")
    before = sums(folder_of(workspace))

    class Stop(BaseException):
        pass

    def stop(stage: str, amount: float, total: float) -> None:
        if stage == "simulating" and amount >= 2:
            raise Stop

    with pytest.raises(Stop):
        call_tool(replace(workspace, progress=stop), "run_program", passes="full")
    assert read(folder_of(workspace) / "recording.rrd").complete
    after = sums(folder_of(workspace))
    assert {name: after[name] for name in before} == before
    assert "video.mp4" in done(workspace, "run_program", passes="full")


def test_without_pictures_full_is_physics(tmp_path: Path) -> None:
    workspace = workspace_in(tmp_path / "runs" / "plain")
    workspace.settings.pictures = False
    done(workspace, "write_program", text=RIGID.replace("duration=1.0", "duration=0.2"))
    assert "pictures:" not in done(workspace, "run_program", passes="full")
    assert not (folder_of(workspace) / "video.mp4").exists()


@pytest.mark.parametrize("camera", ["side", "top"])
def test_a_still_of_the_recording_is_the_picture_of_the_run(tank: Workspace, camera: str) -> None:
    """Poses and particles are recorded bit for bit, so the picture is the one that was drawn while it ran."""
    result = call_tool(tank, "still", camera=camera, time=0.3)
    assert result.image == folder_of(tank) / "stills" / f"{camera}_00.300s.png"
    drawn = np.asarray(Image.open(folder_of(tank) / "frames" / f"{camera}_00.300s.png"))
    start = np.asarray(Image.open(folder_of(tank) / "frames" / f"{camera}_00.000s.png"))
    again = np.asarray(Image.open(result.image))
    assert (drawn == again).all()
    assert (drawn != start).mean() > 0.01


def test_a_still_counts_pixels_as_geometry_has_them(rigid: Workspace) -> None:
    """The block's top face, 0.2 m, 2 m below a camera of 50 degrees and 640 pixels across."""
    text = done(rigid, "still", eye=(0.0, 0.0, 2.2), target=(0.0, 0.0, 0.0), time=0.5)
    edge = 0.2 / (2 * 2.0 * 0.46631) * 640  # tan(25 deg)
    pixels = int(text.split("block ")[1].split(" ")[0])
    assert pixels == pytest.approx(edge**2, rel=0.03)
    assert "t = 0.5 s" in text
    assert "no pixel (out of sight, or glass): arm, ball" in text


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ({"camera": "front"}, "no 'front'; there are side, wide,"),
        ({"time": 7.0}, "7 s is after the recording's end at 1 s"),
        ({"time": -1.0}, "greater than or equal to 0"),
        ({"time": float("nan")}, "finite"),
        ({"eye": (0, 0, 1)}, "go together"),
        ({"eye": (0, 0, 1), "target": (0, 0, 1)}, "move one of them"),
        ({"eye": (0, 0, float("inf")), "target": (0, 0, 1)}, "finite"),
        ({"iteration": 4}, "iteration 4 is not there; the newest is 01"),
    ],
)
def test_a_still_that_cannot_be(rigid: Workspace, asked: dict, said: str) -> None:
    assert said in refused(rigid, "still", **asked)


def test_nothing_runs_where_there_is_no_program(empty: Workspace) -> None:
    assert "write_program" in refused(empty, "run_program")
    assert "write_program" in refused(empty, "still")
    assert "write_program" in refused(empty, "read_program")
