"""Suggestions, each applied to the program that the plan composes, with something in it made wrong."""

from __future__ import annotations

import ast
from typing import Any

import pytest

from tests.agents.flies import flies
from wsim.judge.verdict import RepairTarget
from wsim.program.compose import compose
from wsim.program.mend import NotMendedError, mended
from wsim.program.mend.unroll import unrolled
from wsim.scene import Scene
from wsim.scene.describe import describe
from wsim.scene.world import World

PLAN = flies()
RIGHT = compose(PLAN)
LOOP = """\
def build(scene):
    scene.ground()
    for k, (x, color) in enumerate(zip((0.0, 0.5, 1.0), ("red", "green", "blue"))):
        scene.box(f"block_{k}", size=(0.2, 0.2, 0.2), position=(x, 0.0, 0.1))  # one of three
    scene.simulation(duration=1.0)
"""


def target(**fields: Any) -> RepairTarget:
    return RepairTarget(**{"kind": "physical parameter", **fields})


def world(tmp_path, program: str) -> World:
    names: dict[str, Any] = {"__name__": "program"}
    exec(compile(program, "program.py", "exec"), names)
    scene = Scene()
    names["build"](scene)
    scene.save(tmp_path / "stage.usda")
    return describe(tmp_path / "stage.usda")


def test_a_duration_is_put_where_it_stands_and_nothing_else_changes() -> None:
    made = mended(RIGHT, target(parameter="duration", suggested=0.4, direction="raise"))
    assert made == RIGHT.replace("duration=0.2", "duration=0.4")


def test_a_place_a_velocity_and_a_density_reach_the_world(tmp_path) -> None:
    ball = "/World/ball"
    made = mended(RIGHT, target(prim=ball, parameter="position", vector=(0.0, 0.0, 3.0)))
    made = mended(made, target(prim=ball, parameter="velocity", suggested=3.0))
    made = mended(made, target(prim=ball, parameter="density", suggested=300.0))
    made = mended(made, target(prim=ball, parameter="position.x", suggested=-0.5))
    (before,), (after,) = world(tmp_path, RIGHT).bodies, world(tmp_path, made).bodies
    assert after.position == pytest.approx((-0.5, 0.0, 3.0))
    assert after.velocity == pytest.approx((3.0, 0.0, 0.0))
    assert after.mass == pytest.approx(before.mass / 2)


def test_one_of_a_loop_gets_a_call_of_its_own(tmp_path) -> None:
    made = mended(LOOP, target(prim="/World/block_1", parameter="position.z", suggested=0.4))
    heights = [body.position[2] for body in world(tmp_path, made).bodies]
    assert heights == pytest.approx([0.1, 0.4, 0.1])
    assert "for " not in made


def test_loops_over_what_is_not_written_out_stay() -> None:
    for over in ("range(int(n))", "zip(a, b)", "range(10**9)", "open('x')"):
        program = f"def build(scene):\n    for k in {over}:\n        scene.box(f'b{{k}}')\n"
        assert unrolled(program) == program


def test_what_the_program_lacks_comes_from_the_plan(tmp_path) -> None:
    statements = next(s for s in ast.parse(RIGHT).body if isinstance(s, ast.FunctionDef)).body
    ball = next(s for s in statements if "scene.sphere" in ast.unparse(s))
    lines = RIGHT.splitlines(keepends=True)
    without = "".join(lines[: ball.lineno - 1] + lines[ball.end_lineno :])
    assert world(tmp_path, without).bodies == []
    made = mended(without, target(kind="missing object", prim="/World/ball", direction="add"), PLAN)
    assert world(tmp_path, made).bodies == world(tmp_path, RIGHT).bodies
    with pytest.raises(NotMendedError, match="no plan"):
        mended(without, target(kind="missing object", prim="/World/ball", direction="add"))


def test_what_is_too_much_goes(tmp_path) -> None:
    more = RIGHT.replace("    scene.camera(", '    extra = scene.box("crate", size=(1, 1, 1))\n    scene.camera(', 1)
    more = more.replace("    scene.camera(", '    scene.fixed_joint("tie", extra)\n    scene.camera(', 1)
    assert mended(more, target(kind="extra object", prim="/World/crate", direction="remove")) == RIGHT
    still = mended(RIGHT, target(prim="/World/ball", parameter="velocity", direction="remove"))
    assert world(tmp_path, still).bodies[0].velocity == (0.0, 0.0, 0.0)


def test_another_shape_than_planned_becomes_the_planned_one(tmp_path) -> None:
    wrong = RIGHT.replace("scene.sphere(", "scene.box(").replace("radius=0.1", "size=(0.2, 0.2, 0.2)")
    assert wrong != RIGHT
    made = mended(
        wrong, target(kind="geometry", prim="/World/ball", parameter="shape", direction="change", text="sphere"), PLAN
    )
    assert world(tmp_path, made).bodies == world(tmp_path, RIGHT).bodies


@pytest.mark.parametrize(
    "wrong",
    [
        target(prim="/World/lamp", parameter="mass", suggested=1.0),
        target(prim="/World/ball", parameter="mass", direction="raise"),
        target(parameter="mass", suggested=1.0),
        target(prim="/World/ball", parameter="drive.stiffness", suggested=1.0),
        target(prim="/World/ball", parameter="spin", direction="remove"),
        target(kind="fluid", prim="/World/water", direction="add"),
    ],
)
def test_what_cannot_be_applied_is_said(wrong: RepairTarget) -> None:
    with pytest.raises(NotMendedError):
        mended(RIGHT, wrong, PLAN)
