"""The prompt's clauses, and what answers for each: objectives, objects, or nothing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from wsim.plan.asked.covered import not_checked
from wsim.report.asked import sentence_of

if TYPE_CHECKING:
    from wsim.plan.schema import Plan
    from wsim.runs.records import ClauseSeen, Review


@dataclass(frozen=True)
class Clauses:
    """What the page says of the prompt's words."""

    rows: list[tuple[str, list[str]]]  # words, and what answers for them
    not_checked: list[str]
    stands_in_for: str


def make_clauses(plan: Plan | None) -> Clauses | None:
    """Of a plan that has any; None where there is nothing to say."""
    if plan is None or not (plan.clauses or plan.stands_in_for):
        return None
    rows = []
    for clause in plan.clauses:
        shown = [sentence_of(plan.objectives[number]) for number in clause.objectives]
        shown += [f"{name}: {field.replace('_', ' ')}" if field else name for name, field in clause.things]
        rows += [(clause.words, shown)] if shown else []
    return Clauses(rows, not_checked(plan), plan.stands_in_for or "")


def make_seen(plan: Plan | None, review: Review | None) -> list[tuple[str, ClauseSeen]]:
    """(words, what a reviewer says) of each clause that it was asked about."""
    if plan is None or review is None:
        return []
    known = dict(enumerate(plan.clauses, start=1))
    return [(known[each.clause].words, each) for each in review.review.clauses if each.clause in known]
