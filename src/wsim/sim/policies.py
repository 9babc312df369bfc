"""Policies at work: what networks see of robots, and the targets that they set, in all worlds at once.

Written for one robot in W worlds: arrays lead with the world axis. On a CPU NumPy evaluates a network quicker than
kernels do; on a GPU all of a policy is kernels (`wsim.sim.policies_on_device`), if its network is layers that follow
each other.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wsim.assets.policies import PolicySpec
from wsim.sim.commands import Commands
from wsim.sim.layers import layers_of
from wsim.sim.policies_on_device import PolicyOnDevice
from wsim.sim.walked import Walked

Floats = NDArray[np.float64]


def controller_of(robot: Walked, device: Any) -> PolicyController | PolicyOnDevice:
    """What asks a robot's policy: on a GPU by kernels, where its network can be one's.

    Args:
        robot: And its policy.
        device: Warp device.
    """
    layers = layers_of(robot.network, robot.spec.size) if device.is_cuda else None
    return PolicyController(robot) if layers is None else PolicyOnDevice(robot, layers, device)


def launch_all(policies: Sequence[PolicyController | PolicyOnDevice], simulation: Any) -> None:
    """Launch the kernels of those policies that have some."""
    for policy in policies:
        if isinstance(policy, PolicyOnDevice):
            policy.launch(simulation)


class PolicyController:
    """Sets the targets of a robot's servos, once every 1 / rate, on the host.

    Args:
        robot: And its policy.

    Attributes:
        seen: What the network saw last, (W, n).
        made: What it made of it, (W, J).
    """

    def __init__(self, robot: Walked) -> None:
        spec = robot.spec
        self._robot, self._commands = robot, Commands(robot.policies)
        self._scale = [np.asarray(each.scale) for each in spec.observations]
        self._offset = [np.asarray(each.offset) for each in spec.observations]
        self._action_scale, self._action_offset = np.asarray(spec.action_scale), np.asarray(spec.action_offset)
        self._action = np.zeros((len(robot.base), len(spec.joints)))
        self.seen = np.zeros((len(robot.base), spec.size), dtype=np.float32)
        self.made = self._action.astype(np.float32)

    @property
    def interval(self) -> float:
        """Between two turns [s]."""
        return 1.0 / self._robot.spec.rate

    def __call__(self, t: float, simulation: Any) -> None:
        """Look at the robot in all worlds, and set its targets."""
        spec: PolicySpec = self._robot.spec
        coordinate, dof, target = self._robot.joints
        seen = self._motion(simulation.state)
        seen["command"] = self._commands.at(t, seen.pop("measured"), seen.pop("where"))
        seen["joint_position"] = simulation.state.joint_q.numpy()[coordinate].astype(np.float64)
        seen["joint_velocity"] = simulation.state.joint_qd.numpy()[dof].astype(np.float64)
        seen["last_action"] = self._action
        parts = [
            scale * (seen[each.of] - offset)
            for each, scale, offset in zip(spec.observations, self._scale, self._offset, strict=True)
        ]
        given = np.clip(np.concatenate(parts, axis=1), -spec.observation_limit, spec.observation_limit)
        self.seen = given.astype(np.float32)
        self.made = self._robot.network(self.seen)
        self._action = np.clip(self.made.astype(np.float64), -spec.action_limit, spec.action_limit)
        goal = (self._action_offset + self._action_scale * self._action).astype(np.float32)
        targets = simulation.control.joint_target_q.numpy()
        if simulation.rigid and simulation.rigid.ledger:
            simulation.rigid.ledger.retarget(dof.ravel(), (goal - targets[target]).ravel())
        targets[target] = goal
        simulation.control.joint_target_q.assign(targets)

    def _motion(self, state: Any) -> dict[str, Floats]:
        """The base's motion in its own frame, and along its heading; x, y and heading; (W, 3) each."""
        pose = state.body_q.numpy()[self._robot.base].astype(np.float64)
        motion = state.body_qd.numpy()[self._robot.base].astype(np.float64)
        own = axes(pose[:, 3:])  # rows of each are the frame's axes in the world
        spin = motion[:, 3:]
        velocity = motion[:, :3] - np.cross(spin, np.einsum("wij,wi->wj", own, self._robot.com))  # of its origin
        heading = own[:, 0, :2] / np.maximum(np.linalg.norm(own[:, 0, :2], axis=1, keepdims=True), 1e-9)
        ahead, left = heading, np.stack([-heading[:, 1], heading[:, 0]], axis=1)
        yaw = np.arctan2(heading[:, 1], heading[:, 0])
        along = [np.einsum("wi,wi->w", velocity[:, :2], way) for way in (ahead, left)]
        return {
            "linear_velocity": np.einsum("wij,wj->wi", own, velocity),
            "angular_velocity": np.einsum("wij,wj->wi", own, spin),
            "gravity": -own[:, :, 2],
            "measured": np.stack([*along, spin[:, 2]], axis=1),
            "where": np.stack([pose[:, 0], pose[:, 1], yaw], axis=1),
        }


def axes(q: Floats) -> Floats:
    """(W, 3, 3): the axes of frames turned by quaternions xyzw, a row each."""
    x, y, z, w = q.T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)],
        [2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)],
        [2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), 2, 0)
