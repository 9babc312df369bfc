"""In what a schedule of the stage differs from the plan's, with its numbers in the plan's units."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from wsim import quantities

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.plan.schema import EventPlan, SchedulePlan
    from wsim.scene.world import Event, Schedule

    Floats = NDArray[np.float64]

ROUNDING = 1e-4  # share, and of what is near nought itself: of numbers that a program writes
SHOWN = 6  # numbers of a list in a message
_KINDS = {"touch": "touch", "body": "place", "joint": "joint", "start": "start", "end": "end"}


@dataclass(frozen=True)
class Unlike:
    """A difference.

    Attributes:
        says: What the stage has and what the plan has.
        numbers: `value`, `limit`, `margin`, `expected` and `unit` of a finding; empty where it is of no number.
    """

    says: str
    numbers: dict[str, Any]


def alike(one: Sequence[float] | Floats, other: Sequence[float] | Floats) -> bool:
    """Whether two lists have the same numbers, to rounding."""
    return len(one) == len(other) and bool(np.allclose(one, other, rtol=ROUNDING, atol=ROUNDING))


def differing(what: str, said: Sequence[float] | Floats, planned: Sequence[float] | Floats, unit: str) -> Unlike | None:
    """How numbers of the stage differ from the plan's; None where they do not."""
    if alike(said, planned):
        return None
    lists = " and the plan ".join(_listed(numbers, unit) for numbers in (said, planned))
    if len(said) != len(planned):
        return Unlike(f"{what} {lists}", _numbers(len(said), len(planned), ""))
    one, other = np.asarray(said, dtype=np.float64), np.asarray(planned, dtype=np.float64)
    k = int(np.argmax(np.abs(one - other) / (ROUNDING * (1.0 + np.abs(other)))))
    return Unlike(f"{what} {lists}", _numbers(float(one[k]), float(other[k]), unit))


def unlike(evidence: Evidence, planned: SchedulePlan, said: Schedule, called: Mapping[str, str]) -> Unlike | None:
    """In what a schedule of the stage differs from the plan's; None where it does not.

    Args:
        evidence: Of the stage.
        planned: The plan's.
        said: The stage's, of the same quantity of the same thing.
        called: What the plan calls the stage's schedules, which may have other names there, by their prims.
    """
    linear = planned.quantity == "position" if planned.linear is None else planned.linear
    found = differing("times", said.times, planned.times, "s") or _values(evidence, planned, said)
    if found is None and said.linear != linear:
        ways = {True: "straight from key to key", False: "each value until the next key"}
        found = Unlike(f"{ways[said.linear]} (linear) and the plan {ways[linear]}", {})
    if found is None and (said.point is None) != (planned.point is None):
        at = {True: "the centre of mass", False: "a point of the body"}
        found = Unlike(f"its place at {at[said.point is None]} and the plan at {at[planned.point is None]}", {})
    if found is None and said.point is not None:
        found = differing("point", said.point, planned.point or (), "m")
    return found or _events(evidence, planned.after, said.after, called)


def _values(evidence: Evidence, planned: SchedulePlan, said: Schedule) -> Unlike | None:
    if said.quantity == "release":
        return None
    hinge = any(joint.prim == said.target and joint.kind == "revolute" for joint in evidence.world.joints)
    turns = planned.quantity == "angular_velocity" or (hinge and planned.quantity in ("position", "velocity"))
    wanted = [np.atleast_1d(np.asarray(value, dtype=np.float64)) for value in planned.values]
    values = [np.asarray(value) / (math.radians(1.0) if turns else 1.0) for value in said.values]
    if planned.quantity == "surface_velocity":  # the stage's are in the world's axes, whatever the object's are
        wanted, values = ([np.sqrt(np.sum(value**2, keepdims=True)) for value in each] for each in (wanted, values))
    quantity = next(each[planned.quantity] for each in quantities.OF.values() if planned.quantity in each)
    if planned.quantity == "velocity" and hinge:
        quantity = quantities.JOINT["velocity"]
    unit = quantity.turning if hinge and quantity.turning else quantity.unit
    return differing("values", np.ravel(values), np.ravel(wanted), unit)


def _events(
    evidence: Evidence, planned: EventPlan | None, said: Event | None, called: Mapping[str, str]
) -> Unlike | None:
    if planned is None or said is None:
        if planned is said:
            return None
        ways = {True: "times from the start of the run", False: "times from an event (after)"}
        return Unlike(f"{ways[said is None]} and the plan {ways[planned is None]}", {})
    kind = planned.kind
    given = getattr(planned, kind)
    names = sorted(given) if isinstance(given, tuple) else [given]
    ends = sorted(called.get(end, end.rsplit("/", 1)[-1]) for end in (said.first, said.second) if end)
    sides = [("above" if said.above else "below"), ("below" if planned.below is not None else "above")]
    passes = kind in ("body", "joint")
    own = (_KINDS[kind], names, planned.axis, sides[1] if passes else "")
    theirs = (said.kind, ends, said.axis, sides[0] if passes else "")
    if own != theirs:
        texts = (f"{one[0]} of {' and '.join(one[1])} {one[2] or ''} {one[3]}".rstrip() for one in (theirs, own))
        return Unlike(f"the event (after) {' and the plan '.join(texts)}", {})
    hinge = any(joint.prim == said.first and joint.kind == "revolute" for joint in evidence.world.joints)
    value = planned.above if planned.above is not None else (planned.below or 0.0)
    unit = "deg" if hinge else "m"
    at = math.degrees(said.value) if hinge else said.value
    return differing("delay", [said.delay], [planned.delay or 0.0], "s") or differing("event at", [at], [value], unit)


def _listed(numbers: Sequence[float] | Floats, unit: str) -> str:
    more = f", ... ({len(numbers)})" if len(numbers) > SHOWN else ""
    return f"{', '.join(f'{x:.6g}' for x in numbers[:SHOWN])}{more} {unit}".rstrip()


def _numbers(value: float, expected: float, unit: str) -> dict[str, Any]:
    limit = ROUNDING * (1.0 + abs(expected))
    return {"value": value, "expected": expected, "limit": expected, "margin": limit - abs(value - expected),
            "unit": unit, "limit_from": f"the plan's number, to {limit:.2g}"}  # fmt: skip
