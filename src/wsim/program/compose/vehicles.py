"""Arguments of `scene.vehicle`, and what drives vehicles: a driver along a route, or an engine that is set once."""

from __future__ import annotations

from wsim.plan.layout.drives import has_arcs, heading_deg, stops, way_of
from wsim.plan.layout.land import survey, terrain_of
from wsim.plan.schema import Actuation, ArcPlan, BrakePlan, FromVehicle, PlanObject
from wsim.program.compose.draft import Draft
from wsim.program.compose.poses import position
from wsim.program.source import call, number, tuple_of

LEVEL = 1e-6  # [deg], [m/s]: less is none
DUST = 2e-6  # [m]: to which a pose is rounded


def arguments(draft: Draft, item: PlanObject) -> list[str]:
    """All arguments but the name; on terrain it stands where that is under it, and leans as it does."""
    assert isinstance(item.built, FromVehicle)
    roll, pitch, yaw = item.pose.rotation_deg if item.pose is not None else (0.0, 0.0, 0.0)
    turns = (("yaw_deg", yaw), ("pitch_deg", pitch), ("roll_deg", roll), ("speed", item.speed_ahead))
    return [
        f'"{item.built.vehicle}"', f"position={_place(draft, item)}",
        *(f"{name}={number(value)}" for name, value in turns if abs(value) > LEVEL),
    ]  # fmt: skip


def _place(draft: Draft, item: PlanObject) -> str:
    """The point between its axles: of terrain, or straight above it."""
    at, land = position(item), terrain_of(draft.plan)
    if land is None:
        return tuple_of(at)
    above = at[2] - survey(land).height(at[0], at[1])
    given = [number(at[0]), number(at[1]), *([f"above={number(above)}"] if abs(above) > DUST else [])]
    return f"{draft.handles[land.name]}.place({', '.join(given)})"


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
        draft.imports |= {"Driver", "Legs" if has_arcs(each) else "Road"}
        name = draft.variable(f"{item.name}_driver").upper()
        draft.drivers.append(name)
        path = _path(draft, item, each)
        given = [f'"{item.name}"', f'"{item.built.vehicle}"', f"path={path}", f"speed={number(each.speed or 0.0)}"]
        given += [f"start_speed={number(item.speed_ahead)}"] if item.speed_ahead > LEVEL else []
        waits = [tuple_of(stop) for stop in stops(item, each)]
        given += [f"waits=[{', '.join(waits)}]"] if waits else []
        if each.brake is not None:
            draft.imports.add("Brake")
            given.append(f"brake=Brake({_brake(each.brake)})")
        lines += call(f"{name} = Driver", given, depth=0)
    return lines


def _path(draft: Draft, item: PlanObject, each: Actuation) -> str:
    """A smooth line through the route's points, or its straight legs and arcs."""
    way = way_of(item, each)
    if not has_arcs(each):
        return f"Road({draft.way(tuple(way))}).line()"
    draft.imports.add("Arc")
    legs = [
        f"Arc({number(leg.radius)}, {number(leg.angle_deg)})" if isinstance(leg, ArcPlan) else tuple_of(leg[:2])
        for leg in each.route
    ]
    return f"Legs({tuple_of(way[0])}, {number(heading_deg(item))}, [{', '.join(legs)}]).line()"


def _brake(brake: BrakePlan) -> str:
    """Its arguments."""
    given = [f"at={tuple_of(brake.at)}"] if brake.at is not None else []
    given += [f"time={number(brake.time)}"] if brake.time is not None else []
    if brake.near is not None and brake.within is not None:
        given += [f'near="{brake.near}"', f"within={number(brake.within)}"]
    given += [f"share={number(brake.share)}"] if brake.share < 1.0 else []
    return ", ".join(given)


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
