"""The folder of a sweep: what was asked, what is done, the table.

runs/<time>-sweep-<name>/
  sweep.json  program.py …  plan.json  outcomes.jsonl  summary.json  table.parquet  table.csv  margins.png
  candidates/0007/     the run of candidate 7, as `wsim run` leaves it
"""

from __future__ import annotations

import fcntl
import os
import shutil
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from pydantic import ValidationError

from wsim.errors import UserError
from wsim.runs.folder import RunFolder, write_json, write_whole
from wsim.runs.named import named
from wsim.sweep.candidate import Outcome
from wsim.sweep.spec import Spec


class SweepFolder:
    """A sweep on disk. What is done stands in a line of outcomes.jsonl as soon as it is done.

    Args:
        path: An existing folder of a sweep.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)

    @classmethod
    def create(
        cls, base: str | Path, title: str, spec: Spec, programs: Sequence[Path], plan: str | None = None
    ) -> SweepFolder:
        """Make a new one under `base`.

        Args:
            base: Folder of runs.
            title: What the folder is named after.
            spec: What is asked; its `programs` become the names of the copies.
            programs: Files that are copied.
            plan: Text of plan.json.
        """
        folder = cls(RunFolder.create(base, f"sweep {title}").path)
        names = [program.name for program in programs]
        copies = [name if names.count(name) == 1 else f"{k:02d}-{name}" for k, name in enumerate(names, start=1)]
        for program, name in zip(programs, copies, strict=True):
            shutil.copyfile(program, folder.path / name)
        if plan is not None:
            write_whole(folder.path / "plan.json", plan)
        write_whole(folder.path / "sweep.json", spec.model_copy(update={"programs": copies}).model_dump_json(indent=2))
        return folder

    @classmethod
    def open(cls, path: str | Path) -> SweepFolder:
        """The sweep in a folder.

        Raises:
            UserError: If there is none.
        """
        found = named(Path(path))
        if not (found / "sweep.json").is_file():
            raise UserError(f"{path} is no sweep's folder (it has no sweep.json); `wsim runs` lists them")
        return cls(found)

    @property
    def spec(self) -> Spec:
        """What is asked.

        Raises:
            UserError: If sweep.json is not what it was.
        """
        try:
            return Spec.model_validate_json((self.path / "sweep.json").read_text(encoding="utf-8"))
        except (ValidationError, OSError, UnicodeDecodeError) as error:
            first = error.errors()[0] if isinstance(error, ValidationError) else {"loc": (), "msg": str(error)}
            where = ".".join(map(str, first["loc"]))
            raise UserError(f"{self.path / 'sweep.json'}: {where}: {first['msg']}") from error

    def outcomes(self) -> dict[int, Outcome]:
        """What is done, by the candidate's number. A line that was cut off as it was written counts as not done."""
        path, found = self.path / "outcomes.jsonl", {}
        # At line feeds alone, and a line's bytes by themselves: a reason may hold any character, and be cut off in it.
        for line in path.read_bytes().split(b"\n") if path.is_file() else ():
            try:
                outcome = Outcome.model_validate_json(line)
            except ValidationError:
                continue
            found[outcome.candidate.number] = outcome
        return found

    @contextmanager
    def taken(self) -> Iterator[None]:
        """Nobody else of this machine works in the folder meanwhile.

        Raises:
            UserError: If somebody does.
        """
        handle = os.open(self.path, os.O_RDONLY)
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise UserError(f"another wsim sweep works in {self.path}; wait until it ends, or stop it") from error
        else:
            yield
        finally:
            os.close(handle)

    def add(self, outcome: Outcome) -> None:
        """Keep an outcome."""
        with (self.path / "outcomes.jsonl").open("ab+") as file:
            if file.tell():
                file.seek(-1, os.SEEK_END)
            cut = file.read(1) not in (b"", b"\n")
            file.write((("\n" if cut else "") + outcome.model_dump_json() + "\n").encode())

    def finish(self, best_first: Sequence[Outcome]) -> None:
        """Say in summary.json that all is done, how many came out how, and which is the best."""
        counts = Counter(outcome.status for outcome in best_first)
        best = best_first[0].model_dump(mode="json") if best_first else None
        write_json(self.path / "summary.json", {"counts": dict(counts), "best": best})

    @property
    def finished(self) -> bool:
        """Whether nothing is left to run."""
        return (self.path / "summary.json").is_file()

    def candidate(self, number: int) -> Path:
        """Where a candidate's own run is, if there is one."""
        return self.path / "candidates" / f"{number:04d}"

    def run_of(self, number: int) -> RunFolder:
        """The folder of a candidate that is run in full; an older one goes."""
        path = self.candidate(number)
        shutil.rmtree(path, ignore_errors=True)
        path.mkdir(parents=True)
        return RunFolder(path)
