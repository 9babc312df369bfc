"""A recording that is kept is read once, and is its file's as that is now."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from wsim import recording
from wsim.errors import UserError
from wsim.recording import RecordingWriter, kept
from wsim.scene.world import World


def written(path: Path, name: str) -> Path:
    with RecordingWriter(path, World(name=name)):
        pass
    return path


def test_it_is_read_once_while_it_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first, other = (written(tmp_path / f"{name}.rrd", name) for name in ("first", "other"))
    reads = []
    monkeypatch.setattr(kept, "read", lambda path: reads.append(path.name) or recording.read(path))
    with recording.keeping():
        found = recording.read_and_keep(first)
        assert recording.read_kept(other).world.name == "other"  # which does not take its place
        assert recording.read_kept(first) is found
        assert recording.read_kept(tmp_path / "." / "first.rrd") is found
        assert reads == ["first.rrd", "other.rrd"]
        assert recording.read_and_keep(other) is recording.read_kept(other)
        assert recording.read_kept(first) is not found
    assert recording.read_kept(first) is not recording.read_kept(first)
    assert recording.read_and_keep(first) is not recording.read_kept(first)


def test_a_file_that_was_written_anew_is_read_anew(tmp_path: Path) -> None:
    path = written(tmp_path / "a.rrd", "before")
    with recording.keeping():
        recording.read_and_keep(path)
        written(path, "after!")
        os.utime(path, ns=(1, path.stat().st_mtime_ns + 1))
        assert recording.read_kept(path).world.name == "after!"


def test_what_is_gone_is_told_as_ever(tmp_path: Path) -> None:
    path = written(tmp_path / "a.rrd", "gone")
    with recording.keeping():
        recording.read_and_keep(path)
        path.unlink()
        with pytest.raises(UserError, match="no recording"):
            recording.read_kept(path)
