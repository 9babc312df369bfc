"""Shapes where they stand in their bodies: surface, reach, and the solid that a body's shapes make."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property, lru_cache
from typing import Generic, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from wsim.geometry.kinds import KINDS, Kind, mesh, varying
from wsim.geometry.rotations import UP, conjugate, multiply, rotate
from wsim.geometry.surfaces import Surface

Floats = NDArray[np.float64]


class Described(Protocol):
    """What is read of a `wsim.scene.world.Shape`."""

    prim: str
    size: tuple[float, ...]
    position: tuple[float, float, float]
    rotation: tuple[float, float, float, float]
    collides: bool
    vertices: list[tuple[float, float, float]]
    triangles: list[tuple[int, int, int]]

    @property
    def kind(self) -> str:
        """One of `KINDS`."""


S = TypeVar("S", bound=Described)


@lru_cache(maxsize=4096)
def _kind(kind: str, size: tuple[float, ...]) -> Kind:
    return KINDS[kind](*size)


def kind_of(shape: Described) -> Kind:
    """The shape in its own frame."""
    if shape.kind == "mesh":
        return mesh(shape.size, shape.vertices, shape.triangles)
    if any(isinstance(number, np.ndarray) for number in shape.size):
        return varying(shape.kind, *np.asarray(shape.size))
    return _kind(shape.kind, tuple(shape.size))


def surface_of(shape: Described) -> Surface:
    """A shape as a mesh in its body's frame; round ones keep their volume.

    Raises:
        ValueError: a plane has no volume.
    """
    if shape.kind == "plane":
        raise ValueError(f"{shape.prim}: a {shape.kind} has no volume")
    place = np.array(shape.rotation, dtype=np.float64), np.array(shape.position, dtype=np.float64)
    return kind_of(shape).surface().turned(*place)


def into(shape: Described, points: Floats) -> Floats:
    """Points (N, 3) of its body's frame in the shape's own [m]."""
    return rotate(conjugate(np.array(shape.rotation)), points - np.array(shape.position))


def reach(shape: Described, q: Floats, up: Floats = UP) -> tuple[Floats, Floats]:
    """How far a shape reaches below and above its body's origin [m].

    Args:
        shape: In its body's frame.
        q: The body's rotations (T, 4).
        up: The unit vector (3,) along which it is measured, in the world.

    Returns:
        Lowest and highest relative to the origin, (T,) each.
    """
    centre = rotate(q, np.array(shape.position, dtype=np.float64)) @ up
    full = multiply(q, np.broadcast_to(np.array(shape.rotation, dtype=np.float64), q.shape))
    low, high = kind_of(shape).heights(rotate(conjugate(full), np.broadcast_to(up, (len(q), 3))))
    return centre + low, centre + high


def top_under(shape: Described, points: Floats, up: Floats = UP) -> Floats:
    """The height of a shape's highest point on the lines along up through points, (N,) [m]; -inf where none is met.

    Shape, points (N, 3) and the unit vector up (3,) are in one frame: the world's, of a static shape.
    """
    own = rotate(conjugate(np.array(shape.rotation, dtype=np.float64)), up)
    return points @ up + kind_of(shape).leaves(into(shape, points), own)


class Solid(Generic[S]):
    """A body's colliding shapes: what displaces fluid and touches others."""

    def __init__(self, shapes: Sequence[S]) -> None:
        self.shapes = [s for s in shapes if s.collides and s.kind != "plane"] or list(shapes)

    @cached_property
    def surfaces(self) -> list[Surface]:
        """Its shapes as meshes in the body's frame."""
        return [surface_of(shape) for shape in self.shapes]

    @cached_property
    def volume(self) -> float:
        """[m^3]."""
        return sum(surface.volume for surface in self.surfaces)

    def reach(self, q: Floats, up: Floats = UP) -> tuple[Floats, Floats]:
        """Lowest and highest along a unit vector (3,) relative to the body's origin, (T,) each [m]."""
        ends = [reach(shape, q, up) for shape in self.shapes]
        return np.min([low for low, _ in ends], axis=0), np.max([high for _, high in ends], axis=0)

    def volume_below(self, q: Floats, z: float, height: float) -> float:
        """Volume under a level plane [m^3], the body's origin at height z, turned by q (4,)."""
        return sum(surface.turned(q).volume_below(height - z) for surface in self.surfaces)

    def draft(self, q: Floats, displaced: float) -> float:
        """Depth of the lowest point below the surface when `displaced` [m^3] is under it, at rotation q (4,) [m].

        Archimedes: a body of mass m floats where it displaces m / fluid density. Found by bisection.

        Raises:
            ValueError: the body has less volume than that.
        """
        if displaced > self.volume:
            raise ValueError(f"a body of {self.volume:g} m^3 cannot displace {displaced:g} m^3")
        lows, highs = self.reach(q[None])
        low, high = float(lows[0]), float(highs[0])
        bottom = low
        meshes = [surface.turned(q) for surface in self.surfaces]
        for _ in range(40):
            middle = (low + high) / 2
            if sum(mesh.volume_below(middle) for mesh in meshes) < displaced:
                low = middle
            else:
                high = middle
        return (low + high) / 2 - bottom

    @cached_property
    def smallest(self) -> float:
        """The smallest extent of its largest shape [m]."""
        return max(kind_of(shape).thinnest for shape in self.shapes)
