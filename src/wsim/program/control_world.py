"""What `control(world, t)` is given: the state of all worlds as arrays, and where to put what it decides.

    def control(world, t):
        hinge = world.joint("hinge")
        hinge.target = 0.5 * np.sin(t)
        world.apply_force("block", (0.0, 0.0, 2.0))

Imported in the sandbox beside the program: NumPy alone.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float32]

_ALIGN = 64
INPUTS = ("body_q", "body_qd", "joint_q", "joint_qd", "sensed")
OUTPUTS = ("joint_target", "joint_force", "body_force")


@dataclass(frozen=True)
class ControlLayout:
    """Names and counts: the shapes of the arrays that the simulator and `control` share.

    Attributes:
        bodies: Prim paths of the bodies, in the order of `body_q`.
        joints: Prim paths of the joints with one degree of freedom, in the order of `joint_q`.
        world_count: Worlds that run side by side: the leading axis of every array.
        channels: Of sensors, in the order of `sensed`: prim path, channel, and shape of what it tells.
        labels: Prim paths of what a camera's segmentation has numbers for, in the order of those.
        apart: Each world has the program to itself, loaded for it alone, and is asked by itself as the only one;
            without, one call is asked about all of them.
    """

    bodies: list[str]
    joints: list[str] = field(default_factory=list)
    world_count: int = 1
    apart: bool = False
    channels: list[tuple[str, str, tuple[int, ...]]] = field(default_factory=list)
    labels: list[str] = field(default_factory=list)

    def shapes(self) -> dict[str, tuple[int, ...]]:
        """The shape of each array by name; all are float32, but for `t`, float64."""
        w, b, j = self.world_count, len(self.bodies), len(self.joints)
        return {
            "t": (1,),
            "body_q": (w, b, 7),
            "body_qd": (w, b, 6),
            "joint_q": (w, j),
            "joint_qd": (w, j),
            "sensed": (w, sum(math.prod(shape) for _, _, shape in self.channels)),
            "joint_target": (w, j),
            "joint_force": (w, j),
            "body_force": (w, b, 6),
        }

    @property
    def size(self) -> int:
        """Bytes of all arrays together."""
        return max(_ALIGN, sum(_padded(name, shape) for name, shape in self.shapes().items()))

    def views(self, buffer: Any) -> dict[str, NDArray[Any]]:
        """The arrays in a buffer of `size` bytes."""
        arrays, offset = {}, 0
        for name, shape in self.shapes().items():
            arrays[name] = np.ndarray(shape, _dtype(name), buffer, offset)
            offset += _padded(name, shape)
        return arrays

    def worlds(self, arrays: dict[str, NDArray[Any]]) -> list[ControlWorld]:
        """What each call is given: all worlds, or each `apart`."""
        if not self.apart:
            return [ControlWorld(self, arrays)]
        one = replace(self, world_count=1)
        names = (*INPUTS, *OUTPUTS)
        return [ControlWorld(one, {name: arrays[name][k : k + 1] for name in names}) for k in range(self.world_count)]


def _dtype(name: str) -> type[np.floating[Any]]:
    return np.float64 if name == "t" else np.float32


def _padded(name: str, shape: tuple[int, ...]) -> int:
    count = int(np.prod(shape)) * np.dtype(_dtype(name)).itemsize
    return -(-count // _ALIGN) * _ALIGN


@dataclass(frozen=True)
class ControlBody:
    """The state of one body in all worlds, W of them; the arrays are for reading.

    Attributes:
        position: (W, 3) of its origin, world frame [m].
        rotation: (W, 4) quaternion xyzw.
        velocity: (W, 3) of its centre of mass [m/s].
        angular_velocity: (W, 3), world frame [rad/s].
    """

    position: Floats
    rotation: Floats
    velocity: Floats
    angular_velocity: Floats


class ControlJoint:
    """The state of one joint in all worlds, W of them, and what is asked of it.

    Attributes:
        position: (W,) angle [rad] or travel [m]; for reading.
        velocity: (W,) [rad/s] or [m/s]; for reading.
    """

    def __init__(self, position: Floats, velocity: Floats, target: Floats, force: Floats) -> None:
        self.position = position
        self.velocity = velocity
        self._target = target
        self._force = force

    @property
    def target(self) -> Floats:
        """(W,) what its drive aims at [rad] or [m]; stays until it is set again. One number sets all worlds."""
        return self._target

    @target.setter
    def target(self, value: ArrayLike) -> None:
        self._target[...] = value

    @property
    def force(self) -> Floats:
        """(W,) torque [N m] or force [N] on it; zero at the start of every call."""
        return self._force

    @force.setter
    def force(self, value: ArrayLike) -> None:
        self._force[...] = value


class ControlSensor:
    """What a sensor told last, in all worlds, W of them; the arrays are for reading, and each kind has some of them."""

    def __init__(self, prim: str, channels: dict[str, Floats], labels: Sequence[str] = ()) -> None:
        self._prim, self._channels, self._labels = prim, channels, list(labels)

    @property
    def accelerometer(self) -> Floats:
        """(W, 3) specific force, in the frame of an IMU [m/s^2]: mean since the sample before, 9.81 upwards at rest."""
        return self._channel("accelerometer")

    @property
    def gyroscope(self) -> Floats:
        """(W, 3) angular velocity, in the frame of an IMU [rad/s]."""
        return self._channel("gyroscope")

    @property
    def position(self) -> Floats:
        """(W, J) of a joint sensor's joints [rad] or [m]."""
        return self._channel("position")

    @property
    def velocity(self) -> Floats:
        """(W, J) of a joint sensor's joints [rad/s] or [m/s]."""
        return self._channel("velocity")

    @property
    def effort(self) -> Floats:
        """(W, J) of a joint sensor's joints' drives and of `force` [N m] or [N]."""
        return self._channel("effort")

    @property
    def distance(self) -> Floats:
        """(W, layers, rays) of a range scan [m]; infinite where nothing is met."""
        return self._channel("distance")

    @property
    def force(self) -> Floats:
        """(W, 3) of contacts, in the frame of a contact sensor [N]."""
        return self._channel("force")

    @property
    def touching(self) -> Floats:
        """(W,) 1 where anything touches a contact sensor's body, else 0."""
        return self._channel("touching")

    @property
    def color(self) -> NDArray[np.uint8]:
        """(W, H, W, 3) sRGB of a camera's newest picture: worlds, rows from the top, columns from the left."""
        return self._channel("color").astype(np.uint8)

    @property
    def depth(self) -> Floats:
        """(W, H, W) of a camera's pixels [m], along its axis; infinite where nothing is met."""
        return self._channel("depth")

    @property
    def segmentation(self) -> NDArray[np.int32]:
        """(W, H, W) number of the object that each of a camera's pixels is of, an index of `labels`; 0 is nothing."""
        return self._channel("segmentation").astype(np.int32)

    @property
    def labels(self) -> list[str]:
        """Names of the objects by the number that `segmentation` has for them; that of 0, nothing, is empty. A copy."""
        return list(self._labels)

    def _channel(self, name: str) -> Floats:
        if name not in self._channels:
            raise AttributeError(f"the sensor {self._prim} tells no {name}; it tells {', '.join(self._channels)}")
        return self._channels[name]


