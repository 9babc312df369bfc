"""Where fluid comes into a world and leaves it."""

from __future__ import annotations

import math

from pydantic import BaseModel, ConfigDict

from wsim.geometry.filled import lattice_axis

Vec3 = tuple[float, float, float]


class Opening(BaseModel):
    """A mouth that fluid goes through."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    prim: str
    fluid: str  # prim of what goes through it
    position: Vec3  # of its centre [m], world
    direction: Vec3 = (0.0, 0.0, -1.0)  # which way fluid goes, of length 1
    radius: float = 0.0  # of a round one [m]; 0 where it is a rectangle
    size: tuple[float, float] = (0.0, 0.0)  # width and height of a rectangle [m]
    line: str | None = None

    @property
    def area(self) -> float:
        """Of the mouth [m^2]."""
        return math.pi * self.radius**2 if self.radius else self.size[0] * self.size[1]


class Tap(Opening):
    """A mouth that fluid comes out of, at `rate` from `start` to `stop`."""

    rate: float  # [m^3/s]
    start: float = 0.0  # [s]
    stop: float | None = None  # [s]; None: never
    drop_speed: float = 0.0  # of drops at the mouth [m/s]; 0 for a stream

    @property
    def speed(self) -> float:
        """That fluid has at the mouth [m/s]."""
        return self.drop_speed or self.rate / self.area

    def poured(self, time: float) -> float:
        """Volume that has come out by a time [m^3]."""
        until = time if self.stop is None else min(time, self.stop)
        return self.rate * max(until - self.start, 0.0)

    def first(self, spacing: float) -> float:
        """Volume after which its first particles are out [m^3]: half a layer over the mouth, or half a drop."""
        if self.drop_speed:
            return 0.5 * spacing**3
        if self.radius:
            return 0.5 * max(1, round(self.area / spacing**2)) * spacing**3
        wide, high = (lattice_axis(length, spacing)[0] for length in self.size)
        return 0.5 * wide * high * spacing**3


class Drain(Opening):
    """A face that fluid leaves through, and is gone."""

    falls: bool = True  # freely behind it, or goes on as it came
