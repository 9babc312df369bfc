"""Read what a stage says of motion that is stated, not worked out: surfaces that move as belts do."""

from __future__ import annotations

from pxr import Gf, Usd, UsdGeom

from wsim.scene import schema
from wsim.scene.world import Shape, Vec3

_NOW = Usd.TimeCode.Default()


def with_surface_velocity(shape: Shape, prim: Usd.Prim, base: Gf.Matrix4d) -> Shape:
    """A shape with the velocity of its surface in the frame `base`: that of the nearest prim at or above that has one.

    Args:
        shape: What `prim` was read as.
        prim: A Gprim.
        base: Rigid transform of the shape's owner to the world.
    """
    velocity = _surface_velocity(prim, base)
    return shape.model_copy(update={"surface_velocity": velocity}) if any(velocity) else shape


def _surface_velocity(prim: Usd.Prim, base: Gf.Matrix4d) -> Vec3:
    while prim and not prim.IsPseudoRoot():
        if schema.has(prim, schema.SURFACE_VELOCITY):
            stated = Gf.Vec3d(prim.GetAttribute("wsim:surfaceVelocity").Get() or Gf.Vec3f(0.0))
            turned = Gf.Matrix4d(1.0)
            if prim.IsA(UsdGeom.Xformable):
                turned = UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(_NOW).RemoveScaleShear()
            x, y, z = base.GetInverse().TransformDir(turned.TransformDir(stated))
            return (x, y, z)
        prim = prim.GetParent()
    return (0.0, 0.0, 0.0)
