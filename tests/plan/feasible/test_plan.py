"""What keeps a plan from coming true is told before anything is built, with a way out."""

from __future__ import annotations

from typing import Any

import pytest

from wsim.agents.planner import read_plan
from wsim.errors import UserError
from wsim.plan.feasible.plan import faults
from wsim.rules.planner import plan as plan_by_rules

WOOD = {"name": "wood", "density": 600}
GROUND = {"name": "ground", "role": "terrain", "primitive": "ground", "state": "static", "material": WOOD}
TANK = {"name": "tank", "role": "container", "primitive": "tank", "size": [1, 1, 1], "state": "static"}
WATER = {
    "name": "water", "role": "fluid", "primitive": "fluid", "state": "fluid",
    "material": {"name": "water", "density": 1000}, "registration": {"spacing": 0.1},
}  # fmt: skip
IN_TANK = [{"predicate": "PLACE-IN", "ref": "tank"}, {"predicate": "FREE-SURFACE-AT", "value": 0.6}]


def box(name: str, position: list[float], size: tuple[float, ...] = (0.2, 0.2, 0.2), **more: Any) -> dict[str, Any]:
    return {
        "name": name, "role": "rigid_body", "primitive": "box", "size": list(size), "state": "dynamic",
        "material": WOOD, "position": position, **more,
    }  # fmt: skip


def formula(sentence: str, of: str = "box") -> dict[str, Any]:
    return {"kind": "formula", "object": of, "sentence": sentence}


def made(objects: list[Any], objectives: list[Any], prompt: str = "A world.", **more: Any) -> Any:
    answer = {"objects": [GROUND, *objects], "objectives": objectives, "simulation": {"duration": 3}, **more}
    return read_plan(answer, prompt)


A, B = box("box", [0, 0, 0.1]), box("other", [1, 0, 0.1])
FIXED = {"role": "background", "state": "static"}
POST, DOOR = box("post", [0, 0, 0.5], (0.1, 0.1, 1), **FIXED), box("door", [0.5, 0, 0.5], (0.8, 0.05, 0.9))
TABLE = box("table", [0, 0, 0.4], (1, 1, 0.8), **FIXED)
HINGE = {"name": "hinge", "kind": "hinge", "child": "door", "parent": "post", "anchor": [-0.45, 0, 0], "axis": "Z"}
RESTS = {"kind": "rests_on", "object": "box", "ref": "ground"}
INSIDE = {"kind": "stays_inside", "object": "water", "ref": "tank"}
BLOCK = {**WATER, "size": [0.4, 0.4, 0.4], "position": [0, 0, 0.5]}
OPENS = formula("eventually (turned_between(door, z, 10 deg, 90 deg))", "door")

