"""Several programs and patches in one sweep, crossed with points, draws and seeds; which candidates that makes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyarrow.parquet
import pytest
from hypothesis import given
from hypothesis import strategies as st
from typer.testing import CliRunner

from wsim import recording
from wsim.cli import app
from wsim.errors import UserError
from wsim.report.side_by_side import recorded
from wsim.report.sweep_page import write as write_page
from wsim.sweep.again import run_again
from wsim.sweep.axis import Axis
from wsim.sweep.folder import SweepFolder
from wsim.sweep.run import sweep
from wsim.sweep.spec import Spec
from wsim.sweep.variant import called, variants

G = 9.81
SLIDE = """
def build(scene):
    speed = scene.param("speed", 1.5, low=0.5, high=2.0, unit="m/s")
    scene.simulation(duration=1.2, frame_rate=20.0)
    scene.ground(friction=1.0)
    scene.box("crate", size=(0.4, 0.4, 0.05), position=(0, 0, 0.025), velocity=(speed, 0, 0), density=500.0,
              friction=0.5)
"""
SLIPPERY = """
<<<<<<< SEARCH
              friction=0.5)
=======
              friction=scene.param("friction", 0.25, low=0.1, high=0.9))
>>>>>>> REPLACE
"""
POST = """\
--- a/slide.py
+++ b/slide.py
@@ -5,3 +5,4 @@
     scene.ground(friction=1.0)
+    scene.box("post", size=(0.1, 0.1, 1.0), position=(0, 5, 0.5), static=True)
     scene.box("crate", size=(0.4, 0.4, 0.05), position=(0, 0, 0.025), velocity=(speed, 0, 0), density=500.0,
               friction=0.5)
"""


@pytest.fixture
def files(tmp_path: Path) -> Path:
    (tmp_path / "slide.py").write_text(SLIDE)
    (tmp_path / "slippery.patch").write_text(SLIPPERY)
    (tmp_path / "post.diff").write_text(POST)
    return tmp_path


def asked(files: Path, *options: str) -> SweepFolder:
    """A sweep as the command line runs it."""
    given = ["sweep", str(files / "slide.py"), "--runs", str(files / "runs"), "--workers", "1", "--no-full", *options]
    ended = CliRunner().invoke(app, given)
    if isinstance(ended.exception, UserError):
        raise ended.exception
    assert ended.exit_code == 0, ended.output
    (folder,) = (files / "runs").iterdir()
    return SweepFolder(folder)


def patched(files: Path, *options: str) -> SweepFolder:
    patches = ["--patch", str(files / "slippery.patch"), "--patch", str(files / "post.diff")]
    return asked(files, *patches, *options)


def far(folder: SweepFolder, number: int) -> float:
    """How far the crate of a candidate's own run slid [m]."""
    run, own = run_again(folder, folder.outcomes()[number], pictures=False)
    assert run.facts()["same"] is True
    assert run.facts()["program"] == own.candidate.program
    x = recording.read(run.iteration(1) / "recording.rrd").position("/World/crate")[:, 0]
    return float(x[-1] - x[0])


def test_programs_patches_points_and_seeds_are_crossed_and_each_slides_as_its_own_program_has_it(files: Path) -> None:
    """v^2 / (2 mu g), with the friction of the patch, and that of the program where it has none."""
    folder = patched(files, "--vary", "speed=1,1.4", "--vary", "friction=0.2,0.4", "--method", "grid")
    outcomes = folder.outcomes()
    found = [(o.candidate.program, tuple(o.candidate.params.values())) for _, o in sorted(outcomes.items())]
    base, slippery, post = "slide.py", "slide+slippery.py", "slide+post.py"
    assert found[:3] == [(base, ()), (slippery, ()), (post, ())]
    assert [values for name, values in found[3:] if name == slippery] == [(1, 0.2), (1, 0.4), (1.4, 0.2), (1.4, 0.4)]
    for name in (base, post):  # neither has a friction: the same is run once
        assert [values for own, values in found[3:] if own == name] == [(1,), (1.4,)]
    for number, (name, values) in enumerate(found):
        if values in ((1.4, 0.2), (1.4,)) and name != post:
            mu = 0.2 if name == slippery else 0.5
            assert far(folder, number) == pytest.approx(1.4**2 / (2.0 * mu * G), rel=0.02)
    table = pyarrow.parquet.read_table(folder.path / "table.parquet").to_pylist()
    assert {(row["program"], row["friction"]) for row in table if row["speed"] == 1.0} == {
        (base, None),
        (post, None),
        (slippery, 0.2),
        (slippery, 0.4),
    }
    page = write_page(folder).read_text()
    assert "slide+post.py, of slide.py" in page and '<span class="added">' in page
    assert {name for name, _ in recorded(folder.path)} >= {f"candidate {found.index((base, (1.4,)))}, slide.py"}


