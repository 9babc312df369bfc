"""A plan's world is closed: what its program adds that acts is found, and what is composed from the plan is not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.judge.theory import ask, box, record, times, with_world
from wsim.judge.checks.fluid import CheckPlanFluid
from wsim.judge.checks.plan import CheckPlanPlaces, CheckPlanSizes
from wsim.judge.checks.plan_closed import CheckPlanClosed
from wsim.judge.checks.plan_contacts import CheckPlanContacts
from wsim.judge.checks.plan_joints import CheckPlanJoints
from wsim.judge.checks.plan_motion import CheckPlanMotion
from wsim.judge.checks.run import CheckPlanObjects
from wsim.judge.decide import judge
from wsim.plan.schema import FromRobot, Plan, PlanObject, Proxy
from wsim.program.compose import compose
from wsim.recording.reader import read
from wsim.recording.recording import Recording
from wsim.rules.planner import plan as make_plan
from wsim.scene import Scene
from wsim.scene.describe import describe
from wsim.scene.world import Joint, World
from wsim.sim import Simulation

CHECKS = (
    CheckPlanClosed, CheckPlanSizes, CheckPlanPlaces, CheckPlanJoints, CheckPlanContacts, CheckPlanMotion,
    CheckPlanFluid,
)  # fmt: skip
SLIDE = "A wooden box slides down a ramp"
PENDULUM = "A pendulum swings"
TANK = "A cork ball floats in a tank of water"
BOTH = "A steel ball rolls into a wooden block"


def scene_of(plan: Plan, more: str = "", change: tuple[str, str] = ("", "")) -> Scene:
    """What a plan's program builds, with lines added at its end or one changed."""
    text = compose(plan)
    assert change[0] in text
    text = text.replace(*change) if change[0] else text
    space: dict[str, object] = {}
    exec(
        compile(text.replace("from wsim.scene import ", "from wsim.scene import Drive, Part, "), "p.py", "exec"), space
    )
    scene = Scene()
    space["build"](scene)
    exec(more, {**space, "scene": scene, "p": scene.stage.GetPrimAtPath})
    return scene


def still(world: World) -> Recording:
    """The world as it starts, for a thirtieth of a second."""
    q = np.array([[(*body.position, *body.rotation) for body in world.bodies]] * 2, dtype=np.float32).reshape(2, -1, 7)
    none = np.zeros((2, len(world.bodies), 6), dtype=np.float32)
    return Recording(Path("x.rrd"), world, {}, np.array([0.0, 1 / 30]), q, none, none[:, :, :3], {}, {}, [], {})


def wrong(plan: Plan, more: str = "", change: tuple[str, str] = ("", "")) -> list[tuple[str, str | None]]:
    """Check and prim of what is found."""
    recording = still(describe(scene_of(plan, more, change).stage))
    return [(f.check, f.prim) for check in CHECKS for f in ask(check(), recording, plan) if not f.passed]


@pytest.mark.parametrize(
    "prompt",
    [
        SLIDE, PENDULUM, TANK, BOTH, "Three wooden blocks float on the water", "A steel ball rolls down a ramp",
        "A row of dominoes topples", "A tower of three boxes stands on the ground",
    ],
)  # fmt: skip
def test_what_is_composed_is_the_plans(prompt: str) -> None:
    assert wrong(make_plan(prompt)) == []


BOX = "/World/wooden_box"


