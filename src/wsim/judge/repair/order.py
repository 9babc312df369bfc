"""Which suggestion to try first: what was built otherwise than planned explains much of what happens then."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from wsim.judge.verdict import Finding, Verdict

# What is wrong before anything has moved, in the order in which one hides the next: what is not there has no place,
# and what has another size another weight.
CAUSES = (
    "build", "stage", "control", "CheckPlanObjects", "CheckPlanClosed", "CheckPlanJoints", "CheckPlanControl",
    "CheckPlanSizes", "CheckPlanPlaces", "CheckGravity", "CheckPlanFluid", "CheckMass", "CheckPlanMotion",
    "CheckPlanTerrain", "CheckPlanScatter", "CheckPlanVehicles", "CheckPlanLooks", "CheckPlanContacts", "CheckComplete",
)  # fmt: skip
# What follows the motion, and is put right after it.
LAST = ("CheckInFrame", "CheckSeen")


def suggestions(verdict: Verdict) -> list[Finding]:
    """The failed findings in the order in which their targets are to be tried; of equal targets one.

    What the plan says comes before what physics says, what starts wrong before what happens then, a value before a
    direction, and the cameras last.
    """
    seen: list[object] = []
    found = []
    for finding in sorted(verdict.failures, key=_rank):
        if finding.target is not None and finding.target not in seen:
            seen.append(finding.target)
            found.append(finding)
    return found


def _rank(finding: Finding) -> tuple[int, int, int]:
    target = finding.target
    valued = target is not None and (target.value != "" or target.direction in ("remove", "add"))
    if finding.check in CAUSES:
        return 0, not valued, CAUSES.index(finding.check)
    at_start = target is not None and target.parameter == "position" and target.vector is not None
    group = 3 if finding.check in LAST else 1 if at_start and valued else 2
    # An objective says what was asked; a check of the motion finds what a wrong start does besides.
    return group, not valued, finding.objective is None
