"""What a tool is: a name, arguments that are checked, and a short answer."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel, ConfigDict, ValidationError

from wsim.errors import UserError
from wsim.plan.store import load
from wsim.progress import Progress, silent
from wsim.runs.settings import Settings
from wsim.tools.text import capped, relative

if TYPE_CHECKING:
    from wsim.plan.schema import Plan
    from wsim.runs.folder import RunFolder


class Arguments(BaseModel):
    """What a tool is called with; every field has a description, which a model reads."""

    model_config = ConfigDict(extra="forbid")


@dataclass(frozen=True)
class Result:
    """A tool's answer: a few lines of text, and a picture where it made one."""

    text: str
    ok: bool = True
    image: Path | None = None


@dataclass
class Workspace:
    """What tools work on: a run's folder, how its programs are run, and who is told how far a slow one is."""

    run: RunFolder
    settings: Settings = field(default_factory=Settings)
    progress: Progress = silent  # may raise: so is a slow tool stopped

    @property
    def plan(self) -> Plan | None:
        """The run's plan, if it has one."""
        path = self.run.path / "plan.json"
        if not path.is_file():
            return None
        return load(path)


@dataclass(frozen=True)
class Tool:
    """A deterministic tool: the same function for agents, the command line and MCP."""

    name: str
    description: str
    arguments: type[Arguments]
    call: Callable[[Workspace, Any], Result]
    writes: bool = False  # it changes the run's folder
    needs_run: bool = True  # it works on a run's folder
    narrow: str = ""  # how to ask for less, where an answer is cut

    def __call__(self, workspace: Workspace, /, **given: Any) -> Result:
        """Check the arguments and run; a user's mistake is an answer, not an exception.

        The answer is cut at `wsim.tools.text.LIMIT` characters, and names no folder of this machine.
        """
        try:
            result = self.call(workspace, self.arguments.model_validate(given))
        except ValidationError as error:
            result = Result(f"{self.name}: {self._first(error)}", ok=False)
        except UserError as error:
            result = Result(f"{self.name}: {error}", ok=False)
        return replace(result, text=capped(relative(result.text, workspace.run.path), self.narrow))

    def _first(self, error: ValidationError) -> str:
        """The first mistake in the arguments, and what the tool takes."""
        problem = error.errors(include_url=False)[0]
        where = ".".join(str(part) for part in problem["loc"]) or "arguments"
        return f"{where}: {problem['msg']}; it takes {', '.join(self.arguments.model_fields) or 'no arguments'}"
