"""What a finding was asked for: the plan's objective, the predicate that decides it, and the other object."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.evidence.recorded import MissingError
from wsim.judge.language import Signals, evaluate
from wsim.judge.language.kinds import formula_of
from wsim.judge.language.objective import ObjectiveCheck, conjuncts

if TYPE_CHECKING:
    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.language.measure import Measure
    from wsim.judge.verdict import Finding
    from wsim.plan.schema import Objective
    from wsim.plan.schema.formula import Predicate

SAME = 1e-6  # share by which a finding's value may differ from its measure's


def objective_of(finding: Finding, evidence: Evidence) -> Objective | None:
    """The plan's objective that a finding answers."""
    items = evidence.plan.objectives if evidence.plan is not None else []
    return next((item for item in items if sentence_of(item) == finding.objective), None)


def sentence_of(item: Objective) -> str:
    """An objective in words, as its findings carry it."""
    return ObjectiveCheck(item).asks


def decider(finding: Finding, evidence: Evidence) -> tuple[Predicate, Measure] | None:
    """The predicate, and its measure, that a finding's number comes from; None where the finding has none."""
    item = objective_of(finding, evidence)
    if item is None or finding.value is None:
        return None
    try:
        signals, formula = Signals.of(evidence), formula_of(item, evidence)
        for part in conjuncts(formula):
            outcome = evaluate(part, signals)
            k = int(outcome.measure[0])
            predicate, measure = outcome.predicates[k], outcome.measures[k]
            values = np.broadcast_to(measure.value, (1, len(signals.time)))[0]
            same = np.isclose(values, finding.value, rtol=SAME, atol=1e-12).any()
            if same and (measure.prim, measure.unit) == (finding.prim, finding.unit):
                return predicate, measure
    except MissingError:  # the recording lacks what the objective needs: its finding has no number then
        return None
    return None


def ref_of(finding: Finding, evidence: Evidence) -> str:
    """The prim of the other object of a finding's objective, or nothing."""
    item = objective_of(finding, evidence)
    if item is None:
        return ""
    found = decider(finding, evidence)
    others = [getattr(found[0], field, None) for field in ("ref", "fluid", "target", "center", "on")] if found else []
    name = next((other for other in others if isinstance(other, str)), item.ref)
    return evidence.prim(name) if name is not None else ""
