"""Newton's MuJoCo solver under the law of contact of `wsim.solvers.contact_law`."""

from __future__ import annotations

from typing import Any

import newton
import numpy as np
import warp as wp
from mujoco_warp import OverflowType

from wsim.kernels.contact_law import aim, aim_again, stop, strike
from wsim.solvers.contact_law import ContactConfig, ContactLawC
from wsim.solvers.surface_contacts import SurfaceContacts

Array = np.ndarray


def _yielding(model: Any) -> Array:
    """What each body yields to a push [1/kg], (bodies,), from which MuJoCo takes how hard its contacts are.

    MuJoCo measures it at the centre of mass, where a seesaw does not yield at all, and its contacts would be hard
    without bound; away from there it yields, by no less than about a tenth of what its mass would.
    """
    moves = model.body_weldid > 0
    by_mass = np.where(moves, 0.1 / np.maximum(model.body_mass, 1e-12), 0.0)
    return np.maximum(model.body_invweight0[:, 0], by_mass)


class SolverRigid(newton.solvers.SolverMuJoCo):
    """Rigid bodies with Coulomb's friction and Newton's impacts, in C on a CPU or batched in Warp.

    Args:
        model: The Newton model.
        classes: Class of each shape of the first world, (shapes,).
        law: Friction, restitution, spinning and rolling friction [m] of two classes, (classes, classes, 4).
        on_c: Whether MuJoCo in C steps the first world alone.
        smooth: Whether steps that touch nothing are of the fourth order. In Warp: all steps, and nothing may touch.
        config: How the law is applied.
        touching: Finds contacts with what MuJoCo does not know.
        options: For `newton.solvers.SolverMuJoCo`.
    """

    def __init__(
        self,
        model: Any,
        classes: Array,
        law: Array,
        on_c: bool,
        smooth: bool,
        config: ContactConfig | None = None,
        touching: SurfaceContacts | None = None,
        **options: Any,
    ) -> None:
        self.contact_config = config or ContactConfig()
        super().__init__(
            model,
            use_mujoco_cpu=on_c,
            use_mujoco_contacts=True,
            integrator="rk4" if smooth and not on_c else "implicitfast",
            cone="elliptic",
            enable_multiccd=True,  # a cylinder stands on four points, not on one that wanders
            impratio=1.0,
            tolerance=self.contact_config.solver_tolerance if on_c else self.contact_config.solver_tolerance_warp,
            **options,
        )
        shapes = self.mjc_geom_to_newton_shape.numpy()[0]
        geom_class = np.where(shapes >= 0, classes[np.maximum(shapes, 0) % len(classes)], 0)
        reach = np.full(self.mj_model.ngeom, 0.5 * self.contact_config.reach)
        self.mj_model.geom_margin[:] = reach
        self.mj_model.body_margin[:] = reach[0] if len(reach) else 0.0
        self.mj_model.body_invweight0[:, 0] = _yielding(self.mj_model)
        self._harden_loops()
        self._touching = touching
        if touching:
            touching.bind_geoms(self.mjc_geom_to_newton_shape.numpy())
        if on_c:
            mujoco = self.import_mujoco()[0]
            self._law_c = ContactLawC(mujoco, self.mj_model, geom_class, law, smooth, self.contact_config, touching)
        elif not smooth:
            self._prepare_warp(geom_class, law)

    def _harden_loops(self) -> None:
        """Loops that joints close are as hard as contacts, and the welds that drive kinematic bodies nearly so."""
        welds = self._kinematic_weld_eq_np if self._kinematic_weld_eq is not None else ()
        for k in range(self.mj_model.neq):
            config = self.contact_config
            self.mj_model.eq_solimp[k, :2] = config.kinematic_impedance if k in welds else config.impedance
        if not self.use_mujoco_cpu and self.mj_model.neq:
            impedances = self.mjw_model.eq_solimp
            values = np.broadcast_to(self.mj_model.eq_solimp, (*impedances.shape, 5))
            impedances.assign(values.astype(np.float32))

    def _prepare_warp(self, geom_class: Array, law: Array) -> None:
        device, data = self.model.device, self.mjw_data
        self.mjw_model.opt.warn_overflow &= ~int(OverflowType.LS_ITERATIONS)
        margin = self.mjw_model.geom_margin
        weights = self.mjw_model.body_invweight0
        weights.assign(np.broadcast_to(self.mj_model.body_invweight0, weights.numpy().shape).astype(np.float32))
        margin.assign(np.full(margin.shape, 0.5 * self.contact_config.reach, dtype=np.float32))
        with wp.ScopedDevice(device):
            self._geom_class = wp.array(geom_class, dtype=int)
            self._law = wp.array(law, dtype=wp.vec4)
            self._struck = wp.zeros((data.nworld, self.mj_model.nbody), dtype=int)
            self._target = wp.zeros(data.naconmax, dtype=float)
            self._slip = wp.zeros(data.naconmax, dtype=float)
            self._bend = wp.zeros(data.naconmax, dtype=float)
        if self._touching:
            found, bend = self._touching, self._bend
            self.mjw_model.callback.contactfilter = lambda model, data: found.add_to_warp(model, data, bend)

    def step(
        self, state_in: Any, state_out: Any, control: Any, contacts: Any, dt: float, *, observables: Any = None
    ) -> None:
        """Advance by `dt` [s]; see `newton.solvers.SolverMuJoCo.step`."""
        if self._touching:
            self._touching.find(state_in, dt)
        if not self.use_mujoco_cpu:
            super().step(state_in, state_out, control, contacts, dt, observables=observables)
            return
        # As the parent's, but for the step itself.
        self.validate_observables(observables, contacts)
        self._apply_mjc_control(self.model, state_in, control, self.mj_data)
        self._update_mjc_data(self.mj_data, self.model, state_in)
        self._update_kinematic_weld_references()
        self.mj_model.opt.timestep = dt
        self._law_c.step(self.mj_data)
        self._update_newton_state(self.model, state_out, self.mj_data, state_prev=state_in, observables=observables)
        self._step += 1

    def _mujoco_warp_step(self) -> None:
        """MuJoCo Warp's step, with the law between its halves."""
        model, data = self.mjw_model, self.mjw_data
        if model.opt.integrator == self._mujoco.mjtIntegrator.mjINT_RK4:
            super()._mujoco_warp_step()
            return
        warp = self._mujoco_warp
        warp.fwd_position(model, data)
        warp.fwd_velocity(model, data)
        warp.fwd_actuation(model, data)
        warp.fwd_acceleration(model, data)
        self._aim(model, data)
        for k in range(self.contact_config.solutions):
            if k:
                self._aim_again(model, data)
            warp.solve(model, data)
        warp.implicit(model, data)

    def _aim(self, model: Any, data: Any) -> None:
        config, efc, contact = self.contact_config, data.efc, data.contact
        h = model.opt.timestep
        self._struck.zero_()
        touching = [data.nacon, contact.worldid, contact.geom, contact.dist, contact.efc_address]
        wp.launch(
            strike,
            dim=data.naconmax,
            inputs=[
                *touching, efc.vel, h, self._bend, self._geom_class, model.geom_bodyid, self._law,
                config.threshold,
            ],
            outputs=[self._struck],
        )  # fmt: skip
        wp.launch(
            aim,
            dim=data.naconmax,
            inputs=[
                *touching, contact.dim, efc.vel, h, self._bend, self._geom_class, model.geom_bodyid, self._law,
                self._struck, data.qacc_smooth, *self._jacobian(model, efc), config.threshold, config.settle_time,
                config.settle_speed, config.smallest_friction,
            ],
            outputs=[contact.friction, self._target, self._slip, efc.aref],
        )  # fmt: skip
        wp.launch(
            stop,
            dim=(data.nworld, data.njmax),
            inputs=[data.nefc, efc.type, efc.pos, efc.vel, h, config.settle_time, config.settle_speed],
            outputs=[efc.aref],
        )

    def _aim_again(self, model: Any, data: Any) -> None:
        efc, contact = data.efc, data.contact
        wp.copy(data.qacc_warmstart, data.qacc)
        wp.launch(
            aim_again,
            dim=data.naconmax,
            inputs=[
                data.nacon, contact.worldid, contact.efc_address, contact.dim, contact.friction, efc.vel,
                model.opt.timestep, data.qacc, *self._jacobian(model, efc), self._target,
            ],
            outputs=[self._slip, efc.aref],
        )  # fmt: skip

    @staticmethod
    def _jacobian(model: Any, efc: Any) -> list[Any]:
        return [model.is_sparse, model.nv, efc.J, efc.J_rownnz, efc.J_rowadr, efc.J_colind]
