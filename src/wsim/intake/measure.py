"""How well what collides stands for what is seen: volume, distance of the surfaces, hollows that stay open."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import trimesh
from scipy import ndimage
from scipy.spatial import ConvexHull, cKDTree

from wsim.intake.lattice import Bools, Lattice, hull_of
from wsim.intake.model import Array, Collider, Mesh
from wsim.intake.repair import Solid

LEAST_ROOM = 0.02  # of the hull's volume: smaller hollows are not told of
_SAMPLES, _TARGETS, _NEAREST = 4_000, 60_000, 12
_FEW, _PAIRS = 300, 400_000  # triangles that are all asked; points and triangles at a time


@dataclass(frozen=True)
class Hollow:
    """A hollow of what is seen: which cells, its centre [m], its volume [m^3], and the share that stays open."""

    cells: Bools
    center: Array
    volume: float
    open: float


@dataclass(frozen=True)
class Fit:
    """Measured; None where what is seen has no inside."""

    volume_ratio: float | None
    hausdorff: float
    hollows: list[Hollow]

    @property
    def open(self) -> float:
        """Share of the least open hollow that stays open; 1 where there is none."""
        return min((hollow.open for hollow in self.hollows), default=1.0)


@dataclass(frozen=True)
class Seen:
    """What is seen, on a lattice; `inside` is None where it is not closed."""

    solid: Solid
    lattice: Lattice
    inside: Bools | None
    rooms: list[Bools]

    @classmethod
    def of(cls, solid: Solid) -> Seen:
        """Measure a solid once, for all tries."""
        lattice = Lattice.around(solid.points)
        if not solid.closed:
            return cls(solid, lattice, None, [])
        inside = lattice.inside(solid.mesh())
        hull = lattice.inside(hull_of(Collider("hull", points=solid.points)))
        labels, count = ndimage.label(hull & ~inside)
        sizes = np.bincount(labels.reshape(-1), minlength=count + 1)
        large = [k for k in range(1, count + 1) if sizes[k] >= LEAST_ROOM * hull.sum()]
        return cls(solid, lattice, inside, [labels == k for k in large])

    def measure(self, colliders: list[Collider]) -> Fit:
        """How well colliders stand for it."""
        filled = self.lattice.union(colliders)
        ratio = None
        if self.inside is not None and self.inside.any():
            ratio = float(filled.sum() / self.inside.sum())
        hollows = []
        for cells in self.rooms:
            at = [float(axis.mean()) for axis in np.nonzero(cells)]
            center = self.lattice.low + (np.array(at) + 0.5) * self.lattice.cell
            share = 1.0 - float((cells & filled).sum() / cells.sum())
            hollows.append(Hollow(cells, center, float(cells.sum()) * self.lattice.volume, share))
        return Fit(ratio, hausdorff(self.solid.mesh(), colliders), hollows)


def hausdorff(mesh: Mesh, colliders: list[Collider]) -> float:
    """The most by which a point of either surface lies off the other [m], by samples of both.

    Surfaces of parts that lie in other parts are none of what collides.
    """
    seen = trimesh.Trimesh(mesh.points, mesh.faces, process=False)
    hulls = [hull_of(collider) for collider in colliders]
    touched = trimesh.util.concatenate([trimesh.Trimesh(h.points, h.faces, process=False) for h in hulls])
    (ours, _), (theirs, normals) = _samples(seen), _samples(touched)
    planes = [ConvexHull(h.points).equations for h in hulls]
    # Just before its surface a part that lies in another, or against it, has that one.
    before = theirs + 1e-4 * float(np.ptp(mesh.points, axis=0).max()) * normals
    outer = np.ones(len(theirs), dtype=bool)
    for equations in planes:
        outer &= ~_inside(before, equations, 0.0)
    far = [_distances(ours, touched).max()]
    if outer.any():
        far.append(_distances(theirs[outer], seen).max())
    return float(max(far))


def _samples(mesh: trimesh.Trimesh) -> tuple[Array, Array]:
    """Points on a surface, and its normals there, (n, 3) each."""
    points, faces = trimesh.sample.sample_surface(mesh, _SAMPLES, seed=0)
    return np.asarray(points, dtype=np.float64), np.asarray(mesh.face_normals[faces], dtype=np.float64)


def _inside(points: Array, equations: Array, slack: float) -> Bools:
    depth = points @ equations[:, :3].T + equations[:, 3]
    return np.asarray((depth < slack).all(axis=1))


def _distances(points: Array, mesh: trimesh.Trimesh) -> Array:
    """Of points to a mesh [m]: to all its triangles if they are few, else to those that the nearest samples lie on."""
    every = np.arange(len(mesh.faces))
    if len(every) <= _FEW:
        near = np.broadcast_to(every, (len(points), len(every)))
    else:
        samples, faces = trimesh.sample.sample_surface(mesh, _TARGETS, seed=1)
        at = np.concatenate([np.asarray(samples), np.asarray(mesh.triangles_center)])
        _, nearest = cKDTree(at).query(points, k=_NEAREST)
        near = np.concatenate([np.asarray(faces), every])[nearest]
    triangles, count = np.asarray(mesh.triangles), near.shape[1]
    gaps = np.empty(len(points))
    step = max(1, _PAIRS // count)
    for k in range(0, len(points), step):
        some = slice(k, k + step)
        asked = np.repeat(points[some], count, axis=0)
        closest = trimesh.triangles.closest_point(triangles[near[some]].reshape(-1, 3, 3), asked)
        gaps[some] = np.linalg.norm(closest - asked, axis=1).reshape(-1, count).min(axis=1)
    return gaps
