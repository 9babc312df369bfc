"""How long a plan's drivers take: a run that ends before their way does is refused."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

from wsim.plan.layout.errors import LayoutError
from wsim.plan.schema import Actuation, FromVehicle, Plan, PlanObject

Spot = tuple[float, float]
SLOWEST = 0.1  # [m/s]: where it sets off and stops


def way_of(item: PlanObject, actuation: Actuation) -> list[Spot]:
    """What a driver leads its vehicle through, (x, y) each [m]: where it starts, and the points of the route."""
    assert item.pose is not None
    x, y, _ = item.pose.position
    return [(x, y), *((point[0], point[1]) for point in actuation.route)]


def stops(route: Sequence[Sequence[float]], waits: Sequence[float]) -> list[tuple[float, float, float]]:
    """A driver's (x, y, seconds), of a route's points up to the last where it waits."""
    last = max((k for k, seconds in enumerate(waits) if seconds > 0.0), default=-1)
    return [(point[0], point[1], seconds) for point, seconds in zip(route, waits[: last + 1], strict=False)]


def drive_time(
    kind: str, way: Sequence[Spot], speed: float, start_speed: float = 0.0, waits: Sequence[float] = ()
) -> float:  # fmt: skip
    """What a driver takes along a smooth line through points, by its own speeds [s], and waits at all but the first.

    Raises:
        LayoutError: The scene would refuse the driver; in the scene's words.
    """
    from wsim.scene import Driver, Road, SceneError  # with USD, as above

    try:
        line = Road(way).line()
        driver = Driver(kind, kind, path=line, speed=speed, start_speed=max(0.0, start_speed),
                        waits=stops(way[1:], waits))  # fmt: skip
    except SceneError as error:
        raise LayoutError(str(error)) from error
    steps = [math.dist(a, b) for a, b in pairwise(line)]
    along = [0.0]
    for step in steps:
        along.append(along[-1] + step)
    mean = [0.5 * (driver.speed_at(a) + driver.speed_at(b)) for a, b in pairwise(along)]
    return sum(step / max(fast, SLOWEST) for step, fast in zip(steps, mean, strict=True)) + sum(waits)


def check_drives(plan: Plan) -> None:
    """Whether each driver comes to the end of its route in the time that there is.

    Raises:
        LayoutError: One does not, or the scene would refuse it.
    """
    for item in plan.objects:
        for each in item.registration.actuation:
            if each.kind != "driver" or each.speed is None or not isinstance(item.built, FromVehicle):
                continue
            if item.pose is None:
                continue
            way = way_of(item, each)
            takes = drive_time(item.built.vehicle, way, each.speed, item.speed_ahead, each.waits)
            if takes > plan.simulation.duration:
                raise LayoutError(
                    f"simulation.duration: {plan.simulation.duration:g} s: {item.name} takes {takes:.3g} s along its "
                    f"route at {each.speed:g} m/s; give it {math.ceil(takes + 1.0)} s, or a shorter route"
                )
