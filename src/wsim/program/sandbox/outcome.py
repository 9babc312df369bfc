"""What became of a sandboxed process: its kind, a message and the program's line."""

from __future__ import annotations

import errno
import signal

from wsim.program.sandbox.limits import Limits
from wsim.program.sandbox.process import SandboxProcess
from wsim.program.sandbox.result import Kind, Report, ending, printable, read_report

_MESSAGE = 400  # characters of what a program's exception says; its log has the rest
_NO_ROOM = (errno.ENOSPC, errno.EFBIG, errno.EDQUOT, errno.EMFILE)


def judge(process: SandboxProcess, limits: Limits, name: str, call: str) -> tuple[Kind, str, str | None]:
    """Say what became of a process that has ended.

    Args:
        process: The process.
        limits: What it was allowed.
        name: File name of the program, for the line.
        call: What it was to do, "build(scene)".

    Returns:
        Kind, message and line; "ok" if the process says that it did what it was to do.
    """
    stopped = _stopped(process, limits, call)
    if stopped is not None:
        return (*stopped, None)
    report = read_report(process.report()) if process.code == 0 else None
    if report is None:
        return (*_died(process, call), None)
    line = f"{name}:{report.line}" if report.line else None
    if report.outcome == "ok":
        return "ok", "done", None
    kind: Kind = "exception"
    if report.no_memory or report.type == "MemoryError":
        return "memory", f"the program ran out of its {limits.memory_bytes >> 20} MiB of memory", line
    if report.errno in _NO_ROOM:
        kind = "output"
    return kind, _told(report), line


def _told(report: Report) -> str:
    text = ": ".join(part for part in (report.type, report.message) if part)
    # One line: USD's errors are pages long, and the log has them whole.
    line = " ".join(printable(text).split())
    return line if len(line) <= _MESSAGE else line[:_MESSAGE] + "…"


def _stopped(process: SandboxProcess, limits: Limits, call: str) -> tuple[Kind, str] | None:
    if process.stopped == "timeout":
        return "timeout", f"{call} did not end within {limits.wall_seconds:g} s and was stopped"
    if process.code in (-signal.SIGXCPU, 128 + signal.SIGXCPU):
        return "timeout", f"{call} used more than {limits.cpu_seconds:g} s of CPU time and was stopped"
    if process.stopped == "log":
        return "output", f"the program printed more than {limits.log_bytes} bytes and was stopped"
    if process.stopped == "scratch":
        return "output", f"the program wrote more than {limits.scratch_bytes} bytes of files and was stopped"
    if process.stopped == "threads":
        return "crash", f"the program started more than {limits.threads} threads and was stopped"
    return None


def _died(process: SandboxProcess, call: str) -> tuple[Kind, str]:
    """A process that ended without a report."""
    assert process.code is not None
    log = process.log
    if "std::bad_alloc" in log[-4000:] or "MemoryError" in log[-400:]:
        return "memory", "the program ran out of memory"
    if process.code == 0:
        return "crash", f"the program ended its process before {call} returned"
    return "crash", f"the program {ending(process.code)} before {call} returned"
