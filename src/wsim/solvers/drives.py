"""Drives that damp, as constraint rows: their effort is that of the speed at the step's end, and is bounded.

MuJoCo takes a drive's damping into its implicit step after the constraints are solved, and leaves it there where the
effort is clipped: a motor at its largest effort F would give F / (1 + c h / I), and a gear or a stop would be solved
for accelerations that are not made. As a row of dry friction a drive gives clip(f - c h a), f its effort at the step's
start and a the acceleration of the step: implicit in the speed, at most F, and solved together with all else.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
import warp as wp

from wsim.kernels.drives import aim_drives, take_over

Array = np.ndarray
STIFF_SHARE = 0.5  # of a speed, lost in a step
STIFF_GROUP = 30  # of MuJoCo's actuators, the last that can be disabled


@dataclass(frozen=True)
class DriveRow:
    """A drive under MuJoCo's numbers of its tendon, which gives the row, its degree of freedom and its actuators."""

    tendon: int
    dof: int
    actuators: tuple[int, ...]
    damping: float  # [N s/m or N m s/rad]


def drive_rows(mujoco: Any, model: Any) -> list[DriveRow]:
    """The drives to which `wsim.sim.drives` gave a tendon.

    Args:
        mujoco: The module.
        model: MuJoCo's model.
    """
    found = []
    for tendon in range(model.ntendon):
        first = model.tendon_adr[tendon]
        if model.wrap_type[first] != mujoco.mjtWrap.mjWRAP_JOINT:
            continue
        joint = model.wrap_objid[first]
        drives = (model.actuator_trntype == mujoco.mjtTrn.mjTRN_JOINT) & (model.actuator_trnid[:, 0] == joint)
        actuators = np.flatnonzero(drives)
        own = tuple(actuators.tolist())
        found.append(DriveRow(tendon, int(model.jnt_dofadr[joint]), own, _damping(model, own)))
    return found


def _damping(model: Any, actuators: tuple[int, ...]) -> float:
    return -float(model.actuator_biasprm[list(actuators), 2].sum())


class DrivesC:
    """Drives as rows of MuJoCo in C, in whatever step is solved for accelerations.

    Args:
        mujoco: The module.
        model: MuJoCo's model; the actuators of drives that are stiff get a group of their own.
        rows: Its drives.
        time_step: Of the steps to come [s].

    Attributes:
        stiff: Whether a drive takes a speed away in about a step, so that Runge and Kutta's stages cannot follow it.
        held: MuJoCo's flag of the actuators of those.
    """

    def __init__(self, mujoco: Any, model: Any, rows: list[DriveRow], time_step: float) -> None:
        self.mujoco, self.model, self._rows = mujoco, model, rows
        self._dofs = np.array([row.dof for row in rows])
        self._of_tendon = np.full(model.ntendon, -1)
        self._of_tendon[[row.tendon for row in rows]] = np.arange(len(rows))
        self._kind = int(mujoco.mjtConstraint.mjCNSTR_FRICTION_TENDON)
        self._damping = np.array([row.damping for row in rows])
        self._moment = np.zeros((len(rows), model.nu))
        for k, row in enumerate(rows):
            self._moment[k, list(row.actuators)] = 1.0
        self._off, self._are_rows = int(mujoco.mjtDisableBit.mjDSBL_FRICTIONLOSS), True
        self.stiff = self._rates() * time_step > STIFF_SHARE
        self.held = 1 << STIFF_GROUP
        for k in np.flatnonzero(self.stiff).tolist():
            model.actuator_group[list(rows[k].actuators)] = STIFF_GROUP

    def _rates(self) -> Array:
        """How fast the damping of all of them may take away each one's speed, where the model starts, (drives,) [1/s].

        These are Gershgorin's circles of the mobility times the damping.
        """
        mujoco, model = self.mujoco, self.model
        data, unit = mujoco.MjData(model), np.eye(model.nv)[self._dofs]
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_makeM(model, data)
        mujoco.mj_factorM(model, data)
        yields = np.zeros_like(unit)
        mujoco.mj_solveM(model, data, yields, unit)
        return np.asarray(np.abs(yields[:, self._dofs]) @ self._damping)

    def stiff_rows(self, data: Any) -> Array:
        """The rows of stiff drives in a solution."""
        rows, order = self._drive_rows(data)
        return np.asarray(rows[self.stiff[order]])

    def _drive_rows(self, data: Any) -> tuple[Array, Array]:
        """The rows of drives in a solution, and the drives that they are of."""
        rows = np.flatnonzero(data.efc_type == self._kind)
        drives = self._of_tendon[data.efc_id[rows]]
        own = drives >= 0  # another tendon's friction is no drive's
        return rows[own], drives[own]

    def choose(self, data: Any, are_rows: bool) -> None:
        """Let the drives be rows in this step, or else MuJoCo's actuators, as Runge and Kutta's stages take them."""
        if are_rows == self._are_rows:
            return
        self._are_rows = are_rows
        self.model.opt.disableflags ^= self._off
        self.mujoco.mj_makeConstraint(self.model, data)
        self.mujoco.mj_island(self.model, data)
        self.mujoco.mj_projectConstraint(self.model, data)

    def take_over(self, data: Any) -> None:
        """Give the rows their law, and take the drives out of what is applied."""
        if not self._are_rows:
            return
        data.qfrc_actuator[self._dofs] = 0.0
        rows, order = self._drive_rows(data)
        weight = self._damping[order] * self.model.opt.timestep
        data.efc_D[rows], data.efc_R[rows] = weight, 1.0 / weight
        if data.nisland:  # MuJoCo solves copies, sorted by what hangs together
            copies = data.map_efc2iefc[rows]
            data.iefc_D[copies], data.iefc_R[copies] = weight, 1.0 / weight
        data.efc_aref[rows] = (self._moment @ data.actuator_force)[order] / weight


