"""Arguments of `scene.vehicle`, and what drives vehicles: a driver along a route, or an engine that is set once."""

from __future__ import annotations

import math

from wsim.errors import UserError
from wsim.plan.layout.land import terrain_of
from wsim.plan.schema import Actuation, FromVehicle, PlanObject
from wsim.program.compose.draft import Draft
from wsim.program.compose.poses import position
from wsim.program.source import call, number, tuple_of
from wsim.scene.vehicle_spec import preset

LEVEL = 1e-6  # [deg]: as far as a vehicle may lean
ALONG = 1e-3  # of its speed: as far as its velocity may point aside


def arguments(draft: Draft, item: PlanObject) -> list[str]:
    """All arguments but the name; on terrain it stands where that is under it.

    Raises:
        UserError: If the plan gives it what is its own, leans it, or starts it aside.
    """
    turn = item.pose.rotation_deg if item.pose is not None else (0.0, 0.0, 0.0)
    for what, given in (
        ("angular_velocity_deg", any(item.angular_velocity_deg or ())),
        ("registration.mass or .density", item.registration.mass or item.registration.density),
        ('state "kinematic"', item.state == "kinematic"),
        ("roll or pitch", max(abs(turn[0]), abs(turn[1])) > LEVEL),
    ):
        if given:
            raise UserError(f"{item.name}: a vehicle stands on its wheels with its own {what}; remove it")
    assert isinstance(item.built, FromVehicle)
    at, land = position(item), terrain_of(draft.plan)
    place = f"{draft.handles[land.name]}.place({number(at[0])}, {number(at[1])})" if land else tuple_of(at)
    speed = start_speed(item)
    return [
        f'"{item.built.vehicle}"', f"position={place}", *([f"yaw_deg={number(turn[2])}"] if turn[2] else []),
        *([f"speed={number(speed)}"] if speed else []),
    ]  # fmt: skip


def start_speed(item: PlanObject) -> float:
    """Forward at the start [m/s].

    Raises:
        UserError: If its velocity is not along its heading.
    """
    yaw = math.radians(item.pose.rotation_deg[2]) if item.pose is not None else 0.0
    x, y, z = item.velocity
    ahead, aside = x * math.cos(yaw) + y * math.sin(yaw), y * math.cos(yaw) - x * math.sin(yaw)
    if math.hypot(aside, z) > ALONG * max(abs(ahead), 1e-9) and any(item.velocity):
        raise UserError(
            f"{item.name}: its velocity {list(item.velocity)} m/s is not along its heading; turn one of them"
        )
    return ahead


def rear_axle(item: PlanObject) -> tuple[float, float]:
    """Where the middle of its rear axle starts, (x, y) [m]: that is what a driver leads along the route."""
    assert isinstance(item.built, FromVehicle) and item.pose is not None
    (x, y, _), yaw = item.pose.position, math.radians(item.pose.rotation_deg[2])
    back = 0.5 * preset(item.built.vehicle).wheelbase
    return round(x - back * math.cos(yaw), 3), round(y - back * math.sin(yaw), 3)


def driven(item: PlanObject) -> Actuation | None:
    """What drives a vehicle, if something does."""
    if item.primitive != "vehicle":
        return None
    return next((each for each in item.registration.actuation if each.kind in ("driver", "drive")), None)


def set_off(draft: Draft) -> list[str]:
    """Calls that set engines and steering for the whole run."""
    lines: list[str] = []
    for item in draft.plan.objects:
        each = driven(item)
        if each is not None and each.kind == "drive":
            lines += call(f"{draft.handles[item.name]}.drive", [number(each.speed or 0.0)])
            lines += call(f"{draft.handles[item.name]}.steer", [number(each.steer_deg)]) if each.steer_deg else []
    return lines


def drivers(draft: Draft) -> list[str]:
    """Constants of the program: a driver for each vehicle that follows a route, along a smooth line through it."""
    lines: list[str] = []
    for item in draft.plan.objects:
        each = driven(item)
        if each is None or each.kind != "driver" or not isinstance(item.built, FromVehicle):
            continue
        draft.imports |= {"Driver", "Road"}
        name = draft.variable(f"{item.name}_driver").upper()
        draft.drivers.append(name)
        path = f"Road({draft.way((rear_axle(item), *((x, y) for x, y, *_ in each.route)))}).line()"
        given = [f'"{item.name}"', f'"{item.built.vehicle}"', f"path={path}", f"speed={number(each.speed or 0.0)}"]
        speed = start_speed(item)
        given += [f"start_speed={number(speed)}"] if speed else []
        lines += call(f"{name} = Driver", given, depth=0)
    return lines


def control(draft: Draft) -> list[str]:
    """The program's `control`, where there are drivers."""
    if not draft.drivers:
        return []
    return [
        "",
        "",
        "def control(world, t):",
        '    """Drive."""',
        *(f"    {name}.drive(world, t)" for name in draft.drivers),
    ]
