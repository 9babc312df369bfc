"""Steps of Runge and Kutta's fourth order for those mechanisms that touch nothing, and for worlds that do not.

A mechanism keeps its energy only with a higher order, and contacts and stops know none: each takes the one step or the
other as it has, at the step's start, a stop or dry friction, or a contact that pushes. Beside a crate that rests a
double pendulum gained 1.8 % of its energy in 5 s by steps of the first order, and a hinged pair that tumbled blew up.
What is hit flies on from the speeds after its blows: by the first order a chain that a ball hit gained up to two thirds
of its energy.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import warp as wp

from wsim.kernels.smooth_steps import count_touching, find_touching, keep_where_touched
from wsim.solvers.groups import tendon_bodies
from wsim.solvers.led import Led

Array = np.ndarray
LARGEST_TURN, MOST_PARTS = 0.05, 32  # of a joint in each part of a step [rad]


class Owners:
    """Which mechanism MuJoCo's numbers are of, 0 for none.

    Args:
        mujoco: The module.
        model: MuJoCo's model.
        of_body: Of each body (`wsim.solvers.groups.mechanisms`).
    """

    def __init__(self, mujoco: Any, model: Any, of_body: Array) -> None:
        self.count = int(of_body.max(initial=0)) + 1  # none among them
        self.of_body, self.of_geom = of_body, of_body[model.geom_bodyid]
        self.of_joint, self.of_dof = of_body[model.jnt_bodyid], of_body[model.dof_bodyid]
        ends = np.append(model.jnt_qposadr, model.nq)
        self.of_place = np.repeat(self.of_joint, np.diff(ends))
        pulled = [tendon_bodies(mujoco, model, k) for k in range(model.ntendon)]
        self.of_tendon = np.array([of_body[bodies].max(initial=0) for bodies in pulled], dtype=int)
        self.closed = np.zeros(self.count, dtype=bool)  # what point-to-point constraints or welds hold
        bodies = model.eq_objtype == int(mujoco.mjtObj.mjOBJ_BODY)
        for ends_of in (model.eq_obj1id, model.eq_obj2id):
            self.closed[of_body[ends_of[bodies & (model.eq_active0 != 0)]]] = True

    def with_motion(self, speed: Array) -> Array:
        """Mechanisms of which a degree of freedom has some `speed`, (nv,); (mechanisms,)."""
        found = np.zeros(self.count, dtype=bool)
        found[self.of_dof[speed != 0.0]] = True
        return found


class SmoothStepsC:
    """Makes the smooth step of mechanisms beside the law's step of all else, one world on the CPU.

    Args:
        mujoco: The module.
        model: MuJoCo's model.
        owners: Which mechanism is whose.
    """

    def __init__(self, mujoco: Any, model: Any, owners: Owners) -> None:
        self._mujoco, self._model, self._owners = mujoco, model, owners
        bits, rows = mujoco.mjtDisableBit, mujoco.mjtConstraint
        self._unilateral = int(bits.mjDSBL_CONTACT | bits.mjDSBL_LIMIT | bits.mjDSBL_FRICTIONLOSS)
        self._of_rows = (
            (int(rows.mjCNSTR_LIMIT_JOINT), owners.of_joint),
            (int(rows.mjCNSTR_FRICTION_DOF), owners.of_dof),
            (int(rows.mjCNSTR_LIMIT_TENDON), owners.of_tendon),
        )
        self._all = int(mujoco.mjtState.mjSTATE_INTEGRATION)
        self._state = np.zeros(mujoco.mj_stateSize(model, self._all))
        self._beside: Any = mujoco.MjData(model) if owners.count > 1 else None
        turns = np.isin(model.jnt_type, [int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_BALL)])
        self._led = Led(model, owners.of_geom)
        self._turning = turns[model.dof_jntid] & (owners.of_dof > 0)
        self.since = np.zeros(owners.count, dtype=int)  # steps of the first order since the last smooth one

    def choose(self, data: Any, whole: bool, force: Array) -> tuple[Array, Array]:
        """Mechanisms that go by the fourth order, and those of them that contacts push, (mechanisms,) each.

        That is all of a `whole` world, and else those without a stop, a taut rope or dry friction now. What contacts
        push by their rows' `force` does where they do not lead it, and nothing closes a loop in it.
        """
        smooth, pushed = np.full(self._owners.count, whole), np.zeros(self._owners.count, dtype=bool)
        if not whole and self._owners.count > 1:
            rows = self._pushing(data, force)
            smooth[1:], pushed = True, self._of_contacts(data, rows)
            for kind, owner in self._of_rows:
                smooth[owner[data.efc_id[data.efc_type == kind]]] = False
            smooth &= ~(pushed & (self._owners.closed | self._led.mechanisms(data, rows)))
            smooth[0] = False
        self.since = np.where(smooth, 0, self.since + 1)
        return smooth, pushed & smooth

    def pressed(self, data: Any, force: Array) -> Array:
        """Mechanisms that a contact pushes by its row's `force`, (mechanisms,)."""
        return self._of_contacts(data, self._pushing(data, force))

    @staticmethod
    def _pushing(data: Any, force: Array) -> Array:
        rows = np.flatnonzero(data.contact.efc_address[: data.ncon] >= 0)
        return np.asarray(rows[force[data.contact.efc_address[rows]] > 0.0])

    def _of_contacts(self, data: Any, rows: Array) -> Array:
        found = np.zeros(self._owners.count, dtype=bool)
        found[self._owners.of_geom[data.contact.geom[rows]]] = True
        return found

    def parts(self, data: Any, which: Array) -> int:
        """In how many parts a step is made in which no joint of some mechanisms turns far in one, (mechanisms,)."""
        ours = self._turning & which[self._owners.of_dof]
        if not ours.any():
            return 1
        h = self._model.opt.timestep
        turn = h * np.abs(data.qvel[ours]) + h * h * np.abs(data.qacc[ours])
        return int(min(max(1.0, np.ceil(turn.max() / LARGEST_TURN)), MOST_PARTS))

    def step(self, data: Any) -> None:
        """Advance all of `data`, whose forces are known."""
        # Its stages must not find a contact that the step did not start with: it would be as soft as MuJoCo's own.
        flags = self._model.opt.disableflags
        self._model.opt.disableflags = flags | self._unilateral
        self._mujoco.mj_RungeKutta(self._model, data, 4)
        self._model.opt.disableflags = flags

    def make(
        self, data: Any, force: Array, pushed: Array, parts: int, note: Callable[[Any, float], None] | None = None
    ) -> None:
        """Make the step from the state of `data` beside it, and keep it.

        Args:
            data: MuJoCo's.
            force: Of its constraint rows, of which those of contacts are held over the step.
            pushed: Mechanisms that they push, (mechanisms,).
            parts: By how many steps.
            note: Told of what acts at the ends of each of these, and for how long that counts [s].
        """
        mujoco, model, beside = self._mujoco, self._model, self._beside
        mujoco.mj_getState(model, data, self._state, self._all)
        mujoco.mj_setState(model, beside, self._state, self._all)
        if pushed.any():
            beside.xfrc_applied[:] += np.where(pushed[self._owners.of_body, None], self._pushes(data, force), 0.0)
        flags, h = model.opt.disableflags, model.opt.timestep
        model.opt.disableflags, model.opt.timestep = flags | self._unilateral, h / parts
        mujoco.mj_forward(model, beside)
        for k in range(parts):
            if note is not None:
                note(beside, (0.5 if k == 0 else 1.0) * h / parts)
            mujoco.mj_RungeKutta(model, beside, 4)
            if note is not None or k + 1 < parts:
                mujoco.mj_forward(model, beside)
        model.opt.disableflags, model.opt.timestep = flags, h
        if note is not None:
            note(beside, 0.5 * h / parts)

    def _pushes(self, data: Any, force: Array) -> Array:
        """What contacts give each body, about its centre of mass, (bodies, 6)."""
        contact, found = data.contact, np.zeros((self._model.nbody, 6))
        rows = np.flatnonzero(contact.efc_address[: data.ncon] >= 0)
        at = contact.efc_address[rows, None] + np.arange(6)
        each = np.where(np.arange(6) < contact.dim[rows, None], force[np.minimum(at, len(force) - 1)], 0.0)
        push, spin = np.moveaxis(
            np.einsum("nri,nsr->nsi", contact.frame[rows].reshape(-1, 3, 3), each.reshape(-1, 2, 3)), 1, 0
        )
        for side, sign in ((0, -1.0), (1, 1.0)):
            bodies = self._model.geom_bodyid[contact.geom[rows, side]]
            turn = np.cross(contact.pos[rows] - data.xipos[bodies], push) + spin
            np.add.at(found, bodies, sign * np.concatenate([push, turn], axis=1))
        return found

    def take(self, data: Any, which: Array) -> None:
        """Take what was made for some mechanisms, (mechanisms,)."""
        places, freedoms = which[self._owners.of_place], which[self._owners.of_dof]
        data.qpos[places] = self._beside.qpos[places]
        data.qvel[freedoms] = self._beside.qvel[freedoms]


