"""Where any prim of a stage is, and what it is part of."""

from __future__ import annotations

from pxr import Gf, Usd, UsdGeom, UsdPhysics

from wsim.scene.usd_shapes import to_quat
from wsim.scene.world import Quat

_NOW = Usd.TimeCode.Default()


def rigid_frame(prim: Usd.Prim) -> Gf.Matrix4d:
    """A prim's transform to the world, without its scale."""
    if not prim.IsA(UsdGeom.Xformable):
        return Gf.Matrix4d(1.0)
    return UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(_NOW).RemoveScaleShear()


def turn_of(frame: Gf.Matrix4d) -> Quat:
    """The rotation of a frame."""
    return to_quat(frame.ExtractRotationQuat())


def owner_of(prim: Usd.Prim) -> str | None:
    """Path of the nearest rigid body at or above a prim."""
    while prim and not prim.IsPseudoRoot():
        if prim.HasAPI(UsdPhysics.RigidBodyAPI):
            return str(prim.GetPath())
        prim = prim.GetParent()
    return None


def object_path(prim: Usd.Prim, stage: Usd.Stage) -> str:
    """The object that a static piece of geometry belongs to: the child of the default prim above it."""
    default = stage.GetDefaultPrim()
    parts = prim.GetPath().GetPrefixes()
    under = bool(default) and len(parts) > 1 and parts[0] == default.GetPath()
    return str(parts[1] if under else parts[0])
