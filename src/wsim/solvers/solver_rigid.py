"""Newton's MuJoCo solver under the law of contact of `wsim.solvers.contact_law`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import newton
import numpy as np
import warp as wp
from mujoco_warp import OverflowType

from wsim.geometry.rotations import conjugate, rotate
from wsim.kernels.contact_law import aim, aim_again, stop, strike, weigh
from wsim.kernels.round_on_flat import settle_round_on_flat
from wsim.solvers.breaking import Breakable, BreakingC, BreakingWarp
from wsim.solvers.contact_config import ContactConfig
from wsim.solvers.contact_impulses import ContactImpulsesC, ContactImpulsesWarp
from wsim.solvers.contact_law import ContactLawC
from wsim.solvers.drives import DrivesC, DrivesWarp, drive_rows
from wsim.solvers.flight import Flight
from wsim.solvers.groups import tied_groups
from wsim.solvers.host_models import host_models
from wsim.solvers.ropes import RopesWarp
from wsim.solvers.single_precision import (
    last_tolerance,
    soften_contacts_for_single_precision,
    soften_for_single_precision,
)
from wsim.solvers.smooth_steps import SmoothStepsWarp
from wsim.solvers.surface_contacts import SurfaceContacts
from wsim.solvers.surfaces import Surfaces
from wsim.solvers.tie_impulses import TiedCord, TiedJoint, TieImpulsesC
from wsim.solvers.yielding import yielding

Array = np.ndarray
ALWAYS = 2**30  # steps


class SolverRigid(newton.solvers.SolverMuJoCo):
    """Rigid bodies with Coulomb's friction and Newton's impacts, in C on a CPU or batched in Warp.

    Args:
        model: The Newton model.
        surfaces: Of the shapes of all worlds alike, or of each; where of each, worlds differ in numbers.
        on_c: Whether MuJoCo in C steps the first world alone.
        smooth: Whether steps that touch nothing are of the fourth order.
        may_touch: Whether any contact, stop or dry friction can come up.
        time_step: Of the steps to come [s].
        breakable: The joints that may break, of all worlds alike or of each.
        touching: Finds contacts with what MuJoCo does not know.
        options: For `newton.solvers.SolverMuJoCo`.
    """

    def __init__(
        self,
        model: Any,
        surfaces: Surfaces,
        on_c: bool,
        smooth: bool,
        may_touch: bool,
        time_step: float,
        breakable: Sequence[Sequence[Breakable]] = (),
        touching: SurfaceContacts | None = None,
        **options: Any,
    ) -> None:
        self.contact_config = ContactConfig()
        self._flight: Flight | None = None
        self.impulses: ContactImpulsesC | ContactImpulsesWarp | None = None
        self.tie_impulses: TieImpulsesC | None = None
        super().__init__(
            model,
            use_mujoco_cpu=on_c,
            use_mujoco_contacts=True,
            integrator="rk4" if smooth and not on_c and not may_touch else "implicitfast",
            cone="elliptic",
            enable_multiccd=True,  # a cylinder stands on four points, not on one that wanders
            impratio=1.0,
            tolerance=self.contact_config.solver_tolerance if on_c else self.contact_config.solver_tolerance_warp,
            **options,
        )
        self._differ = len(surfaces.classes) > 1
        of_geoms = surfaces.taken(self.mjc_geom_to_newton_shape.numpy())
        reach = np.full(self.mj_model.ngeom, 0.5 * self.contact_config.reach)
        self.mj_model.geom_margin[:] = reach
        self.mj_model.body_margin[:] = reach[0] if len(reach) else 0.0
        gives = [yielding(host) for host in self._hosts()]
        self.mj_model.body_invweight0[:, 0] = gives[0]
        self._harden_constraints(time_step)
        self.breaking = self._breaking(breakable) if breakable and breakable[0] else None
        self._touching = touching
        if touching:
            touching.bind_geoms(self.mjc_geom_to_newton_shape.numpy())
        mujoco = self.import_mujoco()[0]
        self._flight = Flight(mujoco, self, self.mj_data if on_c else self.mjw_data, self._hosts())
        driven = drive_rows(mujoco, self.mj_model)
        self._drives: Any = None
        if on_c:
            drives = DrivesC(mujoco, self.mj_model, driven) if driven else None
            self._law_c = ContactLawC(
                mujoco,
                self.mj_model,
                self._flight,
                of_geoms,
                smooth,
                self.contact_config,
                self.breaking,
                touching,
                drives,
            )
        elif may_touch or not smooth:
            self._prepare_warp(of_geoms, np.array(gives))
            with wp.ScopedDevice(model.device):
                self._drives = DrivesWarp(self._hosts(), driven, self.mjw_data.nworld) if driven else None
        else:  # Runge and Kutta's stages take drives as MuJoCo does
            self.mjw_model.opt.disableflags |= int(self._mujoco.mjtDisableBit.mjDSBL_FRICTIONLOSS)
        self._ropes: Any = None
        if not on_c and self.mj_model.tendon_limited.any():
            with wp.ScopedDevice(model.device):
                self._ropes = RopesWarp(self._mujoco_warp, self.mjw_data)
        self._smooth_steps: Any = None
        if smooth and may_touch and not on_c:
            self._touched_for.zero_()
            self._smooth_steps = SmoothStepsWarp(
                mujoco, self._mujoco_warp, self.mjw_model, self.mjw_data, self._touched_for
            )

    def _hosts(self) -> Iterator[Any]:
        return host_models(self, self._differ)

    def move_surfaces(self, velocity: Array) -> None:
        """Let surfaces move as belts do: what touches them slips against that velocity.

        MuJoCo adds a geom's `surfacevel` to what its contacts' friction rows have for velocity, in C and in Warp.

        Args:
            velocity: Of each shape of all worlds alike, or of each [m/s], in its body's axes, or the world's,
                (N, shapes, 3).
        """
        if not velocity.any():
            return
        shapes = self.mjc_geom_to_newton_shape.numpy()[0]
        moving = np.zeros((len(velocity), self.mj_model.ngeom, 6))
        for stated, moved, host in zip(velocity, moving, self._hosts(), strict=True):
            for geom in np.flatnonzero((shapes >= 0) & stated[shapes].any(axis=1)):
                turn = conjugate(host.geom_quat[geom][[1, 2, 3, 0]])
                moved[geom, :3] = rotate(turn, stated[shapes[geom]])
        self.mj_model.geom_surfacevel[:] = moving[0]
        self.mj_model.flg_surfacevel = 1
        if not self.use_mujoco_cpu:
            self._give_warp("geom_surfacevel", moving)
            self.mjw_model.flg_surfacevel = True

    def _harden_constraints(self, h: float) -> None:
        """Loops, gears and what may break are as hard as contacts, the welds that drive kinematic bodies nearly so.

        A row asks, as a contact does, that the speed at the end of a step of `h` [s] lets its gap fade in the settling
        time: -gap / (settle_time h) - speed / h, in MuJoCo's direct form of a reference acceleration.
        """
        config, model = self.contact_config, self.mj_model
        welds = self._kinematic_weld_eq_np if self._kinematic_weld_eq is not None else ()
        for k in range(model.neq):
            if k in welds:
                model.eq_solimp[k, :2] = config.kinematic_impedance
            else:
                model.eq_solimp[k, :2] = config.impedance
                model.eq_solref[k] = -1.0 / (config.settle_time * h), -1.0 / h
        if not self.use_mujoco_cpu:
            soften_for_single_precision(self.import_mujoco()[0], model, config)
        if not self.use_mujoco_cpu and model.neq:
            self._tell_warp("eq_solimp", "eq_solref")

    def _tell_warp(self, *names: str) -> None:
        """Give all worlds of MuJoCo Warp's model what MuJoCo's model has under these names."""
        for name in names:
            self._give_warp(name, getattr(self.mj_model, name)[None])

    def _give_warp(self, name: str, values: Array) -> None:
        """Give MuJoCo Warp's model what all worlds have under a name, or each, (N, …); it counts worlds modulo N."""
        array = getattr(self.mjw_model, name)
        if len(values) > array.shape[0]:
            made = wp.array(values.astype(np.float32), dtype=array.dtype, device=self.model.device)
            setattr(self.mjw_model, name, made)
            return
        array.assign(np.broadcast_to(values, array.numpy().shape).astype(np.float32))

    def _breaking(self, breakable: Sequence[Sequence[Breakable]]) -> Any:
        """What breaks joints, under MuJoCo's numbers of their constraints."""
        rows = self.mjc_eq_to_newton_eq.numpy()[0].tolist()
        constraints = [[rows.index(row) for row in joint.rows] for joint in breakable[0]]
        strength = np.array([[[joint.force, joint.torque] for joint in own] for own in breakable])
        if self.use_mujoco_cpu:
            return BreakingC(self.import_mujoco()[0], self.mj_model, constraints, strength)
        with wp.ScopedDevice(self.model.device):
            return BreakingWarp(self.mj_model, constraints, strength, self.mjw_data.nworld)

    def keep_impulses(self, numbers: Array) -> None:
        """Sum what contacts of the first world give, from here on.

        Args:
            numbers: Of the first world's shapes, as a recording counts them, (shapes,); below 0 for none.
        """
        shapes = self.mjc_geom_to_newton_shape.numpy()[0]
        of_geoms = np.where(shapes >= 0, numbers[np.maximum(shapes, 0)], -1)
        if self.use_mujoco_cpu:
            self.impulses = self._law_c.impulses = ContactImpulsesC(self.mj_model, of_geoms)
            return
        capacity = self.mjw_data.naconmax // self.mjw_data.nworld
        self.impulses = ContactImpulsesWarp(self.mj_model, of_geoms, self.model.device, capacity)

    def keep_ties(self, joints: Sequence[TiedJoint], cords: Sequence[TiedCord]) -> None:
        """Sum what joints and cords give from here on, in C alone."""
        if self.use_mujoco_cpu:
            ties = TieImpulsesC(self.import_mujoco()[0], self.mj_model, joints, cords)
            self.tie_impulses = self._law_c.ties = ties

    def mend(self) -> None:
        """Make all joints whole that broke."""
        if self.breaking is not None:
            self.breaking.clear(self.mj_data if self.use_mujoco_cpu else self.mjw_data)

    def _prepare_warp(self, surfaces: Surfaces, gives: Array) -> None:
        device, data = self.model.device, self.mjw_data
        self.mjw_model.opt.warn_overflow &= ~int(OverflowType.LS_ITERATIONS | OverflowType.ITERATIONS)
        # Boxes meet boxes by MuJoCo's own clipping, as in C: in single precision the general search for the depth loses
        # the contacts of a box that slides, on an H200 in one step of some 300.
        self.mjw_model.opt.disableflags |= int(self._mujoco.mjtDisableBit.mjDSBL_NATIVECCD)
        if soften_contacts_for_single_precision(self._mujoco, self.mj_model, self.contact_config):
            self.mjw_model.opt.solver = int(self._mujoco.mjtSolver.mjSOL_CG)
        self._tell_warp("geom_solimp")
        weights = self.mjw_model.body_invweight0.numpy()[: len(gives)]
        weights[..., 0] = gives
        self._give_warp("body_invweight0", weights)
        margin = self.mjw_model.geom_margin
        margin.assign(np.full(margin.shape, 0.5 * self.contact_config.reach, dtype=np.float32))
        with wp.ScopedDevice(device):
            self._geom_class = wp.array(surfaces.classes, dtype=int)
            self._law = wp.array(surfaces.law, dtype=wp.vec3)
            self._curvature = wp.array(surfaces.curvature, dtype=float)
            groups = tied_groups(self._mujoco, self.mj_model)
            self._geom_group = wp.array(groups[self.mj_model.geom_bodyid], dtype=int)
            self._struck = wp.zeros((data.nworld, int(groups.max()) + 1), dtype=int)
            self._target = wp.zeros(data.naconmax, dtype=float)
            self._blow = wp.zeros(data.naconmax, dtype=float)
            self._touched_for = wp.full(data.nworld, value=ALWAYS, dtype=int)
            self._slip = wp.zeros(data.naconmax, dtype=float)
            self._before = wp.zeros(data.naconmax, dtype=wp.vec2)
            self._remaining = wp.zeros(data.naconmax, dtype=float)
            self._sums = wp.zeros((data.nworld, self.mj_model.nbody), dtype=wp.vec2)
            self._bow = wp.zeros(data.naconmax, dtype=float)
            self._last_tolerance = wp.array(
                [last_tolerance(self._mujoco, self.mj_model, self.contact_config)], dtype=float
            )
        self.mjw_model.callback.contactfilter = self._mend_contacts

    def _mend_contacts(self, model: Any, data: Any) -> None:
        """After MuJoCo Warp's search for contacts: those that it finds only nearly, and those that it cannot know."""
        contact = data.contact
        wp.launch(
            settle_round_on_flat,
            dim=data.naconmax,
            inputs=[
                model.geom_type, model.geom_size, data.nacon, contact.worldid, contact.geom, data.geom_xpos,
                data.geom_xmat,
            ],
            outputs=[contact.pos, contact.dist, contact.frame],
        )  # fmt: skip
        if self._touching:
            self._touching.add_to_warp(model, data, self._bow)

    def step(
        self, state_in: Any, state_out: Any, control: Any, contacts: Any, dt: float, *, observables: Any = None
    ) -> None:
        """Advance by `dt` [s]; see `newton.solvers.SolverMuJoCo.step`."""
        self._dt = dt
        if self._touching:
            self._touching.find(state_in, dt)
        if not self.use_mujoco_cpu:
            super().step(state_in, state_out, control, contacts, dt, observables=observables)
            return
        self.validate_observables(observables, contacts)
        self._steps_c(state_in, state_out, control, dt, 1, observables)

    def steps(self, state: Any, control: Any, dt: float, count: int) -> None:
        """Advance by `count` steps of `dt` [s] in C, between which nobody reads or writes `state` and `control`.

        Twice as quick as one by one: what Newton's state costs, with its kernels, is as much as a small world's step.
        """
        self._dt = dt
        self._steps_c(state, state, control, dt, count, None)

    def _steps_c(self, state_in: Any, state_out: Any, control: Any, dt: float, count: int, observables: Any) -> None:
        """As the parent's step, but for the steps themselves."""
        self._apply_mjc_control(self.model, state_in, control, self.mj_data)
        self._update_mjc_data(self.mj_data, self.model, state_in)
        self._update_kinematic_weld_references()
        self.mj_model.opt.timestep = dt
        for k in range(count):
            if k and self._flight:
                self._flight.keep()
            self._law_c.step(self.mj_data)
        self._update_newton_state(self.model, state_out, self.mj_data, state_prev=state_in, observables=observables)
        self._step += count

    def reset(self, state: Any, *args: Any, **options: Any) -> None:
        """Start anew from `state`; see `newton.solvers.SolverMuJoCo.reset`."""
        super().reset(state, *args, **options)
        if self._flight:
            self._flight.forget()

    def _update_mjc_data(self, mj_data: Any, model: Any, state: Any = None, *args: Any, **options: Any) -> None:
        super()._update_mjc_data(mj_data, model, state, *args, **options)
        if self._flight and state is not None:
            self._flight.recall(state)

    def _update_newton_state(self, model: Any, state: Any, mj_data: Any, *args: Any, **options: Any) -> None:
        if self._flight:
            self._flight.keep()
        super()._update_newton_state(model, state, mj_data, *args, **options)
        if self._flight:
            self._flight.tell(state)

    def _mujoco_warp_step(self) -> None:
        """MuJoCo Warp's step, with the law between its halves."""
        model, data = self.mjw_model, self.mjw_data
        if model.opt.integrator == self._mujoco.mjtIntegrator.mjINT_RK4:
            super()._mujoco_warp_step()
            return
        warp = self._mujoco_warp
        if self._smooth_steps:
            self._smooth_steps.before(model, data)
        if self._ropes:
            self._ropes.look_back(model, data)
        warp.fwd_position(model, data)
        warp.fwd_velocity(model, data)
        if self._flight:
            self._flight.tumble(self._dt)
        warp.fwd_actuation(model, data)
        if self._drives:
            self._drives.take_over(data)
        warp.fwd_acceleration(model, data)
        self._aim(model, data)
        if self._drives:
            self._drives.aim(model, data)
        for _ in range(self.contact_config.solutions_warp - 1):
            warp.solve(model, data)
            self._aim_again(model, data)
        if self.breaking is not None:
            warp.solve(model, data)
            self.breaking.give_way(model, data)
        self._solve_last(model, data)
        if isinstance(self.impulses, ContactImpulsesWarp):
            self.impulses.add(data, self._dt)
        self._implicit(model, data)
        if self._flight:
            self._flight.ease_warp(model, data, self._jacobian(model, data.efc), self.contact_config.steady)
            self._flight.fly(self._dt)
        if self._smooth_steps:
            self._smooth_steps.after(model, data, self.breaking.anew if self.breaking else None)
        if model.nu:
            self._tell_efforts(model, data)

    def _solve_last(self, model: Any, data: Any) -> None:
        """The solution whose forces move the bodies, and are recorded."""
        option = model.opt
        usual = option.tolerance, option.iterations
        option.tolerance, option.iterations = self._last_tolerance, self.contact_config.last_turns
        self._mujoco_warp.solve(model, data)
        option.tolerance, option.iterations = usual

    def _implicit(self, model: Any, data: Any) -> None:
        """The step of the first order. Of drives' damping it knows already: their rows were solved with it."""
        flags = model.opt.disableflags
        model.opt.disableflags |= int(self._mujoco.mjtDisableBit.mjDSBL_ACTUATION) if self._drives else 0
        self._mujoco_warp.implicit(model, data)
        model.opt.disableflags = flags

    def _tell_efforts(self, model: Any, data: Any) -> None:
        """What the drives give at the step's end, which the books need, whichever way the step was made."""
        warp = self._mujoco_warp
        warp.kinematics(model, data)
        warp.com_pos(model, data)
        warp.transmission(model, data)
        warp.fwd_velocity(model, data)
        warp.fwd_actuation(model, data)

    def _aim(self, model: Any, data: Any) -> None:
        config, efc, contact, flight = self.contact_config, data.efc, data.contact, self._flight
        assert flight is not None
        h = model.opt.timestep
        self._struck.zero_()
        touching = [data.nacon, contact.worldid, contact.geom, contact.dist, contact.efc_address]
        wp.launch(
            strike,
            dim=data.naconmax,
            inputs=[
                *touching, efc.vel, h, self._bow, self._geom_class, self._geom_group, self._law,
                config.threshold,
            ],
            outputs=[self._struck],
        )  # fmt: skip
        wp.launch(
            aim,
            dim=data.naconmax,
            inputs=[
                *touching, contact.dim, efc.vel, h, self._bow, self._geom_class, model.geom_bodyid,
                self._geom_group, self._law, model.geom_type, self._curvature, data.geom_xmat, contact.frame,
                self._struck, data.qacc_smooth, self._touched_for, flight.row, flight.since,
                *self._jacobian(model, efc), config.threshold, config.settle_time, config.settle_speed,
                config.smallest_friction,
            ],
            outputs=[contact.friction, self._target, self._blow, self._slip, self._before, efc.D, efc.aref],
        )  # fmt: skip
        wp.launch(
            stop,
            dim=(data.nworld, data.njmax),
            inputs=[
                data.nefc, efc.type, efc.pos, efc.vel, h, efc.id, data.ten_length,
                self._ropes.length if self._ropes else data.ten_length, config.settle_time, config.settle_speed,
            ],
            outputs=[efc.aref],
        )  # fmt: skip

    def _aim_again(self, model: Any, data: Any) -> None:
        efc, contact = data.efc, data.contact
        wp.copy(data.qacc_warmstart, data.qacc)
        self._sums.zero_()
        touching, h = [data.nacon, contact.worldid, contact.geom, contact.efc_address], model.opt.timestep
        wp.launch(
            weigh,
            dim=data.naconmax,
            inputs=[
                *touching, contact.dim, contact.friction, efc.vel, h, model.geom_bodyid, data.qacc,
                *self._jacobian(model, efc), efc.force, self._target, self._blow, self._slip, self._before,
            ],
            outputs=[self._remaining, self._sums],
        )  # fmt: skip
        wp.launch(
            aim_again,
            dim=data.naconmax,
            inputs=[
                *touching, efc.vel, h, model.geom_bodyid, self._remaining, self._sums, self._target, self._blow, efc.D,
                efc.force,
            ],
            outputs=[self._slip, self._before, efc.aref],
        )  # fmt: skip

    @staticmethod
    def _jacobian(model: Any, efc: Any) -> list[Any]:
        return [model.is_sparse, model.nv, efc.J, efc.J_rownnz, efc.J_rowadr, efc.J_colind]