class SmoothStepsWarp:
    """Makes the smooth step of all worlds after the law's, from where that began, and chooses.

    Args:
        mujoco: The module of MuJoCo in C, for its flags.
        warp: The module of MuJoCo Warp.
        model: MuJoCo Warp's model.
        data: MuJoCo Warp's data.
        owners: Which mechanism is whose.
        steps: Of the first order since the last smooth one of each world's mechanisms, and before them of what is none,
            (worlds, mechanisms); counted here.
    """

    def __init__(self, mujoco: Any, warp: Any, model: Any, data: Any, owners: Owners, steps: Any) -> None:
        self.mujoco, self.warp, self._steps = mujoco, warp, steps
        bits = mujoco.mjtDisableBit
        # Dry friction is none of its own steps' either; without it, drives are MuJoCo's actuators.
        self.unilateral = int(bits.mjDSBL_CONTACT | bits.mjDSBL_LIMIT | bits.mjDSBL_FRICTIONLOSS)
        self._state = [data.qpos, data.qvel]
        # Of the law's step, beside where it ended: what the next one begins with, and what is told of its contacts.
        self._law = [data.qacc_warmstart, data.time, data.nacon, data.nefc, data.efc.force]
        with wp.ScopedDevice(data.qpos.device):
            self._start, self._end = ([wp.empty_like(array) for array in self._state] for _ in range(2))
            self._kept = [wp.empty_like(array) for array in self._law]
            self._touches = wp.zeros((data.nworld, owners.count), dtype=int)
            self._none_breaks = wp.zeros(data.nworld, dtype=int)
            of_rows = owners.of_geom, owners.of_joint, owners.of_dof, np.append(owners.of_tendon, 0)
            self._of_rows = [wp.array(each, dtype=int) for each in of_rows]
            self._of_values = [wp.array(each, dtype=int) for each in (owners.of_place, owners.of_dof)]

    def begin(self) -> None:
        """Note where the step begins, after its blows."""
        _copy(self._state, self._start)

    def end(self, model: Any, data: Any, breaks: Any = None) -> None:
        """Take the smooth step where the law's had nothing to do, but in no world in which a joint `breaks`."""
        efc = data.efc
        self._touches.zero_()
        wp.launch(
            find_touching,
            dim=(data.nworld, data.njmax),
            inputs=[data.nefc, efc.type, efc.id, efc.force, data.contact.geom, *self._of_rows],
            outputs=[self._touches],
        )
        broken = self._none_breaks if breaks is None else breaks
        wp.launch(count_touching, dim=self._touches.shape, inputs=[broken], outputs=[self._touches, self._steps])
        _copy(self._state, self._end)
        _copy(self._law, self._kept)
        _copy(self._start, self._state)
        # Its stages must not find a contact that the step did not start with: it would be as soft as MuJoCo's own.
        flags = model.opt.disableflags
        model.opt.disableflags = flags | self.unilateral
        self.warp.forward(model, data)
        self.warp.rungekutta4(model, data)
        model.opt.disableflags = flags
        _copy(self._kept, self._law)
        for end, array, owner in zip(self._end, self._state, self._of_values, strict=True):
            wp.launch(keep_where_touched, dim=array.shape, inputs=[self._touches, owner, end], outputs=[array])


def _copy(arrays: Sequence[Any], into: Sequence[Any]) -> None:
    for source, target in zip(arrays, into, strict=True):
        wp.copy(target, source)
