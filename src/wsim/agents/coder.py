"""The coder: edits of the program that is there, checked before anything runs."""

from __future__ import annotations

import ast
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from wsim.agents.ask import UnusableError
from wsim.program.patch import PatchError, apply, parse
from wsim.program.validator import validate
from wsim.skills import pick as by_words
from wsim.skills import skills
from wsim.tools import TOOLS as ALL

if TYPE_CHECKING:
    from wsim.agents.ask import Desk
    from wsim.plan.schema import Plan
    from wsim.tools import Workspace

SKILLS = 2  # that go into a request; the model may read others
TOOLS = (
    "search_api", "show_api", "search_skills", "show_skill", "search_catalogue", "show_asset", "query_recording",
)  # fmt: skip
_PROGRAM = re.compile(r"^## A complete program\n.*?(?=^## |\Z)", re.DOTALL | re.MULTILINE)
NOT_HIS = ("objectives", "repairing")  # the plan says what must happen; how to repair is in his prompt
SKILL_OF = {"controller": "control-functions", "camera": "cameras-and-light", "time step": "time-step-and-stability"}
CANNOT = re.compile(r"^\W*CANNOT\W+(.+)", re.DOTALL)
REASON = 400  # characters of what edits are for
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


@dataclass(frozen=True)
class Patched:
    """A program with edits made, and what they are for in the coder's words; or why there can be none."""

    program: str
    why: str


def repair(desk: Desk, situation: Situation, plan: Plan | None, workspace: Workspace) -> Patched:
    """The program with the coder's edits made.

    Returns:
        The new program; an empty one where the coder says that none can keep to the plan and pass.

    Raises:
        ModelError: If no answer became a program that validates.
        BudgetError: If tokens or time ran out.
    """

    def accept(answer: str) -> Patched:
        given_up = CANNOT.match(answer)
        if given_up:
            return Patched("", " ".join(given_up[1].split())[:REASON])
        why = " ".join(answer.partition("<<<<<")[0].split())[:REASON]
        return Patched(_patched(answer, situation, plan), why)

    return desk.ask(
        "coder", request(situation, pick(situation)), accept, tools=[ALL[name] for name in TOOLS], workspace=workspace
    )


def _patched(answer: str, situation: Situation, plan: Plan | None) -> str:
    """The program that an answer's edits make.

    Raises:
        UserError: The edits do not fit, change nothing, were tried, or make a program with mistakes.
    """
    try:
        text = apply(situation.program, parse(answer))
    except PatchError as error:
        raise UnusableError(f"{error}; or, if none can mend it, CANNOT: and the reason") from error
    if text == situation.program:
        raise UnusableError("the edits change nothing; replace by something else than what is there")
    same = [number for program, number in situation.tried.items() if _runs_alike(program, text)]
    if same:
        number = same[0]
        raise UnusableError(f"but for comments this is the program of iteration {number}; try another, or say CANNOT")
    problems = validate(text, plan)
    if problems:
        shown = "\n".join(problem.sentence for problem in problems[:PROBLEMS])
        raise UnusableError(f"the edits fit, but the program they make has mistakes, at its new lines:\n{shown}")
    return text


def _runs_alike(one: str, other: str) -> bool:
    """Whether two programs differ in comments and layout alone."""
    try:
        return ast.dump(ast.parse(one)) == ast.dump(ast.parse(other))
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return one == other


def pick(situation: Situation) -> list[Any]:
    """The skills for a situation: what mends that which fails, then what the plan is about."""
    wanted = situation.repair or "\n".join(line for line in situation.verdict if not line.startswith("passed:"))
    found = [skill for skill in skills() if skill.name == SKILL_OF.get(situation.repair.partition(" (")[0])]
    for words in (wanted, "\n".join(situation.plan)):
        found += [picked.skill for picked in by_words(words, SKILLS + 1) if picked.skill.name not in NOT_HIS][:SKILLS]
    return list({skill.name: skill for skill in found}.values())[:SKILLS]


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
