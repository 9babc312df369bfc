"""Read URDF and MJCF."""

from __future__ import annotations

from pathlib import Path

from wsim.intake.model import IntakeError, Model


def read_mujoco(path: Path) -> Model:
    """Bodies, joints and masses of a URDF or MJCF file."""
    raise IntakeError(f"file = {path.name}: URDF and MJCF are not read yet; export its meshes as .glb, one body a file")
