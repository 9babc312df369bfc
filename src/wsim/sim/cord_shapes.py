"""What pictures show of springs and ropes: coils, dampers and tubes of short capsules that follow their ends."""

from __future__ import annotations

from typing import Any

import newton
import numpy as np

from wsim.geometry.catenary import hanging
from wsim.geometry.ropes import path_points
from wsim.scene.cord_paths import moving_stops
from wsim.scene.world import Rope, Spring, World

Array = np.ndarray
ROPE_PIECES = 64
COIL_PIECES = 12  # a turn
WIRE = 0.14  # radius of a coil's wire, of the coil's
END = 0.08  # of a spring's length at each end that is straight
MARK = "drawn_"


def add_cord_shapes(builder: Any, world: World) -> None:
    """Give a builder the capsules that draw a world's springs and ropes; nothing collides with them or weighs them."""
    config = newton.ModelBuilder.ShapeConfig(density=0.0, has_shape_collision=False, has_particle_collision=False)
    for cord in world.cords:
        for k in range(_pieces(cord)):
            builder.add_shape_capsule(
                -1, radius=cord.radius, half_height=0.01, cfg=config, label=f"{cord.prim}/{MARK}{k}"
            )


def _turns(spring: Spring) -> int:
    """Turns of a drawn coil: as many as give it a pitch of about its radius, at its rest length."""
    return int(np.clip((spring.rest_length or 1.0) / (1.2 * spring.radius), 5, 14))


def _pieces(cord: Spring | Rope) -> int:
    if isinstance(cord, Rope):
        return ROPE_PIECES
    return COIL_PIECES * _turns(cord) + 2 if cord.stiffness > 0.0 else 2


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
    stops = moving_stops(cord.path, poses)
    if isinstance(cord, Rope):
        points = _slackened(path_points(stops), cord.length)
        return np.stack([points[:-1], points[1:]], axis=1), np.full(len(points) - 1, cord.radius)
    start, end = (stop.position[0] for stop in stops)
    if cord.stiffness == 0.0:
        # A damper: a rod that goes into a cylinder.
        tube = np.stack([start, start + 0.55 * (end - start)])
        return np.stack([tube, np.stack([start, end])]), np.array([0.5 * cord.radius, 0.2 * cord.radius])
    points = _coil(start, end, cord.radius, _turns(cord))
    return np.stack([points[:-1], points[1:]], axis=1), np.full(len(points) - 1, WIRE * cord.radius)


def _coil(start: Array, end: Array, radius: float, turns: int) -> Array:
    apart = end - start
    length = max(float(np.linalg.norm(apart)), 1e-9)
    along = apart / length
    aside = np.eye(3)[int(np.argmin(np.abs(along)))]
    u = np.cross(along, aside)
    u /= np.linalg.norm(u)
    v = np.cross(along, u)
    way = np.linspace(0.0, 1.0, COIL_PIECES * turns + 1)
    turn = 2.0 * np.pi * turns * way
    middle = start + ((END + (1.0 - 2.0 * END) * way) * length)[:, None] * along
    ring = np.cos(turn)[:, None] * u + np.sin(turn)[:, None] * v
    points: Array = np.concatenate([start[None], middle + radius * ring, end[None]])
    return points


def _slackened(points: Array, length: float) -> Array:
    """A rope's way drawn out to its length, in a fixed number of pieces: what is slack hangs in its last part."""
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    slack = length - float(steps.sum())
    if slack > 1e-3 * length:
        left = max(ROPE_PIECES + 2 - len(points), 8)
        points = np.concatenate([points[:-2], hanging(points[-2], points[-1], float(steps[-1]) + slack, left)])
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
