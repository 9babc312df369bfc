"""What to change where a formula fails: by the predicate that decides it, and by when it comes true."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.language.measure import MENDERS, Measure
from wsim.judge.repair.drive import to_point
from wsim.judge.repair.rule import longer_run
from wsim.judge.repair.walking import by_policy
from wsim.judge.verdict import Finding, RepairTarget
from wsim.plan.schema.formula import Eventually, Formula, Ordered, Predicate
from wsim.plan.schema.formula_place import Reaches

if TYPE_CHECKING:
    from wsim.judge.evidence.evidence import Evidence


def target_of(
    part: Formula, predicate: Predicate, measure: Measure, finding: Finding, evidence: Evidence
) -> RepairTarget | None:
    """The target of a finding about part of a formula that one measure decides; None if none is known."""
    if isinstance(predicate, Ordered):
        why = "an event is missing, or comes in another order: compare the times in the message"
        return RepairTarget(kind="program", prim=finding.prim, parameter="order", direction="change", why=why)
    if finding.value is None and finding.expected is None:
        return None
    walked = by_policy(evidence, finding.prim or "")
    if walked is not None:
        return walked
    driven = _driven_there(part, predicate, finding, evidence)
    late = _late(predicate, measure, finding, evidence)
    if late is not None:
        return driven or late
    target = MENDERS[type(predicate)](predicate, finding.model_copy(update={"span": None}), evidence)
    return driven if driven is not None and target.kind == "drive" and target.suggested is None else target


def uncovered(formula: Formula, evidence: Evidence) -> RepairTarget | None:
    """The target where a window of a formula ends after the recording; None where none does."""
    needed = _looks_ahead(formula)
    if needed <= evidence.world.duration:
        return None
    return longer_run(evidence, needed, "a window of the objective ends later than the run")


def _looks_ahead(formula: Formula) -> float:
    """How far into a recording a formula looks [s]."""
    windows = getattr(formula, "windows", None) or (getattr(formula, "window", None),)
    own = sum(window[1] or window[0] for window in windows if window is not None)
    own = max(own, getattr(formula, "seconds", None) or 0.0)
    return own + max((_looks_ahead(part) for part in formula.parts()), default=0.0)


def _late(predicate: Predicate, measure: Measure, finding: Finding, evidence: Evidence) -> RepairTarget | None:
    """The target of an event that happens, but after the moment that decides."""
    margin = np.broadcast_to((measure.single or measure).margin, (1, len(evidence.time)))[0]
    after = evidence.time[(margin >= 0.0) & (evidence.time > (finding.time or 0.0))]
    if predicate.alone != "eventually" or not len(after):
        return None
    late = float(after[0]) - (finding.time or 0.0)
    why = f"it comes about at {after[0]:.3g} s, {late:.3g} s after the moment that decides: a nearer or a faster start"
    return RepairTarget(
        kind="settlement", prim=finding.prim, parameter="position", direction="change", unit="m", why=why
    )


def _driven_there(part: Formula, predicate: Predicate, finding: Finding, evidence: Evidence) -> RepairTarget | None:
    """What a drive is to be set to, so that its body comes to the point in the middle of the time for it."""
    if not isinstance(predicate, Reaches) or isinstance(predicate.target, str):
        return None
    windows = [node.window for node in part.walk() if isinstance(node, Eventually)]
    closed = [(window[0], window[1]) for window in windows if window is not None and window[1] is not None]
    return to_point(evidence, finding.prim or "", np.array(predicate.target), closed[0] if closed else None)
