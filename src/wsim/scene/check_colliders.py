"""Bodies and colliders that the simulator can take: each body weighs something, each collider has an inside."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from pxr import Usd, UsdGeom, UsdPhysics

from wsim.scene.articulation import body_above
from wsim.scene.usd_shapes import Array, collides, volume_of

_FLAT = 1e-5  # of a mesh's extent: MuJoCo's own bound is 1e-6, in single precision
_MOST_TRIANGLES = 1_000_000  # of a mesh that collides
_BOUNDS = ("boundingCube", "boundingSphere")  # what stands for a mesh that may be flat
_AXES = ("X", "Y", "Z")


def check_solid(prim: Usd.Prim, *, known: bool = False) -> Iterator[str]:
    """Problems of one prim: an axis, a body or a collider; of a stage of a known skeleton those of numbers alone."""
    if not known:
        axis = prim.GetAttribute("physics:axis" if prim.IsA(UsdPhysics.Joint) else "axis")
        if axis and axis.HasAuthoredValue() and axis.Get() not in _AXES:
            yield f"{axis.GetPath()}: {axis.Get()!r} must be one of {', '.join(_AXES)}"
            return
    if prim.HasAPI(UsdPhysics.RigidBodyAPI):
        yield from _body(prim, known)
    if prim.IsA(UsdGeom.Mesh):
        yield from _mesh(UsdGeom.Mesh(prim))


def _body(prim: Usd.Prim, known: bool) -> Iterator[str]:
    outer = None if known else _carried_by(prim)
    if outer:
        yield f"{prim.GetPath()}: a rigid body inside the rigid body <{outer.GetPath()}>; put it beside, and join them"
    elif not _weighs(prim):
        yield (
            f"{prim.GetPath()}: a rigid body without mass; give it a collider that is switched on and has a volume, or "
            "physics:mass"
        )


def _carried_by(prim: Usd.Prim) -> Usd.Prim | None:
    """The rigid body whose motion carries a prim along; none where the stack of transforms starts anew."""
    while prim and not prim.IsPseudoRoot():
        if prim.IsA(UsdGeom.Xformable) and UsdGeom.Xformable(prim).GetResetXformStack():
            return None
        prim = prim.GetParent()
        if prim and prim.HasAPI(UsdPhysics.RigidBodyAPI):
            return prim
    return None


def _weighs(body: Usd.Prim) -> bool:
    if _mass(body) > 0.0:
        return True
    parts = Usd.PrimRange(body, Usd.TraverseInstanceProxies())
    return any(_has_volume(part) for part in parts if collides(part) and body_above(part) == body.GetPath())


def _mass(prim: Usd.Prim) -> float:
    return float(UsdPhysics.MassAPI(prim).GetMassAttr().Get() or 0.0) if prim.HasAPI(UsdPhysics.MassAPI) else 0.0


def _has_volume(collider: Usd.Prim) -> bool:
    return bool(collider.IsA(UsdGeom.Gprim)) and volume_of(collider) > 0.0


def _mesh(mesh: UsdGeom.Mesh) -> Iterator[str]:
    prim = mesh.GetPrim()
    points = mesh.GetPointsAttr().Get()
    if not points:
        yield f"{prim.GetPath()}.points: a mesh needs points"
    elif prim.HasAPI(UsdPhysics.CollisionAPI):
        approximation = UsdPhysics.MeshCollisionAPI(prim).GetApproximationAttr()
        if not mesh.GetFaceVertexCountsAttr().Get():
            yield f"{prim.GetPath()}.faceVertexCounts: a mesh that collides needs faces"
        elif (count := len(mesh.GetFaceVertexCountsAttr().Get())) > _MOST_TRIANGLES:
            yield f"{prim.GetPath()}.faceVertexCounts: {count} faces collide; at most {_MOST_TRIANGLES}"
        elif not (approximation and approximation.Get() in _BOUNDS) and _flat(_placed(mesh)):
            yield f"{prim.GetPath()}.points: a flat mesh cannot collide; give it thickness, or use a Cube or a Plane"


def _placed(mesh: UsdGeom.Mesh) -> Array:
    matrix = np.array(mesh.ComputeLocalToWorldTransform(Usd.TimeCode.Default()))
    return np.asarray(mesh.GetPointsAttr().Get(), dtype=np.float64) @ matrix[:3, :3]


def _flat(points: Array) -> bool:
    """Whether points lie in a plane, on a line or at one place."""
    if not np.isfinite(points).all():
        return False  # told elsewhere
    offsets = points - points.mean(axis=0)
    normal = np.linalg.eigh(offsets.T @ offsets)[1][:, 0]  # the direction in which they spread least
    extent = float(np.linalg.norm(np.ptp(points, axis=0)))
    return bool(np.ptp(offsets @ normal) <= _FLAT * extent)
