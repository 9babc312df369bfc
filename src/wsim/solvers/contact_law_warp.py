"""The law of contact of `wsim.solvers.contact_law` on MuJoCo Warp's data, for worlds that are batched or on a GPU."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import warp as wp

from wsim.kernels import slips
from wsim.kernels.blows import begin_round, count_round, lose_finite, silence
from wsim.kernels.contact_law import ENDED, aim, look, look_at_stops, stop, vec5
from wsim.kernels.slips import go_on_from, guess, settle, weigh
from wsim.solvers.contact_config import ContactConfig
from wsim.solvers.contact_impulses import ContactImpulsesWarp
from wsim.solvers.cylinder_contacts import CylinderContacts
from wsim.solvers.flight import Flight
from wsim.solvers.groups import mechanisms, tied_groups
from wsim.solvers.kept_memory import KeptMemory
from wsim.solvers.ropes import RopesWarp
from wsim.solvers.single_precision import last_tolerance
from wsim.solvers.smooth_steps import Owners
from wsim.solvers.smooth_steps_warp import SmoothStepsWarp
from wsim.solvers.surface_contacts import SurfaceContacts
from wsim.solvers.surfaces import Surfaces

ALWAYS = 2**30  # steps


class ContactLawWarp:
    """Steps worlds under the law.

    Args:
        modules: Of MuJoCo in C, and of MuJoCo Warp.
        host: MuJoCo's model of the first world.
        model: MuJoCo Warp's model.
        data: MuJoCo Warp's data.
        flight: Steps the loose bodies.
        surfaces: Of the geoms of all worlds alike, or of each.
        smooth: Whether steps that touch nothing are of the fourth order.
        config: How the law is applied.
        breaking: What breaks joints, if any may break.
        touching: Finds contacts with what MuJoCo does not know.
        cylinders: Finds those of cylinders.
        drives: The drives that damp, if there are any.
    """

    def __init__(
        self,
        modules: tuple[Any, Any],
        host: Any,
        model: Any,
        data: Any,
        flight: Flight,
        surfaces: Surfaces,
        smooth: bool,
        config: ContactConfig,
        breaking: Any = None,
        touching: SurfaceContacts | None = None,
        cylinders: CylinderContacts | None = None,
        drives: Any = None,
    ) -> None:
        mujoco, self._mujoco_warp = modules
        self._mujoco, self._model, self._data, self._flight, self._config = mujoco, model, data, flight, config
        self._breaking, self._drives, self._at_once = breaking, drives, False
        self._touching, self._cylinders = touching, cylinders
        self.impulses: ContactImpulsesWarp | None = None  # where somebody wants them summed
        self.told: Callable[[Any], None] | None = None  # looks at the contacts of each solution
        groups = tied_groups(mujoco, host)
        moves_as_one = np.zeros(host.nbody, dtype=int)
        if smooth:
            moves_as_one = mechanisms(mujoco, host, groups, flight.stated, driven=False)
        owners = Owners(mujoco, host, moves_as_one)
        self._memory = KeptMemory(data.qpos.device)
        wp.load_module(slips, device=data.qpos.device)  # before a graph is captured: a first step may touch nothing
        with wp.ScopedDevice(data.qpos.device):
            self._geom_class = wp.array(surfaces.classes, dtype=int)
            self.law = wp.array(surfaces.law, dtype=wp.vec3)
            self._curvature = wp.array(surfaces.curvature, dtype=float)
            self._target = wp.zeros(data.naconmax, dtype=float)
            self._blow = wp.zeros(data.naconmax, dtype=float)
            self._mechanism = wp.array(moves_as_one, dtype=int)
            self._touched_for = wp.full((data.nworld, owners.count), value=0 if smooth else ALWAYS, dtype=int)
            self._slip = wp.zeros(data.naconmax, dtype=float)
            self._before = wp.zeros(data.naconmax, dtype=wp.vec2)
            self._remaining = wp.zeros(data.naconmax, dtype=float)
            self._best = wp.zeros(data.naconmax, dtype=float)
            self._friction = wp.zeros(data.naconmax, dtype=vec5)
            self._sums = wp.zeros((data.nworld, host.nbody), dtype=wp.vec2)
            self._search = wp.zeros((data.nworld, ENDED + 1), dtype=int)
            self._struck = wp.zeros(1, dtype=int)
            self._free, self._warm = wp.empty_like(data.qacc_smooth), wp.empty_like(data.qacc_warmstart)
            self._speeds = [wp.empty_like(speed) for speed in flight.speeds]  # before a step's blows
            self._change = wp.zeros(data.nworld, dtype=float)
            self._nearest = wp.zeros(data.nworld, dtype=float)
            self._seeking = wp.zeros(1, dtype=int)
            self._bow = wp.zeros(data.naconmax, dtype=float)
            usual = float(model.opt.tolerance.numpy()[0])
            self._last_tolerance = wp.array([last_tolerance(host, usual, config)], dtype=float)
            self._ropes = RopesWarp(self._mujoco_warp, data) if host.tendon_limited.any() else None
        self._smooth_steps: Any = None
        if smooth:
            self._smooth_steps = SmoothStepsWarp(mujoco, self._mujoco_warp, model, data, owners, self._touched_for)
        model.callback.contactfilter = self._add_contacts

    def step(self, h: float) -> None:
        """Advance by `h` [s]."""
        # What MuJoCo Warp makes anew in the rounds of blows, a loop of the graph, it makes outside of them as well.
        with self._memory.used():
            self._advance(h)

    def _advance(self, h: float) -> None:
        """MuJoCo Warp's step, with the law between its halves."""
        model, data, warp = self._model, self._data, self._mujoco_warp
        if self._ropes:
            self._ropes.look_back(model, data)
        warp.fwd_position(model, data)
        self._accelerate(model, data, h)
        if self._breaking is not None:
            self._break_by_blows(model, data, h)
        self._strike(model, data, h)
        if self._smooth_steps:
            self._smooth_steps.begin()
        self._aim(model, data, instant=False)
        if self._drives:
            self._drives.aim(model, data)
        self._seek(model, data)
        if self._breaking is not None:
            self._break(model, data, struck=False)
        self._solve_last(model, data)
        if self.impulses is not None:
            self.impulses.add(data, h)
        if self.told is not None:
            self.told(data)
        self._implicit(model, data)
        self._flight.fly(h)
        if self._smooth_steps:
            self._smooth_steps.end(model, data, self._breaking.anew if self._breaking else None)
        if model.nu:
            self._tell_efforts(model, data)

    def _accelerate(self, model: Any, data: Any, h: float) -> None:
        """Accelerations without constraints, at the present velocities."""
        warp = self._mujoco_warp
        warp.fwd_velocity(model, data)
        self._flight.tumble(h)
        warp.fwd_actuation(model, data)
        if self._drives:
            self._drives.take_over(data)
        warp.fwd_acceleration(model, data)

    def _strike(self, model: Any, data: Any, h: float) -> None:
        """Give worlds the velocities after the blows of this step, and the accelerations there."""
        wp.copy(self._free, data.qacc_smooth)
        wp.copy(self._warm, data.qacc_warmstart)
        self._struck.zero_()
        self._search.zero_()
        self._look(model, data, instant=True)
        if model.opt.graph_conditional:
            wp.capture_while(self._seeking, self._round, model=model, data=data, h=h)
            wp.capture_if(self._struck, self._go_on, model=model, data=data, h=h)
            return
        for _ in range(self._config.blows_unrolled):
            self._round(model, data, h)
        self._go_on(model, data, h)

    def _round(self, model: Any, data: Any, h: float) -> None:
        """One round of blows, of each world that has one, and a look at what they hit."""
        search, efc = self._search, data.efc
        wp.launch(count_round, dim=data.nworld, outputs=[search, self._struck])
        data.qfrc_smooth.zero_()
        data.qacc_smooth.zero_()
        rows = (data.nworld, data.njmax)
        wp.launch(lose_finite, dim=rows, inputs=[data.nefc, efc.type], outputs=[efc.frictionloss])
        self._aim(model, data, instant=True)
        self._seek(model, data)
        share = h / self._config.blow_time
        if self._at_once:
            self._break(model, data, share=share, instant=True)
        self._solve_last(model, data)
        wp.launch(silence, dim=rows, inputs=[search], outputs=[efc.force])
        if self._at_once:
            self._breaking.add_blow(model, data, share)
        elif self.impulses is not None:
            self.impulses.add(data, h)
        if self.told is not None and not self._at_once:
            self.told(data)
        self._flight.jump(search, model.opt.timestep)
        self._mujoco_warp.make_constraint(model, data)
        self._look(model, data, instant=True)

    def _go_on(self, model: Any, data: Any, h: float) -> None:
        wp.copy(data.qacc_warmstart, self._warm)
        self._accelerate(model, data, h)

    def _break(self, model: Any, data: Any, **how: Any) -> None:
        """Solve until in all worlds joints bear what they must: `how` that is judged, `_break_worst` says."""
        self._breaking.again.fill_(1)
        if model.opt.graph_conditional:
            wp.capture_while(self._breaking.again, self._break_worst, model=model, data=data, **how)
        else:
            self._break_worst(model, data, **how)

    def _break_worst(
        self, model: Any, data: Any, share: float = 1.0, struck: bool = False, instant: bool = False
    ) -> None:
        """A solution, and what breaks by it, by what acts all the step or in an instant's blows."""
        self._solve(model, data)
        if instant:
            rows = data.nworld, data.njmax
            wp.launch(silence, dim=rows, inputs=[self._search], outputs=[data.efc.force])
        self._breaking.give_way(model, data, share, struck=struck)

    def _break_by_blows(self, model: Any, data: Any, h: float) -> None:
        """Have joints break in worlds that are struck, by blows that end at once, and go back to before these."""
        self._breaking.begin()
        for speed, kept in zip(self._flight.speeds, self._speeds, strict=True):
            wp.copy(kept, speed)
        self._at_once = True
        self._strike(model, data, h)
        self._at_once = False
        self._breaking.end_blows(self._search)
        if model.opt.graph_conditional:
            wp.capture_if(self._struck, self._break_struck, model=model, data=data, h=h)
        else:
            self._break_struck(model, data, h)

    def _break_struck(self, model: Any, data: Any, h: float) -> None:
        self._aim(model, data, instant=False)
        if self._drives:
            self._drives.aim(model, data)
        self._seek(model, data)
        self._break(model, data, struck=True)
        for speed, kept in zip(self._flight.speeds, self._speeds, strict=True):
            wp.copy(speed, kept)
        self._mujoco_warp.make_constraint(model, data)
        self._go_on(model, data, h)

    def _add_contacts(self, model: Any, data: Any) -> None:
        """After MuJoCo Warp's search for contacts those that it does not find."""
        if self._cylinders:
            self._cylinders.add_to_warp(model, data)
        if self._touching:
            self._touching.add_to_warp(model, data, self._bow)

    def _solve(self, model: Any, data: Any) -> None:
        self._mujoco_warp.solve(model, data)

    def _solve_last(self, model: Any, data: Any) -> None:
        """The solution whose forces move the bodies, and are recorded."""
        option = model.opt
        usual = option.tolerance, option.iterations
        option.tolerance = self._last_tolerance
        if option.solver == int(self._mujoco.mjtSolver.mjSOL_NEWTON):
            option.iterations = self._config.last_turns
        self._solve(model, data)
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

    def _look(self, model: Any, data: Any, instant: bool) -> None:
        """Which worlds have contacts in the step, or blows in this instant: the search for their slips begins."""
        config, contact = self._config, data.contact
        wp.launch(begin_round, dim=data.nworld, outputs=[self._search, self._seeking])
        wp.launch(
            look,
            dim=data.naconmax,
            inputs=[
                data.nacon, contact.worldid, contact.geom, contact.dist, contact.efc_address, data.efc.vel,
                model.opt.timestep, self._bow, self._geom_class, self.law, instant, config.most_blows, config.steady,
                config.threshold, config.settle_time, config.settle_speed,
            ],
            outputs=[self._search, self._seeking],
        )  # fmt: skip
        if self._at_once:
            wp.launch(
                look_at_stops,
                dim=(data.nworld, data.njmax),
                inputs=[
                    *self._stops(model, data), config.most_blows, config.steady, config.settle_time,
                    config.settle_speed,
                ],
                outputs=[self._search, self._seeking],
            )  # fmt: skip

    def _stops(self, model: Any, data: Any) -> list[Any]:
        """Of the rows of stops and ropes what they should reach is told from."""
        efc, length = data.efc, data.ten_length
        back = self._ropes.length if self._ropes else length
        return [data.nefc, efc.type, efc.pos, efc.vel, model.opt.timestep, efc.id, length, back]

    def _aim(self, model: Any, data: Any, instant: bool) -> None:
        """Ask for the speeds after the blows of an `instant`, or at the step's end."""
        config, efc, contact, flight = self._config, data.efc, data.contact, self._flight
        h = model.opt.timestep
        if not instant:
            self._look(model, data, instant)
        wp.launch(
            aim,
            dim=data.naconmax,
            inputs=[
                data.nacon, contact.worldid, contact.geom, contact.dist, contact.efc_address, contact.dim, efc.vel, h,
                self._bow, self._geom_class, model.geom_bodyid, self.law, model.geom_type, self._curvature,
                data.geom_xmat, contact.frame, self._search, instant, self._at_once, config.steady, self._free,
                self._mechanism, self._touched_for, flight.row, flight.since, *self._jacobian(model, efc),
                config.threshold, config.settle_time, config.settle_speed, config.smallest_friction,
            ],
            outputs=[
                self._friction, contact.friction, self._target, self._blow, self._slip, efc.D, efc.aref,
            ],
        )  # fmt: skip
        wp.launch(
            stop,
            dim=(data.nworld, data.njmax),
            inputs=[
                *self._stops(model, data), self._at_once, config.steady, config.settle_time, config.settle_speed,
            ],
            outputs=[efc.aref],
        )  # fmt: skip

    def _seek(self, model: Any, data: Any) -> None:
        """Solve until all worlds' slips are what they were guessed to be, or a given number of times."""
        if model.opt.graph_conditional:
            most = self._config.most_solutions
            wp.capture_while(self._seeking, self._seek_slip, model=model, data=data, most=most)
            return
        solutions = self._config.solutions_unrolled
        for _ in range(solutions):
            self._seek_slip(model, data, solutions - 1)  # with a guess: where something hits, one has none

    def _seek_slip(self, model: Any, data: Any, most: int) -> None:
        """A solution, and from what slips it leaves what they are guessed to be; `most` of them with a guess."""
        config, efc, contact = self._config, data.efc, data.contact
        self._solve(model, data)
        wp.launch(go_on_from, dim=data.qacc.shape, inputs=[self._search, data.qacc], outputs=[data.qacc_warmstart])
        self._sums.zero_()
        self._seeking.zero_()
        touching, h = [data.nacon, contact.worldid, contact.geom, contact.efc_address], model.opt.timestep
        wp.launch(
            weigh,
            dim=data.naconmax,
            inputs=[
                *touching, contact.dim, self._friction, efc.vel, h, model.geom_bodyid, data.qacc,
                *self._jacobian(model, efc), efc.force, self._target, self._blow, self._slip, self._before,
                self._search,
            ],
            outputs=[self._remaining, self._sums, self._change],
        )  # fmt: skip
        wp.launch(
            settle,
            dim=data.nworld,
            inputs=[config.solutions, most, config.tolerance, config.rough],
            outputs=[self._change, self._nearest, self._search, self._seeking],
        )
        wp.launch(
            guess,
            dim=data.naconmax,
            inputs=[
                *touching, self._friction, efc.vel, h, model.geom_bodyid, self._remaining, self._sums, self._target,
                self._blow, efc.D, efc.force, most, self._search,
            ],
            outputs=[contact.friction, self._slip, self._before, self._best, efc.aref],
        )  # fmt: skip

    @staticmethod
    def _jacobian(model: Any, efc: Any) -> list[Any]:
        return [model.is_sparse, model.nv, efc.J, efc.J_rownnz, efc.J_rowadr, efc.J_colind]
