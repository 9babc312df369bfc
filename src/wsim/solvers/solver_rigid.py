"""Newton's MuJoCo solver under the law of contact of `wsim.solvers.contact_law`."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import newton
import numpy as np
import warp as wp
from mujoco_warp import OverflowType

from wsim.geometry.rotations import conjugate, rotate
from wsim.solvers.breaking import Breakable, BreakingC, BreakingWarp
from wsim.solvers.collision_masks import compiled_by_kinds
from wsim.solvers.contact_config import ContactConfig
from wsim.solvers.contact_impulses import ContactImpulsesC, ContactImpulsesWarp
from wsim.solvers.contact_law import ContactLawC
from wsim.solvers.contact_law_warp import ContactLawWarp
from wsim.solvers.cylinder_contacts import CylinderContacts
from wsim.solvers.drives import DrivesC, DrivesWarp, drive_rows
from wsim.solvers.flight import Flight
from wsim.solvers.gears import gears_to_turn, turned
from wsim.solvers.host_models import host_models
from wsim.solvers.locking import LeadsC, LeadsWarp, lock
from wsim.solvers.motion_c import MotionC
from wsim.solvers.single_precision import (
    soften_contacts_for_single_precision,
    soften_for_single_precision,
    tolerance_in_c,
)
from wsim.solvers.surface_contacts import SurfaceContacts
from wsim.solvers.surfaces import Surfaces
from wsim.solvers.tie_impulses import TiedCord, TiedJoint, TieImpulsesC
from wsim.solvers.yielding import yielding

Array = np.ndarray
Told = Callable[[], None]


class SolverRigid(newton.solvers.SolverMuJoCo):
    """Rigid bodies with Coulomb's friction and Newton's impacts, in C on a CPU or batched in Warp.

    Args:
        model: The Newton model.
        surfaces: Of the shapes of all worlds alike, or of each; where of each, worlds differ in numbers.
        on_c: Whether MuJoCo in C steps the first world alone.
        smooth: Whether steps that touch nothing are of the fourth order; in C all the same where drives are stiff.
        may_touch: Whether any contact, stop or dry friction can come up.
        time_step: Of the steps to come [s].
        breakable: The joints that may break, of all worlds alike or of each.
        touching: Finds contacts with what MuJoCo does not know.
        cylinders: Finds those of cylinders.
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
        cylinders: CylinderContacts | None = None,
        **options: Any,
    ) -> None:
        self.contact_config, self._dt = ContactConfig(), time_step
        self._flight: Flight | None = None
        self._leads: LeadsC | LeadsWarp | None = None
        self.impulses: ContactImpulsesC | ContactImpulsesWarp | None = None
        self.tie_impulses: TieImpulsesC | None = None
        self.motion: Any = None  # what MuJoCo in C says of it
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
        if on_c:
            self.mj_model.opt.tolerance = tolerance_in_c(self.mj_model, self.contact_config)
        self._differ = len(surfaces.classes) > 1
        of_geoms = surfaces.taken(self.mjc_geom_to_newton_shape.numpy())
        self._classes = of_geoms.classes
        reach = np.full(self.mj_model.ngeom, 0.5 * self.contact_config.reach)
        self.mj_model.geom_margin[:] = reach
        self.mj_model.body_margin[:] = reach[0] if len(reach) else 0.0
        kinematic, self._leads = lock(self, self._hosts())
        gives = [yielding(host, kinematic) for host in self._hosts()]
        self.mj_model.body_invweight0[:, 0] = gives[0]
        self._turn_gears()
        self._harden_constraints(time_step)
        self.breaking = self._breaking(breakable) if breakable and breakable[0] else None
        self._touching = touching
        if touching:
            touching.bind_geoms(self.mjc_geom_to_newton_shape.numpy())
        if cylinders:
            cylinders.bind(self.mjc_geom_to_newton_shape.numpy()[0])
        mujoco = self.import_mujoco()[0]
        self._flight = Flight(mujoco, self, self.mj_data if on_c else self.mjw_data, self._hosts())
        driven = drive_rows(mujoco, self.mj_model)
        self._law_warp: ContactLawWarp | None = None
        if on_c:
            self.motion = MotionC(mujoco, self, self._flight)
            if cylinders:
                cylinders.bind_c(self.mj_model, self.mj_data)
            drives: Any = DrivesC(mujoco, self.mj_model, driven, time_step) if driven else None
            self._law_c = ContactLawC(
                mujoco,
                self.mj_model,
                self._flight,
                of_geoms,
                smooth,
                self.contact_config,
                self.breaking,
                touching,
                cylinders,
                drives,
            )
        elif may_touch or not smooth:
            self._prepare_warp(np.array(gives))
            if cylinders:
                cylinders.bind_warp(self.mjw_model, self.mjw_data)
            with wp.ScopedDevice(model.device):
                drives = DrivesWarp(self._hosts(), driven, self.mjw_data.nworld) if driven else None
            self._law_warp = ContactLawWarp(
                (mujoco, self._mujoco_warp),
                self.mj_model,
                self.mjw_model,
                self.mjw_data,
                self._flight,
                of_geoms,
                smooth,
                self.contact_config,
                self.breaking,
                touching,
                cylinders,
                drives,
            )
        else:  # Runge and Kutta's stages take drives as MuJoCo does
            self.mjw_model.opt.disableflags |= int(self._mujoco.mjtDisableBit.mjDSBL_FRICTIONLOSS)

    @staticmethod
    def _compile_newton_collision_masks(model: Any, selected_shapes: Array) -> Any:
        """Which shapes may touch, as masks: as Newton finds them or, where it does not, by kinds."""
        found = newton.solvers.SolverMuJoCo._compile_newton_collision_masks(model, selected_shapes)
        return found if found.exact else compiled_by_kinds(model, selected_shapes, found)

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
            self.give_warp("geom_surfacevel", moving)
            self.mjw_model.flg_surfacevel = True

    def hold_points(self, points: Array) -> None:
        """Have constraints hold their children where they say, also where the start is off it: that gap fades.

        Args:
            points: Of each of Newton's equality constraints of all worlds alike, or of each, in the child's axes [m],
                (N, rows, 3); NaN of what is held by other than a point.
        """
        rows = self.mjc_eq_to_newton_eq.numpy()[0]
        chosen = np.flatnonzero(rows >= 0)
        chosen = chosen[np.isfinite(points[0, rows[chosen], 0])]
        if not len(chosen):
            return
        held = np.array([host.eq_data.copy() for host in self._hosts()])[: len(points)]
        held[:, chosen, 3:6] = points[:, rows[chosen]]
        self.mj_model.eq_data[:] = held[0]
        if not self.use_mujoco_cpu:
            self.give_warp("eq_data", held)

    def _turn_gears(self) -> None:
        """Write gears by the joint in which they are as hard as all else, in all worlds as in the first."""
        host = self.mj_model
        gears = gears_to_turn(self.import_mujoco()[0], host)
        if not len(gears):
            return
        ends = host.eq_obj1id.copy(), host.eq_obj2id.copy()
        host.eq_obj1id[gears], host.eq_obj2id[gears] = ends[1][gears], ends[0][gears]
        host.eq_data[:] = turned(host.eq_data, gears)
        if not self.use_mujoco_cpu:
            for name in ("eq_obj1id", "eq_obj2id"):
                getattr(self.mjw_model, name).assign(getattr(host, name))
            self.mjw_model.eq_data.assign(turned(self.mjw_model.eq_data.numpy(), gears))

    def _harden_constraints(self, h: float) -> None:
        """Loops, gears and what may break are as hard as contacts.

        A row asks, as a contact does, that the speed at the end of a step of `h` [s] lets its gap fade in the settling
        time: -gap / (settle_time h) - speed / h, in MuJoCo's direct form of a reference acceleration.
        """
        config, model = self.contact_config, self.mj_model
        for k in range(model.neq):
            model.eq_solimp[k, :2] = config.impedance
            model.eq_solref[k] = -1.0 / (config.settle_time * h), -1.0 / h
        if not self.use_mujoco_cpu:
            soften_for_single_precision(self.import_mujoco()[0], model, config)
        if not self.use_mujoco_cpu and model.neq:
            self._tell_warp("eq_solimp", "eq_solref")

    def _tell_warp(self, *names: str) -> None:
        """Give all worlds of MuJoCo Warp's model what MuJoCo's model has under these names."""
        for name in names:
            self.give_warp(name, getattr(self.mj_model, name)[None])

    def give_warp(self, name: str, values: Array) -> None:
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
        if self._law_warp is not None:
            self._law_warp.impulses = self.impulses

    def keep_ties(self, joints: Sequence[TiedJoint], cords: Sequence[TiedCord]) -> None:
        """Sum what joints and cords give from here on, in C alone."""
        if self.use_mujoco_cpu:
            law = self._law_c
            ties = TieImpulsesC(self.import_mujoco()[0], self.mj_model, joints, cords, law.owners.of_body)
            self.tie_impulses = law.ties = ties

    def take_lead(self) -> Array:
        """Momentum and angular momentum that velocities of the first world gained since the last call and no force
        gave them yet (`Flight.take_lead`), by Newton's bodies, (bodies, 6) [N s, N m s]."""
        bodies = self.model.body_count // max(1, self.model.world_count)
        found = np.zeros((bodies, 6))
        if self._flight:
            ours, gained = self._flight.take_lead()
            newtons = self.mjc_body_to_newton.numpy()[0, ours]
            mass = self.model.body_mass.numpy()[newtons, None]
            found[newtons] = np.concatenate([mass * gained[0, :, 0], gained[0, :, 1]], axis=1)
        return found

    def tell_contacts(self, told: Callable[[Any], None]) -> None:
        """Have something look at MuJoCo's data whenever the contacts of a step are solved."""
        law = self._law_c if self.use_mujoco_cpu else self._law_warp
        if law is not None:  # else nothing ever touches
            law.told = told

    def classes_of(self, geoms: Array) -> Array:
        """The classes of surfaces of some geoms, which worlds have alike."""
        return np.unique(self._classes[0, geoms])

    def friction_law(self, worlds: int) -> Any:
        """Friction, restitution and rolling of two classes, to be changed between steps: of one world in C an array
        (classes, classes, 3), else Warp's (worlds, classes, classes)."""
        if self.use_mujoco_cpu:
            return self._law_c.law
        law = self._law_warp
        assert law is not None  # a pair that rubs may touch
        rows = law.law.numpy()
        law.law = wp.array(rows[np.arange(worlds) % len(rows)], dtype=wp.vec3)
        return law.law

    def mend(self) -> None:
        """Make all joints whole that broke."""
        if self.breaking is not None:
            self.breaking.clear(self.mj_data if self.use_mujoco_cpu else self.mjw_data)

    def _prepare_warp(self, gives: Array) -> None:
        """What of MuJoCo Warp's model the law needs otherwise than Newton gives it."""
        self.mjw_model.opt.warn_overflow &= ~int(OverflowType.LS_ITERATIONS | OverflowType.ITERATIONS)
        if self.model.device.is_cuda and not wp.is_conditional_graph_supported():
            self.mjw_model.opt.graph_conditional = False
        # Boxes meet boxes by MuJoCo's own clipping, as in C: in single precision the general search for the depth loses
        # the contacts of a box that slides, on an H200 in one step of some 300.
        self.mjw_model.opt.disableflags |= int(self._mujoco.mjtDisableBit.mjDSBL_NATIVECCD)
        ill = soften_contacts_for_single_precision(self._mujoco, self.mj_model, self.contact_config)
        too_many = self.mj_model.nv > self.contact_config.most_factored
        if ill or too_many:
            self.mjw_model.opt.solver = int(self._mujoco.mjtSolver.mjSOL_CG)
        if too_many:
            self.mjw_model.opt.iterations = self.contact_config.most_conjugate
        self._tell_warp("geom_solimp")
        weights = self.mjw_model.body_invweight0.numpy()[: len(gives)]
        weights[..., 0] = gives
        self.give_warp("body_invweight0", weights)
        margin = self.mjw_model.geom_margin
        margin.assign(np.full(margin.shape, 0.5 * self.contact_config.reach, dtype=np.float32))

    def step(
        self, state_in: Any, state_out: Any, control: Any, contacts: Any, dt: float, *, observables: Any = None
    ) -> None:
        """Advance by `dt` [s]; see `newton.solvers.SolverMuJoCo.step`."""
        self._dt = dt
        if self.use_mujoco_cpu:
            self.validate_observables(observables, contacts)
            self._steps_c(state_in, state_out, control, dt, 1, observables, lambda: None)
        else:
            self._find_touching(state_in)
            super().step(state_in, state_out, control, contacts, dt, observables=observables)

    def steps(
        self, state: Any, control: Any, dt: float, count: int, observables: Any = None, told: Told = lambda: None
    ) -> None:
        """Advance by `count` steps of `dt` [s] in C, between which nobody else reads or writes `state` and `control`.

        Twice as quick as one by one: what Newton's state costs, with its kernels, is as much as a small world's step.

        Observables are those of the end. `told` is called as the first step begins and as each ends, when MuJoCo's data
        are those of that instant.
        """
        self._dt = dt
        self.validate_observables(observables)
        self._steps_c(state, state, control, dt, count, observables, told)

    def _steps_c(
        self, state_in: Any, state_out: Any, control: Any, dt: float, count: int, observables: Any, told: Told
    ) -> None:
        """As the parent's step, but for the steps themselves."""
        self._apply_mjc_control(self.model, state_in, control, self.mj_data)
        self._update_mjc_data(self.mj_data, self.model, state_in)
        self._update_kinematic_weld_references()
        self.mj_model.opt.timestep = dt
        told()
        for k in range(count):
            if k and self._flight:
                self._flight.keep()
                if self._touching:
                    self.motion.tell(state_out)
            self._find_touching(state_out if k else state_in)
            self._law_c.step(self.mj_data)
            told()
        self._update_newton_state(self.model, state_out, self.mj_data, state_prev=state_in, observables=observables)
        self._step += count

    def _find_touching(self, state: Any) -> None:
        if self._touching and self._flight:
            self._touching.find(state, self._flight.ahead, self._dt)

    def reset(self, state: Any, *args: Any, **options: Any) -> None:
        """Start anew from `state`; see `newton.solvers.SolverMuJoCo.reset`."""
        if self._leads:
            self._leads.forget()
        super().reset(state, *args, **options)
        if self._flight:
            self._flight.forget()
        if self.use_mujoco_cpu or self._leads:  # the first step is led on from the velocities that they have here
            self._update_mjc_data(self.mj_data if self.use_mujoco_cpu else self.mjw_data, self.model, state)
        if self.use_mujoco_cpu:
            self._law_c.closing.forget()
            self.motion.place(state)

    def _update_mjc_data(self, mj_data: Any, model: Any, state: Any = None, *args: Any, **options: Any) -> None:
        super()._update_mjc_data(mj_data, model, state, *args, **options)
        if self._flight and state is not None:
            self._flight.recall(state)
        if self._leads:
            self._leads.push(mj_data, self._dt)

    def _update_newton_state(self, model: Any, state: Any, mj_data: Any, *args: Any, **options: Any) -> None:
        if self._flight:
            self._flight.keep()
            self._flight.say(centred=True)
        super()._update_newton_state(model, state, mj_data, *args, **options)
        if self._flight:
            self._flight.say(centred=False)
            self._flight.tell(state)
            if self.use_mujoco_cpu:
                self.motion.place(state)

    def _mujoco_warp_step(self) -> None:
        """MuJoCo Warp's step under the law; by itself where nothing touches and steps are smooth."""
        if self._law_warp is None:
            super()._mujoco_warp_step()
        else:
            self._law_warp.step(self._dt)
