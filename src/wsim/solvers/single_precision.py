"""How hard constraints may be where MuJoCo is solved in single precision."""

from __future__ import annotations

from typing import Any

import numpy as np

from wsim.solvers.contact_law import ContactConfig

SOFTER = (0.999, 0.99, 0.9)  # MuJoCo's own is 0.9 to 0.95
LARGEST_CONDITION = 1e7  # of what is factored, its diagonal scaled to one (Demmel 1989): 24 bits hold 1.7e7


def soften_for_single_precision(mujoco: Any, model: Any, config: ContactConfig) -> None:
    """Give loops the hardest impedance with which MuJoCo Warp can factor what it solves.

    That is M + J^T D J, over the coordinates that loops bind. A cable whose other end is held is a long tree of light
    links: at the law's impedance single precision finds no Cholesky factor of it.

    Args:
        mujoco: The module.
        model: MuJoCo's model; `eq_solimp` is changed.
        config: The law's.
    """
    hard = np.flatnonzero(model.eq_solimp[:, 0] == config.impedance) if model.neq else ()
    if not len(hard):
        return
    condition = _condition(mujoco, model)
    for softer in SOFTER:
        if condition < LARGEST_CONDITION:
            return
        before = model.eq_solimp[hard, :2].copy()
        model.eq_solimp[hard, :2] = softer
        less = _condition(mujoco, model)
        if less > 0.5 * condition:  # it is not the loops that are at fault
            model.eq_solimp[hard, :2] = before
            return
        condition = less


def _condition(mujoco: Any, model: Any) -> float:
    """Of M + J^T D J as the world starts, its diagonal scaled to one."""
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    rows = np.flatnonzero(data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY)
    jacobian = np.zeros((data.nefc, model.nv))
    if mujoco.mj_isSparse(model):
        mujoco.mju_sparse2dense(jacobian, data.efc_J, data.efc_J_rownnz, data.efc_J_rowadr, data.efc_J_colind)
    else:
        jacobian[:] = data.efc_J.reshape(-1, model.nv)
    held = np.flatnonzero(jacobian[rows].any(axis=0))  # the loops' own coordinates: a world may have thousands
    loops = jacobian[np.ix_(rows, held)]
    factored = mass[np.ix_(held, held)] + loops.T @ (data.efc_D[rows, None] * loops)
    scale = 1.0 / np.sqrt(np.diag(factored))
    return float(np.linalg.cond(scale[:, None] * factored * scale))
