"""Accepted means right: what a sentence says of one thing is planned of that thing, or the sentence is refused."""

import math

import pytest
from pxr import Usd, UsdPhysics

from wsim.assets import load_catalogue
from wsim.defaults import GRAVITY
from wsim.errors import UserError
from wsim.plan.layout.bodies import around
from wsim.rules.lexicon import BALL, lexicon
from wsim.rules.planner import plan


def kinds(made, name):
    return [objective.kind for objective in made.objectives if objective.object == name]


def ops(made, name):
    return {node.op for o in made.objectives if o.object == name and o.formula is not None for node in o.formula.walk()}


# ---- on what moves
@pytest.mark.parametrize(
    "sentence",
    [
        "A crate slides down a ramp with a mug on it.",
        "A crate slides down a ramp while a brick lies on it, and a mug stands on the crate.",
        "A crate rides on a conveyor and a mug stands on it.",
        "A box rides on a turntable, and a book lies on the box.",
        "A turntable turns with a mug on it and a marble that rolls off.",
        "A rubber ball is dropped from 1 m onto a wooden table and then falls off it.",
        "A ball falls onto a desk and rolls off it.",
        "Three boxes drop onto a conveyor.",
        "A crate is dropped from 1 m onto a conveyor and falls off its end.",
    ],
)
def test_what_no_scene_builds_is_refused(sentence):
    with pytest.raises(UserError):
        plan(sentence)


def test_nothing_stands_on_a_ball_so_that_it_means_the_ramp():
    made = plan("A ball rolls down a ramp and a brick rests on it.")
    assert "rolls_down" in kinds(made, "ball") and "stays_within" in ops(made, "brick")


# ---- one of a row
@pytest.mark.parametrize(
    "sentence",
    [
        "The last of ten dominoes in a row falls off the table.",
        "A row of dominoes on a table: the last falls off the edge.",
        "Ten dominoes stand in a row: the second is pushed.",
        "Ten dominoes stand in a row: the first slides at 1 m/s.",
        "Ten dominoes stand in a row and the last is hit by a ball.",
        "A steel ball hits the last of ten dominoes.",
    ],
)
def test_one_of_a_row_is_not_all_of_it(sentence):
    with pytest.raises(UserError):
        plan(sentence)


@pytest.mark.parametrize("cause", ["is pushed", "is knocked over", "is pushed over", "is tipped over", "falls over"])
@pytest.mark.parametrize("count", ["Six", "Twelve"])
def test_the_first_of_a_row_alone_is_set_going_and_the_last_falls(count, cause):
    made = plan(f"{count} dominoes stand in a row; the first {cause} and the last falls.")
    going = [item.name for item in made.objects if any(item.velocity)]
    last = max((item.name for item in made.objects if "domino" in item.name), key=lambda name: int(name.split("_")[1]))
    assert going == ["domino_1"] and kinds(made, last) == ["topples"]


# ---- in water
@pytest.mark.parametrize(
    "sentence",
    [
        "A stone lies on the bottom of a tank of water.",
        "A pine log floats in a tank of water while a stone, which weighs 2 kg, lies on the bottom.",
        "A cork floats in a tank of water and a stone lies on the bottom of it.",
        "A stone rests at the bottom of an aquarium.",
    ],
)
def test_what_lies_on_the_bottom_does_not_float(sentence):
    assert kinds(plan(sentence), "stone") == ["rests_on"]


# ---- off a ramp
@pytest.mark.parametrize("thing", ["A crate", "A steel block"])
@pytest.mark.parametrize(("wall", "name"), [("the wall", "wall"), ("a post", "post")])
def test_what_stops_before_a_thing_at_a_ramps_foot_has_room_to(thing, wall, name):
    made = plan(f"{thing} slides down a ramp and stops before {wall}.")
    item = made.object(thing.split(" ", 1)[1].replace(" ", "_"))
    ramp = made.object("ramp")
    turn, friction = math.radians(ramp.pose.rotation_deg[1]), 0.4  # wood and steel
    speed = math.sqrt(2 * GRAVITY * (math.sin(turn) - friction * math.cos(turn)) * ramp.size[0])
    room = around(made.object(name)).low[0] - around(ramp).high[0] - item.size[0]
    assert room > speed**2 / (2 * friction * GRAVITY)
    assert "stops_before" in ops(made, item.name) and "collides_with" not in kinds(made, item.name)


