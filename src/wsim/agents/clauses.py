"""Clauses that a sound plan lacks are asked for by themselves: the whole plan need not be written again for a word."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from wsim.agents.ask import UnusableError, object_in

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from wsim.agents.ask import Desk
    from wsim.plan.schema import Plan

TOLD = """You wrote a plan of a physical world. It is sound, but not all of its prompt is tied to what shows it.
A clause has "words", verbatim from the prompt, and "by": numbers of objectives (from 0), names, or properties:
name.size, .mass, .density, .velocity, .spin, .friction, .place; a joint.drive, .limits, .anchor; a cord.length,
.stiffness; a schedule; a camera. A verb needs an objective about those that it is said of, a number what has it. Where
no objective shows it, add one: {"kind": "formula", "object": name, "sentence": "..."}, in the words of those there are;
its number counts on from the last. What nothing shows has "unchecked": why, not "by".
Answer {"clauses": [new ones, or with other "by" than before], "objectives": [those to add]} and nothing else."""


def ask_for_clauses(desk: Desk, plan: Plan, answer: dict[str, Any], lacks: str, read: Callable[[Any], Plan]) -> Plan:
    """The plan with the clauses, and the objectives, that its model adds.

    Args:
        desk: Asks the planner's model.
        plan: The plan as it stands.
        answer: What it was made of.
        lacks: What its clauses leave out.
        read: Makes a plan of an answer.

    Raises:
        ModelError: No answer could be used.
        BudgetError: Tokens or time ran out.
    """

    def mended(text: str) -> Plan:
        more = object_in(text)
        if "objects" in more:  # the whole plan again
            return read(more)
        if not isinstance(more.get("clauses"), list):
            raise UnusableError('clauses: give those that are lacking, {"clauses": [{"words", "by"}]}')
        new = {clause.get("words") for clause in more["clauses"] if isinstance(clause, dict)}
        clauses = [clause for clause in answer.get("clauses") or [] if clause.get("words") not in new]
        added = more.get("objectives") or []
        objectives = [*answer.get("objectives", []), *(added if isinstance(added, list) else [])]
        return read(answer | {"clauses": [*clauses, *more["clauses"]], "objectives": objectives})

    return desk.ask("planner", _request(plan, answer, lacks), mended, told=TOLD)


def _request(plan: Plan, answer: dict[str, Any], lacks: str) -> str:
    objectives = [f"{number} {each.kind} {each.object} {each.ref or ''}: {each.sentence}"
                  for number, each in enumerate(plan.objectives)]  # fmt: skip
    things: dict[str, Sequence[Any]] = {
        "objects": plan.objects, "joints": plan.joints, "cords": plan.cords, "schedules": plan.schedules,
        "openings": plan.openings,
        "cameras": plan.cameras,
    }  # fmt: skip
    named = [f"{kind}: {', '.join(each.name for each in found)}" for kind, found in things.items() if found]
    parts = [
        f"Prompt: {plan.prompt}", "# Objectives", *objectives, "# Things", *named, "# Clauses",
        json.dumps(answer.get("clauses") or [], ensure_ascii=False), "# Left out", lacks,
    ]  # fmt: skip
    return "\n".join(parts)
