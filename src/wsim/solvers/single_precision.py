"""How hard constraints may be where MuJoCo is solved in single precision."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from wsim.solvers.contact_config import ContactConfig

Array = np.ndarray
SOFTER = (0.999, 0.99, 0.9)  # MuJoCo's own is 0.9 to 0.95
SOFT_CONTACT = 0.98  # MuJoCo takes the mean with the other surface's: 0.99 against what is hard
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
    hard = np.flatnonzero((model.eq_solimp[:, 0] == config.impedance) & (model.eq_active0 != 0))
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
    data, mass = _at_start(mujoco, model)
    rows = np.flatnonzero(data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY)
    jacobian = np.zeros((data.nefc, model.nv))
    if mujoco.mj_isSparse(model):
        mujoco.mju_sparse2dense(jacobian, data.efc_J, data.efc_J_rownnz, data.efc_J_rowadr, data.efc_J_colind)
    else:
        jacobian[:] = data.efc_J.reshape(-1, model.nv)
    held = np.flatnonzero(jacobian[rows].any(axis=0))  # the loops' own coordinates: a world may have thousands
    loops = jacobian[np.ix_(rows, held)]
    return _scaled_condition(mass[np.ix_(held, held)] + loops.T @ (data.efc_D[rows, None] * loops))


def last_tolerance(model: Any, usual: float, config: ContactConfig) -> float:
    """MuJoCo's tolerance at which a step's last forces leave at most `config.unbalanced` of any body's acceleration.

    MuJoCo Warp ends where a turn lowers the cost by less than this times the trace of M. A contact of a body of mass m
    that lacks a force r of what moves the body costs r^2 / (2 D), D = m d / (1 - d) with d its impedance: so the
    lightest body counts, and how much heavier all others are.

    Args:
        model: MuJoCo's model, of the first of worlds that differ.
        usual: That of other solutions: `config.solver_tolerance_warp`, less where what is locked is in the trace.
        config: The law's.
    """
    trace = float(model.stat.meaninertia * model.nv)
    masses = model.body_mass[(model.body_treeid >= 0) & (model.body_mass > 0.0)]
    if not len(masses) or trace <= 0.0:
        return usual
    harder = config.impedance / (1.0 - config.impedance)
    enough = float(config.unbalanced**2 * masses.min() / (2.0 * harder * trace))
    return usual * min(1.0, enough / config.solver_tolerance_warp)


def tolerance_in_c(model: Any, config: ContactConfig) -> float:
    """MuJoCo's tolerance in C, at which forces leave at most `config.unbalanced_in_c` of any body's acceleration.

    The usual one is a share of the trace of M: beside what is heavy it leaves what is light more (`last_tolerance`).
    """
    if np.bincount(model.body_treeid[model.body_treeid >= 0]).max(initial=0) > 1:
        return config.chain_tolerance
    trace = float(model.stat.meaninertia * model.nv)
    masses = model.body_mass[(model.body_treeid >= 0) & (model.body_mass > 0.0)]
    if not len(masses) or trace <= 0.0:
        return config.solver_tolerance
    harder = config.impedance / (1.0 - config.impedance)
    enough = float(config.unbalanced_in_c**2 * masses.min() / (2.0 * harder * trace))
    return float(np.clip(enough, config.chain_tolerance, config.solver_tolerance))


def soften_contacts_for_single_precision(mujoco: Any, model: Any, config: ContactConfig) -> bool:
    """Soften the contacts of long trees of light links; whether there are such, which Newton's method cannot solve.

    It factors M + J^T D J. In the joints' coordinates a push on the end of a cable of 20 links moves all of them while
    a kink moves one link alone, and hard contacts all along it make a condition of 1e10 and more, against 1e7 of M
    itself. Conjugate gradients factor M alone, and need fewer turns the softer the contacts are: 6 to 20 with these.
    They give way by 1 % of what a push would do without them: 2.5 um under gravity, at 1.25 ms.

    Args:
        mujoco: The module.
        model: MuJoCo's model; `geom_solimp` is changed.
        config: The law's.
    """
    collides = (model.geom_contype | model.geom_conaffinity) > 0
    trees = [np.flatnonzero(model.body_treeid == tree) for tree in range(model.ntree)]
    if all(len(bodies) < 2 for bodies in trees):
        return False
    data, mass = _at_start(mujoco, model)
    ill = []
    for tree, bodies in enumerate(trees):
        geoms = np.flatnonzero(np.isin(model.geom_bodyid, bodies) & collides)
        if len(bodies) > 1 and len(geoms):
            chosen = np.flatnonzero(model.dof_treeid == tree)
            touching = np.unique(model.geom_bodyid[geoms])
            touching = touching[model.body_invweight0[touching, 0] > 0.0]  # a kinematic body does not yield
            pushes = _pushes(mujoco, model, data, touching, config)[:, chosen]
            if _scaled_condition(mass[np.ix_(chosen, chosen)] + pushes.T @ pushes) > LARGEST_CONDITION:
                ill += geoms.tolist()
    model.geom_solimp[ill, :2] = SOFT_CONTACT
    return bool(ill)


def beyond_single_precision(mujoco: Any, model: Any, label: Callable[[int], str]) -> list[str]:
    """What hangs together and whose mass matrix single precision may not be able to solve with, a line of each.

    Of a condition k the accelerations are known to some 6e-8 k of them (Higham 2002, 7.1): from 1.7e7 on, the links of
    a chain may have any.

    Args:
        mujoco: The module.
        model: MuJoCo's model of a world.
        label: The name of a body, by its number in that.
    """
    found, (_, mass) = [], _at_start(mujoco, model)
    for tree in range(model.ntree):
        chosen, bodies = np.flatnonzero(model.dof_treeid == tree), np.flatnonzero(model.body_treeid == tree)
        condition = _scaled_condition(mass[np.ix_(chosen, chosen)]) if len(bodies) > 1 else 1.0
        if condition > LARGEST_CONDITION:
            lightest, heaviest = (int(bodies[choose(model.body_mass[bodies])]) for choose in (np.argmin, np.argmax))
            found.append(
                f"{label(heaviest)}, of {model.body_mass[heaviest]:.3g} kg, hangs together with "
                f"{len(bodies) - 1} bodies down to {model.body_mass[lightest]:.2g} kg, and the condition of their mass "
                f"matrix is {condition:.1e}: single precision can solve up to {LARGEST_CONDITION:.0e}. Give the light "
                "ones more mass (mass_per_length of a cable) or make them fewer (links), or run one world on a CPU, "
                "in double precision"
            )
    return found


def _pushes(mujoco: Any, model: Any, data: Any, bodies: Array, config: ContactConfig) -> Array:
    """Rows of sqrt(D) J, (3 bodies, coordinates), as if all these bodies touched something that does not move."""
    share, rows = config.impedance / (1.0 - config.impedance), [np.zeros((0, model.nv))]
    for body in bodies:
        push = np.zeros((3, model.nv))
        mujoco.mj_jacBodyCom(model, data, push, None, body)
        rows.append(np.sqrt(share / model.body_invweight0[body, 0]) * push)
    return np.concatenate(rows)


def _at_start(mujoco: Any, model: Any) -> tuple[Any, Array]:
    """MuJoCo's data of the world as it starts, and its mass matrix."""
    data, mass = mujoco.MjData(model), np.zeros((model.nv, model.nv))
    mujoco.mj_forward(model, data)
    mujoco.mj_fullM(model, data, mass)
    return data, mass


def _scaled_condition(matrix: Array) -> float:
    """Of a positive definite matrix, its diagonal scaled to one."""
    scale = 1.0 / np.sqrt(np.diag(matrix))
    return float(np.linalg.cond(scale[:, None] * matrix * scale))
