"""The verdict: what the judge found, as data."""

from __future__ import annotations

import traceback
from collections.abc import Sequence
from typing import Literal, Self

from pydantic import BaseModel, ConfigDict, Field

Status = Literal["accepted", "rejected", "blocked"]


RepairKind = Literal[
    "physical parameter", "settlement", "camera", "geometry", "joint", "drive", "controller", "resolution", "time step",
    "fluid", "missing object", "extra object", "visual mismatch", "program",
]  # fmt: skip


class RepairTarget(BaseModel):
    """What to change so that a finding passes: one of a closed list, with parameter and direction where physics says.

    `suggested` is the value that the physics or the plan gives, where one does, and `current` what it is now; of what
    has several numbers (a place, a velocity, edges, limits) that is `vector`, and of what has a name `text`. Each is as
    the program writes it, so that a suggestion can be applied as it stands.
    """

    model_config = ConfigDict(extra="forbid")

    kind: RepairKind
    prim: str | None = None
    parameter: str = ""  # as the program calls it: "density", "friction", "position.z", "time_step"
    direction: Literal["raise", "lower", "change", "add", "remove", ""] = ""
    current: float | None = None
    suggested: float | None = None
    vector: tuple[float, ...] | None = None
    text: str = ""
    unit: str = ""
    why: str = ""

    @property
    def sentence(self) -> str:
        """What to do, in words: "lower density of /World/block from 2500 to 600 kg/m^3"."""
        of = f"{self.parameter} of {self.prim}" if self.parameter and self.prim else self.parameter or self.prim
        words = f"{self.direction or 'look at'} {of or f'the {self.kind}'}"
        now = "" if self.current is None else f"{self.current:.4g}"
        numbers = " ".join(f"{word} {x}" for word, x in (("from", now), ("to", self.value)) if x)
        return " ".join(part for part in (words, numbers, self.unit if numbers else "") if part)

    @property
    def value(self) -> str:
        """What is suggested, in words: a number, (x, y, z), or a name; nothing where no value is."""
        if self.vector is not None:
            return "(" + ", ".join(f"{x:.4g}" for x in self.vector) + ")"
        return self.text if self.suggested is None else f"{self.suggested:.4g}"


class Finding(BaseModel):
    """One check's outcome: the measured value beside its limit, where, when and by which line of the program."""

    model_config = ConfigDict(extra="forbid")

    check: str  # class name of the check or objective, or the stage that failed: "build", "stage", "simulation"
    passed: bool
    message: str  # one sentence a person reads
    objective: str | None = None  # the plan's objective that this finding answers
    prim: str | None = None
    time: float | None = None  # [s] of simulated time: the moment to look at
    span: tuple[float, float] | None = None  # [s]: from when to when it was so
    value: float | None = None
    limit: float | None = None
    expected: float | None = None  # what theory gives, where there is one
    unit: str = ""
    margin: float | None = None  # distance to the limit, positive = satisfied, in `unit`
    limit_from: str = ""  # how the limit was got
    line: str | None = None  # "program.py:12"
    target: RepairTarget | None = None  # what to change, where the finding failed
    weight: float = Field(1.0, gt=0.0, le=1.0, exclude_if=lambda weight: weight == 1.0)  # of one without numbers


class Crash(BaseModel):
    """A check that could not be evaluated. It says nothing of the world: it is a fault of the judge, to be reported."""

    model_config = ConfigDict(extra="forbid")

    check: str  # as in a finding
    objective: str | None = None
    error: str  # "ZeroDivisionError: division by zero"
    traceback: str
    rerun: str = ""  # the one it was asked of, where it was not the run itself: "half the time step"

    @classmethod
    def of(cls, error: Exception, check: str, objective: str | None = None) -> Self:
        """What a check raised."""
        what = " ".join(f"{type(error).__name__}: {error}".rstrip(": ").split())
        return cls(check=check, objective=objective, error=what, traceback="".join(traceback.format_exception(error)))

    @property
    def message(self) -> str:
        """One sentence a person reads."""
        of = f" of the run with {self.rerun}" if self.rerun else ""
        return f"{self.check} could not be evaluated{of}: {self.error}"


class Verdict(BaseModel):
    """Accepted: every finding passed. Rejected: one did not. Blocked: the world could not be judged, or not in full.

    `not_checked` is what of the prompt nothing showed, a line each; `stands_in_for` what was asked for in place of this
    world, and cannot be simulated.
    """

    model_config = ConfigDict(extra="forbid")

    status: Status
    summary: str
    findings: list[Finding] = Field(default_factory=list)
    crashes: list[Crash] = Field(default_factory=list, exclude_if=lambda crashes: not crashes)
    not_checked: list[str] = Field(default_factory=list, exclude_if=lambda lines: not lines)
    stands_in_for: str = Field("", exclude_if=lambda text: not text)

    @property
    def failures(self) -> list[Finding]:
        """The findings that did not pass."""
        return [finding for finding in self.findings if not finding.passed]


def status_of(findings: Sequence[Finding], crashes: Sequence[Crash]) -> Status:
    """What failed rejects, whatever else crashed; of a world whose findings pass a crash leaves it open."""
    if not all(finding.passed for finding in findings):
        return "rejected"
    return "blocked" if crashes else "accepted"


def unjudged(crashes: Sequence[Crash]) -> str:
    """What could not be evaluated, in words: "CheckEnergy could not be evaluated: KeyError: 3, nor 2 more"."""
    more = f", nor {len(crashes) - 1} more" if len(crashes) > 1 else ""
    return f"{crashes[0].message.rstrip('.')}{more}" if crashes else ""
