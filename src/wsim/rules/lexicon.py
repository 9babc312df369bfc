"""The builtin planner's closed vocabulary, read from the data in `language/`. What is not there is refused by name."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from importlib.resources import files
from itertools import product
from typing import Any, Literal

from wsim.assets import Asset, load_catalogue
from wsim.assets.folders import stamp
from wsim.assets.sources import sources
from wsim.defaults import WALL
from wsim.errors import UserError
from wsim.plan.schema import Material
from wsim.rules.data import read
from wsim.rules.liquids import Filled, flow_units, liquid_words

Family = Literal[
    "solid",
    "furniture",
    "vessel",
    "tank",
    "ramp",
    "rod",
    "pendulum",
    "seesaw",
    "robot",
    "office",
    "vehicle",
    "land",
    "dock",
    "pontoon",
    "belt",
    "turntable",
    "rope",
    "bob",
    "tap",
    "rain",
    "drain",
    "roof",
]
Words = tuple[str, ...]
BALL = "sport/ball"  # the catalogue's category of what is round and rolls
_KEYS = {
    "noun": ("words", "plurals", "filled", "class", "primitive", "asset", "size", "top", "afloat", "length", "material",
             "lies"),
    "verb": ("forms", "particles", "object", "commands", "negated"),
    "side": ("words", "predicate", "assume"),
    "group": ("words", "axis"),
}  # fmt: skip


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
        mass: [kg], of the catalogue's thing, at that size.
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
    filled: Filled | None = None  # what a container holds by the word itself


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
    commands: dict[Words, str] = field(default_factory=dict)  # "drop" -> the verb
    third: dict[Words, str] = field(default_factory=dict)  # "drops", of someone who does it
    negated: dict[str, str] = field(default_factory=dict)  # what is done by what does not do it
    groups: dict[str, str] = field(default_factory=dict)  # arrangement -> axis
    stuff: dict[str, str] = field(default_factory=dict)  # a material's word -> the noun that it is by itself

    @property
    def longest(self) -> int:
        """Words in the longest entry."""
        return max(len(words) for words in self.entries)

    @property
    def vocabulary(self) -> set[str]:
        """Every word of every entry."""
        return {word for words in (*self.entries, *self.units) for word in words} | {
            "x", "by", "half", "quarter", "times", "time"
        }  # fmt: skip

    def words_of(self, terminal: str) -> list[str]:
        """All words of a terminal."""
        return sorted(" ".join(words) for words, entry in self.entries.items() if entry.terminal == terminal)

    def add(self, words: str, terminal: str, value: Any = None) -> None:
        """Enter words; the first entry of the same words stays, so that the order of the data decides."""
        self.entries.setdefault(tuple(words.split()), Entry(terminal, value))


def lexicon() -> Lexicon:
    """The lexicon, read once, and again when the user's assets have changed."""
    return _lexicon(stamp())


@lru_cache(maxsize=2)
def _lexicon(_assets: tuple[str, int]) -> Lexicon:
    made = Lexicon()
    _relations(made, read("relations"))
    _quantities(made, read("quantities"))
    _materials(made, read("materials"))
    _verbs(made, read("verbs"))
    nouns = read("nouns")
    _groups(made, nouns)
    for words, terminal, value in liquid_words():
        made.add(words, terminal, value)
    _nouns(made, nouns)
    made.stuff |= nouns["stuff"]
    _others(made)
    _measures(made, read("quantities"))
    _commands(made, read("verbs"))  # last: what is a thing or does something, too, is that
    _robots(made)
    return made


def grammar_text() -> str:
    """The grammar, as Lark reads it."""
    return (files("wsim.rules") / "language" / "english.lark").read_text(encoding="utf-8")