class ControlWorld:
    """All worlds at one time. Names are prim names or prim paths."""

    def __init__(self, layout: ControlLayout, arrays: dict[str, NDArray[Any]]) -> None:
        self.world_count = layout.world_count
        self._bodies, self._joints = _names(layout.bodies), _names(layout.joints)
        self._prims = list(dict.fromkeys(prim for prim, _, _ in layout.channels))
        self._sensors, self._channels = _names(self._prims), layout.channels
        self._labels = [label.rsplit("/", 1)[-1] for label in layout.labels]
        self._arrays = dict(arrays)
        for name in INPUTS:
            self._arrays[name] = arrays[name].view()
            self._arrays[name].flags.writeable = False

    @property
    def bodies(self) -> list[str]:
        """Prim paths of the bodies."""
        return [name for name in self._bodies if name.startswith("/")]

    @property
    def joints(self) -> list[str]:
        """Prim paths of the joints."""
        return [name for name in self._joints if name.startswith("/")]

    def body(self, name: str) -> ControlBody:
        """The state of a body; LookupError if there is none of that name."""
        i = _find(self._bodies, name, "body")
        pose, motion = self._arrays["body_q"][:, i], self._arrays["body_qd"][:, i]
        return ControlBody(pose[:, :3], pose[:, 3:], motion[:, :3], motion[:, 3:])

    def joint(self, name: str) -> ControlJoint:
        """The state of a joint; LookupError if there is none of that name."""
        i = _find(self._joints, name, "joint")
        a = self._arrays
        return ControlJoint(a["joint_q"][:, i], a["joint_qd"][:, i], a["joint_target"][:, i], a["joint_force"][:, i])

    @property
    def sensors(self) -> list[str]:
        """Prim paths of the sensors."""
        return list(self._prims)

    def sensor(self, name: str) -> ControlSensor:
        """What a sensor told last; LookupError if there is none of that name."""
        prim = self._prims[_find(self._sensors, name, "sensor")]
        found, start = {}, 0
        for owner, channel, shape in self._channels:
            end = start + math.prod(shape)
            if owner == prim:
                found[channel] = self._arrays["sensed"][:, start:end].reshape(self.world_count, *shape)
            start = end
        return ControlSensor(prim, found, self._labels)

    def apply_force(self, name: str, force: ArrayLike, torque: ArrayLike = (0.0, 0.0, 0.0)) -> None:
        """Push a body until the next call, on top of what was applied in this one.

        Args:
            name: The body.
            force: (3,) for all worlds or (W, 3), at its centre of mass, world frame [N].
            torque: (3,) or (W, 3), world frame [N m].
        """
        push = self._arrays["body_force"][:, _find(self._bodies, name, "body")]
        push[:, :3] += np.asarray(force, np.float32)
        push[:, 3:] += np.asarray(torque, np.float32)


def _names(paths: Sequence[str]) -> dict[str, int]:
    """Index by path, and by name where one prim alone has it."""
    names = [path.rsplit("/", 1)[-1] for path in paths]
    known = {name: i for i, name in enumerate(names) if names.count(name) == 1}
    return known | {path: i for i, path in enumerate(paths)}


def _find(known: dict[str, int], name: str, kind: str) -> int:
    index = known.get(name)
    if index is None:
        raise LookupError(f"no {kind} {name!r}; known: {', '.join(known) or 'none'}")
    return index
