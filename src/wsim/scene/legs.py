"""A line of straight legs and arcs, for a driver to follow."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from wsim.limits import MAX_SIZE
from wsim.scene.layers import Floats, point
from wsim.scene.validate import Call, shown

MOST_TURN = 3600.0  # [deg] of one arc
_FINE = 0.5  # [m] between two points of the line
_TURN = 5.0  # [deg] at most from one of its pieces to the next: that far apart they are R / 1000 inside an arc


@dataclass(frozen=True)
class Arc:
    """Part of a circle of a radius [m], which turns by so much to the left, from where the line goes so far."""

    radius: float
    angle_deg: float


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
        return np.concatenate([np.array([self._start(Call("Legs"))]), *self._pieces()])

    def ends(self) -> list[tuple[float, float]]:
        """Where each leg ends, (x, y) [m]."""
        return [(float(x), float(y)) for x, y in (piece[-1] for piece in self._pieces())]

    def _start(self, call: Call) -> tuple[float, float]:
        return point(call, "start", self.start)

    def _pieces(self) -> list[Floats]:
        """The points of each leg but its first."""
        call = Call("Legs")
        at = np.array(self._start(call))
        turn = math.radians(call.within("heading_deg", self.heading_deg, -1e4, 1e4, "deg"))
        pieces: list[Floats] = []
        for k, leg in enumerate(call.listed("legs", self.legs, "points (x, y) or Arcs")):
            if isinstance(leg, Arc):
                piece, turn = _round(call, f"legs[{k}]", leg, at, turn)
            else:
                to = np.array(point(call, f"legs[{k}]", leg))
                length = float(np.linalg.norm(to - at))
                if length < 1e-3:
                    call.fail(f"legs[{k}] = {shown(leg)} is where the leg before it ends; leave it out")
                share = np.arange(1, math.ceil(length / _FINE) + 1) / math.ceil(length / _FINE)
                piece, turn = at + share[:, None] * (to - at), math.atan2(*(to - at)[::-1])
            pieces.append(piece)
            at = piece[-1]
        if not pieces:
            call.fail("legs has none; give a point or an Arc")
        return pieces


def _round(call: Call, name: str, arc: Arc, at: Floats, turn: float) -> tuple[Floats, float]:
    """The points of an arc but its first, and where it goes at its end [rad]."""
    radius = call.within(f"{name}.radius", arc.radius, 0.1, MAX_SIZE, "m")
    angle = call.within(f"{name}.angle_deg", arc.angle_deg, -MOST_TURN, MOST_TURN, "deg")
    if angle == 0.0:
        call.fail(f"{name}.angle_deg = 0 turns by nothing; leave it out")
    side = math.copysign(radius, angle)
    middle = at + side * np.array([-math.sin(turn), math.cos(turn)])
    count = max(math.ceil(abs(angle) / _TURN), math.ceil(math.radians(abs(angle)) * radius / _FINE))
    ways = turn + math.radians(angle) * np.arange(1, count + 1) / count
    return middle + side * np.stack([np.sin(ways), -np.cos(ways)], axis=1), float(ways[-1])
