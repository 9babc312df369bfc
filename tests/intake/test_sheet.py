"""A sheet is closed and has the volume of its face times its thickness."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from wsim.intake.model import Mesh
from wsim.intake.sheet import thickened


def test_a_plate_has_its_area_times_its_thickness() -> None:
    points = np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0], [0.0, 1.0, 0.0]])
    sheet = thickened(Mesh("plate", points, np.array([[0, 1, 2], [0, 2, 3]])), 0.1)
    assert trimesh.Trimesh(sheet.points, sheet.faces).is_watertight
    assert sheet.volume == pytest.approx(0.2)


def test_half_a_sphere_has_its_area_times_its_thickness() -> None:
    ball = trimesh.creation.icosphere(subdivisions=4)
    half = np.asarray(ball.faces)[np.asarray(ball.triangles_center)[:, 2] < 0.0]
    used, faces = np.unique(half, return_inverse=True)
    mesh = Mesh("half", np.asarray(ball.vertices)[used], faces.reshape(-1, 3))
    sheet = thickened(mesh, 0.02)
    assert trimesh.Trimesh(sheet.points, sheet.faces).is_watertight
    assert sheet.volume == pytest.approx(0.02 * trimesh.Trimesh(mesh.points, mesh.faces).area, rel=1e-2)


def test_faces_that_cancel_out_move_no_corner() -> None:
    points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    sheet = thickened(Mesh("folded", points, np.array([[0, 1, 2], [2, 1, 0]])), 0.1)
    assert np.isfinite(sheet.points).all()
    assert sheet.points[:3] == pytest.approx(points)
