"""What checks share: a name, findings with their margins, and a guard that turns a crash into a finding."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wsim.judge.verdict import Finding

if TYPE_CHECKING:
    from wsim.judge.evidence.evidence import Evidence


class Check:
    """One question put to the evidence. Subclasses are dataclasses whose fields are their limits."""

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """The answers; empty when the question does not arise in this world."""
        raise NotImplementedError

    @property
    def name(self) -> str:
        """The name that findings carry."""
        return type(self).__name__

    def run(self, evidence: Evidence) -> list[Finding]:
        """The answers, or a failed finding if asking went wrong."""
        try:
            return self.evaluate(evidence)
        except Exception as error:  # noqa: BLE001 - whatever the evidence did to a check, the verdict must say it
            return [self.failed(f"{self.name} could not be evaluated: {type(error).__name__}: {error}")]

    def failed(self, message: str, **details: object) -> Finding:
        """A finding that did not pass."""
        return Finding.model_validate({"check": self.name, "passed": False, "message": message, **details})

    def passed(self, message: str, **details: object) -> Finding:
        """A finding that passed and has no number."""
        return Finding.model_validate({"check": self.name, "passed": True, "message": message, **details})

    def measured(
        self, message: str, value: float, limit: float, unit: str, at_most: bool = True, **details: object
    ) -> Finding:
        """A finding that passes when `value` keeps to `limit`; NaN does not."""
        margin = limit - value if at_most else value - limit
        numbers = {"value": value, "limit": limit, "margin": margin}
        finite = {key: number for key, number in numbers.items() if math.isfinite(number)}
        fields = {"check": self.name, "passed": bool(margin >= 0.0), "message": message, "unit": unit, **finite}
        return Finding.model_validate({**fields, **details})
