"""How hard MuJoCo makes a body's contacts."""

from __future__ import annotations

from typing import Any

import numpy as np

Array = np.ndarray


def yielding(model: Any, kinematic: Array) -> Array:
    """What each body yields to a push [1/kg], (bodies,), from which MuJoCo takes how hard its contacts are.

    MuJoCo measures it at the centre of mass, where a seesaw does not yield at all, and its contacts would be hard
    without bound; away from there it yields, by no less than about a tenth of what its mass would. Kinematic bodies do
    not yield, whatever they weigh: through a paddle of 10 g a ball of a ton would go.

    Args:
        model: MuJoCo's.
        kinematic: Its numbers of the kinematic bodies.
    """
    moves = model.body_weldid > 0
    moves[kinematic] = False
    by_mass = np.where(moves, 0.1 / np.maximum(model.body_mass, 1e-12), 0.0)
    own = model.body_invweight0[:, 0].copy()
    own[kinematic] = 0.0
    return np.maximum(own, by_mass)
