"""Formulas in Python: `always(upright("tower", 10), (2, 5)) & ~touches("tower", "wall")`.

A predicate is called with its fields in order, or by name; numbers in base units.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

from wsim.plan.schema import formula as tree

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


def ordered(*events: Formula) -> tree.Ordered:
    """The events happen for the first time in this order."""
    return tree.Ordered(events=events)


def conserves(what: str, *objects: str, **rest: Any) -> tree.Conserves:
    """Energy or momentum of the objects, or of all, or the mass of a fluid, is as at the start."""
    return tree.Conserves.model_validate({"what": what, "objects": objects, **rest})


def _maker(kind: type[P]) -> Callable[..., P]:
    fields = [name for name in kind.model_fields if name != "op"]

    def make(*values: Any, **named: Any) -> P:
        if len(values) > len(fields):
            raise TypeError(f"{make.__name__} takes {', '.join(fields)}; it was given {len(values)} values")
        return kind.model_validate(dict(zip(fields, values, strict=False)) | named)

    make.__name__ = make.__qualname__ = kind.model_fields["op"].default
    make.__doc__ = f"{kind.__doc__} Fields: {', '.join(fields)}."
    return make


reaches = _maker(tree.Reaches)
stays_within = _maker(tree.StaysWithin)
rests_on = _maker(tree.RestsOn)
supported_by = _maker(tree.SupportedBy)
contained_in = _maker(tree.ContainedIn)
floats = _maker(tree.Floats)
sinks = _maker(tree.Sinks)
submerged = _maker(tree.Submerged)
touches = _maker(tree.Touches)
never_touches = _maker(tree.NeverTouches)
upright = _maker(tree.Upright)
speed_between = _maker(tree.SpeedBetween)
follows_path = _maker(tree.FollowsPath)
crosses = _maker(tree.Crosses)
swings = _maker(tree.Swings)
rolls_without_slip = _maker(tree.RollsWithoutSlip)
settles = _maker(tree.Settles)
collides_with = _maker(tree.CollidesWith)
pushes = _maker(tree.Pushes)
fills_to = _maker(tree.FillsTo)
stays_inside = _maker(tree.StaysInside)
turned_between = _maker(tree.TurnedBetween)
spin_between = _maker(tree.SpinBetween)
gone_between = _maker(tree.GoneBetween)
bounces_to = _maker(tree.BouncesTo)
counts = _maker(tree.Counts)
own_spin_between = _maker(tree.OwnSpinBetween)
tilt_between = _maker(tree.TiltBetween)
dies_down = _maker(tree.DiesDown)
climbs_to = _maker(tree.ClimbsTo)
stops_before = _maker(tree.StopsBefore)
swirls_between = _maker(tree.SwirlsBetween)
level_in = _maker(tree.LevelIn)
