"""What fluid gives to bodies by running against their faces, beside its pressure."""

from __future__ import annotations

from typing import Any

import warp as wp

from wsim.kernels.sph.blows import add_blows

QUANTUM = 1e-9  # of the heaviest particle's mass times the spacing per step


class Blows:
    """Impulses on bodies of a model, added up in whole numbers of a quantum: their order is all one.

    Args:
        model: The `newton.Model`.
        spacing: Between particles [m].
        wanted: Whether any body has faces.

    Attributes:
        impulse: On each body about its centre of mass, in quanta; in quanta times a spacing (bodies, 6).
    """

    def __init__(self, model: Any, spacing: float, wanted: bool) -> None:
        self.spacing = spacing
        self.impulse = wp.zeros((model.body_count if wanted else 0, 6), dtype=wp.int64)
        self._least = QUANTUM * float(model.particle_mass.numpy().max(initial=0.0)) * spacing  # [kg m]

    def quantum(self, dt: float) -> float:
        """Of a step of dt [s], in N s."""
        return self._least / dt

    def give_back(self, dt: float, body_wrench: wp.array, body_f: wp.array) -> None:
        """Add what bodies were given since the last call to the wrenches on them, as a force over a step of dt [s]."""
        if len(self.impulse):
            wp.launch(
                add_blows,
                dim=len(self.impulse),
                inputs=[self.quantum(dt), self.spacing, dt],
                outputs=[self.impulse, body_wrench, body_f],
            )
