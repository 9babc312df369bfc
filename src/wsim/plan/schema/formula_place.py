"""Where a body is, how it stands, and how far and fast it has gone and turned: predicates of the language."""

from __future__ import annotations

from typing import ClassVar, Literal

from pydantic import Field, model_validator

from wsim.plan.schema.base import NotNegative, Number, Positive, Vec3
from wsim.plan.schema.predicate import Named, Place, Predicate, Ranged, ordered_range, quantity


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


class ContainedIn(Predicate):
    """All of the object is between walls, above the floor and below the rim of a container: a tank, a bucket."""

    op: Literal["contained_in"] = "contained_in"
    alone: ClassVar[Literal["finally"]] = "finally"
    object: Named
    ref: Named
    within: NotNegative | None = quantity("m", None)


class StaysInside(Predicate):
    """The object's centre, or all but a share of a fluid, is between the walls and above the floor."""

    op: Literal["stays_inside"] = "stays_inside"
    object: Named
    ref: Named
    share: Positive = quantity("1", 0.01, lt=1.0)
    within: NotNegative = quantity("m", 0.0)


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


class TurnedBetween(Ranged):
    """The object has turned about an axis of the world by an angle since the start; of another: a joint's angle."""

    op: Literal["turned_between"] = "turned_between"
    alone: ClassVar[Literal["finally"]] = "finally"
    low: Number = quantity("deg")
    high: Number = quantity("deg")


class SpinBetween(Ranged):
    """The object turns about an axis of the world at a rate, right-handed; of another: a joint's rate."""

    op: Literal["spin_between"] = "spin_between"
    low: Number = quantity("deg/s")
    high: Number = quantity("deg/s")


class GoneBetween(Ranged):
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
        ordered_range(self.op, self.low, self.high)
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
        ordered_range(self.op, self.low, self.high)
        return self


PREDICATES: tuple[type[Predicate], ...] = (
    Reaches, StaysWithin, ContainedIn, StaysInside, Upright, SpeedBetween, FollowsPath, Crosses, Counts,
    TurnedBetween, SpinBetween, GoneBetween, OwnSpinBetween, TiltBetween,
)  # fmt: skip
