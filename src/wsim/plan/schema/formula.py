"""What must happen, as a tree: signal temporal logic over a closed list of predicates.

This is the JSON form. What each node means, and the sentence that it reads as, is in `wsim.judge.language`;
docs/objectives.md explains all of them. A name is a plan object's, or a prim's whole path ("/World/robot/arm").
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, Union

from pydantic import Field, model_validator

from wsim.plan.schema.base import NotNegative, Number, Positive, Vec3
from wsim.plan.schema.nodes import Always, And, Eventually, Finally, Node, Not, Or, Then, Until

__all__ = ["VOCABULARY", "Always", "And", "Eventually", "Finally", "Formula", "Node", "Not", "Or", "Then", "Until"]

Named = Annotated[str, Field(pattern=r"^(/?[A-Za-z_][A-Za-z0-9_]*)(/[A-Za-z_][A-Za-z0-9_]*)*$", max_length=200)]
Place = Named | Vec3  # an object, or a point [m]


def quantity(unit: str, *default: float | None, **bounds: Any) -> Any:
    """A field that holds a number of a unit; required where no default is given."""
    return Field(*default, json_schema_extra={"unit": unit}, **bounds)


class Predicate(Node):
    """Something that a frame of a recording shows, with a margin. `alone` is how it is read outside of any time."""

    op: str
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
    within: NotNegative = quantity("m", 0.0)


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


class Pushes(Predicate):
    """The object drives another on before it, in contact, for a while: no blow."""

    op: Literal["pushes"] = "pushes"
    alone: ClassVar[Literal["eventually"]] = "eventually"
    object: Named
    ref: Named
    least: Positive = quantity("s", 0.1)


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
    within: NotNegative = quantity("m", 0.0)


def _ordered_range(op: str, low: float, high: float) -> None:
    if high < low:
        raise ValueError(f"{op}: low {low:g} is above high {high:g}; swap them")


class _Ranged(Predicate):
    """A number of the object, against another object if one is named, in a range; either end may be negative."""

    object: Named
    axis: Literal["x", "y", "z"]
    low: Number
    high: Number
    of: Named | None = None
    NAMES: ClassVar[tuple[str, ...]] = (*Predicate.NAMES, "of")

    @model_validator(mode="after")
    def _range(self) -> _Ranged:
        _ordered_range(self.op, self.low, self.high)
        return self


class TurnedBetween(_Ranged):
    """The object has turned about an axis of the world by an angle since the start; of another: a joint's angle."""

    op: Literal["turned_between"] = "turned_between"
    alone: ClassVar[Literal["finally"]] = "finally"
    low: Number = quantity("deg")
    high: Number = quantity("deg")


class SpinBetween(_Ranged):
    """The object turns about an axis of the world at a rate, right-handed; of another: a joint's rate."""

    op: Literal["spin_between"] = "spin_between"
    low: Number = quantity("deg/s")
    high: Number = quantity("deg/s")


class GoneBetween(_Ranged):
    """The object has gone along an axis by a way since the start; of another: as seen from that."""

    op: Literal["gone_between"] = "gone_between"
    alone: ClassVar[Literal["finally"]] = "finally"
    low: Number = quantity("m")
    high: Number = quantity("m")


class OwnSpinBetween(Predicate):
    """The object turns about an axis of its own, as it started along the world's, at a rate, however it moves."""

    op: Literal["own_spin_between"] = "own_spin_between"
    object: Named
    axis: Literal["x", "y", "z"]
    low: Number = quantity("deg/s")
    high: Number = quantity("deg/s")

    @model_validator(mode="after")
    def _range(self) -> OwnSpinBetween:
        _ordered_range(self.op, self.low, self.high)
        return self


class TiltBetween(Predicate):
    """What pointed up at the start leans towards +x or +y of the world by an angle; the other way it is negative."""

    op: Literal["tilt_between"] = "tilt_between"
    alone: ClassVar[Literal["finally"]] = "finally"
    object: Named
    axis: Literal["x", "y"]
    low: Number = quantity("deg")
    high: Number = quantity("deg")

    @model_validator(mode="after")
    def _range(self) -> TiltBetween:
        _ordered_range(self.op, self.low, self.high)
        return self