def test_what_differs_in_bodies_goes_into_a_batch_of_its_own(files: Path) -> None:
    folder = patched(files, "--vary", "speed=1:1.4", "--samples", "3", "--repeats", "2", "--worlds", "64")
    outcomes = folder.outcomes()
    assert len(outcomes) == (1 + 3) * 3 * 2
    together = {o.candidate.program: o.together for o in outcomes.values()}
    assert together == {"slide.py": 16, "slide+slippery.py": 16, "slide+post.py": 8}  # frictions differ within a batch


def test_patches_alone_are_run_as_they_stand_and_a_stopped_sweep_goes_on(files: Path) -> None:
    folder = patched(files, "--samples", "0", "--repeats", "2")
    lines = (folder.path / "outcomes.jsonl").read_text().splitlines()
    assert len(lines) == 6
    (folder.path / "outcomes.jsonl").write_text("\n".join(lines[:4]) + "\n")
    rows = sweep(folder, workers=1)
    assert sorted((row.candidate.program, row.candidate.seed) for row in rows) == [
        (name, seed) for name in ("slide+post.py", "slide+slippery.py", "slide.py") for seed in (0, 1)
    ]


PUSHED = """
def build(scene):
    late = scene.param("late", 0.5, low=0.1, high=1.0, unit="s")
    scene.simulation(duration=1.5, frame_rate=20.0)
    scene.ground()
    lift = scene.box("lift", size=(0.3, 0.3, 0.1), position=(0, 0, 1), mass=1.0, kinematic=True)
    scene.path(lift, times=[late, late + 0.4], positions=[(0, 0, 1), (0, 0, 1.5)])
"""


def test_when_a_path_has_its_key_frames_is_a_candidate(tmp_path: Path) -> None:
    (tmp_path / "slide.py").write_text(PUSHED)
    folder = asked(tmp_path, "--vary", "late=0.2,0.9", "--method", "grid")
    for number, late in ((1, 0.2), (2, 0.9)):
        run, _ = run_again(folder, folder.outcomes()[number], pictures=False)
        seen = recording.read(run.iteration(1) / "recording.rrd")
        z = seen.position("/World/lift")[:, 2]
        assert np.interp(1.25, z, seen.time) == pytest.approx(late + 0.2, abs=0.02)  # half way, at half time


NOWHERE = "<<<<<<< SEARCH\nscene.water()\n=======\nscene.lava()\n>>>>>>> REPLACE\n"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (SLIPPERY + NOWHERE, r"does not apply to slide\.py: edit 2 of 2: these lines are not in the program"),
        ("scene.ground()\n", r"bad\.patch: no edit: give at least one block"),
        (POST[:-30], r"bad\.patch: hunk 1 ends after"),
        (POST + POST, r"bad\.patch: it changes 2 files"),
        (SLIPPERY.replace('scene.param("friction", 0.25, low=0.1, high=0.9)', "0.5"), r"changes nothing in slide\.py"),
        (SLIPPERY.replace("0.25", "2.5"), r"slide\+bad\.py makes no world as it stands: .*default = 2.5 lies outside"),
    ],
)
def test_a_patch_that_does_not_fit_is_said_before_anything_is_run(files: Path, text: str, said: str) -> None:
    (files / "bad.patch").write_text(text)
    with pytest.raises(UserError, match=said) as told:
        asked(files, "--patch", str(files / "bad.patch"))
    assert "\n" not in str(told.value)
    assert not (files / "runs").exists()


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--vary", "fricton=0.1:0.2"], r"none of slide\.py, slide\+slippery\.py, .* has a parameter 'fricton'"),
        (["--vary", "friction=0.1:2"], r"2 is outside friction's range in slide\+slippery\.py, 0\.1 to 0\.9"),
        (["--randomise", "post.friction=0.1:0.2"], r"--randomise for slide\.py: post\.friction: the world has no"),
        (["--vary", "speed=1:2", "--vary", "speed=1,2"], "--vary speed is given twice"),
        (["--vary", "speed=1:2", "--zip", "speed,friction"], "--zip speed,friction: 'friction' is not varied"),
        (["--samples", "1000000", "--repeats", "10000"], "30,000,030,000 candidates are more than 10,000,000"),
        (["--samples", "0", "--vary", "speed=1:2"], "--samples 0 runs the programs as they stand alone"),
    ],
)
def test_what_no_program_of_them_has_is_said_with_their_names(files: Path, options: list[str], said: str) -> None:
    with pytest.raises(UserError, match=said):
        patched(files, *options)
    assert not (files / "runs").exists()


