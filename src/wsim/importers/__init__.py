"""Recordings that others made, read as if wsim had made them: so that the judge can look at any simulation."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsim.door import door

if TYPE_CHECKING:
    from wsim.importers.trajectory import read_npz, save

__all__ = ["read_npz", "save"]

__getattr__ = door(__name__, {"read_npz": "trajectory", "save": "trajectory"})
