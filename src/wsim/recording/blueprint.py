"""How the viewer lays a recording out: the scene, the cameras, the plots and the log."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from wsim.recording.columns import HEIGHT_ROOT, LOG_ENTITY, SCALAR_ROOT, TIMELINE, entity_path, nanoseconds

if TYPE_CHECKING:
    from wsim.scene.world import World


def make_blueprint(world: World, time: float | None = None, entity: str | None = None) -> Any:
    """The layout for a world's recording.

    Args:
        world: What was recorded.
        time: Where playback is to start [s]; None leaves it to the viewer.
        entity: A prim for the 3D view to look at and follow.
    """
    import rerun.blueprint as rrb

    scene = rrb.Spatial3DView(
        name="Scene",
        origin="/",
        contents=["/World/**"],
        background=rrb.Background(kind=rrb.BackgroundKind.GradientBright),
        line_grid=False,
        eye_controls=_eye(world, entity),
    )
    views: list[Any] = [scene]
    cameras = [
        rrb.Spatial2DView(name=camera.prim.rsplit("/", 1)[-1], origin=entity_path(camera.prim))
        for camera in world.cameras
    ]
    if cameras:
        views.append(rrb.Horizontal(*cameras) if len(cameras) <= 3 else rrb.Tabs(*cameras))
    left = rrb.Vertical(*views, row_shares=[2, 1][: len(views)])
    return rrb.Blueprint(
        rrb.Horizontal(left, rrb.Vertical(*_plots(world), _log(world)), column_shares=[2, 1]),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        _time_panel(world, time),
    )


def _plots(world: World) -> list[Any]:
    import rerun.blueprint as rrb

    energy = f"{SCALAR_ROOT}energy/**"
    plots = [rrb.TimeSeriesView(name="Energy [J]", origin="/", contents=[energy])]
    if world.bodies:
        plots.append(rrb.TimeSeriesView(name="Height of bodies [m]", origin="/", contents=[f"{HEIGHT_ROOT}**"]))
    plots.append(rrb.TimeSeriesView(name="Other scalars", origin="/", contents=[f"{SCALAR_ROOT}**", f"- {energy}"]))
    return plots


def _log(world: World) -> Any:
    import rerun.blueprint as rrb

    return rrb.TextLogView(name="Log", origin="/", contents=[f"{LOG_ENTITY}/**", "/World/**"])


def _eye(world: World, entity: str | None) -> Any | None:
    """The first camera's view, so that the scene opens as the program's author framed it."""
    import rerun.blueprint as rrb

    tracked = entity_path(entity) if entity is not None else None
    if not world.cameras:
        return rrb.EyeControls3D(tracking_entity=tracked) if tracked is not None else None
    camera = world.cameras[0]
    return rrb.EyeControls3D(
        kind=rrb.Eye3DKind.Orbital,
        position=camera.eye,
        look_target=camera.target,
        eye_up=camera.up,
        tracking_entity=tracked,
    )


def _time_panel(world: World, time: float | None) -> Any:
    import rerun as rr
    import rerun.blueprint as rrb

    if time is None:
        return rrb.TimePanel(state="collapsed", timeline=TIMELINE, loop_mode="all")
    # A blueprint has no time cursor; playing inside a selection that starts at `time` puts it there.
    end = max(world.duration, time + 1.0 / world.frame_rate)
    selection = rr.encodings.AbsoluteTimeRange(
        rr.encodings.TimeInt(nanos=nanoseconds(time)), rr.encodings.TimeInt(nanos=nanoseconds(end))
    )
    return rrb.TimePanel(timeline=TIMELINE, loop_mode="selection", time_selection=selection, play_state="playing")
