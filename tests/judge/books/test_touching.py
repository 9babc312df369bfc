"""Contacts of some bodies alone are those that these have among all."""

import numpy as np
import pytest

from wsim.judge.books.touching import NEAR, Touching
from wsim.scene.world import Body, Shape, Static, World

KINDS = {"box": (0.2, 0.3, 0.2), "sphere": (0.12,), "cylinder": (0.1, 0.3), "capsule": (0.08, 0.3)}
CORNERS = [(x, y, z) for x in (-0.1, 0.1) for y in (-0.1, 0.1) for z in (-0.1, 0.1)]
FACES = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4),
         (1, 5, 7), (1, 7, 3)]  # fmt: skip


def heap(draw, mesh):
    """A few bodies close to each other, over the ground and on a cube of triangles."""
    bodies = []
    for k, kind in enumerate(draw.choice(sorted(KINDS), size=6)):
        shape = Shape(prim=f"/World/b{k}/geometry", kind=str(kind), size=KINDS[str(kind)])
        bodies.append(
            Body(
                prim=f"/World/b{k}", mass=1.0, volume=1.0, inertia=(1.0, 0, 0, 0, 1.0, 0, 0, 0, 1.0),
                position=(0.0, 0.0, 0.0), rotation=(0.0, 0.0, 0.0, 1.0), shapes=[shape],
            )
        )  # fmt: skip
    statics = [Static(prim="/World/ground", shapes=[Shape(prim="/World/ground/geometry", kind="plane", size=())])]
    if mesh:
        cube = {"kind": "mesh", "size": (), "vertices": CORNERS, "triangles": FACES}
        statics.append(
            Static(prim="/World/cube", shapes=[Shape.model_validate({"prim": "/World/cube/geometry", **cube})])
        )
    return World(duration=1.0, frame_rate=10.0, bodies=bodies, statics=statics)


@pytest.mark.parametrize("mesh", [False, True])
def test_contacts_about_some_bodies(mesh):
    draw, seen = np.random.default_rng(0), 0
    for _ in range(15):
        world = heap(draw, mesh)
        touching = Touching(world)
        turn = draw.normal(size=(6, 4))
        turn[:3] = [0.0, 0.0, 0.0, 1.0]
        place = draw.uniform([-0.3, -0.3, 0.1], [0.3, 0.3, 0.5], size=(6, 3))
        poses = np.concatenate([place, turn / np.linalg.norm(turn, axis=1, keepdims=True)], axis=1)
        every = touching.at(poses, 0.05)
        for about in ([0], [2, 5]):
            wanted = every.only(np.flatnonzero(np.isin(every.one, about) | np.isin(every.two, about)))
            found = touching.at(poses, 0.05, about)
            for name in ("one", "two", "shapes", "point", "normal", "gap"):
                assert np.array_equal(getattr(found, name), getattr(wanted, name))
            seen += len(found)
    assert seen > 100


def test_what_is_looked_for_as_far_as_each_body_goes():
    """Of each pose the contacts about other bodies, within what both reach, are among all."""
    draw, seen = np.random.default_rng(1), 0
    world = heap(draw, mesh=False)
    touching = Touching(world)
    turn = draw.normal(size=(8, 6, 4))
    place = draw.uniform([-0.3, -0.3, 0.1], [0.3, 0.3, 0.5], size=(8, 6, 3))
    poses = np.concatenate([place, turn / np.linalg.norm(turn, axis=2, keepdims=True)], axis=2)
    reach, about = draw.uniform(0.0, 0.05, size=(8, 7)), draw.random((8, 6)) < 0.4
    found = touching.of_many(poses, reach, np.arange(8), about=about)
    near = touching.near(poses, np.zeros(8, dtype=np.intp))
    for k in range(8):
        ours = found.only(np.flatnonzero(np.maximum(found.one, found.two) // 6 == k))
        rows = [np.where(each >= 0, each % 6, -1) for each in (ours.one, ours.two)]
        every = touching.at(poses[k], 0.1)
        asked = np.append(about[k], False)
        some = (asked[every.one] | asked[every.two]) & (every.gap <= reach[k, every.one] + reach[k, every.two])
        pairs = {tuple(pair) for pair in every.only(some).shapes.tolist()}
        assert {tuple(pair) for pair in ours.shapes.tolist()} == pairs
        assert np.all(asked[rows[0]] | asked[rows[1]])
        touch = {tuple(sorted(pair)) for pair in every.only(every.gap <= NEAR).shapes.tolist() if max(pair) < 6}
        assert {tuple(pair) for pair in np.argwhere(np.triu(near[k])).tolist()} == touch
        seen += len(ours)
    assert seen > 20


def test_contacts_with_meshes_are_those_of_each_pair_alone():
    """That of two shapes nothing is left out because of others, or of what is far and may not touch."""
    draw, seen = np.random.default_rng(1), 0
    world = heap(draw, mesh=True)
    cube = world.statics[1].shapes[0]
    world.bodies[0].shapes[0] = world.bodies[1].shapes[0] = cube
    for _ in range(5):
        turn = draw.normal(size=(6, 4))
        place = draw.uniform(-0.25, 0.25, size=(6, 3))
        poses = np.concatenate([place, turn / np.linalg.norm(turn, axis=1, keepdims=True)], axis=1)
        found = Touching(world).at(poses, 0.05)
        for a, b in ((0, 1), (0, 2), (1, 5)):
            two = world.model_copy(update={"bodies": [world.bodies[a], world.bodies[b]], "statics": []})
            alone = Touching(two).at(poses[[a, b]], 0.05)
            pair = found.only(np.flatnonzero(np.isin(found.one, (a, b)) & np.isin(found.two, (a, b))))
            assert sorted(pair.gap) == pytest.approx(sorted(alone.gap), abs=1e-12)
            seen += len(alone)
    assert seen > 20
