"""What a prompt speaks of: things, where they are, what they are to do."""

from __future__ import annotations

from dataclasses import dataclass, field

from wsim.plan.schema import Assumption, AssumptionKind
from wsim.rules.lexicon import Noun, lexicon
from wsim.rules.liquids import Filled, Liquid, colored, liquids
from wsim.rules.phrases import Action, Phrase

ROUND = ("sphere", "cylinder", "capsule")
CARRIERS = ("belt", "turntable")  # families of what moves under what stands on it


@dataclass
class Beside:
    """Where a thing is by another: a row of the plan to be."""

    predicate: str  # a side, a facing, or "between"
    ref: Thing
    other: Thing | None = None
    gap: float | None = None  # [m]
    loose: bool = False  # on whichever side


@dataclass(eq=False)
class Thing:
    """One phrase's objects: alike, and doing the same."""

    phrase: Phrase
    count: int
    arrangement: str = ""  # "stack": on one another; "row": behind one another
    place: str | None = None  # "water" or "ground"
    support: Thing | None = None  # what it stands on or drops on, if that is another thing
    bridges: Thing | None = None  # the second of two that it lies on
    inside: Thing | None = None  # the vessel that it is in
    beside: list[Beside] = field(default_factory=list)
    does: list[str] = field(default_factory=list)  # float, sink, submerge, drop, rest, roll, slide, topple, ...
    drop_height: float | None = None  # [m] above what it drops on
    target: Thing | None = None  # what it rolls, slides or flies into
    meets: Thing | None = None  # what comes at it as it comes at that
    path: Thing | None = None  # the ramp that it is on
    off: bool = False  # leaves its support
    into: Thing | None = None  # what it comes down in or on, after it has left what it was on
    over: Thing | None = None  # the wall or post that it is thrown over
    side: str | None = (
        None  # the end of its support: "left", "right", "one", "other", "middle"; of a seesaw: what goes down
    )
    times: int | None = None  # that it bounces, at least
    manners: set[str] = field(default_factory=set)  # "upright", "head_on", "from_rest", "still", ...
    of: int = 1  # how many the prompt spoke of, before one was chosen
    speed: float | None = None  # [m/s]
    delay: float | None = None  # [s] after which it is let go, or pushed
    force: float | None = None  # that pushes it [N]
    pushed_for: float | None = None  # [s]
    lasts: float | None = None  # for which it goes [s]
    way: float | None = None  # that it drives [m]
    angle: float | None = None  # [deg] of a throw, or of a pendulum at the start
    direction: str | None = None
    rod: Phrase | None = None  # what it hangs on
    spin: float | None = None  # of what turns [deg/s]
    share: float | None = None  # of its start's height, that it comes up to again
    surface: dict[str, float] = field(default_factory=dict)  # "friction", "restitution": as it touches anything
    pairs: list[tuple[Thing | None, str, float]] = field(default_factory=list)  # the same, against one; None: ground

    def said(self, name: str, other: Thing | None) -> float | None:
        """What the prompt says of a coefficient between this and another thing, or the ground."""
        for first, second in ((self, other), (other, self)):
            for partner, what, value in first.pairs if first is not None else ():
                if what == name and partner is second:
                    return value
        own = [one.surface[name] for one in (self, other) if one is not None and name in one.surface]
        return min(own, default=None)

    @property
    def kind(self) -> str:
        """What one of them is: a noun's key."""
        return self.phrase.kind

    @property
    def noun(self) -> Noun:
        """The lexicon's entry."""
        return lexicon().nouns[self.phrase.kind]

    @property
    def round(self) -> bool:
        """Whether it can roll."""
        return self.noun.primitive == "sphere"

    @property
    def group(self) -> bool:
        """Whether the prompt speaks of its objects as of one: a stack, a row."""
        return bool(self.arrangement)

    @property
    def words(self) -> str:
        """The prompt's words for it."""
        return self.phrase.words


@dataclass
class Pour:
    """Water that is poured."""

    vessel: Thing | None  # None: into a tank
    height: float | None  # [m] above the rim
    level: float | None = None  # [m] that it is to stand at


