"""Ropes, springs and cables of a plan: composed, described, and held against the world."""

import json
from pathlib import Path

import pytest

from tests.judge.theory import ask, resting, with_world
from wsim.judge.checks.plan_closed import CheckPlanClosed
from wsim.judge.checks.plan_cords import CheckPlanCords
from wsim.judge.checks.plan_joints import CheckPlanJoints
from wsim.judge.checks.run import CheckPlanObjects
from wsim.plan.schema import Plan
from wsim.plan.store import load
from wsim.program.compose import compose
from wsim.program.validator import validate
from wsim.scene import Scene
from wsim.scene.describe import describe

HOIST = Path(__file__).parents[3] / "examples" / "plans" / "hoist.json"


@pytest.fixture(scope="module")
def hoist() -> Plan:
    return load(HOIST)


def _found(plan: Plan, text: str, check=CheckPlanCords):
    scene, space = Scene(), {}
    exec(compile(text, "program.py", "exec"), space)
    space["build"](scene)
    return ask(check(), with_world(resting(), **dict(describe(scene.stage))), plan)


@pytest.mark.parametrize("check", [CheckPlanCords, CheckPlanClosed, CheckPlanJoints, CheckPlanObjects])
def test_what_is_composed_is_the_plans_and_nothing_else(hoist, check):
    text = compose(hoist)
    assert validate(text, hoist) == []
    assert all(finding.passed for finding in _found(hoist, text, check))


@pytest.mark.parametrize(
    ("old", "new", "parameter"),
    [
        ("stiffness=50.0", "stiffness=60.0", "stiffness"), ("damping=0.2", "damping=0.4", "damping"),
        ("rest_length=0.6", "rest_length=0.5", "rest_length"), ("heavy, light", "light, heavy", "a"),
        (", around=[wheel]", "", "a"),
    ],
)  # fmt: skip
def test_a_cord_that_is_another_is_found(hoist, old, new, parameter):
    text = compose(hoist)
    assert old in text
    (finding,) = _found(hoist, text.replace(old, new))
    assert (finding.passed, finding.target.parameter) == (False, parameter)


def _without(text: str, call: str) -> str:
    """A program without one call of `scene`, over as many lines as it is."""
    head, _, rest = text.partition(f"    scene.{call}(")
    depth, end = 1, 0
    while depth:
        depth += {"(": 1, ")": -1}.get(rest[end], 0)
        end += 1
    return head + rest[end:].lstrip("\n")


@pytest.mark.parametrize(("call", "name"), [("rope", "rope"), ("spring", "coil"), ("cable", "chain")])
def test_a_cord_that_is_missing_is_found(hoist, call, name):
    (finding,) = _found(hoist, _without(compose(hoist), call))
    assert (finding.passed, finding.target.parameter, finding.target.direction) == (False, name, "add")


def test_a_cord_that_the_plan_has_not_is_found(hoist):
    less = hoist.model_copy(update={"cords": hoist.cords[1:]})
    assert [f.prim for f in _found(less, compose(hoist), CheckPlanClosed) if not f.passed] == ["/World/rope"]


@pytest.mark.parametrize(
    ("changed", "says"),
    [
        ({"a": "nothing"}, "cords.0.a: no object 'nothing'"),
        ({"a": "ground"}, "ground is a ground; leave it out, and give anchor_a"),
        ({"around": [{"object": "post_1"}]}, "a rope runs round cylinders; post_1 is a box"),
        ({"a": "post_1", "b": "post_2", "around": None}, "neither of its ends is at a body that it could move"),
        ({"b": "heavy"}, "both its ends are heavy"),
        ({"stiffness": 3.0}, "stiffness is of a spring; it is a rope: remove it"),
        ({"kind": "spring", "around": None}, "a spring needs stiffness [N/m], or damping"),
        ({"b": None}, 'without "b" it ends at the world; give anchor_b'),
        ({"anchor_a": [0.2, 0.0, 0.8]}, "both its ends are at one place"),
        ({"name": "heavy"}, "'heavy' is taken by objects.2"),
        ({"length": -1.0}, "greater than 0"),
    ],
)
def test_a_cord_that_cannot_be_is_refused_with_its_field(changed, says):
    data = json.loads(HOIST.read_text(encoding="utf-8"))
    data["cords"][0] = {key: value for key, value in (data["cords"][0] | changed).items() if value is not None}
    with pytest.raises(ValueError, match=r"cords|taken") as caught:
        Plan.model_validate(data)
    assert says in str(caught.value)


def test_a_name_that_a_link_would_have_is_refused():
    data = json.loads(HOIST.read_text(encoding="utf-8"))
    data["objects"][-1]["name"], data["cords"][2]["b"] = "chain_3", "chain_3"
    with pytest.raises(ValueError, match="chain_3 is one of its links' names"):
        Plan.model_validate(data)