def test_a_file_that_is_not_there_or_no_text_is_said(files: Path) -> None:
    with pytest.raises(UserError, match=r"nothing\.patch cannot be read: No such file"):
        asked(files, "--patch", str(files / "nothing.patch"))
    (files / "slippery.patch").write_bytes(b"\xff\xfe")
    with pytest.raises(UserError, match=r"slippery\.patch is no text in UTF-8"):
        asked(files, "--patch", str(files / "slippery.patch"))


def test_programs_of_one_name_are_told_apart(tmp_path: Path) -> None:
    for name in ("a", "b", "c"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "program.py").write_text(SLIDE)
    a, b, c = (tmp_path / name for name in ("a", "b", "c"))
    file = "program.py"
    assert list(called([(a, a / file), (b, b / file)])) == ["a.py", "b.py"]  # folders of runs
    assert list(called([(a / file, a / file), (c, c / file)])) == ["01-program.py", "c.py"]
    assert list(called([(a / file, a / file)])) == [file]
    with pytest.raises(UserError, match="is named twice"):
        called([(a, a / file), (a / file, a / file)])


def test_patches_of_one_name_are_told_apart(files: Path) -> None:
    (files / "more").mkdir()
    (files / "more" / "slippery.patch").write_text(SLIPPERY.replace("0.25", "0.3"))
    patches = [files / "slippery.patch", files / "more" / "slippery.patch"]
    with variants({"slide.py": files / "slide.py"}, patches) as found:
        assert {path.name: of for path, of in found.items()} == {
            "slide.py": "",
            "slide+slippery.py": "slide.py",
            "slide+slippery-2.py": "slide.py",
        }
        assert [path.read_text().count("0.3") for path in found] == [0, 0, 1]


@given(
    values=st.lists(st.integers(0, 3), min_size=1, max_size=5),
    others=st.lists(st.integers(0, 3), min_size=1, max_size=5),
    lacks=st.sampled_from([{}, {"b.py": ["x"]}, {"b.py": ["x", "y"]}, {"a.py": ["x"], "b.py": ["y"]}]),
    repeats=st.integers(1, 2),
    method=st.sampled_from(["grid", "sobol"]),
)
def test_each_candidate_is_there_once_and_as_many_as_are_said(values, others, lacks, repeats: int, method) -> None:
    axes = [
        Axis(name=name, low=min(of), high=max(of), values=tuple(map(float, of)))
        for name, of in (("x", values), ("y", others))
    ]
    spec = Spec(programs=["a.py", "b.py"], axes=axes, lacks=lacks, repeats=repeats, method=method, samples=64)
    candidates = spec.candidates()
    assert [each.number for each in candidates] == list(range(spec.count))
    keys = [(each.program, each.seed, *sorted(each.params.items())) for each in candidates]
    assert len(set(keys)) == len(keys)
    assert [(each.program, each.params) for each in candidates[: 2 * repeats : repeats]] == [("a.py", {}), ("b.py", {})]
    for program in ("a.py", "b.py"):
        had = {name for name in "xy" if name not in lacks.get(program, ())}
        combinations = {
            tuple((name, float(value)) for name, value in (("x", x), ("y", y)) if name in had)
            for x in values
            for y in others
        }
        if method == "grid":
            points = {tuple(each.params.items()) for each in candidates[2 * repeats :] if each.program == program}
            assert points == combinations - {()}
