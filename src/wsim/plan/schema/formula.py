"""What must happen, as a tree: signal temporal logic over a closed list of predicates.

This is the JSON form. What each node means, and the sentence that it reads as, is in `wsim.judge.language`;
docs/objectives.md explains all of them. A name is a plan object's, or a prim's whole path ("/World/robot/arm").
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, ClassVar, Literal, Union, get_args

from pydantic import AfterValidator, ConfigDict, Field, model_validator

from wsim.plan.schema.base import NotNegative, Number, Positive, Strict, Vec3

DEEPEST = 40  # nodes above one another: deeper is no objective that a person reads, and would exhaust the stack
Named = Annotated[str, Field(pattern=r"^(/?[A-Za-z_][A-Za-z0-9_]*)(/[A-Za-z_][A-Za-z0-9_]*)*$", max_length=200)]
Place = Named | Vec3  # an object, or a point [m]


def _ordered(window: tuple[float, float | None]) -> tuple[float, float | None]:
    if window[1] is not None and window[1] < window[0]:
        raise ValueError(f"the window [{window[0]:g}, {window[1]:g}] s ends before it begins; swap the two")
    return window


# From and to, in seconds from the moment at which the formula is asked; None is the end of the recording.
Window = Annotated[tuple[NotNegative, NotNegative | None], AfterValidator(_ordered)]


def quantity(unit: str, *default: float | None, **bounds: Any) -> Any:
    """A field that holds a number of a unit; required where no default is given."""
    return Field(*default, json_schema_extra={"unit": unit}, **bounds)


class Node(Strict):
    """A formula. `&`, `|` and `~` combine formulas; `until` and `then` put them in time."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, frozen=True)

    def parts(self) -> tuple[Formula, ...]:
        """The formulas that this one is made of."""
        return ()

    def walk(self) -> Iterator[Node]:
        """This node and all below it."""
        yield self
        for part in self.parts():
            yield from part.walk()

    def names(self) -> set[str]:
        """Every object that the formula speaks of."""
        return {name for node in self.walk() if isinstance(node, Predicate) for name in node.objects_named()}

    @model_validator(mode="after")
    def _shallow(self) -> Node:
        if self.depth() > DEEPEST:
            raise ValueError(f"formulas are nested more than {DEEPEST} deep; split the objective in several")
        return self

    def depth(self) -> int:
        """How many nodes stand above one another."""
        return 1 + max((part.depth() for part in self.parts()), default=0)

    def __and__(self, other: Formula) -> And:
        mine = self.of if isinstance(self, And) else (self,)
        return And.model_validate({"of": (*mine, other)})

    def __or__(self, other: Formula) -> Or:
        mine = self.of if isinstance(self, Or) else (self,)
        return Or.model_validate({"of": (*mine, other)})

    def __invert__(self) -> Not:
        return Not.model_validate({"of": self})

    def until(self, other: Formula, window: tuple[float, float | None] | None = None) -> Until:
        """This holds at each moment until the other does."""
        return Until.model_validate({"hold": self, "goal": other, "window": window})

    def then(self, other: Formula, window: tuple[float, float | None] | None = None) -> Then:
        """First this, and afterwards the other."""
        events, windows = (self.events, self.windows) if isinstance(self, Then) else ((self,), ())
        return Then.model_validate({"events": (*events, other), "windows": (*windows, window)})


# ---- operators
class And(Node):
    """All of them hold."""

    op: Literal["and"] = "and"
    of: tuple[Formula, ...] = Field(min_length=2, max_length=100)

    def parts(self) -> tuple[Formula, ...]:
        """The conjuncts."""
        return self.of


class Or(Node):
    """At least one of them holds."""

    op: Literal["or"] = "or"
    of: tuple[Formula, ...] = Field(min_length=2, max_length=100)

    def parts(self) -> tuple[Formula, ...]:
        """The disjuncts."""
        return self.of


class Not(Node):
    """It does not hold."""

    op: Literal["not"] = "not"
    of: Formula

    def parts(self) -> tuple[Formula, ...]:
        """What is denied."""
        return (self.of,)


class Always(Node):
    """It holds at each frame of the window; without a window, to the end."""

    op: Literal["always"] = "always"
    window: Window | None = None
    of: Formula

    def parts(self) -> tuple[Formula, ...]:
        """What holds."""
        return (self.of,)


class Eventually(Node):
    """It holds at some frame of the window; without a window, up to the end."""

    op: Literal["eventually"] = "eventually"
    window: Window | None = None
    of: Formula

    def parts(self) -> tuple[Formula, ...]:
        """What comes to hold."""
        return (self.of,)


