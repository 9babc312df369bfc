"""Mend a body's triangles: doubles, slivers, faces turned over, small holes. Each thing done is said."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import trimesh

from wsim.intake.model import Array, Color, Faces, IntakeError, Mesh
from wsim.intake.shells import edges_of, is_closed, shells, turned_over

MERGED = 1e-6  # of its longest edge: points nearer than this are one
_MOST_FILLED = 0.05  # of the area: a hole that takes more is an opening that was meant
_FLAT = 1e-14  # of the longest edge squared: the area of a sliver


@dataclass
class Solid:
    """One body's triangles, joined: points (V, 3) [m], faces (F, 3), and of each face the index of its look."""

    points: Array
    faces: Faces
    look: Faces
    names: list[str]
    colors: list[Color]
    closed: bool = False

    def mesh(self) -> Mesh:
        """All of it."""
        return Mesh("solid", self.points, self.faces)

    def looks(self) -> list[Mesh]:
        """One mesh for each look."""
        found = []
        for k, (name, color) in enumerate(zip(self.names, self.colors, strict=True)):
            used, index = np.unique(self.faces[self.look == k], return_inverse=True)
            if len(used):
                found.append(Mesh(name, self.points[used], index.reshape(-1, 3), color))
        return found


def repair(meshes: list[Mesh], notes: list[str]) -> Solid:
    """The meshes of a body as one, mended as far as can be.

    Raises:
        IntakeError: If nothing of it has an area.
    """
    solid = _joined(meshes)
    _without_slivers(solid, notes)
    if not len(solid.faces):
        raise IntakeError("area = 0: every triangle is a line or a point; export the mesh again")
    _wound(solid, notes)
    solid.closed = is_closed(solid.faces)
    if not solid.closed and (filled := _filled(solid)):
        notes.append(f"mended: {filled} small holes filled")
        _wound(solid, notes)
        solid.closed = is_closed(solid.faces)
    if solid.closed:
        _outwards(solid, notes)
        solid.closed = solid.mesh().volume > 1e-9 * float(np.prod(np.ptp(solid.points, axis=0)))
    if not solid.closed:
        count = int((np.bincount(edges_of(solid.faces)[0]) != 2).sum())
        notes.append(
            f"not closed: {count} edges belong to one face, or to more than two; so it has no volume of its own, and "
            "what collides says its mass and inertia"
        )
    return solid


def _joined(meshes: list[Mesh]) -> Solid:
    points = np.concatenate([mesh.points for mesh in meshes])
    starts = np.cumsum([0, *(len(mesh.points) for mesh in meshes)])
    faces = np.concatenate([mesh.faces + start for mesh, start in zip(meshes, starts, strict=False)])
    looks = list(dict.fromkeys(mesh.color for mesh in meshes))
    look = np.concatenate([np.full(len(mesh.faces), looks.index(mesh.color)) for mesh in meshes])
    names = [next(mesh.name for mesh in meshes if mesh.color == color) for color in looks]
    step = MERGED * float(np.ptp(points, axis=0).max())
    _, first, index = np.unique(
        np.round(points / step).astype(np.int64), axis=0, return_index=True, return_inverse=True
    )
    return Solid(points[first], index.reshape(-1)[faces], look, names, looks)


def _keep(solid: Solid, kept: Faces) -> None:
    solid.faces, solid.look = solid.faces[kept], solid.look[kept]


def _without_slivers(solid: Solid, notes: list[str]) -> None:
    a, b, c = (solid.points[solid.faces[:, k]] for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2.0
    good = area > _FLAT * float(np.ptp(solid.points, axis=0).max()) ** 2
    f = solid.faces
    good &= (f[:, 0] != f[:, 1]) & (f[:, 1] != f[:, 2]) & (f[:, 2] != f[:, 0])
    if not good.all():
        notes.append(f"mended: {int((~good).sum())} triangles without area left out")
        _keep(solid, np.flatnonzero(good))
    _, first = np.unique(np.sort(solid.faces, axis=1), axis=0, return_index=True)
    if len(first) < len(solid.faces):
        notes.append(f"mended: {len(solid.faces) - len(first)} triangles that were there twice left out")
        _keep(solid, np.sort(first))


def _wound(solid: Solid, notes: list[str]) -> None:
    """Let neighbours turn the same way, where they do not."""
    if is_closed(solid.faces):
        return
    over = turned_over(solid.faces)
    # Of each shell the fewer are turned, so that what was right stays.
    for shell in shells(solid.faces):
        if 2 * over[shell].sum() > len(shell):
            over[shell] = ~over[shell]
    if over.any():
        solid.faces[over] = solid.faces[over][:, ::-1]
        notes.append(f"mended: {int(over.sum())} triangles turned over, to face as their neighbours do")


def _filled(solid: Solid) -> int:
    """Close small holes, each by a fan about its middle; how many were closed."""
    edges = solid.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    there = {(int(a), int(b)) for a, b in edges}
    after: dict[int, int] = {}
    for a, b in sorted(there):
        if (b, a) not in there:
            if b in after:
                return 0  # rims that touch: which goes with which is anyone's guess
            after[b] = a
    count, most = 0, _MOST_FILLED * float(trimesh.Trimesh(solid.points, solid.faces, process=False).area)
    while after:
        start, rim = next(iter(after)), []
        at: int | None = start
        while at is not None and at in after:
            rim.append(at)
            at = after.pop(at)
        if at != start or len(rim) < 3:
            continue
        ring = solid.points[rim]
        middle = ring.mean(axis=0)
        area = np.linalg.norm(np.cross(ring - middle, np.roll(ring, -1, axis=0) - middle), axis=1).sum() / 2.0
        if area > most:
            continue
        new = len(solid.points)
        solid.points = np.vstack([solid.points, middle])
        fan = np.array([[a, b, new] for a, b in zip(rim, [*rim[1:], rim[0]], strict=True)])
        solid.faces = np.vstack([solid.faces, fan])
        solid.look = np.concatenate([solid.look, np.full(len(fan), solid.look[0])])
        count += 1
    return count


def _outwards(solid: Solid, notes: list[str]) -> None:
    """Turn each shell outwards, but for one that lies in another: the wall of a room inside."""
    found = shells(solid.faces)
    corners = [solid.points[solid.faces[shell]].reshape(-1, 3) for shell in found]
    boxes = [(points.min(axis=0), points.max(axis=0)) for points in corners]
    turned = 0
    for shell, (low, high) in zip(found, boxes, strict=True):
        inside = any((other[0] < low).all() and (high < other[1]).all() for other in boxes)
        if not inside and Mesh("", solid.points, solid.faces[shell]).volume < 0.0:
            solid.faces[shell] = solid.faces[shell][:, ::-1]
            turned += len(shell)
    if turned:
        notes.append(f"mended: {turned} triangles turned over, which faced inwards")
