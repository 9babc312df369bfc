"""Formulas in Python: `always(upright("tower", 10), (2, 5)) & ~touches("tower", "wall")`.

A predicate is called with its fields in order, or by name; numbers in base units.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

from wsim.plan.schema import formula as tree
from wsim.plan.schema import formula_contact, formula_fluid, formula_motion, formula_place

if TYPE_CHECKING:
    from wsim.plan.schema.formula import Formula

P = TypeVar("P", bound=tree.Predicate)
Between = tuple[float, float | None]


def always(of: Formula, window: Between | None = None) -> tree.Always:
    """It holds at each frame of the window [s]; without one, to the end."""
    return tree.Always(of=of, window=window)


def eventually(of: Formula, window: Between | None = None) -> tree.Eventually:
    """It holds at some frame of the window [s]; without one, up to the end."""
    return tree.Eventually(of=of, window=window)


def finally_(of: Formula, seconds: float | None = None) -> tree.Finally:
    """It holds over the recording's last seconds; without a number, over the judge's final window."""
    return tree.Finally(of=of, seconds=seconds)


def mean(of: tree.Predicate, seconds: float | None = None, window: Between | None = None) -> tree.Mean:
    """A predicate, of the means of its numbers over the recording's last seconds, the final window, or one [s]."""
    return tree.Mean(of=of, seconds=seconds, window=window)


def ordered(*events: Formula) -> tree.Ordered:
    """The events happen for the first time in this order."""
    return tree.Ordered(events=events)


def conserves(what: str, *objects: str, **rest: Any) -> formula_motion.Conserves:
    """Energy or momentum of the objects, or of all, or the mass of a fluid, is as at the start."""
    return formula_motion.Conserves.model_validate({"what": what, "objects": objects, **rest})


def _maker(kind: type[P]) -> Callable[..., P]:
    fields = [name for name in kind.model_fields if name != "op"]

    def make(*values: Any, **named: Any) -> P:
        if len(values) > len(fields):
            raise TypeError(f"{make.__name__} takes {', '.join(fields)}; it was given {len(values)} values")
        return kind.model_validate(dict(zip(fields, values, strict=False)) | named)

    make.__name__ = make.__qualname__ = kind.model_fields["op"].default
    make.__doc__ = f"{kind.__doc__} Fields: {', '.join(fields)}."
    return make


reaches = _maker(formula_place.Reaches)
stays_within = _maker(formula_place.StaysWithin)
rests_on = _maker(formula_contact.RestsOn)
supported_by = _maker(formula_contact.SupportedBy)
contained_in = _maker(formula_place.ContainedIn)
floats = _maker(formula_fluid.Floats)
sinks = _maker(formula_fluid.Sinks)
submerged = _maker(formula_fluid.Submerged)
touches = _maker(formula_contact.Touches)
never_touches = _maker(formula_contact.NeverTouches)
touches_only = _maker(formula_contact.TouchesOnly)
upright = _maker(formula_place.Upright)
speed_between = _maker(formula_place.SpeedBetween)
follows_path = _maker(formula_place.FollowsPath)
crosses = _maker(formula_place.Crosses)
swings = _maker(formula_motion.Swings)
rolls_without_slip = _maker(formula_contact.RollsWithoutSlip)
settles = _maker(formula_contact.Settles)
collides_with = _maker(formula_contact.CollidesWith)
pushes = _maker(formula_contact.Pushes)
fills_to = _maker(formula_fluid.FillsTo)
stays_inside = _maker(formula_place.StaysInside)
turned_between = _maker(formula_place.TurnedBetween)
spin_between = _maker(formula_place.SpinBetween)
gone_between = _maker(formula_place.GoneBetween)
bounces_to = _maker(formula_contact.BouncesTo)
counts = _maker(formula_place.Counts)
own_spin_between = _maker(formula_place.OwnSpinBetween)
tilt_between = _maker(formula_place.TiltBetween)
dies_down = _maker(formula_motion.DiesDown)
climbs_to = _maker(formula_motion.ClimbsTo)
stops_before = _maker(formula_contact.StopsBefore)
swirls_between = _maker(formula_fluid.SwirlsBetween)
level_in = _maker(formula_fluid.LevelIn)
lies_on = _maker(formula_contact.LiesOn)
stays_on = _maker(formula_contact.StaysOn)
weighs_on = _maker(formula_contact.WeighsOn)
fills = _maker(formula_fluid.Fills)
drops = _maker(formula_motion.Drops)
moves = _maker(formula_motion.Moves)
goes_down = _maker(formula_motion.GoesDown)
rolls = _maker(formula_motion.Rolls)
rolls_freely = _maker(formula_motion.RollsFreely)
flies = _maker(formula_motion.Flies)
falls_freely = _maker(formula_motion.FallsFreely)
tilts_to = _maker(formula_motion.TiltsTo)
