"""A recorded run made again, offline: the same replies, and where anything comes out otherwise."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsim.agents.budget import Budget
from wsim.agents.models import BUILTIN, ROLES, Models
from wsim.agents.relay import Replay
from wsim.errors import UserError
from wsim.loop.generate import generate
from wsim.loop.options import Options
from wsim.loop.start import FIRST_PLAN, REFERENCE
from wsim.plan.store import load
from wsim.progress import Progress, silent
from wsim.runs.folder import RunFolder
from wsim.runs.settings import Settings

if TYPE_CHECKING:
    from wsim.loop.options import Generated

COMPARED = ("plan.json", "transcript.jsonl")
COMPARED_IN_ITERATIONS = ("program.py", "patch.diff", "verdict.json")


@dataclass
class Replayed:
    """A run made again.

    Attributes:
        generated: The new run.
        divergences: Where what was asked differs from what was recorded, a line each.
        differing: Files that are not byte for byte as recorded, with the first line that differs.
        same: How many files are.
    """

    generated: Generated
    divergences: list[str]
    differing: list[str]
    same: int


def replay(recorded: Path, runs: Path, progress: Progress = silent, device: str | None = None) -> Replayed:
    """Make a recorded run again, with its replies in place of models.

    Args:
        recorded: The folder of a run that `wsim generate` made: run.json, transcript.jsonl, and what is compared.
        runs: Where the new run's folder goes.
        progress: Told how far it is.
        device: In place of the recorded one.

    Raises:
        UserError: If the folder is no such run.
    """
    recorded = RunFolder.open(recorded).path
    facts = _facts(recorded)
    models = Models(**{role: facts["models"].get(role, BUILTIN) for role in ROLES})
    settings = Settings(**_known(Settings, facts.get("settings", {})) | ({"device": device} if device else {}))
    answers = Replay.of(recorded)
    reference = recorded / REFERENCE
    options = Options(
        settings=settings,
        models=models,
        budget=Budget(**_known(Budget, facts["budget"])),
        image=reference if reference.is_file() else None,
        candidates=facts.get("candidates", 1),
        confirm=facts.get("confirm", True),
        replay=answers,
    )
    # The builtin planner's, or a file's: a planner that is asked later changes it.
    given = not answers.left or answers.left[0].role != "planner"
    first = next((path for name in (FIRST_PLAN, "plan.json") if (path := recorded / name).is_file()), None)
    plan = load(first) if given and first is not None else None
    agreed = deque([True, *(bool(row.get("approved")) for row in facts.get("replans", []))])
    generated = generate(
        facts["prompt"], runs, options, lambda plan: agreed.popleft() if agreed else True, plan, progress
    )
    if answers.left:
        roles = ", ".join(exchange.role for exchange in answers.left)
        answers.divergences.append(f"{len(answers.left)} recorded exchanges were not asked for: {roles}")
    differing, same = _compare(recorded, generated.run.path)
    return Replayed(generated, answers.divergences, differing, same)


def _facts(recorded: Path) -> dict[str, Any]:
    try:
        facts = RunFolder(recorded).facts()
    except ValueError as error:
        raise UserError(f"{recorded}: run.json: not JSON: {error}") from error
    missing = [name for name in ("prompt", "models", "budget") if name not in facts]
    if missing:
        raise UserError(f"{recorded}: run.json lacks {', '.join(missing)}; give a run that wsim generate made")
    return facts


def _known(kind: Any, given: dict[str, Any]) -> dict[str, Any]:
    names = {field.name for field in fields(kind)}
    return {name: value for name, value in given.items() if name in names}


def _compare(recorded: Path, made: Path) -> tuple[list[str], int]:
    """Which of the recorded files came out otherwise, and how many did not."""
    paths = [recorded / name for name in COMPARED]
    for folder in sorted((recorded / "iterations").glob("[0-9]*")):
        paths += [folder / name for name in COMPARED_IN_ITERATIONS]
    differing, same = [], 0
    for path in paths:
        if not path.is_file():
            continue
        name = path.relative_to(recorded)
        other = made / name
        if not other.is_file():
            differing.append(f"{name}: was not made")
        elif (before := path.read_bytes()) != (after := other.read_bytes()):
            differing.append(f"{name}: {_first(before, after)}")
        else:
            same += 1
    return differing, same


def _first(before: bytes, after: bytes) -> str:
    old, new = (data.decode("utf-8", "replace").splitlines() for data in (before, after))
    for number, (a, b) in enumerate(zip(old, new, strict=False), start=1):
        if a != b:
            k = next((k for k, (x, y) in enumerate(zip(a, b, strict=False)) if x != y), min(len(a), len(b)))
            return f"line {number}: {b[max(k - 30, 0) : k + 50]!r}, where it was {a[max(k - 30, 0) : k + 50]!r}"
    return f"{len(new)} lines, where there were {len(old)}"
