"""What a run has left, to look at."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tests.agents.scripted import Server
from wsim.agents.models import ROLES, Models


def models(server: Server, *roles: str) -> Models:
    """The server's models for some roles, or for all."""
    return Models(**{role: server.model(role) for role in roles or ROLES})


@dataclass
class Kept:
    """What a run has left."""

    folder: Path

    @property
    def facts(self) -> dict[str, Any]:
        return json.loads((self.folder / "run.json").read_text())

    @property
    def rows(self) -> list[tuple[str, str, bool]]:
        """How far each iteration came, its status, and whether it was kept."""
        return [(row["reached"], row["status"], row["kept"]) for row in self.facts["iterations"]]

    def text(self, number: int, name: str = "program.py") -> str:
        return (self.folder / "iterations" / f"{number:02d}" / name).read_text()

    @property
    def numbers(self) -> list[str]:
        return sorted(path.name for path in (self.folder / "iterations").iterdir())
