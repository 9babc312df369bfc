"""`wsim view`: open a run's recording in Rerun."""

from __future__ import annotations

import contextlib
import shlex
from pathlib import Path
from typing import Annotated

import typer

from wsim.cli.judge import find_recording
from wsim.errors import UserError


def view(
    target: Annotated[Path, typer.Argument(help="The folder of a run, or a recording.rrd.")],
    web: Annotated[bool, typer.Option("--web", help="Serve the web viewer on 127.0.0.1 until Ctrl-C.")] = False,
    port: Annotated[int, typer.Option("--port", min=0, max=65535, help="Port of the page; 0 takes a free one.")] = 0,
    finding: Annotated[
        int | None, typer.Option("--finding", min=1, help="Open at the time and prim of this finding of the verdict.")
    ] = None,
) -> None:
    """Open a recording in Rerun's viewer; with no display, print the command to use elsewhere."""
    from wsim.recording.view import has_display, open_native, serve_web

    recording, _ = find_recording(target)
    time, prim = _moment(recording, finding) if finding else (None, None)
    if web:
        with serve_web(recording, port, time=time, entity=prim) as server:
            print(f"serving {recording} on 127.0.0.1 only; Ctrl-C stops\n{server.url}", flush=True)
            with contextlib.suppress(KeyboardInterrupt):  # the way it is meant to end
                server.process.wait()
        return
    if has_display():
        open_native(recording, time, prim)
        print(f"opened {recording}")
        return
    print("There is no display here. Copy the recording to a machine with one, and there run:")
    print(f"  rerun {shlex.quote(recording.name)}")
    print("or serve it to a browser on this machine (also through an SSH tunnel):")
    print(f"  wsim view --web {shlex.quote(str(target))}")


def _moment(recording: Path, number: int) -> tuple[float | None, str | None]:
    """Time and prim of a finding of the verdict beside a recording."""
    from wsim.judge.verdict import Verdict

    path = recording.with_name("verdict.json")
    if not path.is_file():
        raise UserError(f"{path} does not exist; --finding needs the verdict beside the recording")
    findings = Verdict.model_validate_json(path.read_text(encoding="utf-8")).findings
    if number > len(findings):
        raise UserError(f"--finding {number}: the verdict has {len(findings)} findings")
    return findings[number - 1].time, findings[number - 1].prim


def register(app: typer.Typer) -> None:
    """Add the verb."""
    app.command()(view)
