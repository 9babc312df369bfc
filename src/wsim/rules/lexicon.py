"""The builtin planner's closed vocabulary, read from the data in `language/`. What is not there is refused by name."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files
from typing import Any, Literal

from wsim.assets import load_catalogue
from wsim.plan.schema import Material

Family = Literal["solid", "furniture", "vessel", "tank", "ramp", "rod", "pendulum", "seesaw"]
Words = tuple[str, ...]


@dataclass(frozen=True)
class Noun:
    """A thing that can be built.

    Attributes:
        key: Its name in the data, and the stem of its objects' names.
        family: Which rules build it.
        primitive: Of the schema.
        size: As the primitive has it [m].
        afloat: The same for one in water [m].
        length: What a bare length in the prompt is: "edges", "edge", "diameter", "x", "y", "z" or "rod".
        material: Its material where neither the prompt nor the scene names one.
        mass: [kg], of a thing that is not solid through and through.
        asset: The catalogue's entry that the primitive stands for.
        lies: Whether it starts on its side.
    """

    key: str
    family: Family
    primitive: str
    size: tuple[float, ...]
    afloat: tuple[float, ...]
    length: str
    material: str | None = None
    mass: float | None = None
    asset: str | None = None
    lies: bool = False


@dataclass(frozen=True)
class Named:
    """A noun's word: which thing, and whether it is several."""

    noun: str
    plural: bool
    filled: bool = False  # a container that the word itself says to hold water


@dataclass(frozen=True)
class Side:
    """A preposition that relates two things: the plan's row, and what to say where the words leave the side open."""

    key: str
    predicate: str
    assume: str = ""


@dataclass(frozen=True)
class Entry:
    """One entry: the grammar's terminal, and what it stands for."""

    terminal: str
    value: Any = None


@dataclass
class Lexicon:
    """Every entry by its words."""

    entries: dict[Words, Entry] = field(default_factory=dict)
    units: dict[Words, tuple[str, float]] = field(default_factory=dict)  # words -> (terminal, factor)
    nouns: dict[str, Noun] = field(default_factory=dict)
    materials: dict[str, Material] = field(default_factory=dict)  # by word
    colors: dict[str, tuple[float, float, float]] = field(default_factory=dict)
    particles: dict[str, tuple[str, ...]] = field(default_factory=dict)  # of a verb; "" is none
    objects: set[str] = field(default_factory=set)  # verbs that take one
    groups: dict[str, str] = field(default_factory=dict)  # arrangement -> axis

    @property
    def longest(self) -> int:
        """Words in the longest entry."""
        return max(len(words) for words in self.entries)

    @property
    def vocabulary(self) -> set[str]:
        """Every word of every entry."""
        return {word for words in (*self.entries, *self.units) for word in words} | {"x", "by"}

    def words_of(self, terminal: str) -> list[str]:
        """All words of a terminal."""
        return sorted(" ".join(words) for words, entry in self.entries.items() if entry.terminal == terminal)

    def add(self, words: str, terminal: str, value: Any = None) -> None:
        """Enter words; the first entry of the same words stays, so that the order of the data decides."""
        self.entries.setdefault(tuple(words.split()), Entry(terminal, value))


def _data(name: str) -> dict[str, Any]:
    return tomllib.loads((files("wsim.rules") / "language" / f"{name}.toml").read_text(encoding="utf-8"))


@cache
def lexicon() -> Lexicon:
    """The lexicon, read once."""
    made = Lexicon()
    _relations(made, _data("relations"))
    _quantities(made, _data("quantities"))
    _materials(made, _data("materials"))
    _verbs(made, _data("verbs"))
    _nouns(made, _data("nouns"))
    _catalogue(made)
    return made


def grammar_text() -> str:
    """The grammar, as Lark reads it."""
    return (files("wsim.rules") / "language" / "english.lark").read_text(encoding="utf-8")


