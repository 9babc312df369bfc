"""One sandboxed process: started, watched, drained of what it prints, ended, cleaned up after."""

from __future__ import annotations

import contextlib
import json
import os
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, Literal

from wsim.program.sandbox import isolation as ways
from wsim.program.sandbox import watch
from wsim.program.sandbox.limits import Limits
from wsim.program.sandbox.result import REPORT_BYTES

Stopped = Literal["", "timeout", "log", "scratch", "threads"]
_TICK, _LONGEST = 0.05, 0.2  # [s] between looks at a running process: how long at least, and at most
_SPARED = 50  # times as long as a look took nobody looks: of many processes side by side each look holds up the others
_DRAIN_SECONDS = 2.0
_BOOT = (
    "import json, sys; job = json.loads(sys.argv.pop()); sys.path[:0] = job['path'][0]; "
    "sys.path += [p for p in job['path'][1] if p not in sys.path]; "
    "from wsim.program.inside.main import main; main(job)"
)
# A process is told to die with the *thread* that started it; this one lives as long as Python does.
_SPAWNER = ThreadPoolExecutor(1, thread_name_prefix="wsim-sandbox")


class SandboxProcess:
    """A task of `wsim.program.inside` in a process of its own.

    Use it as a context manager: on leaving, the process and all that it started are dead and its files are gone.

    Attributes:
        isolation: "bubblewrap", "landlock" or "none".
        stopped: Why the parent ended it, if it did.
        code: Exit status, once it has ended; negative for a signal.
    """

    def __init__(
        self,
        job: dict[str, Any],
        *,
        limits: Limits,
        isolation: str,
        readable: Sequence[Path] = (),
        descriptors: Sequence[int] = (),
    ) -> None:
        """Start the process.

        Args:
            job: What to do; isolation, limits and paths are added to it.
            limits: What it may use.
            isolation: As `isolation.choose` gives it.
            readable: Paths it may read, beyond Python, wsim and the libraries.
            descriptors: Open files that it inherits, under the same numbers.
        """
        self.isolation = isolation
        self.stopped: Stopped = ""
        self.code: int | None = None
        self._limits = limits
        self._log = bytearray()
        self._report = tempfile.TemporaryFile()  # noqa: SIM115 - closed with the process
        self._scratch = tempfile.mkdtemp(prefix="wsim-sandbox-") if isolation != "bubblewrap" else None
        scratch = self._scratch or ways.SCRATCH
        job = {
            **job,
            "isolation": isolation,
            "limits": limits.model_dump(),
            "scratch": scratch,
            "read": [str(path) for path in (*ways.runtime_paths(), *readable)],
            "parent": os.getpid(),
            "path": ways.module_paths(),
            "report_fd": self._report.fileno(),
        }
        command = [sys.executable, "-s", "-P", "-B", "-c", _BOOT, json.dumps(job)]
        passed = [self._report.fileno(), *descriptors]
        self._info: int | None = None
        if isolation == "bubblewrap":
            self._info, info = os.pipe()
            wrap = ways.bubblewrap(readable, scratch_bytes=limits.scratch_bytes)
            command = [*wrap, "--info-fd", str(info), "--", *command]
            passed.append(info)
        try:
            self._process = _SPAWNER.submit(_start, command, ways.environment(scratch), passed).result()
        except BaseException:
            self._clean()
            raise
        finally:
            if self._info is not None:
                os.close(info)
        self._watched = self._process.pid if isolation != "bubblewrap" else None
        self._drain = threading.Thread(target=self._read_output, daemon=True)
        self._drain.start()

    def __enter__(self) -> SandboxProcess:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def log(self) -> str:
        """What it printed so far, cut at the limit."""
        return bytes(self._log).decode(errors="replace")

    @property
    def alive(self) -> bool:
        """Whether it still runs."""
        return self.code is None and self._process.poll() is None

    def send(self, data: bytes = b"") -> None:
        """Write all that its standard input will hold, and end it; nothing if it is gone."""
        assert self._process.stdin is not None
        if self._process.stdin.closed:
            return
        with contextlib.suppress(BrokenPipeError), self._process.stdin as stream:
            stream.write(data)

    def wait(self, seconds: float) -> None:
        """Wait until it ends, and end it when its time is up or it uses more than it may. Sets `stopped` and `code`."""
        if self.code is not None:
            return
        deadline, tick = time.monotonic() + seconds, _TICK
        ended = os.pidfd_open(self._process.pid)
        try:
            while True:
                left = deadline - time.monotonic()
                if _ready(ended, max(0.0, min(tick, left))):
                    break
                began = time.monotonic()
                excess = self.excess()
                tick = min(max(_TICK, _SPARED * (time.monotonic() - began)), _LONGEST)
                if excess or left <= 0.0:
                    self.kill(excess or "timeout")
                    break
        finally:
            os.close(ended)
        self.kill()

    def excess(self) -> Stopped:
        """What it uses too much of, of that which no rlimit bounds."""
        if self.stopped:
            return self.stopped
        if self._watched is None:
            self._watched = self._inner()
        if self._scratch is not None:
            used = watch.folder_bytes(self._scratch)
            used += watch.deleted_bytes(self._watched, self._scratch, self._limits.file_bytes)
        else:  # its tmpfs has a size; only the number of its files has no bound
            used = watch.many_files(self._watched, ways.SCRATCH)
        if used > self._limits.scratch_bytes:
            return "scratch"
        if watch.threads(self._watched) > self._limits.threads:
            return "threads"
        return ""

    def kill(self, why: Stopped = "") -> None:
        """End it and all that it started, if it runs, and wait for that. Sets `code`."""
        if why and not self.stopped:
            self.stopped = why
        if self.code is not None:
            return
        # The process's own group: bubblewrap, the first process of its name space and the program.
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self.code = self._process.wait()
        self._drain.join(_DRAIN_SECONDS)

    def report(self) -> bytes:
        """What it reported, as it wrote it, cut at a limit."""
        return os.pread(self._report.fileno(), REPORT_BYTES + 1, 0)

    def close(self) -> None:
        """End it and remove its files."""
        self.kill()
        self.send()
        self._clean()

    def _clean(self) -> None:
        self._report.close()
        if self._info is not None:
            os.close(self._info)
            self._info = None
        if self._scratch is not None:
            _remove(self._scratch)
            self._scratch = None

    def _read_output(self) -> None:
        assert self._process.stdout is not None
        with self._process.stdout as stream:
            while data := os.read(stream.fileno(), 1 << 16):
                room = self._limits.log_bytes - len(self._log)
                self._log += data[:room]
                if len(data) > room and not self.stopped:
                    self.stopped = "log"
                    with contextlib.suppress(ProcessLookupError):
                        os.killpg(self._process.pid, signal.SIGKILL)

    def _inner(self) -> int | None:
        """The program's process, which is the one child of the first process in bubblewrap's name space."""
        if self._info is None or not _ready(self._info, 0.0):
            return None
        with contextlib.suppress(OSError, ValueError, KeyError, IndexError):
            if not hasattr(self, "_first"):
                self._first = int(json.loads(os.read(self._info, 4096))["child-pid"])
            return int(Path(f"/proc/{self._first}/task/{self._first}/children").read_text().split()[0])
        return None


def _start(command: Sequence[str], environment: dict[str, str], descriptors: Sequence[int]) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        command,
        env=environment,
        cwd="/",
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        pass_fds=tuple(descriptors),
        start_new_session=True,
    )


def _remove(folder: str) -> None:
    with contextlib.suppress(OSError, RecursionError):
        shutil.rmtree(folder)
        return
    # With isolation "none" a program can nest folders deeper than Python follows, or take its own rights to them.
    for command in (["chmod", "-R", "u+rwX", folder], ["rm", "-rf", folder]):
        subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, check=False)


def _ready(descriptor: int, seconds: float) -> bool:
    """Whether there is something to read, or an end, within some time; select(2) knows no descriptor above 1,023."""
    waiting = select.poll()
    waiting.register(descriptor, select.POLLIN)
    return bool(waiting.poll(1000.0 * seconds))
