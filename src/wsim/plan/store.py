"""Plans on disk."""

from __future__ import annotations

import json
from pathlib import Path

from pydantic import ValidationError

from wsim.errors import UserError
from wsim.plan.layout import LayoutError, layout
from wsim.plan.schema import Plan, explain


def load(path: str | Path) -> Plan:
    """Read and validate a plan; where an object that takes up space lacks its pose, lay the plan out.

    Raises:
        UserError: the file cannot be read, is not JSON, is not a plan, or cannot be laid out; one line that names the
            place in the file.
    """
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise UserError(f"{path}: cannot be read: {error}") from error
    try:
        data = json.loads(text)
    except json.JSONDecodeError as error:
        raise UserError(f"{path}: not JSON: {error.msg} at line {error.lineno}, column {error.colno}") from error
    try:
        plan = Plan.model_validate(data)
    except ValidationError as error:
        raise UserError(f"{path}: not a plan: {explain(error)}") from error
    if all(item.pose is not None or item.primitive in ("ground", "fluid") for item in plan.objects):
        return plan
    try:
        return layout(plan)
    except LayoutError as error:
        raise UserError(f"{path}: {error}") from error


def save(plan: Plan, path: str | Path) -> None:
    """Write a plan as JSON, to a side name first, so that no reader sees half of it."""
    path = Path(path)
    side = path.with_name(path.name + ".part")
    side.write_text(plan.model_dump_json(indent=2) + "\n", encoding="utf-8")
    side.replace(path)
