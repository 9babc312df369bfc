"""The planner: a prompt, and a picture if there is one, become a plan; what the layout refuses goes back to it."""

from __future__ import annotations

from collections.abc import Sequence
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsim.agents.ask import UnusableError, object_in
from wsim.agents.chapters import asked_for, chapters_for, planner_prompt, told
from wsim.agents.robots import robots_for
from wsim.assets import search
from wsim.errors import UserError
from wsim.judge.language import parse
from wsim.plan.store import made
from wsim.program.compose import compose
from wsim.program.validator import validate

if TYPE_CHECKING:
    from wsim.agents.ask import Desk
    from wsim.plan.schema import Plan

ASSETS = 6  # of the catalogue that are offered
HINTS = (
    '{"image": {"hints": {"visible_objects": [str], "scale": str, "support": [str], "layout": [str], '
    '"scene_type": str, "action_intent": str, "constraints": [str]}}}'
)


def plan_with(desk: Desk, prompt: str, pictures: Sequence[bytes] = (), image: str = "") -> Plan:
    """The model's plan of a prompt, laid out.

    Args:
        desk: Asks the planner's model.
        prompt: What the world must be.
        pictures: JPEGs of what it must look like.
        image: Name of the picture's file, for the plan.

    Raises:
        ModelError: If no answer became a plan.
        BudgetError: If tokens or time ran out.
    """
    request = [f"Prompt: {prompt}"]
    known: dict[str, str] = {}
    if pictures:
        known = {"path": image, "sha256": sha256(pictures[0]).hexdigest()}
        request.append(f"A reference picture is attached ({image}); fill image.hints from it: {HINTS}")
    request += [_catalogue(prompt), robots_for(prompt)]

    def accept(text: str) -> Plan:
        answer = object_in(text)
        if wanted := asked_for(answer):
            raise UnusableError(told(wanted))
        return read_plan(answer, prompt, known)

    return desk.ask(
        "planner", "\n\n".join(request), accept, pictures=pictures, told=planner_prompt(chapters_for(prompt))
    )


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
    if isinstance(data.get("objects"), list):
        data["objects"] = [_written_out(item) if isinstance(item, dict) else item for item in data["objects"]]
    objectives = data.get("objectives")
    for number, objective in enumerate(objectives if isinstance(objectives, list) else []):
        if isinstance(objective, dict) and objective.get("kind") == "formula" and "formula" not in objective:
            objective["formula"] = _formula(str(objective.get("sentence", "")), f"objectives.{number}.sentence")
    plan = made(data, Path("plan"))
    if not plan.objectives:
        raise UserError("plan: objectives: none; say what must happen, so that the judge can hold the world to it")
    problems = validate(compose(plan), plan)  # what no program can be written for is the planner's to mend
    if problems:
        raise UserError(f"plan: no program can build it: {problems[0].message}")
    return plan


def _written_out(item: dict[str, Any]) -> dict[str, Any]:
    """An object whose `primitive` and `size`, or `asset`, and `relations` may stand at its top."""
    full = dict(item)
    if "construction" not in full:
        if "asset" in full:
            full["construction"] = {"kind": "asset", "asset": full.pop("asset")}
        elif "primitive" in full:
            full["construction"] = {"primitive": full.pop("primitive"), "size": full.pop("size", [])}
    if isinstance(full.get("construction"), dict):
        full["construction"] = {"kind": "proxy", **full["construction"]}
    if "relations" in full and "topology" not in full:
        full["topology"] = {"relation": full.pop("relations")}
    if isinstance(full.get("position"), list) and "pose" not in full:
        full["pose"] = {"position": full.pop("position"), "rotation_deg": full.pop("rotation_deg", [0, 0, 0])}
    return full


def _formula(sentence: str, where: str) -> dict[str, Any]:
    try:
        return parse(sentence).model_dump(mode="json", exclude_none=True)
    except ValueError as error:
        raise UserError(f"{where}: {error}") from error


def _catalogue(prompt: str) -> str:
    """What the catalogue has for the prompt's words."""
    lines = []
    for hit in search(prompt, ASSETS):
        size = " x ".join(f"{edge:.3g}" for edge in hit.asset.size)
        lines.append(f"{hit.asset.id}: {hit.asset.names[0]}, {size} m")
    return "Assets of the catalogue that may fit:\n" + ("\n".join(lines) or "none")
