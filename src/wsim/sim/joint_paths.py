"""Joints that go by time: their servos' targets, set in all worlds at once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from wsim.errors import UserError
from wsim.geometry.paths import slopes
from wsim.geometry.rotations import Floats
from wsim.scene.world import World
from wsim.sim.joint_arrays import joint_indices
from wsim.sim.reaching import Track, tracks_of

RATE = 200.0  # [Hz]: how often targets are set
NEVER = 1e9  # [s]


class JointPathController:
    """Sets where servos go, so that their joints go as schedules and reaches say.

    A servo gives k (target - q) - d q'. Its target is q_r + (d q_r' + g) / k, q_r where the joint is to be and g what
    holds the weight that hangs on it there: what is left of the lag is that of the masses' own acceleration, and of
    what is carried besides (Siciliano et al., Robotics, 2009, 8.5: PD control with gravity compensation).

    Args:
        model: The Newton model.
        worlds: What each world states, or the one that all do.
        dt: The time step [s]; a target is that of the middle of the time for which it is set.

    Attributes:
        interval: Between two turns [s].

    Raises:
        UserError: If a place cannot be reached, or two set one joint.
    """

    def __init__(self, model: Any, worlds: Sequence[World], dt: float) -> None:
        count = max(1, model.world_count)
        self.interval = max(1, round(1.0 / (RATE * dt))) * dt
        tracks = _tracks(model, worlds, count)
        prims = list(tracks[0])
        self._joints = joint_indices(model, count, prims)
        longest = max(len(each.times) for own in tracks for each in own.values())
        rows = [[_padded(own[prim], longest) for prim in prims] for own in tracks]
        self._times, self._positions, self._holding, self._speeds = (
            np.array([[row[k] for row in own] for own in rows]) for k in range(4)
        )  # (W or 1, J, T) each
        stiffness, damping = (
            array.numpy()[self._joints[1]] for array in (model.joint_target_ke, model.joint_target_kd)
        )
        self._stiffness, self._damping = stiffness.astype(np.float64), damping.astype(np.float64)

    def __call__(self, t: float, simulation: Any) -> None:
        """Set the targets of all worlds."""
        _, dof, target = self._joints
        goal = self.at(t + 0.5 * self.interval).astype(np.float32)
        targets = simulation.control.joint_target_q.numpy()
        if simulation.rigid and simulation.rigid.ledger:
            simulation.rigid.ledger.retarget(dof.ravel(), (goal - targets[target]).ravel())
        targets[target] = goal
        simulation.control.joint_target_q.assign(targets)

    def at(self, t: float) -> Floats:
        """The targets at a time [s], (W, J) [rad or m]."""
        times = self._times
        k = np.clip((times <= t).sum(axis=2) - 1, 0, times.shape[2] - 2)[..., None]
        first, last = (np.take_along_axis(times, k + n, 2)[..., 0] for n in (0, 1))
        h = last - first
        share = np.clip((t - first) / h, 0.0, 1.0)
        (x0, x1), (v0, v1), (g0, g1) = (
            [np.take_along_axis(each, k + n, 2)[..., 0] for n in (0, 1)]
            for each in (self._positions, self._speeds, self._holding)
        )
        # a cubic of each piece, and its slope
        step = x1 - x0
        square, cube = 3.0 * step - h * (2.0 * v0 + v1), h * (v0 + v1) - 2.0 * step
        place = x0 + share * (h * v0 + share * (square + share * cube))
        speed = v0 + share * (2.0 * square + 3.0 * share * cube) / h
        still = (t < first) | (t >= last)
        effort = self._damping * np.where(still, 0.0, speed) + g0 + share * (g1 - g0)
        return np.asarray(place + effort / self._stiffness)


def _moved(world: World) -> list[str]:
    """The prims of hinges and sliders, whose starts reaches need."""
    return [joint.prim for joint in world.joints if joint.kind in ("revolute", "prismatic") and not joint.closing]


def _tracks(model: Any, worlds: Sequence[World], count: int) -> list[dict[str, Track]]:
    prims = _moved(worlds[0])
    places = model.joint_q.numpy()[joint_indices(model, count, prims)[0]].astype(np.float64)
    starts = [dict(zip(prims, row.tolist(), strict=True)) for row in places[: len(worlds)]]
    found = tracks_of(worlds, starts, model.device)
    for world, own in zip(worlds, found, strict=True):
        for each in world.joint_paths:
            if each.prim in own:
                raise UserError(f"{each.prim}: a reach moves it, and a schedule; leave one out")
            times, where = np.array(each.times), np.array(each.positions)
            own[each.prim] = Track(times, where, np.zeros(len(times)))
    joints = {joint.prim: joint for joint in worlds[0].joints}
    policed = {prim for policy in worlds[0].policies for prim in policy.joints}
    for prim in found[0]:
        if prim in policed:
            raise UserError(f"{prim}: a policy sets it, and a schedule or a reach; leave one out")
        drive = joints[prim].drive if prim in joints else None
        if drive is None or drive.stiffness <= 0.0 or joints[prim].closing:
            raise UserError(f"{prim}: a schedule sets where its servo goes, and it has none; give it a stiffness")
    return found


def _padded(track: Track, longest: int) -> tuple[Floats, Floats, Floats, Floats]:
    """Times, positions, holding efforts and speeds of a track, two or more of each, the last again at the end."""
    h = np.diff(track.times)
    speeds = slopes(np.diff(track.positions) / h, h) if len(h) else np.zeros(1)
    more = max(longest, 2) - len(track.times)
    times = np.concatenate([track.times, NEVER + np.arange(more)])
    ends = [np.concatenate([each, np.full(more, each[-1])]) for each in (track.positions, track.holding, speeds)]
    return times, ends[0], ends[1], ends[2]
