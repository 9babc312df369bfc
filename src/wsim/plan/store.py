"""Plans on disk."""

from __future__ import annotations

import json
from pathlib import Path

from pydantic import ValidationError

from wsim.errors import UserError
from wsim.plan.schema import Plan, explain


def load(path: str | Path) -> Plan:
    """Read and validate a plan.

    Raises:
        UserError: the file cannot be read, is not JSON, or is not a plan; one line that names the place in the file.
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
        return Plan.model_validate(data)
    except ValidationError as error:
        raise UserError(f"{path}: not a plan: {explain(error)}") from error


def save(plan: Plan, path: str | Path) -> None:
    """Write a plan as JSON, to a side name first, so that no reader sees half of it."""
    path = Path(path)
    side = path.with_name(path.name + ".part")
    side.write_text(plan.model_dump_json(indent=2) + "\n", encoding="utf-8")
    side.replace(path)