def test_what_comes_to_rest_against_a_post_is_asked_to():
    assert "settles" in kinds(plan("A log rolls down a ramp and comes to rest against a post."), "log")


# ---- off a table, and of what balls are
@pytest.mark.parametrize(("ball", "restitution"), [("tennis ball", 0.745), ("basketball", 0.85)])
def test_what_bounces_after_a_table_does_so_off_the_ground(ball, restitution):
    made = plan(f"A {ball} falls off the edge of a table and bounces on the ground.")
    (formula,) = (o.formula for o in made.objectives if o.formula is not None)
    item = made.object(formula.object)
    assert (formula.op, formula.ref, formula.restitution) == ("collides_with", "ground", restitution)
    assert around(item).low[2] == pytest.approx(around(made.object("table")).high[2], abs=1e-3)


@pytest.mark.parametrize(
    ("words", "material"),
    [("tennis ball", "felt"), ("billiard ball", "resin"), ("bowling ball", "urethane"), ("anvil", "steel")],
)
def test_a_thing_is_of_what_its_name_says(words, material):
    made = plan(f"A {words} is dropped from 0.5 m.")
    assert any(one.choice == f"of {material}" for one in made.assumptions)


@pytest.mark.parametrize("id", sorted(one.id for one in load_catalogue().values() if one.category == BALL))
def test_a_ball_bounces_and_rubs_as_the_catalogue_s_does(id):
    """What stands for it has the surface that the asset states, which is that of its sport's rules."""
    noun = lexicon().nouns[id]
    stage = Usd.Stage.Open(str(load_catalogue()[id].path))
    [(friction, restitution)] = {
        (api.GetDynamicFrictionAttr().Get(), api.GetRestitutionAttr().Get())
        for prim in stage.Traverse()
        if prim.HasAPI(UsdPhysics.MaterialAPI)
        for api in [UsdPhysics.MaterialAPI(prim)]
    }
    material = lexicon().materials[noun.material]
    assert (material.friction, material.restitution) == pytest.approx((friction, restitution), abs=0.005)
    volume = 4 / 3 * math.pi * noun.size[0] ** 3
    assert material.density * volume == pytest.approx(noun.mass, rel=0.02)


# ---- what a table has
@pytest.mark.parametrize(
    ("sentence", "above", "beside"),
    [
        ("A desk with a monitor, a keyboard in front of it and a mouse.", ["monitor", "keyboard", "mouse"], []),
        ("A table with a mug and a chair.", ["mug"], ["chair"]),
        ("A wall with a crate.", [], ["crate"]),
        ("A shelf with a box in front of it.", [], ["box"]),
    ],
)
def test_what_a_table_has_is_on_it(sentence, above, beside):
    made = plan(sentence)
    table = made.object(sentence.split()[1])
    for names, low in ((above, around(table).high[2]), (beside, 0.0)):
        assert [around(made.object(name)).low[2] for name in names] == pytest.approx([low] * len(names), abs=1e-3)
    if "keyboard" in above:
        assert around(made.object("keyboard")).low[0] >= around(made.object("monitor")).high[0]


# ---- what hangs above a table
@pytest.mark.parametrize(
    ("sentence", "length", "clear"),
    [
        ("A lamp hangs from the ceiling above a table.", 0.6, 0.3),
        ("A lamp hangs from the ceiling above a table on a chain 1 m long.", 1.0, 0.3),
        ("A lamp hangs on a chain 0.5 m above a table.", 0.6, 0.5),
        ("A lamp hangs above a table on a rope, and a ball rolls.", 0.6, 0.3),
    ],
)
def test_what_hangs_above_a_table_is_above_it(sentence, length, clear):
    made = plan(sentence)
    lamp, table = (around(made.object(name)) for name in ("lamp", "table"))
    assert [sum(ends) / 2 for ends in zip(lamp.low[:2], lamp.high[:2], strict=True)] == pytest.approx(
        [sum(ends) / 2 for ends in zip(table.low[:2], table.high[:2], strict=True)], abs=1e-6
    )
    assert lamp.low[2] - table.high[2] == pytest.approx(clear, abs=1e-6)
    (rope,) = made.cords
    assert (rope.kind, rope.b) == ("rope", "lamp") and rope.length == pytest.approx(length, abs=1e-6)
    assert rope.anchor_a[2] - lamp.high[2] == pytest.approx(length, abs=1e-6)


