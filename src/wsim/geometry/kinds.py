"""The kinds of shape: what each is in its own frame, from its numbers. A new kind is one class here, and a line below.

A kind's fields are the numbers of `wsim.scene.world.Shape.size`, in their order [m].
"""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from wsim.geometry.surfaces import Surface, arc, box_surface, revolved

Floats = NDArray[np.float64]

MOST_PROBES = 200  # vertices of a mesh that are probed


class Kind:
    """A shape centred on its origin; a round one is turned about Z."""

    round: ClassVar[bool] = False
    """Whether it rolls."""

    @property
    def edges(self) -> tuple[float, ...]:
        """Edges of its bounding box [m]; none where it has no end."""
        raise NotImplementedError

    @property
    def volume(self) -> float:
        """Volume [m^3]."""
        raise NotImplementedError

    @property
    def radius_about(self) -> float:
        """Radius of a ball about its origin that holds it [m]."""
        raise NotImplementedError

    @property
    def thinnest(self) -> float:
        """Its smallest extent [m]."""
        return min(self.edges)

    def surface(self) -> Surface:
        """A closed mesh of it, of its volume."""
        raise NotImplementedError

    def ends(self, axes: Floats) -> tuple[Floats, Floats]:
        """Where it begins and ends along unit axes (..., 3), from its origin, (...) each [m]."""
        half = self.half_width(axes)
        return -half, half

    def half_width(self, axes: Floats) -> Floats:
        """Half its width along unit axes (..., 3), (...) [m]."""
        raise NotImplementedError

    def heights(self, up: Floats) -> tuple[Floats, Floats]:
        """Where it begins and ends along the world's Z, which is `up` (T, 3) in its frame, (T,) each [m].

        The same as `ends`. A kind that has a formula of its own here keeps verdicts as they are to the last digit.
        """
        return self.ends(up)

    def beyond(self, points: Floats) -> list[Floats]:
        """How far points (..., 3) are beyond each of its sides [m], sides at right angles; all negative inside."""
        raise NotImplementedError

    def depth(self, points: Floats) -> Floats:
        """How deep points (..., 3) are inside [m]; negative outside."""
        sides = self.beyond(points)
        if len(sides) == 1:
            return -sides[0]
        outside = np.sqrt(sum(np.square(np.maximum(side, 0.0)) for side in sides))
        depth: Floats = -(outside + np.minimum(functools.reduce(np.maximum, sides), 0.0))
        return depth

    def probes(self) -> tuple[Floats, float]:
        """Points (P, 3), and the radius of a ball, that meet what it meets when a ball stands on each point [m]."""
        raise NotImplementedError


@dataclass(frozen=True)
class Box(Kind):
    """Full edges."""

    x: float
    y: float
    z: float

    @property
    def edges(self) -> tuple[float, ...]:
        """Its own."""
        return (self.x, self.y, self.z)

    @property
    def volume(self) -> float:
        """Product of the edges [m^3]."""
        return math.prod(self.edges)

    @property
    def radius_about(self) -> float:
        """Half its diagonal [m]."""
        return math.hypot(*self.edges) / 2

    def surface(self) -> Surface:
        """Twelve triangles."""
        return box_surface(self.edges)

    def half_width(self, axes: Floats) -> Floats:
        """What its edges add along each axis."""
        x, y, z = np.abs(np.moveaxis(axes, -1, 0))
        return np.asarray((x * self.x + y * self.y + z * self.z) / 2)

    def heights(self, up: Floats) -> tuple[Floats, Floats]:
        """Its half diagonal along Z."""
        half = np.abs(up) @ (np.array(self.edges) / 2)
        return -half, half

    def beyond(self, points: Floats) -> list[Floats]:
        """Its three pairs of faces."""
        return [np.abs(points[..., k]) - edge / 2 for k, edge in enumerate(self.edges)]

    def probes(self) -> tuple[Floats, float]:
        """Corners, and the middles of edges and faces."""
        ticks = (-0.5, 0.0, 0.5)
        grid = np.array([[x, y, z] for x in ticks for y in ticks for z in ticks if (x, y, z) != (0.0, 0.0, 0.0)])
        return grid * np.array(self.edges), 0.0


