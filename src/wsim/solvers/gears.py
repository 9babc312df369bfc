"""Which of two joints a gear's row counts in, for the row to be as hard as all others.

MuJoCo gives the row q1 = c0 + c1 q2 a regularisation by the mobilities of both joints, w1 + w2, where the row itself
feels w1 + c1^2 w2. Written the other way it feels w2 + w1 / c1^2: one of the two is nearer. A rack of 1 kg that hangs
on the friction of a pinion of 10 g, c1 = 5 mm, w1 = 1 / kg and w2 = 8e6 / (kg m^2), sank by 0.13 m in 0.3 s.
"""

from __future__ import annotations

from typing import Any

import numpy as np

Array = np.ndarray


def gears_to_turn(mujoco: Any, model: Any) -> Array:
    """The gears among a model's equality constraints that are to be written the other way, (gears,)."""
    gears = np.flatnonzero((model.eq_type == int(mujoco.mjtEq.mjEQ_JOINT)) & (model.eq_obj2id >= 0))
    one, two = (model.dof_invweight0[model.jnt_dofadr[end[gears]]] for end in (model.eq_obj1id, model.eq_obj2id))
    square = model.eq_data[gears, 1] ** 2
    softer = (one + two) / np.maximum(one + square * two, 1e-300)
    return np.asarray(gears[np.abs(np.log(np.maximum(softer * square, 1e-300))) < np.abs(np.log(softer))])


def turned(data: Array, gears: Array) -> Array:
    """Constraints' numbers (..., constraints, n) with those of some gears for q2 = (q1 - c0) / c1."""
    found = data.copy()
    found[..., gears, 0] = -data[..., gears, 0] / data[..., gears, 1]
    found[..., gears, 1] = 1.0 / data[..., gears, 1]
    return found
