"""What rests on, in and beside a mesh that moves: judged by the hull or the pieces that collide for it."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh

from tests.judge.test_turned import failing, simulated
from tests.judge.theory import edited
from wsim.judge.books.balance import Books
from wsim.judge.books.meshes import colliding
from wsim.judge.evidence.evidence import Evidence
from wsim.scene.world import Shape

LEG, BASE, TALL = 0.1, 0.5, 0.5  # [m] of the letter U: its legs' width, its own, its height


def letter():
    """A closed U, 0.3 m thick: five blocks of one skin."""
    x, inner = BASE / 2, BASE / 2 - LEG
    corners = [(s, z) for z in (0.0, LEG, TALL) for s in (-x, -inner, inner, x)]
    blocks = [(0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (4, 5, 9, 8), (6, 7, 11, 10)]
    rim = [0, 1, 2, 3, 7, 11, 10, 6, 5, 9, 8, 4]
    points = [(a, y, z) for y in (-0.15, 0.15) for a, z in corners]
    faces = [face for a, b, c, d in blocks for face in ((a, b, c), (a, c, d), (a + 12, c + 12, b + 12),
                                                        (a + 12, d + 12, c + 12))]  # fmt: skip
    for a, b in zip(rim, [*rim[1:], rim[0]], strict=True):
        faces += [(a, a + 12, b + 12), (a, b + 12, b)]
    mesh = trimesh.Trimesh(points, faces, process=False)
    mesh.fix_normals()
    return mesh


@pytest.fixture(scope="module")
def dropped(tmp_path_factory):
    """A box of 0.2 m let go over the gap between the legs, by the form in which the U collides."""
    made = {}
    for form in ("convexHull", "convexDecomposition"):
        folder = tmp_path_factory.mktemp(form)
        letter().export(folder / "u.obj")

        def build(scene, form=form, folder=folder):
            scene.ground()
            scene.mesh("u", file=folder / "u.obj", collision=form, density=1000, friction=0.5)
            scene.box("box", size=(0.2, 0.2, 0.2), density=500, friction=0.5, position=(0, 0, 0.62))

        made[form] = simulated(folder, build, 0.8)
    return made


@pytest.mark.parametrize(("form", "height"), [("convexHull", TALL + 0.1), ("convexDecomposition", LEG + 0.1)])
def test_a_box_rests_on_a_hull_and_falls_between_pieces(dropped, form, height):
    assert dropped[form].body_q[-1, 1, 2] == pytest.approx(height, abs=2e-3)
    assert failing(dropped[form]) == set()


def test_a_box_that_hovers_over_a_hull_is_found(dropped):
    still = slice(30, None)  # from 0.5 s on, when it has come to rest
    assert "CheckForces" in failing(edited(dropped["convexHull"], "body_q", (still, 1, 2), 0.1))


def test_a_box_between_the_legs_is_carried_by_pieces_alone(dropped):
    """By the hull it would stand deep within the U; held above the base it has nothing under it."""
    assert "CheckForces" in failing(edited(dropped["convexDecomposition"], "body_q", (slice(40, None), 1, 2), 0.1))


def test_a_ring_that_comes_to_rest_aslant_rolls_on_the_corners_that_collide(tmp_path):
    """Newton's hulls have 64 corners at most: by the hull of all of the ring's it rolls on what is not there."""
    trimesh.creation.torus(0.15, 0.05, major_sections=24, minor_sections=12).export(tmp_path / "ring.obj")

    def build(scene):
        scene.ground()
        scene.mesh("ring", file=tmp_path / "ring.obj", density=1000, friction=0.5, position=(0, 0, 0.3),
                   rotation_deg=(20, 0, 0), angular_velocity_deg=(0, 90, 0))  # fmt: skip

    sound = simulated(tmp_path, build, 2.0)
    assert failing(sound) == set()
    pieces = sound.world.bodies[0].shapes[0].pieces
    assert [len(piece) <= 64 for piece in pieces] == [True]
    shapes = [sound.world.bodies[0].shapes[0].model_copy(update={"pieces": []})]
    forgets = sound.world.model_copy(update={"bodies": [sound.world.bodies[0].model_copy(update={"shapes": shapes})]})
    left = [
        np.linalg.norm(Books.of(Evidence(each, None)).force, axis=2).max()
        for each in (sound, replace(sound, world=forgets))
    ]
    assert left[1] > 5.0 * left[0]  # 0.074 and 0.006 m/s^2


def test_a_hull_turns_outwards_and_has_the_volume_of_its_corners():
    mesh = letter()
    shape = Shape(prim="/World/u", kind="mesh", size=(0.5, 0.3, 0.5), vertices=mesh.vertices.tolist(),
                  triangles=mesh.faces.tolist(), convex=True)  # fmt: skip
    hull = only_mesh(colliding(shape))
    assert hull.volume == pytest.approx(0.5 * 0.3 * 0.5)
    assert only_mesh(colliding(shape.model_copy(update={"convex": False}))).volume == pytest.approx(mesh.volume)
    flat = shape.model_copy(update={"vertices": np.array(mesh.vertices * [1, 0, 1]).tolist()})
    assert colliding(flat) == [flat]


def only_mesh(shapes):
    (shape,) = shapes
    return trimesh.Trimesh(shape.vertices, shape.triangles, process=False)
