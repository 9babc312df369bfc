"""What is asked of a recording, held against closed forms; and the verdict."""

from __future__ import annotations

import math
import re

import pytest

from tests.crashing import CRASH
from tests.tools.conftest import done, refused
from wsim.judge.verdict import Verdict
from wsim.tools import Workspace

G = 9.81
BALL = 1000.0 * 4.0 / 3.0 * math.pi * 0.1**3  # [kg]


def ask(workspace: Workspace, signal: str, prim: str = "", **more: object) -> list[list[str]]:
    """The cells of an answer's table, below its two heads."""
    text = done(workspace, "query_recording", signal=signal, prim=prim, **more)
    for number in re.findall(r"-?\d+\.\d+(?:e-?\d+)?", text):
        assert len(number.split("e")[0].replace("-", "").replace(".", "").strip("0")) <= 4, text
    return [line.split() for line in text.splitlines()[2:]]


def value(workspace: Workspace, signal: str, prim: str = "", **more: object) -> float:
    """The last cell of an answer's first row."""
    return float(ask(workspace, signal, prim, **more)[0][-1])


def test_a_falling_ball(rigid: Workspace) -> None:
    x, y, z = map(float, ask(rigid, "position", "ball", reduction="last")[0][1:])
    assert (x, y) == (1.5, 0.0)
    assert z == pytest.approx(9.0 - G / 2, abs=0.01)
    speed = math.hypot(0.5, G)
    assert value(rigid, "speed", "ball", reduction="last") == pytest.approx(speed, rel=1e-3)
    energy = BALL * speed**2 / 2
    assert value(rigid, "kinetic energy", "ball", reduction="last") == pytest.approx(energy, rel=2e-3)
    assert value(rigid, "velocity.z", "/World/ball", reduction="at", value=0.5) == pytest.approx(-G / 2, rel=1e-3)
    assert value(rigid, "velocity.z", "ball", reduction="mean") == pytest.approx(-G / 2, rel=2e-3)
    assert value(rigid, "gap", "ball", other="block", reduction="first") == pytest.approx(
        math.hypot(0.9, 8.8) - 0.1, 0.01
    )


def test_reductions(rigid: Workspace) -> None:
    rows = ask(rigid, "position", "ball")
    assert len(rows) == 12
    assert (rows[0][0], rows[-1][0]) == ("0", "1")
    assert ask(rigid, "position", "ball", reduction="max")[2] == ["z", "9", "0"]
    assert ask(rigid, "position.z", "ball", reduction="min", start=0.2, end=0.4)[0][1] == "0.4"
    assert len(ask(rigid, "speed", "ball", start=0.2, end=0.4)) == 5
    crossed = done(rigid, "query_recording", signal="position.z", prim="ball", reduction="first_time_below", value=5.0)
    assert "below 5 first at 0.95 s" in crossed  # sqrt(2 * 4 / g) = 0.903, and 20 frames a second
    never = done(rigid, "query_recording", signal="position.z", prim="ball", reduction="first_time_above", value=9.5)
    lowest = value(rigid, "position.z", "ball", reduction="last")
    assert never.splitlines()[1] == f"never above 9.5; it lies between {lowest:g} and 9"


def test_a_block_at_rest_and_an_arm_that_swings(rigid: Workspace) -> None:
    weight = 600.0 * 0.008 * G
    assert value(rigid, "contact_force.z", "block", reduction="last") == pytest.approx(weight, rel=0.01)
    assert ask(rigid, "rotation", "block", reduction="last")[0][1:] == ["0", "0", "0"]
    assert value(rigid, "highest_point", "block", reduction="last") == pytest.approx(0.2, abs=0.002)
    swing = [abs(float(row[1])) for row in ask(rigid, "angle", "hinge")]
    assert swing[0] == 0.0
    assert max(swing) == pytest.approx(180.0, abs=8.0)  # let go level, it comes up level on the other side
    assert float(ask(rigid, "apart", "hinge", reduction="max")[0][0]) < 1e-3
    assert "has no slide" in refused(rigid, "query_recording", signal="slide", prim="hinge")


