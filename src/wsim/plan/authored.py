"""What the scene's own calls make of a plan's objects, so that a world is held against it part by part."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

from wsim.plan.schema import FromVehicle, PlanObject

if TYPE_CHECKING:
    from wsim.scene.world import Shape, Vec3, World


def vehicle_of(item: PlanObject, gravity: Vec3) -> World:
    """A vehicle of the plan by itself: its bodies and joints, where the plan has it, with what is set once.

    Args:
        item: A vehicle; without a pose it stands about the origin.
        gravity: Of the world that it is held against [m/s^2]: its springs carry its weight.
    """
    return _vehicle(item.model_dump_json(exclude={"words"}), gravity)


@lru_cache(maxsize=8)
def _vehicle(given: str, gravity: Vec3) -> World:
    from wsim.scene import Scene  # with USD, and few plans have a vehicle
    from wsim.scene.describe import describe

    item = PlanObject.model_validate_json(given)
    assert isinstance(item.built, FromVehicle)
    scene = Scene()
    scene.simulation(gravity=gravity)
    place, turn = (item.pose.position, item.pose.rotation_deg) if item.pose is not None else ((0.0, 0.0, 0.0),) * 2
    made = scene.vehicle(
        item.name,
        item.built.vehicle,
        position=place,
        yaw_deg=turn[2],
        pitch_deg=turn[1],
        roll_deg=turn[0],
        speed=item.speed_ahead,
    )
    for each in item.registration.actuation:
        if each.kind == "drive":
            made.drive(each.speed or 0.0)
            made.steer(each.steer_deg or 0.0)
    return describe(scene.stage)


@lru_cache(maxsize=64)
def asset_of(asset: str) -> list[Shape]:
    """The shapes of a thing of the catalogue that never moves, upright at the origin; none of what there is not."""
    from wsim.assets import AssetError  # with USD, as above
    from wsim.scene import Scene, SceneError
    from wsim.scene.describe import describe

    scene = Scene()
    try:
        scene.asset("thing", asset, static=True)
    except (AssetError, SceneError):
        return []
    return [shape for static in describe(scene.stage).statics for shape in static.shapes]
