"""The coder: edits of the program that is there, checked before anything runs."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from wsim.agents.ask import UnusableError
from wsim.program.patch import apply, parse

if TYPE_CHECKING:
    from wsim.agents.ask import Desk
    from wsim.plan.schema import Plan
    from wsim.tools import Workspace

SKILLS = 2  # that go into a request; the model may read others
TOOLS = (
    "search_api", "show_api", "search_skills", "show_skill", "search_catalogue", "show_asset", "query_recording",
)  # fmt: skip
_PROGRAM = re.compile(r"^## A complete program\n.*?(?=^## |\Z)", re.DOTALL | re.MULTILINE)
PROBLEMS = 8  # of a patched program that are sent back at once


@dataclass
class Situation:
    """What the coder is told.

    Attributes:
        program: The text to edit: the best so far.
        verdict: What fails in it, as lines.
        repair: What the judge wants mended first, if it says.
        review: What the reviewer saw, if anyone looked.
        history: What was tried before and undone, a line each.
        tried: Texts that were tried, with their iteration.
        plan: The plan as lines.
    """

    program: str
    verdict: Sequence[str]
    plan: Sequence[str]
    repair: str = ""
    review: str = ""
    history: Sequence[str] = ()
    tried: Mapping[str, int] = field(default_factory=dict)


def repair(desk: Desk, situation: Situation, plan: Plan | None, workspace: Workspace) -> str:
    """The program with the coder's edits made.

    Raises:
        ModelError: If no answer became a program that validates.
        BudgetError: If tokens or time ran out.
    """
    from wsim.tools import TOOLS as ALL

    def accept(answer: str) -> str:
        return _patched(answer, situation, plan)

    return desk.ask(
        "coder", request(situation, pick(situation)), accept, tools=[ALL[name] for name in TOOLS], workspace=workspace
    )


def _patched(answer: str, situation: Situation, plan: Plan | None) -> str:
    """The program that an answer's edits make.

    Raises:
        UserError: The edits do not fit, change nothing, were tried, or make a program with mistakes.
    """
    from wsim.program.validator import validate

    text = apply(situation.program, parse(answer))
    if text == situation.program:
        raise UnusableError("the edits change nothing; replace by something else than what is there")
    if text in situation.tried:
        number = situation.tried[text]
        raise UnusableError(f"this very program was iteration {number}, and it was not better; try another")
    problems = validate(text, plan)
    if problems:
        shown = "\n".join(problem.sentence for problem in problems[:PROBLEMS])
        raise UnusableError(f"the edits fit, but the program they make has mistakes, at its new lines:\n{shown}")
    return text


def pick(situation: Situation) -> list[Any]:
    """The skills for a situation: what mends the checks that fail, then what the plan is about."""
    from wsim.skills import pick as by_words

    words = "\n".join((*situation.verdict, *situation.plan))
    return [picked.skill for picked in by_words(words, SKILLS)]


def request(situation: Situation, skills: Sequence[Any]) -> str:
    """What the coder reads."""
    parts = [
        "# Plan",
        "\n".join(situation.plan),
        "# program.py",
        f"```python\n{situation.program.rstrip()}\n```",
        "# Verdict",
        "\n".join(situation.verdict),
    ]
    for title, text in (
        ("# The judge wants this mended first", situation.repair),
        ("# The reviewer saw", situation.review),
        ("# Tried before, and undone", "\n".join(situation.history)),
    ):
        parts += [title, text] if text else []
    for skill in skills:
        parts += [f"# Skill {skill.name}", _rules(skill.body)]
    return "\n\n".join(parts)


def _rules(body: str) -> str:
    """A skill without its program, which is half of it: there is one to edit already, and show_skill has the other."""
    return _PROGRAM.sub("", body).strip()