@pytest.mark.parametrize(
    "sentence",
    [
        "Two lamps hang from the ceiling above a table.",
        "A lamp hangs from the ceiling above a table with a vase on it.",
        "A lamp hangs from the ceiling above a ball.",
    ],
)
def test_what_hangs_where_it_would_touch_is_refused(sentence):
    with pytest.raises(UserError):
        plan(sentence)


# ---- which thing is meant
@pytest.mark.parametrize("which", [", which topples", " that topples", ", and it topples", ", which falls over"])
def test_which_is_what_was_named_last(which):
    made = plan(f"A steel ball hits a tower of six bricks{which}.")
    assert kinds(made, "brick_6") == ["topples"]


def test_which_is_at_rest_is_what_is_hit():
    made = plan("A red ball hits a blue ball, which is at rest.")
    assert any(made.object("red_ball").velocity) and not any(made.object("blue_ball").velocity)


def test_which_is_2_m_long_is_the_ramp():
    made = plan("A crate slides down a ramp, which is 2 m long.")
    assert made.object("ramp").size[0] == 2.0 and made.object("crate").size[0] < 1.0


@pytest.mark.parametrize("agent", ["a steel ball", "a wooden ball"])
def test_a_thing_is_hit_by_another(agent):
    made = plan(f"A block is hit by {agent}.")
    name = agent.split(" ", 1)[1].replace(" ", "_")
    assert kinds(made, name) == ["collides_with"] and any(made.object(name).velocity)


@pytest.mark.parametrize("lead", ["There is a ramp and", "There is a ramp.", "A ramp stands on the ground, and"])
def test_what_a_ball_rolls_down_is_the_ramp(lead):
    made = plan(f"{lead} {'A' if lead.endswith('.') else 'a'} ball rolls down it.")
    assert kinds(made, "ball") == ["rolls_down"]


# ---- what the README says it knows
@pytest.mark.parametrize(
    "sentence",
    [
        "A Polaris leaves a dock, crosses a floating pontoon and reaches the opposite dock.",
        "A robot patrols round an office.",
        "An HMMWV drives 100 m over rough ground, with rocks and trees beside its way.",
    ],
)
def test_phrases_of_the_readme(sentence):
    assert plan(sentence).objectives


# ---- a seesaw
@pytest.mark.parametrize(
    "sentence",
    [
        "A ball falls on one end of a seesaw, and the cube on the other end goes up.",
        "A ball drops onto the left end of a seesaw and a box of 10 kg on the right end goes up.",
        "A ball of 2 kg falls on one end of a seesaw, and a box on the other end goes up.",
        "A cube stands on the left end of a seesaw and a ball on the right end, and the seesaw tilts to the right.",
    ],
)
def test_what_goes_down_outweighs_what_goes_up(sentence):
    made = plan(sentence)
    (tilts,) = (objective for objective in made.objectives if objective.kind == "tilts")
    low = made.object(tilts.ref)
    (high,) = (o for o in made.objects if o.state == "dynamic" and o.name not in ("seesaw", low.name))
    assert low.mass >= 1.2 * high.mass
    assert not any("warning" in one.choice for one in made.assumptions)


def test_what_cannot_outweigh_the_other_end_is_warned_of():
    made = plan("A cork ball falls on one end of a seesaw and an iron cube on the other end goes up.")
    assert made.object("cork_ball").mass == pytest.approx(4 / 3 * math.pi * 0.1**3 * 240)  # as it was said
    assert any(one.choice.startswith("warning") for one in made.assumptions)


# ---- it and they
def test_what_a_ball_rolls_along_is_the_table():
    made = plan("A mug stands on a table, and a ball rolls along it.")
    assert around(made.object("ball")).low[2] == pytest.approx(around(made.object("table")).high[2], abs=1e-3)


