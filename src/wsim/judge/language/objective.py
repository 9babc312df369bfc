"""A formula as an objective of a plan: one finding for each of its conjuncts, with what decided it and when."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from wsim.judge.checks.check import Check
from wsim.judge.language.evaluate import Outcome, evaluate
from wsim.judge.language.sentence import sentence
from wsim.judge.language.signals import Signals
from wsim.judge.objectives.objective import ObjectiveCheck
from wsim.plan.schema.formula import And, Formula

if TYPE_CHECKING:
    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding


@dataclass
class ObjectiveFormula(ObjectiveCheck):
    """What the plan says in the language of objectives."""

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each conjunct: the measure that decides it, in its own unit."""
        formula = self.objective.formula
        if formula is None:
            raise ValueError(f"the objective of {self.objective.object} has no formula")
        return findings(self, formula, evidence)

    @property
    def sentence(self) -> str:
        """The plan's sentence, or the formula's own."""
        formula = self.objective.formula
        return self.objective.sentence or (sentence(formula) if formula is not None else super().sentence)


def findings(check: Check, formula: Formula, evidence: Evidence) -> list[Finding]:
    """One finding for each conjunct of a formula on one recording; raises as `evaluate` does."""
    signals = Signals.of(evidence)
    parts = formula.of if isinstance(formula, And) else (formula,)
    return [_finding(check, part, signals, evidence) for part in parts]


def _finding(check: Check, part: Formula, signals: Signals, evidence: Evidence) -> Finding:
    outcome = evaluate(part, signals)
    measure = outcome.measures[int(outcome.measure[0])]
    frame = int(np.argmin(np.abs(signals.time - outcome.moment[0])))
    moment, said = float(outcome.moment[0]), sentence(part)
    details: dict[str, Any] = {"prim": measure.prim, "line": evidence.line(measure.prim), "time": moment}
    if not np.isfinite(outcome.robustness[0]):
        return check.failed(
            f"{said} cannot hold: the {measure.what} of {measure.prim} is not known at {moment:.3f} s",
            unit=measure.unit, limit_from=measure.limit_from, **details,
        )  # fmt: skip
    shape = (1, len(signals.time))
    value, limit = (float(np.broadcast_to(of, shape)[0, frame]) for of in (measure.value, measure.limit))
    at_most = bool(np.broadcast_to(measure.at_most, shape)[0, frame])
    if measure.expected is not None:
        details["expected"] = float(np.broadcast_to(measure.expected, shape)[0, frame])
    # Under a `not` the limit is kept from the other side.
    own = limit - value if at_most else value - limit
    at_most ^= bool(own * outcome.margin[0] < 0.0)
    word = "holds" if outcome.satisfied[0] else "does not hold"
    return check.measured(
        f"{said} {word}: the {measure.what} of {measure.prim} is {value:.4g} {measure.unit} at {moment:.3f} s, where "
        f"{limit:.4g} {measure.unit} is the {'most' if at_most else 'least'}",
        value, limit, measure.unit, at_most=at_most, span=_span(signals, outcome, frame),
        limit_from=measure.limit_from, **details,
    )  # fmt: skip


def _span(signals: Signals, outcome: Outcome, frame: int) -> tuple[float, float]:
    """From when to when the measure that decides is on the side of its limit where it is at that moment [s]."""
    margin = np.broadcast_to(outcome.measures[int(outcome.measure[0])].margin, (1, len(signals.time)))[0]
    same = (margin >= 0.0) == (margin[frame] >= 0.0)
    other = np.flatnonzero(~same)
    first = other[other < frame].max(initial=-1) + 1
    last = other[other > frame].min(initial=len(same)) - 1
    return float(signals.time[first]), float(signals.time[last])
