"""The way back to the plan: evidence that it cannot come true goes to the planner, once, and it may mend it."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from wsim.agents.ask import UnusableError, object_in
from wsim.agents.planner import clauses_lacking, read_plan
from wsim.plan.asked.weaker import WIDER, weakened
from wsim.plan.schema.draft import Assumption

if TYPE_CHECKING:
    from wsim.agents.ask import Desk
    from wsim.plan.schema import Plan

REASON = 400  # characters of why
SUBJECT = "the plan, changed"
RULES = (
    'Where the evidence is right, answer {"why": "one sentence, with numbers", "plan": {the whole plan, mended}}: an '
    "objective, a place, a size that contradicts physics may change. What the prompt asks for stays: each clause keeps "
    f"as many objectives as it has, limits widen by {WIDER:.0%} at most, the prompt's numbers and what it names stay. "
    'Where the plan is right and the program is at fault, answer {"keep": "why"}.'
)


@dataclass(frozen=True)
class Replanned:
    """A plan in place of another, and why; None where the planner keeps the one that is there."""

    plan: Plan | None
    why: str


def replan(desk: Desk, plan: Plan, evidence: Sequence[str]) -> Replanned:
    """Ask the planner's model to mend a plan that a world of it was held against.

    Args:
        desk: Asks it.
        plan: The plan.
        evidence: Who found it at fault, why, and what was measured, as lines.

    Raises:
        ModelError: If no answer is a plan that asks for as much.
        BudgetError: If tokens or time ran out.
    """
    request = [
        f"Prompt: {plan.prompt}",
        "# The plan",
        f"```json\n{short(plan)}\n```",
        "# It may be at fault",
        *evidence,
    ]
    return desk.ask("planner", "\n\n".join([*request, RULES]), lambda text: _read(object_in(text), plan))


def _read(answer: dict[str, Any], plan: Plan) -> Replanned:
    why = " ".join(str(answer.get("why") or answer.get("keep") or "").split())[:REASON]
    if "keep" in answer:
        return Replanned(None, why)
    if not isinstance(answer.get("plan"), dict) or not why:
        raise UnusableError('answer {"why": ..., "plan": {...}}, or {"keep": ...} to leave the plan as it is')
    picture = {"path": plan.image.path, "sha256": str(plan.image.sha256 or "")} if plan.image is not None else None
    mended = read_plan(answer["plan"], plan.prompt, picture)
    less = weakened(plan, mended)
    if less:
        raise UnusableError(f"the change asks for less: {'; '.join(less)}; mend what contradicts physics alone")
    if plan.clauses and (lacks := clauses_lacking(mended)) and not clauses_lacking(plan):
        raise UnusableError(lacks)
    if _asks(mended) == _asks(plan):
        raise UnusableError('the plan is as it was; change what is at fault, or answer {"keep": "why"}')
    said = Assumption(subject=SUBJECT, choice=why, why="a world of the plan before it could not be made right")
    return Replanned(mended.model_copy(update={"assumptions": [*mended.assumptions, said]}), why)


def _asks(plan: Plan) -> dict[str, Any]:
    """A plan but for its words."""
    return plan.model_dump(exclude={"title", "assumptions", "steps"})


def short(plan: Plan) -> str:
    """A plan as JSON without what is open, and without the formulas that its sentences say."""
    data = plan.model_dump(mode="json", exclude={"prompt", "image", "outputs", "version"})
    for objective in data["objectives"]:
        if objective["sentence"] and objective["kind"] == "formula":
            del objective["formula"]
    return json.dumps(_filled(data), ensure_ascii=False)


def _filled(value: Any) -> Any:
    if isinstance(value, dict):
        kept = {name: _filled(each) for name, each in value.items()}
        return {name: each for name, each in kept.items() if each not in (None, "", [], {})}
    return [_filled(each) for each in value] if isinstance(value, list) else value
