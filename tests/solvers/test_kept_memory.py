"""Memory that is kept for the next array of its size."""

from collections import Counter
from contextlib import contextmanager

import warp as wp
from hypothesis import given
from hypothesis import strategies as st

from wsim.scene import Drive, Scene
from wsim.sim import Simulation
from wsim.solvers.contact_law_warp import ContactLawWarp
from wsim.solvers.kept_memory import KeptMemory

sizes = st.integers(1, 5).map(lambda k: 64 * k)


@given(st.lists(st.one_of(sizes, st.none()), max_size=40))
def test_no_two_arrays_share_a_block_and_no_more_are_made_than_were_ever_used_at_once(calls):
    """Arrays of several sizes, the oldest given back at each None."""
    memory = KeptMemory(wp.get_device("cpu"))
    held, made, most = [], {}, {}
    for size in calls:
        if size is None:
            if held:
                memory.deallocate(*held.pop(0))
            continue
        start = memory.allocate(size)
        assert all(start + size <= other or other + length <= start for other, length in held)
        held.append((start, size))
        made.setdefault(size, set()).add(start)
        most[size] = max(most.get(size, 0), sum(length == size for _, length in held))
    assert {size: len(starts) for size, starts in made.items()} == most


def test_rounds_of_blows_make_nothing_that_the_step_has_not_made_before(tmp_path, monkeypatch):
    """They are a loop in a CUDA graph, which may not allocate: what they ask for must be kept from outside of them."""
    free, kept, inside, missing = Counter(), [False], [0], []
    host = type(wp.get_device_allocator("cpu"))
    allocate, deallocate = host.allocate, host.deallocate

    def allocated(self, size):
        if inside[0] and not (kept[0] and free[size]):
            missing.append(size)
        free[size] -= kept[0] and free[size] > 0
        return allocate(self, size)

    def deallocated(self, start, size):
        free[size] += kept[0]
        deallocate(self, start, size)

    @contextmanager
    def used(_):
        before, kept[0] = kept[0], True
        yield
        kept[0] = before

    def counted(plain):
        def call(*args, **options):
            inside[0] += 1
            plain(*args, **options)
            inside[0] -= 1

        return call

    monkeypatch.setattr(host, "allocate", allocated)
    monkeypatch.setattr(host, "deallocate", deallocated)
    monkeypatch.setattr(KeptMemory, "used", used)
    for name in ("_round", "_go_on"):
        monkeypatch.setattr(ContactLawWarp, name, counted(getattr(ContactLawWarp, name)))
    scene = Scene()
    scene.ground()
    wheel = scene.cylinder("wheel", radius=0.1, height=0.03, axis="Y", position=(0, 0, 1), density=2000)
    scene.joint_revolute("motor", None, wheel, anchor=(0, 0, 1), axis="Y", drive=Drive(velocity=90, damping=20))
    scene.box("bob", size=(0.1,) * 3, mass=1.0, position=(0.5, 0, 0.6), restitution=0.5)
    scene.rope("rope", None, "bob", anchor_a=(0.5, 0, 1.2))
    scene.sphere("ball", radius=0.05, mass=0.3, position=(0.385, 0, 0.6), velocity=(4, 0, 0), restitution=0.5)
    simulation = Simulation(scene.save(tmp_path / "stage.usda"), "cpu", 2)
    simulation._replays = False  # a graph would not come by here
    missing.clear()
    for _ in range(15):
        simulation.step()
    velocity = simulation.state.body_qd.numpy()[simulation.built.bodies, 0]
    assert velocity[1] > 0.5  # the bob was hit
    assert missing == []
