"""What a prompt asks of how things go on, in the ways that people say it: each becomes a formula of the language."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wsim.errors import UserError
from wsim.judge.language import parse
from wsim.plan.schema.formula import Eventually
from wsim.rules.planner import plan

SLIDERS = st.sampled_from(["A crate", "A wooden block", "A box of 20 kg"])
WALLS = st.sampled_from(["a wall", "a barrel", "a steel cube", "a table"])
BALLS = st.sampled_from(["A rubber ball", "A steel ball with a restitution of 0.7"])
NAMES = {"A crate": "crate", "A wooden block": "wooden_block", "A box of 20 kg": "box", "a wall": "wall",
         "a barrel": "barrel", "a steel cube": "steel_cube", "a table": "table", "A rubber ball": "rubber_ball",
         "A steel ball with a restitution of 0.7": "steel_ball"}  # fmt: skip
SHARES = st.sampled_from([5, 20, 35])


@st.composite
def stories(draw):
    """A sentence, and the formula that its plan must have."""
    slider, wall, ball, share = draw(SLIDERS), draw(WALLS), draw(BALLS), draw(SHARES)
    speed = draw(st.sampled_from(["", " at 2 m/s", " at 1.5 m/s"]))
    before = draw(st.sampled_from(["before", "short of"]))
    stop = draw(st.sampled_from(["stops", "comes to a stop"]))
    dies, percent = draw(st.sampled_from(["dies down", "dies away"])), draw(st.sampled_from(["%", " %", " percent"]))
    up, of = draw(st.sampled_from(["comes up", "climbs", "rises"])), draw(st.sampled_from(["", " of its height"]))
    level, angle, rate = draw(st.sampled_from([3, 4, 5])), draw(st.sampled_from([3, 6, 8])), draw(st.integers(10, 40))
    rpm = draw(st.sampled_from(["rpm", "revolutions per minute"]))
    vessel = draw(st.sampled_from(["tank", "bucket"]))
    who, ref, it = NAMES[slider], NAMES[wall], NAMES[ball]
    asks = {
        f"{slider} slides{speed} and {stop} {before} {wall}": f"stops_before({who}, {ref})",
        f"{slider} slides{speed} towards {wall} and {stop} {before} it": f"stops_before({who}, {ref})",
        f"{slider} {stop} {before} {wall}": f"stops_before({who}, {ref})",
        f"{ball} bounces and {dies}": f"dies_down({it}, z)",
        f"{ball} drops from 0.6 m, bounces and {dies}": f"dies_down({it}, z)",
        f"{ball} bounces to {share}{percent}{of}": f"climbs_to({it}, {share} %)",
        f"{ball} bounces and {up} to {share}{percent}{of}": f"climbs_to({it}, {share} %)",
        f"A pendulum swings from 30 degrees and {dies}": "dies_down(pendulum, x)",
        f"A pendulum swings and {up} to {share + 60}{percent}{of}": f"climbs_to(pendulum, {share + 60} %)",
        f"{slider} falls onto a seesaw and the seesaw tilts by {angle} degrees":
            f"eventually(tilt_between(seesaw, x, {angle}, 90))",
        f"{slider} drops on a seesaw. The seesaw tilts by at least {angle} degrees":
            f"eventually(tilt_between(seesaw, x, {angle}, 90))",
        f"A turntable turns at {rate} {rpm}": f"own_spin_between(turntable, z, {5.7 * rate}, {6.3 * rate})",
        f"Water pours into a {vessel} up to {level} cm": f"level_in(water, {vessel}, {level} cm)",
        f"Water is poured into a {vessel} up to a level of {level} cm": f"level_in(water, {vessel}, {level} cm)",
    }  # fmt: skip
    said = draw(st.sampled_from(sorted(asks)))
    return f"{said}{draw(st.sampled_from(['.', '']))}", asks[said]


@settings(max_examples=80, deadline=None)
@given(stories())
def test_what_is_said_of_how_it_goes_on_is_asked(story):
    prompt, said = story
    made = plan(prompt)
    wanted = parse(said)
    formulas = [objective.formula for objective in made.objectives if objective.formula is not None]
    near = [formula for formula in formulas if _same(formula, wanted)]
    assert near, (prompt, said, formulas)
    assert not any(one.choice.startswith("warning") for one in made.assumptions)


def _same(one, other):
    """Whether two formulas are of one kind and names, and their numbers as near as a plan rounds them."""
    if isinstance(one, Eventually) and isinstance(other, Eventually):
        one, other = one.of, other.of
    a, b = one.model_dump(), other.model_dump()
    return a.keys() == b.keys() and all(
        math.isclose(a[key], b[key], rel_tol=1e-3) if isinstance(a[key], float) else a[key] == b[key] for key in a
    )


def test_what_stops_before_a_wall_starts_far_enough_from_it():
    """v^2 / (2 mu g) of 2 m/s and 0.5 is 0.41 m: it starts farther off, and not much."""
    made = plan("A crate slides at 2 m/s on the ground with a friction of 0.5 and stops before a wall")
    crate, wall = made.object("crate"), made.object("wall")
    gap = wall.pose.position[0] - crate.pose.position[0] - (wall.size[0] + crate.size[0]) / 2
    assert 0.41 < gap < 0.65
    assert not any(objective.kind == "collides_with" for objective in made.objectives)


def test_what_dies_down_on_a_hinge_is_damped_and_nothing_else_is():
    damped, free = (plan(f"A pendulum swings{more}") for more in (" and dies down", ""))
    assert damped.joints[0].drive.damping > 0.0 and free.joints[0].drive is None


@pytest.mark.parametrize(
    ("prompt", "why"),
    [
        ("A seesaw tilts by 5 degrees", "nothing is on it"),
        ("A crate falls onto a seesaw and the seesaw tilts by 30 degrees", "below 9"),
        ("A crate climbs to 50 %", "swings or bounces"),
        ("A ball rolls and stops before a wall", "that slides stop before another"),
        ("A crate slides without friction and stops before a wall", "does not know"),
        ("A crate slides with a friction of 0 and stops before a wall", "never stops"),
        ("Water pours into a tank up to 50 cm", "splashes"),
    ],
)
def test_what_cannot_come_true_so_is_refused(prompt, why):
    with pytest.raises(UserError, match=why):
        plan(prompt)


def test_what_physics_contradicts_is_planned_with_a_warning():
    made = plan("A rubber ball bounces to 90 % of its height")
    assert any("warning: it comes up to 36%" in one.choice for one in made.assumptions)
