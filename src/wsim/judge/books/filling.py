"""How the particles of a fluid's solver fill a body: it follows from the body's shapes."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.filled import Samples, box_lattice, capsule_layers, cylinder_layers, sphere_layers
from wsim.geometry.rotations import rotate

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.scene.world import Body, Shape

    Floats = NDArray[np.float64]

TIE = 1e-6  # share of a length: one that is half a spacing more than so many may round either way


def filled(body: Body, spacing: float, count: int) -> Samples | None:
    """As many particles as the simulator says that it filled a body with, in its frame; None where shapes tell others.

    Args:
        body: Of round shapes and boxes; a mesh's particles are spread by a search, which is not repeated here.
        spacing: Between the fluid's particles [m].
        count: How many there are.
    """
    choices = [_fillings(shape, spacing) for shape in body.shapes if shape.collides]
    for choice in itertools.islice(itertools.product(*choices), 64):
        if choice and sum(len(each.volume) for each in choice) == count:
            return Samples(
                *(np.concatenate(parts) for parts in zip(*((c.position, c.volume) for c in choice), strict=True))
            )
    return None


def _fillings(shape: Shape, spacing: float) -> list[Samples]:
    """Of one shape; several where a length may be rounded up or down to spacings."""
    found: dict[tuple[int, ...], Samples] = {}
    for by in itertools.product((1.0, 1.0 + TIE, 1.0 - TIE), repeat=len(shape.size)):
        size = np.array(shape.size) * by
        cells = tuple(round(2.0 * length / spacing) for length in size), *(round(length / spacing) for length in size)
        if cells not in found and (samples := _filling(shape.kind, size, spacing)) is not None:
            place = rotate(np.array(shape.rotation), samples.position) + np.array(shape.position)
            found[cells] = Samples(place, samples.volume)
    return list(found.values())


def _filling(kind: str, size: Floats, spacing: float) -> Samples | None:
    if kind == "box":
        return box_lattice(size, spacing)
    if kind == "sphere":
        return sphere_layers(float(size[0]), spacing)
    if kind == "cylinder":
        return cylinder_layers(float(size[0]), 0.5 * float(size[1]), spacing)
    return capsule_layers(float(size[0]), 0.5 * float(size[1]), spacing) if kind == "capsule" else None
