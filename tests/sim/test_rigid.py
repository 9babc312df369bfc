"""Buffers of a solver that steps many worlds."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tests.sim.test_batch import loose
from wsim.scene import Scene
from wsim.scene.describe import describe
from wsim.sim.model import build_model
from wsim.sim.rigid import CONTACTS_A_PAIR, contact_capacity


def test_a_world_has_as_much_room_for_contacts_among_others_as_alone(tmp_path: Path) -> None:
    scene = Scene()
    loose(scene, np.random.default_rng(1))
    for k in range(3):
        scene.box(f"wall_{k}", size=(0.1, 0.1, 0.1), position=(k, 9, 0.05), static=True)
    stage = scene.save(tmp_path / "stage.usda")
    pairs = 3 + 3 * 4  # three bodies, by twos, and each with the ground and three walls
    for worlds in (1, 4):
        assert contact_capacity(build_model(stage, describe(stage), "cpu", worlds).model) == CONTACTS_A_PAIR * pairs
