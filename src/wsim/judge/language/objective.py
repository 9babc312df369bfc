"""An objective of a plan put to the evidence: one finding for each conjunct of its formula, with what decided it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from wsim.judge.checks.check import Check
from wsim.judge.evidence.alike import same_geometry
from wsim.judge.evidence.recorded import MissingError
from wsim.judge.language.evaluate import Outcome, evaluate
from wsim.judge.language.kinds import formula_of
from wsim.judge.language.mending import target_of, uncovered
from wsim.judge.language.sentence import sentence
from wsim.judge.language.signals import Signals
from wsim.plan.schema.formula import And, Finally, Formula, Mean, Predicate

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.language.measure import Measure
    from wsim.judge.verdict import Finding, RepairTarget
    from wsim.plan.schema import Objective


@dataclass
class ObjectiveCheck(Check):
    """One objective of the plan. A prim that is not there is a failed finding, not an error."""

    objective: Objective

    @property
    def name(self) -> str:
        """The name that findings carry: that of its kind, as in ObjectiveRestsOn."""
        return name_of(self.objective.kind)

    @property
    def asks(self) -> str:
        """The objective in words: the plan's, or the formula's own."""
        given = self.objective
        if given.formula is not None:
            return given.sentence or sentence(given.formula)
        return given.sentence or " ".join(word for word in (given.object, given.kind, given.ref) if word)

    def run(self, evidence: Evidence) -> list[Finding]:
        """The findings, each with the objective's sentence and its object's prim and line."""
        key = self._key[1]
        if key not in evidence.answers:
            evidence.answers[key] = self._answers(evidence)
        return evidence.answers[key]

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each conjunct: the measure that decides it, in its own unit."""
        asked = evidence.kept.get(self._key)
        if isinstance(asked, Asked):
            return asked.findings(self, evidence)
        return findings(self, formula_of(self.objective, evidence), evidence)

    def prepare(self, joined: Evidence, copies: Sequence[Evidence]) -> None:
        """What it comes to in all copies at once, where one formula says it of all; MissingError."""
        if not all(same_geometry(copies[0].world, evidence.world) for evidence in copies):
            return
        formulas = [formula_of(self.objective, evidence) for evidence in copies]
        if any(formula != formulas[0] for formula in formulas):
            return
        if Signals not in joined.kept:
            joined.kept[Signals] = Signals.of_copies(joined, [evidence.world for evidence in copies])
        signals = cast("Signals", joined.kept[Signals])
        outcomes = _outcomes(formulas[0], signals)
        for n, evidence in enumerate(copies):
            evidence.kept[self._key] = Asked(signals, outcomes, n)

    @cached_property
    def _key(self) -> tuple[type, str]:
        return ObjectiveCheck, self.objective.model_dump_json()

    def _answers(self, evidence: Evidence) -> list[Finding]:
        prim = evidence.prim(self.objective.object)
        try:
            found = self.evaluate(evidence)
        except MissingError as error:
            said = self.objective.formula
            longer = uncovered(said, evidence) if said is not None else None
            found = [self.failed(f"{prim}: {error.args[0]}", target=longer)]
        asks = self.asks
        for finding in found:
            finding.objective = asks
            finding.prim = finding.prim or prim
            finding.line = finding.line or evidence.line(finding.prim)
        return found


def name_of(kind: str) -> str:
    """The name that a kind's findings carry."""
    return "Objective" + "".join(word.capitalize() for word in kind.split("_"))