@dataclass(frozen=True)
class Sphere(Kind):
    """A ball."""

    radius: float
    round = True

    @property
    def edges(self) -> tuple[float, ...]:
        """Its diameter, three times."""
        return (2 * self.radius,) * 3

    @property
    def volume(self) -> float:
        """4/3 pi r^3."""
        return 4 / 3 * math.pi * self.radius**3

    @property
    def radius_about(self) -> float:
        """Its own."""
        return self.radius

    def surface(self) -> Surface:
        """Facets of its volume."""
        return revolved(*arc(self.radius, 0.0), volume=self.volume)

    def half_width(self, axes: Floats) -> Floats:
        """The same along all axes."""
        return np.full(axes.shape[:-1], self.radius)

    def beyond(self, points: Floats) -> list[Floats]:
        """One side all round."""
        return [np.linalg.norm(points, axis=-1) - self.radius]

    def probes(self) -> tuple[Floats, float]:
        """The middle of the ball."""
        return np.zeros((1, 3)), self.radius


@dataclass(frozen=True)
class Cylinder(Kind):
    """Along Z."""

    radius: float
    height: float
    round = True

    @property
    def edges(self) -> tuple[float, ...]:
        """Two diameters and the height."""
        return (2 * self.radius, 2 * self.radius, self.height)

    @property
    def volume(self) -> float:
        """Base times height [m^3]."""
        return math.pi * self.radius**2 * self.height

    @property
    def radius_about(self) -> float:
        """To the rim [m]."""
        return math.hypot(self.radius, self.height / 2)

    def surface(self) -> Surface:
        """A prism of its volume and height."""
        profile = (np.array([0.0, self.radius, self.radius, 0.0]), np.array([-1.0, -1.0, 1.0, 1.0]) * self.height / 2)
        return revolved(*profile, volume=self.volume, radial=True)

    def half_width(self, axes: Floats) -> Floats:
        """Its disc's and its axis'."""
        x, y, z = np.abs(np.moveaxis(axes, -1, 0))
        return np.asarray(self.radius * np.hypot(x, y) + self.height / 2 * z)

    def heights(self, up: Floats) -> tuple[Floats, Floats]:
        """Its axis' and its disc's, the sine from the cosine."""
        z = up[:, 2]
        half = np.abs(z) * self.height / 2 + self.radius * np.sqrt(np.maximum(0.0, 1.0 - z**2))
        return -half, half

    def beyond(self, points: Floats) -> list[Floats]:
        """Its mantle and its ends."""
        radial = np.hypot(points[..., 0], points[..., 1]) - self.radius
        return [radial, np.abs(points[..., 2]) - self.height / 2]

    def probes(self) -> tuple[Floats, float]:
        """Three rings, and the middles of its ends."""
        angle = np.linspace(0.0, 2 * np.pi, 24, endpoint=False)
        ring = np.column_stack([np.cos(angle), np.sin(angle)]) * self.radius
        rings = [np.column_stack([ring, np.full(len(ring), z * self.height)]) for z in (-0.5, 0.0, 0.5)]
        return np.concatenate([*rings, [[0.0, 0.0, -0.5 * self.height], [0.0, 0.0, 0.5 * self.height]]]), 0.0


