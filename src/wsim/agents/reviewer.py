"""The reviewer: what a run's pictures show, and what of it is not as planned. Without a model, the facts alone."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError

from wsim.agents.ask import UnusableError, object_in
from wsim.agents.sheet import contact_sheet, shares
from wsim.plan.schema.explain import explain
from wsim.runs.folder import write_json

if TYPE_CHECKING:
    from wsim.agents.ask import Desk
    from wsim.plan.schema import Plan

ROOT = "/World/"
Short = Annotated[str, AfterValidator(lambda text: text[:1200])]  # who says more is heard that far


class Difference(BaseModel):
    """Something that is not as the plan has it."""

    model_config = ConfigDict(extra="forbid")

    object: str
    what: Short
    severity: Literal["minor", "major"] = "minor"


class Shown(BaseModel):
    """Whether pictures and motion show a clause of the prompt."""

    model_config = ConfigDict(extra="forbid")

    clause: int = Field(ge=1)  # as the request numbers them
    shown: Literal["yes", "no", "cannot be seen"]
    why: Short = ""


class Review(BaseModel):
    """What was seen."""

    model_config = ConfigDict(extra="forbid")

    summary: Short
    objects: Short = ""
    layout: Short = ""
    motion: Short = ""
    contacts: Short = ""
    differences: list[Difference] = Field(default_factory=list, max_length=20)
    clauses: list[Shown] = Field(default_factory=list, max_length=100)

    def unshown(self, plan: Plan) -> list[str]:
        """The clauses of the prompt that the pictures contradict, a line each."""
        return [
            f"not shown: '{plan.clauses[each.clause - 1].words}'{f': {each.why}' if each.why else ''}"
            for each in self.clauses
            if each.shown == "no"
        ]

    @property
    def text(self) -> str:
        """For the judge and the coder."""
        lines = [self.summary]
        lines += [f"{d.severity}: {d.object}: {d.what}" for d in self.differences]
        return "\n".join(line for line in lines if line)


def facts(folder: Path) -> list[str]:
    """How much of each still each object takes up, by the shape-index images: at the start, least and when, and last.

    Args:
        folder: An iteration's folder with a review.json.
    """
    cameras: dict[str, list[dict[str, Any]]] = {}
    for row in shares(folder):
        cameras.setdefault(row["camera"], []).append(row)
    lines = []
    for camera, rows in cameras.items():
        seen = sorted({prim for row in rows for prim in row["objects"]})
        parts = [f"{prim.removeprefix(ROOT)} {_over_time(rows, prim)}" for prim in seen]
        lines.append(f"{camera.removeprefix(ROOT)} (% of picture at start/least/end): {', '.join(parts)}")
    return lines


def _over_time(rows: Sequence[dict[str, Any]], prim: str) -> str:
    values = [100.0 * row["objects"].get(prim, 0.0) for row in rows]
    least = min(range(len(values)), key=values.__getitem__)
    when = f"@{rows[least]['time']:g}s" if values[least] < min(values[0], values[-1]) else ""
    return f"{values[0]:.2g}/{values[least]:.2g}{when}/{values[-1]:.2g}"


def review(desk: Desk, plan: Plan, folder: Path, plan_lines: Sequence[str]) -> Review:
    """What the reviewer's model sees in a run's pictures.

    Raises:
        ModelError: If no answer is a review.
        BudgetError: If tokens or time ran out.
    """
    sheet, labels = contact_sheet(folder, [camera.name for camera in plan.cameras])
    names = {each.name for things in (plan.objects, plan.cords) for each in things}
    clauses = [f"{number}. {clause.words}" for number, clause in enumerate(plan.clauses, start=1)]
    request = "\n\n".join(
        [
            f"Prompt: {plan.prompt}", *(["# Its clauses", "\n".join(clauses)] if clauses else []),
            "# Plan", "\n".join(_seen_by_eye(plan, plan_lines)),
            "# Pictures", f"One sheet, left to right, top to bottom: {', '.join(labels)}" if labels else "none",
            "# Facts from the shape-index images (glass and water have no pixels)",
            "\n".join(facts(folder)) or "none",
        ]
    )  # fmt: skip
    return desk.ask(
        "reviewer", request, lambda text: _read(text, names, len(clauses)), pictures=[sheet] if sheet else []
    )


def _seen_by_eye(plan: Plan, plan_lines: Sequence[str]) -> list[str]:
    """The plan's lines without formulas, which measurements show, nor the head of a table of them alone."""
    left_out = ("formula", "must ") if all(each.kind == "formula" for each in plan.objectives) else ("formula",)
    return [line for line in plan_lines if not line.startswith(left_out)]


def _read(text: str, names: set[str], clauses: int) -> Review:
    try:
        found = Review.model_validate(object_in(text))
    except ValidationError as error:
        raise UnusableError(explain(error)) from error
    for difference in found.differences:
        if difference.object not in names:
            raise UnusableError(
                f"differences: the plan has no object {difference.object!r}; it has {', '.join(sorted(names))}"
            )
    for each in found.clauses:
        if each.clause > clauses:
            raise UnusableError(f"clauses: there is no clause {each.clause}; they are numbered from 1 to {clauses}")
    return found


def keep(folder: Path, found: Review | None, by: str) -> None:
    """Write a review into review.json, beside the facts."""
    path = folder / "review.json"
    data: dict[str, Any] = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}
    write_json(path, data | {"by": by, "review": found.model_dump() if found else {"facts": facts(folder)}})
