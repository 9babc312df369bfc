"""What the page shows of a failed finding: the judged signal with its limit, where the prim is, what to change."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from wsim.judge import judge
from wsim.judge.evidence.evidence import Evidence
from wsim.judge.verdict import Finding, RepairTarget
from wsim.recording import read
from wsim.report.chart import Limit
from wsim.report.fixes import command, describe, make_fixes
from wsim.report.locate import camera_then, ring_of, where_is
from wsim.report.moments import moment_chart
from wsim.report.signals import find_signal
from wsim.report.source import statement
from wsim.report.text import measures, said
from wsim.scene.world import Camera, Parameter, World

BLOCK, BALL, WATER = "/World/block", "/World/ball", "/World/water"


@pytest.fixture(scope="module")
def recording(recorded: Path):
    return read(recorded / "recording.rrd")


@pytest.fixture(scope="module")
def evidence(recording):
    return Evidence(recording)


def failed(check: str, prim: str | None, **numbers) -> Finding:
    return Finding(check=check, passed=False, message="", prim=prim, **numbers)


def test_every_number_of_a_verdict_is_found_in_the_signal_that_was_judged(recording) -> None:
    """The checks that hold for any world, on a recording in which the ball is thrown about in the end."""
    q, qd = np.array(recording.body_q), np.array(recording.body_qd)
    q[70, 1, 0] = 3.0
    qd[60:, 0, 2] = 9.0
    density = dict(recording.fluids)
    track = density[WATER]
    density[WATER] = replace(track, density=track.density * 1.1)
    broken = replace(recording, body_q=q, body_qd=qd, fluids=density)
    evidence = Evidence(broken)
    expected = {
        "CheckExplosion": {"Speed", "Speed between frames", "Speed of the fastest particle"},
        "CheckDensity": {"Mean density error", "Density error that 99 % keep to"},
    }
    seen = set()
    for finding in judge(broken).failures:
        if finding.check in expected:
            signal = find_signal(evidence, finding)
            assert signal is not None and signal.how and signal.title in expected[finding.check], finding
            assert np.isclose(signal.value, finding.value, rtol=1e-5).any()
            seen.add(finding.check)
    assert seen == set(expected)


def test_a_mean_and_an_rms_are_told_from_a_frame(evidence) -> None:
    low, _ = evidence.ends(0)
    depth = evidence.level(evidence.world.fluids[0]).height - low
    mean = float(depth[evidence.window].mean())
    signal = find_signal(evidence, failed("ObjectiveFloats", BLOCK, value=mean, unit="m", time=1.0))
    assert signal.title == "Depth of the lowest point below the surface" and signal.downwards
    assert "the mean" in signal.how and signal.over == (evidence.window_start, evidence.time[-1])
    frame = find_signal(evidence, failed("CheckOfTomorrow", BLOCK, value=float(low[20]), unit="m", time=1.0))
    assert frame.title == "Height of the lowest point" and frame.over == (evidence.time[20], evidence.time[20])


def test_scalars_of_the_recording_are_signals_too(evidence) -> None:
    deepest = float(np.max(evidence.recording.scalars["contact/penetration"]))
    signal = find_signal(evidence, failed("CheckPenetration", None, value=deepest, unit="m"))
    assert signal.title == "contact: penetration" and signal.how


def test_the_energy_of_a_body_is_that_of_its_height_and_speed(evidence) -> None:
    """The ball's height is 0.58 m - 1.2 m/s^2 t^2 in this recording, and its recorded velocity 0: it loses m g dz."""
    signal = find_signal(evidence, failed("CheckOfTomorrow", BALL, value=-1e3, unit="J"))
    fallen = evidence.body_q[:, 1, 2] - evidence.body_q[0, 1, 2]
    assert signal.value == pytest.approx(7.1 * 9.81 * fallen, abs=1e-4)


