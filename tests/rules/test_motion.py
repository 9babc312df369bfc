"""Sentences of bodies that move: what is asked of them, what is seen of them, and what starts them."""

import math

import pytest

from wsim.defaults import GRAVITY
from wsim.errors import UserError
from wsim.plan.layout import check_clear
from wsim.plan.layout.bodies import around
from wsim.plan.layout.boxes import Box
from wsim.plan.schema.formula_contact import CollidesWith
from wsim.plan.schema.formula_place import StaysWithin
from wsim.plan.views import _sees
from wsim.rules.planner import plan


def kinds(made) -> list[tuple[str, str, str | None]]:
    return [(o.kind, o.object, o.ref) for o in made.objectives]


def choices(made) -> str:
    return "; ".join(f"{a.choice} ({a.why})" for a in made.assumptions)


def seen(made, name: str, ways) -> bool:
    """Whether every camera has the object in the picture wherever its start is shifted to."""
    start = around(made.object(name))
    places = [
        Box(*(tuple(a + b for a, b in zip(at, way, strict=True)) for at in (start.low, start.high))) for way in ways
    ]
    return all(_sees(camera.eye, camera.target, place) for camera in made.cameras for place in places)


# ---- on ramps
def test_what_rests_on_a_ramp_is_asked_to_stay_in_its_place():
    made = plan("A wooden block rests on a wooden ramp of 40 degrees for 5 seconds.")
    stays, settles = made.objectives
    block = made.object("wooden_block")
    assert settles.kind == "settles" and isinstance(stays.formula, StaysWithin)
    assert stays.formula.center == block.pose.position and stays.formula.radius < min(block.size) / 2
    assert "warning: at 40 degrees and a friction of 0.4 it slides" in choices(made)


def test_an_ice_ball_gets_a_ramp_on_which_it_rolls():
    made = plan("An ice ball rolls down a ramp.")
    slope = math.tan(math.radians(made.object("ramp").pose.rotation_deg[1]))
    assert 2 / 7 * slope < 0.05 < 1.5 * 2 / 7 * slope and "warning" not in choices(made)


@pytest.mark.parametrize(
    ("prompt", "slips"),
    [
        ("An ice ball rolls down a wooden ramp of 30 degrees.", True),
        ("A steel ball rolls down a steel ramp of 60 degrees.", True),
        ("A steel ball rolls down a steel ramp of 54 degrees.", False),  # atan(7/2 * 0.4) = 54.5 degrees
    ],
)
def test_a_ball_that_slips_down_a_ramp_is_warned_of(prompt, slips):
    assert ("it slips as it rolls" in choices(plan(prompt))) == slips


def test_a_ball_with_a_speed_rolls_down_a_ramp_from_the_start():
    ball = plan("A ball rolls at 2 m/s down a ramp of 10 degrees.").object("ball")
    assert ball.rolling and math.hypot(*ball.velocity) == pytest.approx(2.0, rel=1e-6)
    assert plan("A ball rolls down a ramp of 10 degrees.").object("ball").rolling is None


def test_a_ramp_is_longer_than_what_is_on_it():
    made = plan("A plank slides down a ramp of 30 degrees.")
    check_clear(made)
    assert made.object("ramp").size[0] >= made.object("plank").size[0] + made.objectives[0].value
    with pytest.raises(UserError, match=r"1\.5 m is too short for what is on it, 2 m long"):
        plan("A plank slides down a 1.5 m long ramp")


# ---- what the cameras show
@pytest.mark.parametrize("direction", ["", " to the left"])
def test_a_throw_is_in_the_picture_from_its_start_to_where_it_lands(direction):
    made = plan(f"A ball is thrown{direction} at 5 m/s at 45 degrees.")
    v = made.object("ball").velocity
    land = (v[2] + math.sqrt(v[2] ** 2 + 2 * GRAVITY * 1.0)) / GRAVITY
    times = [land * k / 10 for k in range(11)]
    assert seen(made, "ball", [(v[0] * t, v[1] * t, v[2] * t - GRAVITY * t**2 / 2) for t in times])


def test_a_pendulum_is_in_the_picture_all_its_way():
    made = plan("A pendulum of 2 m swings from 90 degrees.")
    turns = [math.radians(90 - 10 * k) for k in range(19)]
    assert seen(made, "pendulum", [(2 * math.sin(a) - 2.0, 0.0, -2 * math.cos(a)) for a in turns])


