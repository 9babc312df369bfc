"""What stands still, as particles tile by tile: the same ones whichever tile comes first, each once."""

import numpy as np
import pytest
import trimesh
from newton import GeoType, Mesh

from wsim.geometry.rotations import rotate
from wsim.solvers.fixed_shapes import fixed_shape
from wsim.solvers.sph_config import ConfigSPH
from wsim.solvers.tiles import Tiles, keys_of

CONFIG = ConfigSPH(spacing=0.05, speed_of_sound=20.0)
HERE = np.array([0.3, -0.2, 0.1, 0.0, 0.0, 0.0, 1.0])
TURNED = np.array([0.0, 0.0, 0.0, *(0.5 * np.array([1.0, 1.0, 1.0, 1.0]))])  # 120 degrees about (1, 1, 1)
TILES = Tiles(0.8, np.ones(3, dtype=bool))


def shape(kind, pose, scale, source=None):
    return fixed_shape(int(kind), pose, np.array(scale), source, CONFIG)


def in_tiles(one, low, high):
    """Its particles, tile by tile, of those between two corners."""
    found = []
    for tile in TILES.spanning(low, high):
        corner, other = TILES.corners(tile)
        samples = one.near(corner, other)
        keep = ((samples.position >= corner) & (samples.position < other)).all(axis=1)
        found.append(np.column_stack([samples.position[keep], samples.volume[keep]]))
    return np.concatenate(found)


def ball(subdivisions, radius):
    mesh = trimesh.creation.icosphere(subdivisions, radius)
    return Mesh(np.asarray(mesh.vertices, dtype=np.float32), np.asarray(mesh.faces).reshape(-1))


@pytest.mark.parametrize("pose", [HERE, TURNED])
def test_a_box_has_a_shell_as_deep_as_a_kernel_reaches(pose):
    half = np.array([1.0, 0.6, 0.1])
    box = shape(GeoType.BOX, pose, half)
    found = in_tiles(box, box.low, box.high)
    depth = box.depth(found[:, :3])
    assert len(np.unique(np.round(found[:, :3], 5), axis=0)) == len(found) == 40 * 24 * 4  # thin: all of it
    assert found[:, 3].sum() == pytest.approx(8 * half.prod())
    assert depth.min() == pytest.approx(0.025, abs=1e-6) and depth.max() < CONFIG.support
    thick = shape(GeoType.BOX, pose, (0.5, 0.5, 0.5))
    laid = in_tiles(thick, thick.low, thick.high)
    assert len(laid) == 20**3 - 16**3  # two layers
    # What is not laid is beyond the reach of water half a spacing off the face.
    third = 0.125
    assert third + 0.5 * CONFIG.spacing > CONFIG.support > thick.depth(laid[:, :3]).max() + 0.5 * CONFIG.spacing


def test_a_plane_is_as_deep_as_a_kernel_reaches_wherever_it_is_asked_for():
    tilted = np.array([0.0, 0.0, 0.2, 0.0, np.sin(0.2), 0.0, np.cos(0.2)])
    plane = shape(GeoType.PLANE, tilted, (0.0, 0.0, 0.0))
    for middle in (np.zeros(3), np.array([40.0, -30.0, 0.0])):
        middle[2] = 0.2 - middle[0] * np.tan(0.4)
        found = in_tiles(plane, middle - 0.6, middle + 0.6)
        depth = -rotate(-tilted[3:] * [1, 1, 1, -1], found[:, :3] - tilted[:3])[:, 2]
        assert np.unique(np.round(depth, 3)) == pytest.approx([0.025, 0.075])
        assert len(np.unique(np.round(found[:, :3], 3), axis=0)) == len(found) > 500
    assert plane.depth(np.array([[0.0, 0.0, -3.0], [0.0, 0.0, 1.0]])) == pytest.approx(
        [3.2 * np.cos(0.4), -0.8 * np.cos(0.4)]
    )


@pytest.mark.parametrize("radius", [0.3, 1.0])  # the larger one is filled part by part
def test_a_meshs_parts_add_up_to_its_shell(radius):
    mesh = shape(GeoType.MESH, HERE, (1.0, 1.0, 1.0), ball(3, radius))
    found = in_tiles(mesh, mesh.low, mesh.high)
    depth, shell = mesh.depth(found[:, :3]), 2.0 * CONFIG.spacing
    assert depth.min() > 0.0 and depth.max() < CONFIG.support + 0.01
    sphere = 4.0 / 3.0 * np.pi * (radius**3 - (radius - shell) ** 3)
    assert found[:, 3].sum() == pytest.approx(sphere, rel=0.15)


def test_round_shapes_have_their_shells():
    for kind, scale in (
        (GeoType.SPHERE, (0.3, 0.0, 0.0)),
        (GeoType.CAPSULE, (0.2, 0.3, 0.0)),
        (GeoType.CYLINDER, (0.2, 0.3, 0.0)),
    ):
        one = shape(kind, HERE, scale)
        found = in_tiles(one, one.low, one.high)
        depth = one.depth(found[:, :3])
        assert 0.3 * CONFIG.spacing < depth.min() and depth.max() < CONFIG.support and len(found) > 500


def test_tiles_are_told_apart():
    tiles = TILES.around(TILES.of(np.array([[0.1, 0.1, 0.1], [-0.1, 3.0, -50.0]])))
    assert len(tiles) == 2 * 27
    keys = np.concatenate([keys_of(w, tiles) for w in (0, 1, 4095)])
    assert len(np.unique(keys)) == 3 * 54
    uncut = Tiles(0.8, np.array([True, False, True]))
    assert len(uncut.around(uncut.of(np.array([[0.1, 7.0, 0.1]])))) == 9
