"""The planner: a prompt, and a picture if there is one, become a plan; what the layout refuses goes back to it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsim.agents.ask import UnusableError, object_in
from wsim.agents.chapters import asked_for, chapters_for, planner_prompt, told
from wsim.agents.clauses import ask_for_clauses
from wsim.agents.failures import ModelError
from wsim.agents.robots import robots_for
from wsim.agents.shorthand import written_out
from wsim.assets import search
from wsim.errors import UserError
from wsim.plan.asked.covered import missing, spans
from wsim.plan.asked.demands import REQUIRED, demands
from wsim.plan.asked.filled import filled
from wsim.plan.asked.tied import tied
from wsim.plan.feasible.plan import refuse_impossible
from wsim.plan.store import made
from wsim.program.compose import compose
from wsim.program.validator import validate

if TYPE_CHECKING:
    from wsim.agents.ask import Desk
    from wsim.plan.schema import Plan

ASSETS = 6  # of the catalogue that are offered
REASON = 400  # characters of why something cannot be simulated
NO_OBJECTIVE = "plan: objectives: none; say what must happen, so that the judge can hold the world to it"
HINTS = (
    '{"image": {"hints": {"visible_objects": [str], "scale": str, "support": [str], "layout": [str], '
    '"scene_type": str, "action_intent": str, "constraints": [str]}}}'
)


def plan_with(desk: Desk, prompt: str, pictures: Sequence[bytes] = (), image: str = "") -> Plan:
    """The model's plan of a prompt, laid out.

    A prompt whose point cannot be simulated has the plan that comes nearest, which says what it stands in for.

    Args:
        desk: Asks the planner's model.
        prompt: What the world must be.
        pictures: JPEGs of what it must look like.
        image: Name of the picture's file, for the plan.

    Raises:
        ModelError: If no answer became a plan, or nothing comes near.
        BudgetError: If tokens or time ran out.
    """
    request = [f"Prompt: {prompt}"]
    known: dict[str, str] = {}
    if pictures:
        known = {"path": image, "sha256": sha256(pictures[0]).hexdigest()}
        request.append(f"A reference picture is attached ({image}); fill image.hints from it: {HINTS}")
    request += [_catalogue(prompt), robots_for(prompt)]
    sound: list[tuple[Plan, dict[str, Any]]] = []  # with the answers that they were made of

    def read(text: str) -> Plan | Cannot:
        answer = object_in(text)
        if wanted := asked_for(answer):
            raise UnusableError(told(wanted))
        plan = _read(answer, prompt, known)
        if isinstance(plan, Cannot):
            return plan
        first, plan = not sound, filled(plan)
        sound.append((plan, answer))
        if first and passes_over_the_impossible(plan) and desk.answers("planner"):
            raise UnusableError(clauses_lacking(plan))  # which another plan may have to stand in for
        return plan

    try:
        found = desk.ask(
            "planner", "\n\n".join(request), read, pictures=pictures, told=planner_prompt(chapters_for(prompt))
        )
    except ModelError:
        if not sound:
            raise
        found = sound[-1][0]
    if isinstance(found, Cannot):
        raise ModelError("cannot", found.why, "planner")
    lacks = clauses_lacking(found)
    if not lacks or len(sound) > 1 or not desk.answers("planner"):
        return _with_clauses(found) if lacks else found
    return _with_clauses(_tied(desk, found, sound[-1][1], lacks, prompt, known))


def _tied(desk: Desk, plan: Plan, answer: dict[str, Any], lacks: str, prompt: str, picture: dict[str, str]) -> Plan:
    """The plan with the clauses that its model adds; as it is where the model adds none that can be used."""
    own = answer["nearest"] if "cannot" in answer else answer

    def again(mended: dict[str, Any]) -> Plan:
        read = _read({**answer, "nearest": mended} if "cannot" in answer else mended, prompt, picture)
        if isinstance(read, Cannot):
            raise UnusableError("the plan is sound: add to its clauses alone")
        return filled(read)

    try:
        return ask_for_clauses(desk, plan, own, lacks, again)
    except ModelError:
        return plan


@dataclass(frozen=True)
class Cannot:
    """The planner's word that wsim has nothing like what is asked."""

    why: str


