"""How a plan's drivers go, and how long they take: a run that ends before their way does is refused."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from wsim.plan.layout.errors import LayoutError
from wsim.plan.schema import Actuation, ArcPlan, FromTerrain, FromVehicle, Plan, PlanObject

if TYPE_CHECKING:
    from wsim.scene import Driver
    from wsim.scene.layers import Floats
    from wsim.scene.vehicle_spec import VehicleSpec

Spot = tuple[float, float]
SLOWEST = 0.1  # [m/s]: where it sets off and stops
ROUNDED = 1e-4  # [m]


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
    """A driver's (x, y, seconds), of where its route's legs end, up to the last where it waits."""
    last = max((k for k, seconds in enumerate(actuation.waits) if seconds > 0.0), default=-1)
    ends = way_of(item, actuation)[1:]
    return [(*end, seconds) for end, seconds in zip(ends, actuation.waits[: last + 1], strict=False)]


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
    return _takes(driver, line) + sum(waits)


def _takes(driver: Driver, line: Floats) -> float:
    """By its own speeds [s], to the end of its way or to where it has come to stand after its brake."""
    total, along = 0.0, 0.0
    for a, b in pairwise(line):
        step = min(math.dist(a, b), driver.brakes_at - along)
        if step <= 0.0:
            break
        fast = 0.5 * (driver.speed_at(along) + driver.speed_at(along + step))
        total, along = total + step / max(fast, SLOWEST), along + step
    return total


def check_drives(plan: Plan) -> None:
    """Whether each driver can go as its route does, stays on terrain, and has time to come to the end of it.

    Raises:
        LayoutError: One cannot, has not, or the scene would refuse it.
    """
    for item in plan.objects:
        for each in item.registration.actuation:
            if each.kind != "driver" or each.speed is None or not isinstance(item.built, FromVehicle):
                continue
            if item.pose is None:
                continue
            takes = _checked(plan, item, each, each.speed)
            if takes > plan.simulation.duration:
                raise LayoutError(
                    f"simulation.duration: {plan.simulation.duration:g} s: {item.name} takes {takes:.3g} s along its "
                    f"route at {each.speed:g} m/s; give it {math.ceil(takes + 1.0)} s, or a shorter route"
                )


def _checked(plan: Plan, item: PlanObject, each: Actuation, speed: float) -> float:
    """What a driver takes [s], its brake too, whose time may come before its place does."""
    from wsim.scene import Brake, Driver, SceneError  # as above
    from wsim.scene.vehicle_spec import preset

    assert isinstance(item.built, FromVehicle)
    kind, brake = item.built.vehicle, None
    try:
        if each.brake is not None:
            brake = Brake(**each.brake.model_dump())
        line = line_of(item, each)
        driver = Driver(item.name, kind, path=line, speed=speed, start_speed=max(0.0, item.speed_ahead),
                        waits=stops(item, each), brake=brake)  # fmt: skip
    except SceneError as error:
        raise LayoutError(str(error)) from error
    _check_turns(item, each, preset(kind))
    _check_land(plan, item, line)
    takes = _takes(driver, line) + sum(each.waits)
    if brake is None:
        return takes
    last = speed if math.isinf(driver.brakes_at) else driver.speed_at(driver.brakes_at)
    begins = takes if brake.time is None else min(takes, brake.time) if brake.at is not None else brake.time
    return begins + last / max(preset(kind).braking(brake.share), SLOWEST)


def _check_turns(item: PlanObject, each: Actuation, spec: VehicleSpec) -> None:
    """Whether it can turn as its arcs do."""
    least = math.hypot(spec.turning_radius(spec.steer_limit_deg), 0.5 * spec.wheelbase)
    for leg in each.route:
        if isinstance(leg, ArcPlan) and leg.radius < least:
            raise LayoutError(
                f"{item.name} is to drive round an arc of {leg.radius:g} m; with its wheels at "
                f"{spec.steer_limit_deg:g} deg it goes round {least:.3g} m; make it wider"
            )


def _check_land(plan: Plan, item: PlanObject, line: Floats) -> None:
    """Whether its way stays on terrain."""
    land = next((each for each in plan.objects if isinstance(each.built, FromTerrain)), None)
    if land is None or not isinstance(land.built, FromTerrain):
        return
    for x, y in line:
        if 2.0 * abs(x) > land.built.extent[0] + ROUNDED or 2.0 * abs(y) > land.built.extent[1] + ROUNDED:
            raise LayoutError(
                f"{item.name} is driven to ({x:.4g}, {y:.4g}) m, where {land.name} is not; move its route, or "
                "extend that"
            )
