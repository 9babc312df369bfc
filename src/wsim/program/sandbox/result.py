"""What came of running a program's `build`."""

from __future__ import annotations

import signal
from dataclasses import dataclass
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

Kind = Literal["ok", "exception", "timeout", "memory", "crash", "output", "stage"]
REPORT_BYTES = 1 << 18


@dataclass(frozen=True)
class BuildResult:
    """One run of `build`: a stage, or why there is none.

    Attributes:
        ok: The stage is there and passed its check.
        kind: "ok"; "exception": the program raised, or has no `build`; "timeout": time ran out; "memory": memory ran
            out; "crash": the process died; "output": it wrote or printed more than it may, or no stage;
            "stage": the stage failed its check.
        message: One or a few lines for a person.
        line: Where in the program, as "program.py:12", where it is known.
        log: What the program printed, cut at the limit.
        seconds: Wall time of it all [s].
        isolation: "bubblewrap", "landlock" or "none".
        problems: Of the stage, one a line.
        told: What its check read of the stage, as JSON of a `wsim.scene.reading.Reading`; empty where nobody asked.
    """

    ok: bool
    kind: Kind
    message: str
    line: str | None
    log: str
    seconds: float
    isolation: str
    problems: tuple[str, ...] = ()
    told: bytes = b""

    def facts(self) -> dict[str, Any]:
        """All but what is told of the stage, as plain data."""
        return {name: value for name, value in vars(self).items() if name != "told"}

    def finding(self) -> dict[str, Any]:
        """The fields of a `wsim.judge.verdict.Finding`, as plain data."""
        return {
            "check": "stage" if self.kind == "stage" else "build",
            "passed": self.ok,
            "message": self.message,
            "line": self.line,
        }


class Report(BaseModel):
    """What the sandboxed process says of itself. The program may have written it: data, not truth."""

    model_config = ConfigDict(extra="forbid", strict=True)

    outcome: Literal["ok", "exception"]
    type: str = Field("", max_length=4000)
    message: str = Field("", max_length=4000)
    line: int | None = Field(None, ge=1, le=10_000_000)
    errno: int | None = None
    no_memory: bool = False
    problems: list[str] = Field(default_factory=list, max_length=50)
    sound: list[int] = Field(default_factory=list, max_length=1000)


def read_report(data: bytes) -> Report | None:
    """A report, or None if there is none that can be read."""
    if not data or len(data) > REPORT_BYTES:
        return None
    try:
        return Report.model_validate_json(data)
    except ValidationError:
        return None


def printable(text: str) -> str:
    """Text of the program's making without control characters: it goes to terminals and logs."""
    return "".join(c if c in "\n\t" or c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in text)


def ending(code: int) -> str:
    """How a process ended, from its exit status; bubblewrap reports a signal as 128 + its number."""
    number = -code if code < 0 else code - 128
    try:
        return f"was killed by {signal.Signals(number).name}"
    except ValueError:
        return f"exited with status {code}"
