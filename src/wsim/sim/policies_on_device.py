"""Policies at work on the device, for all worlds at once: nothing is copied to the host.

What a turn launches is captured in a graph once on CUDA and replayed; only the time is told from the host.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import warp as wp

from wsim.assets.policies import PolicySpec
from wsim.forks import uncollected
from wsim.kernels import policy as kernels
from wsim.kernels.policy_network import dense
from wsim.sim.commands_on_device import CommandsOnDevice
from wsim.sim.layers import Layer
from wsim.sim.walked import Walked

KINDS = {
    "linear_velocity": kernels.LINEAR,
    "angular_velocity": kernels.ANGULAR,
    "gravity": kernels.GRAVITY,
    "command": kernels.COMMAND,
    "joint_position": kernels.POSITION,
    "joint_velocity": kernels.VELOCITY,
    "last_action": kernels.ACTION,
}
VECTORS = 4  # of the base, the first of them


class PolicyOnDevice:
    """Sets the targets of a robot's servos, once every 1 / rate.

    Args:
        robot: And its policy.
        layers: Those of its network.
        device: Warp device.

    Attributes:
        seen: What the network saw last, (W, n).
        made: What it made of it, (W, J).
    """

    def __init__(self, robot: Walked, layers: Sequence[Layer], device: Any) -> None:
        count, spec = len(robot.policies), robot.spec
        self._spec, self._device, self._count = spec, device, count
        self._commands = CommandsOnDevice(robot.policies, device)
        self._coordinate, self._dof, self._target = (self._array(each, int) for each in robot.joints)
        self._base, self._com = self._array(robot.base, int), self._array(robot.com, wp.vec3)
        self._entries = [self._array(*each) for each in _entries(spec)]
        wide, action = np.ones(len(spec.joints)), (spec.action_scale, spec.action_offset)
        self._scale, self._offset = (self._array(np.asarray(each) * wide, float) for each in action)
        self._layers = [
            (self._array(each.weight, float), self._array(each.bias, float), each.bend, each.alpha) for each in layers
        ]
        self._clock = wp.zeros(1, dtype=wp.float64, device=device)
        self._felt = wp.zeros((count, VECTORS), dtype=wp.vec3, device=device)
        self._measured, self._where = (wp.zeros(count, dtype=wp.vec3, device=device) for _ in range(2))
        self.seen = self._zeros(spec.size)
        self._between = [self._zeros(len(each.bias)) for each in layers]
        self.made = self._between[-1]
        self._action, self._moved = self._zeros(len(spec.joints)), self._zeros(len(spec.joints))
        self._graph, self._asked = None, tuple[Any, ...]()

    def _array(self, values: Any, dtype: Any) -> Any:
        return wp.array(values, dtype=dtype, device=self._device)

    def _zeros(self, width: int) -> Any:
        return wp.zeros((self._count, width), dtype=float, device=self._device)

    @property
    def interval(self) -> float:
        """Between two turns [s]."""
        return 1.0 / self._spec.rate

    def __call__(self, t: float, simulation: Any) -> None:
        """Look at the robot in all worlds, and set its targets."""
        self._clock.fill_(t)
        if not self._device.is_cuda:
            self.launch(simulation)
            return
        asked = (simulation.state, simulation.control)
        if self._asked != asked:
            with uncollected(), wp.ScopedCapture(self._device) as capture:
                self.launch(simulation)
            self._graph, self._asked = capture.graph, asked
        wp.capture_launch(self._graph)

    def launch(self, simulation: Any) -> None:
        """Launch the kernels of a turn."""
        state, control = simulation.state, simulation.control
        self._run(
            kernels.feel_base,
            self._count,
            [state.body_q, state.body_qd, self._base, self._com],
            [self._felt, self._measured, self._where],
        )
        self._commands.launch(self._clock, self._measured, self._where, self._felt)
        own = [self._felt, state.joint_q, state.joint_qd, self._coordinate, self._dof, self._action]
        self._run(
            kernels.observe,
            self.seen.shape,
            [*self._entries, self._spec.observation_limit, *own],
            [self.seen],
        )
        x = self.seen
        for layer, y in zip(self._layers, self._between, strict=True):
            self._run(dense, y.shape, [x, *layer], [y])
            x = y
        self._run(
            kernels.set_targets,
            self.made.shape,
            [self.made, self._spec.action_limit, self._scale, self._offset, self._target],
            [self._action, control.joint_target_q, self._moved],
        )
        if simulation.rigid and simulation.rigid.ledger:
            simulation.rigid.ledger.retarget_on_device(self._dof, self._moved)

    def _run(self, kernel: Any, dim: Any, inputs: list[Any], outputs: list[Any]) -> None:
        wp.launch(kernel, dim=dim, inputs=inputs, outputs=outputs, device=self._device)


def _entries(spec: PolicySpec) -> list[tuple[np.ndarray, Any]]:
    """Of each entry that a network sees: what it is of, which axis or joint, its scale and its offset."""
    widths = [spec.width(each.of) for each in spec.observations]
    kinds = np.repeat([KINDS[each.of] for each in spec.observations], widths)
    index = np.concatenate([np.arange(width) for width in widths])
    told = [(np.ones(width) * each.scale, np.ones(width) * each.offset)
            for width, each in zip(widths, spec.observations, strict=True)]  # fmt: skip
    scale, offset = (np.concatenate(each) for each in zip(*told, strict=True))
    return [(kinds, int), (index, int), (scale, float), (offset, float)]
