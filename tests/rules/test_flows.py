"""Taps, rain and holes: what a sentence says of them is what the plan has."""

import math

import pytest

from wsim.defaults import GRAVITY
from wsim.errors import UserError
from wsim.plan.asked.covered import missing
from wsim.plan.schema.formula_fluid import LevelIn
from wsim.rules.planner import plan

LITRE = 1e-3


def opening(made):
    [found] = made.openings
    return found


def level(made):
    """The level that is asked for, and how far it may be off [m]."""
    [found] = [
        node for one in made.objectives if one.formula for node in one.formula.walk() if isinstance(node, LevelIn)
    ]
    return found.level, found.within


def area(made):
    tank = next(item for item in made.objects if item.primitive == "tank")
    return tank.size[0] * tank.size[1]


def start(made):
    return next(item for item in made.objects if item.primitive == "fluid").relation("FREE-SURFACE-AT").value


@pytest.mark.parametrize(
    ("prompt", "rate"),
    [
        ("A tap fills a tank at 0.2 litres per second", 0.2 * LITRE),
        ("A tap fills a tank at 6 l/min", 0.1 * LITRE),
        ("A hose fills an aquarium at 3 gallons per minute", 3 * 3.785411784 * LITRE / 60),
        ("Water runs into a tank at 10 litres per minute", LITRE / 6),
        ("An empty tank is filled with a hose at half a litre per second", 0.5 * LITRE),
        ("A tap with a flow of 3 litres per minute fills a tank", 0.05 * LITRE),
        ("Milk flows from a faucet into a tank at 100 ml per second", 0.1 * LITRE),
    ],
)
def test_a_tap_runs_as_fast_as_is_said_and_its_tank_starts_empty(prompt, rate):
    made = plan(prompt)
    assert opening(made).rate == pytest.approx(rate, rel=1e-5)
    assert start(made) == 0.0
    assert missing(made) == []
    assert [clause.words for clause in made.clauses if clause.unchecked] == []
    # Mass balance: what came in over the floor.
    assert level(made)[0] == pytest.approx(opening(made).poured(made.simulation.duration) / area(made), rel=1e-3)


def test_a_tap_opens_and_shuts_when_it_is_said_to():
    made = opening(plan("A tap above a tank is turned on after 1 second and turned off after 3 seconds"))
    assert (made.start, made.stop) == (1.0, 3.0)


@pytest.mark.parametrize(
    ("prompt", "poured"),
    [
        ("A tap pours 2 litres of oil into a tank", 2.0),
        ("A tap pours three litres of milk into a tank in 5 seconds", 3.0),
        ("A bucket is filled with 5 litres of water by a hose at 1 litre per second", 5.0),
    ],
)
def test_as_much_is_poured_as_is_said(prompt, poured):
    made = plan(prompt)
    assert opening(made).poured(made.simulation.duration) == pytest.approx(poured * LITRE, rel=1e-4)


def test_a_tap_fills_up_to_the_depth_that_is_said():
    made = plan("A hose sprays water into a tank until it is 5 cm deep")
    assert level(made)[0] == pytest.approx(0.05, rel=0.02)


def test_a_tank_drains_between_what_torricelli_says_of_the_worst_and_the_best_hole():
    made = plan("A tank of water drains through a hole in its floor")
    hole, first, end = opening(made), start(made), made.simulation.duration
    assert (hole.kind, hole.at, hole.direction) == ("drain", "tank", None)

    def left(share):  # h(t) = (sqrt(h0) - c a / A sqrt(g / 2) t)^2
        return (math.sqrt(first) - share * hole.area / area(made) * math.sqrt(GRAVITY / 2) * end) ** 2

    middle, within = level(made)
    assert middle - within < left(0.6) < middle + within
    assert middle + within < first  # it has to go down
    assert made.simulation.spacing <= 2 * hole.radius / 6 + 1e-9


@pytest.mark.parametrize(
    ("prompt", "wide", "wall"),
    [
        ("A tank drains through a hole of 5 cm in its side", 0.05, True),
        ("Water leaks out of a tank through a hole in the bottom", None, False),
        ("There is a tank of water with a hole of 4 cm in its bottom", 0.04, False),
        ("Water flows out of a hole in the side of a tank", None, True),
    ],
)
def test_a_hole_is_where_it_is_said_and_as_wide(prompt, wide, wall):
    hole = opening(plan(prompt))
    assert (hole.direction is not None) == wall
    assert wide is None or 2 * hole.radius == pytest.approx(wide)


def test_a_tank_that_empties_is_followed_to_the_end():
    made = plan("A tank of water empties through a hole in its floor")
    assert level(made)[0] + level(made)[1] <= 2 * made.simulation.spacing


@pytest.mark.parametrize(
    ("prompt", "fall"),
    [
        ("Rain falls into a tank at 100 mm per hour for 2 seconds", 0.1 / 3600),
        ("It rains on a table at 4 inches per hour", 4 * 0.0254 / 3600),
    ],
)
def test_rain_is_as_heavy_as_is_said(prompt, fall):
    rain = opening(plan(prompt))
    assert rain.rate / rain.area == pytest.approx(fall, rel=1e-4)
    assert 7.0 < rain.drop_speed < 9.2  # of drops 3 to 5 mm wide (Gunn & Kinzer 1949)


def test_what_rain_falls_on_stands_in_the_tray_that_keeps_the_water():
    made = plan("Rain falls on a roof")
    roof, tray = made.object("roof"), made.object("tank")
    assert roof.state == "static"
    assert roof.pose.rotation_deg[1] > 10.0
    assert opening(made).size[0] < tray.size[0]


@pytest.mark.parametrize(
    ("prompt", "words"),
    [
        ("A tap fills a bowl at 5 litres per second for 3 seconds", "run over"),
        ("Two taps fill a tank", "two taps"),
        ("A tap fills a tank and a wooden ball rolls", "a wooden ball"),
        ("A tap does not fill a tank", "a tank"),
        ("A ball falls into a hole", "a ball falls into a hole"),
        ("A tap fills a mug", "a mug"),
        ("A tank drains through a hole of 2 mm in its floor", "a mouth 0.002 m wide"),
        ("Rain falls at 1 mm per hour into a tank", "too little"),
        ("A tap fills a tank at 5 mm per hour", "5 mm per hour"),
        ("A gate opens and water flows out of a tank", "a gate opens"),
        ("A tap drips", "drips"),
    ],
)
def test_what_cannot_be_built_is_refused_in_one_line_that_names_it(prompt, words):
    with pytest.raises(UserError) as told:
        plan(prompt)
    assert words in str(told.value)
    assert "\n" not in str(told.value)