def _read(answer: dict[str, Any], prompt: str, picture: dict[str, str]) -> Plan | Cannot:
    """A plan; or the one that comes nearest; or why there is none."""
    if "cannot" not in answer:
        return read_plan(answer, prompt, picture)
    why = " ".join(str(answer["cannot"] or "").split())[:REASON]
    if not why:
        raise UnusableError('cannot: say what cannot be simulated, and why, or leave "cannot" out')
    if answer.get("nearest") is None:
        return Cannot(why)
    if not isinstance(answer["nearest"], dict):
        raise UnusableError("nearest: it is a whole plan, or null where nothing comes near")
    return read_plan(answer["nearest"] | {"stands_in_for": why}, prompt, picture)


def _with_clauses(plan: Plan) -> Plan:
    """A plan whose model was asked for clauses: without any it gets those that its words alone give."""
    return plan if plan.clauses else tied(plan)


def passes_over_the_impossible(plan: Plan) -> bool:
    """Whether the prompt has what nothing in wsim does, and the plan says nothing of it."""
    return any(gap.demand.kind == "beyond" for gap in missing(plan))


def clauses_lacking(plan: Plan) -> str:
    """What a plan passes over of its prompt, for the model to mend; empty where it is nothing.

    A plan with no clauses at all is told of those that its prompt has.
    """
    if not plan.clauses and not (asked := [each for each in demands(plan.prompt) if each.kind in REQUIRED]):
        return ""
    if not plan.clauses:
        listed = ", ".join(each.quoted for each in asked)
        return f"plan: clauses: none; tie the words of the prompt to what shows them: {listed}"
    wrong = [f"clauses: {clause.words!r} is not in the prompt as it stands" for clause, at in spans(plan) if not at]
    silent = missing(plan)
    if any(gap.demand.kind == "beyond" for gap in silent):
        wrong.append('where that is the point, answer {"cannot": what and why, "nearest": the nearest plan or null}')
    if silent:
        wrong.append(
            "clauses: " + "; ".join(gap.line for gap in silent) + "; tie each to an objective or a property that shows "
            'it, or say in "unchecked" why nothing does'
        )
    return f"plan: {'; '.join(wrong)}" if wrong else ""


def read_plan(answer: dict[str, Any], prompt: str, picture: dict[str, str] | None = None) -> Plan:
    """A plan from a model's answer: shorthand is written out, sentences become formulas, places are worked out.

    Args:
        answer: What the model said.
        prompt: What it was asked for.
        picture: `path` and `sha256` of the reference picture, if there is one: what no model can know.

    Raises:
        UserError: What is wrong with it, with its path in the plan.
    """
    data = {"title": prompt[:80], **answer, "prompt": prompt}
    if picture and isinstance(data.get("image") or {}, dict):
        data["image"] = {**(data.get("image") or {}), **picture}
    data = written_out(data)
    if data.get("objectives") == []:
        raise UserError(NO_OBJECTIVE)
    plan = made(data, Path("plan"))
    if not plan.objectives:
        raise UserError(NO_OBJECTIVE)
    refuse_impossible(plan)
    problems = validate(compose(plan), plan)  # what no program can be written for is the planner's to mend
    if problems:
        raise UserError(f"plan: no program can build it: {problems[0].message}")
    return plan


def _catalogue(prompt: str) -> str:
    """What the catalogue has for the prompt's words."""
    lines = []
    for hit in search(prompt, ASSETS):
        size = " x ".join(f"{edge:.3g}" for edge in hit.asset.size)
        lines.append(f"{hit.asset.id}: {hit.asset.names[0]}, {size} m")
    return "Assets of the catalogue that may fit:\n" + ("\n".join(lines) or "none")
