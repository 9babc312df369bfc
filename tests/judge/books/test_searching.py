"""A search that worlds of other sizes share finds what one of their own would."""

import numpy as np
import pytest

from wsim.judge.books.searching import Search
from wsim.scene.world import Shape

SIZES = {"box": 3, "sphere": 1, "cylinder": 2, "capsule": 2}
KINDS = [*SIZES, "box", "capsule"]


def shapes(random, static=(1.0, 1.0, 0.1), **fields):
    """A floor, a slab, and one shape on each body."""
    floor = Shape(prim="/World/floor/geometry", kind="plane", size=())
    slab = Shape(prim="/World/slab/geometry", kind="box", size=static, position=(0.3, 0.0, 0.2))
    loose = [
        Shape(prim=f"/World/b{n}/geometry", kind=kind, size=tuple(random.uniform(0.1, 0.3, SIZES[kind])), **fields)
        for n, kind in enumerate(KINDS)
    ]
    return [
        *((n, shape.prim, shape) for n, shape in enumerate(loose)),
        *((-1, each.prim, each) for each in (floor, slab)),
    ]


def poses(random):
    q = random.normal(size=(len(KINDS), 4))
    return np.concatenate([random.uniform(-0.3, 0.3, (len(KINDS), 3)), q / np.linalg.norm(q, axis=1)[:, None]], axis=1)


def found(search, pose):
    far, ours = np.full(len(KINDS) + 2, 0.01), np.ones(len(KINDS) + 2, dtype=bool)
    contacts = search.at(pose.ravel(), far, ours, far[1:], ours[1:])
    return np.array(contacts.geom), np.array(contacts.pos), np.array(contacts.frame), np.array(contacts.dist)


def test_each_finds_what_its_own_would_in_any_order():
    random = np.random.default_rng(0)
    every = [shapes(random) for _ in range(4)]
    own = [Search(len(KINDS), each, {}) for each in every]
    first = Search(len(KINDS), every[0], {})
    shared = [first, *(first.resized(each) for each in every[1:])]
    many = 0
    for n in [*range(4), 0, 2, 0, 3, 1]:
        pose = poses(random)
        for had, wanted in zip(found(shared[n], pose), found(own[n], pose), strict=True):
            assert np.array_equal(had, wanted)
            many += len(wanted)
    assert many > 100


def test_one_that_joins_after_another_was_asked_has_its_own_sizes():
    """Where it differs from the first by some shapes alone, the others are the first's."""
    random = np.random.default_rng(1)
    first, other, later = (shapes(random) for _ in range(3))
    later[2:] = first[2:]
    search = Search(len(KINDS), first, {})
    found(search.resized(other), poses(random))
    many, pose = 0, poses(random)
    own = Search(len(KINDS), later, {})
    for had, wanted in zip(found(search.resized(later), pose), found(own, pose), strict=True):
        assert np.array_equal(had, wanted)
        many += len(wanted)
    assert many


@pytest.mark.parametrize("fields", [{"static": (1.0, 1.0, 0.2)}, {"position": (0.0, 0.0, 0.1)}])
def test_what_is_not_alone_at_its_place_has_its_own(fields):
    """The slab beside the floor, and shapes off their bodies' origins."""
    random = np.random.default_rng(0)
    assert Search(len(KINDS), shapes(random), {}).resized(shapes(random, **fields)) is None
