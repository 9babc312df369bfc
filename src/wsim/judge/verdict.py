"""The verdict: what the judge found, as data."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

Status = Literal["accepted", "rejected", "blocked"]


class Finding(BaseModel):
    """One check's outcome: the measured value beside its limit, where, when and by which line of the program."""

    model_config = ConfigDict(extra="forbid")

    check: str  # class name of the check or objective, or the stage that failed: "build", "stage", "simulation"
    passed: bool
    message: str  # one sentence a person reads
    objective: str | None = None  # the plan's objective that this finding answers
    prim: str | None = None
    time: float | None = None  # [s] of simulated time
    value: float | None = None
    limit: float | None = None
    expected: float | None = None  # what theory gives, where there is one
    unit: str = ""
    margin: float | None = None  # distance to the limit, positive = satisfied, in `unit`
    limit_from: str = ""  # how the limit was got
    line: str | None = None  # "program.py:12"


class Verdict(BaseModel):
    """Accepted: every finding passed. Rejected: one did not. Blocked: the world could not be judged."""

    model_config = ConfigDict(extra="forbid")

    status: Status
    summary: str
    findings: list[Finding] = Field(default_factory=list)

    @property
    def failures(self) -> list[Finding]:
        """The findings that did not pass."""
        return [finding for finding in self.findings if not finding.passed]
