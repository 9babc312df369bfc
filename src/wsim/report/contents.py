"""What a run left in its folder, as far as it got."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from wsim import recording
from wsim.errors import UserError
from wsim.judge.verdict import Verdict
from wsim.plan.schema import Plan
from wsim.plan.store import load
from wsim.runs.folder import RunFolder
from wsim.runs.records import Acceptance, Loop, Review, review_of, sums_of

if TYPE_CHECKING:
    from wsim.recording import Recording

T = TypeVar("T")
LONGEST_NOTE = 400


@dataclass(frozen=True)
class Iteration:
    """One pass over a program."""

    folder: Path
    verdict: Verdict | None
    checks: dict[str, Any]
    program: str | None
    patch: str | None  # what it changes in the one that it was made from
    review: Review | None

    @property
    def number(self) -> str:
        """The folder's name: 01, 02, …"""
        return self.folder.name

    @property
    def index(self) -> int:
        """Its number, from 1."""
        return int(self.folder.name)

    def build(self) -> dict[str, Any]:
        """What checks.json says of the build, empty if nothing."""
        return _section(self.checks, "build")

    def simulation(self) -> dict[str, Any]:
        """What checks.json says of the simulation, empty if nothing."""
        return _section(self.checks, "simulation")

    def seconds(self) -> dict[str, Any]:
        """Wall time [s] by stage."""
        return _section(self.checks, "seconds")


@dataclass(frozen=True)
class RunContents:
    """A run's files, read. What is missing is None; what is there but cannot be read is in `notes`."""

    run: RunFolder
    facts: dict[str, Any]
    plan: Plan | None
    iterations: list[Iteration]
    recording: Recording | None
    notes: list[str] = field(default_factory=list)
    loop: Loop = field(default_factory=Loop)
    shown: Iteration | None = None  # the one that is reported: the best, else the newest
    acceptance: Acceptance | None = None
    plan_diff: str | None = None  # where the plan was changed on the way

    @property
    def newest(self) -> Iteration | None:
        """The newest iteration."""
        return self.iterations[-1] if self.iterations else None

    @property
    def verdict(self) -> Verdict | None:
        """The verdict of the iteration that is reported."""
        return self.shown.verdict if self.shown else None

    @property
    def target(self) -> Path:
        """What commands are given: the run's folder, or the reported iteration's where they would take another."""
        return self.run.path if self.shown is None or self.shown is self.newest else self.shown.folder


def gather(run_dir: Path) -> RunContents:
    """Read a run's folder.

    Raises:
        UserError: There is no such folder.
    """
    if not run_dir.is_dir():
        raise UserError(f"{run_dir} is not a folder; give the folder of a run")
    notes: list[str] = []
    folders = [path for path in (run_dir / "iterations").glob("[0-9]*") if path.is_dir() and path.name.isdecimal()]
    iterations = [_iteration(folder, notes) for folder in sorted(folders, key=lambda folder: int(folder.name))]
    facts = _read(run_dir / "run.json", _object, notes) or {}
    loop = _read(run_dir / "run.json", _loop, notes) if facts else None
    best = [item for item in iterations if loop is not None and item.index == loop.best]
    shown = next(iter(best), iterations[-1] if iterations else None)
    recording = _read(shown.folder / "recording.rrd", _recording, notes) if shown is not None else None
    if recording is not None and not recording.complete:
        error = recording.metadata.get("error") or "the run ended early"
        notes.append(f"The recording is incomplete: {_short(error)}")
    return RunContents(
        run=RunFolder(run_dir),
        facts=facts,
        plan=_read(run_dir / "plan.json", _plan, notes),
        iterations=iterations,
        recording=recording,
        notes=notes,
        loop=loop or Loop(),
        shown=shown,
        plan_diff=_read(run_dir / "plan.diff", _text, notes),
        acceptance=_read(run_dir / "accepted" / "acceptance.json", _acceptance, notes),
    )


def _iteration(folder: Path, notes: list[str]) -> Iteration:
    return Iteration(
        folder=folder,
        verdict=_read(folder / "verdict.json", _verdict, notes),
        checks=_read(folder / "checks.json", _object, notes) or {},
        program=_read(folder / "program.py", _text, notes),
        patch=_read(folder / "patch.diff", _text, notes),
        review=_read(folder / "review.json", _review, notes),
    )


def _read(path: Path, load: Callable[[Path], T], notes: list[str]) -> T | None:
    """A file's content; None if it is not there, or cannot be read, which is then noted."""
    if not path.is_file():
        return None
    try:
        return load(path)
    except (OSError, ValueError, UserError) as error:
        notes.append(f"{path.name} of {path.parent.name} cannot be read: {_short(error)}")
        return None


def _text(path: Path) -> str:
    return path.read_text(encoding="utf-8", errors="replace")


def _object(path: Path) -> dict[str, Any]:
    data = json.loads(_text(path))
    if not isinstance(data, dict):
        raise ValueError(f"a JSON object was expected, not {type(data).__name__}")
    return data


def _verdict(path: Path) -> Verdict:
    return Verdict.model_validate_json(_text(path))


def _loop(path: Path) -> Loop:
    return Loop.model_validate(_object(path))


def _review(path: Path) -> Review | None:
    return review_of(_object(path))


def _acceptance(path: Path) -> Acceptance:
    folder = path.parent
    stamped = {"program": _text(folder / "program.py"), "sums": sums_of(_text(folder / "SHA256SUMS"))}
    return Acceptance.model_validate(_object(path) | stamped)


def _plan(path: Path) -> Plan:
    return load(path)


def _recording(path: Path) -> Recording:
    return recording.read_kept(path)


def _section(checks: dict[str, Any], name: str) -> dict[str, Any]:
    part = checks.get(name)
    return part if isinstance(part, dict) else {}


def _short(error: object) -> str:
    text = str(error)
    return text if len(text) <= LONGEST_NOTE else text[:LONGEST_NOTE] + " …"
