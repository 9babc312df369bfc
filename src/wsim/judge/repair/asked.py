"""What a failed finding was asked for: the plan's objective, the predicate that decides, and the other object."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.language.measure import MEASURERS
from wsim.judge.language.objective import ObjectiveCheck
from wsim.judge.language.signals import Signals
from wsim.plan.schema.formula import Ordered, Predicate

if TYPE_CHECKING:
    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.language.measure import Measure
    from wsim.judge.verdict import Finding
    from wsim.plan.schema import Objective

SAME = 1e-6  # share by which a finding's value may differ from its measure's


def objective_of(finding: Finding, evidence: Evidence) -> Objective | None:
    """The plan's objective that a finding answers."""
    items = evidence.plan.objectives if evidence.plan is not None else []
    return next((item for item in items if sentence_of(item) == finding.objective), None)


def sentence_of(item: Objective) -> str:
    """An objective in words, as its findings carry it."""
    return ObjectiveCheck(item).sentence


def decider(finding: Finding, evidence: Evidence) -> tuple[Predicate, Measure] | None:
    """The predicate, and its measure, that a finding's number comes from; None where the finding has none."""
    item = objective_of(finding, evidence)
    if item is None or item.formula is None or finding.value is None:
        return None
    signals = Signals.of(evidence)
    for node in item.formula.walk():
        if isinstance(node, Predicate) and not isinstance(node, Ordered):
            for measure in MEASURERS[type(node)](node, signals):
                if (measure.prim, measure.unit) == (finding.prim, finding.unit):
                    values = np.broadcast_to(measure.value, (1, len(signals.time)))[0]
                    if np.isclose(values, finding.value, rtol=SAME, atol=1e-12).any():
                        return node, measure
    return None


def ref_of(finding: Finding, evidence: Evidence) -> str:
    """The prim of the other object of a finding's objective, or nothing."""
    item = objective_of(finding, evidence)
    if item is None:
        return ""
    name = item.ref
    if item.formula is not None:
        found = decider(finding, evidence)
        others = (
            (getattr(found[0], field, None) for field in ("ref", "fluid", "target", "center", "on")) if found else ()
        )
        name = next((other for other in others if isinstance(other, str)), None)
    return evidence.prim(name) if name is not None else ""
