"""The recording that was judged, kept for who holds it against another and who reports it: each would read it anew."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path

from wsim.recording.reader import read
from wsim.recording.recording import Recording

Known = tuple[Path, int, int]  # a file as it is: its path, when it was written [ns], bytes

_kept: list[dict[Known, Recording]] = []  # of those who keep, the innermost last; one recording at most in each


@contextlib.contextmanager
def keeping() -> Iterator[None]:
    """Within, `read_kept` gives what `read_and_keep` read last, as long as its file is what it was."""
    _kept.append({})
    try:
        yield
    finally:
        _kept.pop()


def read_and_keep(path: Path) -> Recording:
    """Read a recording, and keep it where someone is keeping; raises as `read` does."""
    if not _kept:
        return read(path)
    _kept[-1].clear()  # not two at a time
    found = read(path)
    _kept[-1][_known(path)] = found
    return found


def read_kept(path: Path) -> Recording:
    """The one that was kept, or the file's; nobody writes into its arrays. Raises as `read` does."""
    found = _kept[-1].get(_known(path)) if _kept and path.is_file() else None
    return read(path) if found is None else found


def _known(path: Path) -> Known:
    stat = path.stat()
    return path.resolve(), stat.st_mtime_ns, stat.st_size