def test_what_drops_is_in_the_picture_where_it_lands():
    assert seen(plan("A ball drops from 3 m"), "ball", [(0.0, 0.0, 0.0), (0.0, 0.0, -3.0)])


def test_a_row_that_is_hit_is_in_the_picture_as_it_lies():
    made = plan("A ball rolls at 3 m/s and hits a row of 8 dominoes.")
    assert seen(made, "domino_8", [(0.4, 0.0, 0.0)])


@pytest.mark.parametrize(
    "prompt",
    [
        "A concrete block slides across the floor at 3 m/s and hits a wall",
        "A steel ball rolls at 3 m/s and hits a wall",
    ],
)
def test_a_wall_that_is_hit_stands_and_the_picture_is_of_it_and_of_what_hits_it(prompt):
    made = plan(prompt)
    (thing,) = (item for item in made.objects if item.state == "dynamic")
    low, high = around(thing).low[0], around(made.object("wall")).high[0]
    assert made.cameras[0].target[0] == pytest.approx(0.5 * (low + high), abs=0.01)
    assert seen(made, thing.name, [(0.0, 0.0, 0.0)]) and seen(made, "wall", [(0.0, 0.0, 0.0)])


def test_what_a_wall_throws_back_behind_its_start_is_in_the_picture():
    """After the blow (0.9 - 0.4) / 1.4 of its speed, 1.07 m/s, and more until it rolls."""
    made = plan("A rubber ball with a restitution of 0.9 rolls at 3 m/s and hits a wall for 6 seconds.")
    assert seen(made, "rubber_ball", [(0.0, 0.0, 0.0), (1.8 - 1.07 * (6.0 - 0.6), 0.0, 0.0)])


def test_what_nothing_rubs_comes_back_as_far_as_time_lets_it():
    """0.6 m there at 1 m/s, and back at half of that for what is left of 4 s."""
    made = plan("A steel block with a friction of 0 and a restitution of 0.5 slides at 1 m/s and hits a wall for 4 s.")
    assert seen(made, "steel_block", [(0.0, 0.0, 0.0), (0.6 - 0.5 * (4.0 - 0.6), 0.0, 0.0)])
    assert made.cameras[0].target[0] > -1.5


# ---- what topples, what is hit
@pytest.mark.parametrize(
    "prompt",
    ["A row of 12 dominoes topples.", "Five dominoes topple.", "Dominoes topple", "A row of dominoes falls over"],
)
def test_a_row_that_topples_is_pushed_at_its_first(prompt):
    made = plan(prompt)
    first, *others = [item for item in made.objects if item.name.startswith("domino")]
    assert {objective.kind for objective in made.objectives} == {"topples"}
    assert "a push to +X, the first one alone" in choices(made) and not any(any(one.velocity) for one in others)
    # Energy about the lower edge, per mass: more than lifts the middle over it.
    (t, _, h), rate = first.size, math.radians(first.angular_velocity_deg[1])
    assert (t**2 + h**2) / 6 * rate**2 > GRAVITY * (math.hypot(t, h) - h) / 2
    assert first.velocity[0] == pytest.approx(rate * h / 2, rel=1e-4)


@pytest.mark.parametrize("prompt", ["A stack of four crates topples.", "A tower of five blocks falls."])
def test_a_stack_that_topples_is_pushed_as_one(prompt):
    made = plan(prompt)
    moved = [item for item in made.objects if any(item.velocity)]
    assert kinds(made) == [("topples", moved[-1].name, None)] and len(moved) in (4, 5)
    assert len({item.angular_velocity_deg for item in moved}) == 1
    assert "dropped" not in choices(made)


def test_what_is_too_low_to_topple_is_refused():
    with pytest.raises(UserError, match=r"0\.4 m high and 0\.4 m deep, it does not topple by itself"):
        plan("A row of six crates topples.")


@pytest.mark.parametrize(
    ("prompt", "expected"),
    [
        ("A ball rolls at 3 m/s and hits a row of three steel balls.", [("collides_with", "ball", "steel_ball_1")]),
        ("A steel ball drops from 2 m on a stack of three crates.", [("formula", "steel_ball", None)]),
        ("A ball hits a row of 3 dominoes", [("topples", f"domino_{k}", None) for k in (1, 2, 3)]),
        ("A 40 cm ball hits a stack of three 20 cm boxes", [("collides_with", "ball", "box_2")]),
    ],
)
def test_a_hit_is_asked_for(prompt, expected):
    assert kinds(plan(prompt)) == expected


