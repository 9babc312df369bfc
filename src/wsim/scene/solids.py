"""What shapes are at density 1: volume, centre and inertia."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import matrices

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from wsim.scene.world import Shape

    Array = NDArray[np.float64]


@dataclass(frozen=True)
class Solid:
    """What a shape is at density 1: volume [m^3], its centre [m] and inertia [m^5], in the shape's own frame."""

    volume: float
    com: Array  # (3,)
    inertia: Array  # (3, 3), about com


def solid(shape: Shape) -> Solid:
    """Volume, centre and inertia of a shape at density 1, in its own frame; zero for a plane."""
    size = shape.size
    if shape.kind == "box":
        x, y, z = size
        return _centred(x * y * z, np.array([y * y + z * z, x * x + z * z, x * x + y * y]) / 12.0)
    if shape.kind == "sphere":
        (r,) = size
        return _centred(4.0 / 3.0 * math.pi * r**3, np.full(3, 0.4 * r * r))
    if shape.kind == "cylinder":
        r, h = size
        side = r * r / 4.0 + h * h / 12.0
        return _centred(math.pi * r * r * h, np.array([side, side, r * r / 2.0]))
    if shape.kind == "capsule":
        return _capsule(*size)
    if shape.kind == "mesh":
        return _polyhedron(np.array(shape.vertices), np.array(shape.triangles, dtype=np.int64))
    return _centred(0.0, np.zeros(3))


def _centred(volume: float, per_mass: Array) -> Solid:
    return Solid(volume, np.zeros(3), np.diag(volume * per_mass))


def _capsule(r: float, h: float) -> Solid:
    tube, ball = math.pi * r * r * h, 4.0 / 3.0 * math.pi * r**3
    axial = tube * r * r / 2.0 + ball * 0.4 * r * r
    # Each half ball about its own base, moved out by h/2: its centre lies 3r/8 beyond the base.
    lateral = tube * (r * r / 4.0 + h * h / 12.0) + ball * (0.4 * r * r + h * h / 4.0 + 3.0 / 8.0 * h * r)
    return Solid(tube + ball, np.zeros(3), np.diag([lateral, lateral, axial]))


def _polyhedron(vertices: Array, triangles: NDArray[np.int64]) -> Solid:
    """Integrals over the tetrahedra from the origin to each triangle (Mirtich 1996; Tonon 2004)."""
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    volumes = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0
    total = float(volumes.sum())
    if abs(total) < 1e-18:
        return _centred(0.0, np.zeros(3))
    corners = a + b + c
    com = (volumes[:, None] * corners).sum(axis=0) / (4.0 * total)
    square = (
        sum(np.einsum("i,ij,ik->jk", volumes, p, q) for p, q in ((a, a), (b, b), (c, c), (corners, corners))) / 20.0
    )
    about_origin = np.trace(square) * np.eye(3) - square
    about_com = about_origin - total * (com @ com * np.eye(3) - np.outer(com, com))
    sign = math.copysign(1.0, total)
    return Solid(abs(total), com, sign * about_com)


def together(shapes: Iterable[Shape]) -> Solid:
    """Several as one, in the frame that they are placed in; where they overlap, both count."""
    found = [(shape, solid(shape), matrices(np.array(shape.rotation))) for shape in shapes]
    weights = np.array([each.volume for _, each, _ in found])
    if weights.sum() <= 0.0:
        return _centred(0.0, np.zeros(3))
    places = [np.array(shape.position) + turn @ each.com for shape, each, turn in found]
    return Solid(
        float(weights.sum()), *about_all(weights, places, [turn @ each.inertia @ turn.T for _, each, turn in found])
    )


def about_all(weights: Array, places: Sequence[Array], inertias: Sequence[Array]) -> tuple[Array, Array]:
    """Centre, (3,), of parts with these centres, and the inertia about it, (3, 3), by the theorem of parallel axes."""
    com = weights @ np.array(places) / weights.sum()
    inertia = np.zeros((3, 3))
    for weight, place, own in zip(weights, places, inertias, strict=True):
        arm = place - com
        inertia += own + weight * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return com, inertia
