"""A plan's terrain as the scene lays it, so that a vehicle stands on it and a world is held against it."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from wsim.assets import AssetError, get
from wsim.plan.layout.drives import check_drives
from wsim.plan.layout.errors import LayoutError
from wsim.plan.schema import (
    FromScatter,
    FromTerrain,
    FromVehicle,
    HillLayer,
    LevelLayer,
    NoiseLayer,
    Plan,
    PlanObject,
    Pose,
)
from wsim.plan.schema.constructions import ROCKS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.scene.terrain import Terrain
    from wsim.scene.vehicle_spec import VehicleSpec

STEEPEST = 35.0  # [deg]: about where tyres slip
_ROUND = np.linspace(-0.9, 0.9, 9)  # of a wheel's radius: places along it that are looked at
_ROUNDS = 3
_SAME = 1e-9  # [m/s]


def terrain_of(plan: Plan) -> PlanObject | None:
    """The plan's first terrain."""
    return next((item for item in plan.objects if isinstance(item.built, FromTerrain)), None)


def survey(item: PlanObject) -> Terrain:
    """What knows the height of terrain at a place.

    Raises:
        LayoutError: The scene would refuse it; in the scene's words.
    """
    assert isinstance(item.built, FromTerrain)
    return _survey(item.name, item.built.model_dump_json())


@lru_cache(maxsize=8)
def _survey(name: str, construction: str) -> Terrain:
    from wsim.scene import Hill, Level, Noise, Road, SceneError  # with USD, and few plans have terrain
    from wsim.scene.terrain import surveyed

    made = FromTerrain.model_validate_json(construction)
    layers: list[Hill | Level | Noise | Road] = []
    for each in made.layers:
        if isinstance(each, NoiseLayer):
            layers.append(Noise(each.amplitude, each.wavelength, octaves=each.octaves, seed=each.seed))
        elif isinstance(each, HillLayer):
            layers.append(Hill(each.position, each.radius, each.height))
        elif isinstance(each, LevelLayer):
            layers.append(Level(each.position, each.radius, blend=each.blend))
        else:
            layers.append(Road(each.points, each.width, each.shoulder, each.smooth))
    try:
        return surveyed(name, size=made.extent, layers=layers, cell=made.cell)
    except SceneError as error:
        raise LayoutError(str(error)) from error


def divided(item: PlanObject) -> NDArray[np.int64]:
    """Which of terrain's areas each of its cells is in, from 1 on, 0 for none: (rows along +Y, columns along +X).

    Raises:
        LayoutError: The scene would refuse it; in the scene's words.
    """
    assert isinstance(item.built, FromTerrain)
    return _divided(item.name, item.built.model_dump_json())


@lru_cache(maxsize=8)
def _divided(name: str, construction: str) -> NDArray[np.int64]:
    from wsim.scene import Area, Road, SceneError  # with USD, and few plans have terrain
    from wsim.scene.areas import divided
    from wsim.scene.validate import Call

    made = FromTerrain.model_validate_json(construction)
    cells = _survey(name, construction).cells
    y, x = (edge * ((np.arange(n) + 0.5) / n - 0.5) for edge, n in zip(made.extent[::-1], cells, strict=True))
    areas = [Area(area.name, road=Road(area.points, width=area.width)) for area in made.areas]
    try:
        return divided(Call("terrain", name), areas, *np.meshgrid(x, y))[1]
    except SceneError as error:
        raise LayoutError(str(error)) from error


def set_down(plan: Plan) -> Plan:
    """The plan with its vehicles on the ground, leaning as it does under their wheels.

    Raises:
        LayoutError: A vehicle stands beside the terrain or where it is too steep, the scene would refuse the terrain
            or a driver, what is scattered is no one body of the catalogue, or there is no time for a drive.
    """
    for item in plan.objects:
        if isinstance(item.built, FromScatter):
            _known(item.name, item.built)
        if isinstance(item.built, FromTerrain):
            survey(item)
            divided(item)
    land = terrain_of(plan)
    if land is not None:
        plan = plan.model_copy(update={"objects": [_stood(item, land) for item in plan.objects]})
    check_drives(plan)
    return plan


