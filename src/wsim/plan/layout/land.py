"""A plan's terrain as the scene lays it, so that a vehicle stands on it and a world is held against it."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from wsim.plan.layout.errors import LayoutError
from wsim.plan.schema import FromTerrain, HillLayer, LevelLayer, NoiseLayer, Plan, PlanObject, Pose

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.scene.terrain import Terrain


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
    """The plan with its vehicles at the height of the ground under the middle between their axles.

    Raises:
        LayoutError: A vehicle stands beside the terrain, or the scene would refuse one.
    """
    for item in plan.objects:
        if isinstance(item.built, FromTerrain):
            survey(item)
            divided(item)
    land = terrain_of(plan)
    if land is None:
        return plan
    return plan.model_copy(update={"objects": [_stood(item, land) for item in plan.objects]})


def _stood(item: PlanObject, land: PlanObject) -> PlanObject:
    if item.primitive != "vehicle" or item.pose is None:
        return item
    ground, (x, y, _) = survey(land), item.pose.position
    if not ground.has(x, y):
        raise LayoutError(f"{item.name} starts at ({x:g}, {y:g}) m, where {land.name} is not; move it, or extend that")
    pose = Pose(position=(x, y, round(ground.height(x, y), 6) + 0.0), rotation_deg=item.pose.rotation_deg)
    return item.model_copy(update={"pose": pose})
