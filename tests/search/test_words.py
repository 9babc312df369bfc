"""Words are split as people and programs write them, and forms of one word are one."""

import pytest

from wsim.search.words import alike, singular, split, stem


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("CreateMassAttr", ["create", "mass", "attr"]),
        ("joint_revolute", ["joint", "revolute"]),
        ("UsdGeom.Xform", ["usd", "geom", "xform"]),
        ("USDStage", ["usd", "stage"]),
        ("a see-saw, 2 m", ["a", "see", "saw", "2", "m"]),
        ("Vec3d", ["vec", "3", "d"]),
        ("", []),
    ],
)
def test_names_and_sentences_are_split(text: str, words: list[str]) -> None:
    assert split(text) == words


@pytest.mark.parametrize(
    ("word", "one"),
    [
        ("benches", "bench"),
        ("boxes", "box"),
        ("shelves", "shelf"),
        ("dominoes", "domino"),
        ("glasses", "glass"),
        ("batteries", "battery"),
        ("houses", "house"),
        ("bus", "bus"),
    ],
)
def test_singular(word: str, one: str) -> None:
    assert singular(word) == singular(one) == one


@pytest.mark.parametrize(
    "words",
    ["hinge hinges hinged", "jitter jittering jitters", "carry carried",
     "slide slides sliding slider", "float floats floating", "drop drops dropped dropping", "box boxes",
     "topple topples toppling", "balance balances balancing", "tower towers", "linkage linkages", "glass glasses"],
)  # fmt: skip
def test_forms_of_a_word_are_one(words: str) -> None:
    assert len({stem(word) for word in words.split()}) == 1, [stem(word) for word in words.split()]


def test_words_that_differ_stay_apart() -> None:
    words = (
        "ball",
        "box",
        "wall",
        "wave",
        "water",
        "hinge",
        "swing",
        "speed",
        "spin",
        "car",
        "carry",
        "spring",
        "tank",
        "crank",
        "drive",
        "drop",
    )
    assert len({stem(word) for word in words}) == len(words)


def test_a_slip_is_like_what_was_meant() -> None:
    assert alike("cilinder", "cylinder") > 0.8
    assert alike("ball", "wall") == alike("tub", "tube") == 0.0
