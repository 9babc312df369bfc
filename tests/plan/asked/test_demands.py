"""What a prompt demands: verbs that are verbs, numbers with their units, and nothing else that looks like them."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from wsim.plan.asked.demands import demands
from wsim.plan.asked.tokens import tokens


def found(prompt: str, *kinds: str) -> list[str]:
    return [each.text for each in demands(prompt) if each.kind in kinds]


VERBS = {
    "A puck slides across ice and hits a wall.": ["slides", "hits"],
    "Two balls roll down a slide and fall off a table.": ["roll", "fall"],
    "A ball and a cube fall into the water.": ["fall"],
    "Drop a ball on a swing; it bounces.": ["Drop", "bounces"],
    "Let a marble roll through the funnel.": ["roll"],
    "A block is pushed off a table by a swinging pendulum.": ["pushed"],
    "A stack collapses after being struck by a wrecking ball.": ["collapses", "struck"],
    "A seesaw tilts to the left when a boy lands on its left end.": ["tilts", "lands"],
    "A Go2 patrols the office, then comes back.": ["patrols", "comes"],
    "A car stops with one wheel on the road.": ["stops"],
    "A ball rolls to the left of the box.": ["rolls"],
    "A drop of water, a roll of tape and a spring.": [],
}


@pytest.mark.parametrize("prompt", VERBS)
def test_verbs_are_told_from_nouns(prompt: str) -> None:
    assert found(prompt, "verb") == VERBS[prompt]


def test_what_no_world_here_does_is_beyond() -> None:
    for prompt, verb in (
        ("A plastic bottle buckles under a 2-kg weight.", "buckles"), ("A dry twig breaks.", "breaks"),
        ("A window pane shatters.", "shatters"), ("The candle is melting.", "melting"), ("The rod was bent.", "bent"),
    ):  # fmt: skip
        assert found(prompt, "beyond") == [verb]


NUMBERS = {
    "5 m/s": (5.0, "m/s"), "30 km/h": (30 / 3.6, "m/s"), "half a metre": (0.5, "m"), "0.5m": (0.5, "m"),
    "a metre": (1.0, "m"), "one and a half metres": (1.5, "m"), "a 45-degree": (45.0, "deg"),
    "60 rpm": (360.0, "deg/s"),
    "twenty-one grams": (0.021, "kg"), "a dozen": (12.0, ""), "400 kg/m3": (400.0, "kg/m^3"), "two": (2.0, ""),
    "180 degrees a second": (180.0, "deg/s"), "a quarter turn": (90.0, "deg"), "twice": (2.0, ""),
    "1/4": (0.25, ""),
    "1,000": (1000.0, ""), "0,5 m": (0.5, "m"), "10 %": (0.1, "1"), "9.81 m/s^2": (9.81, "m/s^2"),
    "three seconds": (3.0, "s"),
}  # fmt: skip


@pytest.mark.parametrize("words", NUMBERS)
def test_numbers_have_their_value_in_si(words: str) -> None:
    (number,) = [each for each in demands(f"It has {words}.") if each.kind == "number"]
    assert (number.value, number.unit) == (pytest.approx(NUMBERS[words][0]), NUMBERS[words][1])


def test_edges_share_the_last_ones_unit() -> None:
    edges = [each for each in demands("A box of 40 x 20 x 10 cm.") if each.kind == "number"]
    assert [(each.value, each.unit) for each in edges] == [(pytest.approx(x), "m") for x in (0.4, 0.2, 0.1)]


def test_what_counts_nothing_is_no_number() -> None:
    for prompt in ("One of them, the other one.", "The first ball, the 2nd, a Go2 and a G1.", "A single one-way gate."):
        assert found(prompt, "number") == []


DENIED = {
    "The tower does not fall.": ["fall"], "It never touches the wall.": ["touches"], "It must not tip or fall.":
    ["tip", "fall"], "It hits the box without touching the skittle.": ["touching"], "No water spills.": ["spills"],
    "None of the blocks falls, and nothing moves.": ["falls", "moves"], "The post keeps it from falling.": ["falling"],
    "It can't hit the crate.": ["hit"], "It does not fall and slides.": ["fall"], "It isn't ever hit.": ["hit"],
    "A floor with no friction: the block slides.": [], "Not only does it fall but it rolls.": [],
    "There is no wall and the ball falls.": [], "Without a wall it falls.": [], "It falls; nothing moves it on.":
    ["moves"],
}  # fmt: skip


@pytest.mark.parametrize("prompt", DENIED)
def test_what_is_not_to_happen_is_told_from_what_is(prompt: str) -> None:
    assert [each.text for each in demands(prompt) if each.denied] == DENIED[prompt]


NAMES = {
    "Ball two hits ball one and box 1 lies two metres away.": ["two metres"],
    "Cart number two, a type 3 crate and a model 500 car wait.": [], "Beside the wall, two balls roll.": ["two"],
    "A tower three blocks high stands.": ["three"], "A friction 1 and a gravity 10.": ["1", "10"],
    "The first two float.": ["two"], "All three of them fall.": ["three"], "A Boeing 747 lands.": [],
    "Drop the ball three times.": ["three"], "The link 2 falls.": [], "A ball waits: two come.": ["two"],
    "Ball one and a half metres away ball two waits.": ["one and a half metres"],
}  # fmt: skip


@pytest.mark.parametrize("prompt", NAMES)
def test_a_number_in_a_name_is_no_count(prompt: str) -> None:
    assert found(prompt, "number") == NAMES[prompt]


@pytest.mark.parametrize(
    ("prompt", "bound"),
    [
        ("Within a second it falls.", 1.0), ("It falls in under a second and a half.", 1.5),
        ("It falls no later than half a second after that.", 0.5), ("In less than 200 ms it falls.", 0.2),
        ("It falls within a quarter of a second.", 0.25), ("After 2 s it falls.", None),
        ("It falls for a second.", None),
        ("It touches it for less than 2 s.", None), ("It falls into a second box.", None),
    ],
)  # fmt: skip
def test_times_by_which_something_happens(prompt: str, bound: float | None) -> None:
    assert [each.value for each in demands(prompt) if each.bound] == ([] if bound is None else [pytest.approx(bound)])


def test_how_often() -> None:
    assert found("It bounces exactly once, then only twice, and again.", "often") == [
        "exactly once", "only twice", "again"
    ]  # fmt: skip
    assert found("Once it has fallen it lies; again and again.", "often") == []
    often = [each.text for each in demands("Three times it falls, twice as far as twice the box.") if each.often]
    assert often == ["Three"]


def test_manners() -> None:
    assert found("A ball rolls gently and very slowly on a jelly.", "manner") == ["gently", "slowly"]
    assert found("A hard floor and a fast car.", "manner") == []


@given(st.text(max_size=200))
def test_any_text_is_read(text: str) -> None:
    """Whatever it is, each demand's words are the prompt's, within its tokens."""
    count = sum(not token.stops for token in tokens(text))
    for each in demands(text):
        assert each.text in text
        assert 0 <= each.first <= each.last < count


@given(st.floats(0.01, 999.0).map(lambda x: round(x, 2)), st.sampled_from(["m", "cm", "kg", "m/s", "degrees"]))
def test_any_number_before_a_unit_is_read(value: float, unit: str) -> None:
    (number,) = [each for each in demands(f"A thing of {value} {unit} lies there.") if each.kind == "number"]
    assert number.text == f"{value} {unit}"
    assert number.value == pytest.approx(value * (0.01 if unit == "cm" else 1.0))


@pytest.mark.parametrize(
    ("prompt", "verbs"),
    [
        ("Three boxes on a ramp slide.", ["slide"]), ("Two balls in a tank float.", ["float"]),
        ("The balls in the bucket bounce twice.", ["bounce"]), ("The ball left the table.", ["left"]),
        ("Two balls on a slide.", []), ("A ball in the box.", []), ("Marbles on a wooden drop table.", []),
        ("The ball rolls left.", ["rolls"]), ("Two left wheels turn.", ["turn"]),
    ],
)  # fmt: skip
def test_a_plural_verb_is_found_behind_what_it_is_said_of(prompt: str, verbs: list[str]) -> None:
    assert [each.text for each in demands(prompt) if each.kind == "verb"] == verbs


@pytest.mark.parametrize(
    ("prompt", "denied"),
    [
        ("Not one box falls.", True), ("Not a single box falls.", True), ("The box nearly topples.", True),
        ("The ball fails to reach the wall.", True), ("The box rests rather than rolls.", True),
        ("The ball stops before reaching the wall.", True), ("The ball bounces before reaching the wall.", False),
        ("One box falls.", False),
    ],
)  # fmt: skip
def test_a_denial_has_many_words(prompt: str, denied: bool) -> None:
    assert [each for each in demands(prompt) if each.kind == "verb"][-1].denied == denied


@pytest.mark.parametrize(
    ("prompt", "found"),
    [
        ("It goes between 2 and 3 m.", [(2.0, "m"), (3.0, "m")]),
        ("A box of 20x30x40 cm.", [(0.2, "m"), (0.3, "m"), (0.4, "m")]),
        ("Water at 20 °C.", [(20.0, "degC")]), ("A box of 2 pounds.", [(0.907, "kg")]),
        ("A 1:10 scale model.", []), ("At 3 o'clock a ball falls.", []), ("A Go2 walks.", []),
    ],
)  # fmt: skip
def test_numbers_have_the_units_that_people_write(prompt: str, found: list[tuple[float, str]]) -> None:
    numbers = [(round(each.value or 0.0, 3), each.unit) for each in demands(prompt) if each.kind == "number"]
    assert numbers == found
