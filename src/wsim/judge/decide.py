"""The verdict that follows from the findings of all checks and objectives."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING

from wsim.judge.books.copies import work_out
from wsim.judge.checks.registry import physics_checks, run_checks
from wsim.judge.evidence.evidence import Evidence
from wsim.judge.language.objective import ObjectiveCheck
from wsim.judge.repair.aim import aim
from wsim.judge.verdict import Finding, RepairTarget, Verdict

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsim.plan.schema import Plan
    from wsim.recording.recording import Recording


def judge(recording: Recording, plan: Plan | None = None) -> Verdict:
    """Judge what happened.

    Args:
        recording: The evidence; nothing else is looked at.
        plan: What was asked for. Without one, only the checks that hold for any world are made.

    Returns:
        Accepted if every finding passed, rejected if one did not, blocked if there is nothing to judge, or something
        acts in the world that the judge does not know.
    """
    return judge_copies([Evidence(recording, plan)])[0]


def judge_copies(copies: Sequence[Evidence]) -> list[Verdict]:
    """Judge several copies of one world, over the same times and by the same plan, each as by itself.

    They may differ in how they move, in their masses and inertias, and in what went wrong.
    """
    first = copies[0]
    if len(first.time) == 0:
        return [_nothing() for _ in copies]
    if first.world.foreign:
        return [_cannot_judge(evidence) for evidence in copies]
    runs = [[finding for check in run_checks() for finding in check.run(evidence)] for evidence in copies]
    broken = [next((f for f in found if f.check == "CheckFinite" and not f.passed), None) for found in runs]
    sound = [evidence for evidence, wrong in zip(copies, broken, strict=True) if wrong is None]
    if len(sound) > 1:
        _work_out(sound)
    return [_conclusion(*each) for each in zip(copies, runs, broken, strict=True)]


def _work_out(copies: Sequence[Evidence]) -> None:
    """At once what the checks ask of all copies. What cannot be is left to each by itself, whose check tells of it."""
    joined = None
    with contextlib.suppress(Exception):
        joined = Evidence.join(copies)
    with contextlib.suppress(Exception):
        work_out(copies)
    if joined is not None:
        asked = copies[0].plan.objectives if copies[0].plan is not None else []
        for check in (*physics_checks(), *map(ObjectiveCheck, asked)):
            with contextlib.suppress(Exception):
                check.prepare(joined, copies)


def _conclusion(evidence: Evidence, findings: list[Finding], broken: Finding | None) -> Verdict:
    """The verdict on what moved, unless the numbers are broken."""
    if broken is None:
        findings += [finding for check in physics_checks() for finding in check.run(evidence)]
    for objective in evidence.plan.objectives if evidence.plan is not None else []:
        check = ObjectiveCheck(objective)
        if broken is None:
            findings += check.run(evidence)
        else:
            prim = evidence.prim(objective.object)
            message = f"{prim}: cannot be measured: {broken.message}"
            findings.append(
                check.failed(message, objective=check.sentence, prim=prim, time=broken.time, line=evidence.line(prim))
            )
    return conclude(findings, evidence)


def _nothing() -> Verdict:
    finding = Finding(check="CheckComplete", passed=False, message="The recording has no frames")
    aim([finding])
    return Verdict(status="blocked", summary="Blocked: the recording has no frames.", findings=[finding])


def _cannot_judge(evidence: Evidence) -> Verdict:
    """Blocked: a motion that an unknown part of the world may have made is neither right nor wrong."""
    told = [f"{one.prim} has {one.feature}" for one in evidence.world.foreign]
    findings = [
        Finding(
            check="CheckKnown", passed=False, message=f"Cannot judge what {each}", prim=one.prim,
            target=RepairTarget(kind="program", prim=one.prim, direction="remove", why="the judge has no law for it"),
        )
        for each, one in zip(told, evidence.world.foreign, strict=True)
    ]  # fmt: skip
    more = f", nor {len(told) - 1} more" if len(told) > 1 else ""
    return Verdict(status="blocked", summary=f"Blocked: cannot judge what {told[0]}{more}.", findings=findings)


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
