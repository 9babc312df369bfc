"""Sentences of the words that README lists: each is planned, or refused in a line that names words of it."""

import re
from pathlib import Path
from random import Random

import pytest

from wsim.errors import UserError
from wsim.plan.layout import LayoutError
from wsim.plan.schema import Plan
from wsim.rules.planner import plan

README = (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")
SECTION = " ".join(README.split("\n## The builtin planner\n")[1].split("\n## ")[0].split())
MEASURES = ("20 cm", "0.5 m long", "20 x 10 x 5 cm", "2 kg", "30 degree")  # README's, before a noun


def listed(first: str, last: str) -> list[str]:
    """What README lists from one word to another."""
    words = re.split(r"[,;]|\band\b|\bor\b", SECTION[SECTION.index(first) : SECTION.index(last) + len(last)])
    return [word.strip() for word in words if word.strip()]


BODIES = listed("block, box", "plant, lamp")
STILL = [word.split(" (")[0] for word in listed("table, desk", "wall, ramp")]
VESSELS = listed("tank, aquarium", "bucket, bowl, pot, bin")
HINGED = ["pendulum", "seesaw"]
MATERIALS = [*listed("wood, pine", "steel"), *listed("iron, aluminium", "glass")]
COLOURS = listed("red, green", "black, grey")
SIZES = listed("tiny, small", "big, huge")
PLACES = listed("on, in,", "facing away from")
DOES = ["floats", "sinks", "drops", "falls", "rests", "sits", "lies", "stands", "stays", "is stacked", "is submerged",
        "rolls", "slides", "hits", "collides with", "knocks over", "topples", "is pushed", "is thrown", "flies",
        "swings", "hangs"]  # fmt: skip
NUMBERS = ("two", "three", "five", "twelve", "4")


def thing(random: Random) -> str:
    """A thing, with some of what README lets one say of it."""
    kind = random.choice([BODIES, BODIES, BODIES, STILL, VESSELS, HINGED])
    noun = random.choice(kind)
    words = [random.choice(words) for words in (SIZES, COLOURS, MATERIALS) if random.random() < 0.25]
    if random.random() < 0.15:
        words.insert(0, random.choice(MEASURES))
    if random.random() < 0.1:
        group = random.choice(("stack", "tower", "pile", "row", "line"))
        return f"a {group} of {random.choice(NUMBERS)} {' '.join([*words, noun + 's'])}"
    if random.random() < 0.15:
        return " ".join([random.choice(NUMBERS), *words, noun + "s"])
    return " ".join(["a", *words, noun])


def sentence(random: Random) -> str:
    """One thing that does something somewhere; at times a second sentence about it, or about another."""
    said = [thing(random)]
    if random.random() < 0.7:
        said.append(random.choice(DOES))
    if random.random() < 0.7:
        where = random.choice([*PLACES, "20 cm behind", "down", "into", "off", "against"])
        other = random.choice(
            [thing(random), thing(random), "the ground", "the floor", "water", "a tank of water", "it"]
        )
        said.append(f"{where} {other}" + (f" and {thing(random)}" if where == "between" else ""))
    if random.random() < 0.15:
        said.append(
            random.choice(("for 2 seconds", "at 3 m/s", "at 30 degrees", "with a radius of 5 cm", "from 0.5 m"))
        )
    if random.random() < 0.2:
        said += [random.choice((".", ",", "and", "while")), random.choice((thing(random), "it")), random.choice(DOES)]
    return " ".join(said)


def outcome(said: str) -> Plan | UserError:
    try:
        return plan(said)
    except UserError as error:
        return error


def named(error: UserError) -> set[str]:
    """The words that a refusal quotes; where nothing has room, those of the objects that it names."""
    if isinstance(error, LayoutError):
        return {word for name in re.findall(r"\w+", str(error)) for word in name.split("_")}
    return {word for words in re.findall(r"'([^']+)'", str(error)) for word in words.split()}


def test_the_words_are_found():
    assert (BODIES[0], BODIES[-1], len(BODIES)) == ("block", "lamp", 27)
    assert (STILL[-1], VESSELS, MATERIALS[-1]) == (
        "ramp",
        ["tank", "aquarium", "bucket", "bowl", "pot", "bin"],
        "glass",
    )
    assert "to the left of" in PLACES and "huge" in SIZES and "grey" in COLOURS


@pytest.mark.parametrize("noun", [*BODIES, *STILL, *VESSELS, *HINGED])
def test_each_thing_alone_is_a_scene(noun):
    assert isinstance(outcome(f"a {noun}"), Plan)


@pytest.mark.parametrize("seed", range(8))
def test_each_sentence_is_planned_or_refused_by_its_words(seed):
    random = Random(seed)
    planned = 0
    for _ in range(50):
        said = sentence(random)
        made = outcome(said)
        planned += isinstance(made, Plan)
        if isinstance(made, UserError):
            assert "\n" not in str(made)
            assert named(made) & {*said.split()}, f"{said}: {made}"
    assert 0 < planned < 50
