"""Pushed with a force, let go later, hung on a rope, thrown over a wall, put into a vessel: each as theory has it."""

import math

import numpy as np
import pytest

from wsim.defaults import GRAVITY
from wsim.errors import UserError
from wsim.plan.layout.bodies import around
from wsim.rules.planner import plan


# ---- forces and times
@pytest.mark.parametrize(("force", "lasts", "start"), [(40.0, 2.0, 0.0), (60.0, 1.0, 2.0), (30.0, 0.5, 1.0)])
def test_a_force_moves_a_crate_as_far_as_newton_says(force, lasts, start):
    """From rest at a = F / m - mu g for the time, then v^2 / 2 mu g."""
    when = f"After {start:g} seconds a" if start else "A"
    made = plan(f"{when} crate is pushed with {force:g} N for {lasts:g} seconds.")
    crate = made.object("crate")
    (schedule,) = made.schedules
    assert (schedule.of, schedule.quantity, schedule.times) == ("crate", "force", (start, start + lasts))
    assert schedule.values == ((force, 0.0, 0.0), (0.0, 0.0, 0.0)) and not any(crate.velocity)
    brake = min(crate.material.friction, 0.7) * GRAVITY
    gain = force / crate.mass - brake
    way = gain * lasts**2 / 2 + (gain * lasts) ** 2 / (2 * brake)
    (objective,) = made.objectives
    assert objective.kind == "moves" and objective.value == pytest.approx(0.9 * way, abs=1e-3)
    assert made.simulation.duration > start + lasts + gain * lasts / brake


def test_a_force_that_friction_holds_is_warned_of():
    made = plan("A crate is pushed with 5 N for two seconds.")
    assert any("warning: it stays" in one.choice for one in made.assumptions)


@pytest.mark.parametrize(
    "sentence",
    ["A ball is dropped after two seconds.", "After two seconds a ball is released on a ramp.",
     "After two seconds a ball is dropped into a tank of water."],
)  # fmt: skip
def test_what_is_let_go_later_is_held_until_then(sentence):
    made = plan(sentence)
    (joint,), (schedule,) = made.joints, made.schedules
    assert (joint.kind, joint.child, joint.parent) == ("fixed", "ball", None)
    assert (schedule.of, schedule.quantity, schedule.times) == (joint.name, "release", (2.0,))
    assert made.simulation.duration > 2.0 + 1.0


# ---- ropes
@pytest.mark.parametrize(("thing", "rope"), [("ball", 1.0), ("crate", 0.6), ("steel cylinder", 0.8)])
def test_what_swings_on_a_rope_has_the_slower_mode_s_period(thing, rope):
    """Against the eigenvalues of the two coupled equations, K x = w^2 M x."""
    made = plan(f"A {thing} hangs on a rope of {rope:g} m and swings from 5 degrees.")
    (cord,) = made.cords
    body = made.object(cord.b)
    top = math.dist(cord.anchor_b, body.pose.position)
    assert cord.kind == "rope" and math.dist(cord.anchor_a, cord.anchor_b) == pytest.approx(rope, abs=1e-5)
    half = [max(body.size[0], body.size[-1] / 2)] if body.primitive == "sphere" else [body.size[-1] / 2]
    assert top == pytest.approx(half[0], abs=1e-5)
    about = {
        "sphere": 0.4 * body.size[0] ** 2,
        "box": (body.size[0] ** 2 + body.size[-1] ** 2) / 12,
        "cylinder": body.size[0] ** 2 / 4 + body.size[-1] ** 2 / 12,
    }[body.primitive]
    inertia = np.array([[rope**2, rope * top], [rope * top, top**2 + about]])
    slow = min(np.linalg.eigvals(np.linalg.solve(inertia, GRAVITY * np.diag([rope, top]))).real)
    period = next(o.formula.period for o in made.objectives if o.formula is not None and o.formula.op == "swings")
    assert period == pytest.approx(2 * math.pi / math.sqrt(slow), rel=1e-3)


# ---- over a wall
@pytest.mark.parametrize("wall", ["a wall", "a wall of 1.5 m", "a wall that is 2 m high", "a post"])
def test_a_throw_over_a_wall_clears_it(wall):
    made = plan(f"A ball is thrown over {wall}.")
    ball, over = made.object("ball"), around(made.object(wall.split()[1]))
    (x, _, z), (along, _, up) = ball.pose.position, ball.velocity
    for edge in (over.low[0] - ball.size[0], over.high[0] + ball.size[0]):
        time = (edge - x) / along
        assert time > 0.0 and z + up * time - GRAVITY * time**2 / 2 - ball.size[0] > over.high[2] + 0.1
    assert {"never_touches"} <= {o.formula.op for o in made.objectives if o.formula is not None}


# ---- into vessels
@pytest.mark.parametrize("count", range(2, 10))
@pytest.mark.parametrize("vessel", ["bucket", "bowl", "bin"])
def test_several_in_a_vessel_are_apart_and_over_its_mouth(count, vessel):
    made = plan(f"{count} balls are dropped into a {vessel}.")
    balls = [one for one in made.objects if one.primitive == "sphere"]
    places = np.array([one.pose.position for one in balls])
    apart = [np.linalg.norm(a - b) for i, a in enumerate(places) for b in places[:i]]
    assert len(balls) == count and min(apart) > 2 * balls[0].size[0]
    mouth = next(one for one in made.objects if one.name not in {b.name for b in balls} and one.name != "ground")
    room = min(high - low for low, high in zip(around(mouth).low[:2], around(mouth).high[:2], strict=True)) / 2
    middle = np.array(mouth.pose.position[:2])
    assert max(np.linalg.norm(places[:, :2] - middle, axis=1)) + balls[0].size[0] < room


def test_what_does_not_go_into_a_vessel_is_refused():
    with pytest.raises(UserError, match="fit"):
        plan("Two mugs lie in a bowl.")
