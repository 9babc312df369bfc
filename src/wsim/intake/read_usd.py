"""Read the Gprims of a USD file as one body."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import trimesh
from pxr import Gf, Usd, UsdGeom, UsdPhysics

from wsim.geometry.rotations import matrices
from wsim.intake.model import Body, IntakeError, Mesh, Model
from wsim.scene.usd_shapes import read_shape
from wsim.scene.world import Shape

_SHOWN = (UsdGeom.Tokens.default_, UsdGeom.Tokens.render)


def read_usd(path: Path) -> Model:
    """What a renderer shows of a stage: meshes and plain shapes, as one body."""
    stage = Usd.Stage.Open(str(path))
    if stage is None:
        raise IntakeError(f"file = {path.name} is no USD stage; export it again")
    up = str(UsdGeom.GetStageUpAxis(stage)).lower()
    notes, meshes = [], []
    for prim in stage.Traverse(Usd.TraverseInstanceProxies()):
        if prim.IsA(UsdPhysics.Joint):
            notes.append("the joints of a USD file are not carried: all of it is one body")
        imageable = UsdGeom.Imageable(prim)
        if not prim.IsA(UsdGeom.Gprim) or imageable.ComputePurpose() not in _SHOWN:
            continue
        shape = read_shape(prim, Gf.Matrix4d(1.0)) if imageable.ComputeVisibility() != "invisible" else None
        mesh = _mesh(shape, prim.GetName()) if shape is not None else None
        if mesh is None:
            notes.append(f"{prim.GetName()[:40]} is no triangles; left out")
        else:
            meshes.append(mesh)
    unit = float(UsdGeom.GetStageMetersPerUnit(stage))
    return Model([Body("", meshes)], up, "+z" if up == "y" else "+x", unit, notes=list(dict.fromkeys(notes)))


def _mesh(shape: Shape, name: str) -> Mesh | None:
    if shape.kind == "mesh":
        points, faces = np.array(shape.vertices).reshape(-1, 3), np.array(shape.triangles).reshape(-1, 3)
    elif shape.kind == "plane":
        return None
    else:
        made = plain(shape.kind, shape.size)
        points, faces = np.asarray(made.vertices), np.asarray(made.faces)
    red, green, blue = shape.color
    mesh = Mesh(name, points, faces.astype(np.int64), (red, green, blue))
    return mesh.moved(matrices(np.array(shape.rotation)), np.array(shape.position))


def plain(kind: str, size: tuple[float, ...]) -> trimesh.Trimesh:
    """A plain shape as triangles."""
    if kind == "box":
        return trimesh.creation.box(extents=size)
    if kind == "sphere":
        return trimesh.creation.icosphere(subdivisions=3, radius=size[0])
    if kind == "cylinder":
        return trimesh.creation.cylinder(radius=size[0], height=size[1], sections=48)
    if kind == "capsule":
        return trimesh.creation.capsule(radius=size[0], height=size[1], count=[24, 24])
    raise IntakeError(f"shape = {kind} is not known; make it a mesh")