@pytest.mark.parametrize(
    ("more", "check", "prim"),
    [
        # A rail that holds the box, with a motor or without; a hinge, a weld.
        ('scene.joint_prismatic("rail", None, "wooden_box", axis="X")', "CheckPlanJoints", "/World/rail"),
        ('scene.joint_fixed("weld", "ramp", "wooden_box")', "CheckPlanJoints", "/World/weld"),
        # Springs and ropes.
        (
            'scene.spring("pull", "ramp", "wooden_box", stiffness=50.0, rest_length=0.1)',
            "CheckPlanClosed", "/World/pull",
        ),
        ('scene.rope("line", "ramp", "wooden_box", length=4.0)', "CheckPlanClosed", "/World/line"),
        # A belt, a pair of its own, a spin, another solid within the ramp.
        ('scene.surface_velocity("ramp", velocity=(1.0, 0.0, 0.0))', "CheckPlanMotion", "/World/ramp"),
        ('scene.contact("wooden_box", "ramp", friction=0.0)', "CheckPlanContacts", "/World/contact_wooden_box_ramp"),
        (
            'UsdPhysics.RigidBodyAPI(p("/World/wooden_box")).CreateAngularVelocityAttr(Gf.Vec3f(0.0, 90.0, 0.0))',
            "CheckPlanMotion", BOX,
        ),
        (
            'UsdPhysics.RigidBodyAPI(p("/World/wooden_box")).CreateVelocityAttr(Gf.Vec3f(0.5, 0.0, 0.0))',
            "CheckPlanPlaces", BOX,
        ),
        # Another collider on the box; one within the ramp; a body within it; a ground with a step.
        (
            'c = UsdGeom.Cube.Define(scene.stage, "/World/wooden_box/keel"); c.CreateSizeAttr(0.05); '
            "UsdPhysics.CollisionAPI.Apply(c.GetPrim())",
            "CheckPlanSizes", BOX,
        ),
        (
            'c = UsdGeom.Cube.Define(scene.stage, "/World/ramp/wall"); c.CreateSizeAttr(0.5); '
            "UsdPhysics.CollisionAPI.Apply(c.GetPrim())",
            "CheckPlanSizes", "/World/ramp",
        ),
        (
            'c = UsdGeom.Cube.Define(scene.stage, "/World/ground/step"); c.CreateSizeAttr(0.5); '
            "UsdPhysics.CollisionAPI.Apply(c.GetPrim())",
            "CheckPlanSizes", "/World/ground",
        ),
        (
            'c = UsdGeom.Cube.Define(scene.stage, "/World/ramp/cart"); c.CreateSizeAttr(0.2); '
            "UsdPhysics.CollisionAPI.Apply(c.GetPrim()); UsdPhysics.RigidBodyAPI.Apply(c.GetPrim())",
            "CheckPlanClosed", "/World/ramp/cart",
        ),
    ],
)  # fmt: skip
def test_what_the_plan_has_not_is_found(more: str, check: str, prim: str) -> None:
    names = "from pxr import Gf, UsdGeom, UsdPhysics\n"
    found = wrong(make_plan(SLIDE), names + more)
    assert check in [name for name, _ in found], found
    if "contact_" not in prim:
        assert (check, prim) in found, found


def test_a_plan_that_speaks_of_a_spring_may_have_one() -> None:
    plan = make_plan(SLIDE).model_copy(update={"prompt": "A box on a ramp is pulled by a spring"})
    assert wrong(plan, 'scene.spring("pull", "ramp", "wooden_box", stiffness=50.0, rest_length=0.1)') == []


@pytest.mark.parametrize(
    ("more", "parameter"),
    [
        ("Drive(velocity=90.0, damping=1.0)", "drive"),
        ("limits", "limits"),
        ("friction", "friction"),
        ("axis", "axis"),
        ("anchor", "anchor"),
        ("twice", ""),
    ],
)
def test_a_joint_is_the_plans(more: str, parameter: str) -> None:
    """Edits the recorded world's hinge: what a program might have given it."""
    plan = make_plan(PENDULUM)
    world = describe(scene_of(plan).stage)
    hinge = next(joint for joint in world.joints if joint.kind == "revolute")
    rest = [joint for joint in world.joints if joint is not hinge]
    changed = {
        "drive": {"drive": {"velocity": 1.5, "damping": 1.0}},
        "limits": {"low": -0.1, "high": 0.1},
        "friction": {"friction": 0.1},
        "axis": {"axis": "X"},
        "anchor": {"child_anchor": tuple(0.5 * x for x in hinge.child_anchor or ())},
        "": {"prim": "/World/second"},
    }[parameter]
    other = type(hinge).model_validate({**hinge.model_dump(), **changed})
    joints = [*rest, *([hinge] if parameter == "" else []), other]
    found = ask(CheckPlanJoints(), still(world.model_copy(update={"joints": joints})), plan)
    assert [f.target.parameter for f in found if not f.passed and f.target is not None] == [parameter]


def test_a_gear_and_a_path_are_found() -> None:
    plan = make_plan(PENDULUM)
    world = describe(scene_of(plan).stage)
    gear = {"prim": "/World/gear", "first": world.joints[0].prim, "second": world.joints[0].prim, "ratio": 1.0}
    path = {"times": [0.0, 1.0], "positions": [(0.0, 0.0, 1.0)] * 2, "rotations": [(0.0, 0.0, 0.0, 1.0)] * 2}
    body = world.bodies[0]
    changed = World.model_validate(
        {
            **world.model_dump(),
            "gears": [gear],
            "bodies": [{**body.model_dump(), "path": path}, *(b.model_dump() for b in world.bodies[1:])],
        }
    )
    found = ask(CheckPlanClosed(), still(changed), plan)
    assert {(f.prim, f.passed) for f in found} == {("/World/gear", False), (body.prim, False)}


