"""The Unitree Go2 and its policy, walking."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.intake.go2 import go2
from tests.sim.test_policies_on_device import by_kernels
from wsim.intake.robots import TakenIn
from wsim.scene import Scene
from wsim.sim import Simulation

__all__ = ["go2"]


@pytest.mark.parametrize(
    ("device", "worlds"), [("cpu", 1), pytest.param("cuda:0", 1, marks=pytest.mark.cuda),
                           pytest.param("cuda:0", 16, marks=pytest.mark.cuda)]
)  # fmt: skip
def test_a_second_of_walking_is_the_same_by_kernels(go2: TakenIn, tmp_path: Path, device: str, worlds: int) -> None:
    """What differs is rounding, which feet on the ground make more of: on a GPU another solver, too, steps it."""
    scene = Scene()
    scene.simulation(duration=1.0, frame_rate=50.0)
    scene.ground()
    scene.policy("walk", scene.robot("go2"), "go2_walk", command=(0.5, 0.0, 0.3))
    stage = scene.save(tmp_path / "stage.usda")
    host, kernels = Simulation(stage, device="cpu"), Simulation(stage, device=device, world_count=worlds)
    by_kernels(kernels)
    for _ in range(50):
        host.advance_frame()
        kernels.advance_frame()
    assert host.problems() == kernels.problems() == []
    one, all_ = host.state.joint_q.numpy(), kernels.state.joint_q.numpy().reshape(worlds, -1)
    assert one[0] > 0.2
    place, angle = (1e-5, 5e-5) if device == "cpu" else (0.03, 0.3)
    assert np.abs(all_[:, :3] - one[:3]).max() < place
    assert np.abs(all_[:, 7:] - one[7:]).max() < angle
