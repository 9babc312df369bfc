"""What checks share: a name, and findings with their margins."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, ClassVar

from wsim.judge.evidence.recorded import MissingError
from wsim.judge.verdict import Finding

if TYPE_CHECKING:
    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import RepairTarget

Bounds = tuple[float, float]


class Check:
    """One question put to the evidence. Subclasses are dataclasses whose fields are their limits."""

    of_world: ClassVar[bool] = False  # it asks the world and the plan alone: of several copies of a world once

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """The answers; empty when the question does not arise in this world."""
        raise NotImplementedError

    def repair(self, finding: Finding, evidence: Evidence) -> RepairTarget | None:
        """What to change where a finding failed that does not say so itself; None where no rule is known."""
        return None

    def prepare(self, joined: Evidence, copies: Sequence[Evidence]) -> None:
        """Work out at once what it asks of worlds of one geometry, and keep it with each; nothing if it need not.

        Args:
            joined: Evidence whose motion has an axis of copies (`Evidence.join`).
            copies: Each by itself.
        """

    def prepare_similar(self, copies: Sequence[Evidence]) -> None:
        """Work out at once what it asks of worlds that differ in sizes, places and coefficients, too, or nothing.

        Args:
            copies: Of similar worlds (`wsim.judge.books.copies`), over the same times; their books are worked out.
        """

    @property
    def name(self) -> str:
        """The name that findings carry."""
        return type(self).__name__

    @property
    def asks(self) -> str | None:
        """The plan's objective that findings answer, if any."""
        return None

    def run(self, evidence: Evidence) -> list[Finding]:
        """The answers, each with the line that made its prim unless it says its own.

        What the world or the recording lacks is a failed finding; whatever else is raised is a crash of the check.
        """
        if not self.of_world:
            return self._answers(evidence)
        if type(self) not in evidence.of_world:
            evidence.of_world[type(self)] = self._answers(evidence)
        return [finding.model_copy() for finding in evidence.of_world[type(self)]]

    def _answers(self, evidence: Evidence) -> list[Finding]:
        try:
            found = self.evaluate(evidence)
        except MissingError as error:
            return [self.failed(f"{self.name} could not be evaluated: {error.args[0]}")]
        for finding in found:
            if "line" not in finding.model_fields_set:
                finding.line = evidence.line(finding.prim)
        return found

    def failed(self, message: str, **details: object) -> Finding:
        """A finding that did not pass."""
        return Finding.model_validate({"check": self.name, "passed": False, "message": message, **details})

    def passed(self, message: str, **details: object) -> Finding:
        """A finding that passed and has no number."""
        return Finding.model_validate({"check": self.name, "passed": True, "message": message, **details})

    def measured(
        self,
        message: str,
        value: float,
        limit: float,
        unit: str,
        at_most: bool = True,
        fine: str = "",
        target: RepairTarget | None = None,
        **details: object,
    ) -> Finding:
        """A finding that passes when `value` keeps to `limit`; NaN does not.

        Args:
            message: What it says.
            value: What was found.
            limit: What it may be,
            unit: of both.
            at_most: False where it must not be less.
            fine: What it says instead where it passes.
            target: What to change where it does not pass.
            details: Other fields of the finding.
        """
        margin = limit - value if at_most else value - limit
        passed = bool(margin >= 0.0)
        numbers = {"value": value, "limit": limit, "margin": margin}
        finite = {key: number for key, number in numbers.items() if math.isfinite(number)}
        fields = {"check": self.name, "passed": passed, "message": fine if passed and fine else message, "unit": unit}
        return Finding.model_validate({**fields, **finite, "target": None if passed else target, **details})

    def between(
        self,
        message: str,
        value: float,
        bounds: Bounds,
        unit: str,
        expected: float,
        target: RepairTarget | None = None,
        **details: object,
    ) -> Finding:
        """A finding that passes when `value` is between two limits: it is held against the one on its side.

        Args:
            message: What it says.
            value: What was found.
            bounds: The lower and the upper limit.
            unit: Of all.
            expected: What theory gives, which divides the sides.
            target: What to change where it does not pass; one that says not which way is told to bring it back.
            details: Other fields of the finding.
        """
        above = value > expected
        room = bounds[1] - value if above else value - bounds[0]
        if target is not None and not target.direction and not room >= 0.0:
            target = target.model_copy(update={"direction": "lower" if above else "raise"})
        fields: dict[str, Any] = {"expected": expected, "target": target, **details}
        return self.measured(message, value, bounds[above], unit, at_most=above, **fields)


Checks = tuple[type[Check], ...]


def share_about(expected: float, share: float) -> Bounds:
    """The limits a share below and above what is expected."""
    return expected * (1.0 - share), expected * (1.0 + share)


def worst(found: Sequence[Finding]) -> list[Finding]:
    """All that failed; where none did, the one nearest to its limit."""
    failed = sum(not finding.passed for finding in found)
    return sorted(found, key=lambda finding: finding.margin or 0.0)[: max(1, failed)]


def listed(values: tuple[float, ...]) -> str:
    """Numbers as a person reads them: (0.1, 2, 30)."""
    return "(" + ", ".join(f"{value:.3g}" for value in values) + ")"