@dataclass(frozen=True)
class Capsule(Kind):
    """Along Z; the height is without the caps."""

    radius: float
    height: float
    round = True

    @property
    def edges(self) -> tuple[float, ...]:
        """Two diameters, and the height with both caps."""
        return (2 * self.radius, 2 * self.radius, self.height + 2 * self.radius)

    @property
    def volume(self) -> float:
        """A cylinder's and a ball's [m^3]."""
        return math.pi * self.radius**2 * (self.height + 4 / 3 * self.radius)

    @property
    def radius_about(self) -> float:
        """To the top of a cap [m]."""
        return self.radius + self.height / 2

    @property
    def thinnest(self) -> float:
        """Its diameter [m]."""
        return 2 * self.radius

    def surface(self) -> Surface:
        """Facets of its volume."""
        return revolved(*arc(self.radius, self.height), volume=self.volume)

    def half_width(self, axes: Floats) -> Floats:
        """Its caps' and its axis'."""
        return np.asarray(self.radius + self.height / 2 * np.abs(axes[..., 2]))

    def beyond(self, points: Floats) -> list[Floats]:
        """One side all round."""
        x, y, z = points[..., 0], points[..., 1], points[..., 2]
        along = np.maximum(np.abs(z) - self.height / 2, 0.0)
        return [np.sqrt(x * x + y * y + along * along) - self.radius]

    def probes(self) -> tuple[Floats, float]:
        """Balls along its axis."""
        z = np.linspace(-0.5, 0.5, 9) * self.height
        return np.column_stack([np.zeros((9, 2)), z]), self.radius


@dataclass(frozen=True)
class Plane(Kind):
    """Everything below z = 0."""

    @property
    def edges(self) -> tuple[float, ...]:
        """None: it has no end."""
        return ()

    @property
    def radius_about(self) -> float:
        """Infinite."""
        return math.inf

    @property
    def thinnest(self) -> float:
        """Infinite."""
        return math.inf

    def beyond(self, points: Floats) -> list[Floats]:
        """Its one face."""
        return [points[..., 2]]


@dataclass(frozen=True, eq=False)
class Mesh(Box):
    """A closed mesh: its bounding box's edges, vertices [m] and triangles. Its box where it has none."""

    points: Sequence[Sequence[float]]
    faces: Sequence[Sequence[int]]

    @functools.cached_property
    def vertices(self) -> Floats:
        """Its vertices (V, 3) [m]."""
        return np.array(self.points, dtype=np.float64)

    @property
    def volume(self) -> float:
        """What its surface encloses [m^3]."""
        return self.surface().volume

    @property
    def radius_about(self) -> float:
        """To the farthest vertex [m]."""
        return float(np.linalg.norm(self.vertices, axis=1).max()) if self.points else super().radius_about

    def surface(self) -> Surface:
        """The mesh itself."""
        return Surface(self.vertices, np.array(self.faces, dtype=np.intp)) if self.faces else super().surface()

    def ends(self, axes: Floats) -> tuple[Floats, Floats]:
        """Its outermost vertices."""
        if not self.points:
            return super().ends(axes)
        along = axes @ self.vertices.T
        return along.min(axis=-1), along.max(axis=-1)

    def heights(self, up: Floats) -> tuple[Floats, Floats]:
        """Its outermost vertices."""
        return self.ends(up) if self.points else super().heights(up)

    def depth(self, points: Floats) -> Floats:
        """Unknown, as if all were outside: NumPy has no tree to ask for the nearest triangle."""
        return np.full(points.shape[:-1], -np.inf)

    def probes(self) -> tuple[Floats, float]:
        """Some of its vertices."""
        if not self.points:
            return super().probes()
        return self.vertices[:: max(1, len(self.vertices) // MOST_PROBES)], 0.0


KINDS: dict[str, type[Kind]] = {
    "box": Box, "sphere": Sphere, "cylinder": Cylinder, "capsule": Capsule, "plane": Plane, "mesh": Mesh,
}  # fmt: skip
PRIMITIVES: dict[str, type[Kind]] = {name: KINDS[name] for name in ("box", "sphere", "cylinder", "capsule")}
ROUND = frozenset(name for name, kind in KINDS.items() if kind.round)
