"""Plain geometry: axis-aligned boxes, rotations, and how deep two turned bodies are in each other."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import product

from wsim.plan.schema import Vec3

TOUCH = 1e-3  # faces that meet may overlap by this much [m]
TINY = 1e-9

Matrix = tuple[Vec3, Vec3, Vec3]


@dataclass(frozen=True)
class Box:
    """An axis-aligned box [m]."""

    low: Vec3
    high: Vec3

    @property
    def size(self) -> Vec3:
        """Edge lengths [m]."""
        a, b = self.low, self.high
        return (b[0] - a[0], b[1] - a[1], b[2] - a[2])

    @property
    def center(self) -> Vec3:
        """The middle [m]."""
        a, b = self.low, self.high
        return ((a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2)

    def overlap(self, other: Box) -> float:
        """How deep two boxes are in each other along their shallowest axis; not positive when they are apart [m]."""
        return min(
            min(a_high, b_high) - max(a_low, b_low)
            for a_low, a_high, b_low, b_high in zip(self.low, self.high, other.low, other.high, strict=True)
        )


def union(boxes: list[Box]) -> Box:
    """The box round all of them; there must be one."""
    low = [min(box.low[axis] for box in boxes) for axis in range(3)]
    high = [max(box.high[axis] for box in boxes) for axis in range(3)]
    return Box((low[0], low[1], low[2]), (high[0], high[1], high[2]))


def rotation(rotation_deg: Vec3) -> Matrix:
    """Roll about X, then pitch about Y, then yaw about Z [deg], as a matrix whose columns are the body's axes."""
    roll, pitch, yaw = (math.radians(angle) for angle in rotation_deg)
    cr, sr, cp, sp, cy, sy = (f(a) for a in (roll, pitch, yaw) for f in (math.cos, math.sin))
    return (
        (cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
        (sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
        (-sp, cp * sr, cp * cr),
    )


def turned(vector: tuple[float, float], yaw: float) -> tuple[float, float]:
    """A vector of the plane, turned by `yaw` [deg]."""
    c, s = math.cos(math.radians(yaw)), math.sin(math.radians(yaw))
    return (c * vector[0] - s * vector[1], s * vector[0] + c * vector[1])


def angle_between(a: float, b: float) -> float:
    """How far two headings are apart: 0 to 180 [deg]."""
    return abs((a - b + 180.0) % 360.0 - 180.0)


@dataclass(frozen=True)
class Solid:
    """A convex body: a box, sphere, cylinder or capsule, with its centre, its axes and its half extents along them."""

    kind: str
    center: Vec3
    axes: Matrix
    half: Vec3

    def reach(self, n: Vec3) -> float:
        """How far it reaches from its centre along the unit vector `n` [m]."""
        along = [abs(sum(n[i] * self.axes[i][k] for i in range(3))) for k in range(3)]
        if self.kind == "sphere":
            return self.half[0]
        if self.kind == "capsule":
            return along[2] * (self.half[2] - self.half[0]) + self.half[0]
        if self.kind == "cylinder":
            return along[2] * self.half[2] + math.sqrt(max(0.0, 1.0 - along[2] ** 2)) * self.half[0]
        return sum(a * h for a, h in zip(along, self.half, strict=True))

    def box(self) -> Box:
        """The axis-aligned box round it."""
        x, y, z = self.center
        rx, ry, rz = (self.reach(axis) for axis in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)))
        return Box((x - rx, y - ry, z - rz), (x + rx, y + ry, z + rz))


def depth(a: Solid, b: Solid) -> float:
    """How deep two solids are in each other, by separating axes; not positive when one of them parts the two [m].

    Exact for boxes and for two spheres. For the other round shapes the axes tried are those of their faces and of the
    line between the centres, so that two that nearly touch may count as touching.
    """
    between = (b.center[0] - a.center[0], b.center[1] - a.center[1], b.center[2] - a.center[2])
    if a.kind == b.kind == "sphere":
        return a.half[0] + b.half[0] - math.hypot(*between)
    columns = [[(m[0][k], m[1][k], m[2][k]) for k in range(3)] for m in (a.axes, b.axes)]
    tried = [*columns[0], *columns[1], *(_cross(u, v) for u, v in product(*columns))]
    tried += [between, (between[0], between[1], 0.0)]
    least = math.inf
    for n in tried:
        length = math.hypot(*n)
        if length < 1e-6:
            continue
        unit = (n[0] / length, n[1] / length, n[2] / length)
        apart = abs(sum(unit[i] * between[i] for i in range(3)))
        least = min(least, a.reach(unit) + b.reach(unit) - apart)
        if least <= 0.0:
            break
    return least


def _cross(u: Vec3, v: Vec3) -> Vec3:
    return (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