WRONG: dict[str, tuple[dict[str, Any], str]] = {
    "a fluid's centre": (
        {"objects": [TANK, {**WATER, "relations": IN_TANK}],
         "objectives": [formula("finally (reaches(water, (0, 0, 1), within 10 cm))", "water")]},
        r"objectives\.0\.formula: reaches of water, which is a fluid and has no centre; ask stays_inside",
    ),
    "a fluid that settles": (
        {"objects": [TANK, {**WATER, "relations": IN_TANK}], "objectives": [{"kind": "settles", "object": "water"}]},
        r"objectives\.0: settles of water, which is a fluid",
    ),
    "a surface of a free fluid": (
        {"objects": [BLOCK], "objectives": [formula("fills_to(water, 0.2 m)", "water")]},
        r"fills_to: water is in no tank and has no surface; put it in one .* fills\(water, vessel\)",
    ),
    "inside what is solid": (
        {"objects": [A, BLOCK], "objectives": [{"kind": "fills", "object": "water", "ref": "box"}]},
        r"objectives\.0: fills box, which is a solid box and has no hollow; name a tank, or a vessel of the catalogue",
    ),
    "a size that the surface overrides": (
        {"objects": [TANK, {**WATER, "size": [0.5, 1, 0.5], "relations": IN_TANK}], "objectives": [INSIDE]},
        r"objects\.2\.construction\.size: 0\.5 x 1 x 0\.5 m of water, which its level and tank make 1 x 1 x 0\.6",
    ),
    "an upright door": (
        {"objects": [POST, DOOR], "objectives": [formula("upright(door, 10 deg)", "door")], "joints": [HINGE]},
        r"upright of door, which hinge lets turn about the vertical alone: .* ask turned_between\(door, z",
    ),
    "a weight that a hinge bears": (
        {"objects": [POST, DOOR], "objectives": [formula("finally (weighs_on(door, ground))", "door")],
         "joints": [HINGE]},
        r"weighs_on\(door, ground\), and hinge bears a part of its weight; ask lies_on\(door, ground\)",
    ),
    "an anchor in the air": (
        {"objects": [POST, DOOR], "objectives": [OPENS],
         "joints": [{**HINGE, "anchor": [-0.45, 0.7, 0]}]},
        r"joints\.0\.anchor: it is at \(0\.05, 0\.7, 0\.5\), 0\.68 m off door and 0\.65 m off post; a hinge is on",
    ),
    "a window after the end": (
        {"objects": [A], "objectives": [formula("eventually[2, 4] (touches(box, ground))")]},
        r"its windows reach to 4 s, and the run ends at 3 s; shorten them, or give simulation\.duration 4",
    ),
    "windows that add up": (
        {"objects": [A], "objectives": [formula("eventually[0, 2] (always[0, 2] (touches(box, ground)))")]},
        "its windows reach to 4 s",
    ),
    "topples and stays upright": (
        {"objects": [A],
         "objectives": [{"kind": "topples", "object": "box"}, formula("always (upright(box, 10 deg))")]},
        r"objectives\.0 and objectives\.1\.formula: box cannot topple and stay upright; leave one",
    ),
    "hits what it never touches": (
        {"objects": [A, B], "objectives": [
            {"kind": "collides_with", "object": "box", "ref": "other"}, formula("never_touches(box, other)")]},
        "box cannot do both, collides_with and never_touches, with other",
    ),
    "a free fluid without a place": (
        {"objects": [A, {**WATER, "size": [0.4] * 3, "relations": [{"predicate": "SPAWNED-ABOVE", "value": 0.1}]}],
         "objectives": [RESTS]},
        r"objects\.2: water is in no tank, and has no place .* give it a .position. too",
    ),
    "what is fixed moves": (
        {"objects": [A, TABLE], "objectives": [RESTS, {"kind": "moves", "object": "table"}]},
        r'objectives\.1: moves of table, which is static and never moves; make it "dynamic"',
    ),
    "a kinematic thing that nothing moves goes": (
        {"objects": [A, box("gate", [3, 0, 1], state="kinematic")],
         "objectives": [RESTS, formula("crosses(gate, z, 2 m)", "gate")]},
        r"crosses of gate, which is kinematic and has no velocity and no schedule: it never moves; give it one",
    ),
    "what a fixed joint holds falls": (
        {"objects": [A, box("sign", [3, 0, 1])], "objectives": [RESTS, formula("drops(sign)", "sign")],
         "joints": [{"name": "nail", "kind": "fixed", "child": "sign"}]},
        r"drops of sign, which nail holds to what stands still: it never moves; schedule its release, or leave it out",
    ),
    "a drawer beyond its stop": (
        {"objects": [A, box("drawer", [3, 0, 1])],
         "objectives": [RESTS, formula("gone_between(drawer, x, 0.5 m, 0.6 m)", "drawer")],
         "joints": [{"name": "rail", "kind": "slider", "child": "drawer", "axis": "X", "limits": [0, 0.4]}]},
        r"gone_between x 0\.5 to 0\.6 m of drawer, and rail's limits are 0 to 0\.4; widen the joint's limits",
    ),
    "a flap that may not turn so far topples": (
        {"objects": [A, box("flap", [3, 0, 1])],
         "objectives": [RESTS, {"kind": "topples", "object": "flap"}],
         "joints": [{"name": "pin", "kind": "hinge", "child": "flap", "axis": "Y", "limits": [-30, 30]}]},
        r"topples of flap, which pin lets turn by -30 to 30 deg; widen",
    ),
    "a flap leans the other way": (
        {"objects": [A, box("flap", [3, 0, 1])],
         "objectives": [RESTS, formula("tilt_between(flap, y, 20 deg, 40 deg)", "flap")],
         "joints": [{"name": "pin", "kind": "hinge", "child": "flap", "axis": "X", "limits": [0, 60]}]},
        r"tilt_between y 20 to 40 deg of flap, and pin's limits are -60 to 0",
    ),
    "a window before a clock that waits for another": (
        {"objects": [A, box("gate", [3, 0, 1], state="kinematic")],
         "objectives": [RESTS, formula("eventually[0, 1.5] (crosses(gate, z, 1.2 m))", "gate")],
         "schedules": [
             {"name": "push", "of": "box", "quantity": "force", "times": [0, 1], "values": [[1, 0, 0], [0, 0, 0]]},
             {"name": "lift", "of": "gate", "quantity": "velocity", "times": [0], "values": [[0, 0, 1]],
              "after": {"end": "push", "delay": 0.6}}]},
        r"crosses of gate by 1\.5 s, which does not move before 1\.6 s \(schedule lift\)",
    ),
    "stays where it does not start": (
        {"objects": [A, box("tower", [2, 0, 0.5], (0.2, 0.2, 1))],
         "objectives": [{"kind": "stays_on", "object": "box", "ref": "tower"}]},
        r"stays_on: box starts 1\.8 m from tower, .* ask for the end: rests_on",
    ),
    "pushed off what it is not on": (
        {"objects": [box("box", [3, 0, 0.1]), TABLE], "objectives": [RESTS],
         "prompt": "A box is pushed off a table."},
        r"the prompt has something pushed off table, and nothing that moves starts on it; place it",
    ),
}  # fmt: skip


