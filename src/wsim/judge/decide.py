"""All checks and objectives, and the verdict that follows from their findings."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsim.judge.checks.camera import CheckInFrame, CheckSeen
from wsim.judge.checks.contact import CheckFriction, CheckSupport, CheckTunnelling
from wsim.judge.checks.energy import CheckEnergy
from wsim.judge.checks.fluid import CheckFluidMass, CheckHydrostatic, CheckPlanFluid
from wsim.judge.checks.joint import CheckDrives, CheckJointLimits, CheckJoints
from wsim.judge.checks.mass import CheckMass
from wsim.judge.checks.motion import CheckContinuity, CheckFreeFlight, CheckFreeTurning, CheckGravity
from wsim.judge.checks.physics import (
    CheckDensity,
    CheckExplosion,
    CheckFluidContained,
    CheckPenetration,
    CheckWaterLevel,
)
from wsim.judge.checks.plan import CheckPlanJoints, CheckPlanLooks, CheckPlanPlaces, CheckPlanSizes
from wsim.judge.checks.rest import CheckCreep, CheckJitter, CheckRestForce
from wsim.judge.checks.run import CheckComplete, CheckFinite, CheckLog, CheckPlanControl, CheckPlanObjects
from wsim.judge.evidence.evidence import Evidence
from wsim.judge.language.objective import ObjectiveFormula
from wsim.judge.objectives.fluid import ObjectiveFills, ObjectiveFloats, ObjectiveStaysInside, ObjectiveSubmerged
from wsim.judge.objectives.hinge import ObjectiveSwings, ObjectiveTilts
from wsim.judge.objectives.motion import (
    ObjectiveCollidesWith,
    ObjectiveFlies,
    ObjectiveMoves,
    ObjectiveRollsDown,
    ObjectiveSlides,
)
from wsim.judge.objectives.solid import (
    CheckSettled,
    ObjectiveRestsOn,
    ObjectiveSettles,
    ObjectiveStaysOn,
    ObjectiveTopples,
)
from wsim.judge.repair.aim import aim
from wsim.judge.verdict import Finding, Verdict

if TYPE_CHECKING:
    from wsim.judge.checks.check import Check
    from wsim.judge.objectives.objective import ObjectiveCheck
    from wsim.plan.schema import Plan
    from wsim.recording.recording import Recording

OBJECTIVES: dict[str, type[ObjectiveCheck]] = {
    "floats": ObjectiveFloats,
    "rests_on": ObjectiveRestsOn,
    "submerged": ObjectiveSubmerged,
    "stays_on": ObjectiveStaysOn,
    "topples": ObjectiveTopples,
    "stays_inside": ObjectiveStaysInside,
    "settles": ObjectiveSettles,
    "swings": ObjectiveSwings,
    "slides": ObjectiveSlides,
    "rolls_down": ObjectiveRollsDown,
    "moves": ObjectiveMoves,
    "flies": ObjectiveFlies,
    "collides_with": ObjectiveCollidesWith,
    "tilts": ObjectiveTilts,
    "fills": ObjectiveFills,
}


def run_checks() -> list[Check]:
    """The checks that need no finite numbers."""
    return [CheckFinite(), CheckComplete(), CheckLog(), CheckPlanObjects(), CheckPlanControl()]


def physics_checks() -> list[Check]:
    """The checks of what the numbers say."""
    return [
        CheckExplosion(),
        CheckPenetration(),
        CheckFluidContained(),
        CheckDensity(),
        CheckWaterLevel(),
        CheckSettled(),
        CheckContinuity(),
        CheckFreeFlight(),
        CheckFreeTurning(),
        CheckGravity(),
        CheckEnergy(),
        CheckTunnelling(),
        CheckSupport(),
        CheckFriction(),
        CheckRestForce(),
        CheckJitter(),
        CheckCreep(),
        CheckJoints(),
        CheckJointLimits(),
        CheckDrives(),
        CheckMass(),
        CheckPlanSizes(),
        CheckPlanPlaces(),
        CheckPlanLooks(),
        CheckPlanJoints(),
        CheckPlanFluid(),
        CheckFluidMass(),
        CheckHydrostatic(),
        CheckInFrame(),
        CheckSeen(),
    ]


def judge(recording: Recording, plan: Plan | None = None) -> Verdict:
    """Judge what happened.

    Args:
        recording: The evidence; nothing else is looked at.
        plan: What was asked for. Without one, only the checks that hold for any world are made.

    Returns:
        Accepted if every finding passed, rejected if one did not, blocked if there is nothing to judge.
    """
    evidence = Evidence(recording, plan)
    if len(evidence.time) == 0:
        finding = Finding(check="CheckComplete", passed=False, message="The recording has no frames")
        aim([finding])
        return Verdict(status="blocked", summary="Blocked: the recording has no frames.", findings=[finding])
    findings = [finding for check in run_checks() for finding in check.run(evidence)]
    broken = next((f for f in findings if f.check == "CheckFinite" and not f.passed), None)
    if broken is None:
        findings += [finding for check in physics_checks() for finding in check.run(evidence)]
    for objective in plan.objectives if plan is not None else []:
        check = (OBJECTIVES[objective.kind] if objective.formula is None else ObjectiveFormula)(objective)
        if broken is None:
            findings += check.run(evidence)
        else:
            prim = evidence.prim(objective.object)
            message = f"{prim}: cannot be measured: {broken.message}"
            findings.append(
                check.failed(message, objective=check.sentence, prim=prim, time=broken.time, line=evidence.line(prim))
            )
    return conclude(findings, evidence)


def conclude(findings: list[Finding], evidence: Evidence | None = None) -> Verdict:
    """Accepted if every finding passed; one sentence says why not, and each failed finding what to change."""
    aim(findings, evidence)
    failures = [finding for finding in findings if not finding.passed]
    if not failures:
        return Verdict(status="accepted", summary=f"Accepted: all {len(findings)} findings pass.", findings=findings)
    # An objective says more to a person than the check that a broken world fails besides.
    first = next((finding for finding in failures if finding.objective is not None), failures[0])
    summary = f"Rejected: {len(failures)} of {len(findings)} findings fail; {first.message.rstrip('.')}."
    return Verdict(status="rejected", summary=summary, findings=findings)
