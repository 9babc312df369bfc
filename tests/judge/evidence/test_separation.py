"""The least distance of two shapes: known ones are found, and it is never more than the distance of their points."""

import math
from dataclasses import replace

import numpy as np
import pytest

from wsim.geometry.rotations import rotate
from wsim.geometry.shapes import kind_of
from wsim.judge.evidence.placed import Placed
from wsim.judge.evidence.separation import separation
from wsim.scene.world import Shape

UPRIGHT = (0.0, 0.0, 0.0, 1.0)
KINDS = {"box": (0.3, 0.2, 0.1), "sphere": (0.1,), "cylinder": (0.1, 0.4), "capsule": (0.1, 0.2), "plane": ()}


def placed(kind, position=(0.0, 0.0, 0.0), rotation=UPRIGHT, size=None):
    shape = Shape(prim=f"/World/{kind}", kind=kind, size=KINDS[kind] if size is None else size)
    position, rotation = np.atleast_2d(np.array(position)), np.atleast_2d(np.array(rotation))
    return Placed(shape.prim, 0, shape, position, rotation)


@pytest.mark.parametrize(
    ("a", "b", "gap"),
    [
        (placed("sphere", (0.0, 0.0, 0.35)), placed("sphere"), 0.15),
        (placed("box", (0.0, 0.0, 0.06)), placed("plane"), 0.01),
        (placed("plane"), placed("cylinder", (5.0, 0.0, 0.13), (0.0, math.sqrt(0.5), 0.0, math.sqrt(0.5))), 0.03),
        (placed("box"), placed("box", (0.32, 0.0, 0.0)), 0.02),
        (placed("capsule", (0.0, 0.25, 0.0)), placed("box"), 0.05),
        # Two bars across each other, edge on edge: only the normal of the two edges tells them apart.
        (
            placed("box", (0.0, 0.0, 0.2), (math.sin(math.pi / 8), 0.0, 0.0, math.cos(math.pi / 8)), (2.0, 0.1, 0.1)),
            placed("box", size=(0.1, 2.0, 0.1), rotation=(0.0, math.sin(math.pi / 8), 0.0, math.cos(math.pi / 8))),
            0.2 - 0.1 * math.sqrt(2.0),
        ),
    ],
)
def test_a_known_gap_is_found(a, b, gap):
    assert separation(a, b, np.array([0])) == pytest.approx(gap, abs=1e-12)
    assert separation(b, a, np.array([0])) == pytest.approx(gap, abs=1e-12)


@pytest.mark.parametrize("one", ["box", "sphere", "cylinder", "capsule"])
@pytest.mark.parametrize("other", KINDS)
def test_it_is_never_more_than_the_distance_of_any_point(one, other):
    random = np.random.default_rng(3)
    turns = random.normal(size=(2, 300, 4))
    turns /= np.linalg.norm(turns, axis=2, keepdims=True)
    a = placed(one, random.uniform(-0.5, 0.5, (300, 3)), turns[0])
    b = placed(other, np.zeros((300, 3)), turns[1])
    points, margin = kind_of(a.shape).probes()
    world = rotate(a.rotation[:, None], points[None]) + a.position[:, None]
    local = rotate(b.rotation[:, None] * [-1.0, -1.0, -1.0, 1.0], world - b.position[:, None])
    distance = -kind_of(b.shape).depth(local).max(axis=1) - margin
    gap = separation(a, b, np.arange(300))
    assert np.all(gap <= distance + 1e-9) and (gap > 0.0).any()


def test_a_mesh_is_as_far_as_its_corners():
    corners = [(x, y, z) for x in (0.0, 0.1) for y in (0.0, 0.1) for z in (0.0, 0.1)]
    cube = placed("box", (0.3, 0.0, 0.0))
    mesh = cube.shape.model_copy(update={"kind": "mesh", "vertices": corners})
    gap = separation(replace(cube, shape=mesh), placed("box"), np.array([0]))
    assert gap == pytest.approx(0.15)