@dataclass
class Flow:
    """What lets fluid into a tank or a vessel, or out of it.

    Attributes:
        kind: "tap", "rain" or "drain".
        words: The prompt's for it.
        vessel: What it is over or in; None is the tank.
        rate: How much comes [m^3/s]; of rain how much falls on an area [m/s].
        height: Of its mouth over the rim [m].
        width: Of a hole [m].
        start: When it opens [s].
        lasts: How long it is open [s].
        level: Up to which it fills [m].
        volume: That it pours [m^3].
        wall: Whether a hole is in a wall, not in the floor.
        empties: Whether a hole is said to let out all of it.
        on: What rain falls on.
        ground: Whether that is the ground.
        said: The numbers of these that the prompt gives; the scene adds to the others.
    """

    kind: str
    words: str
    vessel: Thing | None = None
    rate: float | None = None
    height: float | None = None
    width: float | None = None
    start: float | None = None
    lasts: float | None = None
    level: float | None = None
    volume: float | None = None
    wall: bool = False
    empties: bool = False
    on: Thing | None = None
    ground: bool = False
    said: dict[str, float] = field(default_factory=dict)

    def settle(self) -> None:
        """Keep what the prompt has said, before the scene adds to it."""
        names = ("rate", "width", "start", "lasts", "volume", "height")
        self.said = {name: value for name in names if (value := getattr(self, name)) is not None}


@dataclass
class Cast:
    """All that the prompt speaks of."""

    things: list[Thing] = field(default_factory=list)
    tank: str | None = None  # the prompt's words for it, if it was named
    water: str | None = None  # the same, of what fills it
    filled: Filled | None = None  # with what, and how much, where that is said
    share: float | None = None  # of its height that it is full; 0 where it is said to be empty
    stands: bool = False  # whether it is said to hold that from the start
    pour: Pour | None = None
    flows: list[Flow] = field(default_factory=list)  # what comes in and goes out
    ground: str | None = None  # the ground's material, if it is said
    only: list[tuple[Thing, str]] = field(default_factory=list)  # what alone of all in the water does what
    said: list[tuple[Thing, Action]] = field(default_factory=list)  # all that things are said to do
    named: list[tuple[Thing, Phrase]] = field(default_factory=list)  # by which words each is named
    office: str | None = None  # the prompt's words for one that is patrolled
    duration: float | None = None  # [s], if it was given
    assumptions: list[Assumption] = field(default_factory=list)

    def assume(
        self, subject: str, choice: str, why: str, kind: AssumptionKind | None = None, value: str | None = None
    ) -> None:
        """Note a choice that the prompt left open; its kind and value, where a person may be asked for another."""
        self.assumptions.append(Assumption(subject=subject, choice=choice, why=why, kind=kind, value=value))

    def assume_height(self, subject: str, choice: str, height: float) -> None:
        """Note from how high a thing comes [m]; the choice has a place for it."""
        length = f"{height:g} m"
        self.assume(subject, choice.format(length), "the prompt gives no height", "height", length)

    def drop_height(self, thing: Thing, usual: float, above: str) -> float:
        """From how high above something a thing drops [m]; the usual is noted where the prompt leaves it open."""
        if thing.drop_height is not None:
            return thing.drop_height
        self.assume_height(thing.words, f"dropped from {{}} above {above}", usual)
        return usual

    @property
    def liquid(self) -> Liquid:
        """What fills the tank or is poured."""
        if self.filled is None:
            return liquids()["water"]
        color = lexicon().colors[self.filled.color] if self.filled.color is not None else None
        return colored(liquids()[self.filled.liquid], color)

    @property
    def wet(self) -> bool:
        """Whether the scene has a tank of water that stands in it from the start."""
        if self.pour is not None or self.flows:
            return False
        return self.tank is not None or self.water is not None or any(thing.place == "water" for thing in self.things)

    def family(self, *families: str) -> list[Thing]:
        """The things of some families, in the prompt's order."""
        return [thing for thing in self.things if thing.noun.family in families]
