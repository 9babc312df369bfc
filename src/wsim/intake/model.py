"""What is read from a user's file, whatever its format: bodies of coloured meshes, and the joints between them.

Lengths in metres, Z up, +X forward once `orient` is through; rotations as (3, 3) matrices.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from wsim.errors import UserError

Array = NDArray[np.float64]
Faces = NDArray[np.int64]
Color = tuple[float, float, float]

GREY: Color = (0.6, 0.6, 0.6)
JointKind = Literal["revolute", "prismatic", "spherical"]


class IntakeError(UserError):
    """A file that cannot become an asset: one line with the field, its value, and the way out."""


@dataclass(frozen=True)
class Mesh:
    """Triangles of one look: points (V, 3) [m], faces (F, 3), linear RGB in 0..1."""

    name: str
    points: Array
    faces: Faces
    color: Color = GREY

    def moved(self, turn: Array, shift: Array) -> Mesh:
        """The same mesh at `turn` x + `shift`; a `turn` that mirrors turns its faces over."""
        faces = self.faces[:, ::-1] if np.linalg.det(turn) < 0.0 else self.faces
        return replace(self, points=self.points @ turn.T + shift, faces=faces)

    @property
    def volume(self) -> float:
        """Of what it encloses [m^3]; negative where its faces look inwards."""
        a, b, c = (self.points[self.faces[:, k]] for k in range(3))
        return float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6.0


@dataclass(frozen=True)
class Collider:
    """A convex body that collides: a plain shape about `center`, turned by `turn`, or the hull of points.

    `size` [m]: edges of a box, radius of a sphere, radius and height of a cylinder along its Z.
    """

    kind: Literal["box", "sphere", "cylinder", "hull"]
    size: tuple[float, ...] = ()
    center: Array = field(default_factory=lambda: np.zeros(3))
    turn: Array = field(default_factory=lambda: np.eye(3))
    points: Array = field(default_factory=lambda: np.zeros((0, 3)))

    def moved(self, turn: Array, shift: Array, scale: float = 1.0) -> Collider:
        """The same body, scaled, turned and moved."""
        return replace(
            self,
            size=tuple(scale * v for v in self.size),
            center=scale * (turn @ self.center) + shift,
            turn=turn @ self.turn,
            points=scale * (self.points @ turn.T) + shift,
        )


@dataclass
class Body:
    """A rigid body: meshes and colliders in the asset's frame; without colliders they are made of the meshes.

    `mass` [kg] is the file's own, with `com` [m] in the asset's frame and `inertia` [kg m^2] about it, along its axes.
    """

    name: str
    meshes: list[Mesh] = field(default_factory=list)
    colliders: list[Collider] = field(default_factory=list)
    mass: float | None = None
    com: Array | None = None
    inertia: Array | None = None
    origin: Array = field(default_factory=lambda: np.zeros(3))  # where its frame stands in the asset
    turn: Array = field(default_factory=lambda: np.eye(3))


@dataclass
class Joint:
    """Of the bodies `parent` and `child`, at `at` [m], about or along `axis`; limits in degrees or metres."""

    name: str
    kind: JointKind
    parent: str
    child: str
    at: Array
    axis: Array
    limits: tuple[float, float] | None = None


@dataclass
class Model:
    """What a file holds. `up` and `forward` are axes of the file, `unit` its length unit [m], None if it says none."""

    bodies: list[Body]
    up: str
    forward: str
    unit: float | None
    joints: list[Joint] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def points(self) -> Array:
        """All points that are seen, (N, 3)."""
        return np.concatenate([mesh.points for body in self.bodies for mesh in body.meshes])


def as_trimesh(meshes: list[Mesh]) -> Any:
    """Meshes as one of trimesh's, points in one place made one."""
    import trimesh  # heavy, and most verbs need none of it

    joined = trimesh.util.concatenate([trimesh.Trimesh(m.points, m.faces, process=False) for m in meshes])
    joined.merge_vertices()
    return joined
