"""What policies are told, on the device: `wsim.sim.commands` for all worlds at once, without copies to the host."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import warp as wp

from wsim.kernels.policy_commands import bring_on, follow_routes, state_commands
from wsim.scene.world import Policy
from wsim.sim.commands import APPROACH, NEAR, TURN


class CommandsOnDevice:
    """What each of W worlds is told, brought on slowly and trimmed.

    Args:
        policies: The policy as each world states it.
        device: Warp device.
    """

    def __init__(self, policies: Sequence[Policy], device: Any) -> None:
        spec, self._count, self._device = policies[0].spec, len(policies), device
        self._times = self._array(_padded([each.times for each in policies], np.inf), wp.float64)
        self._commands = self._array(_padded([each.commands for each in policies], 0.0), wp.vec3)
        self._route = None
        if policies[0].route:
            self._route = self._array(_padded([each.route for each in policies], 0.0), wp.vec3)
            self._points = self._array([len(each.route) for each in policies], int)
            self._speed = self._array([each.speed for each in policies], float)
        dt, trim, slew = 1.0 / spec.rate, spec.trim, spec.command_slew
        self._limit = wp.vec3(spec.command_limit)
        self._most = wp.vec3(np.inf, np.inf, np.inf) if slew is None else wp.vec3(np.array(slew) * dt)
        self._share, self._rate, self._sum_limit = 0.0, wp.vec3(), wp.vec3()
        if trim:
            self._share = dt / (trim.smoothing + dt)
            self._rate, self._sum_limit = wp.vec3(np.array(trim.gain) * dt), wp.vec3(trim.limit)
        self._next = wp.zeros(self._count, dtype=int, device=device)
        self._wanted, self._now, self._smoothed, self._sum = (
            wp.zeros(self._count, dtype=wp.vec3, device=device) for _ in range(4)
        )

    def _array(self, values: Any, dtype: Any) -> Any:
        return wp.array(values, dtype=dtype, device=self._device)

    def launch(self, clock: Any, measured: Any, where: Any, felt: Any) -> None:
        """Write what each is told now.

        Args:
            clock: The time [s], one number in double precision.
            measured: How fast the robots go along their headings, to their left, and turn, (W,) vectors.
            where: x, y [m] and heading [rad] of each, (W,) vectors.
            felt: What is seen of the base, (W, 4) vectors, of which the command is one.
        """
        if self._route is None:
            self._each(state_commands, [clock, self._times, self._commands], [self._wanted])
        else:
            given = [where, self._route, self._points, self._speed, NEAR, APPROACH, TURN]
            self._each(follow_routes, given, [self._next, self._wanted])
        given = [self._wanted, measured, self._limit, self._most, self._share, self._rate, self._sum_limit]
        self._each(bring_on, given, [self._now, self._smoothed, self._sum, felt])

    def _each(self, kernel: Any, inputs: list[Any], outputs: list[Any]) -> None:
        wp.launch(kernel, dim=self._count, inputs=inputs, outputs=outputs, device=self._device)


def _padded(lists: Sequence[Sequence[Any]], by: float) -> np.ndarray:
    """Lists of several lengths as one array."""
    longest = max(map(len, lists))
    rows = [np.asarray(each, dtype=np.float64) for each in lists]
    ends = [[(0, longest - len(row)), *[(0, 0)] * (row.ndim - 1)] for row in rows]
    return np.stack([np.pad(row, end, constant_values=by) for row, end in zip(rows, ends, strict=True)])
