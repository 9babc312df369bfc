"""Steps of Runge and Kutta's fourth order for mechanisms, each by itself, and for worlds that touch nothing.

A mechanism keeps its energy and its momentum only with a higher order, and taut ropes know none: each takes the one
step or the other as it has one at the step's start. Beside a crate that rests a double pendulum gained 1.8 % of
its energy in 5 s by steps of the first order, and a hinged pair that tumbled blew up. What is hit flies on from the
speeds after its blows: by the first order a chain that a ball hit gained up to two thirds of its energy.

In C what a contact, a stop or a stiffly damped drive gives is that of the step's rows, implicit, and held over the
step; dry friction and other drives are known to its stages. In Warp (`smooth_steps_warp.py`) mechanisms with any of
these go by the first order.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from typing import Any

import numpy as np

from wsim.geometry.rotations import cross
from wsim.solvers.closing import ClosingC
from wsim.solvers.drives import DrivesC
from wsim.solvers.groups import tendon_bodies
from wsim.solvers.led import Led

Array = np.ndarray
LARGEST_TURN, MOST_PARTS = 0.05, 32  # of a joint in each part of a step [rad]
REVERSAL_PARTS = 16  # of a step in which dry friction ends a motion or turns
NO_ROWS = np.zeros(0, dtype=int)
STILL = 1e-3  # of the speed that dry friction takes away in a step
Rows = tuple[Array, Array, Array, Array]  # of the constraints: kind, number, force, place
# Told of what acts, for how long [s], and of the rows held beside that.
Note = Callable[[Any, float, Sequence[Array]], None]


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
        drives: The drives that damp, if there are any.
        closing: What constraints may ask for.
    """

    def __init__(self, mujoco: Any, model: Any, owners: Owners, drives: DrivesC | None, closing: ClosingC) -> None:
        self._mujoco, self._model, self._owners, self._drives = mujoco, model, owners, drives
        self._closing = closing
        bits, rows = mujoco.mjtDisableBit, mujoco.mjtConstraint
        self._unilateral, self._dry = int(bits.mjDSBL_CONTACT | bits.mjDSBL_LIMIT), int(bits.mjDSBL_FRICTIONLOSS)
        self._stop, self._ropes = int(rows.mjCNSTR_LIMIT_JOINT), ((int(rows.mjCNSTR_LIMIT_TENDON), owners.of_tendon),)
        self._rubs = (
            (int(rows.mjCNSTR_FRICTION_DOF), owners.of_dof),
            (int(rows.mjCNSTR_FRICTION_TENDON), owners.of_tendon),
        )
        self._all = int(mujoco.mjtState.mjSTATE_INTEGRATION)
        self._state = np.zeros(mujoco.mj_stateSize(model, self._all))
        self._beside: Any = mujoco.MjData(model) if owners.count > 1 else None
        turns = np.isin(model.jnt_type, [int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_BALL)])
        self._led = Led(model, owners.of_geom)
        self._has_stops, self._has_friction = bool(model.jnt_limited.any()), bool(model.dof_frictionloss.any())
        self._turning = turns[model.dof_jntid] & (owners.of_dof > 0)
        self.since = np.zeros(owners.count, dtype=int)  # steps of the first order since the last smooth one

    def choose(self, data: Any, whole: bool, force: Array) -> tuple[Array, Array]:
        """Mechanisms that go by the fourth order, and those of them that contacts push, (mechanisms,) each.

        That is all of a `whole` world, and else those without a taut rope now. What contacts push by their rows'
        `force` does where they do not lead it, and like what is at a stop where nothing closes a loop in it.
        """
        smooth, pushed = np.full(self._owners.count, whole), np.zeros(self._owners.count, dtype=bool)
        if not whole and self._owners.count > 1:
            rows = self._pushing(data, force)
            smooth[1:], pushed = True, self._of_contacts(data, rows)
            smooth &= ~self._with(data, self._ropes)
            held = pushed | self.stopped(data, force)
            smooth &= ~(held & self._owners.closed | pushed & self._led.mechanisms(data, rows))
            smooth[0] = False
        self.since = np.where(smooth, 0, self.since + 1)
        return smooth, pushed & smooth

    def stops(self, data: Any) -> Array:
        """Rows of the stops of mechanisms that are near."""
        if not self._has_stops:
            return NO_ROWS
        rows = np.flatnonzero(data.efc_type == self._stop)
        return np.asarray(rows[self._owners.of_joint[data.efc_id[rows]] > 0])

    def stopped(self, data: Any, force: Array) -> Array:
        """Mechanisms that a stop holds by its row's `force`, (mechanisms,)."""
        found, rows = np.zeros(self._owners.count, dtype=bool), self.stops(data)
        found[self._owners.of_joint[data.efc_id[rows[force[rows] > 0.0]]]] = True
        return found

    def rubbed(self, data: Any) -> Array:
        """Mechanisms with dry friction, or drives that are rows of the constraints, (mechanisms,)."""
        return self._with(data, self._rubs)

    def _with(self, data: Any, kinds: Sequence[tuple[int, Array]]) -> Array:
        found = np.zeros(self._owners.count, dtype=bool)
        for kind, owner in kinds:
            found[owner[data.efc_id[data.efc_type == kind]]] = True
        return found

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

    def parts_of_reversal(self, data: Any, rate: Array, which: Array) -> int:
        """In how many parts a step is made near whose end dry friction in some mechanisms stops a motion, or turns.

        A stage asks that a speed be gone a step later, so that friction gives way before what slips has come to rest.

        Args:
            data: MuJoCo's.
            rate: Accelerations of its coordinates in the step, (nv,).
            which: Of the mechanisms, (mechanisms,).
        """
        if not self._has_friction:
            return 1
        rows = np.flatnonzero(data.efc_type == self._rubs[0][0])
        rows = rows[which[self._owners.of_dof[data.efc_id[rows]]]]
        dofs, h = data.efc_id[rows], self._model.opt.timestep
        speed = data.efc_vel[rows]
        slips = np.abs(speed) > STILL * data.efc_frictionloss[rows] * self._model.dof_invweight0[dofs] * h
        return REVERSAL_PARTS if (slips & (speed * (speed + 2.0 * h * rate[dofs]) <= 0.0)).any() else 1

    def step(self, data: Any, note: Note | None = None) -> None:
        """Advance all of `data`, whose forces are known.

        Args:
            data: MuJoCo's.
            note: Told of what acts at both ends of the step, for half of it each.
        """
        # Its stages must not find a contact that the step did not start with: it would be as soft as MuJoCo's own.
        flags, half = self._model.opt.disableflags, 0.5 * self._model.opt.timestep
        self._model.opt.disableflags = flags | self._unilateral | self._dry
        if note is not None:
            note(data, half, ())
        with self._closing.stages():
            self._mujoco.mj_RungeKutta(self._model, data, 4)
            if note is not None:
                warm = data.qacc_warmstart.copy()
                self._mujoco.mj_forward(self._model, data)
                note(data, half, ())
                data.qacc_warmstart[:] = warm
        self._model.opt.disableflags = flags

    def make(self, data: Any, force: Array, pushed: Array, parts: int, note: Note | None = None) -> None:
        """Make the step from the state of `data` beside it, and keep it.

        Its stages know dry friction and all drives but the stiff ones.

        Args:
            data: MuJoCo's.
            force: Of its constraint rows, of which those of contacts, stops and stiff drives are held over the step.
            pushed: Mechanisms that they push, (mechanisms,).
            parts: By how many steps.
            note: Told of what acts at the ends of each of these, and for how long that counts [s].
        """
        mujoco, model, beside = self._mujoco, self._model, self._beside
        mujoco.mj_getState(model, data, self._state, self._all)
        mujoco.mj_setState(model, beside, self._state, self._all)
        if self._drives is not None:
            beside.qfrc_applied[:] += self._along_joints(data, force, self._drives.stiff_rows(data))
        outer, inner, rows = self._contacts(data, pushed)
        beside.xfrc_applied[:] += self._pushes(data, force, outer)
        own = self._pushes(data, force, inner), self._along_joints(data, force, rows)
        stops = self.stops(data)
        stopped = self._along_joints(data, force, stops)
        beside.qfrc_applied[:] += own[1] + stopped
        told = data.efc_type[stops], data.efc_id[stops], force[stops], data.efc_pos[stops]
        with self._stages(parts), self._closing.stages():
            self._advance(parts, note and partial(self._tell, note, own, stopped, told))

    @contextmanager
    def _stages(self, parts: int) -> Iterator[None]:
        """Have MuJoCo's steps be parts of one, with drives for actuators and not for rows."""
        option, loss = self._model.opt, self._model.tendon_frictionloss
        kept = option.disableflags, option.timestep, option.disableactuator, loss.copy()
        option.disableflags = (kept[0] | self._unilateral) & ~self._dry
        option.timestep /= parts
        self._model.dof_solref[:] = 0.0, -1.0 / option.timestep  # dry friction asks that a speed be gone by the end
        if self._drives is not None:
            option.disableactuator, loss[:] = self._drives.held, 0.0
        try:
            yield
        finally:
            option.disableflags, option.timestep, option.disableactuator, loss[:] = kept

    def _advance(self, parts: int, note: Callable[[Any, float], None] | None) -> None:
        mujoco, model, beside = self._mujoco, self._model, self._beside
        h = model.opt.timestep
        mujoco.mj_forward(model, beside)
        for k in range(parts):
            if note is not None:
                note(beside, (0.5 if k == 0 else 1.0) * h)
            mujoco.mj_RungeKutta(model, beside, 4)
            if note is not None or k + 1 < parts:
                mujoco.mj_forward(model, beside)
        if note is not None:
            note(beside, 0.5 * h)

    def _tell(
        self, note: Note, own: tuple[Array, Array], stopped: Array, stops: Rows, beside: Any, span: float
    ) -> None:
        """Tell of what parts of a mechanism push each other with as of what pushes bodies, as other contacts do, and of
        stops as of the rows that they were.

        Args:
            note: Whom.
            own: What that is on the bodies at the step's start, and what of it is held along the coordinates.
            stopped: What stops give, held along the coordinates.
            stops: Their rows.
            beside: MuJoCo's data.
            span: For which it counts [s].
        """
        pushes, along = own
        acts = beside.xfrc_applied.copy(), beside.qfrc_applied.copy()
        beside.qfrc_applied[:] -= along + stopped
        if along.any():
            beside.xfrc_applied[:] += pushes + self._about_joints(beside, along - self._given_along(beside, pushes))
        note(beside, span, stops)
        beside.xfrc_applied[:], beside.qfrc_applied[:] = acts

    def _given_along(self, data: Any, pushes: Array) -> Array:
        """What some pushes on bodies, (bodies, 6), give along the coordinates, (nv,)."""
        found = np.zeros(self._model.nv)
        for body in np.flatnonzero(pushes.any(axis=1)).tolist():
            push, turn = pushes[body, :3], pushes[body, 3:]
            self._mujoco.mj_applyFT(self._model, data, push, turn, data.xipos[body], body, found)
        return found

    def _about_joints(self, data: Any, along: Array) -> Array:
        """Pushes on bodies, (bodies, 6), between ends of their joints, that give this along the coordinates, (nv,)."""
        model, found = self._model, np.zeros((self._model.nbody, 6))
        for dof in np.flatnonzero(along).tolist():
            body = int(model.dof_bodyid[dof])
            turn, push = along[dof] * data.cdof[dof, :3], along[dof] * data.cdof[dof, 3:]
            slides = not turn.any()
            found[body] += np.concatenate([push if slides else np.zeros(3), turn])
            above = int(model.body_parentid[body])
            arm = data.xipos[body] - data.xipos[above]
            found[above] -= np.concatenate([push, np.cross(arm, push)] if slides else [np.zeros(3), turn])
        found[0] = 0.0
        return found

    def _contacts(self, data: Any, pushed: Array) -> tuple[Array, Array, Array]:
        """Contacts that push some mechanisms, (mechanisms,): from without, and between what hangs on the same body.

        The rows of those come last. Held in the coordinates of the joints between them, these turn with the body that
        both hang on, and give it nothing.
        """
        contact = data.contact
        found = np.flatnonzero(contact.efc_address[: data.ncon] >= 0)
        found = found[pushed[self._owners.of_geom[contact.geom[found]]].any(axis=1)]
        inner = np.array([self._led.root(one, two) > 0 for one, two in contact.geom[found].tolist()], dtype=bool)
        rows = [np.arange(contact.dim[k]) + contact.efc_address[k] for k in found[inner]]
        return found[~inner], found[inner], np.concatenate([np.zeros(0, dtype=int), *rows])

    def _along_joints(self, data: Any, force: Array, rows: Array) -> Array:
        """What some rows give along the coordinates, (nv,)."""
        found, only = np.zeros(self._model.nv), np.zeros(data.nefc)
        if len(rows):
            only[rows] = force[rows]
            self._mujoco.mj_mulJacTVec(self._model, data, found, only)
        return found

    def _pushes(self, data: Any, force: Array, rows: Array) -> Array:
        """What some contacts give each body, about its centre of mass, (bodies, 6)."""
        contact, count = data.contact, self._model.nbody
        if not len(rows):
            return np.zeros((count, 6))
        at = contact.efc_address[rows, None] + np.arange(6)
        each = np.where(np.arange(6) < contact.dim[rows, None], force[np.minimum(at, len(force) - 1)], 0.0)
        push, spin = np.einsum("nri,nsr->sni", contact.frame[rows].reshape(-1, 3, 3), each.reshape(-1, 2, 3))
        bodies = self._model.geom_bodyid[contact.geom[rows]].T  # (2, contacts)
        turn = cross(contact.pos[rows] - data.xipos[bodies], push[None]) + spin
        given = np.concatenate([np.broadcast_to(push, turn.shape), turn], axis=2)
        given[0] *= -1.0
        places = 6 * bodies[..., None] + np.arange(6)
        return np.bincount(places.ravel(), given.ravel(), minlength=6 * count).reshape(count, 6)

    def take(self, data: Any, which: Array) -> None:
        """Take what was made for some mechanisms, (mechanisms,)."""
        places, freedoms = which[self._owners.of_place], which[self._owners.of_dof]
        data.qpos[places] = self._beside.qpos[places]
        data.qvel[freedoms] = self._beside.qvel[freedoms]
