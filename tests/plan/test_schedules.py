"""Schedules in plans: what is wrong with one is said with its path, and what is right becomes a call."""

import pytest
from pydantic import ValidationError

from wsim.plan.schema import Plan, explain
from wsim.program.compose import compose
from wsim.program.validator import validate

WOOD = {"name": "wood", "density": 600}


def item(name, state="dynamic", primitive="box", size=(0.2, 0.2, 0.2), position=(0, 0, 1)):
    return {
        "name": name, "role": "rigid_body", "material": WOOD, "state": state,
        "construction": {"kind": "proxy", "primitive": primitive, "size": size}, "pose": {"position": position},
    }  # fmt: skip


def plan(*schedules, **more):
    ground = item("ground", "static", "ground", ()) | {"role": "terrain", "pose": None}
    return {
        "title": "t", "prompt": "p",
        "objects": [
            ground, item("ball", primitive="sphere", size=(0.1,)), item("arm", position=(2, 0, 1)),
            item("bob", position=(4, 0, 1)), item("gate", "kinematic", position=(6, 0, 1)),
            item("belt", "static", position=(8, 0, 1)),
        ],
        "joints": [
            {"name": "hinge", "kind": "hinge", "child": "arm", "drive": {"velocity": 90, "damping": 1}},
            {"name": "hook", "kind": "fixed", "child": "bob"},
        ],
        "contacts": [{"object": "ball", "ref": "ground", "friction": 0.4}],
        "schedules": list(schedules), "simulation": {"duration": 3},
    } | more  # fmt: skip


def one(**fields):
    return {"name": "s", "of": "ball", "quantity": "force", "times": [0, 1], "values": [[1, 0, 0], [0, 0, 0]]} | fields


def test_a_plan_is_composed_to_calls_that_are_sound():
    made = Plan.model_validate(plan(
        one(), one(name="a", quantity="torque", after={"touch": ["ball", "ground"], "delay": 0.5}),
        one(name="b", of="hinge", quantity="velocity", values=[180, 0]),
        one(name="c", of="hook", quantity="release", times=[1], values=[],
            after={"body": "ball", "axis": "Z", "below": 0.5}),
        one(name="d", of="gate", quantity="velocity", after={"joint": "hinge", "above": 45}),
        one(name="e", of="belt", quantity="surface_velocity", linear=True, after={"end": "a"}),
        one(name="f", of=["ball", "ground"], quantity="friction", values=[0.4, 0.1]),
    ))  # fmt: skip
    text = compose(made)
    assert validate(text, made) == []
    assert 'Event(touch=("ball", "ground"), delay=0.5)' in text and 'Event(joint="hinge", above=45.0)' in text
    assert 'scene.schedule("c", "hook", "release", times=[1.0]' in text.replace("\n        ", " ").replace("( ", "(")
    assert Plan.model_validate_json(made.model_dump_json()) == made
    assert "schedules" not in Plan.model_validate(plan()).model_dump()


BAD = [
    (one(of="blob"), "schedules.0.of: no joint and no object 'blob'"),
    (one(quantity="velocity"), "ball is a loose body, which has force, torque; this is 'velocity'"),
    (one(quantity="mass"), "schedules.0.quantity"),
    (one(times=[-1, 1]), "schedules.0.times.0"),
    (one(times=[1, 1]), "times [1.0, 1.0] must rise"),
    (one(times=[0, 9]), "schedules.0.times: 9 s is after the end, at 3 s"),
    (
        one(after={"touch": ["ball", "ground"], "delay": 3.5}),
        "schedules.0.after.delay: its delay, and what it counts from, put its start at 3.5 s or later",
    ),
    (
        one(times=[0, 2], after={"touch": ["ball", "ground"], "delay": 1.5}),
        "schedules.0.times: 2 s, which count from 1.5 s or later, is after the end, at 3 s",
    ),
    (one(values=[[1, 0, 0]]), "values has 1 entries; give one for each of 2 times"),
    (one(values=[1, 0]), "schedules.0.values.0: a force is [x, y, z]"),
    (one(of="hinge", quantity="velocity", values=[[1, 0, 0], 0]), "schedules.0.values.0: a velocity is one number"),
    (one(of="hinge", quantity="position", values=[1, 0]), "give it a drive with a stiffness"),
    (one(of="hook", quantity="effort", values=[1, 0]), "hook is a fixed joint, which has no effort"),
    (one(of="hinge", quantity="release", times=[1], values=[]), "hinge slides, or has limits or a drive"),
    (one(of=["ball", "arm"], quantity="friction", values=[1, 0]), "have no friction of their own"),
    (one(of=["ball", "ground"], quantity="friction", values=[11, 0]), "must be from 0 to 10"),
    (one(point=[0, 0, 0], quantity="torque"), '"point" is where a "force" acts'),
    (one(after={}), "this has none"),
    (one(after={"touch": ["ball", "arm"], "start": "s"}), "this has touch and start"),
    (one(after={"body": "ball", "above": 1}), '"axis"'),
    (one(after={"body": "belt", "axis": "X", "above": 1}), "schedules.0.after.body: 'belt' is nothing"),
    (one(after={"joint": "hook", "above": 1}), "no hinge or slider 'hook'; the plan has hinge"),
    (one(after={"end": "t"}), "no schedule 't' stands before this one; those are none"),
    (one(after={"touch": ["gate", "belt"]}), "never meet"),
]


@pytest.mark.parametrize(("bad", "says"), BAD, ids=[each[1][-30:] for each in BAD])
def test_what_is_wrong_is_said_with_its_path(bad, says):
    with pytest.raises(ValidationError) as error:
        Plan.model_validate(plan(bad))
    assert says in explain(error.value)


def test_a_quantity_has_one_schedule_and_a_name_is_given_once():
    with pytest.raises(ValidationError, match=r"schedules\.0 is of the same force; put all keys into one"):
        Plan.model_validate(plan(one(), one(name="t")))
    with pytest.raises(ValidationError, match=r"schedules\.0\.name: 'ball' is taken"):
        Plan.model_validate(plan(one(name="ball")))


def test_a_clock_that_counts_from_another_schedule_may_begin_after_the_end():
    first = one(times=[0, 2])
    late = one(name="t", quantity="torque", times=[0], values=[[0, 0, 1]], after={"end": "s", "delay": 1.5})
    with pytest.raises(ValidationError, match=r"schedules\.1\.after\.delay: .* start at 3\.5 s or later"):
        Plan.model_validate(plan(first, late))
    Plan.model_validate(plan(first, late | {"after": {"end": "s", "delay": 1.0}}))
