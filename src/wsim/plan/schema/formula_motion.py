"""How a motion goes on: predicates of the language of objectives."""

from __future__ import annotations

from typing import ClassVar, Literal

from pydantic import model_validator

from wsim.plan.schema.base import Positive
from wsim.plan.schema.predicate import Named, Predicate, quantity


class Swings(Predicate):
    """The object swings with a period, and to an amplitude; without a period, that of a physical pendulum."""

    op: Literal["swings"] = "swings"
    object: Named
    period: Positive | None = quantity("s", None)
    amplitude: Positive | None = quantity("deg", None, le=180.0)
    share: Positive = quantity("1", 0.03, lt=1.0)


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


class Moves(Predicate):
    """The object's centre ends so far, on the level, from where it started; in a direction, if one is given."""

    op: Literal["moves"] = "moves"
    alone: ClassVar[Literal["finally[0]"]] = "finally[0]"  # it may be on its way up to the end
    object: Named
    least: Positive | None = quantity("m", None)
    direction: Literal["front", "back", "left", "right"] | None = None


class GoesDown(Predicate):
    """The object's centre has gone so far down the slope of a fixed object since the start."""

    op: Literal["goes_down"] = "goes_down"
    alone: ClassVar[Literal["eventually"]] = "eventually"
    object: Named
    ref: Named
    least: Positive | None = quantity("m", None)


class Rolls(Predicate):
    """The object's turning makes up at least a share of its way, on another object while it is there."""

    op: Literal["rolls"] = "rolls"
    object: Named
    on: Named | None = None
    share: Positive = quantity("1", 0.5)


class RollsFreely(Predicate):
    """A ball let go on a slope gathers speed as its inertia lets it: g sin(slope) / (1 + I / m r^2)."""

    op: Literal["rolls_freely"] = "rolls_freely"
    object: Named
    ref: Named
    share: Positive = quantity("1", 0.1, lt=1.0)


class Flies(Predicate):
    """The object starts in the air, and touches nothing for a while."""

    op: Literal["flies"] = "flies"
    object: Named
    least: Positive = quantity("s", 0.1)


class FallsFreely(Predicate):
    """Until it touches something, the object keeps to the parabola of its start: no air in this world."""

    op: Literal["falls_freely"] = "falls_freely"
    object: Named
    within: Positive | None = quantity("m", None)


class Drops(Predicate):
    """The object's lowest point is lower than at the start by a share of its height then."""

    op: Literal["drops"] = "drops"
    alone: ClassVar[Literal["finally"]] = "finally"
    object: Named
    share: Positive = quantity("1", 0.5)


class TiltsTo(Predicate):
    """The object has gone down, on the side where another one started, by an angle."""

    op: Literal["tilts_to"] = "tilts_to"
    alone: ClassVar[Literal["eventually"]] = "eventually"
    object: Named
    ref: Named
    least: Positive = quantity("deg", 5.0, le=90.0)


PREDICATES: tuple[type[Predicate], ...] = (
    Swings, Conserves, DiesDown, ClimbsTo, Moves, GoesDown, Rolls, RollsFreely, Flies, FallsFreely, Drops, TiltsTo,
)  # fmt: skip
