"""The top of a shape under a point, however it is turned: by rays through triangles, by its depth, by hand."""

import numpy as np
import pytest
import trimesh
from trimesh.ray.ray_triangle import ray_triangle_id

from wsim.geometry.rotations import matrices
from wsim.geometry.shapes import into, kind_of, surface_of, top_under
from wsim.scene.world import Shape

SIZES = {"box": (0.6, 0.4, 0.2), "sphere": (0.3,), "cylinder": (0.2, 0.7), "capsule": (0.15, 0.5)}
SEEDS = range(8)


def turned(seed: int) -> tuple[float, ...]:
    q = np.random.default_rng(seed).normal(size=4)
    return tuple((q / np.linalg.norm(q)).tolist())


def made(kind: str, seed: int, **fields) -> Shape:
    return Shape(
        prim="/a", kind=kind, size=fields.pop("size", SIZES.get(kind)), position=(0.3, -0.2, 1.0),
        rotation=turned(seed), **fields,
    )  # fmt: skip


def ring() -> dict[str, list]:
    """A ring that stands beside its own origin, and is hollow there."""
    mesh = trimesh.creation.torus(0.5, 0.15, major_sections=16, minor_sections=8)
    mesh.apply_translation((0.4, 0.1, -0.2))
    return {"vertices": mesh.vertices.tolist(), "triangles": mesh.faces.tolist(), "size": tuple(mesh.extents.tolist())}


def places(shape: Shape, seed: int) -> np.ndarray:
    """Points all about a shape, seen from above, at any height."""
    corners = surface_of(shape).vertices
    middle, reach = (corners.min(axis=0) + corners.max(axis=0)) / 2, np.ptp(corners, axis=0)
    return middle + np.random.default_rng(seed + 100).uniform(-0.6, 0.6, (200, 3)) * reach


class Every:
    """trimesh looks each ray's candidates up in a tree, of a library that is not here: all of them are."""

    def __init__(self, corners: np.ndarray) -> None:
        self.every = range(len(corners))
        self.bounds = np.concatenate([corners.min(axis=(0, 1)), corners.max(axis=(0, 1))])

    def intersection(self, _: object) -> range:
        return self.every


def cast(shape: Shape, points: np.ndarray) -> np.ndarray:
    """The highest that rays from far above meet of the shape's triangles, by trimesh."""
    surface = surface_of(shape)
    corners = surface.vertices[surface.triangles]
    above, down = points + np.array([0.0, 0.0, 50.0]), np.tile([0.0, 0.0, -1.0], (len(points), 1))
    _, ray, where = ray_triangle_id(corners, above, down, tree=Every(corners))
    top = np.full(len(points), -np.inf)
    np.maximum.at(top, ray, where[:, 2])
    return top


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("kind", ["box", "mesh"])
def test_what_has_flat_sides_is_met_where_rays_meet_it(kind, seed):
    shape = made(kind, seed, **(ring() if kind == "mesh" else {}))
    points = places(shape, seed)
    expected = cast(shape, points)
    assert 20 < np.isfinite(expected).sum() < len(points)
    assert top_under(shape, points) == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("kind", SIZES)
def test_the_top_is_where_the_depth_ends(kind, seed):
    """There the depth is nil, above it is outside; where there is no top the whole line is outside."""
    shape = made(kind, seed)
    points = places(shape, seed)
    top = top_under(shape, points)
    over = np.isfinite(top)
    assert 20 < over.sum() < len(points)

    def depth(heights: np.ndarray) -> np.ndarray:
        lines = np.concatenate([np.broadcast_to(points[:, None, :2], (*heights.shape, 2)), heights[..., None]], axis=2)
        return kind_of(shape).depth(into(shape, lines))

    tops = np.where(over, top, 0.0)[:, None]
    assert depth(tops)[over] == pytest.approx(0.0, abs=1e-9)
    assert depth(tops + np.linspace(1e-6, 2.0, 50))[over].max() < 0.0
    assert depth(np.broadcast_to(np.linspace(-1.0, 3.0, 400), (len(points), 400)))[~over].max() < 0.0


@pytest.mark.parametrize(
    ("kind", "size", "expected"),
    [
        ("box", (0.6, 0.4, 0.2), 0.1),
        ("sphere", (0.3,), 0.3),
        ("cylinder", (0.2, 0.7), 0.35),
        ("capsule", (0.2, 0.6), 0.5),
    ],
)
def test_upright_it_is_the_upper_end(kind, size, expected):
    shape = Shape(prim="/a", kind=kind, size=size)
    assert top_under(shape, np.array([[0.0, 0.0, 9.0], [0.0, 0.0, -9.0], [2.0, 0.0, 0.0]])) == pytest.approx(
        np.array([expected, expected, -np.inf])
    )


def test_a_point_over_an_edge_is_over_the_shape():
    box = Shape(prim="/a", kind="box", size=(1.0, 1.0, 1.0))
    mesh = trimesh.creation.box((1.0, 1.0, 1.0))
    hull = Shape(
        prim="/a", kind="mesh", size=(1.0, 1.0, 1.0), vertices=mesh.vertices.tolist(), triangles=mesh.faces.tolist()
    )
    points = np.array([[0.0, 0.0, 2.0], [0.25, 0.25, 2.0], [0.5, 0.1, 2.0], [-0.5, -0.5, 2.0]])
    for shape in (box, hull):
        assert top_under(shape, points) == pytest.approx(0.5)


def test_a_slope_is_met_on_its_plane():
    plane = Shape(
        prim="/a", kind="plane", size=(), position=(0.0, 0.0, 0.3), rotation=(0.2, -0.1, 0.3, 0.9273618495495703)
    )
    normal = matrices(np.array(plane.rotation))[:, 2]
    points = np.array([[0.4, -0.7, 3.0], [0.0, 0.0, 0.0]])
    top = top_under(plane, points)
    assert (np.column_stack([points[:, :2], top]) - [0.0, 0.0, 0.3]) @ normal == pytest.approx(0.0, abs=1e-9)
    assert top[1] == pytest.approx(0.3) and top[0] != pytest.approx(0.3)
    overhead = Shape(prim="/a", kind="plane", size=(), rotation=(1.0, 0.0, 0.0, 0.0))
    assert np.all(top_under(overhead, points) == -np.inf)
