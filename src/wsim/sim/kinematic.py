"""Kinematic bodies: those that go by their velocity, and those that a path leads."""

from __future__ import annotations

from typing import Any

import newton
import numpy as np
import warp as wp
from newton import JointType

from wsim.kernels.kinematic import arrive, begin, carry, lead
from wsim.scene.usd_motion import curve_of
from wsim.scene.world import World
from wsim.solvers.packed import Packed

Array = np.ndarray


class Kinematic:
    """Moves the kinematic bodies of all worlds of a model.

    A body on a path has, over each step, the velocity that takes it to where its path is at the step's end: what it
    meets meets that velocity, and no error adds up.

    Args:
        model: The Newton model.
        world: What the stage states of the first world.
        dt: Time step [s].
    """

    def __init__(self, model: Any, world: World, dt: float) -> None:
        self.model, self.dt, self._packed = model, dt, Packed(model.device)
        kinematic = (model.body_flags.numpy() & int(newton.BodyFlags.KINEMATIC)) != 0
        kinds, child = model.joint_type.numpy(), model.joint_child.numpy()
        joints = [j for j in range(len(child)) if kinds[j] == int(JointType.FREE) and kinematic[child[j]]]
        paths = {body.prim: body.path for body in world.bodies if body.path is not None}
        number = {prim: k for k, prim in enumerate(paths)}
        labels = [str(label) for label in model.body_label]
        led = [j for j in joints if labels[child[j]] in number]
        free = [j for j in joints if labels[child[j]] not in number]
        coordinates, freedoms = model.joint_q_start.numpy(), model.joint_qd_start.numpy()
        with wp.ScopedDevice(model.device):
            self._carried = wp.array(child[free], dtype=int), wp.array(coordinates[free], dtype=int)
            self._lost = wp.zeros(len(free), dtype=wp.transformd)
            self._led = wp.array(child[led], dtype=int)
            self._coordinate = wp.array(coordinates[led], dtype=int)
            self._freedom = wp.array(freedoms[led], dtype=int)
            self._path = wp.array([number[labels[child[j]]] for j in led], dtype=int)
            self._target = wp.zeros(len(led), dtype=wp.transform)
            self._step = wp.zeros(1, dtype=int)
            curves = [curve_of(path) for path in paths.values()] if led else []
            self._curves = _arrays(curves) if led else []
            self._speeds = wp.array([curve.velocity(0.0) for curve in curves], dtype=wp.vec3)  # at the start
            hangs = _hang(model, kinematic)
            self._hanging = wp.array(hangs, dtype=bool) if hangs.any() else None

    @property
    def idle(self) -> bool:
        """Whether there is none."""
        return not len(self._led) and not len(self._carried[0])

    def before(self, state: Any) -> None:
        """Set the bodies on paths where a step starts, with the velocity that they have in it."""
        if not len(self._led):
            return
        self._packed.launch(
            lead,
            dim=len(self._led),
            inputs=[
                self._step, self.dt, self._led, self._path, self._coordinate, self._freedom, self.model.body_com,
                *self._curves,
            ],
            outputs=[state.body_q, state.body_qd, state.joint_q, state.joint_qd, self._target],
            changing=(state.body_q, state.body_qd, state.joint_q, state.joint_qd),
        )  # fmt: skip

    def after(self, state: Any) -> None:
        """Set all of them where a step ends."""
        bodies, coordinates = self._carried
        if len(bodies):
            self._packed.launch(
                carry,
                dim=len(bodies),
                inputs=[bodies, coordinates, self.model.body_com, state.body_qd, wp.float64(self.dt)],
                outputs=[self._lost, state.body_q, state.joint_q],
                changing=(state.body_qd, state.body_q, state.joint_q),
            )
        if len(self._led):
            self._packed.launch(
                arrive,
                dim=len(self._led),
                inputs=[self._led, self._coordinate, self._target],
                outputs=[state.body_q, state.joint_q, self._step],
                changing=(state.body_q, state.joint_q),
            )
        self._take_along(state)  # the solver leaves kinematic bodies where they were, and hung these on them there

    def reset(self, state: Any) -> None:
        """Start the paths anew, at the velocity that they have then; `state` is where the next step starts."""
        self._step.zero_()
        self._lost.zero_()
        self.before(state)
        if len(self._led):
            wp.launch(
                begin,
                dim=len(self._led),
                inputs=[self._led, self._path, self._freedom, self.model.body_com, state.body_q, self._speeds],
                outputs=[state.body_qd, state.joint_qd],
                device=self.model.device,
            )
            self._take_along(state)

    def _take_along(self, state: Any) -> None:
        """Have what hangs on kinematic bodies, by joints of the tree, be where they are and go with them."""
        if self._hanging is not None:
            newton.eval_fk(self.model, state.joint_q, state.joint_qd, state, joint_mask=self._hanging)


def _hang(model: Any, kinematic: Array) -> Array:
    """Which joints hang, over others or not, on a kinematic body, (joints,)."""
    child, ancestor = model.joint_child.numpy(), model.joint_ancestor.numpy()
    hangs = np.zeros(len(child), dtype=bool)
    for j in range(len(child)):  # a joint stands after its ancestors
        above = ancestor[j]
        hangs[j] = above >= 0 and (hangs[above] or kinematic[child[above]])
    return hangs


def _arrays(curves: list[Any]) -> list[Any]:
    """The curves' pieces one after another: where each starts, whether it repeats, times and coefficients.

    Each has one piece more than it needs, so that keys and pieces have the same numbers.
    """
    starts = np.cumsum([0, *(len(curve.times) for curve in curves)])
    fill = [np.concatenate([curve.place, curve.place[-1:]]) for curve in curves]
    turns = [np.concatenate([curve.turn, curve.turn[-1:]]) for curve in curves]
    bases = [np.concatenate([curve.base, curve.base[-1:]]) for curve in curves]
    return [
        wp.array(starts, dtype=int),
        wp.array([int(curve.repeat) for curve in curves], dtype=int),
        wp.array(np.concatenate([curve.times for curve in curves]), dtype=wp.float64),
        wp.array(np.concatenate(fill), dtype=wp.vec3d),
        wp.array(np.concatenate(bases), dtype=wp.quatd),
        wp.array(np.concatenate(turns), dtype=wp.vec3d),
    ]
