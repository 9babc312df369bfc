"""Meshes that are seen and weighed, and the plain shapes that collide in their place.

Lengths in metres, angles in degrees, Z up. A mesh is closed and its faces turn counterclockwise seen from outside, so
that its volume is what its density is of.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Point = tuple[float, float, float]
Profile = Sequence[tuple[float, float]]
Faces = list[tuple[int, ...]]

SIDES = 32  # of what is round, as it is seen


@dataclass(frozen=True)
class Mesh:
    """Points (n, 3) [m] and the corners of each face."""

    points: Array
    faces: Faces

    def __add__(self, other: Mesh) -> Mesh:
        first = len(self.points)
        faces = self.faces + [tuple(first + corner for corner in face) for face in other.faces]
        return Mesh(np.concatenate([self.points, other.points]), faces)

    def moved(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Mesh:
        """The mesh, shifted [m]."""
        return Mesh(self.points + np.array((x, y, z)), self.faces)

    def turned(self, axis: str, degrees: float) -> Mesh:
        """The mesh, turned about an axis through the origin."""
        return Mesh(self.points @ rotation(axis, degrees).T, self.faces)

    def volume(self) -> float:
        """What a closed mesh fills [m^3]; parts that overlap count twice."""
        a, b, c = self.points[self.triangles()].transpose(1, 0, 2)
        return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)

    def triangles(self) -> NDArray[np.int64]:
        """Each face as a fan, (n, 3)."""
        fans = [(face[0], face[k], face[k + 1]) for face in self.faces for k in range(1, len(face) - 1)]
        return np.array(fans, dtype=np.int64)


def rotation(axis: str, degrees: float) -> Array:
    """The matrix that turns column vectors about X, Y or Z."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    i, j = {"X": (1, 2), "Y": (2, 0), "Z": (0, 1)}[axis]
    matrix = np.eye(3)
    matrix[i, i] = matrix[j, j] = c
    matrix[i, j], matrix[j, i] = -s, s
    return matrix


def join(meshes: Iterable[Mesh]) -> Mesh:
    """Several meshes as one."""
    first, *rest = meshes
    for mesh in rest:
        first += mesh
    return first


def box(size: Point, center: Point = (0.0, 0.0, 0.0)) -> Mesh:
    """A box of edges `size` [m]."""
    return taper(size[:2], size[:2], size[2], (center[0], center[1], center[2] - size[2] / 2))


def taper(bottom: tuple[float, float], top: tuple[float, float], height: float, base: Point = (0.0, 0.0, 0.0)) -> Mesh:
    """A box whose edges in x and y change from `bottom` to `top` [m]; `base` is the centre of its bottom face."""
    corners = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    points = [(x * size[0] / 2, y * size[1] / 2, z) for size, z in ((bottom, 0.0), (top, height)) for x, y in corners]
    return Mesh(np.array(points) + base, _sides(range(4), range(4, 8), [3, 2, 1, 0], [4, 5, 6, 7]))


def extrude(outline: Profile, width: float) -> Mesh:
    """A prism along Y, centred; its outline (x, z) turns counterclockwise seen from -Y."""
    count = len(outline)
    points = [(x, y, z) for y in (-width / 2, width / 2) for x, z in outline]
    near, far = range(count), range(count, 2 * count)
    return Mesh(np.array(points), _sides(near, far, list(near), list(reversed(far)), outward=False))


def lathe(profile: Profile, sides: int = SIDES) -> Mesh:
    """A solid of revolution about Z.

    Args:
        profile: (radius, z) [m] from the axis at the bottom, out, up and back to the axis; of a vessel up the outside
            and down the inside. One that touches the axis nowhere is a ring, and closes by itself.
        sides: Of the circle.
    """
    closed = all(r > 0.0 for r, _ in profile)
    angle = np.arange(sides) * (2.0 * math.pi / sides)
    points: list[Point] = []
    rows: list[list[int]] = []
    for r, z in profile:
        first = len(points)
        if r > 0.0:
            points += [(r * math.cos(a), r * math.sin(a), z) for a in angle]
            rows.append(list(range(first, first + sides)))
        else:
            points.append((0.0, 0.0, z))
            rows.append([first] * sides)
    faces: Faces = []
    pairs = zip(rows, [*rows[1:], rows[0]], strict=True) if closed else itertools.pairwise(rows)
    for low, high in pairs:
        for j in range(sides):
            k = (j + 1) % sides
            corners = dict.fromkeys((low[j], low[k], high[k], high[j]))
            faces.append(tuple(corners))
    return Mesh(np.array(points), faces)