class Finally(Node):
    """It holds at each of the recording's last seconds; without a number, over the judge's final window."""

    op: Literal["finally"] = "finally"
    seconds: Positive | None = None
    of: Formula

    def parts(self) -> tuple[Formula, ...]:
        """What holds at the end."""
        return (self.of,)


class Until(Node):
    """`hold` holds at each frame before one of the window at which `goal` holds."""

    op: Literal["until"] = "until"
    window: Window | None = None
    hold: Formula
    goal: Formula

    def parts(self) -> tuple[Formula, ...]:
        """What holds, and until what."""
        return (self.hold, self.goal)


class Then(Node):
    """The events happen one after another, each in its window after the one before; None: any time after it."""

    op: Literal["then"] = "then"
    events: tuple[Formula, ...] = Field(min_length=2, max_length=20)
    windows: tuple[Window | None, ...]

    @model_validator(mode="after")
    def _matched(self) -> Then:
        if len(self.windows) != len(self.events) - 1:
            raise ValueError(
                f"then: {len(self.events)} events have {len(self.events) - 1} windows between them, not "
                f"{len(self.windows)}"
            )
        return self

    def parts(self) -> tuple[Formula, ...]:
        """The events."""
        return self.events


# ---- predicates
class Predicate(Node):
    """Something that a frame of a recording shows, with a margin. `alone` is how it is read outside of any time."""

    alone: ClassVar[Literal["always", "eventually", "finally", "now"]] = "always"
    NAMES: ClassVar[tuple[str, ...]] = ("object", "ref", "fluid", "target", "center", "on")

    def objects_named(self) -> set[str]:
        """The objects that it names."""
        return {name for field in self.NAMES if isinstance(name := getattr(self, field, None), str)}


class Reaches(Predicate):
    """The object's centre comes to a point, or its surface to another object's."""

    op: Literal["reaches"] = "reaches"
    alone: ClassVar[Literal["eventually"]] = "eventually"
    object: Named
    target: Place
    within: Positive | None = quantity("m", None)


class StaysWithin(Predicate):
    """The object's centre stays within a distance of a point, or of another object's centre."""

    op: Literal["stays_within"] = "stays_within"
    object: Named
    center: Place
    radius: Positive = quantity("m")


class RestsOn(Predicate):
    """The object stands on another from above, over it, and does not move against it."""

    op: Literal["rests_on"] = "rests_on"
    alone: ClassVar[Literal["finally"]] = "finally"
    object: Named
    ref: Named
    within: Positive | None = quantity("m", None)


class SupportedBy(Predicate):
    """The object touches another, and contact forces carry at least a share of its weight."""

    op: Literal["supported_by"] = "supported_by"
    alone: ClassVar[Literal["finally"]] = "finally"
    object: Named
    ref: Named
    share: Positive = quantity("1", 0.5)


class ContainedIn(Predicate):
    """All of the object is between the walls, above the floor and below the rim of a container."""

    op: Literal["contained_in"] = "contained_in"
    alone: ClassVar[Literal["finally"]] = "finally"
    object: Named
    ref: Named
    within: NotNegative | None = quantity("m", None)


class Floats(Predicate):
    """The object's draft is that of Archimedes, for its own shape and mass."""

    op: Literal["floats"] = "floats"
    alone: ClassVar[Literal["finally"]] = "finally"
    object: Named
    fluid: Named
    within: Positive | None = quantity("m", None)


class Sinks(Predicate):
    """The object is under the surface, and on the floor of the fluid's container."""

    op: Literal["sinks"] = "sinks"
    alone: ClassVar[Literal["finally"]] = "finally"
    object: Named
    fluid: Named
    within: Positive | None = quantity("m", None)


class Submerged(Predicate):
    """The object's highest point is below the surface."""

    op: Literal["submerged"] = "submerged"
    alone: ClassVar[Literal["finally"]] = "finally"
    object: Named
    fluid: Named


class Touches(Predicate):
    """The two surfaces meet."""

    op: Literal["touches"] = "touches"
    alone: ClassVar[Literal["eventually"]] = "eventually"
    object: Named
    ref: Named
    within: Positive | None = quantity("m", None)


class NeverTouches(Predicate):
    """There is a gap between the two surfaces."""

    op: Literal["never_touches"] = "never_touches"
    object: Named
    ref: Named
    clearance: NotNegative = quantity("m", 0.0)


class Upright(Predicate):
    """What pointed up at the start points up."""

    op: Literal["upright"] = "upright"
    object: Named
    within: Positive | None = quantity("deg", None, le=180.0)


