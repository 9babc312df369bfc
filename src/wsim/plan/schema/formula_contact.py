"""What a body touches, what carries it and what it hits: predicates of the language of objectives."""

from __future__ import annotations

from typing import ClassVar, Literal

from pydantic import Field

from wsim.plan.schema.base import NotNegative, Positive
from wsim.plan.schema.predicate import Named, Predicate, quantity


class RestsOn(Predicate):
    """The object stands on another from above, over it, and does not move against it."""

    op: Literal["rests_on"] = "rests_on"
    alone: ClassVar[Literal["finally"]] = "finally"
    object: Named
    ref: Named
    within: Positive | None = quantity("m", None)


class LiesOn(Predicate):
    """The object is over another and touches it from above, still or not."""

    op: Literal["lies_on"] = "lies_on"
    alone: ClassVar[Literal["finally"]] = "finally"
    object: Named
    ref: Named
    within: Positive | None = quantity("m", None)


class StaysOn(Predicate):
    """The object is over another and touches it, however the two tilt."""

    op: Literal["stays_on"] = "stays_on"
    object: Named
    ref: Named
    within: Positive | None = quantity("m", None)


class WeighsOn(Predicate):
    """Contact forces, some of them of the other, are the object's weight less what fluid bears, to a share of it."""

    op: Literal["weighs_on"] = "weighs_on"
    alone: ClassVar[Literal["finally"]] = "finally"
    object: Named
    ref: Named
    share: Positive = quantity("1", 0.25, lt=1.0)


class SupportedBy(Predicate):
    """The object touches another that bears of it, and contact forces carry at least a share of its weight."""

    op: Literal["supported_by"] = "supported_by"
    alone: ClassVar[Literal["finally"]] = "finally"
    object: Named
    ref: Named
    share: Positive = quantity("1", 0.5)


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


class TouchesOnly(Predicate):
    """Nothing presses on the object, or on a part of it, but some others, and its own parts."""

    op: Literal["touches_only"] = "touches_only"
    object: Named
    objects: tuple[Named, ...] = Field(min_length=1, max_length=1000)

    def objects_named(self) -> set[str]:
        """The object, and what it may touch."""
        return {self.object, *self.objects}


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


class StopsBefore(Predicate):
    """The object stands still, and has not touched the other on its way."""

    op: Literal["stops_before"] = "stops_before"
    alone: ClassVar[Literal["finally"]] = "finally"
    object: Named
    ref: Named
    within: Positive | None = quantity("m", None)


class BouncesTo(Predicate):
    """After a touch of the other, the object's lowest point rises to a height over where it touched."""

    op: Literal["bounces_to"] = "bounces_to"
    alone: ClassVar[Literal["eventually"]] = "eventually"
    object: Named
    ref: Named
    height: Positive = quantity("m")
    within: Positive | None = quantity("m", None)


PREDICATES: tuple[type[Predicate], ...] = (
    RestsOn, LiesOn, StaysOn, WeighsOn, SupportedBy, Touches, NeverTouches, TouchesOnly, RollsWithoutSlip, Settles,
    CollidesWith, Pushes, StopsBefore, BouncesTo,
)  # fmt: skip
