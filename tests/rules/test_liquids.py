"""Liquids other than water, and how much of one stands in a tank."""

import math

import pytest

from wsim.errors import UserError
from wsim.rules.data import read
from wsim.rules.grammar import NotUnderstood
from wsim.rules.liquids import liquids
from wsim.rules.planner import plan


def fluid(made):
    [found] = [item for item in made.objects if item.primitive == "fluid"]
    return found


def litres(made):
    tank = next(item for item in made.objects if item.primitive == "tank")
    return 1000 * tank.size[0] * tank.size[1] * fluid(made).relation("FREE-SURFACE-AT").value


def test_every_number_of_a_liquid_has_a_source():
    for key, fields in read("liquids")["liquid"].items():
        assert fields["source"], key
        assert 0.0 < liquids()[key].material.density < 20_000.0


@pytest.mark.parametrize(
    ("prompt", "name", "density", "viscosity"),
    [
        ("A steel ball sinks in honey", "honey", 1420, 10.0),
        ("A wooden block floats in a tank of oil", "oil", 911, 0.084),
        ("Fill a tank with milk and drop a ball in", "milk", 1030, 0.0021),
        ("A steel ball floats on mercury", "mercury", 13546, 0.00155),
        ("An ice cube floats in a glass tank of cola", "cola", 1041, 0.00136),
        ("A brick sinks in lava", "lava", 2700, 100.0),
        ("A cork floats in a tank of salt water", "sea_water", 1024.8, 0.00108),
        ("A ball floats in a tank of water", "water", 1000, None),
    ],
)
def test_a_tank_is_filled_with_what_is_said(prompt, name, density, viscosity):
    made = fluid(plan(prompt))
    assert (made.name, made.material.density, made.registration.viscosity) == (name, density, viscosity)


@pytest.mark.parametrize(
    ("prompt", "kind"),
    [
        ("A steel ball is dropped into mercury", "floats"),  # 7850 against 13546 kg/m^3
        ("A gold ball is dropped into mercury", "rests_on"),
        ("A plastic ball is dropped into a tank of oil", "rests_on"),  # 950 against 911
        ("A plastic ball is dropped into a tank of milk", "floats"),
    ],
)
def test_what_floats_is_lighter_than_the_liquid(prompt, kind):
    assert plan(prompt).objectives[0].kind == kind


def test_paint_has_the_colour_that_is_said():
    red, plain = (fluid(plan(prompt)) for prompt in ("A tank of red paint", "A tank of paint"))
    assert red.material.color != plain.material.color
    assert red.material.attenuation_length == 0.0


@pytest.mark.parametrize(
    ("prompt", "volume"),
    [
        ("A tank filled with 20 litres of water", 20.0),
        ("A wooden cube floats in a tank filled with 30 litres of oil", 30.0),
        ("A tank holds 2 gallons of milk", 7.5708),
        ("A tank is filled with 3 cups of water", 0.70976),
    ],
)
def test_as_much_is_in_a_tank_as_is_said(prompt, volume):
    assert litres(plan(prompt)) == pytest.approx(volume, rel=0.05)


@pytest.mark.parametrize(
    ("prompt", "level"),
    [
        ("A tank with 10 cm of water in it", 0.1),
        ("Fill a tank with oil up to 20 cm and drop a steel ball into it", 0.2),
    ],
)
def test_as_deep_as_is_said(prompt, level):
    assert fluid(plan(prompt)).relation("FREE-SURFACE-AT").value == pytest.approx(level)


@pytest.mark.parametrize(
    ("words", "share"), [("half full", 0.5), ("three quarters full", 0.75), ("a third full", 1 / 3)]
)
def test_as_full_as_is_said(words, share):
    made = plan(f"A cork floats in a tank {words} of milk")
    tank = next(item for item in made.objects if item.primitive == "tank")
    assert fluid(made).relation("FREE-SURFACE-AT").value / tank.size[2] == pytest.approx(share, rel=0.02)


def test_a_block_that_is_poured_is_as_much_as_is_said():
    made = fluid(plan("2 litres of water are poured into a tank"))
    assert math.prod(made.size) == pytest.approx(0.002, rel=0.01)


@pytest.mark.parametrize(
    ("prompt", "words"),
    [
        ("A ball floats in a tank of water and a cube floats in a tank of milk", "milk"),
        ("A tank without water", "without"),
        ("A tank of ketchup", "ketchup"),
        ("A ball floats in an empty tank", "an empty tank"),
        ("A wooden cube floats in a tank filled with 1 litre of oil", "too little"),
        ("3 litres of oil are poured into a bowl", "3 litres of oil"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line_that_names_it(prompt, words):
    with pytest.raises(UserError) as told:
        plan(prompt)
    assert words in str(told.value)
    assert "\n" not in str(told.value)


def test_two_amounts_are_refused():
    with pytest.raises((UserError, NotUnderstood), match=r"how full it is|else of the"):
        plan("A ball floats in a half full tank of water that holds 20 litres of water")
