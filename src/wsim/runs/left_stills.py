"""Stills of a program that did not come as far as its pictures: what was recorded of it, or else how it starts."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from wsim import recording, sim
from wsim.errors import UserError
from wsim.progress import Progress, silent
from wsim.runs.folder import write_json
from wsim.sim.seen import still_name, write_png

if TYPE_CHECKING:
    from wsim.sim.stills import Still


def leave_stills(folder: Path, named: Sequence[str] = (), device: str = "auto", progress: Progress = silent) -> None:
    """Draw what happened, by a folder's stage and recording, into its frames/, and say in review.json what is seen.

    Where there is no stage, or stills are there already, nothing is done; nor where the stage breaks the renderer too.

    Args:
        folder: An iteration's.
        named: Names of the objects that it is about.
        device: That draws.
        progress: Told about compilation.
    """
    stage, frames = folder / "stage.usda", folder / "frames"
    if not stage.is_file() or any(frames.glob("*.png")):
        return
    try:
        stills = _drawn(stage, folder / "recording.rrd", named, device, progress)
    except (UserError, ValueError, RuntimeError, LookupError, ArithmeticError):
        return  # the verdict says what is wrong with it; there is no picture of that
    shares = []
    for still in stills:
        write_png(frames / still_name(still.camera.prim, still.time), still.rgb)
        size = still.rgb.shape[0] * still.rgb.shape[1]
        seen = {prim: round(count / size, 5) for prim, count in still.pixels.items() if count}
        shares.append({"camera": still.camera.prim, "time": round(still.time, 4), "objects": seen})
    write_json(folder / "review.json", {"share_of_picture": shares})


def _drawn(stage: Path, recorded: Path, named: Sequence[str], device: str, progress: Progress) -> list[Still]:
    drawer = sim.Stills(stage, device, progress=progress)
    if recorded.is_file():
        found = recording.read(recorded)
        if len(found.time):
            return drawer.draw_moments(found, named)
    return drawer.draw_start()
