"""What is to knock a thing over comes as fast as that takes, hits it where it turns it away, and is said where not."""

import math

import pytest

from tests.rules.test_worlds import judged_world
from wsim.defaults import GRAVITY
from wsim.plan.schema import Material, PlanObject
from wsim.rules.planner import plan
from wsim.rules.scenes.knock import FASTEST, shoving_speed, tipping_speed


def weighing(mass, primitive, size):
    wood = Material(name="wood", density=600.0, friction=0.4)
    made = PlanObject.proxy(name=primitive, role="rigid_body", primitive=primitive, size=size, material=wood)
    return made.model_copy(update={"registration": made.registration.model_copy(update={"mass": mass})})


def block(mass, size):
    return weighing(mass, "box", size)


def ball(mass):
    return weighing(mass, "sphere", (0.1,))


@pytest.mark.parametrize("bounce", [0.0, 0.5])
def test_a_blow_with_the_speed_that_tips_just_lifts_the_middle_over_the_edge(bounce):
    """Of a bullet that weighs nothing beside the block: I w = m v (1 + e) z, and I w^2 / 2 is the lift's energy."""
    bullet, target, height = ball(1e-6), block(2.0, (0.1, 0.2, 0.4)), 0.3
    speed = tipping_speed(bullet, target, height, bounce)
    inertia = 2.0 * (0.1**2 + 0.4**2) / 3
    rate = 1e-6 * speed * (1 + bounce) * height / inertia
    assert inertia * rate**2 / 2 == pytest.approx(2.0 * GRAVITY * (math.hypot(0.05, 0.2) - 0.2), rel=1e-4)


def test_what_is_driven_from_under_a_stack_goes_half_its_depth_against_it():
    """With two above: mu g (2 + 3) stops it, mu g takes these along."""
    heavy, crate = ball(1e9), block(5.0, (0.4, 0.4, 0.4))
    speed = shoving_speed(heavy, crate, 2, 0.0)
    assert speed**2 / (2 * 0.4 * GRAVITY * (5 + 1)) == pytest.approx(0.2)
    assert shoving_speed(ball(5.0), crate, 2, 0.0) == pytest.approx(2 * speed)


@pytest.mark.parametrize(("what", "target"), [("bowling ball", "four crates"), ("steel ball", "three red cubes")])
def test_a_stack_that_is_to_fall_is_hit_fast_enough(what, target):
    made = plan(f"A {what} rolls into a stack of {target} and knocks it over.")
    (mover,) = (o for o in made.objects if any(o.velocity))
    below = min((o for o in made.objects if o.primitive == "box"), key=lambda o: o.pose.position[2])
    above = sum(o.primitive == "box" for o in made.objects) - 1
    assert 1.2 * shoving_speed(mover, below, above, 0.2) < mover.velocity[0] <= FASTEST
    assert not any("warning" in one.choice for one in made.assumptions)


@pytest.mark.parametrize(("speed", "warned"), [(2, True), (12, False)])
def test_a_speed_that_does_not_knock_it_over_is_warned_of(speed, warned):
    made = plan(f"A bowling ball rolls at {speed} m/s into a stack of four crates and knocks it over.")
    assert any(one.choice.startswith("warning") for one in made.assumptions) == warned
    assert any(one.kind == "topples" for one in made.objectives)


@pytest.mark.parametrize("what", ["A steel ball", "A bowling ball", "A small iron ball", "A barrel", "A big cylinder"])
def test_dominoes_are_hit_above_their_middle_and_more_slowly_than_they_fall(what):
    made = plan(f"{what} rolls into a row of six dominoes and they fall over.")
    (mover,) = (o for o in made.objects if any(o.velocity))
    height = made.object("domino_1").size[2]
    assert height / 2 < mover.size[0] < height
    assert 0.0 < mover.velocity[0] < math.sqrt(GRAVITY * height)


@pytest.mark.parametrize(
    "prompt",
    [
        "A bowling ball crashes into a tower of three crates and knocks it over",
        "A barrel rolls down a ramp into a row of three dominoes and knocks them over",
        "A wardrobe stands to the left of a stool",
    ],
)
def test_it_does(prompt, tmp_path):
    _, verdict = judged_world(prompt, tmp_path)
    assert verdict.status == "accepted", verdict.summary
