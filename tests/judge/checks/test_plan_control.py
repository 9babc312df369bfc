"""What a policy moves needs no `control`, and nothing else is excused by it."""

import math

import pytest

from tests.judge.checks.test_plan import a_plan, a_world
from tests.judge.theory import ask, with_world
from wsim.assets.policies import Observation, PolicySpec
from wsim.judge.checks.run import CheckPlanControl
from wsim.plan.schema import Actuation, FromRobot, Plan, PlanObject, Registration, SchedulePlan, Step
from wsim.scene.world import Event, Joint, JointPath, Policy, Reach, Schedule

SPEC = PolicySpec(joints=["hip"], rate=50.0, observations=[Observation(of="command")])
STEP = Step(title="push", shows="control pushes the ball", controls=True)


def judged(actuated, joint=None, steps=(), policy=True, base="/World/robot/base", controlled=False):
    """Whether a world's control is as its plan asks, whose `actuated` is moved, by a joint of the box or otherwise."""
    plan = a_plan(name="hip", kind="hinge", child="box")
    objects = [
        item.model_copy(update={"registration": item.registration.model_copy(
            update={"actuation": [Actuation(kind="policy", joint=joint)]})}) if item.name in actuated else item
        for item in plan.objects
    ]  # fmt: skip
    hip = Joint(prim="/World/hip", kind="revolute", parent=None, child="/World/box")
    walks = Policy(
        prim="/World/walk", base=base, joints=["/World/hip"], spec=SPEC, network="",
        sha256="",
    )  # fmt: skip
    world = with_world(a_world(), joints=[hip], policies=[walks] if policy else [])
    world.metadata["controlled"] = controlled
    found = ask(CheckPlanControl(), world, plan.model_copy(update={"objects": objects, "steps": list(steps)}))
    return all(finding.passed for finding in found)


@pytest.mark.parametrize(
    ("joint", "base"), [("hip", "/World/robot/base"), (None, "/World/box/base"), (None, "/World/x")]
)
def test_a_policy_moves_its_joints_and_what_it_has(joint, base):
    assert judged(["box"], joint, base=base)
    assert not judged(["box"], joint, policy=False)


def test_a_policy_excuses_nothing_that_it_does_not_move():
    assert not judged(["ball"])
    assert not judged(["box"], "knee")
    assert not judged(["box", "ball"])
    assert not judged(["box"], "hip", [STEP]) and judged(["box"], "hip", [STEP], controlled=True)


def test_a_policy_that_the_plan_names_and_the_world_lacks_is_said_so():
    dog = PlanObject(
        name="dog", role="robot", construction=FromRobot(robot="go2", size=(0.7, 0.4, 0.4)),
        registration=Registration(actuation=[Actuation(kind="policy", policy="go2_walk")]),
    )  # fmt: skip
    plan = Plan(title="", prompt="", objects=[dog])
    (found,) = ask(CheckPlanControl(), with_world(a_world(), policies=[]), plan)
    assert (found.passed, found.message) == (False, "The plan lets a policy walk dog, and none does")
    assert (found.target.kind, found.target.parameter, found.target.direction) == ("controller", "policy", "add")
    walks = Policy(prim="/World/walk", base="/World/dog/base", joints=[], spec=SPEC, network="", sha256="")
    assert all(each.passed for each in ask(CheckPlanControl(), with_world(a_world(), policies=[walks]), plan))


TIMED = [
    ({"kind": "reach", "link": "hand", "path": [[0.3, 0.0, 0.2]], "times": [1.0]}, "reach"),
    ({"kind": "schedule", "joint": "grip", "target": [0.03, 0.0], "times": [1.0, 2.0]}, "schedule"),
]
REACH = Reach(
    prim="/World/arm/reaches/reach_0", link="/World/arm/hand", times=[1.0], positions=[(0.3, 0.0, 0.2)], straight=False
)
GRIP = JointPath(prim="/World/arm/joints/grip", times=[1.0, 2.0], positions=[0.03, 0.0])
SLIDER = Joint(prim="/World/arm/joints/grip", kind="prismatic", parent="/World/arm/hand", child="/World/arm/finger")


def by_time(actuations, controlled=False, **stage):
    """What is found of an arm that does this by the plan, and that on the stage."""
    arm = PlanObject(
        name="arm", role="robot", construction=FromRobot(robot="desk_arm", size=(0.3, 0.3, 0.5)),
        registration=Registration.model_validate({"actuation": actuations}),
    )  # fmt: skip
    world = with_world(a_world(), joints=[SLIDER], **stage)
    world.metadata["controlled"] = world.metadata["steered"] = controlled
    return ask(CheckPlanControl(), world, Plan(title="", prompt="", objects=[arm]))