def _relations(made: Lexicon, data: dict[str, Any]) -> None:
    for key, side in data["side"].items():
        for words in side["words"]:
            made.add(words, "SIDE", Side(key, side["predicate"], side.get("assume", "")))
    for key, all_words in data["preposition"].items():
        for words in all_words:
            made.add(words, "PREP", key)
    for key, all_words in data["direction"].items():
        for words in all_words:
            made.add(words, "DIRECTION", key)
    for terminal, all_words in data["word"].items():
        for words in all_words:
            made.add(words, terminal, words)


def _quantities(made: Lexicon, data: dict[str, Any]) -> None:
    for word, value in data["number"].items():
        made.add(word, "COUNT", value)
    for word, value in data["size"].items():
        made.add(word, "SCALE", value)
    for word, axis in data["dimension"].items():
        made.add(word, "DIMENSION", axis)
    for kind, units in data["unit"].items():
        for words, factor in units.items():
            made.units[tuple(words.split())] = (kind.upper(), factor)
    phrases = data["measure_phrase"]
    for noun, what in data["measure"].items():
        for pattern in phrases["patterns"]:
            made.add(pattern.format(noun), "MEASURE_OF", what)
    for word, what in phrases["words"].items():
        made.add(word, "MEASURE_OF", what)


def _materials(made: Lexicon, data: dict[str, Any]) -> None:
    for name, fields in data["material"].items():
        material = Material(name=name, **{key: value for key, value in fields.items() if key != "words"})
        for word in fields["words"]:
            made.materials[word] = material
            made.add(word, "MATERIAL", word)
    for word, color in data["color"].items():
        made.colors[word] = (color[0], color[1], color[2])
        made.add(word, "COLOR", word)


def _verbs(made: Lexicon, data: dict[str, Any]) -> None:
    for verb, fields in data["verb"].items():
        made.particles[verb] = tuple(fields.get("particles", ("",)))
        if fields.get("object"):
            made.objects.add(verb)
        for form in fields["forms"]:
            made.add(form, "VERB", verb)


def _nouns(made: Lexicon, data: dict[str, Any]) -> None:
    for key, fields in data["noun"].items():
        size = tuple(fields["size"])
        made.nouns[key] = Noun(
            key=key,
            family=fields["class"],
            primitive=fields["primitive"],
            size=size,
            afloat=tuple(fields.get("afloat", size)),
            length=fields["length"],
            material=fields.get("material"),
            mass=fields.get("mass"),
            asset=fields.get("asset"),
            lies=fields.get("lies", False),
        )
        for words in fields["words"]:
            made.add(words, "NOUN", Named(key, plural=False))
        for words in fields.get("filled", []):
            made.add(words, "NOUN", Named(key, plural=False, filled=True))
        for words in fields.get("plurals", [word + "s" for word in fields["words"]]):
            made.add(words, "NOUN", Named(key, plural=True))
    for arrangement, fields in data["group"].items():
        made.groups[arrangement] = fields["axis"]
        for word in fields["words"]:
            made.add(word, "GROUP", arrangement)
    for terminal, section in (("PART", "part"), ("FLUID", "fluid"), ("GROUND", "ground")):
        for key, all_words in data[section].items():
            for word in all_words:
                made.add(word, terminal, key)


def _catalogue(made: Lexicon) -> None:
    """The catalogue's other names for what is known, and its other things, as solid stand-ins of their boxes."""
    by_asset = {noun.asset: noun.key for noun in made.nouns.values() if noun.asset is not None}
    for asset in load_catalogue().values():
        key = by_asset.get(asset.id)
        if key is None:
            key = asset.id.replace("-", "_").replace(" ", "_")
            size = tuple(asset.size)
            made.nouns[key] = Noun(key, "solid", "box", size, size, "z", "wood", asset.mass, asset.id)
        taken = made.vocabulary
        for name in asset.names:
            words = name.lower().replace("-", " ").split()
            # A word that already means something keeps its meaning; "wooden table" is a material and a thing.
            if words[0] not in made.materials and (len(words) > 1 or words[0] not in taken):
                made.add(" ".join(words), "NOUN", Named(key, plural=False))
                made.add(" ".join(words) + "s", "NOUN", Named(key, plural=True))
