"""A candidate, and what came of it."""

from __future__ import annotations

import math
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from wsim.judge.verdict import Crash, Finding, Verdict

Status = Literal["accepted", "rejected", "blocked", "failed"]
ORDER: tuple[Status, ...] = ("accepted", "rejected", "blocked", "failed")  # the best first


class Candidate(BaseModel):
    """One world of a sweep.

    Attributes:
        number: Its own, from 0: the program as it stands.
        params: Values of `scene.param`; the others keep their defaults.
        draws: Numbers that are set on the stage (`wsim.runs.draws`).
        seed: Of `wsim.sim.perturb`; 0 starts as the stage states.
        program: The file in the sweep's folder.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    number: int
    params: dict[str, float] = Field(default_factory=dict)
    draws: dict[str, float] = Field(default_factory=dict)
    seed: int = 0
    program: str = "program.py"

    @property
    def values(self) -> dict[str, float]:
        """All in which it differs from the program as it stands: parameters, then what was drawn."""
        return self.params | self.draws


class Outcome(BaseModel):
    """What came of a candidate.

    Attributes:
        candidate: It.
        status: The verdict's; "failed" where there is none, for a reason that is not the world's.
        reason: The verdict's summary and what the program raised, or why there is no verdict.
        slack: The least distance of an objective to its limit as a share of both, in (-1, 1); negative: it, or another
            finding, fails. None where nothing was asked and nothing failed.
        decided_by: The finding of that slack: its objective's sentence, or its check's name.
        margins: By objective, the distance to its limit in its unit; positive: satisfied.
        values: By objective, what was measured.
        failures: What did not pass.
        crashes: What could not be evaluated.
        seconds: What it took [s].
        together: Worlds that were simulated at once: of more than one neither contacts nor what ties gave are recorded,
            so that less is asked of it than of a run of its own.
        note: Why it was not simulated with others, why those were set up one by one, or what was said of it before it
            was run by itself.
    """

    model_config = ConfigDict(extra="forbid", ser_json_inf_nan="strings")  # JSON has no other word for them

    candidate: Candidate
    status: Status
    reason: str = ""
    slack: float | None = None
    decided_by: str = ""
    margins: dict[str, float] = Field(default_factory=dict)
    values: dict[str, float] = Field(default_factory=dict)
    failures: list[str] = Field(default_factory=list)
    crashes: list[Crash] = Field(default_factory=list, exclude_if=lambda crashes: not crashes)
    seconds: float = 0.0
    together: int = 1
    note: str = Field(default="", exclude_if=lambda note: not note)

    @property
    def rank(self) -> tuple[int, float, int]:
        """Smaller is better: by status, then the most room, then the first drawn."""
        return (ORDER.index(self.status), -(0.0 if self.slack is None else self.slack), self.candidate.number)

    @classmethod
    def of(cls, candidate: Candidate, verdict: Verdict, seconds: float = 0.0) -> Outcome:
        """What a verdict says of a candidate.

        What was asked decides how near it came; where something else failed, that does too. The room that other
        checks had left says how a world was computed, not how well it does.
        """
        asked = [finding for finding in verdict.findings if finding.objective]
        decisive = [*asked, *(finding for finding in verdict.failures if not finding.objective)]
        tightest = min(decisive, key=slack, default=None)
        nearest = {name(finding): finding for finding in sorted(asked, key=slack, reverse=True)}  # the tightest of each
        return cls(
            candidate=candidate,
            status=verdict.status,
            reason=reason(verdict),
            slack=None if tightest is None else slack(tightest),
            decided_by="" if tightest is None else name(tightest),
            margins={key: finding.margin for key, finding in nearest.items() if finding.margin is not None},
            values={key: finding.value for key, finding in nearest.items() if finding.value is not None},
            failures=list(dict.fromkeys(map(name, verdict.failures))),
            crashes=verdict.crashes,
            seconds=round(seconds, 3),
        )


def reason(verdict: Verdict) -> str:
    """The summary; where there was no world to judge, also what the program said, which no other file keeps."""
    first = next(iter(verdict.failures), None)
    if first is None or not first.message or first.message.rstrip(".") in verdict.summary:
        return verdict.summary
    return f"{verdict.summary.rstrip('.')}: {first.message}"


def name(finding: Finding) -> str:
    """What a finding is called in a table."""
    return finding.objective or finding.check


def slack(finding: Finding) -> float:
    """How far a finding is from its limit, m, as a share m / (|m| + s) with s the greater of limit and expected value.

    Margins have units and cannot be compared; this one is without, grows with each of them, and changes sign with them.
    1 and -1 where there are no numbers, or none that is finite.
    """
    sign = 1.0 if finding.passed else -1.0
    scale = max(abs(finding.limit or 0.0), abs(finding.expected or 0.0))
    if finding.margin is None or not math.isfinite(finding.margin) or not math.isfinite(scale):
        return sign
    size = abs(finding.margin)
    return sign * size / (size + scale) if size + scale > 0.0 else 0.0
