"""What the builtin planner makes of prompts, exactly; and what it refuses, by name."""

import math
import subprocess
import sys
import tomllib
from pathlib import Path
from random import Random

import pytest

from wsim.assets import load_catalogue
from wsim.defaults import WALL
from wsim.errors import UserError
from wsim.rules.grammar import NotUnderstood
from wsim.rules.lexicon import lexicon
from wsim.rules.planner import plan

PROMPTS = tomllib.loads((Path(__file__).parent / "prompts.toml").read_text(encoding="utf-8"))["prompt"]


@pytest.mark.parametrize("expected", PROMPTS, ids=lambda expected: expected["says"])
def test_what_a_prompt_becomes(expected):
    made = plan(expected["says"])
    assert [
        [o.name, o.role, o.primitive, o.material.name if o.material else ""] for o in made.objects if o.name != "ground"
    ] == expected["objects"]
    rows = [[o.name, row.predicate, row.ref or ""] for o in made.objects for row in o.relations]
    assert rows == expected["relations"]
    assert [[o.kind, o.object, o.ref or ""] for o in made.objectives] == expected["objectives"]
    joints = [[j.name, j.kind, j.child, j.parent or ""] for j in made.joints]
    assert joints == expected.get("joints", [])
    assert all(
        o.pose is not None for o in made.objects if o.name != "ground" and not (o.role == "fluid" and not o.size)
    )
    assert made.steps[0].title == "ground" and made.steps[-1].title == "cameras"
    assert {name for step in made.steps for name in step.objects} == {o.name for o in made.objects}
    assert made.assumptions and plan(expected["says"]) == made


@pytest.mark.parametrize(
    ("prompt", "words"),
    [
        ("A giraffe stands on a table", ["giraffe"]),
        ("A ball and a trampoline", ["trampoline"]),
        ("A giant pushes a box", ["giant"]),
        ("A robot pushes a box", ["a robot pushes a box"]),
        ("A robot stands on the ground", ["a robot"]),
        ("A robot patrols a ball", ["a robot patrols a ball"]),
        ("An office with a ball", ["an office"]),
        ("A ball rolls and comes back", ["a ball comes back"]),
        ("A wooden bal on the floor", ["bal"]),
        ("A velvet cube rests on the ground", ["velvet"]),
        ("A turquoise ball", ["turquoise"]),
        ("Ketchup pours into a bowl", ["ketchup"]),
        ("A ball rolls quickly down a ramp", ["quickly"]),
        ("A ball orbits a cube", ["orbits"]),
        ("A 3 parsec ball", ["parsec"]),
        ("The wind blows a ball", ["wind", "blows"]),
        ("A mug in a table", ["a mug in a table"]),
        ("A table rolls down a ramp", ["a table rolls down a ramp"]),
        ("A ball rolls down a table", ["rolls down a table"]),
        ("A box under a shelf", ["under a shelf"]),
        ("A cube swings", ["swings"]),
        ("Water pours onto a box", ["pours onto a box"]),
        ("A ball between three walls", ["between three walls"]),
        ("A ball swings on a table", ["on a table"]),
        ("A mug on a ball on", ["on"]),
        ("A box holds a ball", ["a box holds a ball"]),
        ("A pendulum floats", ["a pendulum"]),
        ("A ball with a speed of 2 m/s on the ground", ["a ball"]),
        ("A 30 degree box", ["a 30 degree box"]),
        ("A ball filled with water", ["a ball filled with water"]),
        ("A small 20 cm ball", ["a small 20 cm ball"]),
        ("A red ball beside a box hits a wall", ["a red ball"]),
        ("Water pours into two bowls", ["pours into two bowls"]),
        ("A 2 m pendulum in a tank of water", ["a 2 m pendulum"]),
    ],
)
def test_what_it_cannot_ground_is_refused_by_name(prompt, words):
    with pytest.raises(NotUnderstood) as caught:
        plan(prompt)
    assert caught.value.words == words
    assert all(repr(word) in str(caught.value) for word in words)


def test_a_word_that_is_nearly_known_is_suggested():
    with pytest.raises(NotUnderstood, match="'penulum' \\(did you mean 'pendulum'\\?\\)"):
        plan("A penulum swings")


@pytest.mark.parametrize(
    ("prompt", "words"),
    [
        ("A ball rolls down an 80 degree ramp", "outside 1 to 60"),
        ("A box rolls down a ramp", "rolls balls, barrels and the like"),
        ("A stack of three boxes slides down a ramp", "no stack or row on a ramp"),
        ("Three boxes on a seesaw", "one thing on each end"),
        ("A pendulum swings from 120 degrees", "outside 0 to 90"),
        ("A ball is thrown at 500 m/s", "not above 0 and up to 50 m/s"),
        ("A box weighing 90000 kg", "outside 0.001 to 10000 kg"),
        ("Water pours into a bowl and a ball falls into a bucket", "empty vessel"),
        ("A ball rests on the ground for 500 seconds", "outside 0.1 to 60"),
        ("A robot dog patrols an office and a ball rolls", "'a ball': .* furnishes an office itself"),
        ("Two robot dogs patrol an office", "'two robot dogs': .* for one robot"),
        ("A robot dog patrols an office at 3 m/s", "3 m/s is outside 0.2 to 0.9"),
        ("A red ball to the left of a blue ball and the blue ball to the left of the red ball", "in a circle"),
    ],
)
def test_what_it_does_not_build_says_why(prompt, words):
    with pytest.raises(UserError, match=words):
        plan(prompt)


