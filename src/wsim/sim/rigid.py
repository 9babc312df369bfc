"""The rigid-body half of a step: MuJoCo in C on a CPU, MuJoCo Warp where worlds are batched."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import warp as wp
from mujoco_warp import OverflowType
from newton import ShapeFlags

from wsim.kernels.overflow import accumulate_overflow
from wsim.recording.contacts import Pushes
from wsim.recording.ties import Ties
from wsim.scene.world import World
from wsim.sim.constraints import constraint_rows, held_points
from wsim.sim.contacts import shape_numbers, surface_velocities, surfaces_of
from wsim.sim.devices import steps_in_c
from wsim.sim.drives import drive_count
from wsim.sim.kinematic import Kinematic
from wsim.sim.ledger import Ledger
from wsim.sim.ledger_notes import StepNotes
from wsim.sim.pressed import Pressed
from wsim.sim.schedules import Schedules
from wsim.sim.ties import ties_of
from wsim.sim.time_step import is_overdamped
from wsim.solvers.breaking import Breakable
from wsim.solvers.contact_config import ContactConfig
from wsim.solvers.cylinder_contacts import CylinderContacts
from wsim.solvers.single_precision import beyond_single_precision
from wsim.solvers.solver_rigid import SolverRigid
from wsim.solvers.surface_contacts import SLOTS, SurfaceContacts, SurfaceParts

CONTACTS_A_PAIR = 8  # box on box gives up to eight points
ROWS_A_CONTACT = 3  # push and friction; where rolling is resisted, 6
SMALLEST_CONTACTS = 64
# A search that single precision cannot make any better is no overflow: MuJoCo in C stops as silently at its last step.
STAGNATED = int(OverflowType.LS_ITERATIONS | OverflowType.ITERATIONS)
FAR = 1e8  # a joint's limit beyond this is none [rad or m]


def contact_capacity(model: Any) -> int:
    """Contacts that one world can have at once, from the shapes that may collide.

    Every moving shape may touch its neighbours; counting all pairs is safe and small for few shapes, and beyond that a
    body has no room for more than about a dozen neighbours (the kissing number of equal spheres).
    """
    collides = (model.shape_flags.numpy() & int(ShapeFlags.COLLIDE_SHAPES)) != 0
    collides &= model.shape_world.numpy() <= 0  # of the first world, and of all
    moving = int((collides & (model.shape_body.numpy() >= 0)).sum())
    fixed = int((collides & (model.shape_body.numpy() < 0)).sum())
    pairs = moving * (moving - 1) // 2 + moving * fixed
    return max(SMALLEST_CONTACTS, CONTACTS_A_PAIR * min(pairs, 12 * moving))


def _may_touch(model: Any) -> bool:
    """Whether any contact or stop can come up."""
    limits = (model.joint_limit_lower, model.joint_limit_upper)
    stops = any(bool((np.abs(limit.numpy()) < FAR).any()) for limit in limits) if model.joint_dof_count else False
    return stops or model.shape_contact_pair_count > 0


def _is_driven(model: Any) -> bool:
    """Whether any joint has a motor."""
    gains = (model.joint_target_ke, model.joint_target_kd) if model.joint_dof_count else ()
    return any(bool(gain.numpy().any()) for gain in gains)


class RigidBodies:
    """Steps the bodies of a model, and tells about contacts, overflows and what drives them.

    Args:
        model: The Newton model.
        worlds: What the stage of all worlds alike, or that of each, states.
        dt: Time step [s].
        controlled: Whether a controller pushes bodies or joints.
        breakable: The joints that may break, of all worlds alike or of each.
        surfaces: What collides by its triangles.
        cylinders: Pairs of shapes of the first world, a cylinder first, that MuJoCo does not see touch.

    Attributes:
        driven: Whether any joint has a motor; `observables` then has what each gives.
        ledger: What fluid, drives and the controller put into the bodies; None where there are none of them.
        pressed: What contacts press with.
    """

    def __init__(
        self,
        model: Any,
        worlds: Sequence[World],
        dt: float,
        controlled: bool = False,
        breakable: Sequence[Sequence[Breakable]] = ((),),
        surfaces: SurfaceParts | None = None,
        cylinders: Sequence[tuple[int, int]] = (),
    ) -> None:
        world = worlds[0]
        self.model, self.breakable, self._world = model, breakable[0], world
        self.on_c = steps_in_c(model.device, model.world_count)
        capacity = contact_capacity(model)
        # A mechanism keeps its energy only with a higher order: over 5 s at 1.7 ms the double pendulum of the examples
        # gains 1.9 % of its potential energy with MuJoCo's first-order default, and 2e-6 of it with Runge-Kutta.
        # Beside a fluid the acoustic step is shorter, and the fluid's wrench is first-order anyway.
        swings = bool(world.joints or world.springs)
        smooth = swings and model.particle_count == 0
        if not self.on_c:  # there no step but the first order's is implicit in drives
            smooth = smooth and not any(is_overdamped(each, dt) for each in worlds)
        jumps = any(joint.friction or joint.may_break for joint in world.joints)
        touching = SurfaceContacts(model, surfaces, ContactConfig().reach) if surfaces else None
        rims = CylinderContacts(cylinders, ContactConfig().reach) if cylinders else None
        may_touch = _may_touch(model) or bool(world.ropes or touching or rims) or jumps
        if touching:
            capacity += SLOTS * len(touching.shapes) // max(1, model.world_count)
        rows_a_contact = int(model.mujoco.condim.numpy().max(initial=ROWS_A_CONTACT))
        rows = rows_a_contact * capacity + constraint_rows(world) + drive_count(world) + len(world.ropes) + 64
        sizes: dict[str, Any] = {} if self.on_c else {"nconmax": capacity, "njmax": rows}
        found = surfaces_of(model, worlds)
        self.solver = SolverRigid(model, found, self.on_c, smooth, may_touch, dt, breakable, touching, rims, **sizes)
        self.solver.hold_points(np.array([held_points(each) for each in worlds]))
        self.solver.move_surfaces(surface_velocities(model, worlds))
        kinds: set[Any] = set()
        if not self.on_c:
            kinds = {self.solver.ObservableKind.OVERFLOW}
            self.overflow_seen = wp.zeros(max(1, model.world_count), dtype=wp.int32, device=model.device)
        self.driven = driven = _is_driven(model)
        if driven:
            kinds.add(self.solver.ObservableKind.QFRC_ACTUATOR)
        self.observables: Any = self.solver.observables(kinds) if kinds else None
        self._kinematic = Kinematic(model, world, dt)
        self.pressed = Pressed(model, self.solver, self.on_c)
        self.schedules: Schedules | None = None
        if world.schedules:
            self.schedules = Schedules(model, worlds, self.solver, [joint.prim for joint in self.breakable], dt)
        pushed = driven or controlled or bool(world.schedules) or model.particle_count > 0
        self.ledger = Ledger(model, self.observables if driven else None, not smooth) if pushed else None
        if self.ledger and self.schedules and self.schedules.pushes:
            self.ledger.scheduled = self.schedules.given
        self._notes: StepNotes | None = None
        if self.ledger and self.on_c and model.particle_count == 0:
            notes = StepNotes(model, self.solver)
            self._notes = notes if notes.hold else None

    def step(self, state_in: Any, state_out: Any, control: Any, dt: float) -> None:
        """Advance the bodies by `dt` [s] under gravity, contacts, joints and `state_in.body_f`."""
        if self.schedules and self.ledger:
            self.schedules.before(state_in, control, self.ledger.last)
        self._kinematic.before(state_in)
        if self.ledger:
            self.ledger.before(state_in)
        self.solver.step(state_in, state_out, control, None, dt, observables=self.observables)
        if self.ledger:
            self.ledger.after(state_in.body_f, state_out, control, dt)
        self._kinematic.after(state_out)
        if self.schedules:
            self.schedules.after(state_out)
        if not self.on_c:
            wp.launch(
                accumulate_overflow,
                dim=len(self.overflow_seen),
                inputs=[self.observables.overflow],
                outputs=[self.overflow_seen],
                device=self.model.device,
            )

    @property
    def alone(self) -> bool:
        """Whether nothing but the solver reads or writes the state between two turns of others."""
        idle = self._kinematic.idle and self.schedules is None
        return self.on_c and idle and (self.ledger is None or self._notes is not None)

    def steps(self, state: Any, control: Any, dt: float, count: int) -> None:
        """Advance by `count` steps of `dt` [s] if the bodies are `alone`, in one go where books can be kept of it."""
        if self.ledger is None or self._notes is None:
            self.solver.steps(state, control, dt, count)
        elif self._notes.tell_all(control):
            self._notes.begin(state.body_f)
            self.solver.steps(state, control, dt, count, self.observables, self._notes.note)
            self.ledger.add(self._notes.end(), state.body_f, control, dt)
        else:
            for _ in range(count):
                self.step(state, state, control, dt)

    def keep_contacts(self) -> None:
        """Sum from here on what the first world's pairs of shapes give each other; in C its joints and cords, too."""
        self.solver.keep_impulses(shape_numbers(self.model, self._world))
        if self.on_c and (self._world.joints or self._world.cords):
            self.solver.keep_ties(*ties_of(self.solver, self._world))

    def take_contacts(self) -> Pushes | None:
        """The sums since the last call; None where nobody asked to keep them."""
        return self.solver.impulses.take() if self.solver.impulses else None

    def take_ties(self) -> Ties | None:
        """The sums of joints and cords since the last call; None where nobody keeps them."""
        return self.solver.tie_impulses.take() if self.solver.tie_impulses else None

    def take_lead(self) -> np.ndarray:
        """What bodies of the first world gained since the last call beside all impulses: those of half a step that
        their velocities are ahead of them, (bodies, 6) [N s, N m s]."""
        return self.solver.take_lead()

    def reset(self, state: Any) -> None:
        """Forget the steps taken so far; `state` is where the next one starts."""
        self._kinematic.reset(state)
        self.solver.reset(state, flags=0)
        self.solver.mend()
        for sums in (self.solver.impulses, self.solver.tie_impulses):
            if sums:
                sums.clear()
        if self.ledger:
            self.ledger.clear()
        if self.schedules:
            self.schedules.reset(state)
        if not self.on_c:
            self.overflow_seen.zero_()

    def breakage(self) -> dict[str, np.ndarray]:
        """Of each joint that may break: whether it is broken, and the most that it bore since the last call, (W,).

        Names are `broken`, `force` [N] and `torque` [N m] before the joint's path below /World.
        """
        if self.solver.breaking is None:
            return {}
        broken, load = self.solver.breaking.take()
        found: dict[str, np.ndarray] = {}
        for k, joint in enumerate(self.breakable):
            name = joint.prim.removeprefix("/World")
            found |= {f"broken{name}": broken[:, k].astype(np.float64)}
            found |= {f"force{name}": load[:, k, 0], f"torque{name}": load[:, k, 1]}
        return found

    def began(self) -> dict[str, np.ndarray]:
        """When the clocks of schedules with events began, by name, (W,) [s]; -1 for one that waits."""
        return self.schedules.began() if self.schedules else {}

    def problems(self) -> list[str]:
        """What the solver warned of since the start: each fails the run."""
        if not self.on_c:
            seen = self.overflow_seen.numpy() & ~STAGNATED
            worlds = np.flatnonzero(seen)
            which = OverflowType(int(np.bitwise_or.reduce(seen, initial=0)))
            lost = getattr(self.solver.impulses, "lost", 0)
            full = [f"{lost} contacts found no room in the sums of a frame"] if lost else []
            if not len(worlds):
                return full
            return [f"contact buffers overflowed in worlds {worlds[:8].tolist()}: {which.name}", *full]
        mujoco = self.solver.import_mujoco()[0]
        found = []
        for kind in range(len(self.solver.mj_data.warning)):
            warning = self.solver.mj_data.warning[kind]
            if warning.number:
                found.append(f"MuJoCo: {mujoco.mjtWarning(kind).name} {warning.number} times, last {warning.lastinfo}")
        return found

    def beyond_precision(self) -> list[str]:
        """What single precision may have lost the numbers of, a line each; nothing where it is solved in double."""
        if self.on_c:
            return []
        newtons, labels = self.solver.mjc_body_to_newton.numpy()[0], self.model.body_label
        label = lambda body: str(labels[newtons[body]])  # noqa: E731
        return beyond_single_precision(self.solver.import_mujoco()[0], self.solver.mj_model, label)

    def overflowed(self) -> np.ndarray:
        """Whether a world's contact buffers were too small at some time, (W,)."""
        return np.zeros(1, dtype=bool) if self.on_c else (self.overflow_seen.numpy() & ~STAGNATED) != 0

    def contacts_of_first_world(self) -> tuple[np.ndarray, float]:
        """Net contact force on each body of the first world [N], shape (bodies, 3), and the deepest penetration [m]."""
        force, deepest = self.contacts()
        return force[0], float(deepest[0])

    def contacts(self) -> tuple[np.ndarray, np.ndarray]:
        """Net contact force on each body of each world [N], (W, bodies, 3), and the deepest penetrations [m], (W,)."""
        self.pressed.measure()
        worlds = max(1, self.model.world_count)
        return self.pressed.force.numpy().reshape(worlds, -1, 3).copy(), self.pressed.deepest.numpy().copy()