def tube(path: Sequence[Point], radius: float, sides: int = 10) -> Mesh:
    """A round bar along a path of points [m], square at its ends."""
    line = np.array(path, dtype=np.float64)
    along = np.gradient(line, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    side = np.cross(along[0], (0.0, 0.0, 1.0) if abs(along[0, 2]) < 0.9 else (1.0, 0.0, 0.0))
    points: list[Array] = []
    angle = np.arange(sides) * (2.0 * math.pi / sides)
    for center, forward in zip(line, along, strict=True):
        side = side - forward * (side @ forward)  # carried along without a twist
        side /= np.linalg.norm(side)
        up = np.cross(forward, side)
        points += [center + radius * (math.cos(a) * side + math.sin(a) * up) for a in angle]
    faces: Faces = []
    for first in range(0, len(points) - sides, sides):
        near = range(first, first + sides)
        faces += [(near[j], near[j - sides + 1], near[j - sides + 1] + sides, near[j] + sides) for j in range(sides)]
    last = len(points) - sides
    faces += [tuple(reversed(range(sides))), tuple(range(last, last + sides))]
    return Mesh(np.array(points), faces)


def prism(rings: Sequence[Sequence[Point]]) -> Mesh:
    """A solid through rings of equally many corners, each turning counterclockwise seen from the last ring's side."""
    count = len(rings[0])
    points = np.array([corner for ring in rings for corner in ring])
    faces: Faces = []
    for first in range(0, count * (len(rings) - 1), count):
        faces += [
            (first + k, first + (k + 1) % count, first + count + (k + 1) % count, first + count + k)
            for k in range(count)
        ]
    last = count * (len(rings) - 1)
    return Mesh(points, [*faces, tuple(reversed(range(count))), tuple(range(last, last + count))])


def arc(center: Point, radius: float, start: float, end: float, count: int, plane: str = "YZ") -> list[Point]:
    """Points on a circle in a plane, from an angle to another [deg], counted from the plane's first axis."""
    i, j = ("XYZ".index(axis) for axis in plane)
    points = []
    for k in range(count):
        angle = math.radians(start + (end - start) * k / (count - 1))
        point = list(center)
        point[i] += radius * math.cos(angle)
        point[j] += radius * math.sin(angle)
        points.append((point[0], point[1], point[2]))
    return points


def _sides(
    low: Sequence[int], high: Sequence[int], bottom: list[int], top: list[int], *, outward: bool = True
) -> Faces:
    """The faces of a prism between two rings of corners."""
    count = len(low)
    quads = [(low[k], low[(k + 1) % count], high[(k + 1) % count], high[k]) for k in range(count)]
    return [*(quad if outward else quad[::-1] for quad in quads), tuple(bottom), tuple(top)]


@dataclass(frozen=True)
class Collider:
    """A shape that collides: no renderer shows it.

    `size` [m]: a Cube's edges, a Cylinder's and a Capsule's radius and height along Z (a capsule's without its caps), a
    Sphere's radius. A Mesh collides as its convex hull. `turn` is a quaternion (x, y, z, w).
    """

    kind: Literal["Cube", "Cylinder", "Capsule", "Sphere", "Mesh"]
    size: tuple[float, ...] = ()
    center: Point = (0.0, 0.0, 0.0)
    turn: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0)
    mesh: Mesh | None = None

    def moved(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Collider:
        """The shape, shifted [m]."""
        if self.mesh is not None:
            return replace(self, mesh=self.mesh.moved(x, y, z))
        return replace(self, center=(self.center[0] + x, self.center[1] + y, self.center[2] + z))


def block(size: Point, center: Point = (0.0, 0.0, 0.0), axis: str = "Z", degrees: float = 0.0) -> Collider:
    """A box that collides, turned about its centre."""
    half = math.radians(degrees) / 2
    turn = [math.sin(half) if name == axis else 0.0 for name in "XYZ"]
    return Collider("Cube", size, center, (turn[0], turn[1], turn[2], math.cos(half)))


def drum(radius: float, low: float, high: float, x: float = 0.0, y: float = 0.0) -> Collider:
    """An upright cylinder from height `low` to `high` [m]."""
    return Collider("Cylinder", (radius, high - low), (x, y, (low + high) / 2))


def ball(radius: float, center: Point) -> Collider:
    """A sphere [m]."""
    return Collider("Sphere", (radius,), center)


def rod(start: Point, end: Point, radius: float) -> Collider:
    """A capsule whose round ends touch two points [m]."""
    a, b = np.array(start), np.array(end)
    length = float(np.linalg.norm(b - a))
    x, y, z = (b - a) / length
    # The quaternion that turns +Z to the rod; straight down is a half turn about X.
    turn = np.array([-y, x, 0.0, 1.0 + z]) if z > -1.0 + 1e-9 else np.array([1.0, 0.0, 0.0, 0.0])
    turn = turn / np.linalg.norm(turn)
    middle = (a + b) / 2
    return Collider(
        "Capsule",
        (radius, max(length - 2.0 * radius, 1e-3)),
        (float(middle[0]), float(middle[1]), float(middle[2])),
        (float(turn[0]), float(turn[1]), float(turn[2]), float(turn[3])),
    )


def hull(mesh: Mesh) -> Collider:
    """The convex hull of a mesh."""
    return Collider("Mesh", mesh=mesh)


def ring(inner: float, wall: float, low: float, high: float, count: int) -> list[Collider]:
    """Upright boxes around a circle of radius `inner` [m], which they leave free; they meet and do not overlap."""
    width = 2.0 * inner * math.tan(math.pi / count)
    at, tall, middle = inner + wall / 2, high - low, (low + high) / 2
    turns = [2.0 * math.pi * k / count for k in range(count)]
    return [
        block((wall, width, tall), (at * math.cos(a), at * math.sin(a), middle), "Z", math.degrees(a)) for a in turns
    ]


def staves(inner: tuple[float, float], wall: float, low: float, high: float, count: int) -> list[Collider]:
    """Convex pieces around a cone that they leave free, of radius `inner` [m] at `low` and at `high`."""
    found = []
    grow = 1.0 / math.cos(math.pi / count)  # an edge stands farther out than the middle of a face
    for k in range(count):
        edges = [(k + side) * 2.0 * math.pi / count for side in (-0.5, 0.5)]
        points = [
            (radius * grow * math.cos(a), radius * grow * math.sin(a), z)
            for r, z in zip(inner, (low, high), strict=True)
            for radius, a in ((r, edges[0]), (r + wall, edges[0]), (r + wall, edges[1]), (r, edges[1]))
        ]
        found.append(hull(Mesh(np.array(points), _sides(range(4), range(4, 8), [3, 2, 1, 0], [4, 5, 6, 7]))))
    return found
