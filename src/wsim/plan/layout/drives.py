"""How a plan's drivers go, and how long they take: a run that ends before their way does is refused."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from wsim.limits import MAX_WAY
from wsim.plan.layout.errors import LayoutError
from wsim.plan.layout.trips import Trip, check_land, check_time, ground_friction
from wsim.plan.schema import Actuation, ArcPlan, FromVehicle, Plan, PlanObject

if TYPE_CHECKING:
    from wsim.scene.layers import Floats
    from wsim.scene.vehicle_spec import VehicleSpec

Spot = tuple[float, float]
ROUNDED = 1e-4  # [m]
CORNER = math.radians(45.0)  # that a way turns by at most from leg to leg: R tan(alpha / 2) is about a driver's lead


def way_of(item: PlanObject, actuation: Actuation) -> list[Spot]:
    """What a driver leads its vehicle through, (x, y) each [m]: where it starts, and where each leg ends."""
    assert item.pose is not None
    x, y, _ = item.pose.position
    if has_arcs(actuation):
        return [(x, y), *((round(u, 4), round(v, 4)) for u, v in _legs(item, actuation).ends())]
    return [(x, y), *((leg[0], leg[1]) for leg in actuation.route if not isinstance(leg, ArcPlan))]


def has_arcs(actuation: Actuation) -> bool:
    """Whether its route has arcs: then it is of straight legs and arcs, else a smooth line through its points."""
    return any(isinstance(leg, ArcPlan) for leg in actuation.route)


def heading_deg(item: PlanObject) -> float:
    """Where a vehicle heads as it starts, as seen from above [deg]."""
    ahead, aside, _ = item.ahead
    return round(math.degrees(math.atan2(aside, ahead)), 4) + 0.0


def _legs(item: PlanObject, actuation: Actuation) -> Any:
    from wsim.scene import Arc, Legs  # with USD, and few plans have a vehicle

    assert item.pose is not None
    route = [Arc(leg.radius, leg.angle_deg) if isinstance(leg, ArcPlan) else leg[:2] for leg in actuation.route]
    return Legs(item.pose.position[:2], heading_deg(item), route)


def line_of(item: PlanObject, actuation: Actuation) -> Floats:
    """Points of a driver's way, (N, 2) [m], as its program has them."""
    from wsim.scene import Road  # as above

    if has_arcs(actuation):
        line: Floats = _legs(item, actuation).line()
        return line
    return Road(way_of(item, actuation)).line()


def stops(item: PlanObject, actuation: Actuation) -> list[tuple[float, float, float]]:
    """A driver's (x, y, seconds), of where its route's legs end, up to the last where it waits.

    An arc of more than a turn comes by its end before it is there: it goes by, 0 s.
    """
    last = max((k for k, seconds in enumerate(actuation.waits) if seconds > 0.0), default=-1)
    found: list[tuple[float, float, float]] = []
    legs = zip(actuation.route, way_of(item, actuation)[1:], actuation.waits[: last + 1], strict=False)
    for leg, end, seconds in legs:
        before = math.ceil(abs(leg.angle_deg) / 360.0) - 1 if isinstance(leg, ArcPlan) else 0
        found += [*[(*end, 0.0)] * before, (*end, seconds)]
    return found


def drive_time(
    kind: str, way: Sequence[Spot], speed: float, start_speed: float = 0.0, waits: Sequence[float] = ()
) -> float:  # fmt: skip
    """What a driver takes along a smooth line through points, by its own speeds [s], and waits at all but the first.

    Raises:
        LayoutError: The scene would refuse the driver; in the scene's words.
    """
    from wsim.scene import Driver, Road, SceneError  # as above

    stands = [(*at, seconds) for at, seconds in zip(way[1:], waits, strict=False)]
    try:
        line = Road(way).line()
        driver = Driver(kind, kind, path=line, speed=speed, start_speed=max(0.0, start_speed), waits=stands)
    except SceneError as error:
        raise LayoutError(str(error)) from error
    return float(driver.timetable()[1][-1])


