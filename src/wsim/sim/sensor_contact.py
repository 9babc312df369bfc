"""Contact sensors: what contacts push bodies with."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wsim.geometry.rotations import conjugate, multiply, rotate
from wsim.sim.joint_arrays import in_every_world

if TYPE_CHECKING:
    from wsim.sim.model import Built


class Contact:
    """Reads one sensor in W worlds.

    Args:
        built: The model.
        k: Which of the world's sensors it is.
        interval: Between samples [s].
        seeds: What each world's noise differs by; it has none.

    Attributes:
        spans: Whether a sample tells of the time before it.
    """

    spans = True

    def __init__(self, built: Built, k: int, interval: float, seeds: Sequence[int]) -> None:
        worlds = max(1, built.model.world_count)
        stated: list[Any] = [built.world_of(w).sensors[k] for w in range(worlds)]
        row = [body.prim for body in built.world.bodies].index(stated[0].body)
        self._bodies = in_every_world(built.bodies[[row]], worlds, built.model.body_count)[:, 0]
        self._rotation = np.array([each.rotation for each in stated])
        self._threshold = np.array([each.threshold for each in stated])

    def __call__(self, t: float, simulation: Any) -> dict[str, NDArray[np.float64]]:
        """`force` [N], (W, 3), and `touching`, 1 or 0, (W,); nothing touches at the start, before the first step."""
        if t == 0.0:
            return {"force": np.zeros_like(self._rotation[:, :3]), "touching": np.zeros(len(self._bodies))}
        pressed = simulation.rigid.pressed
        pressed.measure()
        turn = multiply(simulation.state.body_q.numpy()[self._bodies, 3:].astype(np.float64), self._rotation)
        return {
            "force": rotate(conjugate(turn), pressed.force.numpy()[self._bodies]),
            "touching": (pressed.load.numpy()[self._bodies] > self._threshold).astype(np.float64),
        }
