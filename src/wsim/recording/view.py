"""Opens recordings in Rerun's viewer: a window where there is a display, else a web page on this machine alone."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import tempfile
import time as clock
import urllib.error
import urllib.parse
import urllib.request
import webbrowser
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from types import TracebackType

from wsim.errors import UserError
from wsim.recording.display import has_display
from wsim.recording.excerpt import write_excerpt

LOCALHOST = "127.0.0.1"
START_SECONDS = 30.0


def rerun_binary() -> str:
    """The path of the viewer that comes with the Rerun SDK.

    Raises:
        UserError: It is not installed.
    """
    override = os.environ.get("RERUN_CLI_PATH")
    spec = find_spec("rerun_cli")
    if override:
        binary = Path(override)
    elif spec is None or spec.origin is None:
        raise UserError("Rerun's viewer is not installed; install rerun-sdk")
    else:
        # The binary itself: the `rerun` script is a Python process that would stay between us and it.
        folder = Path(spec.origin).parent
        bundled = folder / "Rerun.app" / "Contents" / "MacOS" / "Rerun"
        binary = bundled if bundled.exists() else folder / ("rerun.exe" if sys.platform == "win32" else "rerun")
    if not binary.exists():
        raise UserError(f"Rerun's viewer is not at {binary}; reinstall rerun-sdk")
    return str(binary)


def view_command(path: str | Path, time: float | None = None, entity: str | None = None) -> list[str]:
    """The command that opens a recording in the viewer's window.

    With a time [s] or an entity a copy goes to the temporary folder and is opened instead: one that begins at that
    time, and whose 3D view follows that prim.

    Raises:
        UserError: There is no recording, or no viewer, or the recording knows no such prim or time.
    """
    return [rerun_binary(), *_files(Path(path), time, entity), "--bind", LOCALHOST, "--port", "auto"]


def open_native(
    path: str | Path, time: float | None = None, entity: str | None = None, *, log: str | Path | None = None
) -> subprocess.Popen[bytes]:
    """Open a recording in a window that lives on by itself; what the viewer prints goes to `log`, or nowhere.

    Raises:
        UserError: There is no display; `serve_web` needs none.
    """
    if not has_display():
        raise UserError("there is no display to open a window on; use the web viewer (--web) instead")
    command = view_command(path, time, entity)
    with Path(log or os.devnull).open("wb") as output:
        return subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.STDOUT, start_new_session=True
        )


@dataclass
class WebServer:
    """A running web viewer; stop it with `stop`, or use it as a context manager."""

    url: str  # open this in a browser
    port: int  # of the page
    data_port: int  # of the recording's stream, which the page connects to
    process: subprocess.Popen[bytes] = field(repr=False)

    def stop(self) -> None:
        """End the server and wait until it is gone."""
        if self.process.poll() is None:
            self.process.terminate()
            try:
                self.process.wait(timeout=5.0)
            except subprocess.TimeoutExpired:
                self.process.kill()
        self.process.wait()

    def wait(self) -> None:
        """Wait until the server ends by itself, or the user interrupts."""
        try:
            self.process.wait()
        finally:
            self.stop()

    def __enter__(self) -> WebServer:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.stop()


def serve_web(
    path: str | Path,
    port: int = 0,
    *,
    data_port: int = 0,
    time: float | None = None,
    entity: str | None = None,
    open_browser: bool = False,
) -> WebServer:
    """Serve a recording and Rerun's web viewer on 127.0.0.1 only; returns when the page answers.

    Rerun's Python functions for this bind every interface, so its command line does it, as a process of its own.

    Args:
        path: The recording.
        port: Of the page; 0 takes a free one.
        data_port: Of the stream; 0 takes a free one.
        time: Where it begins [s]; a copy is served then.
        entity: The prim that the 3D view follows.
        open_browser: Whether to open the page in the user's browser.

    Raises:
        UserError: The file is missing, or the server did not start, with what it said.
    """
    files = _files(Path(path), time, entity)
    port, data_port = _free_ports(port, data_port)
    command = [rerun_binary(), *files, "--serve-web", "--bind", LOCALHOST]
    command += ["--web-viewer-port", str(port), "--port", str(data_port)]
    with tempfile.TemporaryFile() as output:
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.STDOUT)
        try:
            _wait_for(f"http://{LOCALHOST}:{port}/", process)
        except UserError as error:
            output.seek(0)
            said = output.read().decode(errors="replace").strip().splitlines()
            raise UserError(f"{error}: {said[-1] if said else 'it said nothing'}") from None
    stream = urllib.parse.quote(f"rerun+http://{LOCALHOST}:{data_port}/proxy", safe="")
    server = WebServer(f"http://{LOCALHOST}:{port}/?url={stream}", port, data_port, process)
    if open_browser:
        webbrowser.open(server.url)
    return server


def _files(path: Path, time: float | None, entity: str | None) -> list[str]:
    if not path.is_file():
        raise UserError(f"no recording at {path}")
    if time is None and entity is None:
        return [str(path)]
    copy = Path(tempfile.mkdtemp(prefix="wsim-view-")) / path.name
    return [str(write_excerpt(path, copy, time, entity))]


def _free_ports(*wanted: int) -> list[int]:
    """The ports asked for, with free ones in the place of zeros. All are held open at once, so that they differ."""
    with_sockets = []
    try:
        for port in wanted:
            probe = socket.socket()
            with_sockets.append(probe)
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            try:
                probe.bind((LOCALHOST, port))
            except OSError as error:
                raise UserError(f"port {port} cannot be used: {error.strerror}; choose another, or 0") from error
        return [probe.getsockname()[1] for probe in with_sockets]
    finally:
        for probe in with_sockets:
            probe.close()


def _wait_for(url: str, process: subprocess.Popen[bytes]) -> None:
    """Wait until the page answers; end the process and raise when it does not."""
    local = urllib.request.build_opener(urllib.request.ProxyHandler({}))  # never ask a proxy for our own machine
    deadline = clock.monotonic() + START_SECONDS
    while clock.monotonic() < deadline:
        if process.poll() is not None:
            raise UserError(f"Rerun's web viewer ended with code {process.returncode}")
        try:
            with local.open(url, timeout=1.0):
                return
        except (urllib.error.URLError, OSError):
            clock.sleep(0.05)
    process.kill()
    process.wait()
    raise UserError(f"Rerun's web viewer did not answer at {url} within {START_SECONDS:.0f} s")
