"""The verdict that follows from the findings of all checks and objectives."""

from __future__ import annotations

import contextlib
import warnings
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from wsim.forks import uncollected
from wsim.judge.books.copies import similar
from wsim.judge.books.copies import work_out as books_of
from wsim.judge.checks.registry import physics_checks, run_checks
from wsim.judge.evidence.alike import groups, same_form
from wsim.judge.evidence.evidence import Evidence
from wsim.judge.evidence.recorded import MissingError
from wsim.judge.language.objective import ObjectiveCheck
from wsim.judge.repair.aim import aim
from wsim.judge.verdict import Crash, Finding, RepairTarget, Verdict, status_of, unjudged
from wsim.plan.asked.covered import Told, told
from wsim.threads import in_one_thread

if TYPE_CHECKING:
    from wsim.judge.checks.check import Check
    from wsim.plan.schema import Plan
    from wsim.recording.recording import Recording


@dataclass
class Answers:
    """What checks found, and which could not be evaluated."""

    findings: list[Finding] = field(default_factory=list)
    crashes: list[Crash] = field(default_factory=list)

    def ask(self, checks: Iterable[Check], evidence: Evidence) -> None:
        """Put some checks to the evidence. One that crashes is kept as such, and the others go on."""
        for check in checks:
            try:
                self.findings += check.run(evidence)
            except Exception as error:  # noqa: BLE001 - whatever it is, it says something of the judge, not of the world
                self.crashes.append(Crash.of(error, check.name, check.asks))


@uncollected()
def judge(recording: Recording, plan: Plan | None = None) -> Verdict:
    """Judge what happened.

    Args:
        recording: The evidence; nothing else is looked at.
        plan: What was asked for. Without one, only the checks that hold for any world are made.

    Returns:
        Accepted if every finding passed, rejected if one did not, blocked if there is nothing to judge, something acts
        in the world that the judge does not know, or a check crashed where none failed.
    """
    return judge_copies([Evidence(recording, plan)])[0]


@in_one_thread()
def judge_copies(copies: Sequence[Evidence]) -> list[Verdict]:
    """Judge several copies of one world, over the same times and by the same plan, each as by itself.

    They may differ in how they move, and in their descriptions. All that checks ask is worked out at once of those
    of one geometry (`wsim.judge.evidence.alike`), and the books of those that differ in sizes, too
    (`wsim.judge.books.copies`).
    """
    if len(copies[0].time) == 0:
        return [_nothing() for _ in copies]
    if copies[0].world.foreign:
        return [_cannot_judge(evidence) for evidence in copies]
    runs, first = [Answers() for _ in copies], run_checks()
    for answers, evidence in zip(runs, copies, strict=True):
        answers.ask(first, evidence)
    broken = [next((f for f in run.findings if f.check == "CheckFinite" and not f.passed), None) for run in runs]
    sound = [evidence for evidence, wrong in zip(copies, broken, strict=True) if wrong is None]
    work_out(sound)
    checks = physics_checks()
    asked = {id(evidence.plan): told(evidence.plan) for evidence in copies}
    concluded = [_conclusion(checks, *each) for each in zip(copies, runs, broken, strict=True)]
    return [held(verdict, asked[id(each.plan)]) for verdict, each in zip(concluded, copies, strict=True)]


def work_out(copies: Sequence[Evidence]) -> None:
    """At once what the checks ask of all copies of like worlds. What cannot be is left to each by itself, and told."""
    joined: list[tuple[Evidence, list[Evidence]]] = []
    for group in (group for group in groups(copies, _of_one_form) if len(group) > 1):
        with _left_to_each(group, "motion"):
            whole = Evidence.join(group)
            joined += [(whole, group)] if whole is not None else []
    for group in (group for group in groups(copies, similar) if len(group) > 1):
        with _left_to_each(group, "books"):
            books_of(group)
        for check in physics_checks():
            with _left_to_each(group, check.name), contextlib.suppress(MissingError):
                check.prepare_similar(group)
    for whole, group in joined:
        asked = group[0].plan.objectives if group[0].plan is not None else []
        for check in (*physics_checks(), *map(ObjectiveCheck, asked)):
            with _left_to_each(group, check.name), contextlib.suppress(MissingError):
                check.prepare(whole, group)


