"""Loose bodies in flight: how they turn, and where they are, beyond what MuJoCo's step and single precision give.

MuJoCo takes a body's gyroscopic torque at the step's start and makes it implicit, which costs a body that tumbles its
energy, by the square of what it turns in a step. Here the spin of the step's end follows from the free motion over the
step; contacts see it as a smooth force. Where gravity, and what touches a body, are all that acts on it after the
step's blows, and it accelerates evenly, the step goes the way of the mean of its first and last velocities: falls,
throws, slides and rolling are exact, where v += a h, x += v h would come a t h / 2 too far. What a contact leads to and
fro, or round a bend, goes by the latter, which is symplectic: by the mean it would gain energy. There its velocity is
that of half a step before, and the state is told the one at its place. Newton's state is in
single precision, where a kilometre has steps of 0.06 mm: what is true between two steps is kept beside it in double,
for as long as nobody else writes the state.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import newton
import numpy as np
import warp as wp

from wsim.kernels.blows import jump
from wsim.kernels.flight import Loose, Noted, fly, keep, recall, say, tumble
from wsim.solvers.packed import Packed

Array = np.ndarray
STATED, OTHER = -1, -2  # rows of bodies that are not loose: that go as is stated, or by joints
NEVER = 2**30  # steps
SETTLING = 3  # steps that a start takes
EVEN = 0.1  # change of an acceleration that is none [m/s^2]: five times what a gap of 3e-8 m, rounding, makes of it
PATIENCE = 0.02  # without a jolt, for which it must have been even [s]
ROUGH = 0.1  # by which an acceleration changes otherwise than in the step before, where it jolts [m/s^2]


class Flight:
    """What a solver's joints are at, and the steps of its loose bodies.

    Args:
        mujoco: The module of MuJoCo in C.
        solver: Newton's MuJoCo solver.
        data: MuJoCo's data that it steps, in C or in Warp.
        hosts: MuJoCo's model of all worlds alike, or of each in turn (`wsim.solvers.host_models`).
    """

    def __init__(self, mujoco: Any, solver: Any, data: Any, hosts: Iterable[Any]) -> None:
        model = solver.model
        self._packed = Packed(model.device)
        self.model, self._qpos, self._qvel = model, _rows(data.qpos), _rows(data.qvel)
        self._qacc, self._bias, self._held = _rows(data.qacc), _rows(data.qfrc_bias), _rows(data.qfrc_constraint)
        self._pushed = _rows(data.qfrc_smooth)
        kinematic = (model.body_flags.numpy() & int(newton.BodyFlags.KINEMATIC)) != 0
        place, freedom = solver.mj_q_start.numpy(), solver.mj_qd_start.numpy()
        self.joints = len(place)
        ours = ~kinematic[model.joint_child.numpy()[: self.joints]] & (place >= 0)
        loose = _loose(mujoco, solver.mj_model, place[ours])
        center, principal, moments, arm = _inertia(mujoco, hosts, loose)
        jnt = solver.mj_model.body_jntadr[loose]
        shape = self._qpos.shape[0], len(loose)
        self._bodies = loose
        rows = _rows_of_bodies(solver, loose, place[kinematic[model.joint_child.numpy()[: self.joints]]])
        with wp.ScopedDevice(model.device):
            self._joints = [wp.array(np.where(ours, start, -1), dtype=int) for start in (place, freedom)]
            self._loose, self._noted = Loose(), Noted()
            self._loose.place = wp.array(solver.mj_model.jnt_qposadr[jnt], dtype=int)
            self._loose.freedom = wp.array(solver.mj_model.jnt_dofadr[jnt], dtype=int)
            self._loose.body = wp.array(solver.mjc_body_to_newton.numpy()[:, loose], dtype=int)
            self._loose.center = wp.array(center, dtype=wp.vec3d)
            self._loose.principal = wp.array(principal, dtype=wp.quatd)
            self._loose.moments = wp.array(moments, dtype=wp.vec3d)
            self._loose.arm = wp.array(arm, dtype=wp.float64)
            self._loose.tied = wp.array(_tied(mujoco, solver.mj_model, loose), dtype=int)
            self._change = wp.zeros(shape, dtype=wp.vec3d)
            for name in ("known", "gain", "trend", "shift"):
                setattr(self._noted, name, wp.zeros((*shape, 2), dtype=wp.vec3d))
            for name in ("calm", "behind", "since"):
                setattr(self._noted, name, wp.zeros(shape, dtype=int))
            self._noted.ahead = wp.zeros(model.body_count, dtype=wp.spatial_vector)
            self.row = wp.array(rows, dtype=int)  # of each of MuJoCo's bodies among the loose ones, or below 0
            self._row_of_joint = wp.array(_rows_of_joints(place, solver.mj_model.jnt_qposadr[jnt]), dtype=int)
            self._true = [wp.zeros(array.shape, dtype=wp.float64) for array in (self._qpos, self._qvel)]
            self._told = [wp.zeros(n, dtype=float) for n in (model.joint_coord_count, model.joint_dof_count)]
        # Of C's numbers: a kernel's launch takes longer than a step of a small world.
        in_c = [(true.numpy(), array.numpy()) for true, array in zip(self._true, (self._qpos, self._qvel), strict=True)]
        self._shared = in_c if isinstance(data.qpos, Array) else []
        self._row_c, self._since_c, self._behind_c = rows, self.since.numpy()[0], self._noted.behind.numpy()
        self._lead = np.zeros((*shape, 2, 3))
        self.forget()

    def forget(self) -> None:
        """Start from the state, whatever was told."""
        for told in self._told:
            told.fill_(math.nan)
        noted = self._noted
        for array in (noted.known, noted.gain, noted.trend):
            array.fill_(math.nan)  # nothing is a jolt at a start
        noted.calm.fill_(-SETTLING)
        for array in (noted.shift, noted.behind, noted.since, noted.ahead):
            array.zero_()
        self._lead[:] = 0.0

    def recall(self, state: Any) -> None:
        """Put what is true of `state` into MuJoCo's data, which has it in single precision."""
        model = self.model
        self._packed.launch(
            recall,
            dim=(self._qpos.shape[0], self.joints),
            inputs=[
                state.joint_q, state.joint_qd, *self._told, self.joints, model.joint_q_start, model.joint_qd_start,
                *self._joints, self._row_of_joint, self._loose,
            ],
            outputs=[self._noted, *self._true, self._qpos, self._qvel],
            changing=(state.joint_q, state.joint_qd),
        )  # fmt: skip

    def say(self, *, centred: bool) -> None:
        """Give MuJoCo the velocities that loose bodies have where they are, or those that their steps go on from."""
        if self._shared and not (self._behind_c > 0).any():
            return
        self._packed.launch(
            say,
            dim=self._change.shape,
            inputs=[self._loose, self._noted, *self._true, int(centred)],
            outputs=[self._qvel],
            changing=(centred,),
        )

    def take_lead(self) -> tuple[Array, Array]:
        """What velocities of loose bodies gained since the last call that no force gave them.

        Where a velocity is told half a step after the one that steps go on from, the force that acts in between is not
        known yet: it is taken for the last one.

        Returns:
            MuJoCo's numbers of the bodies, (bodies,), and for each world the gain of the velocity of their centres of
            mass [m/s] and of their angular momentum about them [kg m^2/s], (worlds, bodies, 2, 3).
        """
        lags = self._noted.behind.numpy()[..., None, None] > 0
        lead = self._noted.shift.numpy() + np.where(lags, self._noted.gain.numpy(), 0.0)
        gained, self._lead = lead - self._lead, lead
        return self._bodies, gained

    def tell(self, state: Any) -> None:
        """Note what `state` says of MuJoCo's data."""
        for told, array in zip(self._told, (state.joint_q, state.joint_qd), strict=True):
            wp.copy(told, array)

    def keep(self) -> None:
        """Note what MuJoCo's data say at a step's end."""
        if self._shared:
            for true, array in self._shared:
                true[:] = array
            return
        for true, array in zip(self._true, (self._qpos, self._qvel), strict=True):
            wp.launch(keep, dim=array.shape, inputs=[array], outputs=[true], device=self.model.device)

    def since_exact(self, bodies: Array) -> Array:
        """Of bodies in C, the steps of the first order since they went exactly."""
        known = np.append(self._since_c, [NEVER, 0])  # at OTHER, and at STATED
        return np.asarray(known[self._row_c[bodies]])

    @property
    def since(self) -> Any:
        """Steps of the first order of loose bodies since they went exactly, (worlds, bodies)."""
        return self._noted.since

    @property
    def ahead(self) -> Any:
        """By how much velocities at the next step's end are ahead of those told, (bodies,), if forces stay."""
        return self._noted.ahead

    @property
    def stated(self) -> Array:
        """Whether a body of MuJoCo's goes as is stated, (bodies,): the world does."""
        return np.asarray(self._row_c == STATED)

    @property
    def speeds(self) -> list[Any]:
        """The velocities that steps go on from, and what they are in double precision, arrays of Warp's."""
        return [self._qvel, self._true[1]]

    def jump(self, search: Any, timestep: Any) -> None:
        """Take in Warp the velocities after a round of blows, in the worlds that it is one of."""
        wp.launch(
            jump,
            dim=self._qvel.shape,
            inputs=[search, timestep, self._qacc],
            outputs=[self._true[1], self._qvel],
            device=self.model.device,
        )

    def tumble(self, h: float) -> None:
        """Mend the bias of loose bodies, between what hangs on velocities and the accelerations."""
        self._packed.launch(
            tumble,
            dim=self._change.shape,
            inputs=[self._loose, wp.float64(h), self._true[1]],
            outputs=[self._change, self._bias],
            changing=(h,),
        )

    def fly(self, h: float) -> None:
        """Advance the loose bodies by `h` [s] in place of MuJoCo, which has."""
        self._packed.launch(
            fly,
            dim=self._change.shape,
            inputs=[
                self._loose, wp.float64(h), self._change, self._qacc, self._held, self._pushed, self._bias,
                wp.float64(EVEN), wp.float64(PATIENCE), wp.float64(ROUGH),
            ],
            outputs=[self._noted, *self._true, self._qpos, self._qvel],
            changing=(h,),
        )  # fmt: skip


