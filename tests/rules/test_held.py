"""Vessels of the catalogue that hold a liquid."""

import pytest

from wsim.errors import UserError
from wsim.rules.planner import plan
from wsim.rules.scenes.vessel import hollow_of


def parts(made):
    fluid = next(item for item in made.objects if item.primitive == "fluid")
    return made.object(fluid.relation("PLACE-IN").ref), fluid


@pytest.mark.parametrize(
    ("prompt", "asset", "liquid"),
    [
        ("A bowl of water", "bowl", "water"),
        ("A mug half full of coffee on a table", "mug", "coffee"),
        ("A glass of milk stands on a table", "drinking_glass", "milk"),
        ("A vase is filled with water", "vase", "water"),
        ("Fill a mug with tea", "mug", "tea"),
        ("A bucket of red paint stands on the ground", "bucket", "paint"),
        ("A bowl with 3 cm of water in it", "bowl", "water"),
    ],
)
def test_the_catalogues_vessel_stands_still_and_holds_it(prompt, asset, liquid):
    made = plan(prompt)
    vessel, fluid = parts(made)
    assert (vessel.built.asset, vessel.state, fluid.name) == (asset, "static", liquid)
    assert [(one.kind, one.object, one.ref) for one in made.objectives] == [("stays_inside", liquid, vessel.name)]


def test_half_full_is_half_as_deep():
    _, fluid = parts(plan("A mug half full of coffee"))
    hollow = hollow_of("mug")
    assert fluid.relation("FREE-SURFACE-AT").value == pytest.approx(0.5 * (hollow.rim - hollow.floor), rel=1e-3)


@pytest.mark.parametrize(
    ("prompt", "litres"),
    [
        ("A flask holds 0.1 litres of mercury", 0.1),
        ("A mug contains 200 ml of cola", 0.2),
        ("A mug is filled with a cup of tea", 0.2365882),
    ],
)
def test_as_much_as_is_said(prompt, litres):
    made = plan(prompt)
    assert parts(made)[1].registration.volume == pytest.approx(1e-3 * litres)
    assert [clause.words for clause in made.clauses if clause.unchecked] == []


def test_a_bowl_that_something_floats_in_is_a_tank():
    assert parts(plan("A cork floats in a bowl of water"))[0].primitive == "tank"


@pytest.mark.parametrize(
    ("prompt", "words"),
    [
        ("A mug filled with 2 litres of water", "holds up to 0.35 litres"),
        ("A bottle filled with 0.2 litres of oil", "a bottle"),
        ("A funnel of water", "funnel"),
        ("A book of water", "a book"),
        ("Three mugs of coffee", "three mugs"),
        ("A mug of coffee falls off a table", "a mug of coffee"),
        ("A small mug of coffee", "a small mug"),
        ("A mug without coffee", "without"),
        ("A mug of water and a bowl of milk stand on a table", "a mug of water"),
    ],
)
def test_what_cannot_be_filled_is_refused_in_one_line_that_names_it(prompt, words):
    with pytest.raises(UserError) as told:
        plan(prompt)
    assert words in str(told.value)
    assert "\n" not in str(told.value)