def test_a_fluid_is_as_thick_as_the_plans() -> None:
    found = wrong(make_plan(TANK), change=("spacing=", "viscosity=5.0, spacing="))
    assert found == [("CheckPlanFluid", "/World/water")]


def test_a_tank_is_a_floor_and_four_walls() -> None:
    names = "from pxr import UsdGeom, UsdPhysics\n"
    lid = 'c = UsdGeom.Cube.Define(scene.stage, "/World/tank/lid"); UsdPhysics.CollisionAPI.Apply(c.GetPrim())'
    assert ("CheckPlanSizes", "/World/tank") in wrong(make_plan(TANK), names + lid)


@pytest.mark.parametrize(("kind", "size"), [("cylinder", (0.1, 0.2)), ("sphere", (0.1,)), ("capsule", (0.1, 0.1))])
def test_a_box_is_no_other_shape_of_its_size(kind: str, size: tuple[float, ...]) -> None:
    plan = make_plan(SLIDE)
    world = describe(scene_of(plan).stage)
    body = world.bodies[0]
    shape = body.shapes[0].model_copy(update={"kind": kind, "size": size})
    changed = world.model_copy(update={"bodies": [body.model_copy(update={"shapes": [shape]})]})
    assert not all(f.passed for f in ask(CheckPlanSizes(), still(changed), plan))


def test_a_motor_that_drags_a_box_down_its_ramp_is_rejected(tmp_path: Path) -> None:
    """The box would slide by itself; here a motorised rail along the slope sees to it."""
    plan = make_plan(SLIDE)
    rail = 'scene.joint_prismatic("rail", None, "wooden_box", axis=SLOPE, drive=Drive(velocity=0.8, damping=500.0))'
    pose = plan.object("ramp").pose
    assert pose is not None
    pitch = np.radians(pose.rotation_deg[1])
    slope = (float(np.cos(pitch)), 0.0, float(-np.sin(pitch)))
    verdicts = []
    for more in ("", rail.replace("SLOPE", str(slope))):
        scene = scene_of(plan, more)
        stage = scene.save(tmp_path / f"{len(verdicts)}.usda")
        assert Simulation(stage, device="cpu").run(tmp_path / f"{len(verdicts)}.rrd").problems == []
        verdicts.append(judge(read(tmp_path / f"{len(verdicts)}.rrd"), plan))
    assert verdicts[0].status == "accepted" or {f.check for f in verdicts[0].failures} <= {"CheckInFrame", "CheckSeen"}
    assert {("CheckPlanJoints", "/World/rail")} <= {(f.check, f.prim) for f in verdicts[1].failures}


def test_a_robot_has_links_of_its_own_and_must_be_there():
    """Its links are bodies within it; a plan's robot that is not in the world, or something else, is found."""
    made = Joint(prim="/World/dog/joints/hip", kind="revolute", parent="/World/dog/base", child="/World/dog/leg")
    t = times(1.0)
    dog = PlanObject(name="dog", role="robot", construction=FromRobot(robot="go2", size=(0.7, 0.4, 0.4)))
    plan = Plan(title="A robot", prompt="A robot.", objects=[dog])

    def world(*bodies):
        return record([box(name) for name in bodies], np.zeros((len(t), 3 * len(bodies))), np.zeros((len(t), 3)), t)

    there = with_world(world("dog/base", "dog/leg"), joints=[made])
    assert all(each.passed for check in (CheckPlanObjects(), CheckPlanClosed()) for each in ask(check, there, plan))
    (missing,) = (each for each in ask(CheckPlanObjects(), world("cat/base"), plan) if "dog" in each.message)
    assert missing.message == "The plan's dog is not in the world: no /World/dog"
    for other in (world("dog"), world("dog/base", "dog/leg")):  # a box; two that nothing holds together
        (wrong,) = (each for each in ask(CheckPlanObjects(), other, plan) if not each.passed)
        assert wrong.message == "/World/dog has no links that joints hold together, as a robot has"
    solid = dog.model_copy(update={"construction": Proxy(primitive="box", size=(0.7, 0.4, 0.4))})  # of one piece
    asked = ask(CheckPlanClosed(), there, plan.model_copy(update={"objects": [solid]}))
    assert [each.prim for each in asked if not each.passed] == ["/World/dog/base", "/World/dog/leg"]