def test_ramps_are_as_steep_as_friction_wants():
    def angle(prompt):
        made = plan(prompt)
        (ramp,) = (o for o in made.objects if o.role == "terrain" and o.name != "ground")
        return ramp.pose.rotation_deg[1], {a.why for a in made.assumptions if a.choice.startswith("inclined")}

    sliding, why = angle("A wooden block slides down a wooden ramp")
    assert sliding == 30.0 and why == {"steeper than the angle of friction, 21.8 degrees at a friction of 0.4"}
    resting, why = angle("A wooden block rests on a wooden ramp")
    assert resting == 15.0 and why == {"flatter than the angle of friction, 21.8 degrees at a friction of 0.4"}
    rolling, why = angle("A steel ball rolls down a ramp")
    assert rolling == 20.0 and "2/7 tan(20 degrees) = 0.10" in why.pop()
    assert angle("A block slides down a 12 degree ramp") == (12.0, set())
    [contact] = plan("A block slides down a 12 degree ramp").contacts
    assert 0.0 < contact.friction < math.tan(math.radians(12.0))
    warned = plan("A block slides down a 12 degree wooden ramp").assumptions
    assert any(a.choice.startswith("warning: at 12 degrees") for a in warned)


def test_measures_are_taken_as_said():
    brick = plan("A 20 x 10 x 5 cm brick block lies on the ground").object("brick_block")
    assert brick.size == pytest.approx((0.2, 0.1, 0.05))
    assert plan("A cylinder with a radius of 5 cm").object("cylinder").size[0] == 0.05
    plank = plan("A 0.5 m long 10 cm wide plank").object("plank")
    assert plank.size == (0.5, 0.1, 0.04)
    assert plan("A box weighing 2 kg").object("box").registration.mass == 2.0
    assert plan("A red ball flies to the left at 6 m/s for 2 seconds").simulation.duration == 2.0
    mug = plan("A laptop on a desk and a mug 20 cm to the right of the laptop").object("mug")
    assert mug.relation("RIGHT-OF").gap == 0.2
    assert mug.construction.kind == "asset" and mug.construction.asset == "mug"
    red = plan("A red mug on a desk").object("red_mug")
    assert red.construction.kind == "external" and red.construction.candidate == "mug"


def test_the_catalogue_is_in_the_lexicon():
    known = {noun.asset for noun in lexicon().nouns.values()}
    assert set(load_catalogue()) <= known


OWN_SIZE = {"ramp", "seesaw", "domino"}  # which the rules build in another shape than the catalogue's


@pytest.mark.parametrize("noun", [noun for noun in lexicon().nouns.values() if noun.asset], ids=lambda noun: noun.key)
def test_what_stands_for_an_asset_is_as_large_and_heavy(noun):
    asset = load_catalogue()[noun.asset]
    if noun.key in OWN_SIZE:
        assert noun.mass is None
        return
    assert noun.mass == asset.mass
    stands_on = asset.anchors["seat"][2] if noun.key == "bench" else asset.size[2]
    outer = {
        "box": lambda: noun.size,
        "sphere": lambda: (2 * noun.size[0],) * 3,
        "cylinder": lambda: (2 * noun.size[0], 2 * noun.size[0], noun.size[1]),
        "tank": lambda: (noun.size[0] + 2 * WALL, noun.size[1] + 2 * WALL, noun.size[2] + WALL),
    }[noun.primitive]()
    rounding = 1.1e-5  # of the metadata [m]
    assert outer[2] == pytest.approx(stands_on, abs=rounding)
    assert min(outer[:2]) == pytest.approx(min(asset.size[:2]), abs=rounding)
    assert all(edge <= own + rounding for edge, own in zip(outer[:2], asset.size[:2], strict=True))


def test_a_mass_of_the_catalogue_goes_with_its_size():
    """A barrel in water is a small one: the mass of the large one would sink it."""
    assert plan("A barrel rolls").object("barrel").registration.mass == load_catalogue()["barrel"].mass
    afloat = plan("A barrel floats in a tank of water")
    assert afloat.object("barrel").registration.mass is None
    assert not any(assumption.choice.startswith("warning") for assumption in afloat.assumptions)
    assert plan("An oak barrel on the ground").object("oak_barrel").registration.mass is None


def test_a_thing_of_the_usual_size_goes_into_its_vessel():
    made = plan("A ball falls into a bucket")
    assert 2 * made.object("ball").size[0] < min(load_catalogue()["bucket"].hollow.size[:2])
    made = plan("A ball falls into a bowl")
    assert 2 * made.object("ball").size[0] < min(load_catalogue()["bowl"].hollow.size[:2])
    assert any(assumption.why == "so that it goes into a bowl" for assumption in made.assumptions)
    with pytest.raises(UserError, match="does not fit into bowl"):
        plan("A 40 cm ball in a bowl")


def test_planning_loads_no_simulator():
    code = (
        "import sys; from wsim.rules.planner import plan; plan('A pendulum swings');"
        "assert not {'newton', 'warp', 'pxr', 'mujoco'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_any_of_its_words_in_any_order_are_planned_or_refused():
    """Prompts with words exchanged for others that the planner knows: no other end than a plan or one clear line."""
    known = lexicon()
    words = [word for kind in ("NOUN", "VERB", "SIDE", "PREP") for word in known.words_of(kind)]
    words += ["the", "it", "and", "3", "20 cm", "2 kg", "30 degrees", "3 m/s", "red", "in", "down", "over"]
    random = Random(7)
    planned = 0
    for _ in range(400):
        said = random.choice(PROMPTS)["says"].split()
        for _ in range(random.randint(1, 2)):
            said[random.randrange(len(said))] = random.choice(words)
        try:
            plan(" ".join(said))
            planned += 1
        except UserError as error:
            assert "\n" not in str(error)
    assert 5 < planned < 395