def test_water_in_a_tank(tank: Workspace) -> None:
    floor, level = 0.02, 0.2
    assert value(tank, "level", "water", reduction="first") == pytest.approx(floor + level, abs=1e-3)
    assert value(tank, "center.z", "water", reduction="first") == pytest.approx(floor + level / 2, abs=1e-3)
    assert value(tank, "outside", "water", reduction="last") == 0.0
    assert value(tank, "fastest", "water", reduction="first") == 0.0
    assert 0.05 < float(ask(tank, "fastest", "water", reduction="max")[0][0]) < 2.0
    assert 0.0 < value(tank, "density_error", "water", reduction="mean") < 0.02
    rise = value(tank, "draft", "block", reduction="last") - value(tank, "draft", "block", reduction="first")
    fall = value(tank, "position.z", "block", reduction="first") - value(tank, "position.z", "block", reduction="last")
    assert rise == pytest.approx(fall, abs=1e-3)
    assert fall > 0.03


def test_what_can_be_asked_is_listed(rigid: Workspace, tank: Workspace) -> None:
    text = done(rigid, "query_recording")
    assert text.startswith("0 to 1 s, 21 frames")
    for word in ("ball, block, arm", "position [m]", "hinge", "angle [deg]", "energy/kinetic"):
        assert word in text
    assert "draft" not in text
    assert "draft" in done(tank, "query_recording")
    for name in re.findall(r"(?:^|[ ,])((?:energy|contact|fluid|work)/\w+)", done(tank, "query_recording")):
        ask(tank, name, reduction="last")


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ({"signal": "speed"}, "is of an object; name one of ball, block, arm, hinge"),
        ({"signal": "speed", "prim": "bal"}, "called 'bal'; there are ball, block, arm, hinge"),
        ({"signal": "sped", "prim": "ball"}, "ball has no 'sped'; it has position"),
        ({"signal": "position.w", "prim": "ball"}, "the components x, y, z, not 'w'"),
        ({"signal": "speed.x", "prim": "ball"}, "no components"),
        ({"signal": "gap", "prim": "ball"}, "one of block, arm, ground"),
        ({"signal": "draft", "prim": "ball"}, "no fluid here"),
        ({"signal": "speed", "prim": "ball", "start": 5.0}, "no frame lies between"),
        ({"signal": "speed", "prim": "ball", "reduction": "at"}, "needs one: the time"),
        ({"signal": "position", "prim": "ball", "reduction": "first_time_above", "value": 1.0}, "ask for position.z"),
        ({"signal": "speed", "prim": "ball", "reduction": "middle"}, "reduction: Input should be"),
        ({"signals": "speed"}, "signals: Extra inputs are not permitted; it takes iteration, signal"),
    ],
)
def test_what_cannot_be_asked(rigid: Workspace, asked: dict, said: str) -> None:
    text = refused(rigid, "query_recording", **asked)
    assert said in text
    assert len(text.splitlines()) == 1


def test_a_verdict_tells_what_failed_first_and_what_to_change(empty: Workspace) -> None:
    program = (
        "def build(scene):\n"
        "    scene.simulation(duration=0.2)\n"
        "    scene.ground()\n"
        "    scene.box('block', size=(0.2, 0.2, 0.2), density=500.0, position=(0.0, 0.0, 0.04))\n"
    )
    done(empty, "write_program", text=program)
    ran = done(empty, "run_program", passes="physics")
    lines = done(empty, "read_verdict").splitlines()
    assert ran.splitlines()[1:] == lines
    assert lines[0].startswith("rejected: ")
    assert lines[1].startswith("try first: ")
    assert lines[2].split() == ["check", "prim", "value", "limit", "unit", "at", "[s]", "line"]
    (row,) = (line.split() for line in lines if line.split()[:2] == ["CheckPenetration", "block"])
    assert row[2:5] == ["0.06", "0.04", "m"]
    assert row[-1] == "program.py:4"
    assert any(line.startswith("  -> change position") and "0.06 m" in line for line in lines)
    assert lines[-1].startswith("passed: CheckFinite")
    assert len(lines) == len(set(lines))
    assert "margin" in done(empty, "read_verdict", passed=True)


def test_a_verdict_tells_what_crashed(empty: Workspace) -> None:
    done(empty, "write_program", text="def build(scene):\n    scene.ground()\n")
    verdict = Verdict(status="blocked", summary="", crashes=[CRASH])
    (empty.run.iterations()[-1] / "verdict.json").write_text(verdict.model_dump_json())
    assert done(empty, "read_verdict").splitlines() == [
        "blocked: 0 of 0 findings fail", f"{CRASH.message}; this is a fault of wsim's, not of the world",
    ]  # fmt: skip


def test_what_was_not_run_has_no_verdict_and_says_who_has(empty: Workspace) -> None:
    done(empty, "write_program", text="def build(scene):\n    scene.ground()\n")
    assert "run_program" in refused(empty, "read_verdict")
    assert "run_program" in refused(empty, "query_recording", signal="speed", prim="ball")