class DiesDown(Predicate):
    """The object goes to and fro, up and down along an axis, each time at most a share as far as the time before."""

    op: Literal["dies_down"] = "dies_down"
    alone: ClassVar[Literal["finally"]] = "finally"
    object: Named
    axis: Literal["x", "y", "z"]
    share: Positive = quantity("1", 0.98, le=1.0)


class ClimbsTo(Predicate):
    """After its lowest place so far the object comes up again by a share of its start's height over that."""

    op: Literal["climbs_to"] = "climbs_to"
    alone: ClassVar[Literal["eventually"]] = "eventually"
    object: Named
    share: Positive = quantity("1")


class StopsBefore(Predicate):
    """The object stands still, and has not touched the other on its way."""

    op: Literal["stops_before"] = "stops_before"
    alone: ClassVar[Literal["finally"]] = "finally"
    object: Named
    ref: Named
    within: Positive | None = quantity("m", None)


class SwirlsBetween(Predicate):
    """The fluid turns as a whole about its middle, about an axis of the world, at a rate: a vortex."""

    op: Literal["swirls_between"] = "swirls_between"
    fluid: Named
    axis: Literal["x", "y", "z"]
    low: Number = quantity("deg/s")
    high: Number = quantity("deg/s")

    @model_validator(mode="after")
    def _range(self) -> SwirlsBetween:
        _ordered_range(self.op, self.low, self.high)
        return self


class LevelIn(Predicate):
    """What of the fluid is in a vessel stands there at a height above the vessel's floor."""

    op: Literal["level_in"] = "level_in"
    alone: ClassVar[Literal["finally"]] = "finally"
    fluid: Named
    ref: Named
    level: Positive = quantity("m")
    within: Positive | None = quantity("m", None)


class BouncesTo(Predicate):
    """After a touch of the other, the object's lowest point rises to a height over where it touched."""

    op: Literal["bounces_to"] = "bounces_to"
    alone: ClassVar[Literal["eventually"]] = "eventually"
    object: Named
    ref: Named
    height: Positive = quantity("m")
    within: Positive | None = quantity("m", None)


class Counts(Predicate):
    """At least so many of some objects are in a container, below its rim."""

    op: Literal["counts"] = "counts"
    alone: ClassVar[Literal["finally"]] = "finally"
    ref: Named
    least: Positive = quantity("1")
    objects: tuple[Named, ...] = Field(min_length=1, max_length=1000)

    def objects_named(self) -> set[str]:
        """The container, and what is counted."""
        return {self.ref, *self.objects}


_KINDS: tuple[type[Node], ...] = (
    And, Or, Not, Always, Eventually, Finally, Until, Then,
    Reaches, StaysWithin, RestsOn, SupportedBy, ContainedIn, Floats, Sinks, Submerged, Touches, NeverTouches,
    Upright, SpeedBetween, FollowsPath, Crosses, Ordered, Swings, RollsWithoutSlip, Settles, Conserves,
    CollidesWith, Pushes, FillsTo, StaysInside, TurnedBetween, SpinBetween, GoneBetween, BouncesTo, Counts,
    OwnSpinBetween, TiltBetween, DiesDown, ClimbsTo, StopsBefore, SwirlsBetween, LevelIn,
)  # fmt: skip
if TYPE_CHECKING:
    Formula = Node
else:
    Formula = Annotated[Union[_KINDS], Field(discriminator="op")]  # noqa: UP007 - made of a list

for _kind in (And, Or, Not, Always, Eventually, Finally, Until, Then, Ordered):
    _kind.model_rebuild(_types_namespace={"Formula": Formula})

VOCABULARY: dict[str, type[Predicate]] = {
    kind.model_fields["op"].default: kind for kind in _KINDS if issubclass(kind, Predicate)
}
