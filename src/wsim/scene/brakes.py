"""Brakes that a program's `control` presses: dry friction of the wheels' hinges, by torques. NumPy alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wsim.defaults import GRAVITY
from wsim.limits import MIN_BRAKING
from wsim.scene.layers import point
from wsim.scene.validate import Call, shown
from wsim.scene.vehicle_spec import CORNERS, VehicleSpec

Floats = NDArray[np.float64]

_STANDS = 0.2  # [m/s]: what is slower is held where it is
_HELD = 0.3  # of what would stop it within a call: the damping that holds it
_BACK = 3.0  # [1/s]: its stiffness over its damping


@dataclass(frozen=True)
class Brake:
    """All four brakes are pressed for good from the first moment that one of these comes; the engine is off then.

    Attributes:
        at: A place (x, y) on the path [m]; where the path comes there more than once, the last time.
        time: Of the run [s].
        near, within: A body, by its prim's name, whose origin comes so near to that of the vehicle [m].
        share: Of the brakes' torque, 0.01 to 1; with 1 the wheels lock where the brakes can: it stops in v²/(2 mu g).
    """

    at: Sequence[float] | None = None
    time: float | None = None
    near: str | None = None
    within: float | None = None
    share: float = 1.0

    def checked(self, call: Call) -> Brake:
        """Itself, its numbers checked."""
        if self.at is None and self.time is None and self.near is None:
            call.fail("brake says neither at, nor time, nor near; give one")
        if (self.near is None) != (self.within is None):
            call.fail("brake: near and within go together; give both")
        if self.near is not None and (not isinstance(self.near, str) or not self.near):
            call.fail(f"brake.near = {shown(self.near)} must be the name of a body")
        return Brake(
            at=None if self.at is None else tuple(point(call, "brake.at", self.at)),
            time=None if self.time is None else call.within("brake.time", self.time, 0.0, 1e6, "s"),
            near=self.near,
            within=None if self.within is None else call.positive("brake.within", self.within, 1e4, "m"),
            share=call.within("brake.share", self.share, MIN_BRAKING, 1.0),
        )


class Pressed:
    """What pressed brakes give in each of W worlds, call after call.

    Dry friction gives what stops a wheel, up to so much. Of a wheel that slips that is the inertia that it has left,
    I w / dt, and what the tyre turned it by since the last call: I dw / dt less the torque then given. So it locks
    within two calls, or turns on against the whole torque where that is less than the tyre's. Under 0.2 m/s the
    tyre no longer slips; a damper and a spring about where it is hold it, up to the same torque.
    """

    def __init__(self, spec: VehicleSpec, worlds: int) -> None:
        self._spec = spec
        self._turned, self._gave = np.zeros((4, worlds)), np.zeros((4, worlds))
        self._at = np.full((4, worlds), np.nan)  # where a wheel is held [rad]

    def torque(self, corner: str, axle: Any, speed: Floats, rise: Floats, share: float, step: float) -> Floats:
        """On a wheel's hinge [N m], (W,), at a speed ahead [m/s], where the heading rises by so much."""
        spec, k = self._spec, CORNERS.index(corner)
        turns, angle = (np.asarray(each, dtype=np.float64) for each in (axle.velocity, axle.position))
        most, dt = share * spec.brake_torque, max(step, 1e-3)
        tyre = spec.wheel_inertia * (turns - self._turned[k]) / dt - self._gave[k]
        locks = -spec.wheel_inertia * turns / dt - tyre
        slow = np.abs(speed) < _STANDS
        self._at[k] = np.where(slow, np.where(np.isnan(self._at[k]), angle, self._at[k]), np.nan)
        damping = _HELD * 0.25 * spec.effective_mass * spec.wheel_radius**2 / 0.01
        uphill = 0.25 * spec.mass * GRAVITY * rise * spec.wheel_radius
        holds = uphill - damping * (turns + _BACK * (angle - np.nan_to_num(self._at[k])))
        return np.asarray(np.clip(np.where(slow, holds, locks), -most, most))

    def note(self, corner: str, axle: Any) -> None:
        """Keep what a wheel does and is given."""
        k = CORNERS.index(corner)
        self._turned[k], self._gave[k] = axle.velocity, axle.force
