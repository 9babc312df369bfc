"""Run a program's `control(world, t)` in the sandbox, one call a control step, over shared memory.

with ControlProcess(Path("program.py"), ControlLayout(["/World/block"]), Limits()) as control:
    out = control.step(0.01, {"body_q": body_q, "body_qd": body_qd})
    out["body_force"]  # (W, B, 6)
"""

from __future__ import annotations

import ast
import contextlib
import fcntl
import mmap
import os
import select
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, Literal, NoReturn

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wsim.program.control_world import INPUTS, OUTPUTS, ControlLayout
from wsim.program.sandbox.isolation import choose
from wsim.program.sandbox.limits import Limits
from wsim.program.sandbox.outcome import judge
from wsim.program.sandbox.process import SandboxProcess
from wsim.program.sandbox.result import printable

__all__ = ["ControlError", "ControlLayout", "ControlProcess", "has_control"]

ControlKind = Literal["exception", "timeout", "memory", "crash", "output", "value"]
# Beyond these a number is a mistake; both ways.
LARGEST = {"joint_target": 1e4, "joint_force": 1e7, "body_force": 1e7}  # [rad or m], [N m or N], [N and N m]
_SEALS = 0x1 | 0x2 | 0x4  # F_SEAL_SEAL, F_SEAL_SHRINK, F_SEAL_GROW
_ADD_SEALS = 1033
_TICK = 0.05  # [s] between looks at a slow call
_WATCH = 1.0  # [s] between looks at a fast one


class ControlError(Exception):
    """A program's `control` failed.

    Attributes:
        kind: "exception", "timeout", "memory", "crash" and "output" as of `BuildResult`; "value": it set a number that
            is not finite or out of range.
        message: One line for a person.
        line: "program.py:12", where it is known.
    """

    def __init__(self, kind: ControlKind, message: str, line: str | None = None) -> None:
        super().__init__(f"{message} ({line})" if line else message)
        self.kind, self.message, self.line = kind, message, line

    def finding(self) -> dict[str, Any]:
        """The fields of a `wsim.judge.verdict.Finding`, as plain data."""
        return {"check": "control", "passed": False, "message": self.message, "line": self.line}


def has_control(source: str) -> bool:
    """Whether a program defines `control` at its top level; it is read, not run."""
    try:
        body = ast.parse(source).body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return False
    return any(isinstance(item, ast.FunctionDef) and item.name == "control" for item in body)


