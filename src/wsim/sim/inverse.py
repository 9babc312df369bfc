"""How the joints of a chain must stand for its link to be at a place: by `newton.ik`, checked in double precision."""

from __future__ import annotations

from typing import Any

import newton
import numpy as np
import warp as wp
from newton import ik

from wsim.geometry.rotations import Floats, rotate
from wsim.sim.arm import Arm, Pose, missed

LENGTH = 0.1  # [m] that a radian of turning is held to be as bad as
NEAR = (1e-4, np.radians(0.05))  # [m], [rad]: what is as near is there
TRIES = 32  # starts, spread over the limits
STEPS, NEXT_STEPS = 100, 12  # of Levenberg and Marquardt's, from anywhere, and from close by


class Inverse:
    """Solves a number of problems of one chain at once.

    Args:
        arm: The chain.
        point: Of the link [m].
        turned: Whether the link's rotation matters.
        count: Problems.
        device: Warp device.
    """

    def __init__(self, arm: Arm, point: Floats, turned: bool, count: int, device: Any) -> None:
        self.arm, self._point, self._turned = arm, point, turned
        self._low = np.where(np.isfinite(arm.low), arm.low, -1e6)
        self._high = np.where(np.isfinite(arm.high), arm.high, 1e6)
        with wp.ScopedDevice(device):
            model = _model(arm, self._low, self._high)
            last, offset = model.body_count - 1, arm.tip[0] + rotate(arm.tip[1], point)
            self._places = wp.zeros(count, dtype=wp.vec3)
            self._turns = wp.zeros(count, dtype=wp.vec4)
            goals = [ik.IKObjectivePosition(last, wp.vec3(*offset.tolist()), self._places)]
            if turned:
                tip = wp.quat(*arm.tip[1].tolist())
                goals.append(ik.IKObjectiveRotation(last, tip, self._turns, weight=LENGTH))
            goals.append(ik.IKObjectiveJointLimit(model.joint_limit_lower, model.joint_limit_upper, weight=1.0))
            self._solver = ik.IKSolver(model, count, goals, jacobian_mode="analytic", lambda_min=1e-9)
            self._q = wp.zeros((count, len(arm.prims)), dtype=wp.float32)

    def solve(self, start: Floats, wanted: Pose, steps: int = NEXT_STEPS) -> tuple[Floats, Floats, Floats]:
        """Coordinates (N, J) within the limits, and by how much they miss, (N,) [m] and (N,) [rad].

        Args:
            start: Coordinates to start from, (N, J).
            wanted: Places (N, 3) and turns (N, 4) in the root's frame.
            steps: Of the optimizer.
        """
        self._places.assign(wanted[0].astype(np.float32))
        self._turns.assign(wanted[1].astype(np.float32))
        self._q.assign(start.astype(np.float32))
        self._solver.step(self._q, self._q, iterations=steps)
        q = np.clip(self._q.numpy().astype(np.float64), self.arm.low, self.arm.high)
        distance, angle = missed(self.arm.reach(q, self._point), wanted)
        return q, distance, angle if self._turned else np.zeros_like(angle)


def nearest(arm: Arm, point: Floats, start: Floats, wanted: Pose, turned: bool, device: Any) -> tuple[Floats, ...]:
    """Of all ways that many starts lead to, the one that is nearest to `start`; or, where none gets there, the best.

    Args:
        arm: The chain.
        point: Of the link [m].
        start: Coordinates, (N, J).
        wanted: Places (N, 3) and turns (N, 4) in the root's frame.
        turned: Whether the turns matter.
        device: Warp device.

    Returns:
        Coordinates (N, J), and by how much they miss, (N,) [m] and (N,) [rad].
    """
    count = len(start)
    seeds = np.concatenate([start[:, None], np.broadcast_to(_spread(arm), (count, TRIES, len(arm.prims)))], axis=1)
    each = seeds.shape[1]
    goals = np.repeat(wanted[0], each, axis=0), np.repeat(wanted[1], each, axis=0)
    inverse = Inverse(arm, point, turned, count * each, device)
    q, distance, angle = inverse.solve(seeds.reshape(count * each, -1), goals, STEPS)
    q = _unwound(arm, q.reshape(seeds.shape), start[:, None])
    distance, angle = distance.reshape(count, each), angle.reshape(count, each)
    there = (distance <= NEAR[0]) & (angle <= NEAR[1])
    cost = np.where(there, np.abs(q - start[:, None]).max(axis=2), 1e6 + distance + LENGTH * angle)
    best = np.arange(count), cost.argmin(axis=1)
    return q[best], distance[best], angle[best]


def _unwound(arm: Arm, q: Floats, start: Floats) -> Floats:
    """The same without whole turns of hinges, as far as their limits leave it."""
    turns = np.where(arm.slides, 0.0, 2.0 * np.pi * np.rint((q - start) / (2.0 * np.pi)))
    less = q - turns
    return np.where((less >= arm.low) & (less <= arm.high), less, q)


def _spread(arm: Arm) -> Floats:
    """Starts all over the limits, (TRIES, J): multiples of powers of a root, which keep apart (Roberts 2018)."""
    count = len(arm.prims)
    root = 2.0
    for _ in range(32):  # of x^(J + 1) = x + 1
        root = (1.0 + root) ** (1.0 / (count + 1))
    shares = np.mod(0.5 + np.arange(1, TRIES + 1)[:, None] * root ** -np.arange(1.0, count + 1.0), 1.0)
    free = np.where(arm.slides, 1.0, np.pi)
    low, high = np.where(np.isfinite(arm.low), arm.low, -free), np.where(np.isfinite(arm.high), arm.high, free)
    return np.asarray(low + shares * (high - low))


def _model(arm: Arm, low: Floats, high: Floats) -> Any:
    """The chain alone, as Newton has it."""
    builder = newton.ModelBuilder()
    joints, parent = [], -1
    for j, slides in enumerate(arm.slides):
        link = builder.add_link(mass=1.0, inertia=wp.mat33(np.eye(3)))
        add = builder.add_joint_prismatic if slides else builder.add_joint_revolute
        joints.append(
            add(
                parent,
                link,
                axis=wp.vec3(*arm.axis[j].tolist()),
                parent_xform=_transform(arm.ahead, j),
                child_xform=_transform(arm.back, j),
                limit_lower=float(low[j]),
                limit_upper=float(high[j]),
            )
        )
        parent = link
    builder.add_articulation(joints)
    return builder.finalize()


def _transform(poses: Pose, j: int) -> Any:
    return wp.transform(poses[0][j].tolist(), poses[1][j].tolist())
