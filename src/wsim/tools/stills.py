"""The tool that draws a still: any camera, at any recorded time."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from pydantic import Field, FiniteFloat

from wsim import recording, sim
from wsim.errors import UserError
from wsim.scene.describe import describe
from wsim.scene.world import Camera
from wsim.sim.seen import still_name, write_png
from wsim.tools.base import Result, Tool, Workspace
from wsim.tools.iterations import OfIteration, file_of
from wsim.tools.run import picture_lines
from wsim.tools.text import name_of, number, prim_of

if TYPE_CHECKING:
    from wsim.scene.world import World

Point = tuple[FiniteFloat, FiniteFloat, FiniteFloat]
OWN = "/World/own_view"


class StillOf(OfIteration):
    """A picture of one moment."""

    camera: str = Field("", description="a camera's name; the first by default", max_length=200)
    time: float = Field(0.0, ge=0.0, allow_inf_nan=False, description="simulated time [s]; the nearest frame is drawn")
    eye: Point | None = Field(None, description="x, y, z [m] to look from, in place of a camera")
    target: Point | None = Field(None, description="x, y, z [m] to look at; goes with eye")


def still(workspace: Workspace, asked: StillOf) -> Result:
    """A PNG, and how many pixels of it each object has."""
    stage = file_of(workspace, asked.iteration, "stage.usda", "run_program with the pass build makes one")
    path = stage.with_name("recording.rrd")
    if asked.time > 0.0 and not path.is_file():
        file_of(workspace, asked.iteration, path.name, "run_program with the pass physics records; time=0 needs none")
    found = recording.read(path) if path.is_file() else None
    if found is not None and not len(found.time):
        raise UserError(f"iterations/{stage.parent.name}/{path.name} has no frames; see the verdict")
    if found is not None and asked.time > found.time[-1] + 0.5 / found.world.frame_rate:
        raise UserError(f"time: {number(asked.time)} s is after the recording's end at {number(found.time[-1])} s")
    world = found.world if found is not None and found.world.cameras else describe(stage)
    stills = sim.Stills(stage, workspace.settings.device, [_camera(world, asked)], workspace.progress)
    (drawn,) = stills.draw(found, asked.time) if found is not None else stills.draw_start()
    name = still_name(_file_stem(asked) or drawn.camera.prim, drawn.time)
    target = stage.parent / "stills" / name
    write_png(target, drawn.rgb)
    lines = picture_lines(f"iterations/{stage.parent.name}/stills/{name}", drawn.pixels, drawn.rgb.shape)
    lines[0] += f", t = {number(drawn.time)} s; water and glass are looked through"
    return Result("\n".join(lines), image=target)


def _camera(world: World, asked: StillOf) -> Camera:
    """The camera that is meant.

    Raises:
        UserError: If there is none of that name, or eye and target are no view.
    """
    if (asked.eye is None) is not (asked.target is None):
        raise UserError("eye and target go together; give both, or the name of a camera")
    if asked.eye is not None and asked.target is not None:
        if asked.camera:
            raise UserError("camera: give its name, or eye and target, not both")
        if math.dist(asked.eye, asked.target) < 1e-6:
            raise UserError(f"eye and target are both ({', '.join(map(number, asked.eye))}); move one of them")
        return Camera(prim=OWN, eye=asked.eye, target=asked.target)
    known = {camera.prim: camera for camera in sim.cameras_of(world)}
    if not asked.camera:
        return next(iter(known.values()))
    if prim_of(asked.camera) not in known:
        names = ", ".join(name_of(prim) for prim in known)
        raise UserError(f"camera: no {asked.camera[:60]!r}; there are {names}, or give eye and target")
    return known[prim_of(asked.camera)]


def _file_stem(asked: StillOf) -> str:
    """A name for a view of its own, from where it looks; empty for a camera of the stage."""
    if asked.eye is None or asked.target is None:
        return ""
    return "from_" + "_".join(number(x) for x in asked.eye) + "_at_" + "_".join(number(x) for x in asked.target)


TOOLS = (
    Tool(
        "still", "A picture of any camera, or any view, at any recorded time, and each object's pixels in it.", StillOf,
        still, writes=True,
    ),
)  # fmt: skip
