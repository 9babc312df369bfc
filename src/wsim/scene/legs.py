"""A line of straight legs and arcs, for a driver to follow."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from wsim.limits import MAX_SIZE, MAX_WAY
from wsim.scene.layers import Floats, point
from wsim.scene.validate import Call, shown

MOST_TURN = 3600.0  # [deg] of one arc
_LEAST = 1e-3  # [m] of a leg
_FINE = 0.5  # [m] between two points of the line
_TURN = 5.0  # [deg] at most from one of its pieces to the next: that far apart they are R / 1000 inside an arc


@dataclass(frozen=True)
class Arc:
    """Part of a circle of a radius [m], which turns by so much to the left, from where the line goes so far."""

    radius: float
    angle_deg: float


@dataclass(frozen=True)
class Stretch:
    """A leg as it lies: its points but its first, (N, 2) [m], how long it is [m], and where it goes at its ends [rad].

    Where it `enters` otherwise than the leg before `leaves` there is a corner.
    """

    points: Floats
    length: float
    enters: float
    leaves: float


@dataclass(frozen=True)
class Legs:
    """A line from a start, straight on to points, and along arcs that begin as the leg before ends.

    Attributes:
        start: Where it begins, (x, y) [m].
        heading_deg: Where it goes there, to the left from +X: so a first arc begins.
        legs: A point (x, y) [m] or an `Arc` each, in turn.
    """

    start: Sequence[float]
    heading_deg: float
    legs: Sequence[Sequence[float] | Arc]

    def line(self) -> Floats:
        """Points of it, (N, 2) [m], 0.5 m or 5 degrees from one to the next, or a little less."""
        return np.concatenate([np.array([self._start(Call("Legs"))]), *(leg.points for leg in self.stretches())])

    def ends(self) -> list[tuple[float, float]]:
        """Where each leg ends, (x, y) [m]."""
        return [(float(x), float(y)) for x, y in (leg.points[-1] for leg in self.stretches())]

    def stretches(self) -> list[Stretch]:
        """Each leg as it lies.

        Raises:
            SceneError: A leg is none, or all are more than 10 km long.
        """
        call = Call("Legs")
        at = np.array(self._start(call))
        turn = math.radians(call.within("heading_deg", self.heading_deg, -1e4, 1e4, "deg"))
        made: list[Stretch] = []
        total = 0.0
        for k, leg in enumerate(call.listed("legs", self.legs, "points (x, y) or Arcs")):
            name = f"legs[{k}]"
            make = _round if isinstance(leg, Arc) else _straight
            made.append(make(call, name, leg, at, turn, MAX_WAY - total))
            at, turn, total = made[-1].points[-1], made[-1].leaves, total + made[-1].length
        if not made:
            call.fail("legs has none; give a point or an Arc")
        return made

    def _start(self, call: Call) -> tuple[float, float]:
        return point(call, "start", self.start)


def _fits(call: Call, name: str, length: float, left: float) -> None:
    """Whether the line is not too long with a leg."""
    if length > left:
        call.fail(f"{name} ends {MAX_WAY - left + length:.6g} m along the line, which is {MAX_WAY:g} m long at most")


def _straight(call: Call, name: str, leg: object, at: Floats, _: float, left: float) -> Stretch:
    to = np.array(point(call, name, leg))
    length = float(np.linalg.norm(to - at))
    if length < _LEAST:
        call.fail(f"{name} = {shown(leg)} is where the leg before it ends; leave it out")
    _fits(call, name, length, left)
    share = np.arange(1, math.ceil(length / _FINE) + 1) / math.ceil(length / _FINE)
    turn = math.atan2(*(to - at)[::-1])
    return Stretch(at + share[:, None] * (to - at), length, turn, turn)


def _round(call: Call, name: str, arc: Arc, at: Floats, turn: float, left: float) -> Stretch:
    radius = call.within(f"{name}.radius", arc.radius, 0.1, MAX_SIZE, "m")
    angle = call.within(f"{name}.angle_deg", arc.angle_deg, -MOST_TURN, MOST_TURN, "deg")
    if angle == 0.0:
        call.fail(f"{name}.angle_deg = 0 turns by nothing; leave it out")
    length = math.radians(abs(angle)) * radius
    _fits(call, name, length, left)
    side = math.copysign(radius, angle)
    middle = at + side * np.array([-math.sin(turn), math.cos(turn)])
    count = max(math.ceil(abs(angle) / _TURN), math.ceil(length / _FINE))
    ways = turn + math.radians(angle) * np.arange(1, count + 1) / count
    points = middle + side * np.stack([np.sin(ways), -np.cos(ways)], axis=1)
    if math.dist(points[0], at) < _LEAST:
        call.fail(f"{name}.angle_deg = {angle:g} makes an arc of {length:.2g} m; leave it out")
    return Stretch(points, length, turn, float(ways[-1]))
