"""Forms that many things are made of, seen and touched, built of `parts`."""

from __future__ import annotations

import math

import numpy as np

from .parts import SIDES, Collider, Mesh, Point, Profile, box, lathe, prism, rotation

ALONG = {"X": ("Y", 90.0), "Y": ("X", -90.0), "Z": ("Z", 0.0)}  # turns +Z to an axis


def cylinder(radius: float, height: float, base: Point = (0.0, 0.0, 0.0), axis: str = "Z", sides: int = SIDES) -> Mesh:
    """A cylinder of `height` along +axis from the centre `base` of its lower end [m]."""
    return cone(radius, radius, height, base, axis, sides)


def cone(
    low: float, high: float, height: float, base: Point = (0.0, 0.0, 0.0), axis: str = "Z", sides: int = SIDES
) -> Mesh:
    """A frustum of radius `low` at its base and `high` at the other end [m]; either may be 0."""
    rim = [(r, z) for r, z in ((low, 0.0), (high, height)) if r > 0.0]
    return lathe([(0.0, 0.0), *rim, (0.0, height)], sides).turned(*ALONG[axis]).moved(*base)


def disc(radius: float, width: float, center: Point, axis: str = "Y", sides: int = SIDES) -> Mesh:
    """A wheel: a cylinder about its centre [m]."""
    return cylinder(radius, width, (0.0, 0.0, -width / 2), "Z", sides).turned(*ALONG[axis]).moved(*center)


def annulus(outer: float, inner: float, width: float, center: Point, axis: str = "Z", sides: int = SIDES) -> Mesh:
    """A flat ring about its centre [m]."""
    half = width / 2
    rim = lathe([(inner, -half), (outer, -half), (outer, half), (inner, half)], sides)
    return rim.turned(*ALONG[axis]).moved(*center)


def globe(radius: float, center: Point = (0.0, 0.0, 0.0), sides: int = 24, rows: int = 12) -> Mesh:
    """A sphere [m]."""
    angle = [math.pi * k / rows for k in range(1, rows)]
    rim = [(radius * math.sin(a), -radius * math.cos(a)) for a in angle]
    return lathe([(0.0, -radius), *rim, (0.0, radius)], sides).moved(*center)


def cushion(size: Point, center: Point = (0.0, 0.0, 0.0), bevel: float = 0.02) -> Mesh:
    """A box with its edges taken off [m]."""
    x, y, z = size[0] / 2, size[1] / 2, size[2] / 2
    rings = [
        octagon(x - bevel, y - bevel, bevel / 2, -z),
        octagon(x, y, bevel, bevel - z),
        octagon(x, y, bevel, z - bevel),
        octagon(x - bevel, y - bevel, bevel / 2, z),
    ]
    return prism(rings).moved(*center)


def octagon(x: float, y: float, cut: float, z: float) -> list[Point]:
    """A rectangle of half edges x and y at height z whose corners are cut off [m]."""
    flat = [(x, cut - y), (x, y - cut), (x - cut, y), (cut - x, y), (-x, y - cut), (-x, cut - y), (cut - x, -y),
            (x - cut, -y)]  # fmt: skip
    return [(i, j, z) for i, j in flat]


def upright(outline: Profile, thick: float, axis: str = "X") -> Mesh:
    """A plate that stands across an axis, centred: its outline turns counterclockwise seen against the axis."""
    turn = {"X": np.array([(0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)]), "Z": np.eye(3)}[axis]
    rings = [[(u, v, w) for u, v in outline] for w in (-thick / 2, thick / 2)]
    mesh = prism(rings)
    return Mesh(mesh.points @ turn.T, mesh.faces)


def circle(radius: float, count: int, start: float = 0.0, center: tuple[float, float] = (0.0, 0.0)) -> Profile:
    """Corners of a regular polygon, from an angle on [deg]."""
    angles = [math.radians(start + 360.0 * k / count) for k in range(count)]
    return [(center[0] + radius * math.cos(a), center[1] + radius * math.sin(a)) for a in angles]


def basket(size: Point, wall: float, floor: float, base: Point = (0.0, 0.0, 0.0)) -> dict[str, tuple[Point, Point]]:
    """The five boards (size, centre) of a box that is open at the top; `size` is outside [m]."""
    x, y, z = size
    tall, middle = z - floor, base[2] + floor + (z - floor) / 2
    boards = {"floor": ((x, y, floor), (base[0], base[1], base[2] + floor / 2))}
    for side, name in ((-1, "back"), (1, "front")):
        boards[name] = ((wall, y, tall), (base[0] + side * (x - wall) / 2, base[1], middle))
    for side, name in ((-1, "right"), (1, "left")):
        boards[name] = ((x - 2 * wall, wall, tall), (base[0], base[1] + side * (y - wall) / 2, middle))
    return boards


def wheel(radius: float, width: float, center: Point, axis: str = "Y") -> Collider:
    """A cylinder that collides, about an axis through its centre [m]."""
    turner, degrees = ALONG[axis]
    half = math.radians(degrees) / 2
    turn = [math.sin(half) if name == turner else 0.0 for name in "XYZ"]
    return Collider("Cylinder", (radius, width), center, (turn[0], turn[1], turn[2], math.cos(half)))


def inscribed(radius: float) -> float:
    """Edge of the square in a circle, a hair smaller [m]."""
    return math.floor(radius * math.sqrt(2.0) * 1e4) / 1e4


def around(mesh: Mesh, count: int, start: float = 0.0) -> list[Mesh]:
    """Copies of a mesh about Z, evenly spread."""
    return [mesh.turned("Z", start + 360.0 * k / count) for k in range(count)]


def slab(size: Point, center: Point, axis: str, degrees: float) -> Mesh:
    """A box turned about its centre."""
    return Mesh(box(size).points @ rotation(axis, degrees).T + center, box(size).faces)
