"""The judge's model: what to mend first, and whether what was seen is what was asked for.

It may object to a world that passes every check. It cannot accept one that fails a check: `decide` sees to it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Literal, get_args

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError

from wsim.agents.ask import UnusableError, object_in
from wsim.judge.verdict import Finding, RepairKind, RepairTarget, Verdict
from wsim.plan.schema.explain import explain

if TYPE_CHECKING:
    from wsim.agents.ask import Desk
    from wsim.plan.schema import Plan

ROOT = "/World/"
MINOR = 0.25  # of a major objection's weight
PLAN_STAYS = 'The planner has been asked once, and is not again: leave "plan" null, and name a repair.'
Short = Annotated[str, AfterValidator(lambda text: text[:800])]  # who says more is heard that far


class Objection(BaseModel):
    """Something of the plan or the prompt that the world does not show."""

    model_config = ConfigDict(extra="forbid")

    object: str
    what: Short
    severity: Literal["minor", "major"] = "major"


class Repair(BaseModel):
    """What to mend first."""

    model_config = ConfigDict(extra="forbid")

    kind: RepairKind
    object: str = ""
    parameter: Short = ""
    why: Short

    @property
    def sentence(self) -> str:
        """For the coder."""
        what = " of ".join(part for part in (self.parameter, self.object) if part)
        return f"{self.kind}{f' ({what})' if what else ''}: {self.why}"


class Opinion(BaseModel):
    """What the judge's model holds of a world."""

    model_config = ConfigDict(extra="forbid")

    accept: bool
    why: Short = ""
    repair: Repair | None = None
    plan: Short | None = None  # what of the plan no program can make true
    objections: list[Objection] = Field(default_factory=list, max_length=10)


def opinion(
    desk: Desk,
    plan: Plan,
    plan_lines: Sequence[str],
    verdict_lines: Sequence[str],
    seen: str,
    passed: bool,
    undone: Sequence[str] = (),
    plan_stays: bool = False,
) -> Opinion:
    """Ask the judge's model.

    Args:
        desk: Asks it.
        plan: What the world is to be.
        plan_lines: The same, to read.
        verdict_lines: What the checks found.
        seen: The review; empty if nobody looked.
        passed: Every check passed, so that only an objection can keep the world back.
        undone: Patches of this very world that made it no better.
        plan_stays: The planner was asked once already, and is not asked again.

    Raises:
        ModelError: If no answer is an opinion.
        BudgetError: If tokens or time ran out.
    """
    names = {each.name for things in (plan.objects, plan.cords) for each in things}
    review = seen or "nobody has looked at pictures yet"
    parts = [
        f"Prompt: {plan.prompt}", "# Plan", "\n".join(plan_lines), "# Checks", "\n".join(verdict_lines),
        "# Review", review,
    ]  # fmt: skip
    parts += ["# Tried from here, and undone", *undone] if undone else []
    parts += [PLAN_STAYS] if plan_stays and not passed else []
    request = "\n\n".join(parts)
    return desk.ask("judge", request, lambda text: _read(text, names, passed))


def _read(text: str, names: set[str], passed: bool) -> Opinion:
    try:
        found = Opinion.model_validate(object_in(text))
    except ValidationError as error:
        problem = error.errors(include_url=False)[0]
        hint = f"; kinds are {', '.join(get_args(RepairKind))}" if "kind" in problem["loc"] else ""
        raise UnusableError(f"{explain(error)}{hint}") from error
    for objection in found.objections:
        if objection.object not in names:
            raise UnusableError(
                f"objections: the plan has no object {objection.object!r}; it has {', '.join(sorted(names))}"
            )
    if not found.accept and not found.objections and passed:
        raise UnusableError(
            "every check passed: accept, or object to an object of the plan; neither a repair nor a fault of the plan "
            "is enough"
        )
    if not found.accept and not found.objections and found.repair is None and not found.plan:
        raise UnusableError(
            "not accepted, and neither a repair, a fault of the plan nor an objection; say what is wrong"
        )
    return found


def decide(verdict: Verdict, held: Opinion) -> Verdict:
    """The verdict with the model's objections in it. A failed check stays failed, whatever the model says.

    A world that fails by its checks is ranked by them alone: there objections say nothing that counts.
    """
    if verdict.status != "accepted" or held.accept or not held.objections:
        return verdict
    objections = [
        Finding(
            check="JudgeObjection",
            passed=False,
            message=f"{one.object}: {one.what}",
            prim=ROOT + one.object,
            limit_from="the judge's model, from the review",
            weight=1.0 if one.severity == "major" else MINOR,
            target=RepairTarget(kind="visual mismatch", prim=ROOT + one.object, why=one.what),
        )
        for one in held.objections
    ]
    findings = [*verdict.findings, *objections]
    failed = sum(not finding.passed for finding in findings)
    summary = f"{failed} of {len(findings)} findings fail, {len(objections)} by review."
    return verdict.model_copy(update={"status": "rejected", "summary": summary, "findings": findings})