def test_a_finding_that_lasts_says_from_when_to_when(evidence) -> None:
    finding = failed("CheckOfTomorrow", BALL, value=123.0, unit="m", time=1.0, span=(1.0, 1.5))
    assert dict(measures(finding))["lasts"] == "1 … 1.5\u00a0s"
    chart = moment_chart(evidence, finding, 1)
    assert chart.over == (1.0, 1.5) and 'class="over"' in str(chart.svg)
    assert chart.series[0].time[-1] == pytest.approx(2.0, abs=0.04)
    assert "lasts" not in dict(measures(finding.model_copy(update={"span": (1.0, 1.0)})))


def test_a_number_of_no_signal_gets_a_picture_of_what_went_on_and_no_limit(evidence) -> None:
    chart = moment_chart(evidence, failed("CheckOfTomorrow", BLOCK, value=123.0, limit=1.0, unit="m", time=1.0), 4)
    assert chart is not None and chart.limits == [] and "not one of this line" in chart.note
    assert [(mark.label, mark.time) for mark in chart.marks] == [("#4", 1.0)]
    assert moment_chart(evidence, failed("CheckPlanObjects", "/World/nobody"), 1) is None


def test_the_plot_is_about_the_moment_and_draws_its_limit(evidence) -> None:
    time, low = float(evidence.time[18]), float(evidence.ends(1)[0][18])  # in the middle of its fall
    finding = failed("CheckOfTomorrow", BALL, time=time, value=low, limit=0.01, margin=0.01 - low, unit="m")
    chart = moment_chart(evidence, finding, 2)
    assert chart is not None
    assert chart.limits == [Limit(0.01, "at most")] and chart.limits[0].forbids == 1.0
    drawn = chart.series[0].time
    assert (drawn[0], drawn[-1]) == pytest.approx((time - 0.5, time + 0.5), abs=0.04)
    assert chart.marks[0].measured == (time, low)
    svg = str(chart.svg)
    for part in ('class="forbidden"', 'class="limit"', "at most 0.01", 'class="moment"', 'class="measured"'):
        assert part in svg, part


def test_the_forbidden_side_is_above_or_below_its_limit(evidence) -> None:
    def shaded(at_most: bool) -> tuple[float, float]:
        value = float(evidence.ends(1)[0][10])
        limit = 0.2
        numbers = {"value": value, "limit": limit, "margin": limit - value if at_most else value - limit, "unit": "m"}
        chart = moment_chart(evidence, failed("CheckOfTomorrow", BALL, time=float(evidence.time[10]), **numbers), 1)
        svg = str(chart.svg)
        box = svg.split('class="forbidden"')[1]
        line = svg.split('class="limit"')[1]
        return float(box.split('y="')[1].split('"')[0]), float(line.split('y1="')[1].split('"')[0])

    top, line = shaded(at_most=True)
    assert top < line
    top, line = shaded(at_most=False)
    assert top == pytest.approx(line)


def test_a_prim_is_ringed_where_the_camera_sees_it(recording) -> None:
    """A pinhole at (0, -2, 0) that looks along +Y with 90 degrees across: x / depth of 1 is half the picture."""
    camera = Camera(prim="/World/c", eye=(0.0, -2.0, 0.0), target=(0.0, 0.0, 0.0), fov=90.0, width=400, height=200)
    x, y, radius = ring_of(camera, (1.0, 0.0, 0.5), 0.2)
    assert (x, y) == pytest.approx((0.75, 0.125)) and radius == pytest.approx(1.15 * 0.05)
    assert ring_of(camera, (0.0, -3.0, 0.0), 0.2) is None  # behind it
    assert ring_of(camera, (3.0, 0.0, 0.0), 0.2) is None  # beside the picture
    center, reach = where_is(recording, BALL, 0.0)
    assert center == pytest.approx((0.25, 0.0, 0.58)) and reach == pytest.approx(0.06)
    assert where_is(recording, WATER, 0.0) is None


