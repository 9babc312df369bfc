"""Shapes of several copies of a world, of other sizes or places in each: one shape, of other numbers at each frame."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from wsim.geometry.kinds import Kind, varying

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from wsim.scene.world import Shape

    Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Stacked:
    """A primitive whose numbers are of each of F frames, as `wsim.geometry.shapes.Described` has them of one."""

    prim: str
    kind: str
    collides: bool
    size: tuple[Any, ...]  # (F, 1) each [m]
    position: Floats  # (F, 3) [m]
    rotation: Floats  # (F, 4)
    vertices: list[Any] = field(default_factory=list)
    triangles: list[Any] = field(default_factory=list)

    def kind_at(self, frames: NDArray[Any] | slice) -> Kind:
        """What it is in its own frame, at some frames."""
        return varying(self.kind, *(numbers[frames] for numbers in self.size))


def stacked(shapes: Sequence[Shape], frames: int) -> Shape:
    """The same shape of each copy, over so many frames each: it itself where all are of one size and place."""
    first = shapes[0]
    names = "size", "position", "rotation"
    if all(getattr(shape, name) == getattr(first, name) for shape in shapes for name in names):
        return first
    size, position, rotation = (
        np.repeat(np.array([getattr(shape, name) for shape in shapes], dtype=np.float64), frames, axis=0)
        for name in names
    )
    found = Stacked(first.prim, first.kind, first.collides, tuple(size.T[:, :, None]), position, rotation)
    return cast("Shape", found)  # as far as geometry asks
