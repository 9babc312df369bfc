"""A copy of a sweep's folder wherever fsspec reaches: an object store, another machine, memory.

A sweep works in a folder of this machine, and what it finds is sent as it comes: of outcomes.jsonl what is new, as a
part of its own, since an object store appends to nothing and renames nothing; all other files when the sweep ends. A
part is named by where it begins, so that parts in the order of their names are the file.
"""

from __future__ import annotations

import shutil
import time
from pathlib import Path
from typing import TYPE_CHECKING

from wsim.errors import UserError
from wsim.runs.folder import write_whole
from wsim.sweep.folder import SweepFolder

if TYPE_CHECKING:
    from fsspec import AbstractFileSystem

EVERY = 10.0  # [s] between parts: a store is asked for some thousand things a second, not for each outcome of a cluster
OUTCOMES = "outcomes.jsonl"
PARTS = "outcomes"


class Store:
    """The copy of one sweep.

    Args:
        url: Where it is, as fsspec names it: s3://bucket/sweeps/name, memory://name, /mnt/shared/name.
        every: Seconds between parts [s].

    Raises:
        UserError: If that is nothing that can be reached from here.
    """

    def __init__(self, url: str, every: float = EVERY) -> None:
        self.url, self._every = url.rstrip("/"), every
        self._files, self._root = _reached(self.url)
        self._sent, self._when = 0, -every
        self._known: dict[str, float] = {}  # files that are there, by when they were changed here

    def part(self, folder: SweepFolder, now: float | None = None) -> None:
        """Send what outcomes.jsonl has more than when it was sent last, if that is long enough ago.

        A store that does not answer stops no sweep: what was not sent goes with the next part, at the latest with
        `rest`, which says so.
        """
        now = time.monotonic() if now is None else now
        if now - self._when < self._every:
            return
        self._when = now
        try:
            self._part(folder.path)
        except OSError:
            return

    def rest(self, folder: SweepFolder) -> None:
        """Send all that is not there yet.

        Raises:
            UserError: If the store does not take it; the folder on this machine is whole.
        """
        try:
            self._part(folder.path)
            for path in sorted(folder.path.rglob("*")):
                name, changed = path.relative_to(folder.path).as_posix(), path.stat().st_mtime
                if path.is_file() and name != OUTCOMES and self._known.get(name) != changed:
                    self._put(name, path.read_bytes())
                    self._known[name] = changed
        except OSError as error:
            raise UserError(f"{self.url} does not take the sweep ({error}); it is whole in {folder.path}") from error

    def fetch(self, runs: Path) -> SweepFolder:
        """The sweep that the store has, in a folder of this machine: it goes on from there.

        Args:
            runs: Folder of runs, in which it has the name that it has in the store.

        Raises:
            UserError: If no sweep is there, or the folder is here already.
        """
        path = runs / self._root.rsplit("/", 1)[-1]
        try:
            names = [name.removeprefix(self._root).lstrip("/") for name in self._files.find(self._root)]
            if "sweep.json" not in names:
                raise UserError(f"{self.url} is no sweep's folder (it has no sweep.json)")
            if outside := [name for name in names if ".." in name.split("/") or name.startswith("/")]:
                raise UserError(f"{self.url} holds {outside[0]!r}, which lies outside of the sweep's folder")
            if path.exists():
                raise UserError(f"{path} is here already; go on with it: --resume {path}, with --store for the copy")
            partial = path.with_name(f".{path.name}.partial")  # what is cut off is no sweep to go on with
            shutil.rmtree(partial, ignore_errors=True)
            for name in names:
                if not name.startswith(f"{PARTS}/"):
                    (partial / name).parent.mkdir(parents=True, exist_ok=True)
                    (partial / name).write_bytes(self._files.cat_file(f"{self._root}/{name}"))
                    self._known[name] = (partial / name).stat().st_mtime
            write_whole(partial / OUTCOMES, self._outcomes(names))
            partial.rename(path)
        except OSError as error:
            raise UserError(f"{self.url} cannot be fetched: {error}") from error
        self._sent = (path / OUTCOMES).stat().st_size
        return SweepFolder(path)

    def _part(self, folder: Path) -> None:
        path = folder / OUTCOMES
        if not path.is_file():
            return
        with path.open("rb") as file:
            file.seek(self._sent)
            new = file.read()
        if new := new[: new.rfind(b"\n") + 1]:
            self._put(f"{PARTS}/{self._sent:012d}.jsonl", new)
            self._sent += len(new)

    def _put(self, name: str, content: bytes) -> None:
        path = f"{self._root}/{name}"
        try:
            self._files.pipe_file(path, content)
        except FileNotFoundError:  # a store of folders, which an object store has none of
            self._files.makedirs(path.rsplit("/", 1)[0], exist_ok=True)
            self._files.pipe_file(path, content)

    def _outcomes(self, names: list[str]) -> str:
        parts = sorted(name for name in names if name.startswith(f"{PARTS}/"))
        texts = [self._files.cat_file(f"{self._root}/{name}").decode(errors="replace") for name in parts]
        return "".join(text if text.endswith("\n") else f"{text}\n" for text in texts if text)


def _reached(url: str) -> tuple[AbstractFileSystem, str]:
    from fsspec.core import url_to_fs  # loads slowly; only a sweep with a store needs it

    try:
        files, root = url_to_fs(url)
    except (ImportError, ValueError) as error:
        raise UserError(f"{url} cannot be reached: {error}") from error
    return files, root.rstrip("/")