def test_a_prim_is_ringed_by_a_camera_that_follows_it(recording) -> None:
    """It stands as far from its body at any time as at the start."""
    camera = Camera(prim="/World/c", eye=(0.25, -2.0, 0.58), target=(0.25, 0.0, 0.58), fov=90.0, follows=BALL)
    last = float(recording.time[-1])
    (before, _), (after, _) = (where_is(recording, BALL, time) for time in (0.0, last))
    assert math.dist(before, after) > 0.05
    seen = ring_of(camera_then(recording, camera, last), after, 0.2)
    assert seen == pytest.approx(ring_of(camera_then(recording, camera, 0.0), before, 0.2))
    assert seen != pytest.approx(ring_of(camera, after, 0.2))


def lower(prim: str, current: float = 2500.0) -> RepairTarget:
    return RepairTarget(
        kind="physical parameter", prim=prim, parameter="density", direction="lower", current=current, suggested=600.0,
        unit="kg/m^3", why="what floats is light",
    )  # fmt: skip


def test_findings_that_ask_for_the_same_change_are_one_fix() -> None:
    world = World(parameters=[Parameter(name="wood_density", value=2500.0, default=600.0, unit="kg/m^3")])
    blocks = [(k, failed("c", f"/World/b{k}", target=lower(f"/World/b{k}"))) for k in (3, 5)]
    step = RepairTarget(kind="time step", parameter="time_step", direction="lower", suggested=5e-4, unit="s")
    fixes = make_fixes([*blocks, (1, failed("c", None, target=step)), (2, failed("c", None))], world, Path("runs/a b"))
    assert [fix.findings for fix in fixes] == [[3, 5], [1]]
    assert fixes[0].what == "Lower the density of b3 and b5 from 2500 to 600 kg/m³"
    assert fixes[0].command == "wsim run 'runs/a b' --set wood_density=600"
    assert fixes[1].what == "Lower the time step to 0.0005 s" and fixes[1].command.endswith("--time-step 0.0005")


def test_a_change_that_no_single_parameter_makes_has_no_command() -> None:
    two = [Parameter(name=name, value=2500.0, default=600.0, unit="kg/m^3") for name in ("wood", "cork")]
    assert command(lower("/World/b"), World(parameters=two), Path("r")) == ""
    assert command(lower("/World/b", current=700.0), World(parameters=two[:1]), Path("r")) == ""
    assert command(lower("/World/b"), None, Path("r")) == ""


def test_changes_in_words() -> None:
    assert describe([RepairTarget(kind="missing object", prim="/World/ball", direction="add")]) == "Add ball"
    assert describe([RepairTarget(kind="program", direction="change")]) == "Change the program"
    assert describe([RepairTarget(kind="controller")]) == "Look at the controller"
    many = [lower(f"/World/B{k}") for k in range(6)]
    assert describe(many) == "Lower the density of B0, B1, B2 and 3 more from 2500 to 600 kg/m³"
    now = RepairTarget(kind="drive", prim="/World/Arm", parameter="gain", direction="raise", current=2.0, unit="N m")
    assert describe([now]) == "Raise the gain of Arm, now 2 N m"


def test_the_whole_call_is_shown_and_not_the_function_around_it() -> None:
    program = 'def build(scene):\n    scene.box(\n        "b",\n        size=(1, 1, 1),\n    )\n    x = 1\n'
    call = 'scene.box(\n    "b",\n    size=(1, 1, 1),\n)'
    assert statement(program, 2) == call and statement(program, 3) == call
    assert statement(program, 6) == "x = 1"
    assert statement(program, 1) == "def build(scene):"
    assert statement("def f(:\n  y", 2) == "y"
    assert statement("f(\n" + "    1,\n" * 40 + ")\n", 1).endswith("…")


def test_shares_are_percent_and_prims_are_names() -> None:
    finding = failed("c", WATER, value=0.0113, limit=0.01, margin=-0.0013, unit="share of particles")
    assert dict(measures(finding))["measured"] == "1.13\u00a0%" and dict(measures(finding))["at most"] == "1\u00a0%"
    assert said("/World/water: 1000 kg/m^3") == "water: 1000 kg/m³"
