"""How the viewer lays a recording out: the scene, the cameras, the plots and the log."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
import rerun.blueprint as rrb

from wsim.geometry.rotations import rotate
from wsim.recording.columns import HEIGHT_ROOT, LOG_ENTITY, SCALAR_ROOT, SENSOR_ROOT, TIMELINE, entity_path

if TYPE_CHECKING:
    from wsim.scene.world import World

BACKGROUND = (225, 232, 240)  # glass and water show on it
EYE_TURN = 35.0  # [deg] about Z
EYE_DISTANCE = 0.85  # of the first camera's


def make_blueprint(world: World, *, paused: bool = False, entity: str | None = None) -> Any:
    """The layout for a world's recording.

    Args:
        world: What was recorded.
        paused: Whether the viewer is to stand still at the beginning.
        entity: A prim for the 3D view to look at and follow.
    """
    scene = rrb.Spatial3DView(
        name="Scene",
        origin="/",
        contents=["/World/**"],
        background=BACKGROUND,
        line_grid=False,
        eye_controls=eye_controls(world, entity),
    )
    views: list[Any] = [scene]
    cameras = [
        rrb.Spatial2DView(name=camera.prim.rsplit("/", 1)[-1], origin=entity_path(camera.prim))
        for camera in world.cameras
    ]
    cameras += [
        rrb.Spatial2DView(name=sensor.prim.rsplit("/", 1)[-1], origin=entity_path(f"{SENSOR_ROOT}{sensor.prim}/color"))
        for sensor in world.sensors
        if "color" in sensor.channels
    ]
    if cameras:
        views.append(rrb.Horizontal(*cameras) if len(cameras) <= 3 else rrb.Tabs(*cameras))
    left = rrb.Vertical(*views, row_shares=[2, 1][: len(views)])
    return rrb.Blueprint(
        rrb.Horizontal(left, rrb.Vertical(*_plots(world), _log()), column_shares=[2, 1]),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        rrb.TimePanel(
            state="collapsed", timeline=TIMELINE, loop_mode="all", play_state="paused" if paused else "playing"
        ),
    )


def _plots(world: World) -> list[Any]:
    energy = f"{SCALAR_ROOT}energy/**"
    plots = [rrb.TimeSeriesView(name="Energy [J]", origin="/", contents=[energy])]
    if world.bodies:
        plots.append(rrb.TimeSeriesView(name="Height of bodies [m]", origin="/", contents=[f"{HEIGHT_ROOT}**"]))
    if world.sensors:
        plots.append(rrb.TimeSeriesView(name="Sensors", origin="/", contents=[f"{SENSOR_ROOT}/**"]))
    plots.append(rrb.TimeSeriesView(name="Other scalars", origin="/", contents=[f"{SCALAR_ROOT}**", f"- {energy}"]))
    return plots


def _log() -> Any:
    return rrb.TextLogView(name="Log", origin="/", contents=[f"{LOG_ENTITY}/**", "/World/**"])


def eye_controls(world: World, entity: str | None) -> Any | None:
    """Near the first camera, turned aside: from its very place its own picture would hide the scene."""
    tracked = entity_path(entity) if entity is not None else None
    if not world.cameras:
        return rrb.EyeControls3D(tracking_entity=tracked) if tracked is not None else None
    camera = world.cameras[0]
    half = 0.5 * math.radians(EYE_TURN)
    turn = np.array([0.0, 0.0, math.sin(half), math.cos(half)])
    offset = rotate(turn, np.subtract(camera.eye, camera.target)) * EYE_DISTANCE
    return rrb.EyeControls3D(
        kind=rrb.Eye3DKind.Orbital,
        position=np.add(camera.target, offset),
        look_target=camera.target,
        eye_up=(0.0, 0.0, 1.0),
        tracking_entity=tracked,
    )
