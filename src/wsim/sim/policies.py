"""Policies at work: what networks see of robots, and the targets that they set, in all worlds at once.

Written for one robot in W worlds: arrays lead with the world axis. A network runs on the host: its weights are small,
and it is asked some tens of times a second.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wsim.assets.policies import PolicySpec
from wsim.errors import UserError
from wsim.scene.world import Policy, World
from wsim.sim.commands import Commands
from wsim.sim.joint_arrays import in_every_world, joint_indices
from wsim.sim.networks import Network, read_network

Floats = NDArray[np.float64]


def load(policy: Policy) -> Network:
    """The network of a policy, if its file is the one that the stage was made for.

    Raises:
        UserError: If it is another, or none.
    """
    path = Path(policy.network)
    if not path.is_file():
        raise UserError(f"{policy.prim}: its network {path} is not there; pull or take in the policy again")
    if hashlib.sha256(path.read_bytes()).hexdigest() != policy.sha256:
        raise UserError(f"{policy.prim}: {path} has changed since the stage was made; build it again")
    return read_network(path, policy.spec.size, len(policy.spec.joints))


class PolicyController:
    """Sets the targets of a robot's servos, once every 1 / rate.

    Args:
        model: The Newton model.
        worlds: What each world states, or the one that all do.
        bodies: Newton's indices of the first world's bodies.
        k: Which of the worlds' policies it is.
    """

    def __init__(self, model: Any, worlds: Sequence[World], bodies: np.ndarray, k: int) -> None:
        count = max(1, model.world_count)
        stated = [worlds[w if len(worlds) > 1 else 0].policies[k] for w in range(count)]
        self._policy, self._network = stated[0], load(stated[0])
        spec = self._policy.spec
        self._commands = Commands(stated)
        self._joints = joint_indices(model, count, self._policy.joints)
        row = [body.prim for body in worlds[0].bodies].index(self._policy.base)
        self._base = in_every_world(bodies[[row]], count, model.body_count)[:, 0]
        self._com = model.body_com.numpy()[self._base].astype(np.float64)
        self._scale = [np.asarray(each.scale) for each in spec.observations]
        self._offset = [np.asarray(each.offset) for each in spec.observations]
        self._action_scale, self._action_offset = np.asarray(spec.action_scale), np.asarray(spec.action_offset)
        self._action = np.zeros((count, len(spec.joints)))

    @property
    def interval(self) -> float:
        """Between two turns [s]."""
        return 1.0 / self._policy.spec.rate

    def __call__(self, t: float, simulation: Any) -> None:
        """Look at the robot in all worlds, and set its targets."""
        spec: PolicySpec = self._policy.spec
        coordinate, dof, target = self._joints
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
        action = self._network(given.astype(np.float32)).astype(np.float64)
        self._action = np.clip(action, -spec.action_limit, spec.action_limit)
        goal = (self._action_offset + self._action_scale * self._action).astype(np.float32)
        targets = simulation.control.joint_target_q.numpy()
        if simulation.rigid and simulation.rigid.ledger:
            simulation.rigid.ledger.retarget(dof.ravel(), (goal - targets[target]).ravel())
        targets[target] = goal
        simulation.control.joint_target_q.assign(targets)

    def _motion(self, state: Any) -> dict[str, Floats]:
        """The base's motion in its own frame, and along its heading; x, y and heading; (W, 3) each."""
        pose = state.body_q.numpy()[self._base].astype(np.float64)
        motion = state.body_qd.numpy()[self._base].astype(np.float64)
        own = axes(pose[:, 3:])  # rows of each are the frame's axes in the world
        spin = motion[:, 3:]
        velocity = motion[:, :3] - np.cross(spin, np.einsum("wij,wi->wj", own, self._com))  # of its origin
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
