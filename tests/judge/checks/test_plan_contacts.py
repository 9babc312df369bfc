"""The world's pairs against the plan's contacts."""

import pytest

from tests.judge.theory import ask, resting, with_world
from wsim.judge.checks.plan_contacts import CheckPlanContacts
from wsim.plan.schema import Material, Plan, PlanObject, Pose
from wsim.program.compose import compose
from wsim.scene import Scene
from wsim.scene.describe import describe

_GROUND, _POSE = Pose(position=(0.0, 0.0, 0.0)), Pose(position=(0.0, 0.0, 0.1))


def _plan(**contact):
    wood = Material(name="wood", density=600.0, friction=0.4)
    ground = PlanObject.proxy(
        name="ground", role="terrain", primitive="ground", state="static", material=wood, pose=_GROUND
    )
    ball = PlanObject.proxy(name="ball", role="rigid_body", primitive="sphere", size=(0.1,), material=wood, pose=_POSE)
    pair = {"object": "ball", "ref": "ground"} | contact
    return Plan.model_validate({"title": "t", "prompt": "p", "objects": [ground, ball], "contacts": [pair]})


def _found(plan, text):
    scene = Scene()
    space: dict[str, object] = {}
    exec(compile(text, "program.py", "exec"), space)
    space["build"](scene)
    return ask(CheckPlanContacts(), with_world(resting(), **dict(describe(scene.stage))), plan)


@pytest.mark.parametrize("contact", [{"friction": 0.1}, {"restitution": 0.0, "rolling": 0.02}, {"restitution": 0.9}])
def test_what_is_composed_passes(contact):
    plan = _plan(**contact)
    (finding,) = _found(plan, compose(plan))
    assert finding.passed


def test_a_pair_left_out_or_otherwise_is_found():
    plan = _plan(friction=0.1, rolling=0.02)
    text = compose(plan)
    assert 'scene.contact("ball", "ground", friction=0.1, rolling=0.02)' in text
    other = _found(plan, text.replace("friction=0.1, rolling", "friction=0.2, rolling"))
    assert [(f.passed, f.target.parameter, f.target.suggested) for f in other] == [(False, "friction", 0.1)]
    gone = _found(plan, "\n".join(line for line in text.splitlines() if "scene.contact" not in line))
    assert [(f.passed, f.target.parameter) for f in gone] == [(False, "friction"), (False, "rolling")]


@pytest.mark.parametrize(
    ("contact", "says"),
    [
        ({"ref": "nothing", "friction": 0.1}, "contacts.0.ref: no object 'nothing'"),
        ({"ref": "ball", "friction": 0.1}, "does not touch itself"),
        ({"object": "ground", "friction": 0.1}, "does not touch itself"),
        ({}, "states nothing; give friction, restitution or rolling"),
        ({"friction": -1}, "greater than or equal to 0"),
        ({"rolling": 2}, "less than or equal to 1"),
    ],
)
def test_a_plan_with_a_wrong_contact_is_refused(contact, says):
    with pytest.raises(ValueError, match=says.replace(".", r"\.")):
        _plan(**contact)


def test_a_plan_without_contacts_reads_as_it_always_did():
    plan = Plan.model_validate({"title": "t", "prompt": "p", "objects": []})
    assert "contacts" not in plan.model_dump()
    assert "rolling" not in Material(name="wood", density=600.0).model_dump()
