"""A launch whose arguments are packed once does what `wp.launch` does, with the arguments of the call."""

from __future__ import annotations

import numpy as np
import warp as wp

from wsim.sim.compiling import rehearse
from wsim.solvers import packed
from wsim.solvers.packed import Packed


@wp.kernel
def add_times(factor: float, given: wp.array[float], found: wp.array[float]):
    i = wp.tid()
    found[i] = found[i] + factor * given[i]


def add(launches: Packed, factor: float, given: wp.array, found: wp.array) -> None:
    launches.launch(add_times, dim=len(found), inputs=[factor, given], outputs=[found], changing=(factor, given, found))


def test_each_call_has_its_own_numbers_and_arrays() -> None:
    launches = Packed("cpu")
    one, two = (wp.full(3, value, dtype=float, device="cpu") for value in (1.0, 10.0))
    found = [wp.zeros(3, dtype=float, device="cpu") for _ in range(2)]
    for _ in range(2):
        add(launches, 2.0, one, found[0])
        add(launches, 3.0, two, found[0])
        add(launches, 2.0, one, found[1])
    assert (found[0].numpy() == 2 * (2.0 + 30.0)).all()
    assert (found[1].numpy() == 2 * 2.0).all()


def test_what_is_written_between_two_calls_is_seen() -> None:
    launches = Packed("cpu")
    given, found = wp.ones(2, dtype=float, device="cpu"), wp.zeros(2, dtype=float, device="cpu")
    add(launches, 1.0, given, found)
    given.assign(np.array([5.0, 6.0], dtype=np.float32))
    add(launches, 1.0, given, found)
    assert found.numpy().tolist() == [6.0, 7.0]


def test_of_no_threads_nothing_is_launched() -> None:
    launches, none = Packed("cpu"), wp.zeros(0, dtype=float, device="cpu")
    for _ in range(2):
        add(launches, 1.0, none, none)


def test_what_is_rehearsed_is_launched_afterwards() -> None:
    launches = Packed("cpu")
    given, found = wp.ones(2, dtype=float, device="cpu"), wp.zeros(2, dtype=float, device="cpu")
    assert [module.name for module, _ in rehearse(lambda: add(launches, 1.0, given, found))] == [add_times.module.name]
    assert found.numpy().tolist() == [0.0, 0.0]
    add(launches, 1.0, given, found)
    assert found.numpy().tolist() == [1.0, 1.0]


def test_arrays_that_come_and_go_are_told_apart(monkeypatch) -> None:
    """Where one was, another may come to be: a launch keeps its own as long as it is kept, which is not for ever."""
    monkeypatch.setattr(packed, "MOST", 4)
    launches, found = Packed("cpu"), wp.zeros(2, dtype=float, device="cpu")
    for k in range(20):
        given = wp.full(2, float(k), dtype=float, device="cpu")
        add(launches, 1.0, given, found)
        assert len(launches._kept) <= 4
    assert found.numpy().tolist() == [190.0, 190.0]


def test_a_graph_has_what_is_launched_while_it_is_recorded() -> None:
    launches = Packed("cpu")
    given, found = wp.ones(2, dtype=float, device="cpu"), wp.zeros(2, dtype=float, device="cpu")
    add(launches, 1.0, given, found)
    with wp.ScopedCapture(device="cpu") as capture:
        add(launches, 1.0, given, found)
    found.zero_()
    for _ in range(3):
        wp.capture_launch(capture.graph)
    assert found.numpy().tolist() == [3.0, 3.0]
