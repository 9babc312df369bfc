"""Sensors at work: each is read at its own rate in all worlds at once, by whoever wants its last sample.

Newton's own `SensorIMU` wants the solver's accelerations. Those leave out what a blow changes, and under the law of
contact (`wsim.solvers.contact_law`) a step's velocities are not what they alone lead to: here readings come from the
state, as a recording has it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wsim.scene.world_sensors import Sensor, SensorCamera, SensorContact, SensorIMU, SensorJoints, SensorRange
from wsim.sim.sensor_camera import Camera
from wsim.sim.sensor_contact import Contact
from wsim.sim.sensor_imu import IMU
from wsim.sim.sensor_joints import Joints
from wsim.sim.sensor_range import Range
from wsim.sim.turns import Controller, Turns

if TYPE_CHECKING:
    from wsim.scene.world import World
    from wsim.sim.model import Built

Floats = NDArray[np.float64]
Sample = dict[str, NDArray[Any]]  # by channel, each (W, ...)
# Time [s], prim, what the first world's tells, and points in the world that it met, if it meets any.
Kept = Callable[[float, str, Mapping[str, NDArray[Any]], Floats | None], None]
KINDS: dict[type[Any], Callable[[Built, int, float, Sequence[int]], Any]] = {
    SensorIMU: IMU,
    SensorJoints: Joints,
    SensorRange: Range,
    SensorContact: Contact,
    SensorCamera: Camera,
}


def sees(world: World) -> bool:
    """Whether a world has a camera among its sensors."""
    return any(isinstance(sensor, SensorCamera) for sensor in world.sensors)


class Sensors:
    """The sensors of a world, in all worlds.

    Args:
        built: The model.
        dt: The time step [s].
        seeds: One for each world, of what its sensors' noise differs by from another's; by default copies of one stage
            are counted.
        wanted: Whether a controller asks what they told; else cameras draw nothing until `tell` is called.
    """

    def __init__(self, built: Built, dt: float, seeds: Sequence[int] = (), wanted: bool = True) -> None:
        self._keep: Kept | None = None
        self._wanted = wanted
        self._cameras: list[Camera] = []
        self._worlds = max(1, built.model.world_count)
        own = seeds or (range(self._worlds) if len(built.worlds) == 1 else [0] * self._worlds)
        self._turns = Turns(dt)
        self._last: dict[str, Sample] = {}
        for k, sensor in enumerate(built.world.sensors):
            steps = max(1, round(1.0 / (sensor.rate * dt)))
            reader = KINDS[type(sensor)](built, k, steps * dt, own)
            if isinstance(reader, Camera):
                self._cameras.append(reader)
            self._turns.add(self._reading(sensor, reader), steps * dt)
        if wanted:
            self._prepare()

    def __bool__(self) -> bool:
        """Whether any are read."""
        return bool(self._turns)

    def tell(self, keep: Kept) -> None:
        """Have somebody told of each sample of the first world from now on."""
        self._keep = keep
        self._prepare()

    def _prepare(self) -> None:
        self._wanted = True
        for camera in self._cameras:
            camera.prepare()

    def ask(self, step: int, simulation: Any) -> int:
        """Read those whose turn is at a step; the steps until the next turn of any."""
        return self._turns.ask(step, simulation)

    def flat(self) -> NDArray[np.float32]:
        """The last sample of all, side by side in the order of `World.sensors` and of their channels, (W, n)."""
        parts = [part for sample in self._last.values() for part in sample.values()]
        rows = [part.reshape(self._worlds, -1).astype(np.float32, copy=False) for part in parts]
        return np.concatenate([np.zeros((self._worlds, 0), np.float32), *rows], axis=1)

    def _reading(self, sensor: Sensor, reader: Any) -> Controller:
        def turn(t: float, simulation: Any) -> None:
            if isinstance(reader, Camera) and not self._wanted:
                return
            sample = self._last[sensor.prim] = reader(t, simulation)
            if self._keep is not None and (t > 0.0 or not reader.spans):
                first = {name: part[0] for name, part in sample.items()}
                self._keep(t, sensor.prim, first, getattr(reader, "points", None))

        return turn
