"""What a prompt says, as its grammar has it: things, what they do, and where."""

from __future__ import annotations

from dataclasses import dataclass, field

from wsim.rules.lexicon import Side
from wsim.rules.liquids import Filled


@dataclass
class Phrase:
    """A thing as the prompt names it."""

    kind: str  # a noun's key, or "group", "water", "ground", "part", "pronoun"
    words: str
    definite: bool = False
    plural: bool = False
    count: int | None = None
    material: str | None = None
    color: str | None = None
    scale: float | None = None  # against the default size
    length: float | None = None  # [m], of whatever the noun's length is
    measures: dict[str, float] = field(
        default_factory=dict
    )  # "x", "y", "z", "radius", "diameter" [m], "mass", "density"
    edges: tuple[float, float, float] | None = None  # [m]
    angle: float | None = None  # [deg], of an incline
    arrangement: str = ""  # of a group: "stack" or "row"
    members: Phrase | None = None  # of a group
    part: str | None = None  # "surface", "top", "bottom", "end", "middle", "edge", of `owner`
    owner: Phrase | None = None
    choice: str = ""  # of some spoken of before: "nth", "some", "other", "all", "described"; of a part: its side
    nth: int | None = None  # 1: the first; -1: the last
    masses: tuple[float, ...] = ()  # [kg], of several that are alike but for that
    weight: float | None = None  # against the usual: what is heavy is above 1
    shape: tuple[str, float] | None = None  # the axis along which it is larger than usual, and how much: "tall"
    clauses: list[Action] = field(default_factory=list)  # "that sinks", "floating"
    only: bool = False  # "only the cork"
    filled: Filled | None = None  # a container that was said to hold a liquid
    share: float | None = None  # of its height that a container is full; 0 is empty
    liquid: str = "water"  # of one that is itself named: a liquid's key
    volume: float | None = None  # the same: how much of it [m^3]
    at: int = -1  # where its words begin in the prompt as it is read
    places: list[Place] = field(default_factory=list)

    @property
    def adorned(self) -> bool:
        """Whether it is said of what it is made, how large, how many or where."""
        own = (self.material, self.color, self.scale, self.length, self.measures, self.edges, self.filled, self.volume)
        return any(own) or self.plural or (self.count or 1) > 1 or bool(self.places)


@dataclass
class Place:
    """Where something is, goes to or comes from, how fast, and for how long."""

    preposition: str  # a key of the lexicon, or "side", "between", "speed", "spin", "angle", "share", "time", ...
    phrase: Phrase | None = None
    other: Phrase | None = None  # the second of "between", or of a "friction" or "restitution" between two
    side: Side | None = None
    length: float | None = None  # [m]: "from 0.5 m", "0.2 m in front of"
    value: float | None = None  # [m/s], [deg/s], [deg], [s] or [1]
    direction: str | None = None
    words: str = ""
    full: Phrase | None = None  # what something is said to be filled with, and how much


@dataclass
class Action:
    """What a thing does."""

    verb: str
    words: str
    target: Phrase | None = None
    particle: str | None = None
    relative: bool = False  # said of a thing that the words before name: "that runs"
    at: tuple[int, int] = (-1, -1)  # from and to where its words are in the prompt as it is read
    places: list[Place] = field(default_factory=list)


@dataclass
class Clause:
    """Things, and what they all do."""

    subjects: list[Phrase] = field(default_factory=list)
    actions: list[Action] = field(default_factory=list)
    inverted: bool = False  # "on a table stands a lamp": its things come last
    given: bool = False  # after "with": what the things before have
    within: Place | None = None  # of "a tank in which": where all of them are
    then: bool = False  # after "then": what comes later
    again: bool = False  # of things that a clause before has named, with all that is said of where they are

    @property
    def words(self) -> str:
        """The clause, near enough for a message."""
        return " ".join([", ".join(phrase.words for phrase in self.subjects), *(a.words for a in self.actions)]).strip()
