"""What makes the vehicles, terrain and scatters of a plan invalid as a whole."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from wsim.limits import MAX_DRIVE_SPEED, MAX_POSITION
from wsim.plan.schema.actuation import ArcPlan
from wsim.plan.schema.constructions import FromScatter, FromTerrain, FromVehicle

if TYPE_CHECKING:
    from wsim.plan.schema.draft import Draft
    from wsim.plan.schema.objects import Actuation, PlanObject

LEVEL = 1e-6  # [deg]: as far as a vehicle leans that stands level
ALONG = 1e-3  # of its speed: as far as its velocity may point aside


def land_problems(plan: Draft) -> Iterator[str]:
    """All of them."""
    lands = [item.name for item in plan.objects if item.primitive in ("terrain", "ground")]
    terrain = next((item for item in plan.objects if isinstance(item.built, FromTerrain)), None)
    if len(lands) > 1 and terrain is not None:
        yield f"objects: {' and '.join(lands)} are both the ground; keep one of them"
    yield from _scattered(plan)
    for i, item in enumerate(plan.objects):
        if isinstance(item.built, FromVehicle):
            yield from _starts(f"objects.{i}", item, terrain)
            for j, actuation in enumerate(item.registration.actuation):
                where = f"objects.{i}.registration.actuation.{j}"
                if actuation.kind not in ("driver", "drive"):
                    yield (
                        f'{where}.kind: {actuation.kind!r}: {item.name} is a vehicle, which a "driver" or a "drive" '
                        "moves; take one of these, or leave it out"
                    )
                near = actuation.brake.near if actuation.brake is not None else None
                if near is not None and not any(
                    one.name == near and _moves(one) for one in plan.objects if one is not item
                ):
                    yield (
                        f"{where}.brake.near: {near!r} is no other object that moves; name one, or give the place as "
                        '"at"'
                    )
                yield from _driven(where, item.built, actuation, terrain)


def _moves(item: PlanObject) -> bool:
    """Whether it is one body, whose place a program is told."""
    return item.state in ("dynamic", "kinematic") and item.primitive not in ("robot", "terrain", "scatter")


def _scattered(plan: Draft) -> Iterator[str]:
    """What is scattered lies on terrain, its prims' names are nobody else's, and it is not called by one name."""
    items = {item.name: item for item in plan.objects}
    owner: dict[str, str] = {}
    for i, item in enumerate(plan.objects):
        if isinstance(item.built, FromScatter) and items.get(item.built.on, item).primitive != "terrain":
            yield f"objects.{i}.construction.on: {item.built.on!r} is no terrain of the plan; scatter it on one"
        for prim in (*item.prims, *item.hinges):
            if owner.setdefault(prim, item.name) != item.name:
                yield f"objects.{i}.name: {prim} would be a part of {item.name} and of {owner[prim]}; rename one"
    for i, objective in enumerate(plan.objectives):
        called = {"object": objective.object, "ref": objective.ref}
        told = [(field, name) for field, name in called.items() if name is not None]
        told += [("formula", name) for name in sorted(objective.formula.names() if objective.formula else ())]
        for field, name in told:
            one = items.get(name)
            if one is not None and isinstance(one.built, FromScatter):
                yield (
                    f"objectives.{i}.{field}: {name!r} is {one.built.count} things, which an objective cannot call by "
                    'one name; say what the other touches alone, as "touches_only", or leave it out'
                )


def _starts(where: str, item: PlanObject, terrain: PlanObject | None) -> Iterator[str]:
    """How a vehicle stands and goes as it starts; on terrain, where the layout leans it, its yaw alone is asked."""
    turn = item.pose.rotation_deg if item.pose is not None else (0.0, 0.0, 0.0)
    if terrain is None and max(abs(turn[0]), abs(turn[1])) > LEVEL:
        yield f"{where}.pose.rotation_deg: {list(turn)}: {item.name} stands level on the ground; give it a yaw alone"
    ahead, aside = _going(item, turn[2] if terrain is not None else None)
    if aside > ALONG * abs(ahead):
        yield (
            f"{where}.velocity: {list(item.velocity)} m/s of {item.name} is not along its heading, on which it rolls; "
            "turn one of them"
        )
    elif abs(ahead) > MAX_DRIVE_SPEED:
        yield f"{where}.velocity: {abs(ahead):g} m/s of {item.name} must be <= {MAX_DRIVE_SPEED:g} m/s; start it slower"


def _going(item: PlanObject, yaw_deg: float | None) -> tuple[float, float]:
    """How fast a vehicle starts along its heading, and aside of it [m/s]: as its yaw has it, whatever the slope.

    Args:
        item: It.
        yaw_deg: On terrain, which is nowhere as steep as 45 degrees where it stays; None: as its pose has it.
    """
    if yaw_deg is None:
        ahead = item.speed_ahead
        return ahead, math.dist(item.velocity, [ahead * way for way in item.ahead])
    (x, y, z), yaw = item.velocity, math.radians(yaw_deg)
    ahead, left = x * math.cos(yaw) + y * math.sin(yaw), y * math.cos(yaw) - x * math.sin(yaw)
    return math.copysign(math.hypot(x, y, z), ahead), abs(left) if abs(z) <= abs(ahead) else abs(z)


def _driven(where: str, vehicle: FromVehicle, actuation: Actuation, terrain: PlanObject | None) -> Iterator[str]:
    """Where a vehicle is driven to, how fast, and how far its wheels are turned."""
    if actuation.speed is not None and actuation.speed > MAX_DRIVE_SPEED:
        yield f"{where}.speed: {actuation.speed:g} m/s must be <= {MAX_DRIVE_SPEED:g} m/s; drive slower"
    if actuation.steer_deg:
        from wsim.scene.vehicle_spec import preset  # with USD, and few plans steer

        most = preset(vehicle.vehicle).steer_limit_deg
        if abs(actuation.steer_deg) > most:
            yield (
                f"{where}.steer_deg: {actuation.steer_deg:g} deg: a {vehicle.vehicle} turns its wheels by {most:g} deg "
                "at most; steer less"
            )
    for k, leg in enumerate(actuation.route):
        if isinstance(leg, ArcPlan):
            continue  # where that leads the layout knows
        x, y, *_ = leg
        if max(abs(x), abs(y)) > MAX_POSITION:
            yield f"{where}.route.{k}: ({x:g}, {y:g}) m must be within {MAX_POSITION:g} m; move it"
        elif terrain is not None and isinstance(terrain.built, FromTerrain):
            wide, deep = terrain.built.extent
            if 2.0 * abs(x) > wide or 2.0 * abs(y) > deep:
                yield (
                    f"{where}.route.{k}: ({x:g}, {y:g}) m is not on {terrain.name}, {wide:g} x {deep:g} m about the "
                    "origin; move it, or extend that"
                )
