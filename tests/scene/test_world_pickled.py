"""What comes of a world that is pickled is that world."""

from __future__ import annotations

import copy
import pickle

import pytest
from hypothesis import given
from hypothesis import strategies as st

from wsim.scene.world import Body, Camera, Fluid, Shape, World

PLACES = st.tuples(*[st.floats(-1e6, 1e6)] * 3)
SHAPES = st.builds(
    Shape, prim=st.text(max_size=8), kind=st.just("box"), size=PLACES, friction=st.none() | st.floats(0.0, 1.0)
)
BODIES = st.builds(
    Body,
    prim=st.text(max_size=8), mass=st.floats(0.0, 1e6), volume=st.floats(0.0, 1e6), inertia=st.just((1.0,) * 9),
    position=PLACES, rotation=st.just((0.0, 0.0, 0.0, 1.0)), shapes=st.lists(SHAPES, max_size=2),
)  # fmt: skip
WORLDS = st.builds(
    World,
    bodies=st.lists(BODIES, max_size=3),
    fluids=st.lists(st.builds(Fluid, prim=st.just("/World/water"), density=st.floats(1.0, 1e4), viscosity=st.just(0.0),
                              spacing=st.just(0.1), size=PLACES, center=PLACES), max_size=1),
    cameras=st.lists(st.builds(Camera, prim=st.just("/World/camera"), eye=PLACES, target=PLACES), max_size=1),
)  # fmt: skip


@given(WORLDS, st.integers(0, pickle.HIGHEST_PROTOCOL))
def test_a_world_is_unpickled_to_the_last_bit(world: World, protocol: int) -> None:
    found = pickle.loads(pickle.dumps(world, protocol))
    assert found == world
    assert found.model_dump_json() == world.model_dump_json()
    assert found.model_dump_json(exclude_unset=True) == world.model_dump_json(exclude_unset=True)


@given(WORLDS)
def test_a_copy_is_its_own(world: World) -> None:
    """Pickling has not changed what `copy` and `model_copy` give."""
    for found in (copy.deepcopy(world), world.model_copy(deep=True), pickle.loads(pickle.dumps(world))):
        found.duration = world.duration + 1.0
        found.bodies.append(Body.model_construct())
        assert found.duration != world.duration
        assert len(found.bodies) == len(world.bodies) + 1


def test_an_unpickled_model_refuses_what_a_model_refuses() -> None:
    found = pickle.loads(pickle.dumps(World()))
    with pytest.raises(ValueError, match="no field"):
        found.nothing = 1
