"""The flat faces of what never moves, which bodies stand on and slide down."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import rotate

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from wsim.scene.world import Shape

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]


@dataclass(eq=False)
class Face:
    """A side of a static box, or a plane.

    Args:
        shape: Whose it is.
        normal: Outwards (3,), unit, in the world.
        centre: A point of it (3,) [m]; of a box its middle.
        spans: Unit vectors in it, (2, 3).
        halves: How far it goes along those, (2,) [m]; inf of a plane.
    """

    shape: Shape
    normal: Floats
    centre: Floats
    spans: Floats
    halves: Floats

    def height(self, points: Floats) -> Floats:
        """Of points (..., 3) over it, along its normal [m]."""
        return np.asarray((points - self.centre) @ self.normal)

    def over(self, points: Floats) -> Bools:
        """Whether points (..., 3) are in front of it: over it, and not beyond an edge."""
        beside = np.abs((points - self.centre) @ self.spans.T)
        return np.asarray(np.all(beside < self.halves, axis=-1) & (self.height(points) > 0.0))

    def seen(self, way: Floats) -> float:
        """How large it looks along a unit vector (3,) that comes out of it [m^2]; not positive from behind."""
        return float(4.0 * np.prod(self.halves) * (self.normal @ way))


def faces(shape: Shape) -> list[Face]:
    """All of a static shape's flat faces; none of what is round or a mesh."""
    axes = rotate(np.array(shape.rotation, dtype=np.float64), np.eye(3))
    place = np.array(shape.position, dtype=np.float64)
    if shape.kind == "plane":
        return [Face(shape, axes[2], place, axes[:2], np.full(2, np.inf))]
    if shape.kind != "box":
        return []
    halves = np.array(shape.size) / 2
    return [
        Face(shape, side * axes[k], place + side * halves[k] * axes[k], np.delete(axes, k, 0), np.delete(halves, k))
        for k in range(3)
        for side in (1.0, -1.0)
    ]


def normal_under(shapes: Iterable[Shape], points: Floats, up: Floats) -> Floats:
    """The normal (3,) of the face that most of some points (N, 3) are over, of those that face upwards.

    Where none of them is over any, it is of the face that looks largest from above, and where nothing is flat the first
    shape's own Z.
    """
    chosen = list(shapes)
    facing = [face for shape in chosen for face in faces(shape) if face.normal @ up > 1e-6]
    if not facing:
        return rotate(np.array(chosen[0].rotation, dtype=np.float64), np.array([0.0, 0.0, 1.0]))
    under = [int(np.count_nonzero(face.over(points))) for face in facing]
    if any(under):
        return facing[int(np.argmax(under))].normal
    return max(facing, key=lambda face: face.seen(up)).normal
