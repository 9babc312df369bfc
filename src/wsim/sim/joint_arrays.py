"""Where joints and bodies of a world are in the arrays of W worlds, which follow each other."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np


def in_every_world(first: np.ndarray, worlds: int, total: int) -> np.ndarray:
    """Indices (W, n) of the first world's things in all worlds; `total` is how many all worlds have."""
    return np.asarray(first)[None, :] + (total // worlds) * np.arange(worlds)[:, None]


def joint_indices(model: Any, worlds: int, prims: Sequence[str]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Where joints' coordinates, degrees of freedom and targets are, each (W, J)."""
    first: dict[str, int] = {}
    for k, label in enumerate(model.joint_label):
        first.setdefault(str(label), k)
    joints = np.array([first[prim] for prim in prims], dtype=np.int64)
    every = in_every_world(joints, worlds, model.joint_count)
    starts = (model.joint_q_start, model.joint_qd_start, model.joint_target_q_start)
    coordinate, dof, target = (start.numpy()[every] for start in starts)
    return coordinate, dof, target
