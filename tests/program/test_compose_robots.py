"""Robots of a plan, and the policies that walk them, as a program places them."""

from __future__ import annotations

import ast

import pytest

from wsim.errors import UserError
from wsim.plan.schema import Actuation, FromRobot, Material, Plan, PlanObject, Pose, Registration
from wsim.program.compose import compose
from wsim.scene import Scene


def placed(id: str = "desk_arm", **more) -> PlanObject:
    return PlanObject(
        name="worker", role="robot", construction=FromRobot(robot=id, size=(0.3, 0.3, 0.5)),
        pose=Pose(position=(1.0, 2.0, 0.0), rotation_deg=(0.0, 0.0, 90.0)), **more,
    )  # fmt: skip


def test_a_robot_is_placed_by_its_id(tmp_path) -> None:
    text = compose(Plan(title="A robot", prompt="", objects=[placed()]))
    assert 'scene.robot("worker", "desk_arm", position=(1.0, 2.0, 0.0), yaw_deg=90.0)' in text
    space: dict = {}
    exec(compile(text, "program.py", "exec"), space)  # what it is, is known here
    scene = Scene()
    space["build"](scene)
    assert scene.stage.GetPrimAtPath("/World/worker/joints")


def test_a_policy_walks_it_along_its_route() -> None:
    walk = Actuation(kind="policy", policy="go2_walk", route=((1.0, 0.0), (0.0, 0.0, 90.0)), speed=0.5)
    item = placed("go2", registration=Registration(actuation=[walk]))
    text = compose(Plan(title="A robot", prompt="", objects=[item]))
    assert ast.parse(text)
    assert 'worker = scene.robot("worker", "go2", position=(1.0, 2.0, 0.0), yaw_deg=90.0)' in text
    assert "    worker_route = (\n        (1.0, 0.0),\n        (0.0, 0.0, 90.0),\n    )\n" in text
    assert 'scene.policy("worker_walk", worker, "go2_walk", route=worker_route, speed=0.5)' in text
    again = Plan.model_validate_json(Plan(title="", prompt="", objects=[item]).model_dump_json())
    assert again.objects[0].registration.actuation == [walk]


def test_what_a_robot_has_of_its_own_is_refused_with_a_way_out() -> None:
    with pytest.raises(UserError, match="worker: a robot stands at rest with its own material; remove it"):
        compose(Plan(title="", prompt="", objects=[placed(material=Material(name="tin", density=900.0))]))
    with pytest.raises(ValueError, match='policy, route and speed are of the kind "policy"'):
        Actuation(kind="path", route=((0.0, 0.0),))
    with pytest.raises(ValueError, match="primitive of a vehicle is"):
        placed().model_copy(update={"role": "vehicle"}).model_validate(placed().model_dump() | {"role": "vehicle"})
