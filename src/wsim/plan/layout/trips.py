"""Where and when a plan's driver is, and comes to stand: on terrain, and before the run ends."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from wsim.plan.layout.errors import LayoutError
from wsim.plan.schema import Actuation, BrakePlan, FromTerrain, Plan, PlanObject

if TYPE_CHECKING:
    from wsim.scene import Driver
    from wsim.scene.layers import Floats

ROUNDED = 1e-4  # [m]
BEFORE = 1e-6  # [m] of a place where it brakes, where it does not wait


class Trip:
    """Where and when a driver brakes for good, and stands, by its own speeds.

    Attributes:
        ends: When it would be at the end of its way [s].
        time: Whether its brake's time is what comes first.
        brakes_at: How far along its way it brakes [m]; None where it ends as any driver does, for all that is known.
        stands: When it has come to stand [s].
        stop: What its brakes take to stop it [m].
    """

    def __init__(self, driver: Driver, brake: BrakePlan | None, slows: float) -> None:
        """Work it out, of what slows down by so much [m/s^2]."""
        along, when = driver.timetable()
        self.ends = self.stands = float(when[-1])
        self.time, self.brakes_at, self.stop = False, None, 0.0
        if brake is None or (brake.at is None and brake.time is None):
            return
        placed = math.inf
        if brake.at is not None:
            self.brakes_at = driver.brakes_at
            placed = float(np.interp(self.brakes_at - BEFORE, along, when))
        begins = placed if brake.time is None else min(placed, brake.time)
        if begins < placed:
            self.time, self.brakes_at = True, float(np.interp(begins, when, along))
        assert self.brakes_at is not None
        speed = driver.speed_at(self.brakes_at)
        self.stands, self.stop = begins + speed / max(slows, 1e-9), 0.5 * speed**2 / max(slows, 1e-9)


def ground_friction(plan: Plan) -> float:
    """That of the ground, or terrain; inf where there is none."""
    lands = (item for item in plan.objects if item.primitive in ("ground", "terrain"))
    return next((item.material.friction for item in lands if item.material is not None), math.inf)


def check_time(plan: Plan, item: PlanObject, each: Actuation, trip: Trip, where: str) -> None:
    """Whether it stands before the run ends."""
    lasts = plan.simulation.duration
    if trip.stands <= lasts:
        return
    more = math.ceil(trip.stands + 1.0)
    if trip.time and each.brake is not None:
        raise LayoutError(
            f"{where}.brake.time: {each.brake.time:g} s: {item.name} then stands at {trip.stands:.3g} s, and the run "
            f"ends at {lasts:g} s; brake earlier, or give simulation.duration {more} s"
        )
    raise LayoutError(
        f"simulation.duration: {lasts:g} s: {item.name} takes {trip.stands:.3g} s along its route at {each.speed:g} "
        f"m/s; give it {more} s, or a shorter route"
    )


def check_land(plan: Plan, item: PlanObject, line: Floats, trip: Trip, where: str) -> None:
    """Whether its way stays on terrain, and where it stops: straight on from where it brakes, or along its way."""
    land = next((each for each in plan.objects if isinstance(each.built, FromTerrain)), None)
    if land is None or not isinstance(land.built, FromTerrain):
        return
    wide, deep = land.built.extent
    for field, places, out in (("route", line, "move its route"), ("brake", _stops(line, trip), "brake earlier")):
        for x, y in places:
            if 2.0 * abs(x) > wide + ROUNDED or 2.0 * abs(y) > deep + ROUNDED:
                raise LayoutError(
                    f"{where}.{field}: {item.name} is driven to ({x:.4g}, {y:.4g}) m, where {land.name} is not; {out}, "
                    "or extend that"
                )


def _stops(line: Floats, trip: Trip) -> list[Floats]:
    """Where it may stop after it has braked: as its wheels slide, or as they are steered past its way's end."""
    if trip.brakes_at is None:
        return []
    ways = np.diff(line, axis=0)
    lengths = np.linalg.norm(ways, axis=1)
    along = np.append(0.0, np.cumsum(lengths))
    k = min(int(np.searchsorted(along, trip.brakes_at, side="right")) - 1, len(ways) - 1)
    slides = line[k] + ways[k] / lengths[k] * (trip.brakes_at + trip.stop - along[k])
    past = max(trip.brakes_at + trip.stop - along[-1], 0.0)
    return [slides, line[-1] + ways[-1] / lengths[-1] * past]
