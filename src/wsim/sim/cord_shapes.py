"""What pictures show of springs and ropes: coils, dampers and tubes of short capsules that follow their ends."""

from __future__ import annotations

from typing import Any

import newton
import numpy as np

from wsim.scene.cord_lines import cord_lines, spring_turns
from wsim.scene.world import Rope, Spring, World

Array = np.ndarray
ROPE_PIECES = 64
COIL_PIECES = 12  # a turn
MARK = "drawn_"


def add_cord_shapes(builder: Any, world: World) -> None:
    """Give a builder the capsules that draw a world's springs and ropes; nothing collides with them or weighs them."""
    config = newton.ModelBuilder.ShapeConfig(density=0.0, has_shape_collision=False, has_particle_collision=False)
    for cord in world.cords:
        for k in range(_pieces(cord)):
            builder.add_shape_capsule(
                -1, radius=cord.radius, half_height=0.01, cfg=config, label=f"{cord.prim}/{MARK}{k}"
            )


def _pieces(cord: Spring | Rope) -> int:
    if isinstance(cord, Rope):
        return ROPE_PIECES
    return COIL_PIECES * spring_turns(cord) + 2 if cord.stiffness > 0.0 else 2


class CordShapes:
    """Moves the capsules of a model to where the springs and ropes of a state are.

    Args:
        model: With the shapes of `add_cord_shapes`, or without: then there is nothing to do.
        world: What the stage states.
    """

    def __init__(self, model: Any, world: World) -> None:
        self.model = model
        labels = {str(label): k for k, label in enumerate(model.shape_label)}
        cords = [cord for cord in world.cords if f"{cord.prim}/{MARK}0" in labels]
        self.cords = {cord.prim: (cord, labels[f"{cord.prim}/{MARK}0"]) for cord in cords}
        self._bodies = {str(label): k for k, label in reversed(list(enumerate(model.body_label)))}

    def update(self, state: Any) -> None:
        """Move the capsules; the model's shapes are to be refitted after."""
        if not self.cords:
            return
        body_q = state.body_q.numpy()
        places, sizes = self.model.shape_transform.numpy(), self.model.shape_scale.numpy()
        for cord, first in self.cords.values():
            held = {guide.body for guide in cord.path if guide.body is not None}
            poses = {prim: body_q[self._bodies[prim]][None] for prim in held}
            ends, radii = _drawn(cord, poses)
            part = slice(first, first + len(ends))
            places[part], sizes[part] = _capsules(ends, radii)
        self.model.shape_transform.assign(places)
        self.model.shape_scale.assign(sizes)


def _drawn(cord: Spring | Rope, poses: dict[str, Array]) -> tuple[Array, Array]:
    """Ends of the capsules that draw a cord, (P, 2, 3) [m], and their radii, (P,) [m]."""
    ends, radii = [], []
    for line in cord_lines(cord, poses, COIL_PIECES, ROPE_PIECES):
        points = _divided(line.points) if isinstance(cord, Rope) else line.points
        ends.append(np.stack([points[:-1], points[1:]], axis=1))
        radii.append(np.full(len(points) - 1, line.radius))
    return np.concatenate(ends), np.concatenate(radii)


def _divided(points: Array) -> Array:
    """A rope's way in a fixed number of pieces."""
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    way = np.concatenate([[0.0], np.cumsum(steps)])
    if len(way) > ROPE_PIECES + 1:
        kept = np.linspace(0.0, way[-1], ROPE_PIECES + 1)
    else:  # its corners stay where they are
        kept = np.concatenate([way, np.linspace(0.0, way[-1], ROPE_PIECES + 3 - len(way))[1:-1]])
    kept.sort()
    return np.stack([np.interp(kept, way, points[:, axis]) for axis in range(3)], axis=1)


def _capsules(ends: Array, radii: Array) -> tuple[Array, Array]:
    """Newton's transforms (P, 7) and scales (P, 3) of capsules between pairs of points."""
    apart = ends[:, 1] - ends[:, 0]
    length = np.linalg.norm(apart, axis=1)
    along = apart / np.maximum(length, 1e-12)[:, None]
    # The shortest turn from Z to the capsule's direction; of one straight down, half a turn about X.
    turn = np.column_stack((-along[:, 1], along[:, 0], np.zeros(len(along)), 1.0 + along[:, 2]))
    turn[turn[:, 3] < 1e-9] = (1.0, 0.0, 0.0, 0.0)
    turn /= np.linalg.norm(turn, axis=1, keepdims=True)
    places = np.column_stack((ends.mean(axis=1), turn))
    return places, np.column_stack((radii, 0.5 * length, np.zeros(len(ends))))
