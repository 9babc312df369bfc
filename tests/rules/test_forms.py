"""A sentence says the same in whatever form it is put: commanded, turned round, listed after a colon, with a motor."""

import pytest

from wsim.errors import UserError
from wsim.rules.planner import plan


def built(sentence):
    """What a plan builds and asks, without the words that it came from."""
    made = plan(sentence)
    things = [(o.primitive, o.size, o.material and o.material.name, o.pose, o.velocity, o.mass) for o in made.objects]
    asked = [(o.kind, o.object, o.ref, o.value, o.formula) for o in made.objectives]
    return things, asked, made.schedules, made.joints, made.cords, made.simulation


@pytest.mark.parametrize(
    ("sentence", "plain"),
    [
        # commands
        ("Drop a steel ball onto a wooden table.", "A steel ball is dropped onto a wooden table."),
        ("Roll a ball down a ramp.", "A ball rolls down a ramp."),
        ("Push a crate across the floor.", "A crate is pushed across the floor."),
        ("Stack three boxes on a table.", "Three boxes are stacked on a table."),
        ("Throw a brick at a stack of boxes.", "A brick is thrown at a stack of boxes."),
        ("Tip the first of five dominoes over.", "The first of five dominoes is tipped over."),
        ("Knock a tower of four bricks over with a ball.", "A tower of four bricks is knocked over by a ball."),
        ("Place a brick on a table and push it off the edge.", "A brick is on a table and is pushed off the edge."),
        ("Drive a buggy 50 m over rough ground.", "A buggy drives 50 m over rough ground."),
        ("Someone pushes a mug off the desk.", "A mug is pushed off the desk."),
        ("A motor turns a turntable at 30 rpm.", "A turntable turns at 30 rpm."),
        ("Let a marble fall into a bucket of water.", "A marble falls into a bucket of water."),
        ("Show me how a ball bounces.", "A ball bounces."),
        ("Please build a tower of six cubes.", "A tower of six cubes."),
        # the place first
        ("On a table stands a lamp, and beside it a mug.", "A lamp stands on a table, and a mug stands beside it."),
        ("In a tank of water, a cork floats.", "A cork floats in a tank of water."),
        ("On the ground there are three barrels in a row.", "Three barrels stand in a row on the ground."),
        ("There's a ball on a table.", "A ball is on a table."),
        ("There is a table and a laptop on it.", "A laptop is on a table."),
        ("A laptop on a desk and a chair stands behind it.", "A laptop is on a desk; a chair stands behind the desk."),
        # lists, and what is said of some of them
        ("Two things fall: a ball and a brick.", "A ball and a brick fall."),
        ("Two crates: a small one and a red one.", "A small crate and a red crate."),
        ("Two blocks float in water, one red and the other blue.", "A red block and a blue block float in water."),
        ("A red and a blue ball are dropped.", "A red ball and a blue ball are dropped."),
        ("Only the cork floats; the steel ball sinks.", "The cork floats; the steel ball sinks."),
        ("In a tank are a cork and a stone. Only the cork floats.", "A cork floats and a stone sinks in a tank."),
        # small words
        ("A box was hit by a ball.", "A box is hit by a ball."),
        ("A stack of boxes gets knocked over by a ball.", "A stack of boxes is knocked over by a ball."),
        ("A pair of balls collide.", "Two balls collide."),
        ("A domino row topples.", "A row of dominoes topples."),
        ("A crate on a ramp doesn't slide.", "A crate on a ramp stays there."),
        ("A seesaw has 2 kg on its left end.", "A seesaw with a 2 kg weight on its left end."),
        ("A steel ball of 10 cm diameter falls.", "A steel ball with a diameter of 10 cm falls."),
        ("Water pours into a tank until it is 5 cm deep.", "Water pours into a tank up to 5 cm."),
    ],
)
def test_it_says_the_same(sentence, plain):
    assert built(sentence) == built(plain)


@pytest.mark.parametrize(
    "sentence",
    [
        "Falls a ball.",
        "Three things fall: a ball and a box.",  # how many?
        "Five things fall.",  # which?
        "A motor pushes a crate.",
        "Fill a bucket.",
        "Only the ball rolls.",
        "A ball does not bounce.",
        "Two balls hang on ropes and collide.",
        "Someone rolls.",
        "A ball rolls slowly down a ramp.",
        "A pendulum swings after two seconds.",
        "A ball is pushed with 5 N.",
        "After two seconds a crate.",
        "A ball is thrown at 1 m/s over a wall that is 2 m high.",
        "A mug, a mug and a mug stand in a bowl.",
        "Throw a ball over a ball.",
    ],
)
def test_what_it_would_lose_is_refused(sentence):
    with pytest.raises(UserError):
        plan(sentence)


def test_only_one_of_three_floats():
    """The others are asked to sink, and are of what does."""
    ends = [objective.kind for objective in plan("Only one of the three balls floats.").objectives]
    assert ends == ["floats", "rests_on", "rests_on", "stays_inside"]


def test_to_the_right_of_it_is_of_what_the_first_is_left_of():
    made = plan("To the left of a barrel there's a crate, and to the right of it a pillar.")
    assert [(row.predicate, row.ref) for row in made.object("pillar").relations][1] == ("RIGHT-OF", "barrel")
