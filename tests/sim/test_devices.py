"""Which device "auto" takes."""

from __future__ import annotations

import pytest

from wsim.errors import UserError
from wsim.scene.world import Fluid, World
from wsim.sim.devices import choose_device, known_device, pick_device

WATER = Fluid(prim="/World/Water", density=1000.0, viscosity=1e-3, spacing=0.01, size=(1, 1, 1), center=(0, 0, 0))
BODIES, TANK = World(), World(fluids=[WATER])


@pytest.mark.parametrize(
    ("cuda", "world", "world_count", "device", "why"),
    [
        ((), BODIES, 1, "cpu", "cpu: no CUDA device is here"),
        ((), TANK, 8192, "cpu", "cpu: no CUDA device is here"),
        (("cuda:0", "cuda:1"), BODIES, 1, "cpu", "cpu: rigid bodies alone, one world"),
        (("cuda:0", "cuda:1"), BODIES, 8192, "cuda:0", "cuda:0: 8,192 worlds at once"),
        (("cuda:1",), TANK, 1, "cuda:1", "cuda:1: a fluid"),
    ],
)
def test_auto_takes_what_is_quicker(cuda, world, world_count, device, why):
    assert choose_device(cuda, world, world_count) == (device, why)


def test_a_named_device_is_taken_whatever_the_world():
    assert pick_device("cpu", TANK, 64) == "cpu"
    with pytest.raises(UserError, match="device 'cuda:77' is not here"):
        known_device("cuda:77")