@dataclass(frozen=True)
class Asked:
    """What the conjuncts of a formula come to in a world of some."""

    signals: Signals
    outcomes: list[tuple[Formula, str, Outcome]]  # each with its sentence
    world: int = 0

    def findings(self, check: Check, evidence: Evidence) -> list[Finding]:
        """One for each, with what to change where it fails."""
        found = [self._finding(check, *each, evidence) for each in self.outcomes]
        for finding, (part, *_) in zip(found, self.outcomes, strict=True):
            if not finding.passed:
                finding.target = _target(part, finding, evidence)
        return found

    def _finding(self, check: Check, part: Formula, said: str, outcome: Outcome, evidence: Evidence) -> Finding:
        signals, n = self.signals, self.world
        measure = outcome.measures[int(outcome.measure[n])]
        frame = int(np.argmin(np.abs(signals.time - outcome.moment[n])))
        moment = float(outcome.moment[n])
        details: dict[str, Any] = {"prim": measure.prim, "line": evidence.line(measure.prim), "time": moment}
        if measure.expected is not None:
            expected = float(self._here(measure.expected)[frame])
            details["expected"] = expected if np.isfinite(expected) else None
        if not np.isfinite(outcome.robustness[n]):
            return check.failed(
                f"{said} cannot hold: the {measure.what} of {measure.prim} is not known at {moment:.3f} s",
                unit=measure.unit, limit_from=measure.limit_from, **details,
            )  # fmt: skip
        value, limit = (float(self._here(of)[frame]) for of in (measure.value, measure.limit))
        at_most = bool(self._here(measure.at_most)[frame])
        # Under a `not` the limit is kept from the other side.
        own = limit - value if at_most else value - limit
        at_most ^= bool(own * outcome.margin[n] < 0.0)
        satisfied, span = bool(outcome.satisfied[n]), self._span(measure, frame)
        when = f"at {moment:.3f} s"
        if measure.single is not None:
            last = measure.last % len(signals.time)
            when = f"from {moment:.3f} s " + (
                "on" if last == len(signals.time) - 1 else f"to {signals.time[last]:.3f} s"
            )
        if not satisfied and _at_the_end(part):
            details["time"] = span[0]  # what fails at the end is to be looked at where it came to be so
            when += f", and so since {span[0]:.3f} s"
        unit = "" if measure.unit == "1" else f" {measure.unit}"
        message = (
            f"{said} {'holds' if satisfied else 'does not hold'}: the {measure.what} of {measure.prim} is "
            f"{value:.4g}{unit} {when}, where {limit:.4g}{unit} is the {'most' if at_most else 'least'}"
        )
        return check.measured(
            message if satisfied or not measure.note else f"{message}; {measure.note}", value, limit, measure.unit,
            at_most=at_most, span=span, limit_from=measure.limit_from, **details,
        )  # fmt: skip

    def _here(self, of: Any) -> NDArray[Any]:
        """Of this world, (T,)."""
        every, frames = np.asarray(of), len(self.signals.time)
        own = every if every.ndim < 2 else every[self.world if len(every) > 1 else 0]
        return own if own.shape == (frames,) else np.full(frames, own)

    def _span(self, measure: Measure, frame: int) -> tuple[float, float]:
        """From when to when the measure that decides is on the side of its limit where it is at that moment [s].

        Of a mean it is the last stretch of what it is of, from where that came to the mean's side; or all of the mean's
        time, where that ends on the other.
        """
        time, margin = self.signals.time, self._here(measure.margin)
        side = margin[frame] >= 0.0
        if measure.single is not None:
            margin = self._here(measure.single.margin)[: measure.last + 1 or None]
            if (margin[-1] >= 0.0) != side:
                return float(time[frame]), float(time[measure.last])
            frame = len(margin) - 1
        other = np.flatnonzero((margin >= 0.0) != side)
        first = other[other < frame].max(initial=-1) + 1
        last = other[other > frame].min(initial=len(margin)) - 1
        return float(time[first]), float(time[last])


def findings(check: Check, formula: Formula, evidence: Evidence) -> list[Finding]:
    """One finding for each conjunct of a formula on one recording; raises as `evaluate` does."""
    signals = Signals.of(evidence)
    return Asked(signals, _outcomes(formula, signals)).findings(check, evidence)


def _outcomes(formula: Formula, signals: Signals) -> list[tuple[Formula, str, Outcome]]:
    return [(part, sentence(part), evaluate(part, signals)) for part in conjuncts(formula)]


def _target(part: Formula, finding: Finding, evidence: Evidence) -> RepairTarget | None:
    """What to change for a part that fails in one world."""
    try:
        outcome = evaluate(part, Signals.of(evidence))
        decides = int(outcome.measure[0])
        return target_of(part, outcome.predicates[decides], outcome.measures[decides], finding, evidence)
    except Exception:  # noqa: BLE001 - evidence too broken for the objective may be so for its rule: nothing is known
        return None


def conjuncts(formula: Formula) -> tuple[Formula, ...]:
    """The parts of a formula that have a finding each."""
    return formula.of if isinstance(formula, And) else (formula,)


def _at_the_end(part: Formula) -> bool:
    """Whether a formula is about the end of the recording."""
    if isinstance(part, Mean):
        return part.window is None
    return isinstance(part, Finally) or (isinstance(part, Predicate) and part.alone.startswith("finally"))
