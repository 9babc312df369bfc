"""Clauses that a planner left out and whose evidence the words alone find: it need not be asked again for these."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsim.plan.asked.covered import UNTIED, missing
from wsim.plan.asked.doers import doers
from wsim.plan.asked.shown import SHOWN_BY
from wsim.plan.asked.tied import evidence
from wsim.plan.asked.vocabulary import LETS_GO
from wsim.plan.schema.clause import Clause

if TYPE_CHECKING:
    from wsim.plan.asked.demands import Demand
    from wsim.plan.schema import Plan


def filled(plan: Plan) -> Plan:
    """The plan with clauses for what none of its own has, where what it asks for or states is found to show it.

    A verb takes objectives of the kinds that show it alone, about those that it is said of; a number what has it; how
    things stand, the things. What is not found is left out, as it was.
    """
    found = []
    for gap in missing(plan) if plan.clauses else ():
        by = _evidence(plan, gap.demand) if gap.why == UNTIED and not gap.demand.denied else []
        found += [Clause(words=gap.demand.text, by=by)] if by else []
    return plan.model_copy(update={"clauses": [*plan.clauses, *found]}) if found else plan


def _evidence(plan: Plan, demand: Demand) -> list[int | str]:
    if demand.kind == "state":
        return [item.name for item in plan.objects if item.primitive != "ground"]
    if demand.base in LETS_GO:
        return [item.name for item in plan.objects if item.state == "dynamic"]
    known = demand.kind == "number" or (demand.base in SHOWN_BY and bool(doers(plan, demand)))
    return list(evidence(plan, demand)) if known else []
