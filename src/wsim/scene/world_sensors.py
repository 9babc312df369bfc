"""Sensors as plain data: what each is fixed to, how often it is read, and what it tells."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated, Literal, TypeAlias

from pydantic import BaseModel, ConfigDict, Field

_Vec3: TypeAlias = tuple[float, float, float]
_Quat: TypeAlias = tuple[float, float, float, float]
Shape: TypeAlias = tuple[int, ...]


class _Sensor(BaseModel):
    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)

    prim: str
    rate: float  # samples a second [Hz]
    line: str | None = None


class _Mounted(_Sensor):
    body: str | None  # prim of the body that it is fixed to; None: the world
    position: _Vec3 = (0.0, 0.0, 0.0)  # [m], in the body's frame, or the world's
    rotation: _Quat = (0.0, 0.0, 0.0, 1.0)  # of its own frame, likewise


class SensorIMU(_Mounted):
    """An inertial measurement unit: specific force and angular velocity, in its own frame."""

    kind: Literal["imu"] = "imu"
    accelerometer_noise: float = 0.0  # density [m/s^2/sqrt(Hz)]
    gyroscope_noise: float = 0.0  # density [rad/s/sqrt(Hz)]
    accelerometer_bias: _Vec3 = (0.0, 0.0, 0.0)  # [m/s^2], in its own frame
    gyroscope_bias: _Vec3 = (0.0, 0.0, 0.0)  # [rad/s]
    seed: int | None = None  # of its noise; None: the world's

    @property
    def channels(self) -> dict[str, Shape]:
        """Shape of what it tells, by name."""
        return {"accelerometer": (3,), "gyroscope": (3,)}


class SensorJoints(_Sensor):
    """Position, velocity and effort of hinges and sliders."""

    kind: Literal["joints"] = "joints"
    joints: list[str]  # prims

    @property
    def channels(self) -> dict[str, Shape]:
        """Shape of what it tells, by name."""
        shape = (len(self.joints),)
        return {"position": shape, "velocity": shape, "effort": shape}


class SensorRange(_Mounted):
    """A fan of rays: the distance to the first surface along each."""

    kind: Literal["range"] = "range"
    azimuths: list[float]  # of the rays of a layer [rad], from X to Y of its own frame
    elevations: list[float]  # of the layers [rad], from there to Z
    nearest: float = 0.0  # [m]: what is nearer is not seen
    farthest: float  # [m]
    noise: float = 0.0  # standard deviation [m]
    seed: int | None = None  # of its noise; None: the world's

    @property
    def channels(self) -> dict[str, Shape]:
        """Shape of what it tells, by name."""
        return {"distance": (len(self.elevations), len(self.azimuths))}


class SensorContact(_Sensor):
    """What contacts push a body with, in a frame that turns with it."""

    kind: Literal["contact"] = "contact"
    body: str  # prim
    rotation: _Quat = (0.0, 0.0, 0.0, 1.0)  # of its own frame, in the body's
    threshold: float  # [N]: it is touched where contacts press with more

    @property
    def channels(self) -> dict[str, Shape]:
        """Shape of what it tells, by name."""
        return {"force": (3,), "touching": ()}


class SensorCamera(_Mounted):
    """A pinhole camera along +X of its own frame, +Z up, whose pixels are measurements."""

    kind: Literal["camera"] = "camera"
    width: int  # [pixel]
    height: int  # [pixel]
    fov: float  # from left to right [deg]
    farthest: float  # [m]: depth beyond it is infinite
    tells: list[Literal["color", "depth", "segmentation"]]

    @property
    def channels(self) -> dict[str, Shape]:
        """Shape of what it tells, by name."""
        size = (self.height, self.width)
        return {name: (*size, 3) if name == "color" else size for name in self.tells}


Sensor: TypeAlias = Annotated[
    SensorIMU | SensorJoints | SensorRange | SensorContact | SensorCamera, Field(discriminator="kind")
]


def channels(sensors: Iterable[Sensor]) -> list[tuple[str, str, Shape]]:
    """What sensors tell, side by side as the simulator gives it: prim, channel and shape of each part, in its order."""
    return [(each.prim, name, shape) for each in sensors for name, shape in each.channels.items()]
