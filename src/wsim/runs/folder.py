"""The folder of a run: what lies where, and files that are whole or not there."""

from __future__ import annotations

import hashlib
import json
import re
import shutil
from datetime import datetime
from pathlib import Path
from typing import Any

from wsim.errors import UserError
from wsim.program.patch import diff
from wsim.runs.named import named

SLUG_LENGTH = 40


def write_whole(path: Path, text: str) -> None:
    """Write a text file under a side name, then rename it: a reader never sees half of it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(path.name + ".partial")
    partial.write_text(text, encoding="utf-8")
    partial.replace(path)


def write_json(path: Path, data: Any) -> None:
    """Write JSON that a person can read; whole or not at all."""
    write_whole(path, json.dumps(data, indent=2, ensure_ascii=False) + "\n")


def slug(text: str) -> str:
    """A short folder name made of a text's first words."""
    words = re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-")
    if len(words) > SLUG_LENGTH:
        words = words[:SLUG_LENGTH].rsplit("-", 1)[0]
    return words or "run"


def _dangling(path: Path) -> Path | None:
    """The link at or above a path that leads nowhere; None if there is none."""
    return next((each for each in (path, *path.parents) if each.is_symlink() and not each.exists()), None)


def check_base(base: Path) -> None:
    """Refuse a folder for runs that none can be made in; nothing is made, and nothing heavy loaded to find it out.

    Raises:
        UserError: A link at or above it leads nowhere, or what is there is no folder.
    """
    if (dangling := _dangling(base)) is not None:
        raise UserError(f"{dangling} is a link to {dangling.readlink()}, which is not there; name another with --runs")
    there = next((path for path in (base, *base.parents) if path.exists()), base)
    if there.exists() and not there.is_dir():
        raise UserError(f"cannot make a run folder in {base}: {there} is a file; choose another with --runs")


class RunFolder:
    """runs/<time>-<slug>/ with run.json, plan.json, transcript.jsonl, report.html, iterations/NN/ and accepted/.

    Args:
        path: An existing folder of a run.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)

    @classmethod
    def create(cls, base: str | Path, title: str) -> RunFolder:
        """Make a new folder under `base`; never one that exists."""
        stem = f"{datetime.now():%Y%m%d-%H%M%S}-{slug(title)}"
        check_base(Path(base))
        for k in range(1, 1000):
            path = Path(base) / (stem if k == 1 else f"{stem}-{k}")
            try:
                path.mkdir(parents=True)
            except FileExistsError:
                continue
            except OSError as error:
                raise UserError(
                    f"cannot make a run folder at {path}: {error.strerror}; choose another with --runs"
                ) from error
            return cls(path)
        raise UserError(f"{base} already holds a thousand runs of this second; choose another folder with --runs")

    @classmethod
    def open(cls, path: str | Path) -> RunFolder:
        """The run that a path belongs to: its folder, or anything inside it.

        Raises:
            UserError: If there is no run there.
        """
        start = named(Path(path))
        if not start.exists():
            raise UserError(f"{path} does not exist; `wsim runs` lists the runs of this folder")
        for folder in (start, *start.resolve().parents):
            if (folder / "run.json").is_file() or (folder / "iterations").is_dir():
                return cls(folder)
        if (start / "sweep.json").is_file():
            runs = sorted(each.name for each in (start / "candidates").glob("[0-9]*"))
            own = (
                f"name a candidate's, such as {start / 'candidates' / runs[0]}"
                if runs
                else "none of it was run in full"
            )
            raise UserError(f"{path} is a sweep, not a run: {own}; `wsim view` shows all, its report.html tells of it")
        raise UserError(f"{path} is not in a run's folder (no run.json beside it or above it)")

    def iteration(self, number: int) -> Path:
        """Folder of an iteration, counted from 1; made if it is not there."""
        path = self.path / "iterations" / f"{number:02d}"
        path.mkdir(parents=True, exist_ok=True)
        return path

    def last_iteration(self) -> Path:
        """Folder of the newest iteration.

        Raises:
            UserError: If the run has none.
        """
        found = self.iterations()
        if not found:
            raise UserError(f"{self.path} has no iterations: the run ended before its program was built")
        return found[-1]

    def record(self, **facts: Any) -> None:
        """Add facts to run.json."""
        path = self.path / "run.json"
        known = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}
        write_json(path, {**known, **facts})

    def facts(self) -> dict[str, Any]:
        """What run.json holds."""
        path = self.path / "run.json"
        return json.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}

    def iterations(self) -> list[Path]:
        """Folders of all iterations, the oldest first."""
        found = (path for path in (self.path / "iterations").glob("[0-9]*") if path.name.isdigit())
        return sorted(found, key=lambda path: int(path.name))

    def add(self, program: str, before: str | None = None) -> Path:
        """A new iteration that holds a program; its folder is whole or not there.

        Args:
            program: The text of program.py.
            before: The text that it was patched from; the difference becomes patch.diff.
        """
        known = self.iterations()
        number = int(known[-1].name) + 1 if known else 1
        folder = self.path / "iterations" / f"{number:02d}"
        partial = folder.with_name(f".{folder.name}.partial")
        shutil.rmtree(partial, ignore_errors=True)
        partial.mkdir(parents=True)
        (partial / "program.py").write_text(program, encoding="utf-8")
        if before is not None:
            (partial / "patch.diff").write_text(diff(before, program), encoding="utf-8")
        partial.rename(folder)
        return folder

    def stamp(self, source: Path, acceptance: dict[str, Any] | None = None) -> Path:
        """Copy a folder's program and stage to accepted/, with their checksums; what was accepted before goes.

        Args:
            source: The folder.
            acceptance: What acceptance.json says of them, if anything.
        """
        target, partial = self.path / "accepted", self.path / "accepted.partial"
        shutil.rmtree(partial, ignore_errors=True)
        partial.mkdir()
        sums = []
        for name in ("program.py", "stage.usda"):
            shutil.copyfile(source / name, partial / name)
            sums.append(f"{hashlib.sha256((partial / name).read_bytes()).hexdigest()}  {name}\n")
        if acceptance is not None:
            write_json(partial / "acceptance.json", acceptance)
        write_whole(partial / "SHA256SUMS", "".join(sums))
        shutil.rmtree(target, ignore_errors=True)
        partial.rename(target)
        return target
