"""Read a triangle mesh from a file and write it to a stage."""

from __future__ import annotations

import re
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from pxr import Usd, UsdGeom, UsdPhysics

from wsim.limits import MAX_POINTS, MAX_SIZE, MIN_SIZE
from wsim.scene.bodies import MassProperties
from wsim.scene.errors import one_line
from wsim.scene.static_mesh import define_mesh, smooth_normals
from wsim.scene.validate import Call, shown

FORMATS = (".obj", ".stl", ".ply", ".glb")
APPROXIMATIONS = ("convexHull", "convexDecomposition", "none")


@dataclass(frozen=True)
class MeshFile:
    """The triangles of a file, scaled and with Z up."""

    mesh: Any  # trimesh.Trimesh

    @classmethod
    def read(
        cls, call: Call, file: str | Path, folder: Path | None, *, scale: float | Sequence[float], up_axis: str
    ) -> MeshFile:
        """Read `file`; `SceneError` if it is missing, of another format, empty or of an absurd size."""
        path = _find(call, file, folder)
        factors = _factors(call, scale)
        up = call.axis(up_axis, "up_axis")
        if up == "X":
            call.fail('up_axis = "X" must be "Z" or "Y"')
        import trimesh  # heavy, and few programs read meshes

        try:
            with warnings.catch_warnings(), np.errstate(all="ignore"):  # what is not finite is told below
                warnings.simplefilter("ignore")
                mesh = trimesh.load(path, force="mesh", process=False)
        except Exception as error:  # noqa: BLE001 - each of trimesh's readers raises its own kinds
            call.fail(f"file = {shown(path.name)} cannot be read as a mesh: {_unread(error)}")
        if not isinstance(mesh, trimesh.Trimesh) or len(mesh.faces) == 0:
            call.fail(f"file = {shown(path.name)} holds no triangles")
        if len(mesh.vertices) > MAX_POINTS:
            call.fail(f"file = {shown(path.name)} has {len(mesh.vertices)} vertices; at most {MAX_POINTS}")
        strays = mesh.faces[(mesh.faces < 0) | (mesh.faces >= len(mesh.vertices))]
        if len(strays):
            call.fail(f"file = {shown(path.name)}: {_stray(int(strays[0]), len(mesh.vertices))}")
        bad = ~np.isfinite(mesh.vertices).all(axis=1)
        if bad.any():
            count, first = int(bad.sum()), int(np.argmax(bad))
            call.fail(
                f"file = {shown(path.name)} holds {count} vertices that are not finite, such as number {first} "
                f"(from 0), {shown(tuple(mesh.vertices[first].tolist()))}; export it again"
            )
        mesh.merge_vertices()
        vertices = np.asarray(mesh.vertices) * factors
        if up == "Y":
            vertices = vertices[:, [0, 2, 1]] * (1.0, -1.0, 1.0)
        longest = float(np.ptp(vertices, axis=0).max())
        if not MIN_SIZE <= longest <= MAX_SIZE:
            call.fail(
                f"scale = {shown(scale)} makes {Path(file).name} {longest:g} m long; it must be {MIN_SIZE:g} to "
                f"{MAX_SIZE:g} m. Files in millimetres need scale=0.001"
            )
        return cls(trimesh.Trimesh(vertices, mesh.faces, process=False))

    def approximation(self, call: Call, collision: str | None, *, static: bool) -> str:
        """How the mesh collides: as asked for, or the default for what it is; one that moves has a volume."""
        corners = np.asarray(self.mesh.vertices)
        if not static and np.linalg.matrix_rank(corners - corners.mean(axis=0), 1e-6 * np.ptp(corners)) < 3:
            call.fail("the mesh is flat: it has no volume that could move; static=True, or give it a thickness")
        if collision is None:
            return "none" if static else "convexHull"
        if call.one_of("collision", collision, APPROXIMATIONS) == "none" and not static:
            call.fail('collision = "none" needs static=True; a mesh that moves takes convexHull or convexDecomposition')
        return collision

    def define(self, stage: Usd.Stage, path: str, approximation: str, smooth: float = 0.0) -> UsdGeom.Mesh:
        """Write the triangles to a stage; those that meet at a kink below `smooth` [rad] stand for a curve."""
        points, faces = np.asarray(self.mesh.vertices), np.asarray(self.mesh.faces, dtype=np.int64)
        normals = smooth_normals(points, faces, smooth).reshape(-1, 3) if smooth > 0.0 else None
        usd = define_mesh(stage, path, points, [faces], normals)
        UsdPhysics.MeshCollisionAPI(usd.GetPrim()).CreateApproximationAttr(approximation)
        return usd

    def mass_properties(self, mass: float | None, density: float | None) -> MassProperties | None:
        """Mass properties of the convex hull, for a mesh whose own volume means nothing; None for a closed mesh."""
        if self.mesh.is_volume:
            return None
        hull = self.mesh.convex_hull
        if mass is None:
            mass = float(density or 0.0) * float(hull.volume)
        inertia = np.asarray(hull.moment_inertia) * (mass / float(hull.volume))
        return MassProperties.of(mass, np.asarray(hull.center_mass), inertia)


def _unread(error: Exception) -> str:
    """Why a reader of trimesh's gave up; of an index in NumPy's words, in a mesh's."""
    text = one_line(error)
    found = re.search(r"index (-?\d+) is out of bounds .* size (\d+)", text)
    return _stray(int(found[1]), int(found[2])) if found else text


def _stray(index: int, count: int) -> str:
    return f"a face names vertex {index} (from 0) of {count}, which is not there; mend the file, or export it again"


def _find(call: Call, file: str | Path, folder: Path | None) -> Path:
    if not isinstance(file, (str, Path)):
        call.fail(f"file = {shown(file)} must be the path of an OBJ, STL, PLY or GLB file")
    path = Path(file)
    if path.suffix.lower() not in FORMATS:
        call.fail(f"file = {shown(str(file))} must end in one of {', '.join(FORMATS)}")
    places = [path] if path.is_absolute() or folder is None else [folder / path, path]
    for place in places:
        if place.is_file():
            return place
    looked = dict.fromkeys(str(place.absolute()) for place in places)
    return call.fail(f"file = {shown(str(file))} is not there; looked at {' and '.join(looked)}")


def _factors(call: Call, scale: float | Sequence[float]) -> np.ndarray:
    if isinstance(scale, (Sequence, np.ndarray)):
        values = [call.positive(f"scale[{i}]", v, 1e6, "") for i, v in enumerate(scale)]
        if len(values) != 3:
            call.fail(f"scale = {shown(scale)} must be one number or three")
        return np.array(values)
    return np.full(3, call.positive("scale", scale, 1e6, ""))
