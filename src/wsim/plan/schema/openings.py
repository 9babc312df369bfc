"""Where fluid comes into a plan's world, and where it leaves."""

from __future__ import annotations

import math
from typing import Literal

from pydantic import model_validator

from wsim.plan.schema.base import Name, NotNegative, Number, Positive, Sparse, Vec3

_OF_TAPS = ("rate", "start", "stop", "drop_speed")


class OpeningPlan(Sparse):
    """A tap, a hose or rain that lets a fluid in, or a drain that lets it out."""

    name: Name
    kind: Literal["tap", "drain"]
    fluid: Name
    at: Name | None = None  # the object whose rim or top it is over, or, of a drain, whose inner floor it is in
    offset: Vec3 = (0.0, 0.0, 0.0)  # of its centre from the middle of that, or the world's origin [m]
    direction: tuple[Number, Number, Number] | None = None  # which way fluid goes; down
    radius: Positive | None = None  # of a round mouth [m]
    size: tuple[Positive, Positive] | None = None  # width and height of a rectangular one [m]
    rate: Positive | None = None  # of a tap [m^3/s]
    start: NotNegative | None = None  # [s]
    stop: Positive | None = None  # [s]
    drop_speed: Positive | None = None  # of rain [m/s]

    @model_validator(mode="after")
    def _is_whole(self) -> OpeningPlan:
        if (self.radius is None) == (self.size is None):
            raise ValueError('give "radius", of a round mouth, or "size", width and height of a rectangular one')
        if self.kind == "tap" and self.rate is None:
            raise ValueError('a tap needs a "rate" in m^3/s; a litre a second is 0.001')
        given = [name for name in _OF_TAPS if getattr(self, name) is not None]
        if self.kind == "drain" and given:
            raise ValueError(f'"{given[0]}" is of a tap; a drain takes what comes to it')
        if self.direction is not None and not any(self.direction):
            raise ValueError("direction is zero; say which way the fluid goes")
        if self.stop is not None and self.stop <= (self.start or 0.0):
            raise ValueError(f"stop = {self.stop:g} s must be after start, {self.start or 0.0:g} s")
        return self

    @property
    def area(self) -> float:
        """Of the mouth [m^2]."""
        return math.prod(self.size) if self.size else math.pi * (self.radius or 0.0) ** 2

    @property
    def narrowest(self) -> float:
        """How wide the mouth is at its narrowest [m]."""
        return min(self.size) if self.size else 2.0 * (self.radius or 0.0)

    def poured(self, time: float) -> float:
        """Volume that has come out by a time [m^3]."""
        until = time if self.stop is None else min(time, self.stop)
        return (self.rate or 0.0) * max(until - (self.start or 0.0), 0.0)