class DrivesWarp:
    """Drives as rows of MuJoCo Warp, in the law's steps.

    Args:
        hosts: MuJoCo's model of all worlds alike, or of each in turn (`wsim.solvers.host_models`).
        rows: The drives of the first.
        worlds: How many there are.
    """

    def __init__(self, hosts: Iterable[Any], rows: list[DriveRow], worlds: int) -> None:
        damping, mobility = [], []
        for host in hosts:
            own = np.zeros(host.ntendon)
            for row in rows:
                own[row.tendon] = _damping(host, row.actuators)
            damping.append(own)
            mobility.append(host.tendon_invweight0.copy())
        dofs = np.zeros(len(damping[0]), dtype=int)
        for row in rows:
            dofs[row.tendon] = row.dof
        pairs = [(*row.actuators, -1)[:2] for row in rows]
        self._count = len(rows)
        self._dof = wp.array([row.dof for row in rows], dtype=int)
        self._tendon = wp.array([row.tendon for row in rows], dtype=int)
        self._actuator = wp.array(np.array(pairs), dtype=int)
        numbers = [wp.array(np.array(each), dtype=float) for each in (damping, mobility)]
        self._of_tendon = [*numbers, wp.array(dofs, dtype=int)]
        self._effort = wp.zeros((worlds, len(dofs)), dtype=float)

    def take_over(self, data: Any) -> None:
        """Take the drives out of what is applied."""
        wp.launch(
            take_over,
            dim=(data.nworld, self._count),
            inputs=[self._dof, self._tendon, self._actuator, data.actuator_force],
            outputs=[self._effort, data.qfrc_actuator],
        )

    def aim(self, model: Any, data: Any) -> None:
        """Give the rows their law."""
        efc = data.efc
        wp.launch(
            aim_drives,
            dim=(data.nworld, data.njmax),
            inputs=[
                data.nefc, efc.type, efc.id, *self._of_tendon, self._effort, efc.frictionloss, data.qacc_smooth,
                data.qacc_warmstart, model.opt.timestep,
            ],
            outputs=[efc.D, efc.aref],
        )  # fmt: skip
