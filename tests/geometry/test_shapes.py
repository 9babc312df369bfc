"""Volumes and drafts against closed forms."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from wsim.geometry.kinds import KINDS, PRIMITIVES, varying
from wsim.geometry.rotations import multiply, rotate
from wsim.geometry.shapes import Solid, kind_of
from wsim.scene.world import Shape

UPRIGHT = np.array([0.0, 0.0, 0.0, 1.0])


def about_x(degrees: float) -> np.ndarray:
    half = math.radians(degrees) / 2
    return np.array([math.sin(half), 0.0, 0.0, math.cos(half)])


def solid(kind: str, size: tuple[float, ...], **fields) -> Solid:
    shape = Shape(prim="/World/a/geometry", kind=kind, size=size, **fields)
    return Solid([shape])


@pytest.mark.parametrize(("kind", "count"), [("box", 3), ("sphere", 1), ("cylinder", 2), ("capsule", 2)])
def test_a_primitive_of_another_size_in_each_row_is_each_of_them(kind, count):
    """Depths, ends, heights, balls about them and probes."""
    random = np.random.default_rng(0)
    sizes, points = random.uniform(0.1, 0.4, (5, count)), random.uniform(-0.3, 0.3, (5, 7, 3))
    ways = points / np.linalg.norm(points, axis=2, keepdims=True)
    every = varying(kind, *sizes.T[:, :, None])
    (low, high), (bottom, top) = every.ends(ways), every.heights(ways[:, 0])
    probes, margin = every.probes()
    for n, size in enumerate(sizes.tolist()):
        one = PRIMITIVES[kind](*size)
        assert every.depth(points)[n] == pytest.approx(one.depth(points[n]), abs=1e-15)
        assert np.array([low[n], high[n]]) == pytest.approx(np.array(one.ends(ways[n])), abs=1e-15)
        assert (bottom[n], top[n]) == pytest.approx([float(end[0]) for end in one.heights(ways[n, :1])], abs=1e-15)
        assert float(every.radius_about[n, 0]) == pytest.approx(one.radius_about, rel=1e-15)
        assert float(every.thinnest[n, 0]) == pytest.approx(one.thinnest, rel=1e-15)
        own, deep = one.probes()
        assert np.broadcast_to(probes, (5, *own.shape))[n] == pytest.approx(own, abs=1e-15)
        assert float(np.broadcast_to(margin, (5, 1))[n, 0]) == deep


@pytest.mark.parametrize(
    ("kind", "size", "volume"),
    [
        ("box", (0.2, 0.3, 0.14), 0.2 * 0.3 * 0.14),
        ("sphere", (0.09,), 4 / 3 * math.pi * 0.09**3),
        ("cylinder", (0.08, 0.3), math.pi * 0.08**2 * 0.3),
        ("capsule", (0.08, 0.3), math.pi * 0.08**2 * (0.3 + 4 / 3 * 0.08)),
    ],
)
def test_volume(kind, size, volume):
    body = solid(kind, size)
    assert body.volume == pytest.approx(volume, rel=1e-9)
    for q in (UPRIGHT, about_x(37.0)):
        assert body.volume_below(q, 1.0, 2.0) == pytest.approx(volume, rel=1e-9)
        assert body.volume_below(q, 1.0, 0.0) == 0.0
        assert body.volume_below(q, 1.0, 1.0) == pytest.approx(volume / 2, rel=1e-9)


def test_draft_of_a_box_level_and_on_edge():
    box = solid("box", (0.2, 0.2, 0.14))
    assert box.draft(UPRIGHT, 0.6 * box.volume) == pytest.approx(0.6 * 0.14)
    # On its edge a square prism's section under the surface is a triangle: depth^2 = ratio * side^2.
    prism = solid("box", (0.3, 0.2, 0.2))
    assert prism.draft(about_x(45.0), 0.25 * prism.volume) == pytest.approx(0.2 * math.sqrt(0.25))


def test_draft_of_a_sphere_is_its_caps():
    radius, ratio = 0.09, 0.24
    cap = brentq(lambda h: h * h * (3 * radius - h) / (4 * radius**3) - ratio, 0.0, 2 * radius)
    ball = solid("sphere", (radius,))
    assert ball.draft(UPRIGHT, ratio * ball.volume) == pytest.approx(cap, rel=3e-3)


def test_draft_of_a_lying_cylinder_is_its_segments():
    radius, ratio = 0.08, 0.3
    theta = brentq(lambda t: (t - math.sin(t)) / (2 * math.pi) - ratio, 0.0, 2 * math.pi)
    log = solid("cylinder", (radius, 0.3))
    depth = radius * (1 - math.cos(theta / 2))
    assert log.draft(about_x(90.0), ratio * log.volume) == pytest.approx(depth, rel=3e-3)
    assert log.draft(UPRIGHT, ratio * log.volume) == pytest.approx(0.3 * ratio)


def test_a_mesh_is_cut_as_the_box_that_it_is():
    corners = [(x, y, z) for x in (-0.1, 0.1) for y in (-0.1, 0.1) for z in (-0.07, 0.07)]
    triangles = [
        (0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4),
        (1, 5, 7), (1, 7, 3),
    ]  # fmt: skip
    mesh = solid("mesh", (0.2, 0.2, 0.14), vertices=corners, triangles=triangles)
    box = solid("box", (0.2, 0.2, 0.14))
    for q in (UPRIGHT, about_x(20.0)):
        assert mesh.draft(q, 0.4 * box.volume) == pytest.approx(box.draft(q, 0.4 * box.volume))
        assert np.allclose(mesh.reach(q[None]), box.reach(q[None]))


def test_what_is_too_heavy_has_no_draft():
    with pytest.raises(ValueError, match="cannot displace"):
        solid("sphere", (0.1,)).draft(UPRIGHT, 1.0)


@pytest.mark.parametrize("kind", ["box", "sphere", "cylinder", "capsule"])
def test_reach_is_the_surface_s(kind):
    body = solid(kind, {"box": (0.2, 0.3, 0.1), "sphere": (0.1,)}.get(kind, (0.1, 0.3)))
    q = multiply(about_x(33.0), np.array([0.0, math.sin(0.3), 0.0, math.cos(0.3)]))
    z = rotate(q, body.surfaces[0].vertices)[:, 2]
    low, high = body.reach(q[None])
    assert low[0] == pytest.approx(z.min(), abs=2e-3)
    assert high[0] == pytest.approx(z.max(), abs=2e-3)


def test_depth_inside_has_the_right_sign_and_size():
    box = Shape(prim="/a", kind="box", size=(2.0, 2.0, 2.0))
    points = np.array([[0.0, 0.0, 0.9], [0.0, 0.0, 1.5], [2.0, 2.0, 0.0]])
    assert kind_of(box).depth(points) == pytest.approx([0.1, -0.5, -math.sqrt(2.0)])
    rod = Shape(prim="/a", kind="cylinder", size=(1.0, 4.0))
    assert kind_of(rod).depth(np.array([[0.8, 0.0, 0.0], [0.0, 0.0, 2.3]])) == pytest.approx([0.2, -0.3])
    pill = Shape(prim="/a", kind="capsule", size=(1.0, 4.0))
    assert kind_of(pill).depth(np.array([[0.0, 0.0, 2.5], [1.5, 0.0, 0.0]])) == pytest.approx([0.5, -0.5])


@pytest.mark.parametrize("kind", ["box", "sphere", "cylinder", "capsule"])
def test_a_kind_tells_one_story(kind):
    """Its width, its ball, its depth and its surface, each worked out in another way, are those of one solid."""
    shape = KINDS[kind](*{"box": (0.2, 0.3, 0.1), "sphere": (0.1,)}.get(kind, (0.1, 0.3)))
    points = shape.surface().vertices
    assert np.abs(shape.depth(points)).max() < 2e-3
    assert np.linalg.norm(points, axis=1).max() == pytest.approx(shape.radius_about, abs=2e-3)
    assert np.ptp(points, axis=0) == pytest.approx(shape.edges, abs=4e-3)
    assert shape.thinnest == pytest.approx(min(shape.edges))
    axes = rotate(about_x(33.0), np.eye(3))
    low, high = shape.ends(axes)
    assert low == pytest.approx((points @ axes.T).min(axis=0), abs=2e-3)
    assert high == pytest.approx((points @ axes.T).max(axis=0), abs=2e-3)
    assert shape.heights(axes) == pytest.approx(np.array([low, high]))
    assert shape.volume == pytest.approx(shape.surface().volume)
    probes, margin = shape.probes()
    assert shape.depth(probes) == pytest.approx(np.full(len(probes), margin))