def check_drives(plan: Plan) -> None:
    """Whether each driver can go as its route does, stays on terrain, and has time to come to the end of it.

    Raises:
        LayoutError: One cannot, has not, or the scene would refuse it.
    """
    for i, item in enumerate(plan.objects):
        for j, each in enumerate(item.registration.actuation):
            if each.kind == "driver" and isinstance(item.built, FromVehicle) and item.pose is not None:
                _check(plan, item, each, f"objects.{i}.registration.actuation.{j}")


def _check(plan: Plan, item: PlanObject, each: Actuation, where: str) -> None:
    """One of them, whose place in the plan is `where`."""
    from wsim.scene import Brake, Driver  # as above
    from wsim.scene.vehicle_spec import preset

    assert isinstance(item.built, FromVehicle) and each.speed is not None
    kind, spec = item.built.vehicle, preset(item.built.vehicle)
    with _told(f"{where}.route"):
        if has_arcs(each):
            _check_turns(item, each, spec, where)
        else:
            _check_length(way_of(item, each), where)
        line = line_of(item, each)
    with _told(where):
        brake = Brake(**each.brake.model_dump()) if each.brake is not None else None
        driver = Driver(item.name, kind, path=line, speed=each.speed, start_speed=max(0.0, item.speed_ahead),
                        waits=stops(item, each), brake=brake)  # fmt: skip
    trip = Trip(driver, each.brake, spec.braking(brake.share, ground_friction(plan)) if brake is not None else math.inf)
    check_land(plan, item, line, trip, where)
    check_time(plan, item, each, trip, where)


@contextmanager
def _told(where: str) -> Iterator[None]:
    """What the scene refuses, as of a place in the plan."""
    from wsim.scene import SceneError  # as above

    try:
        yield
    except SceneError as error:
        raise LayoutError(f"{where}: {error}") from error


def _check_length(way: Sequence[Spot], where: str) -> None:
    """Whether a smooth line through points can be as short as a driver's way, before it is drawn."""
    length = sum(math.dist(a, b) for a, b in pairwise(way))
    if length > MAX_WAY:
        raise LayoutError(f"{where}.route: {length:.6g} m long; it must be {MAX_WAY:g} m at most: leave points out")


def _check_turns(item: PlanObject, each: Actuation, spec: VehicleSpec, where: str) -> None:
    """Whether it can turn as its arcs do, and round the corners between its legs.

    What goes round a circle of R by a corner of alpha leaves its legs R tan(alpha / 2) before it and after it; what
    comes out of an arc begins late, and has the leg again after twice as much.
    """
    least = math.hypot(spec.turning_radius(spec.steer_limit_deg), 0.5 * spec.wheelbase)
    for k, leg in enumerate(each.route):
        if isinstance(leg, ArcPlan) and leg.radius < least:
            raise LayoutError(
                f"{where}.route.{k}.radius: {item.name} is to drive round an arc of {leg.radius:g} m; with its wheels "
                f"at {spec.steer_limit_deg:g} deg it goes round {least:.3g} m; make it wider"
            )
    legs = _legs(item, each).stretches()
    before = [math.radians(heading_deg(item)), *(leg.leaves for leg in legs)]
    turns = [abs(math.remainder(leg.enters - came, math.tau)) for leg, came in zip(legs, before, strict=False)]
    for k, turn in enumerate(turns):
        after = turns[k + 1] if k + 1 < len(turns) else 0.0
        out = f"put an arc of {least:.3g} m or more there" if k else "start it along its way, or put an arc first"
        if turn > CORNER:
            raise LayoutError(
                f"{where}.route.{k}: {item.name} is to turn by {math.degrees(turn):.3g} deg on the spot where this leg "
                f"begins; {math.degrees(CORNER):g} deg at most: {out}"
            )
        takes = least * (2.0 * math.tan(0.5 * turn) + math.tan(0.5 * min(after, CORNER)))
        if takes > legs[k].length + ROUNDED:
            raise LayoutError(
                f"{where}.route.{k}: {item.name} takes {takes:.3g} m to turn by the corners at the ends of this leg, "
                f"which is {legs[k].length:.3g} m long; make it longer, or {out}"
            )
