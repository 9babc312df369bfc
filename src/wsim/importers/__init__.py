"""Recordings that others made, read as if wsim had made them: so that the judge can look at any simulation."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    from wsim.recording import Recording

__all__ = ["read_npz"]


def read_npz(path: str | Path, model: str | Path | None = None) -> Recording:
    """Read a MuJoCo or Newton trajectory; see `wsim.importers.trajectory.read_npz`."""
    from wsim.importers.trajectory import read_npz

    return read_npz(path, model)