def _rows(values: Any) -> Any:
    """MuJoCo's numbers as an array of Warp's, a row a world; those of C are shared, not copied."""
    return wp.array(values[None], dtype=wp.float64, device="cpu", copy=False) if isinstance(values, Array) else values


def _loose(mujoco: Any, model: Any, places: Array) -> Array:
    """MuJoCo's bodies on a free joint that nothing hangs on by another, (bodies,); `places` are joints' in qpos."""
    freedoms = np.bincount(model.dof_treeid[model.dof_treeid >= 0], minlength=model.ntree)
    free = model.jnt_type == int(mujoco.mjtJoint.mjJNT_FREE)
    alone = freedoms[model.dof_treeid[model.jnt_dofadr]] == 6
    return np.asarray(model.jnt_bodyid[free & alone & np.isin(model.jnt_qposadr, places)])


def _rows_of_bodies(solver: Any, loose: Array, led: Array) -> Array:
    """Of each of MuJoCo's bodies its row among the loose ones; STATED of what goes as stated, else OTHER."""
    model = solver.mj_model
    rows = np.full(model.nbody, OTHER)
    rows[loose] = np.arange(len(loose))
    rows[0] = STATED
    rows[model.jnt_bodyid[np.isin(model.jnt_qposadr, led)]] = STATED
    return rows