def _entries(file: str, table: str, data: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    """A table's entries; a key that nobody reads is a mistake that would change nothing, and so never be seen."""
    for name, fields in data[table].items():
        for key in fields:
            if key not in _KEYS[table]:
                raise UserError(
                    f"{file}.toml: {table} {name!r} has no key {key!r}; it may have {', '.join(_KEYS[table])}"
                )
        yield name, fields


def _relations(made: Lexicon, data: dict[str, Any]) -> None:
    for key, side in _entries("relations", "side", data):
        for words in side["words"]:
            made.add(words, "SIDE", Side(key, side["predicate"], side.get("assume", "")))
    for key, all_words in data["preposition"].items():
        for words in all_words:
            made.add(words, "PREP", key)
    for key, all_words in data["surface"].items():
        for words in all_words:
            made.add(words, "SURFACE", key)
    for key, all_words in data["direction"].items():
        for words in all_words:
            made.add(words, "DIRECTION", key)
    for words, key in data["manner"].items():
        made.add(words, "MANNER", key)
    for key, all_words in data["in_which"].items():
        for words in all_words:
            made.add(words, "IN_WHICH", key)
    _spots(made, data["spot"])
    for terminal, all_words in data["word"].items():
        for words in all_words:
            made.add(words, terminal, words)


def _spots(made: Lexicon, data: dict[str, Any]) -> None:
    """Each end of a thing with each lead: "on the left end", "at its other side", "on the right"."""
    leads, tails = data["leads"], data["tails"]
    for key in (key for key in data if key not in ("leads", "tails")):
        for side in data[key]:
            for lead, tail in product(leads, tails):
                if tail or lead.endswith(("the", "its")):  # "on the left", but not "on left"
                    made.add(f"{lead} {side}{tail}", "SPOT", key)


def _quantities(made: Lexicon, data: dict[str, Any]) -> None:
    for word, value in data["number"].items():
        made.add(word, "COUNT", value)
    for word, value in data["size"].items():
        made.add(word, "SCALE", value)
    for table in ("nth", "weight", "shape", "compared", "often"):
        for word, value in data[table].items():
            terminal = "TIMES" if table == "often" else table.upper()
            made.add(word, terminal, tuple(value) if isinstance(value, list) else value)
    for word, angle in data["slope"].items():
        made.add(word, "ANGLE", angle)
    for word, axis in data["dimension"].items():
        made.add(word, "DIMENSION", axis)
    made.units |= flow_units(data["unit"]["volume"], data["unit"].pop("depth"))
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
        made.materials[name] = material
        for word in fields["words"]:
            made.materials[word] = material
            made.add(word, "MATERIAL", word)
    for word, color in data["color"].items():
        made.colors[word] = (color[0], color[1], color[2])
        made.add(word, "COLOR", word)


def _verbs(made: Lexicon, data: dict[str, Any]) -> None:
    for verb, fields in _entries("verbs", "verb", data):
        made.particles[verb] = tuple(fields.get("particles", ("",)))
        if fields.get("object"):
            made.objects.add(verb)
        for form in fields["forms"]:
            made.add(form, "VERB", verb)
        if "negated" in fields:
            made.negated[verb] = fields["negated"]


def _measures(made: Lexicon, data: dict[str, Any]) -> None:
    """What a length may be said to be after it: "10 cm diameter"."""
    for noun, what in data["measure"].items():
        made.add(noun, "MEASURE", what)


def _commands(made: Lexicon, data: dict[str, Any]) -> None:
    """What may be commanded, and what someone does."""
    for verb, fields in data["verb"].items():
        for form in fields.get("commands", ()):
            made.commands[tuple(form.split())] = verb
            made.add(form, "COMMAND", verb)
            head, *rest = form.split()
            made.third[(_plural(head), *rest)] = verb
            made.add(" ".join((_plural(head), *rest)), "THIRD", verb)


def _groups(made: Lexicon, data: dict[str, Any]) -> None:
    for arrangement, fields in _entries("nouns", "group", data):
        made.groups[arrangement] = fields["axis"]
        for word in fields["words"]:
            made.add(word, "GROUP", arrangement)
    for terminal, section in (("PART", "part"), ("GROUND", "ground")):
        for key, all_words in data[section].items():
            for word in all_words:
                made.add(word, terminal, key)


def _nouns(made: Lexicon, data: dict[str, Any]) -> None:
    catalogue = load_catalogue()
    for key, fields in _entries("nouns", "noun", data):
        asset = catalogue[fields["asset"]] if "asset" in fields else None
        noun = made.nouns[key] = _noun(key, fields, asset)
        words = [*fields.get("words", ()), *(_names(asset, made) if asset is not None else ())]
        for filled in fields.get("filled", []):
            made.add(filled, "NOUN", Named(noun.key, plural=False, filled=Filled("water")))
        _name(made, key, words, fields.get("plurals", ()))


def _noun(key: str, fields: dict[str, Any], asset: Asset | None) -> Noun:
    size: tuple[float, ...]
    if "size" in fields:
        size, mass = tuple(fields["size"]), None
    elif asset is not None:
        size, mass = _built(asset, fields["primitive"], fields.get("top")), asset.mass
    else:
        raise UserError(f"nouns.toml: noun {key!r} has neither an asset nor a size; give it one")
    return Noun(
        key=key,
        family=fields["class"],
        primitive=fields["primitive"],
        size=size,
        afloat=tuple(fields.get("afloat", size)),
        length=fields["length"],
        material=fields.get("material"),
        mass=mass,
        asset=asset.id if asset is not None else None,
        lies=fields.get("lies", False),
    )


def _built(asset: Asset, primitive: str, top: str | None) -> tuple[float, ...]:
    """The primitive's size that fills an asset's box [m]; a cylinder leaves out what stands off, such as a handle."""
    x, y, z = asset.size
    if top in asset.anchors:  # a user's own that has a shipped one's id may lack it
        z = asset.anchors[top][2]
    size: tuple[float, ...]
    if primitive == "sphere":
        size = (z / 2,)
    elif primitive == "cylinder":
        size = (min(x, y) / 2, z)
    elif primitive == "tank":  # the room inside its walls and above its floor
        size = (x - 2 * WALL, y - 2 * WALL, z - WALL)
    else:
        size = (x, y, z)
    return tuple(round(edge, 6) for edge in size)


def _names(asset: Asset, made: Lexicon) -> Iterator[str]:
    """What the catalogue calls an asset, less what has a meaning: "wooden table" is a material and a thing."""
    for name in asset.names:
        words = name.replace("-", " ").split()
        if words[0] not in made.materials and (len(words) > 1 or (words[0],) not in made.entries):
            yield " ".join(words)


def _name(made: Lexicon, key: str, words: Iterable[str], plurals: Iterable[str]) -> None:
    """Enter a thing's words, and their plurals."""
    for word in plurals:
        made.add(word, "NOUN", Named(key, plural=True))
    for word in words:
        if tuple(word.split()) not in made.entries:  # the catalogue calls a shelf "shelves", too
            made.add(word, "NOUN", Named(key, plural=False))
            made.add(_plural(word), "NOUN", Named(key, plural=True))


def _plural(word: str) -> str:
    if word.endswith("shelf"):
        return word[:-1] + "ves"
    if word.endswith("tty"):
        return word[:-1] + "ies"
    return word + ("es" if word.endswith(("s", "x", "ch", "sh")) else "s")


def _others(made: Lexicon) -> None:
    """The catalogue's other things: balls as spheres, the rest as solid stand-ins of their boxes."""
    known = {noun.asset for noun in made.nouns.values()}
    for asset in load_catalogue().values():
        if asset.id not in known:
            shape, length = ("sphere", "diameter") if asset.category == BALL else ("box", "z")
            size = _built(asset, shape, None)
            made.nouns[asset.id] = Noun(asset.id, "solid", shape, size, size, length, "wood", asset.mass, asset.id)
            _name(made, asset.id, list(_names(asset, made)), ())


def _robots(made: Lexicon) -> None:
    """Robots that can be pulled, with a policy that walks them; a number in a name is a word of its own: "go 2"."""
    for id, source in sources().items():
        if source.policies and source.size is not None:
            made.nouns[id] = Noun(id, "robot", "box", source.size, source.size, "x")
            _name(made, id, [re.sub(r"(?<=[a-z])(?=\d)", " ", called) for called in source.called], ())