# ---- how surfaces rub and bounce
def test_a_ball_bounces_by_its_own_restitution():
    made = plan("A rubber ball bounces on a table")
    (objective,) = made.objectives
    assert objective.formula == CollidesWith(object="rubber_ball", ref="table", restitution=0.6)
    (contact,) = made.contacts  # else the smaller of the two would count, oak's 0.1
    assert (contact.object, contact.ref, contact.restitution) == ("rubber_ball", "table", 0.6)
    assert kinds(plan("A ball bounces off a wall")) == [("collides_with", "ball", "wall")]


@pytest.mark.parametrize(
    ("prompt", "value"),
    [
        ("A steel ball with a restitution of 0.8 drops from 1 m.", 0.8),
        ("A steel ball drops from 1 m with a restitution of 0.8.", 0.8),
        ("A steel ball bounces with a restitution of 0.8 between the ball and the floor", 0.8),
    ],
)
def test_a_restitution_is_taken_as_said(prompt, value):
    made = plan(prompt)
    stated = [c.restitution for c in made.contacts] or [made.object("steel_ball").material.restitution]
    assert stated == [value] and made.objectives[0].formula.restitution == value


def test_a_restitution_of_nothing_is_one():
    """A material's 0 leaves it to the other: only a contact says that what falls there stays down."""
    (contact,) = plan("A ball drops from 1 m on a table with a restitution of 0").contacts
    assert (contact.ref, contact.restitution) == ("table", 0.0)


def test_a_friction_is_taken_as_said():
    made = plan("A crate slides at 3 m/s with a friction of 0.2 between the crate and the floor.")
    (contact,) = made.contacts
    assert (contact.object, contact.ref, contact.friction) == ("crate", "ground", 0.2)
    assert made.objectives[0].value == pytest.approx(0.5 * 9 / (2 * 0.2 * GRAVITY), abs=1e-3)
    own = plan("A crate with a friction of 0.2 slides at 3 m/s")
    assert own.object("crate").material.friction == 0.2 and own.contacts == []
    (more,) = plan("A crate with a friction of 0.9 slides at 3 m/s").contacts
    assert (more.ref, more.friction) == ("ground", 0.9)
    steep = plan(
        "A wooden block rests on a wooden ramp of 40 degrees with a friction of 0.9 between the block and the ramp"
    )
    assert "warning" not in choices(steep)
    with pytest.raises(UserError, match="a restitution of 3 is outside 0 to 1"):
        plan("A ball with a restitution of 3 drops")


# ---- numbers where people say them
@pytest.mark.parametrize(
    "prompt",
    ["A turntable turns at 180 degrees a second and carries a box.", "A turntable at 30 rpm carries a box",
     "A turntable turns at 180 deg/s and carries a box"],
)  # fmt: skip
def test_a_turntable_turns_at_the_rate_that_is_said(prompt):
    made = plan(prompt)
    box, disc = made.object("box"), made.object("turntable")
    assert disc.angular_velocity_deg == (0.0, 0.0, 180.0) and "warning" not in choices(made)
    assert math.pi**2 * math.hypot(*box.pose.position[:2]) < 0.4 * GRAVITY  # friction holds it


def test_a_mass_may_come_after_the_noun():
    assert plan("A crate of 20 kg slides").object("crate").mass == 20.0
    assert plan("a steel ball of 2 kg drops").object("steel_ball").mass == 2.0


def test_a_said_mass_is_told_as_a_density():
    told = choices(plan("A 2 kg block"))
    assert "357 kg/m^3 on average" in told and "wood of 600 kg/m^3" not in told


@pytest.mark.parametrize("load", ["a barrel", "a plant", "a mug", "a crate"])
@pytest.mark.parametrize("speed", ["0.8", "1", "2"])
def test_a_belt_is_as_long_as_its_load_goes(load, speed):
    assert plan(f"A conveyor at {speed} m/s carries {load}.").object("conveyor").size[0] > 3.0 * min(1.0, float(speed))


def test_no_speed_is_refused_with_what_would_do():
    with pytest.raises(UserError, match="0 m/s is not above 0 and up to 50 m/s"):
        plan("A ball rolls at 0 m/s")


def test_of_two_that_meet_each_rolls_or_slides_by_its_own_shape():
    for prompt in ("A red ball and a blue crate hit each other", "A blue crate and a red ball hit each other"):
        met = plan(prompt)
        ball, crate = (next(item for item in met.objects if name in item.name) for name in ("ball", "crate"))
        assert ball.rolling
        assert not crate.rolling
        assert ball.velocity[0] == -crate.velocity[0] != 0.0
