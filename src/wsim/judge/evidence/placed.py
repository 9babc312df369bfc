"""The colliding shapes of bodies and static objects, where they are at each frame."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from wsim.geometry.rotations import multiply, rotate
from wsim.geometry.shapes import kind_of
from wsim.judge.evidence.stacked import Stacked, stacked

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from wsim.geometry.kinds import Kind
    from wsim.scene.world import Body, Shape, Static, World

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
        return self.shape.kind_at(slice(None)) if isinstance(self.shape, Stacked) else kind_of(self.shape)

    def at(self, frames: NDArray[Any] | slice) -> Kind:
        """The same at some frames, if it is of another size at each."""
        if isinstance(self.shape, Stacked):
            return self.shape.kind_at(frames)
        return self.kind

    @property
    def radius(self) -> float:
        """Of a ball about it [m]."""
        return self.kind.radius_about

    @cached_property
    def radii(self) -> Floats:
        """The same at each frame, (T,) [m]."""
        found = np.asarray(self.radius)
        return np.broadcast_to(found[:, 0] if found.ndim else found, len(self.position))

    @cached_property
    def room(self) -> tuple[Floats, Floats]:
        """The corners of the box about all the places that it is ever in, (3,) each [m]."""
        radii = self.radii[:, None]
        return (self.position - radii).min(axis=0), (self.position + radii).max(axis=0)


def placed_shapes(world: World, body_q: Floats) -> list[Placed]:
    """All colliding shapes, those of bodies first."""
    return [_placed(*each, body_q) for each in _colliding(world)]


def placed_together(worlds: Sequence[World], body_q: Floats) -> list[Placed]:
    """Those of several copies (`wsim.judge.evidence.alike.same_form`), whose frames stand one after another."""
    shapes = [[shape for _, _, shape in _colliding(world)] for world in worlds]
    count = len(body_q) // len(worlds)
    rows = _colliding(worlds[0])
    return [
        _placed(owner, row, stacked(each, count), body_q)
        for (owner, row, _), each in zip(rows, zip(*shapes, strict=True), strict=True)
    ]


def as_parts(placed: Sequence[Placed], world: World, frames: slice) -> list[Placed]:
    """Of all copies' shapes those of one of them, over its frames."""
    found = []
    for each, (_, _, shape) in zip(placed, _colliding(world), strict=True):
        found.append(Placed(each.owner, each.body, shape, each.position[frames], each.rotation[frames]))
        if not isinstance(each.shape, Stacked):
            found[-1].__dict__["kind"] = each.kind
    return found


def _colliding(world: World) -> list[tuple[str, int, Shape]]:
    """Of each colliding shape its owner, the row of that, and itself."""
    items: list[tuple[int, Body | Static]] = [*enumerate(world.bodies), *((-1, each) for each in world.statics)]
    return [(item.prim, row, shape) for row, item in items for shape in item.shapes if shape.collides]


def _placed(owner: str, row: int, shape: Shape, body_q: Floats) -> Placed:
    own, turn = (np.asarray(each, dtype=np.float64) for each in (shape.position, shape.rotation))
    if row < 0:
        return Placed(
            owner, row, shape, np.broadcast_to(own, (len(body_q), 3)), np.broadcast_to(turn, (len(body_q), 4))
        )
    position, turned = body_q[:, row, :3], body_q[:, row, 3:]
    if own.any():
        position = position + rotate(turned, own)
    if turn[..., :3].any():
        turned = multiply(turned, np.broadcast_to(turn, turned.shape))
    return Placed(owner, row, shape, position, turned)
