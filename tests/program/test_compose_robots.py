"""Robots of a plan, and the policies that walk them, as a program places them."""

from __future__ import annotations

import ast

import pytest

from wsim.errors import UserError
from wsim.plan.schema import Actuation, FromRobot, Material, Plan, PlanObject, Pose, Proxy, Registration
from wsim.program.compose import compose
from wsim.scene import Scene
from wsim.scene.describe import describe
from wsim.scene.errors import SceneError


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


def test_what_its_id_says_stays_a_string() -> None:
    text = compose(Plan(title="A robot", prompt="", objects=[placed('a", position=open("b"), c="')]))
    (call,) = (node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Call)
               and getattr(node.func, "attr", "") == "robot")  # fmt: skip
    assert [argument.value for argument in call.args] == ["worker", 'a", position=open("b"), c="']


def test_what_a_robot_has_of_its_own_is_refused_with_a_way_out() -> None:
    with pytest.raises(UserError, match="worker: a robot stands at rest with its own material; remove it"):
        compose(Plan(title="", prompt="", objects=[placed(material=Material(name="tin", density=900.0))]))
    with pytest.raises(UserError, match="worker: a robot stands at rest with its own angular_velocity_deg; remove it"):
        compose(Plan(title="", prompt="", objects=[placed(angular_velocity_deg=(0.0, 0.0, 9.0))]))
    with pytest.raises(ValueError, match='policy, route and speed are of the kind "policy"'):
        Actuation(kind="path", route=((0.0, 0.0),))
    with pytest.raises(ValueError, match="route and speed are walked by a policy; name it"):
        Actuation(kind="policy", route=((0.0, 0.0),))
    with pytest.raises(ValueError, match=r"speed 0\.8 m/s is along a route; give one"):
        Actuation(kind="policy", policy="go2_walk", speed=0.8)
    walk = Actuation(kind="policy", policy="go2_walk")
    with pytest.raises(ValueError, match="worker: it has the policies go2_walk, go2_walk; one walks it"):
        placed("go2", registration=Registration(actuation=[walk, walk]))
    with pytest.raises(ValueError, match="door: policy 'go2_walk' walks a robot"):
        PlanObject(
            name="door", role="rigid_body", construction=Proxy(primitive="box", size=(1.0, 1.0, 1.0)),
            material=Material(name="tin", density=900.0), registration=Registration(actuation=[walk]),
        )  # fmt: skip
    with pytest.raises(ValueError, match="primitive of a vehicle is"):
        placed().model_copy(update={"role": "vehicle"}).model_validate(placed().model_dump() | {"role": "vehicle"})


REACHES = [
    {"kind": "reach", "link": "hand", "point": [0.0, 0.0, 0.07], "path": [[1.0, 2.3, 0.2]], "times": [1.0],
     "rotation_deg": [180.0, 0.0, 0.0]},
    {"kind": "follow", "link": "hand", "path": [[1.0, 2.3, 0.1], [1.1, 2.3, 0.1]], "times": [1.5, 2.0]},
    {"kind": "schedule", "joint": "left_finger", "target": [0.03, 0.01], "times": [0.0, 2.0]},
]  # fmt: skip


def test_it_goes_by_time(tmp_path) -> None:
    item = placed(registration=Registration.model_validate({"actuation": REACHES}))
    plan = Plan(title="A robot", prompt="", objects=[item])
    assert Plan.model_validate_json(plan.model_dump_json()).objects[0].registration.actuation[0].times == (1.0,)
    space: dict = {}
    exec(compile(compose(plan), "program.py", "exec"), space)
    scene = Scene()
    space["build"](scene)
    world = describe(scene.stage)
    reach, follow = world.reaches
    assert (reach.link, reach.positions, reach.times) == ("/World/worker/hand", [(1.0, 2.3, 0.2)], [1.0])
    assert (reach.straight, follow.straight, follow.start, len(follow.positions)) == (False, True, 1.0, 2)
    assert reach.rotations[0] == pytest.approx((1.0, 0.0, 0.0, 0.0))
    (schedule,) = world.joint_paths
    assert schedule.prim == "/World/worker/joints/left_finger"
    assert schedule.positions == [0.03, 0.01]


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        (REACHES[0] | {"path": [[1.0, 2.3, 0.2]] * 2, "times": [1.0, 2.0]}, 'a "reach" goes to one place'),
        (REACHES[1] | {"times": [2.0, 1.5]}, "path has 2 entries and times 2; give one for each, rising"),
        (REACHES[1] | {"link": None}, 'a "follow" is of a "link"'),
        (REACHES[2] | {"joint": None}, 'a "schedule" is of a "joint"'),
        (REACHES[2] | {"link": "hand"}, 'link is of the kinds "reach" and "follow"'),
        ({"kind": "position", "times": [1.0]}, "times are of the kinds"),
    ],
)
def test_what_goes_by_time_is_said_whole(changed: dict, said: str) -> None:
    with pytest.raises(ValueError, match=said):
        Actuation.model_validate(changed)


def test_robots_alone_reach() -> None:
    with pytest.raises(ValueError, match="door: a reach is of a robot"):
        PlanObject(
            name="door", role="rigid_body", construction=Proxy(primitive="box", size=(1.0, 1.0, 1.0)),
            material=Material(name="tin", density=900.0),
            registration=Registration.model_validate({"actuation": REACHES[:1]}),
        )  # fmt: skip


GOES = {"kind": "reach", "link": "hand", "path": [[0.3, 0.0, 0.2]]}
GRIPS = {"kind": "schedule", "joint": "left_finger", "target": [0.03, 0.0]}


@pytest.mark.parametrize(
    ("actuations", "why"),
    [
        ([{**GOES, "times": [2.0]}, {**GOES, "times": [1.0]}], "1 s must be after 2 s, when it sets out"),
        ([{**GOES, "times": [2.0]}, {**GOES, "times": [3.0], "start": 1.0}], "start: 1 s is before 2 s"),
        ([{**GOES, "times": [0.0]}], "0 s must be after 0 s"),
        ([{**GOES, "times": [1.0], "start": 2.0}], "1 s must be after 2 s"),
        ([{**GRIPS, "times": [1.0, 2.0]}] * 2, "left_finger has a schedule already"),
        ([{**GOES, "times": [6.0]}], "6 s is after the end, at 5 s"),
        ([{**GOES, "times": [1.0]}, {"kind": "policy", "policy": "go2_walk"}], "a policy walks worker"),
    ],
)
def test_what_a_robot_cannot_do_by_time_is_refused_in_the_plan(actuations: list, why: str) -> None:
    own = Registration.model_validate({"actuation": actuations})
    plan = {"title": "", "prompt": "", "objects": [placed(registration=own)], "simulation": {"duration": 5.0}}
    with pytest.raises(ValueError, match=why):
        Plan.model_validate(plan)


def test_a_joint_has_one_schedule() -> None:
    arm = Scene().robot("arm", "desk_arm")
    arm.drive("left_finger", times=[0.0, 1.0], positions=[0.03, 0.0])
    with pytest.raises(SceneError, match="left_finger has a schedule already"):
        arm.drive("left_finger", times=[2.0, 3.0], positions=[0.0, 0.03])
    with pytest.raises(SceneError, match="left_finger has a schedule, which says where it goes"):
        arm.drive("left_finger", position=0.02)
    arm.drive("left_finger", stiffness=500.0)
