"""`wsim view`: open a run's recording in Rerun."""

from __future__ import annotations

import contextlib
import shlex
from pathlib import Path
from typing import Annotated

import typer

from wsim import recording as recordings
from wsim.cli.judge import find_recording
from wsim.errors import UserError
from wsim.judge.verdict import Verdict
from wsim.recording.display import has_display
from wsim.report.side_by_side import recorded, side_by_side
from wsim.runs.named import is_run, named


def view(
    target: Annotated[
        Path, typer.Argument(help="The folder of a run, of an iteration or a sweep, or a recording.rrd.")
    ],
    web: Annotated[bool, typer.Option("--web", help="Serve the web viewer on 127.0.0.1 until Ctrl-C.")] = False,
    port: Annotated[int, typer.Option("--port", min=0, max=65535, help="Port of the page; 0 takes a free one.")] = 0,
    finding: Annotated[
        int | None, typer.Option("--finding", min=1, help="Open at the time and prim of this finding of the verdict.")
    ] = None,
) -> None:
    """Open a recording in Rerun's viewer; with no display, print the command to use elsewhere.

    Of a run with several iterations, and of a sweep, all that were recorded are shown side by side.
    """
    recording = _all_of(named(target)) if finding is None else None
    if recording is None:
        recording, _ = find_recording(target)
    time, prim = _moment(recording, finding) if finding is not None else (None, None)
    if web:
        served = recordings.serve_web(recording, port, time=time, entity=prim)
        with contextlib.suppress(KeyboardInterrupt), served as server:  # the way it is meant to end
            print(f"serving {recording} on 127.0.0.1 only; Ctrl-C stops\n{server.url}", flush=True)
            server.process.wait()
        return
    if has_display():
        recordings.open_native(recording, time, prim)
        print(f"opened {recording}")
        return
    chosen = f" --finding {finding}" if finding is not None else ""
    what = "the recording" if finding is None else "the recording, with verdict.json beside it,"
    print(f"There is no display here. Copy {what} to a machine with one, and there run:")
    name = shlex.quote(recording.name)
    print(f"  wsim view {name}{chosen}" if chosen else f"  rerun {name}")
    print("or serve it to a browser on this machine (also through an SSH tunnel):")
    print(f"  wsim view --web {shlex.quote(str(target))}{chosen}")


def _all_of(folder: Path) -> Path | None:
    """All that a run or a sweep recorded in one recording; None where that is one or none."""
    if not is_run(folder) or len(recorded(folder)) < 2:
        return None
    return side_by_side(folder)


def _moment(recording: Path, number: int) -> tuple[float | None, str | None]:
    """Time and prim of a finding of the verdict beside a recording, which is told; None for what cannot be shown."""
    path = recording.with_name("verdict.json")
    if not path.is_file():
        raise UserError(f"{path} does not exist; --finding needs the verdict beside the recording")
    findings = Verdict.model_validate_json(path.read_text(encoding="utf-8")).findings
    if number > len(findings):
        raise UserError(f"--finding {number}: the verdict has {len(findings)} findings")
    finding = findings[number - 1]
    world = recordings.read_world(recording)
    # A missing object has a prim that nothing was recorded of; a joint is seen where its child is.
    seen = {item.prim for group in (world.bodies, world.statics, world.fluids, world.cameras) for item in group}
    seen_as = {joint.prim: joint.child for joint in world.joints}
    prim = seen_as.get(finding.prim, finding.prim) if finding.prim is not None else None
    shown = prim if prim is not None and any(prim == one or prim.startswith(one + "/") for one in seen) else None
    time = finding.time if finding.time is not None or finding.span is None else finding.span[0]
    where = f" at {time:.3f} s" if time is not None else ""
    print(
        f"finding {number}{where}: {finding.message}" + ("" if shown == prim else f" ({prim} is not in the recording)")
    )
    return time, shown
