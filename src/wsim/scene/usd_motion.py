"""Read what a stage says of motion that is stated, not worked out: surfaces that move as belts do, and paths."""

from __future__ import annotations

import numpy as np
from pxr import Gf, Usd, UsdGeom, UsdPhysics

from wsim.geometry.paths import Curve
from wsim.scene import schema
from wsim.scene.usd_shapes import to_quat, to_vec3
from wsim.scene.world import Path, Shape, Vec3

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


def path_of(prim: Usd.Prim) -> Path | None:
    """The path of a kinematic body: its key frames, or the time samples of its transform, which USD's tools write."""
    if not UsdPhysics.RigidBodyAPI(prim).GetKinematicEnabledAttr().Get():
        return None
    if schema.has(prim, schema.PATH):
        times, places, turns, repeat = (
            prim.GetAttribute(f"wsim:{name}").Get() for name in ("times", "positions", "rotations", "repeat")
        )
        return Path(
            times=list(times or ()),
            positions=[to_vec3(place) for place in places or ()],
            rotations=[to_quat(turn) for turn in turns or ()],
            repeat=bool(repeat),
        )
    codes = sample_times(prim)
    if len(codes) < 2:
        return None
    rate = prim.GetStage().GetTimeCodesPerSecond()
    frames = [
        UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(Usd.TimeCode(code)).RemoveScaleShear() for code in codes
    ]
    return Path(
        times=[code / rate for code in codes],
        positions=[to_vec3(frame.ExtractTranslation()) for frame in frames],
        rotations=[to_quat(frame.ExtractRotationQuat()) for frame in frames],
    )


def sample_times(prim: Usd.Prim) -> list[float]:
    """The time codes at which a prim's transform, or one above it, has samples."""
    codes: set[float] = set()
    while prim and prim.IsA(UsdGeom.Xformable):
        codes |= set(UsdGeom.Xformable(prim).GetTimeSamples())
        prim = prim.GetParent()
    return sorted(codes)


def curve_of(path: Path) -> Curve:
    """The motion through a path's key frames."""
    return Curve.through(path.times, np.array(path.positions), np.array(path.rotations), path.repeat)