class ControlProcess:
    """A program's `control` in a process of its own. Use it as a context manager."""

    def __init__(
        self,
        program: Path,
        layout: ControlLayout,
        limits: Limits | None = None,
        isolation: str = "auto",
        *,
        readable: Sequence[Path] = (),
    ) -> None:
        """Start the process and load the program.

        Args:
            program: The program's file.
            layout: Names and counts.
            limits: What the process may use; `call_seconds` for one call, CPU time not limited.
            isolation: As for `wsim.program.sandbox.build`.
            readable: Files and folders that the program may read besides.

        Raises:
            ControlError: If the program does not load, or has no `control`.
            UserError: If no isolation works here.
        """
        self.layout = layout
        self._program = Path(program).resolve()
        self._limits = (limits or Limits()).model_copy(update={"cpu_seconds": None})
        isolation = choose(isolation)
        self._open: list[int] = []
        self._first = True
        self._watched = time.monotonic()
        memory = _shared_memory(layout.size)
        self._arrays = layout.views(mmap.mmap(memory, layout.size))
        ask_read, self._ask = os.pipe()
        self._answer, answer_write = os.pipe()
        self._open += [self._ask, self._answer]
        job = {
            "task": "control",
            "program": str(self._program),
            "layout": asdict(layout),
            "memory_fd": memory,
            "ask_fd": ask_read,
            "answer_fd": answer_write,
        }
        paths = [self._program, *(Path(path).resolve() for path in readable)]
        self._process = self._started(job, [memory, ask_read, answer_write], isolation, paths)
        self._poll = select.poll()
        self._poll.register(self._answer, select.POLLIN)
        try:
            self._wait(self._limits.first_call_seconds, "loading the program")
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> ControlProcess:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def log(self) -> str:
        """What the program printed, cut at the limit."""
        return printable(self._process.log)

    def step(self, t: float, arrays: Mapping[str, ArrayLike]) -> dict[str, NDArray[np.float32]]:
        """Call `control(world, t)` once.

        Args:
            t: Simulated time [s].
            arrays: `body_q` (W, B, 7), `body_qd` (W, B, 6), `joint_q` (W, J), `joint_qd` (W, J); with `joint_target`
                (W, J) the drives' targets before the call. What is left out stays as it was.

        Returns:
            `joint_target` (W, J), as last set; `joint_force` (W, J) and `body_force` (W, B, 6) of this call: force
            [N] and torque [N m] at the centre of mass, world frame. Copies, finite and in range.

        Raises:
            ControlError: If the call failed; the process is then gone.
            ValueError: If an array has no such name or the wrong shape.
        """
        self._write(t, arrays)
        with contextlib.suppress(BrokenPipeError):
            os.write(self._ask, b"s")
        seconds = self._limits.first_call_seconds if self._first else self._limits.call_seconds
        self._first = False
        self._wait(seconds, f"control(world, t) at t = {t:g} s")
        # Copied before it is looked at: the other side could still be writing.
        result = {name: self._arrays[name].copy() for name in OUTPUTS}
        for name, values in result.items():
            # One comparison for too large, infinite and not a number.
            if values.size and not np.abs(values).max() <= LARGEST[name]:
                self._refuse(name, values, t)
        return result

    def close(self) -> None:
        """End the process."""
        self._process.close()
        self._close_pipes()
        self._arrays = {}  # the shared memory goes with its last view

    def _started(
        self, job: dict[str, Any], theirs: Sequence[int], isolation: str, readable: Sequence[Path]
    ) -> SandboxProcess:
        """The process at work on a job; `theirs` are its ends of what is shared, and closed here."""
        try:
            return SandboxProcess(job, limits=self._limits, isolation=isolation, readable=readable, descriptors=theirs)
        except BaseException:
            self._close_pipes()
            raise
        finally:
            for descriptor in theirs:
                os.close(descriptor)

    def _write(self, t: float, arrays: Mapping[str, ArrayLike]) -> None:
        if not self._open:
            raise ControlError("crash", "the control process has ended")
        for name, values in arrays.items():
            if name not in (*INPUTS, "joint_target"):
                raise ValueError(f"no array {name!r}; known: {', '.join((*INPUTS, 'joint_target'))}")
            given = np.asarray(values)
            if given.shape != self._arrays[name].shape:
                raise ValueError(f"{name} has shape {given.shape}; the layout says {self._arrays[name].shape}")
            self._arrays[name][...] = given
        self._arrays["t"][0] = t
        self._arrays["joint_force"][...] = 0.0
        self._arrays["body_force"][...] = 0.0

    def _wait(self, seconds: float, call: str) -> None:
        """Wait for the answer; a `ControlError` if there is none."""
        now = time.monotonic()
        deadline = now + seconds
        while not self._poll.poll(1000.0 * max(0.0, min(_TICK, deadline - now))):
            now = time.monotonic()
            excess = self._process.excess() or ("timeout" if now >= deadline else "")
            if excess:
                self._process.kill(excess)
                self._fail(call, seconds)
        if not os.read(self._answer, 1):  # it hung up
            self._fail(call, seconds)
        if now - self._watched > _WATCH:
            self._watched = now
            excess = self._process.excess()
            if excess:
                self._process.kill(excess)
                self._fail(call, seconds)

    def _fail(self, call: str, seconds: float) -> NoReturn:
        self._process.wait(1.0)  # it has hung up, and is ending
        limits = self._limits.model_copy(update={"wall_seconds": seconds})
        kind, message, line = judge(self._process, limits, self._program.name, call)
        self.close()
        if kind == "ok" or kind == "stage":
            raise ControlError("crash", f"the program ended its process in {call}", line)
        raise ControlError(kind, message, line)

    def _refuse(self, name: str, values: NDArray[np.float32], t: float) -> NoReturn:
        """Raise for the first value that cannot be used."""
        bad = ~(np.abs(values) <= LARGEST[name])
        world, index, *rest = (int(i) for i in np.argwhere(bad)[0])
        prim = (self.layout.bodies if name == "body_force" else self.layout.joints)[index]
        where = "".join(f"[{i}]" for i in (world, index, *rest))
        value = values[bad][0]
        self.close()
        raise ControlError(
            "value",
            f"{name}{where} = {value:g} ({prim}, world {world}) at t = {t:g} s must be finite and at most "
            f"{LARGEST[name]:g} in size",
        )

    def _close_pipes(self) -> None:
        while self._open:
            os.close(self._open.pop())


def _shared_memory(size: int) -> int:
    """A descriptor of memory of so many bytes, whose size nobody can change."""
    memory = os.memfd_create("wsim-control", os.MFD_ALLOW_SEALING | os.MFD_CLOEXEC)
    os.ftruncate(memory, size)
    # A file that its other user could cut short would crash this process on its next look.
    fcntl.fcntl(memory, _ADD_SEALS, _SEALS)
    return memory
