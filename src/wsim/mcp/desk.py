"""The desk that a client works at, and the run that is open on it."""

from __future__ import annotations

import difflib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from wsim.errors import UserError
from wsim.progress import Progress, silent
from wsim.runs.folder import RunFolder
from wsim.runs.settings import Settings
from wsim.tools.base import Result, Tool, Workspace

NOT_OPEN = "no-run-is-open"  # a folder that is never made
HOW_TO_OPEN = "No run is open: call make_plan or new_run to start one, or open_run for one that exists."
SHOWN = 5  # runs that are named where one was not found


@dataclass
class Desk:
    """Where runs are kept, how their programs are run, and the run that is open.

    A server has one desk, and a desk has one run open: so no tool needs an argument that says which run is meant, which
    a model could leave out or make up, and then work on the wrong world. Two agents at once start a server each.
    """

    runs: Path
    settings: Settings = field(default_factory=Settings)
    run: RunFolder | None = None

    def start(self, title: str) -> RunFolder:
        """Make a new run's folder, and open it."""
        self.run = RunFolder.create(self.runs, title)
        self.run.record(title=title)
        return self.run

    def open(self, name: str = "") -> RunFolder:
        """Open a run by the name of its folder; without a name, the newest.

        Raises:
            UserError: If there is no such run.
        """
        known = self._known()
        if not known:
            raise UserError(f"{self.runs} has no runs yet; call make_plan or new_run to start one")
        chosen = name or known[0]
        if chosen not in known:
            near = difflib.get_close_matches(chosen, known, n=SHOWN, cutoff=0.5) or known[:SHOWN]
            raise UserError(f"run: there is no {chosen!r} in {self.runs}; there is {', '.join(near)}")
        self.run = RunFolder(self.runs / chosen)
        return self.run

    def call(self, tool: Tool, arguments: dict[str, Any], progress: Progress = silent) -> Result:
        """Call a tool on the open run; one that needs none works without."""
        if self.run is None and tool.needs_run:
            return Result(HOW_TO_OPEN, ok=False)
        run = self.run or RunFolder(self.runs / NOT_OPEN)
        return tool(Workspace(run, self.settings, progress), **arguments)

    def _known(self) -> list[str]:
        """Names of the runs there are, the newest first: a name begins with its time."""
        if not self.runs.is_dir():
            return []
        return sorted((path.name for path in self.runs.iterdir() if (path / "run.json").is_file()), reverse=True)
