"""CoACD's process has its limits, and what it found is kept; the lattice measures what geometry says."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import trimesh

from tests.intake import models
from wsim.intake.fit import few_corners
from wsim.intake.lattice import Lattice
from wsim.intake.measure import hausdorff
from wsim.intake.model import Collider, Mesh
from wsim.intake.parts import cache_folder, decompose


def mesh_of(made: trimesh.Trimesh) -> Mesh:
    return Mesh("m", np.asarray(made.vertices), np.asarray(made.faces))


def test_a_process_that_takes_too_long_or_too_much_is_ended(own: Path) -> None:
    bowl = mesh_of(models.bowl())
    assert decompose(bowl, 0.002, seconds=0.5) == "CoACD took more than 0.5 s"
    said = decompose(bowl, 0.002, memory=1 << 26)
    assert isinstance(said, str) and said.startswith("CoACD ")
    assert list(cache_folder().glob("*.npz")) == []


def test_parts_are_kept_by_content_and_settings(own: Path) -> None:
    ring = mesh_of(trimesh.creation.torus(major_radius=0.1, minor_radius=0.03, major_sections=12, minor_sections=8))
    parts = decompose(ring, 0.02)
    assert len(parts) > 2
    assert len(list(cache_folder().glob("*.npz"))) == 1
    again = decompose(ring, 0.02, seconds=1e-3)  # no process could be that quick
    assert all(np.array_equal(one, other) for one, other in zip(parts, again, strict=True))
    assert decompose(ring, 0.01, seconds=1e-3) == "CoACD took more than 0.001 s"


def test_a_broken_cache_is_made_again(own: Path) -> None:
    box = mesh_of(models.box())
    decompose(box, 0.02)
    (kept,) = cache_folder().glob("*.npz")
    kept.write_bytes(b"PK\x03\x04 torn")
    assert len(decompose(box, 0.02)) == 1


def test_what_lies_in_the_current_folder_is_not_run(own: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "wsim.py").write_text("open('ran', 'w').close()\n")
    monkeypatch.chdir(tmp_path)
    assert len(decompose(mesh_of(models.box()), 0.02)) == 1
    assert not (tmp_path / "ran").exists()


def test_the_lattice_counts_a_ball_and_its_shell() -> None:
    ball, inner = trimesh.creation.icosphere(4, radius=1.0), trimesh.creation.icosphere(4, radius=0.7)
    lattice = Lattice.around(np.asarray(ball.vertices))
    filled = lattice.inside(mesh_of(ball)).sum() * lattice.volume
    assert filled == pytest.approx(4.0 / 3.0 * math.pi, rel=0.01)
    shell = trimesh.util.concatenate([ball, inner.copy()])
    shell.faces[len(ball.faces) :] = shell.faces[len(ball.faces) :, ::-1]
    filled = lattice.inside(mesh_of(shell)).sum() * lattice.volume
    assert filled == pytest.approx(4.0 / 3.0 * math.pi * (1.0 - 0.7**3), rel=0.01)


def test_the_distance_of_surfaces_is_the_largest_gap() -> None:
    box = mesh_of(trimesh.creation.box(extents=(1.0, 1.0, 1.0)))
    assert hausdorff(box, [Collider("box", (1.0, 1.0, 1.0))]) == pytest.approx(0.0, abs=1e-9)
    assert hausdorff(box, [Collider("box", (1.0, 1.0, 1.2))]) == pytest.approx(0.1, abs=1e-3)
    halves = [Collider("box", (0.5, 1.0, 1.0), center=np.array([x, 0.0, 0.0])) for x in (-0.25, 0.25)]
    assert hausdorff(box, halves) == pytest.approx(0.0, abs=1e-9)


def test_few_corners_bound_nearly_all() -> None:
    ball = np.asarray(trimesh.creation.icosphere(4, radius=1.0).vertices)
    few = few_corners(ball)
    assert len(few) <= 64
    assert trimesh.convex.convex_hull(few).volume > 0.88 * 4.0 / 3.0 * math.pi