class SpeedBetween(Predicate):
    """The speed of the object's centre of mass is in a range."""

    op: Literal["speed_between"] = "speed_between"
    object: Named
    low: NotNegative = quantity("m/s")
    high: NotNegative = quantity("m/s")

    @model_validator(mode="after")
    def _range(self) -> SpeedBetween:
        if self.high < self.low:
            raise ValueError(f"speed_between: low {self.low:g} m/s is above high {self.high:g} m/s; swap them")
        return self


class FollowsPath(Predicate):
    """The object's centre keeps to a polyline and comes to its points in their order."""

    op: Literal["follows_path"] = "follows_path"
    object: Named
    path: tuple[Vec3, ...] = Field(min_length=2, max_length=1000)
    within: Positive | None = quantity("m", None)


class Crosses(Predicate):
    """The object's centre is beyond a plane across an axis, on the other side of it than at the start."""

    op: Literal["crosses"] = "crosses"
    alone: ClassVar[Literal["eventually"]] = "eventually"
    object: Named
    axis: Literal["x", "y", "z"]
    at: Number = quantity("m")


class Ordered(Predicate):
    """The events happen for the first time in this order."""

    op: Literal["ordered"] = "ordered"
    alone: ClassVar[Literal["now"]] = "now"
    events: tuple[Formula, ...] = Field(min_length=2, max_length=20)

    def parts(self) -> tuple[Formula, ...]:
        """The events."""
        return self.events


class Swings(Predicate):
    """The object swings with a period, and to an amplitude; without a period, that of a physical pendulum."""

    op: Literal["swings"] = "swings"
    object: Named
    period: Positive | None = quantity("s", None)
    amplitude: Positive | None = quantity("deg", None, le=180.0)
    share: Positive = quantity("1", 0.03, lt=1.0)


class RollsWithoutSlip(Predicate):
    """The point of a round object that is on the ground, or on another object, stands still on it."""

    op: Literal["rolls_without_slip"] = "rolls_without_slip"
    object: Named
    on: Named | None = None
    share: Positive = quantity("1", 0.05, lt=1.0)


class Settles(Predicate):
    """The object neither moves nor turns."""

    op: Literal["settles"] = "settles"
    alone: ClassVar[Literal["finally"]] = "finally"
    object: Named
    speed: Positive | None = quantity("m/s", None)


class Conserves(Predicate):
    """Energy or momentum of the objects (all, if none is named), or the mass of a fluid, is as at the start."""

    op: Literal["conserves"] = "conserves"
    what: Literal["energy", "momentum", "mass"]
    objects: tuple[Named, ...] = ()
    share: Positive = quantity("1", 0.02, lt=1.0)

    @model_validator(mode="after")
    def _of_a_fluid(self) -> Conserves:
        if self.what == "mass" and len(self.objects) != 1:
            raise ValueError(f"conserves: mass is a fluid's; name one fluid, not {len(self.objects)} objects")
        return self

    def objects_named(self) -> set[str]:
        """The objects that it names."""
        return set(self.objects)


class CollidesWith(Predicate):
    """The two touch and their speed to each other changes at once, with a restitution if one is given."""

    op: Literal["collides_with"] = "collides_with"
    alone: ClassVar[Literal["eventually"]] = "eventually"
    object: Named
    ref: Named
    restitution: NotNegative | None = quantity("1", None, le=1.0)
    within: Positive = quantity("1", 0.1, lt=1.0)


class FillsTo(Predicate):
    """The fluid's surface stands at a height above the floor of its container."""

    op: Literal["fills_to"] = "fills_to"
    alone: ClassVar[Literal["finally"]] = "finally"
    fluid: Named
    level: Positive = quantity("m")
    within: Positive | None = quantity("m", None)


class StaysInside(Predicate):
    """The object's centre, or all but a share of a fluid, is between the walls and above the floor."""

    op: Literal["stays_inside"] = "stays_inside"
    object: Named
    ref: Named
    share: Positive = quantity("1", 0.01, lt=1.0)


Formula = Annotated[
    Union[  # noqa: UP007 - the discriminator reads a list better than twenty bars
        And, Or, Not, Always, Eventually, Finally, Until, Then,
        Reaches, StaysWithin, RestsOn, SupportedBy, ContainedIn, Floats, Sinks, Submerged, Touches, NeverTouches,
        Upright, SpeedBetween, FollowsPath, Crosses, Ordered, Swings, RollsWithoutSlip, Settles, Conserves,
        CollidesWith, FillsTo, StaysInside,
    ],
    Field(discriminator="op"),
]  # fmt: skip

for _node in (And, Or, Not, Always, Eventually, Finally, Until, Then, Ordered):
    _node.model_rebuild()

VOCABULARY: dict[str, type[Predicate]] = {
    kind.model_fields["op"].default: kind for kind in get_args(get_args(Formula)[0]) if issubclass(kind, Predicate)
}