def _known(name: str, scatter: FromScatter) -> None:
    """LayoutError if what is scattered is neither rocks nor a thing of the catalogue that is one body."""
    for what in scatter.what if scatter.what != (ROCKS,) else ():
        try:
            entry = get(what)
        except AssetError as error:
            raise LayoutError(f"{name} is to scatter {what!r}: {error}") from error
        if entry.articulated:
            raise LayoutError(f"{name} is to scatter {what!r}, whose parts move on a joint; take another")


def _stood(item: PlanObject, land: PlanObject) -> PlanObject:
    """A vehicle on the plane that is nearest to the ground under its wheels, and so high that none is in it."""
    if not isinstance(item.built, FromVehicle) or item.pose is None:
        return item
    from wsim.scene.vehicle_spec import preset  # as above

    pose = _resting(item.name, preset(item.built.vehicle), item.pose, land)
    stood = item.model_copy(update={"pose": pose})
    speed = math.copysign(math.hypot(*item.velocity), item.speed_ahead)
    moves = tuple(speed * way for way in stood.ahead)
    if pose == item.pose and math.dist(moves, item.velocity) < _SAME:
        return item
    return stood.model_copy(update={"velocity": moves})


def _resting(name: str, spec: VehicleSpec, pose: Pose, land: PlanObject) -> Pose:
    """How a vehicle stands on the ground, turned as it is about the vertical.

    With roll, then pitch, then yaw its forward direction rises by -tan(pitch), its left by tan(roll) / cos(pitch).
    """
    from wsim.scene.vehicle_spec import CORNERS  # as above

    ground, (x, y, _), yaw = survey(land), pose.position, math.radians(pose.rotation_deg[2])
    wheels, ahead = np.array([spec.place(corner) for corner in CORNERS]), spec.wheel_radius * _ROUND
    tyre = spec.wheel_radius - np.sqrt(spec.wheel_radius**2 - ahead**2)  # how much higher it is beside its lowest point
    roll = pitch = 0.0
    for _ in range(_ROUNDS):  # leaning brings its wheels somewhat closer together, as seen from above
        u = (wheels[:, :1] + ahead) * math.cos(pitch) + wheels[:, 1:] * math.sin(roll) * math.sin(pitch)
        v = wheels[:, 1:] * math.cos(roll) + np.zeros_like(ahead)
        at = x + u * math.cos(yaw) - v * math.sin(yaw), y + u * math.sin(yaw) + v * math.cos(yaw)
        if not all(ground.has(float(a), float(b)) for a, b in zip(at[0].flat, at[1].flat, strict=True)):
            raise LayoutError(
                f"{name} starts at ({x:g}, {y:g}) m with a wheel where {land.name} is not; move it, or extend that"
            )
        heights, under = ground.heights(*at), len(_ROUND) // 2
        plane = np.column_stack([np.ones(len(wheels)), u[:, under], v[:, under]])
        level, rise, lean = (float(each) for each in np.linalg.lstsq(plane, heights[:, under])[0])
        steep = math.degrees(math.atan(math.hypot(rise, lean)))
        if steep > STEEPEST:
            raise LayoutError(
                f"{name} starts at ({x:g}, {y:g}) m on ground of {steep:.3g} degrees, where it would not stay; move "
                f"it, or give {land.name} a level layer there"
            )
        pitch = -math.atan(rise)
        roll = math.atan(lean * math.cos(pitch))
    lift = float((heights - level - rise * u - lean * v - tyre).max())
    turn = (*(round(math.degrees(angle), 4) + 0.0 for angle in (roll, pitch)), pose.rotation_deg[2])
    return Pose(position=(x, y, round(level + max(lift, 0.0), 6) + 0.0), rotation_deg=turn)
