"""What is drawn for each candidate: the words of `--randomise`, the same draws again, and what comes of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyarrow.parquet
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats
from typer.testing import CliRunner

from wsim import recording
from wsim.cli import app
from wsim.errors import UserError
from wsim.report.sweep_page import write as write_page
from wsim.sweep.again import run_again
from wsim.sweep.axis import Axis
from wsim.sweep.candidate import Outcome
from wsim.sweep.draw import Draw, parse, parse_all
from wsim.sweep.folder import SweepFolder
from wsim.sweep.picture import draw as draw_picture
from wsim.sweep.run import sweep
from wsim.sweep.spec import Spec

SPEED, G = 1.5, 9.81
PROGRAM = f"""
def build(scene):
    scene.simulation(duration=1.0)
    scene.ground(friction=1.0)
    scene.box("crate", size=(0.4, 0.4, 0.05), position=(0, 0, 0.025), velocity=({SPEED}, 0, 0), density=500.0,
              friction=scene.param("friction", 0.5, low=0.1, high=0.9))
    if scene.param("bare", 0.0, low=0.0, high=1.0) < 0.5:
        scene.box("post", size=(0.1, 0.1, 1.0), position=(0, 5, 0.5), static=True)
"""
MU = Draw(target="crate", what="friction", low=0.2, high=0.6)


@given(
    target=st.from_regex(r"[a-z_][a-z0-9_]{0,8}(/[a-z]{1,4})?", fullmatch=True),
    what=st.sampled_from(["mass", "friction", "level"]),
    ends=st.tuples(st.floats(1e-6, 9.0), st.floats(1e-6, 9.0)).filter(lambda ends: ends[0] != ends[1]),
    times=st.booleans(),
)
def test_a_range_is_read_as_it_is_written(target: str, what, ends: tuple[float, float], times: bool) -> None:
    low, high = sorted(ends)
    suffix = "x" if times else ""
    (made,) = parse(f"{target}.{what}={low!r}:{high!r}{suffix}")
    assert made == Draw(target=target, what=what, low=low, high=high, times=times)
    assert made.name == f"{target}.{what}{' x' if times else ''}"
    assert all(low <= made.at(0, k, 0) <= high for k in range(20))
    with pytest.raises(UserError, match="not below"):
        parse(f"{target}.{what}={high!r}:{low!r}{suffix}")


@given(middle=st.floats(0.5, 5.0), deviation=st.floats(0.001, 0.1), what=st.sampled_from(["mass", "friction", "level"]))
def test_a_normal_distribution_is_cut_off_where_hardly_any_of_it_is(middle: float, deviation: float, what) -> None:
    (made,) = parse(f"crate.{what}=normal:{middle!r}:{deviation!r}")
    assert (made.low, made.high) == pytest.approx((middle - 4.0 * deviation, middle + 4.0 * deviation))
    assert all(made.low <= made.at(0, k, 0) <= made.high for k in range(50))


def test_draws_have_the_distribution_that_is_asked_for() -> None:
    """Kolmogorov and Smirnov: of n draws a share is off by more than 1.95 / sqrt(n) once in a thousand times."""
    cases = {
        "crate.mass=normal:2:0.25": stats.norm(2.0, 0.25),
        "crate.mass=log:0.5:8": stats.loguniform(0.5, 8.0),
        "crate.mass=log:0.5:8x": stats.loguniform(0.5, 8.0),
        "crate.mass=0.5:8": stats.uniform(0.5, 7.5),
        "crate.pose=normal:0.1": stats.norm(0.0, 0.1),
    }
    for text, theory in cases.items():
        for index, made in enumerate(parse(text)):
            values = [made.at(3, k, index) for k in range(2000)]
            assert stats.kstest(values, theory.cdf).statistic < 1.95 / np.sqrt(2000), text


@given(
    text=st.text(max_size=30)
    | st.from_regex(r"[a-z]{1,3}\.(mass|friction|level|pose)=(log:|normal:)?[-0-9a-z.:,]{0,12}")
)
def test_whatever_is_written_is_read_or_refused_in_a_line(text: str) -> None:
    try:
        for made in parse(text):
            assert np.isfinite([made.low, made.high]).all() and made.low < made.high
    except UserError as error:
        assert str(error).startswith(f"--randomise {text}: ")


def test_a_pose_is_a_reach_and_an_angle() -> None:
    assert [(d.name, d.low, d.high) for d in parse("crate.pose=0.05,5deg")] == [
        ("crate.pose.x", -0.05, 0.05),
        ("crate.pose.y", -0.05, 0.05),
        ("crate.pose.turn", -5.0, 5.0),
    ]
    assert [d.name for d in parse("crate.pose=0,5deg")] == ["crate.pose.turn"]
    assert [d.name for d in parse("crate.pose=0.1")] == ["crate.pose.x", "crate.pose.y"]
    assert [(d.name, d.low, d.spread) for d in parse("crate.pose=normal:0.05,5deg")] == [
        ("crate.pose.x", -0.2, "normal"),
        ("crate.pose.y", -0.2, "normal"),
        ("crate.pose.turn", -20.0, "normal"),
    ]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("crate.mass=2:1", "low 2 is not below high 1"),
        ("crate.mass=nan:1", "expected BODY.mass=2:3"),
        ("crate.mass=0:1", "low 0 must be above 0, as every mass is"),
        ("crate.mass=-2:1", "low -2 must be above 0, as every mass is"),
        ("floor.friction=-0.1:1", "low -0.1 is below 0, and no friction is"),
        ("floor.friction=0.1:11", "high 11 is above 10"),
        ("crate.colour=0:1", "expected BODY.mass=2:3"),
        ("crate=0:1", "expected BODY.mass=2:3"),
        ("crate.mass=normal:1:0.3", "low -0.2, 4 deviations from the mean, must be above 0, as every mass is"),
        ("crate.friction=normal:9:0.3", "high 10.2, 4 deviations from the mean, is above 10"),
        ("crate.friction=log:0:0.5", "low 0 has no logarithm; it must be above 0"),
        ("crate.mass=log:-1:2", "low -1 must be above 0"),
        ("crate.mass=normal:1:0", "expected BODY.mass=2:3"),
        ("crate.mass=normal:1:-0.1", "expected BODY.mass=2:3"),
        ("crate.mass=normal:1", "expected BODY.mass=2:3"),
        ("crate.mass=normal(1,0.1)", "expected BODY.mass=2:3"),
        ("crate.mass=log:normal:1:2", "expected BODY.mass=2:3"),
        ("crate.mass=NORMAL:1:0.1", "expected BODY.mass=2:3"),
        ("crate.pose=log:0.1", "expected BODY.mass=2:3"),
        ("crate.pose=0.1,5", "expected BODY.mass=2:3"),
        ("crate.pose=0", "expected BODY.mass=2:3"),
        ("crate.pose=-0.1", "expected BODY.mass=2:3"),
    ],
)
def test_what_is_no_range_is_said_in_a_line(text: str, said: str) -> None:
    with pytest.raises(UserError) as told:
        parse(text)
    assert str(told.value).startswith(f"--randomise {text}: ")
    assert said in str(told.value)


def test_a_number_is_drawn_once() -> None:
    with pytest.raises(UserError, match=r"crate\.mass is given twice"):
        parse_all(["crate.mass=1:2", "crate.mass=0.8:1.2x"])


def test_draws_hang_on_seed_and_number_alone() -> None:
    spec = Spec(axes=[Axis(name="friction", low=0.1, high=0.9)], draws=parse("crate.pose=0.05"), samples=8, repeats=2)
    candidates = spec.candidates()
    assert [c.draws for c in candidates[:2]] == [{}, {}]  # as it stands
    assert spec.of([candidates[6].params], 6)[0] == candidates[6]  # as a search asks
    assert spec.candidates() == candidates
    drawn = {tuple(c.draws.values()) for c in candidates[2:]}
    assert len(drawn) == 16 == len(candidates) - 2  # also of one point's repeats
    assert not drawn & {tuple(c.draws.values()) for c in spec.model_copy(update={"seed": 1}).candidates()}
    alone = Spec(draws=[MU], samples=5, method="grid")
    assert (alone.count, len(alone.candidates())) == (6, 6)


@pytest.fixture(scope="module")
def swept(tmp_path_factory: pytest.TempPathFactory) -> SweepFolder:
    base = tmp_path_factory.mktemp("drawn")
    (base / "slide.py").write_text(PROGRAM)
    spec = Spec(draws=[MU, *parse("crate.mass=0.8:1.2x")], samples=4, worlds=8)
    folder = SweepFolder.create(base / "runs", "slide", spec, [base / "slide.py"])
    sweep(folder, workers=1)
    return folder


def test_each_candidate_run_again_stops_where_its_drawn_friction_has_it(swept: SweepFolder) -> None:
    """v^2 / (2 mu g): what is run again in full has the draws that the table says."""
    outcomes = swept.outcomes()
    assert [o.together for o in outcomes.values()] == [5] * 5
    for number in (0, 1, 3):
        run, _ = run_again(swept, outcomes[number], pictures=False)
        facts = run.facts()
        assert facts["same"] is True
        assert facts.get("draws", {}) == outcomes[number].candidate.draws
        x = recording.read(run.iteration(1) / "recording.rrd").position("/World/crate")[:, 0]
        mu = outcomes[number].candidate.draws.get("crate.friction", 0.5)
        assert x[-1] - x[0] == pytest.approx(SPEED**2 / (2.0 * mu * G), rel=0.01)


def test_draws_stand_in_table_picture_and_page(swept: SweepFolder) -> None:
    outcomes = swept.outcomes()
    table = pyarrow.parquet.read_table(swept.path / "table.parquet")
    by_number = dict(zip(table["candidate"].to_pylist(), table["crate.friction"].to_pylist(), strict=True))
    assert by_number == {k: o.candidate.draws.get("crate.friction") for k, o in outcomes.items()}
    assert "crate.mass x" in table.column_names
    assert draw_picture(list(outcomes.values()), swept.path)
    page = write_page(swept).read_text()
    assert "crate.mass x" in page and "0.2 … 0.6, drawn for each" in page


def test_a_draw_that_a_candidates_world_lacks_fails_that_one(tmp_path: Path) -> None:
    (tmp_path / "slide.py").write_text(PROGRAM)
    spec = Spec(points=[{"bare": 1.0}, {"bare": 0.0}], draws=parse("post.friction=0.1:0.2"))
    folder = SweepFolder.create(tmp_path / "runs", "slide", spec, [tmp_path / "slide.py"])
    sweep(folder, workers=1)
    found: dict[int, Outcome] = folder.outcomes()
    assert [found[k].status for k in range(3)] == ["accepted", "failed", "accepted"]
    assert found[1].reason.startswith("post.friction: the world has no 'post'")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("creat.mass=1:2", "--randomise creat.mass: the world has no 'creat'; did you mean \"crate\"?"),
        ("post.mass=1:2", "--randomise post.mass: post never moves, and has no mass"),
        ("crate.level=1:2", "--randomise crate.level: crate names no fluids"),
        ("crate.friction=1:40x", "--randomise crate.friction = 20 is above 10"),
    ],
)
def test_what_the_world_lacks_is_said_before_anything_is_run(tmp_path: Path, text: str, said: str) -> None:
    (tmp_path / "slide.py").write_text(PROGRAM)
    asked = ["sweep", str(tmp_path / "slide.py"), "--runs", str(tmp_path / "runs"), "--randomise", text]
    ended = CliRunner().invoke(app, asked)
    assert isinstance(ended.exception, UserError)
    assert said in str(ended.exception)
    assert not (tmp_path / "runs").exists()