@pytest.mark.parametrize(("actuation", "kind"), TIMED)
def test_what_a_plan_lets_a_robot_do_by_time_is_on_the_stage(actuation, kind):
    stage = {"reaches": [REACH]} if kind == "reach" else {"joint_paths": [GRIP]}
    assert all(each.passed for each in by_time([actuation], **stage))
    for unlike, of, numbers in (
        ({"reaches": [REACH.model_copy(update={"link": "/World/arm/wrist"})]}, "", ""),
        ({"reaches": [REACH.model_copy(update={"positions": [(0.3, 0.0, 0.25)]})]}, "reach",
         ": it has way 0.3, 0, 0.25 m and the plan 0.3, 0, 0.2 m"),
        ({"reaches": [REACH.model_copy(update={"times": [2.0]})]}, "reach", ": it has times 2 s and the plan 1 s"),
        ({"joint_paths": [GRIP.model_copy(update={"prim": "/World/other/joints/grip"})]}, "", ""),
        ({"joint_paths": [GRIP.model_copy(update={"positions": [0.0, 0.0]})]}, "schedule",
         ": it has positions 0, 0 m and the plan 0.03, 0 m"),
        ({}, "", ""),
    ):  # fmt: skip
        (found,) = by_time([actuation], **unlike)
        says = f"The plan has a {kind} of arm that the stage has not{numbers if of == kind else ''}"
        assert (found.passed, found.message) == (False, says)
        assert (found.target.kind, found.target.parameter) == ("controller", kind)


@pytest.mark.parametrize("stage", [{"reaches": [REACH]}, {"joint_paths": [GRIP]}])
def test_what_a_stage_does_by_time_is_the_plans(stage):
    (found,) = by_time([], **stage)
    assert not found.passed and "by time, and the plan does not" in found.message
    assert (found.target.kind, found.target.direction) == ("controller", "remove")


def test_what_is_done_by_time_makes_no_control_legal():
    """A motion that is left off the stage is no reason for a program's own hands."""
    actuations = [actuation for actuation, _ in TIMED]
    both = {"reaches": [REACH], "joint_paths": [GRIP]}
    assert all(each.passed for each in by_time(actuations, **both))
    for stage in (both, {"reaches": [REACH]}):
        assert not all(each.passed for each in by_time(actuations, controlled=True, **stage))


PUSH = Schedule(
    prim="/World/Schedules/push", target="/World/ball", quantity="force", times=[0.0, 2.0],
    values=[(40.0, 0.0, 0.0), (0.0, 0.0, 0.0)],
)  # fmt: skip
TURN = Schedule(
    prim="/World/Schedules/turn", target="/World/hip", quantity="velocity", times=[0.0], values=[(math.pi / 2,)],
    after=Event(kind="end", first="/World/Schedules/push", delay=0.5),
)  # fmt: skip
PLANNED = [
    {"name": "push", "of": "ball", "quantity": "force", "times": [0, 2], "values": [[40, 0, 0], [0, 0, 0]]},
    {"name": "turn", "of": "hip", "quantity": "velocity", "times": [0], "values": [90],
     "after": {"end": "push", "delay": 0.5}},
]  # fmt: skip


def scheduled(*stage):
    """What is found of a world with schedules of a ball's force, and of a hinge's speed after it."""
    plan = a_plan(name="hip", kind="hinge", child="box")
    hip = Joint(prim="/World/hip", kind="revolute", parent=None, child="/World/box")
    planned = [SchedulePlan.model_validate(each) for each in PLANNED]
    world = with_world(a_world(), joints=[hip], schedules=list(stage))
    return ask(CheckPlanControl(), world, plan.model_copy(update={"schedules": planned}))


def test_schedules_may_have_other_names_in_the_stage():
    assert all(each.passed for each in scheduled(PUSH, TURN))
    shove = PUSH.model_copy(update={"prim": "/World/Schedules/shove"})
    assert all(each.passed for each in scheduled(shove, after(TURN, first="/World/Schedules/shove")))


def after(schedule, **change):
    return schedule.model_copy(update={"after": schedule.after.model_copy(update=change)})


@pytest.mark.parametrize(
    ("stage", "says", "value", "expected"),
    [
        ((PUSH.model_copy(update={"times": [0.0, 1.5]}), TURN), "times 0, 1.5 s and the plan 0, 2 s", 1.5, 2.0),
        ((PUSH.model_copy(update={"values": [(32.0, 0.0, 0.0), (0.0, 0.0, 0.0)]}), TURN),
         "values 32, 0, 0, 0, 0, 0 N and the plan 40, 0, 0, 0, 0, 0 N", 32.0, 40.0),
        ((PUSH, TURN.model_copy(update={"values": [(math.pi / 4,)]})), "values 45 deg/s and the plan 90 deg/s", 45, 90),
        ((PUSH, after(TURN, delay=0.8)), "delay 0.8 s and the plan 0.5 s", 0.8, 0.5),
        ((PUSH, after(TURN, kind="start")), "the event (after) start of push and the plan end of push", None, None),
        ((PUSH, TURN.model_copy(update={"after": None})), "times from the start of the run and the plan", None, None),
    ],
)  # fmt: skip
def test_in_what_a_schedule_differs_is_said_in_the_plans_units(stage, says, value, expected):
    (found,) = scheduled(*stage)
    assert not found.passed and says in found.message
    assert (found.value, found.expected) == (value and pytest.approx(value), expected and pytest.approx(expected))
    assert found.margin is None or found.margin < 0.0
