"""What a joint leaves free can be asked for; what it shuts out is told before anything is built."""

from __future__ import annotations

from typing import Any

import pytest

from tests.plan.feasible.test_plan import DOOR, FIXED, HINGE, OPENS, POST, RESTS, A, B, box, formula, made
from wsim.errors import UserError
from wsim.plan.feasible.plan import faults

SLIDER = {"name": "rail", "kind": "slider", "child": "box", "axis": "X"}
RELEASE = {"name": "drop", "of": "hinge", "quantity": "release", "times": [1.0]}
CART = box("cart", [0, 3, 0.5], state="kinematic", role="mechanism", velocity=[0.5, 0, 0])


def hinged(sentence: str, **more: Any) -> dict[str, Any]:
    return {"objects": [POST, DOOR], "objectives": [formula(sentence, "door")], "joints": [HINGE], **more}


def slid(sentence: str) -> dict[str, Any]:
    return {"objects": [A, B], "objectives": [formula(sentence)], "joints": [SLIDER]}


def carried(sentence: str) -> dict[str, Any]:
    return {"objects": [CART, A], "objectives": [formula(sentence, "cart")]}


@pytest.mark.parametrize(
    ("world", "why"),
    [
        (hinged("drops(door)"), "drops of door, and hinge keeps it at its height"),
        (hinged("turned_between(door, x, 20 deg, 60 deg)"), "and hinge lets it turn about z alone"),
        (hinged("eventually (spin_between(door, y, 20 deg/s, 60 deg/s))"), "and hinge lets it turn about z alone"),
        (hinged("gone_between(door, z, 0.3 m, 1 m)"), "and hinge keeps it where it is along z"),
        (hinged("moves(door, least 3 m)"), "holds its centre 0.45 m off the axis: it comes no further than 0.9 m"),
        (hinged("gone_between(door, x, -3 m, -2 m)"), "it comes no further than 0.9 m"),
        (hinged("flies(door)"), "and hinge holds it all the time: it never flies"),
        (slid("gone_between(box, y, 1 m, 2 m)"), "and rail lets it move along x alone"),
        (slid("drops(box)"), "and rail keeps it at its height"),
        (slid("turned_between(box, z, 20 deg, 90 deg)"), "and rail lets it turn about nothing"),
        (slid("not upright(box)"), "and rail lets it turn about nothing"),
        (carried("moves(cart, least 2 m)"), r"goes \(1.5, 0, 0\) m by its velocity"),
        (carried("moves(cart, least 0.5 m, back)"), r"goes \(1.5, 0, 0\) m by its velocity"),
        (carried("drops(cart)"), "by its velocity and no lower"),
    ],
)  # fmt: skip
def test_what_a_joint_or_a_velocity_shuts_out_is_told(world: dict[str, Any], why: str) -> None:
    with pytest.raises(UserError, match=why):
        made(**world)


@pytest.mark.parametrize(
    "world",
    [
        {"objects": [POST, DOOR], "objectives": [OPENS], "joints": [HINGE]},
        hinged("moves(door, least 0.5 m)"),
        hinged("turned_between(door, x, -5 deg, 5 deg)"),  # nought is inside
        hinged("drops(door)", schedules=[RELEASE]),
        hinged("not upright(door)", schedules=[RELEASE]),
        slid("gone_between(box, x, 1 m, 2 m)"),
        carried("moves(cart, least 1 m, front)"),
        {"objects": [A, B], "objectives": [formula("drops(box) or moves(box, least 1 m)")], "joints": [SLIDER]},
    ],
)
def test_what_it_leaves_free_may_be_asked(world: dict[str, Any]) -> None:
    assert faults(made(**world)) == []


@pytest.mark.parametrize(
    ("objectives", "why"),
    [
        (["upright(box)", "not upright(box)"], "box cannot be upright all the time, and not"),
        (["collides_with(other, box)", "never_touches(box, other)"], "cannot do both, collides_with and never_touches"),
        (["gone_between(box, x, 1 m, 2 m)", "gone_between(box, x, -2 m, -1 m)"], "gone_between 1 to 2 and -2 to -1"),
        (["gone_between(box, x, 1 m, 2 m) and gone_between(box, x, -2 m, -1 m)"], "cannot have both, gone_between"),
        (["moves(box, least 1 m, front)", "moves(box, least 1 m, back)"], "cannot end both, back and front"),
        (["stays_within(box, (0, 0, 0.1), radius 0.1 m)", "moves(box, least 1 m)"], "cannot move 1 m inside a radius"),
        (["counts(table, 3, box, other)"], "counts: 3 of the 2 that it names"),
        (["rolls_without_slip(box, ground)"], "a box does not roll"),
        (["goes_down(box, ground)"], "ground is level, and nothing goes down it"),
        (["swings(box)"], "nothing holds it; hang it on a joint or a cord"),
        (["touches(box, box)"], "it is said of a thing and itself"),
    ],
)
def test_what_contradicts_itself_is_told(objectives: list[str], why: str) -> None:
    table = box("table", [3, 0, 0.4], (1, 1, 0.8), **FIXED)
    with pytest.raises(UserError, match=why):
        made([A, B, table], [formula(sentence) for sentence in objectives])


@pytest.mark.parametrize(
    "objectives",
    [
        ["eventually (gone_between(box, x, 1 m, 2 m))", "finally (gone_between(box, x, -2 m, -1 m))"],
        ["gone_between(box, x, 1 m, 2 m)", "gone_between(box, y, -2 m, -1 m)"],
        ["eventually[0, 1] (upright(box))", "finally (not upright(box))"],
        ["moves(box, front)", "moves(box, left)"],
        ["collides_with(other, box)", "always[0, 0.1] (never_touches(box, other))"],
    ],
)
def test_what_comes_one_after_the_other_contradicts_nothing(objectives: list[str]) -> None:
    assert faults(made([A, B], [RESTS, *map(formula, objectives)])) == []
