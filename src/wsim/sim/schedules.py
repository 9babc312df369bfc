"""What happens by time or after an event, set on the device step by step, in all worlds at once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import warp as wp

from wsim.errors import UserError
from wsim.kernels import schedules as kernels
from wsim.scene.world import Schedule, World
from wsim.sim.joint_arrays import in_every_world, joint_indices
from wsim.sim.schedule_targets import Meetings, Pairs, Releases, Runners
from wsim.solvers.packed import Packed

Array = np.ndarray
KINDS = {
    "position": kernels.POSITION, "velocity": kernels.VELOCITY, "effort": kernels.EFFORT, "release": kernels.RELEASE,
    "force": kernels.FORCE, "torque": kernels.TORQUE, "surface_velocity": kernels.SURFACE,
    "friction": kernels.FRICTION,
}  # fmt: skip
LEADS = {"velocity": kernels.GOES, "angular_velocity": kernels.TURNS}  # of kinematic bodies
EVENTS = {
    "touch": kernels.TOUCH, "place": kernels.PLACE, "joint": kernels.JOINT, "start": kernels.START, "end": kernels.END,
}  # fmt: skip


class Schedules:
    """Follows the schedules of all worlds of a model.

    Args:
        model: The Newton model.
        worlds: What the stage of all worlds alike, or that of each, states.
        solver: Its bodies' `wsim.solvers.solver_rigid.SolverRigid`.
        breakable: Prims of the joints that may break.
        dt: Time step [s].

    Attributes:
        given: What forces and torques act on bodies in this step, at their centres of mass.
        begin: When each clock began, (W, S) [s]; below 0 before.

    Raises:
        UserError: If two things set one joint.
    """

    def __init__(self, model: Any, worlds: Sequence[World], solver: Any, breakable: Sequence[str], dt: float) -> None:
        self._model, self._dt, self._packed = model, dt, Packed(model.device)
        own, self._count = worlds[0].schedules, max(1, model.world_count)
        _check_alone(worlds[0])
        bodies = {prim: k for k, prim in reversed(list(enumerate(map(str, model.body_label))))}
        led = {body.prim for body in worlds[0].bodies if body.kinematic}
        kinds = [(LEADS if each.target in led else KINDS)[each.quantity] for each in own]
        self.events = [k for k, each in enumerate(own) if each.after is not None]
        self._numbers = {each.prim: k for k, each in enumerate(own)}
        touches = [each.after for each in own if each.after is not None and each.after.kind == "touch"]
        shape = (self._count, len(own))
        with wp.ScopedDevice(model.device):
            self._keys = _keys(worlds)
            self._targets = self._targets_of(worlds, kinds, bodies)
            self._events = self._events_of(worlds, bodies)
            self._acts, self._mean = wp.zeros(shape, dtype=int), wp.zeros(shape, dtype=wp.vec3d)
            self._step, self._before = wp.zeros(self._count, dtype=int), wp.zeros(shape, dtype=float)
            self.begin = wp.zeros(shape, dtype=wp.float64)
            self.given: Any = wp.zeros(model.body_count, dtype=wp.spatial_vector)
            self._waits = wp.array(np.tile([-1.0 if each.after else 0.0 for each in own], (self._count, 1)),
                                   dtype=wp.float64)  # fmt: skip
            self._meetings = Meetings(solver, model, worlds[0], touches, self._count)
            self._runners = Runners(solver, model, worlds, self._count)
            self._pairs = Pairs(solver, model, worlds, self._count)
            self._releases = Releases(solver, own, breakable)
        self._sets_joints, self._pushes, self._leads = (
            any(kind in some for kind in kinds)
            for some in (
                (kernels.POSITION, kernels.VELOCITY, kernels.EFFORT),
                (kernels.FORCE, kernels.TORQUE),
                (kernels.GOES, kernels.TURNS),
            )
        )
        self._stated: list[tuple[Any, Any]] = []

    @property
    def pushes(self) -> bool:
        """Whether any is a force or a torque."""
        return self._pushes

    def before(self, state: Any, control: Any, last: Any) -> None:
        """Set what acts in the step to come.

        Args:
            state: Where it starts; forces are added to its `body_f`.
            control: Gets joints' targets and efforts.
            last: The ledger's efforts of drives, which go with targets that jump.
        """
        shape, arrays, h = self._acts.shape, [self._acts, self._mean], wp.float64(self._dt)
        self._packed.launch(
            kernels.find_means, dim=shape, inputs=[self._step, h, self._keys, self.begin], outputs=arrays
        )
        if self._pushes:
            self.given.zero_()
            self._packed.launch(
                kernels.push_bodies, dim=shape, inputs=[*arrays, self._targets, state.body_q],
                outputs=[self.given, state.body_f], changing=(state.body_q, state.body_f),
            )  # fmt: skip
        if self._sets_joints:
            model = self._model
            self._keep(control)
            self._packed.launch(
                kernels.set_joints, dim=shape,
                inputs=[*arrays, self._targets, model.joint_target_ke, model.joint_target_kd, model.joint_effort_limit],
                outputs=[control.joint_target_q, control.joint_target_qd, control.joint_f, last],
                changing=(control.joint_target_q, control.joint_target_qd, control.joint_f),
            )  # fmt: skip
        if self._leads:
            self._packed.launch(
                kernels.lead_bodies, dim=shape, inputs=[*arrays, self._targets],
                outputs=[state.body_qd, state.joint_qd], changing=(state.body_qd, state.joint_qd),
            )  # fmt: skip
        self._runners.set(self._packed, self._acts, self._mean)
        self._pairs.set(self._packed, self._acts, self._mean)
        self._releases.let_go(self._packed, [self._step, h, self._keys, self.begin])

    def after(self, state: Any) -> None:
        """Look for events at the end of a step, and count it."""
        self._watch(state, 0)

    def _watch(self, state: Any, first: int) -> None:
        self._packed.launch(
            kernels.watch,
            dim=self._count,
            inputs=[first, wp.float64(self._dt), self._keys, self._events, state.body_q, state.joint_q,
                    self._meetings.met],
            outputs=[self._step, self._before, self.begin],
            changing=(first, state.body_q, state.joint_q),
        )  # fmt: skip

    def reset(self, state: Any) -> None:
        """Start all clocks anew, and set what is stated; `state` is where the next step starts."""
        self._step.zero_()
        self._meetings.met.zero_()
        wp.copy(self.begin, self._waits)
        for array, stated in self._stated:
            wp.copy(array, stated)
        self._runners.reset()
        self._pairs.reset()
        self._watch(state, 1)

    def began(self) -> dict[str, Array]:
        """When the clocks of schedules with events began, by their paths below /World, (W,) [s]; -1: not yet."""
        if not self.events:
            return {}
        begin, prims = self.begin.numpy(), list(self._numbers)
        return {f"begin{prims[k].removeprefix('/World')}": begin[:, k] for k in self.events}

    def _keep(self, control: Any) -> None:
        """Keep what a control has before anything is set, for when the run starts anew."""
        own = (control.joint_target_q, control.joint_target_qd, control.joint_f)
        if [array.ptr for array, _ in self._stated] != [
            array.ptr for array in own
        ] and not self._model.device.is_capturing:
            self._stated = [(array, wp.clone(array)) for array in own]

    # ---- arrays
    def _targets_of(self, worlds: Sequence[World], kinds: list[int], bodies: dict[str, int]) -> Any:
        """The bodies and degrees of freedom that schedules set, (W, S)."""
        model, own = self._model, worlds[0].schedules
        index, second = (np.full((self._count, len(own)), -1) for _ in range(2))
        arms = np.zeros((len(worlds), len(own), 3))
        starts, children = model.joint_qd_start.numpy(), model.joint_child.numpy().tolist()
        for s, (each, kind) in enumerate(zip(own, kinds, strict=True)):
            if kind in (kernels.POSITION, kernels.VELOCITY, kernels.EFFORT):
                _, dof, target = joint_indices(model, self._count, [each.target])
                index[:, s], second[:, s] = dof[:, 0], target[:, 0]
            elif kind in (kernels.FORCE, kernels.TORQUE, kernels.GOES, kernels.TURNS):
                body = in_every_world(np.array([bodies[each.target]]), self._count, model.body_count)[:, 0]
                index[:, s] = body
                second[:, s] = [starts[children.index(k)] for k in body]
            for n, world in enumerate(worlds):
                point = world.schedules[s].point
                if point is not None:
                    arms[n, s] = np.subtract(point, world.body(each.target).com)
        targets = kernels.Targets()
        targets.kind = wp.array(kinds, dtype=int)
        targets.index, targets.second = wp.array(index, dtype=int), wp.array(second, dtype=int)
        targets.arm = wp.array(arms, dtype=wp.vec3)
        return targets

    def _events_of(self, worlds: Sequence[World], bodies: dict[str, int]) -> Any:
        model, own, touches = self._model, worlds[0].schedules, 0
        index = np.full((self._count, len(own)), -1)
        for s, each in enumerate(own):
            event = each.after
            if event is None:
                continue
            if event.kind == "touch":
                index[:, s], touches = touches, touches + 1
            elif event.kind == "place":
                index[:, s] = in_every_world(np.array([bodies[event.first]]), self._count, model.body_count)[:, 0]
            elif event.kind == "joint":
                index[:, s] = joint_indices(model, self._count, [event.first])[0][:, 0]
            else:
                index[:, s] = self._numbers[event.first]
        found = kernels.Events()
        told = [each.after for each in own]
        found.kind = wp.array([EVENTS[e.kind] if e else kernels.NONE for e in told], dtype=int)
        found.index = wp.array(index, dtype=int)
        found.axis = wp.array(["XYZ".index(e.axis) if e and e.axis else 0 for e in told], dtype=int)
        found.side = wp.array([1.0 if not e or e.above else -1.0 for e in told], dtype=float)
        every = [[each.after for each in world.schedules] for world in worlds]
        found.value = wp.array([[e.value if e else 0.0 for e in row] for row in every], dtype=float)
        found.delay = wp.array([[e.delay if e else 0.0 for e in row] for row in every], dtype=wp.float64)
        return found


def _check_alone(world: World) -> None:
    """Nothing else sets what a schedule does."""
    others = {prim: "a policy" for policy in world.policies for prim in policy.joints}
    others |= {path.prim: "its robot's drive by times and positions" for path in world.joint_paths}
    for each in world.schedules:
        if each.quantity in ("position", "velocity") and each.target in others:
            raise UserError(f"{each.prim}: {others[each.target]} sets {each.target}, too; leave one of the two out")


def _keys(worlds: Sequence[World]) -> Any:
    """The key frames of all worlds, padded to as many."""
    most = max(len(each.times) for world in worlds for each in world.schedules)
    shape = len(worlds), len(worlds[0].schedules)
    times, values = np.full((*shape, most), np.inf), np.zeros((*shape, most, 3))
    base, count, linear = np.zeros((*shape, 3)), np.zeros(shape), np.zeros(shape)
    for n, world in enumerate(worlds):
        for s, each in enumerate(world.schedules):
            keys, wide = len(each.times), len(each.values[0])
            times[n, s, :keys], values[n, s, :keys, :wide] = each.times, each.values
            count[n, s], linear[n, s] = keys, each.linear
            stated = stated_of(world, each)
            base[n, s, : len(stated)] = stated
    found = kernels.Keys()
    found.times, found.values = wp.array(times, dtype=wp.float64), wp.array(values, dtype=wp.vec3d)
    found.count, found.linear = wp.array(count, dtype=int), wp.array(linear, dtype=int)
    found.base = wp.array(base, dtype=wp.vec3d)
    return found


def stated_of(world: World, schedule: Schedule) -> tuple[float, ...]:
    """What a quantity is before its schedule's first key."""
    what, target = schedule.quantity, schedule.target
    bodies = {body.prim: body for body in world.bodies}
    if what in ("position", "velocity") and target not in bodies:
        drive = next(joint.drive for joint in world.joints if joint.prim == target)
        return (0.0,) if drive is None else (float(getattr(drive, what)),)
    if what in ("velocity", "angular_velocity"):
        return tuple(getattr(bodies[target], what))
    if what == "surface_velocity":
        return next(static.shapes[0].surface_velocity for static in world.statics if static.prim == target)
    if what == "friction":
        return (next(pair.friction or 0.0 for pair in world.contacts if pair.prim == target),)
    return ()
