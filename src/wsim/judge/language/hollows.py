"""What things can be in: the hollow of a tank, a bucket or a bowl, as the half-spaces that bound it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from wsim.geometry.rotations import conjugate, multiply, rotate
from wsim.geometry.shapes import Solid
from wsim.judge.evidence.recorded import MissingError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.language.signals import Signals
    from wsim.scene.world import Container, Shape

    Floats = NDArray[np.float64]

OPEN = 0.1  # of its hull, that no shape of it fills: less is a solid's rounding
LID = 0.5  # of the upward axis that a face's normal has: it closes a hollow from above
SAME = 5  # digits [m and 1] to which faces are one


@dataclass(frozen=True)
class Hollow:
    """Where something is in a vessel.

    Attributes:
        prim: The vessel's.
        faces: (K, 4): a place x of its frame is inside where n . x <= d, n unit vectors and d [m] the last column.
        pose: Of its frame, (7,) of what stands still, (W, T, 7) of a body [m, xyzw].
        up: What points up at the start, in its frame (3,).
    """

    prim: str
    faces: Floats
    pose: Floats
    up: Floats

    def room(self, signals: Signals, name: str) -> Floats:
        """The least room between a body and the walls, the floor and the rim, (W, T) [m]; less than 0 beyond them."""
        turned, places = self._local(signals, name)
        solid = signals.solid(name)
        flat, room = turned.reshape(-1, 4), []
        for face in self.faces:
            _, high = solid.reach(flat, face[:3])
            room.append(face[3] - places @ face[:3] - high.reshape(places.shape[:-1]))
        return np.asarray(np.min(room, axis=0))

    def depth(self, signals: Signals, name: str) -> Floats:
        """How far a body's origin is from the walls and the floor, (W, T) [m]; less than 0 beyond them."""
        _, places = self._local(signals, name)
        walls = self.faces[self.faces[:, :3] @ self.up < LID]
        return np.asarray((walls[:, 3] - places @ walls[:, :3].T).min(axis=-1))

    def _local(self, signals: Signals, name: str) -> tuple[Floats, Floats]:
        """A body's rotations and places in the vessel's frame, (W, T, 4) and (W, T, 3)."""
        q, back = signals.q(name), conjugate(self.pose[..., 3:])
        back = np.broadcast_to(back, (*q.shape[:2], 4))
        return multiply(back, q[..., 3:]), rotate(back, q[..., :3] - self.pose[..., :3])


def hollow_of(signals: Signals, name: str) -> Hollow:
    """The hollow of a tank; of anything else that is hollow, what its convex hull holds and it does not fill.

    Raises:
        MissingError: It is solid, endless or a fluid: nothing can be in it.
    """
    prim = signals.prim(name)
    for container in signals.world.containers:
        if container.prim == prim:
            return _of_tank(container, signals.up)
    shapes = signals.body(name).shapes if signals.moves(name) else _still(signals, prim)
    faces = _bounds([shape for shape in shapes if shape.collides])
    if faces is None:
        known = ", ".join(container.prim for container in signals.world.containers) or "none"
        raise MissingError(f"{name!r} is no container, and not hollow either; containers are {known}")
    if signals.moves(name):
        pose = signals.q(name)
        return Hollow(prim, faces, pose, rotate(conjugate(pose[0, 0, 3:]), signals.up))
    return Hollow(prim, faces, np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]), signals.up)


def _of_tank(container: Container, up: Floats) -> Hollow:
    half = np.array(container.inner_size, dtype=np.float64) / 2
    faces = np.hstack([np.vstack([np.eye(3), -np.eye(3)]), np.concatenate([half, half])[:, None]])
    pose = np.array([*container.inner_center, *container.rotation], dtype=np.float64)
    return Hollow(container.prim, faces, pose, rotate(conjugate(pose[3:]), up))


def _still(signals: Signals, prim: str) -> list[Shape]:
    return next((static.shapes for static in signals.world.statics if static.prim == prim), [])


def _bounds(shapes: Sequence[Shape]) -> Floats | None:
    """The faces of the convex hull of some shapes (K, 4); None of what is solid or endless."""
    if not shapes or any(shape.kind == "plane" for shape in shapes):
        return None
    surfaces = Solid(shapes).surfaces
    try:
        hull = ConvexHull(np.vstack([surface.vertices for surface in surfaces]))
    except (QhullError, ValueError):  # flat
        return None
    if sum(surface.volume for surface in surfaces) > (1.0 - OPEN) * hull.volume:
        return None
    faces = np.unique(np.round(hull.equations, SAME), axis=0)
    return np.hstack([faces[:, :3], -faces[:, 3:]])