def _rows_of_joints(place: Array, loose: Array) -> Array:
    """Of joints that stand at these places in qpos the rows of the loose bodies' among them, or -1."""
    same = place[:, None] == loose[None]
    return np.where(same.any(axis=1), same.argmax(axis=1) if len(loose) else 0, -1)


def _tied(mujoco: Any, model: Any, loose: Array) -> Array:
    """1 where a tendon or an equality may hold each of some bodies, -1 where others are fixed to it, (bodies,)."""
    kinds = mujoco.mjtWrap
    sites = model.wrap_objid[model.wrap_type == int(kinds.mjWRAP_SITE)]
    geoms = model.wrap_objid[np.isin(model.wrap_type, [int(kinds.mjWRAP_SPHERE), int(kinds.mjWRAP_CYLINDER)])]
    bodies = [model.site_bodyid[sites], model.geom_bodyid[geoms]]
    acts = model.eq_active0 != 0  # Newton gives each loose body a weld, in case it is led
    body, site = (model.eq_objtype == int(kind) for kind in (mujoco.mjtObj.mjOBJ_BODY, mujoco.mjtObj.mjOBJ_SITE))
    for ends in (model.eq_obj1id, model.eq_obj2id):
        bodies += [ends[acts & body], model.site_bodyid[ends[acts & site]]]
    carries = np.isin(loose, model.body_parentid)
    return np.where(np.isin(loose, np.concatenate(bodies)), 1, np.where(carries, -1, 0)).astype(np.int32)


def _inertia(mujoco: Any, hosts: Iterable[Any], bodies: Array) -> tuple[Array, Array, Array, Array]:
    """Of each body with what is fixed to it, in its axes: centre of mass [m], principal axes and moments [kg m^2].

    All are (worlds, bodies, …). Moments rise; the axes are a turn xyzw. Last comes the greatest radius of gyration [m].
    """
    found: list[tuple[Array, Array, Array]] = []
    data: Any = None
    for host in hosts:
        if data is None:
            data = mujoco.MjData(host)
        else:  # of the same object, with other numbers
            mujoco.mj_resetData(host, data)
        mujoco.mj_kinematics(host, data)
        mujoco.mj_comPos(host, data)
        mujoco.mj_crb(host, data)
        axes, inertia = data.xmat[bodies].reshape(-1, 3, 3), data.crb[bodies]
        center = np.einsum("nji,nj->ni", axes, data.subtree_com[bodies] - data.xpos[bodies])
        around = inertia[:, [0, 3, 4, 3, 1, 5, 4, 5, 2]].reshape(-1, 3, 3)
        found.append((center, np.einsum("nji,njk,nkl->nil", axes, around, axes), inertia[:, 9]))
    centers, around, masses = (np.stack(each) for each in zip(*found, strict=True))
    moments, principal = np.linalg.eigh(around)
    principal[..., 2] *= np.sign(np.linalg.det(principal))[..., None]
    turns = np.zeros((*masses.shape, 4))
    for turn, matrix in zip(turns.reshape(-1, 4), principal.reshape(-1, 9), strict=True):
        mujoco.mju_mat2Quat(turn, matrix)
    return centers, turns[..., [1, 2, 3, 0]], moments, np.sqrt(moments[..., 2] / masses)
