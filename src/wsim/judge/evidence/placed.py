"""The colliding shapes of bodies and static objects, where they are at each frame."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import multiply, rotate
from wsim.geometry.shapes import kind_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.geometry.kinds import Kind
    from wsim.scene.world import Shape, World

    Floats = NDArray[np.float64]


@dataclass
class Placed:
    """A colliding shape through time."""

    owner: str  # prim of its body or static
    body: int  # row of its body, or -1
    shape: Shape
    position: Floats  # (T, 3)
    rotation: Floats  # (T, 4)

    @cached_property
    def kind(self) -> Kind:
        """The shape in its own frame."""
        return kind_of(self.shape)

    @property
    def radius(self) -> float:
        """Of a ball about it [m]."""
        return self.kind.radius_about

    def during(self, frames: slice) -> Placed:
        """The same over some frames."""
        found = Placed(self.owner, self.body, self.shape, self.position[frames], self.rotation[frames])
        found.__dict__["kind"] = self.kind
        return found


def placed_shapes(world: World, body_q: Floats) -> list[Placed]:
    """All colliding shapes, those of bodies first."""
    placed = []
    frames = len(body_q)
    for i, body in enumerate(world.bodies):
        q = body_q[:, i, 3:]
        for shape in body.shapes:
            if shape.collides:
                position, turned = body_q[:, i, :3], q
                if any(shape.position):
                    position = position + rotate(q, np.array(shape.position, dtype=np.float64))
                if any(shape.rotation[:3]):
                    turned = multiply(q, np.broadcast_to(np.array(shape.rotation, dtype=np.float64), q.shape))
                placed.append(Placed(body.prim, i, shape, position, turned))
    for static in world.statics:
        for shape in static.shapes:
            if shape.collides:
                fixed = np.broadcast_to(np.array(shape.position, dtype=np.float64), (frames, 3))
                turned = np.broadcast_to(np.array(shape.rotation, dtype=np.float64), (frames, 4))
                placed.append(Placed(static.prim, -1, shape, fixed, turned))
    return placed
