"""What to change so that a failed finding passes.

A check that knows says so itself, with `target=` in its finding, as an objective does by the predicate that decides it
(`wsim.judge.language.mending`); of others it is asked for its rule, `Check.repair`. What no rule covers gets a target
that says so.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from wsim.judge.checks.registry import physics_checks, run_checks
from wsim.judge.repair.place import overlapping_start
from wsim.judge.repair.rule import time_step, tried
from wsim.judge.verdict import Finding, RepairTarget

if TYPE_CHECKING:
    from wsim.judge.evidence.evidence import Evidence

# What fails before there is a recording: the program's own text is to be mended.
STAGES = {
    "build": "the program stopped before its world was made: its message says where",
    "stage": "the stage that the program made is not one that can be simulated: its message says what is wrong",
}


# Of what starts inside something else the solver makes a push that no law explains.
PUSHED_APART = (
    "CheckRestitution", "CheckBlowFriction", "CheckEnergy", "CheckForces", "CheckRecordedForces", "CheckRecordedTies",
    "CheckContinuity",
    "CheckSupport", "CheckJitter", "CheckFreeFlight", "CheckFreeTurning",
)  # fmt: skip
DEEP = 0.02  # of the smallest extent: what starts no deeper is hardly pushed


def aim(findings: Sequence[Finding], evidence: Evidence | None = None) -> None:
    """Give every failed finding its repair target, in place.

    Args:
        findings: Of one verdict; those that passed are left without a target.
        evidence: What they were made from; without it only the program's own failures have a rule.
    """
    for finding in findings:
        finding.target = None if finding.passed else tried(_told(finding, evidence))
    broken = next((finding for finding in findings if finding.check == "CheckFinite" and not finding.passed), None)
    if broken is not None:
        for finding in findings:
            if finding.objective is not None and not finding.passed:
                finding.target = broken.target  # nothing can be told of it before its numbers are finite


def _told(finding: Finding, evidence: Evidence | None) -> RepairTarget:
    """What a check says itself, unless how its body starts explains what it found; else what its rule says."""
    start = None
    if evidence is not None and finding.check in PUSHED_APART:
        start = overlapping_start(evidence, finding.prim, DEEP) if finding.prim is not None else None
    target = start or finding.target or _target(finding, evidence)
    if evidence is not None and target.parameter == "time_step" and target.current is None:
        return target.model_copy(update={"current": time_step(evidence)})
    return target


def _target(finding: Finding, evidence: Evidence | None) -> RepairTarget:
    if finding.check == "control":
        return RepairTarget(
            kind="controller", parameter="control", direction="change", why="the program's control failed"
        )
    if finding.check in STAGES:
        return RepairTarget(kind="program", direction="change", why=STAGES[finding.check])
    if evidence is None:
        return unknown(finding)
    check = next((check for check in [*run_checks(), *physics_checks()] if check.name == finding.check), None)
    if check is None:
        return unknown(finding)
    try:
        return check.repair(finding, evidence) or unknown(finding)
    except Exception:  # noqa: BLE001 - evidence too broken for the check may be so for the rule: nothing is known then
        return unknown(finding)


def unknown(finding: Finding) -> RepairTarget:
    """The target where nothing says which number to change."""
    where = "the line that made it" if finding.line else "the program"
    why = f"no formula says which number to change: compare {where} with the finding's message"
    return RepairTarget(kind="program", prim=finding.prim, direction="change", why=why)