def test_they_are_what_is_several():
    made = plan("A conveyor carries two boxes and they fall off its end.")
    assert all("collides_with" in kinds(made, name) for name in ("box_1", "box_2"))


# ---- nothing is dropped
@pytest.mark.parametrize(
    ("sentence", "words"),
    [
        ("A ball rolls down a ramp 2 m long, off a table and into a bucket.", "a ball"),
        ("A ball rolls down a ramp and off a table.", "a ball"),
        ("A ball rolls off a ramp, off a table and into a bucket.", "a ball"),
        ("A ball rolls off the table and lands behind a box.", "behind a box"),
        ("A cube slides and stops behind a box.", "behind a box"),
        ("A ball rolls under a table.", "under a table"),
        ("A wooden plank floats on the water and a steel cube lies on it.", "on it"),
        ("A ball hangs on a rope 1 m long and is hit by another ball.", "another ball"),
        ("Three balls hang side by side from the ceiling; the first swings into the second.", "three balls"),
        ("A cube with a ball on it slides down a ramp.", "a ball"),
        ("A ball drops into a bucket that stands on a table, and then a cube.", "a cube"),
        ("A ball rolls and a cube.", "a cube"),
        ("A red ball rolls and then a blue ball rolls.", "then a blue ball"),
        ("A ball drops into a box.", "into a box"),
        ("A ball stands to the right of a box and rolls to the left.", "a box"),
        ("A cube slides for 2 seconds at 20 m/s.", "2 s"),
        ("A ball rolls down a ramp to the left.", "to the left"),
        ("A box with a mug on it is pushed to the left.", "a mug"),
        ("A ball falls on a ramp, rolls down and hits a wall.", "a ball"),
        ("A block slides on ice and hits two balls.", "two balls"),
        ("A pillar topples onto a box.", "onto a box"),
        ("A steel ball sinks and then a cork floats.", "then a cork"),
        ("A ball rolls down a ramp and hits a box that lies on a table.", "a ball"),
        ("A cube that lies on a ramp is hit by a ball.", "a ball"),
        ("Four blocks are stacked on a table and four on the ground.", "four"),
        ("A ball next to a box is pushed to the right.", "a box"),
        ("There is a ramp. A ball rolls down it. At its end there is a box.", "at its end"),
        ("A ball falls onto the ground and rolls to the left.", "a ball"),
        ("A heavy ball knocks over the 2 kg platform.", "platform"),
        ("All of the balls sink: three balls are dropped into a tank.", "three balls"),
        ("A mug stands on a shelf above a table.", "above a table"),
        ("A ball drops on a platform that stands on a table.", "platform"),
        ("Two small balls on a rope drop.", "drop"),
    ],
)
def test_what_would_be_lost_is_refused_by_its_words(sentence, words):
    with pytest.raises(UserError) as refused:
        plan(sentence)
    assert words in str(refused.value)
    assert len(str(refused.value).splitlines()) <= 3


@pytest.mark.parametrize(
    ("sentence", "sinks", "floats"),
    [
        ("Only one of three balls sinks.", 1, 2),
        ("Two of three blocks float on the water.", 1, 2),
        ("Three boxes fall into a tank and two of them float.", 1, 2),
        ("A tank of water with four balls; one of them sinks.", 1, 3),
    ],
)
def test_the_others_do_the_other(sentence, sinks, floats):
    made = plan(sentence)
    asked = [o.kind for o in made.objectives if o.ref in ("tank", "water") and o.object != "water"]
    assert asked.count("rests_on") == sinks and asked.count("floats") == floats
    names = {o.object for o in made.objectives if o.kind == ("floats" if "float" in sentence else "rests_on")}
    verb = next(clause for clause in made.clauses if clause.words in ("sinks", "float"))
    assert {made.objectives[k].object for k in verb.objectives} == names


@pytest.mark.parametrize("noun", ["ball rolls", "cube slides"])
def test_what_goes_apart_starts_apart_and_is_asked_to(noun):
    made = plan(f"A red {noun} to the left and a blue {noun} to the right.")
    thing = noun.split()[0]
    red, blue = made.object(f"red_{thing}"), made.object(f"blue_{thing}")
    assert red.pose.position[1] > blue.pose.position[1] and red.velocity[1] > 0.0 > blue.velocity[1]
    ways = {o.object: o.direction for o in made.objectives if o.kind == "moves"}
    assert ways == {red.name: "left", blue.name: "right"}


