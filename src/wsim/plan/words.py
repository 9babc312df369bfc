"""The builtin planner's closed vocabulary. A word that is not here is refused, never skipped."""

from __future__ import annotations

from wsim.plan.materials import COLORS, MATERIALS

_COUNTED = ("one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve")
NUMBERS = {word: value for value, word in enumerate(_COUNTED, start=1)}
ARTICLES = frozenset({"a", "an", "the"})
JOINERS = frozenset({"and", ",", "then"})  # between things, and between what one thing does
ENDS = frozenset({".", ";", "while", "as"})  # between sentences

# Plural or singular -> the thing it names.
NOUNS = {
    "block": "block",
    "blocks": "block",
    "box": "box",
    "boxes": "box",
    "cube": "cube",
    "cubes": "cube",
    "ball": "ball",
    "balls": "ball",
    "sphere": "sphere",
    "spheres": "sphere",
    "cylinder": "cylinder",
    "cylinders": "cylinder",
    "log": "log",
    "logs": "log",
}
PLURALS = frozenset(word for word, noun in NOUNS.items() if word != noun)
GROUPS = frozenset({"stack", "tower", "pile"})
TANKS = frozenset({"tank", "aquarium"})
WATER = frozenset({"water"})
GROUND = frozenset({"ground", "floor"})
PARTS = {"surface": "surface", "top": "top", "bottom": "bottom"}
PRONOUNS = frozenset({"it", "them", "they"})

# Relative to the default size of the thing.
SIZES = {"small": 0.7, "little": 0.7, "large": 1.5, "big": 1.5}
UNITS = {
    "mm": 0.001,
    "millimetre": 0.001,
    "millimetres": 0.001,
    "millimeter": 0.001,
    "millimeters": 0.001,
    "cm": 0.01,
    "centimetre": 0.01,
    "centimetres": 0.01,
    "centimeter": 0.01,
    "centimeters": 0.01,
    "m": 1.0,
    "metre": 1.0,
    "metres": 1.0,
    "meter": 1.0,
    "meters": 1.0,
}

# Every form of a verb -> the verb.
VERBS = {
    form: verb
    for verb, forms in {
        "float": "float floats floating",
        "sink": "sink sinks sinking",
        "drop": "drop drops dropping dropped",
        "fall": "fall falls falling",
        "rest": "rest rests resting sit sits sitting lie lies lying stand stands standing stay stays staying",
        "stack": "stacked",
        "knock": "knock knocks knocking knocked",
        "topple": "topple topples toppling",
        "hit": "hit hits hitting",
        "roll": "roll rolls rolling",
        "hold": "hold holds holding contain contains containing",
        "submerge": "submerged",
    }.items()
    for form in forms.split()
}
BE = frozenset({"is", "are"})
PREPOSITIONS = frozenset(
    {"in", "into", "inside", "on", "onto", "to", "at", "from", "above", "against", "towards", "toward"}
)
PARTICLES = frozenset({"over", "down", "in"})  # after a verb: knocks over, falls down, drops in
OTHERS = frozenset({"of", "filled", "full", "with", "there", "height"})

VOCABULARY = frozenset().union(
    NUMBERS,
    ARTICLES,
    JOINERS,
    ENDS,
    NOUNS,
    GROUPS,
    TANKS,
    WATER,
    GROUND,
    PARTS,
    PRONOUNS,
    SIZES,
    UNITS,
    VERBS,
    BE,
    PREPOSITIONS,
    PARTICLES,
    OTHERS,
    MATERIALS,
    COLORS,
)


def known_words() -> str:
    """What the planner knows, for people."""
    return (
        f"things: {', '.join(sorted(set(NOUNS.values()) | GROUPS | TANKS | WATER | GROUND))}; "
        f"materials: {', '.join(sorted(MATERIALS))}; colours: {', '.join(sorted(COLORS))}; "
        f"sizes: {', '.join(sorted(SIZES))} or a length such as 20 cm; "
        "what they do: float, sink, drop, fall, rest, sit, lie, stand, stay, are stacked or submerged, roll, hit, "
        "knock over, topple"
    )
