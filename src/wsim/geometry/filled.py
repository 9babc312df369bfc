"""Particles that stand for a solid: a lattice in a box, layers that follow a surface that is curved.

A lattice would cut a curved surface into steps, where a particle's depth is anything from nothing to a spacing. Such a
surface is rough: it drags along the water that should slip past it, and where it is depends on how the steps fall. The
outermost layer here lies half a spacing deep, as a fluid particle beside a wall stands half a spacing off it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

Array = np.ndarray
GOLDEN = math.pi * (3.0 - math.sqrt(5.0))  # [rad]; points that turn by it never line up


@dataclass(frozen=True)
class Samples:
    """Particles of a solid: positions [m] of shape (n, 3) and volumes [m^3] of shape (n,)."""

    position: Array
    volume: Array


def lattice_axis(length: float, spacing: float) -> tuple[int, float]:
    """Cells that divide a length [m] evenly at about `spacing` [m], and their exact edge [m]."""
    count = max(1, round(length / spacing))
    return count, length / count


def box_lattice(size: Array, spacing: float, plane: bool = False) -> Samples:
    """Cell centres of a box of edge lengths `size` [m] about the origin; the volumes add up to the box's.

    With `plane` there is one cell along y, a metre deep whatever the box is.
    """
    axes = [lattice_axis(float(length), spacing) for length in size]
    if plane:
        axes[1] = (1, 1.0)
    ticks = [(np.arange(count) + 0.5) * edge - 0.5 * count * edge for count, edge in axes]
    position = np.stack(np.meshgrid(*ticks, indexing="ij"), axis=-1).reshape(-1, 3)
    return Samples(position, np.full(len(position), np.prod([edge for _, edge in axes])))


def _layers(radius: float, spacing: float) -> Iterator[tuple[float, float, float]]:
    """Outer and inner radius of each layer, and where its particles stand [m]; the rest is one core."""
    count = max(1, round(radius / spacing))
    for k in range(count):
        outer = radius - k * spacing
        inner = outer - spacing if k < count - 1 else 0.0
        yield outer, inner, outer - min(0.5 * spacing, 0.5 * outer)


def capsule_layers(radius: float, half_height: float, spacing: float) -> Samples:
    """Layers of particles in a capsule along Z; the volumes add up to the capsule's.

    Every layer is a spiral of equal steps in height. By Archimedes' hat-box theorem these are equal areas on the caps
    and on the cylinder alike.

    Args:
        radius: Of caps and cylinder [m].
        half_height: Of the cylinder [m]; 0 is a sphere.
        spacing: Between particles [m].
    """

    def volume(r: float) -> float:
        return 2.0 * math.pi * r**2 * half_height + 4.0 / 3.0 * math.pi * r**3

    places, volumes = [], []
    for outer, inner, r in _layers(radius, spacing):
        share = volume(outer) - volume(inner)
        length = half_height + r
        count = max(1, round(share / spacing**3), round(2.0 * half_height / spacing))
        k = np.arange(count)
        z = length * (1.0 - (2.0 * k + 1.0) / count)
        ring = np.sqrt(np.maximum(r**2 - np.maximum(np.abs(z) - half_height, 0.0) ** 2, 0.0))
        spiral = np.stack([ring * np.cos(GOLDEN * k), ring * np.sin(GOLDEN * k), z], axis=1)
        places.append(spiral - spiral.mean(axis=0))  # or the lift would turn the body
        volumes.append(np.full(count, share / count))
    return Samples(np.concatenate(places), np.concatenate(volumes))


def sphere_layers(radius: float, spacing: float) -> Samples:
    """Layers of particles in a sphere of `radius` [m]; the volumes add up to the sphere's."""
    return capsule_layers(radius, 0.0, spacing)


def cylinder_layers(radius: float, half_height: float, spacing: float) -> Samples:
    """Discs of rings of particles in a cylinder along Z [m]; the volumes add up to the cylinder's."""
    discs, edge = lattice_axis(2.0 * half_height, spacing)
    places, volumes = [], []
    for disc in range(discs):
        z = (disc + 0.5) * edge - half_height
        for outer, inner, r in _layers(radius, spacing):
            area = math.pi * (outer**2 - inner**2)
            count = max(1, round(area / spacing**2))
            angle = 2.0 * math.pi * np.arange(count) / count + GOLDEN * disc
            ring = np.stack([r * np.cos(angle), r * np.sin(angle), np.full(count, z)], axis=1)
            places.append(ring if count > 1 else np.array([[0.0, 0.0, z]]))
            volumes.append(np.full(count, area * edge / count))
    return Samples(np.concatenate(places), np.concatenate(volumes))