def _of_one_form(one: Evidence, other: Evidence) -> bool:
    return same_form(one.world, other.world)


@contextlib.contextmanager
def _left_to_each(copies: Sequence[Evidence], what: str) -> Iterator[None]:
    """Verdicts stay what they are if it cannot be worked out at once, but slower: that is a fault of the judge's."""
    try:
        yield
    except Exception as error:  # noqa: BLE001 - a check that crashes for one world alone tells of it there
        told = f"{what} of {len(copies)} worlds cannot be worked out at once, and is of each by itself"
        warnings.warn(f"{told}: {type(error).__name__}: {error}", RuntimeWarning, stacklevel=2)


def _conclusion(checks: Sequence[Check], evidence: Evidence, answers: Answers, broken: Finding | None) -> Verdict:
    """The verdict on what moved, unless the numbers are broken."""
    asked = [ObjectiveCheck(each) for each in (evidence.plan.objectives if evidence.plan is not None else [])]
    if broken is None:
        answers.ask([*checks, *asked], evidence)
    else:
        answers.findings += [_unmeasured(check, evidence, broken) for check in asked]
    return conclude(answers.findings, evidence, answers.crashes)


def _unmeasured(check: ObjectiveCheck, evidence: Evidence, broken: Finding) -> Finding:
    prim = evidence.prim(check.objective.object)
    message = f"{prim}: cannot be measured: {broken.message}"
    return check.failed(message, objective=check.asks, prim=prim, time=broken.time, line=evidence.line(prim))


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


def conclude(findings: list[Finding], evidence: Evidence | None = None, crashes: Sequence[Crash] = ()) -> Verdict:
    """The verdict of some findings: one sentence says why it is so, and each failed finding what to change."""
    aim(findings, evidence)
    return Verdict(
        status=status_of(findings, crashes), summary=_summary(findings, crashes), findings=findings,
        crashes=list(crashes),
    )  # fmt: skip


def held(verdict: Verdict, asked: Told) -> Verdict:
    """A verdict that says what of the prompt nothing shows; a world that was not asked all of it is not accepted."""
    if asked == Told():
        return verdict
    status, summary = verdict.status, verdict.summary
    if status == "accepted" and asked.unasked:
        status, summary = "blocked", f"Blocked: {asked.unasked}; all {len(verdict.findings)} findings pass."
    elif asked.not_checked:
        summary = f"{summary.rstrip('.')}; not checked: {_quoted(asked.not_checked)}."
    if asked.stands_in_for:
        summary = f"{summary.rstrip('.')}. It stands in for {asked.stands_in_for.rstrip('.')}."
    more = {"not_checked": list(asked.not_checked), "stands_in_for": asked.stands_in_for}
    return verdict.model_copy(update={"status": status, "summary": summary, **more})


def _quoted(lines: Sequence[str]) -> str:
    """The words of the prompt alone: why nothing shows them stands beside the verdict."""
    return ", ".join(dict.fromkeys(line.partition("': ")[0] + "'" for line in lines))


def _summary(findings: list[Finding], crashes: Sequence[Crash]) -> str:
    failures = [finding for finding in findings if not finding.passed]
    if not failures:
        if crashes:
            return f"Blocked: {unjudged(crashes)}; all {len(findings)} findings of the others pass."
        return f"Accepted: all {len(findings)} findings pass."
    # An objective says more to a person than the check that a broken world fails besides.
    first = next((finding for finding in failures if finding.objective is not None), failures[0])
    besides = f"; {unjudged(crashes)}" if crashes else ""
    return f"Rejected: {len(failures)} of {len(findings)} findings fail; {first.message.rstrip('.')}{besides}."