@pytest.mark.parametrize(
    ("words", "axis", "sign", "gap"),
    [
        ("2 m in front of", 0, 1, 2.0),
        ("1 m behind", 0, -1, 1.0),
        ("30 cm to the left of", 1, 1, 0.3),
        ("40 cm to the right of", 1, -1, 0.4),
    ],
)
def test_a_distance_before_a_side_is_no_height(words, axis, sign, gap):
    made = plan(f"A ball is dropped {words} a box.")
    ball, box = around(made.object("ball")), around(made.object("box"))
    apart = ball.low[axis] - box.high[axis] if sign > 0 else box.low[axis] - ball.high[axis]
    assert apart == pytest.approx(gap, abs=1e-3) and ball.low[2] == pytest.approx(0.5)


def test_a_fall_for_a_time_is_from_as_high():
    assert around(plan("A ball falls for 0.5 seconds.").object("ball")).low[2] == pytest.approx(GRAVITY / 8, abs=1e-3)


def test_what_slides_for_a_time_starts_as_fast():
    made = plan("A cube slides across the ground for 2 seconds and stops.")
    assert made.object("cube").velocity[0] == pytest.approx(0.4 * GRAVITY * 2.0, abs=0.01)
    assert made.simulation.duration > 2.0 and {"eventually", "speed_between"} <= ops(made, "cube")


def test_what_a_conveyor_is_with_rides_on_it():
    made = plan("A conveyor with two crates runs at 0.3 m/s.")
    belt = made.object("conveyor")
    assert belt.surface_velocity == (0.3, 0.0, 0.0)
    for name in ("crate_1", "crate_2"):
        assert around(made.object(name)).low[2] == pytest.approx(around(belt).high[2], abs=0.002)


def test_each_turntable_has_its_own():
    made = plan("Two turntables turn at 30 rpm, one with a cube and the other with a mug.")
    for name, table in (("cube", "turntable"), ("mug", "turntable_1")):
        assert ("stays_on", table) in [(o.kind, o.ref) for o in made.objectives if o.object == name]


def test_a_clause_of_a_thing_on_which_another_falls_is_its_own():
    made = plan("A ball drops into a bucket that stands on a table.")
    assert around(made.object("bucket")).low[2] == pytest.approx(around(made.object("table")).high[2])
    made = plan("A cube falls beside the ball that lies on a table.")
    assert around(made.object("cube")).low[2] > around(made.object("table")).high[2]
    assert [clause.by for clause in made.clauses if clause.words == "lies"] == [["ball"]]


@pytest.mark.parametrize(
    ("sentence", "verb", "name"),
    [
        ("A ball drops on a box from a height of 50 cm.", "drops", "ball"),
        ("A cube falls on the ball that lies on a table.", "falls", "cube"),
        ("A ball falls on the left end of a seesaw and a cube on the right end flies up.", "flies", "cube"),
        ("A tennis ball is dropped into a pot on a workbench.", "dropped", "tennis_ball"),
    ],
)
def test_a_verb_is_tied_to_what_it_is_said_of(sentence, verb, name):
    made = plan(sentence)
    (clause,) = (clause for clause in made.clauses if clause.words == verb)
    assert clause.objectives and {made.objectives[k].object for k in clause.objectives} <= {name, "seesaw"}
    assert all(name in str(made.objectives[k]) for k in clause.objectives)


def test_what_falls_then_is_let_go_later():
    made = plan("A red ball drops and then a blue ball drops.")
    (release,) = made.schedules
    assert release.of == "blue_ball_held" and release.times == (1.0,)


def test_what_comes_of_a_motion_is_no_name_alone():
    made = plan("A ball bounces to 36 % of its height and then rests.")
    assert [clause.by for clause in made.clauses if clause.words == "rests"] == [None]


def test_a_verb_of_two_is_tied_to_what_is_asked_of_each():
    made = plan("A heavy and a light ball drop from 1 m.")
    (clause,) = (clause for clause in made.clauses if clause.words == "drop")
    assert {made.objectives[k].object for k in clause.objectives} == {"ball", "ball_1"}
