"""Kinematic bodies as MuJoCo has them: with inertia that nothing moves."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import numpy as np
import warp as wp

from wsim.kernels.kinematic import push

Array = np.ndarray
RATIO = 1e6  # of a kinematic body's inertia to that of all that moves, which move it by a millionth of their own way


def locked(mujoco: Any, model: Any, bodies: Array) -> Array:
    """Armature of all degrees of freedom, (nv,) [kg or kg m^2], with that which locks some bodies' own.

    Such a body goes on with the velocity that it is given, whatever pushes it or hangs on it. Against turns it has the
    inertia of all that moves at the distance of the farthest, or at 1 m.

    Args:
        mujoco: The module.
        model: MuJoCo's model.
        bodies: Kinematic ones, each on a free joint.
    """
    armature: Array = model.dof_armature.copy()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    moves = model.body_treeid >= 0
    mass = RATIO * float(model.body_mass[moves].sum())
    for body in bodies:
        far = np.linalg.norm(data.xipos[moves] - data.xpos[body], axis=1)
        first = model.body_dofadr[body]
        armature[first : first + 3] = mass
        armature[first + 3 : first + 6] = mass * max(1.0, float(far.max())) ** 2
    return armature


class LeadsC:
    """Takes kinematic bodies from the velocity of one step to that of the next by a force that lasts all the step.

    What hangs on such a body has a velocity relative to it, and would else go along with every change of it as if it
    had no inertia: a pendulum would not feel that its pivot is pulled away.

    Args:
        freedoms: Of the bodies in qvel, (n,).
        inertia: Theirs (`locked`), (n,).
    """

    def __init__(self, freedoms: Array, inertia: Array) -> None:
        self._freedoms, self._inertia = freedoms, inertia
        self.forget()

    def forget(self) -> None:
        """Have the next push take the velocity that it finds for the one to go on from."""
        self._before: Array = np.full(len(self._freedoms), np.nan)

    def push(self, data: Any, dt: float) -> None:
        """Have `data`, which has the velocity of a step of `dt` [s], start with that of the step before."""
        speed = data.qvel[self._freedoms]
        start = np.where(np.isnan(self._before), speed, self._before)
        data.qfrc_applied[self._freedoms] = self._inertia * (speed - start) / dt
        data.qvel[self._freedoms], self._before = start, speed


class LeadsWarp:
    """The same in all worlds of a batch; the inertia is that of all alike, or of each, (N, n)."""

    def __init__(self, freedoms: Array, inertia: Array, worlds: int) -> None:
        self._freedoms, self._inertia = wp.array(freedoms, dtype=int), wp.array(inertia, dtype=float)
        self._before = wp.full((worlds, len(freedoms)), math.nan, dtype=float)

    def forget(self) -> None:
        """Have the next push take the velocity that it finds for the one to go on from."""
        self._before.fill_(math.nan)

    def push(self, data: Any, dt: float) -> None:
        """Have `data`, which has the velocity of a step of `dt` [s], start with that of the step before."""
        wp.launch(
            push,
            dim=self._before.shape,
            inputs=[self._freedoms, self._inertia, dt],
            outputs=[self._before, data.qvel, data.qfrc_applied],
            device=self._before.device,
        )


def lock(solver: Any, hosts: Iterable[Any]) -> tuple[Array, LeadsC | LeadsWarp | None]:
    """Give kinematic bodies inertia that nothing moves, in place of the welds by which Newton holds them.

    A weld yields: by it a bob of 100 kg on a body of 10 g fell 26 % too slowly.

    Args:
        solver: A `wsim.solvers.solver_rigid.SolverRigid`.
        hosts: MuJoCo's model of all worlds alike, or of each (`wsim.solvers.host_models`).

    Returns:
        MuJoCo's numbers of these bodies, and what takes them along.
    """
    model, on_c = solver.mj_model, solver.use_mujoco_cpu
    welds = np.zeros(0, dtype=int) if solver._kinematic_weld_eq_np is None else solver._kinematic_weld_eq_np
    welds = welds[model.eq_active0[welds] != 0]
    bodies: Array = model.eq_obj1id[welds].copy()
    if not len(welds):
        return bodies, None
    inertia = np.array([locked(solver._mujoco, host, bodies) for host in hosts])
    model.dof_armature[:] = inertia[0]
    model.eq_active0[welds] = 0
    solver.mj_data.eq_active[welds] = 0
    freedoms = (model.body_dofadr[bodies][:, None] + np.arange(6)).ravel()
    free = model.stat.meaninertia * model.nv  # of M's trace, by which MuJoCo multiplies its tolerance
    share = free / (free + float(inertia[0].sum()))
    model.opt.tolerance *= share
    if on_c:
        return bodies, LeadsC(freedoms, inertia[0, freedoms])
    solver.give_warp("dof_armature", inertia)
    tolerance, active = solver.mjw_model.opt.tolerance, solver.mjw_data.eq_active.numpy()
    tolerance.assign(tolerance.numpy() * share)
    active[:, welds] = False
    solver.mjw_data.eq_active.assign(active)
    with wp.ScopedDevice(solver.model.device):
        return bodies, LeadsWarp(freedoms, inertia[:, freedoms], solver.mjw_data.nworld)