@pytest.mark.parametrize("what", WRONG)
def test_what_cannot_come_true_is_refused(what: str) -> None:
    given, message = WRONG[what]
    with pytest.raises(UserError, match=message) as caught:
        made(**given)
    assert len(str(caught.value)) < 1000


RIGHT: dict[str, dict[str, Any]] = {
    "a door that turns": {
        "objects": [POST, DOOR], "joints": [HINGE],
        "objectives": [OPENS],
    },
    "a gate that control lifts": {
        "objects": [A, box("gate", [3, 0, 1], state="kinematic")],
        "objectives": [RESTS, formula("crosses(gate, z, 2 m)", "gate")],
        "steps": [{"title": "lift", "shows": "control lifts the gate"}],
    },
    "a sign that is let go": {
        "objects": [A, box("sign", [3, 0, 1])], "objectives": [RESTS, formula("drops(sign)", "sign")],
        "joints": [{"name": "nail", "kind": "fixed", "child": "sign"}],
        "schedules": [{"name": "fall", "of": "nail", "quantity": "release", "times": [1]}],
    },
    "what is fixed does not move": {
        "objects": [A, TABLE],
        "objectives": [RESTS, formula("not (crosses(table, x, 2 m))", "table"),
                       formula("always (speed_between(table, 0 m/s, 1 m/s))", "table"),
                       formula("moves(box, 1 m) or moves(table, 1 m)")],
    },
    "a flap within its limits": {
        "objects": [A, box("flap", [3, 0, 1])],
        "objectives": [RESTS, formula("tilt_between(flap, y, -40 deg, -20 deg)", "flap"),
                       formula("turned_between(flap, x, 59 deg, 61 deg)", "flap")],
        "joints": [{"name": "pin", "kind": "hinge", "child": "flap", "axis": "X", "limits": [0, 60]}],
    },
    "a window that reaches the schedule": {
        "objects": [A, box("gate", [3, 0, 1], state="kinematic")],
        "objectives": [RESTS, formula("eventually[0, 1.5] (crosses(gate, z, 1.05 m))", "gate"),
                       formula("eventually[0, 1] (eventually[0, 1] (crosses(gate, z, 1.05 m)))", "gate")],
        "schedules": [{"name": "lift", "of": "gate", "quantity": "velocity", "times": [0, 2], "linear": True,
                       "values": [[0, 0, 0], [0, 0, 1]], "after": {"touch": ["box", "ground"], "delay": 0.5}}],
    },
    "a bob on a thread": {
        "objects": [box("box", [0, 0, 1])],
        "joints": [{"name": "h", "kind": "hinge", "child": "box", "anchor": [0, 0, 1], "axis": "Y"}],
        "objectives": [{"kind": "swings", "object": "box"}],
    },
    "topples after it stood": {
        "objects": [A],
        "objectives": [{"kind": "topples", "object": "box"}, formula("always[0, 1] (touches(box, ground))")],
    },
    "touches what it did not touch before": {
        "objects": [A, B],
        "objectives": [formula("always[0, 0.4] (never_touches(box, other))"),
                       formula("eventually[0.4, 1.5] (touches(box, other))")],
    },
    "topples from upright": {
        "objects": [A],
        "objectives": [formula("always[0, 0.4] (upright(box, 10 deg))"), {"kind": "topples", "object": "box"}],
    },
    "one or the other": {
        "objects": [A, B],
        "objectives": [formula("never_touches(box, other) or eventually (touches(box, other))")],
    },
    "pushed off what it is on": {
        "objects": [box("box", [0, 0, 0.9]), TABLE], "objectives": [RESTS], "prompt": "A box is pushed off a table.",
    },
    "what drops into a tank": {
        "objects": [TANK, box("box", [0, 0, 2])],
        "objectives": [{"kind": "stays_inside", "object": "box", "ref": "tank"}],
    },
    "water in its tank": {"objects": [TANK, {**WATER, "relations": IN_TANK}], "objectives": [INSIDE]},
    "water that falls": {"objects": [BLOCK], "objectives": [formula("conserves(mass, water)", "water")]},
    "a window up to the end": {
        "objects": [A],
        "objectives": [formula("eventually[0, 3] (touches(box, ground))"),
                       formula("finally[1] (touches(box, ground))")],
    },
}  # fmt: skip


@pytest.mark.parametrize("what", RIGHT)
def test_what_can_is_taken(what: str) -> None:
    assert faults(made(**RIGHT[what])) == []


@pytest.mark.parametrize(
    "prompt",
    [
        "A steel ball rolls into a stack of four wooden blocks and knocks it over.",
        "A red cork ball floats in a tank of water and an iron cube sinks.",
        "A pendulum of 2 m swings from 90 degrees.", "A box falls onto a seesaw.",
        "A buggy crosses a raft between docks.",
    ],
)  # fmt: skip
def test_plans_by_rules_can_come_true(prompt: str) -> None:
    assert faults(plan_by_rules(prompt)) == []
