"""Outlines against areas and depths that are known."""

import math

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from wsim.geometry.outlines import outline_of
from wsim.geometry.surfaces import Surface, arc, box_surface, revolved

HALF_TURN = np.array([0.0, 0.0, 0.0, 1.0])


def quaternion(numbers: list[float]) -> np.ndarray:
    q = np.array(numbers)
    return q / np.linalg.norm(q) if np.linalg.norm(q) > 0.1 else HALF_TURN


turns = st.lists(st.floats(-1.0, 1.0), min_size=4, max_size=4).map(quaternion)


@settings(max_examples=25, deadline=None)
@given(turns, st.floats(-1.2, 1.2))
def test_a_ball_is_cut_in_a_disc_however_it_is_turned(q, off):
    ball = revolved(*arc(1.0, 0.0, 128), volume=4.0 / 3.0 * math.pi, around=128)
    found = outline_of(ball.turned(q, np.array([0.5, off, -0.2])))
    area = math.pi * max(0.0, 1.0 - off**2)
    assert found.area == pytest.approx(area, abs=4e-3)
    if area > 0.1:
        assert found.centroid == pytest.approx([0.5, -0.2], abs=2e-3)
        points = np.random.default_rng(0).uniform(-2.0, 2.0, (50, 2))
        expected = math.sqrt(1.0 - off**2) - np.hypot(points[:, 0] - 0.5, points[:, 1] + 0.2)
        assert found.depth(points) == pytest.approx(expected, abs=4e-3)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10**6), turns)
def test_a_convex_solid_is_cut_as_a_polygon_of_half_planes(seed, q):
    """Depth in a convex polygon is the least distance from its sides, wherever that is inside."""
    hull = trimesh.convex.convex_hull(np.random.default_rng(seed).normal(size=(12, 3)))
    surface = Surface(np.asarray(hull.vertices), np.asarray(hull.faces, dtype=np.intp)).turned(q)
    found = outline_of(surface)
    assert len(found.segments) > 2
    along = found.segments[:, 1] - found.segments[:, 0]
    out = np.stack([along[:, 1], -along[:, 0]], axis=1) / np.linalg.norm(along, axis=1)[:, None]
    points = np.random.default_rng(seed).uniform(-2.0, 2.0, (200, 2))
    within = -np.einsum("nsk,sk->ns", points[:, None] - found.segments[:, 0], out).max(axis=1)
    depth = found.depth(points)
    assert (np.abs(within) < 1e-9).any() or ((depth > 0.0) == (within > 0.0)).all()
    assert depth[within > 0.0] == pytest.approx(within[within > 0.0], abs=1e-9)


def test_a_ring_is_cut_twice_and_its_hole_is_outside():
    ring = trimesh.creation.torus(2.0, 0.5, major_sections=96, minor_sections=96)
    found = outline_of(Surface(np.asarray(ring.vertices), np.asarray(ring.faces, dtype=np.intp)))
    assert found.area == pytest.approx(2.0 * math.pi * 0.25, rel=3e-3)
    assert found.depth(np.array([[2.0, 0.0], [-2.0, 0.0], [0.0, 0.0]])) == pytest.approx([0.5, 0.5, -1.5], abs=2e-3)


def test_a_face_in_the_plane_adds_no_line_of_its_own():
    """A box that stands on the plane is cut, or is not, but not in part."""
    areas = {}
    for y in (-0.6, -0.5, 0.0, 0.5, 0.6):
        areas[y] = outline_of(box_surface((1.0, 1.0, 2.0)).turned(HALF_TURN, np.array([0.0, y, 0.0]))).area
    assert areas == pytest.approx({-0.6: 0.0, -0.5: 2.0, 0.0: 2.0, 0.5: 0.0, 0.6: 0.0})
