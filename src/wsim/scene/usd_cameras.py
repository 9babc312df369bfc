"""Cameras of a stage, read back, and held against what a picture needs of them.

A camera below a body is fixed to it, as USD has it. One that stands elsewhere may follow a body, by `wsim:follows`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

from pxr import Gf, Usd, UsdGeom, UsdPhysics

from wsim.scene import schema
from wsim.scene.usd_prims import rigid_frame
from wsim.scene.usd_shapes import to_vec3
from wsim.scene.usd_values import targets_of, value_of
from wsim.scene.world import Camera

_WIDEST = 175.0  # [deg]
_MOST = 8192  # pixels across a film, or down


def read_camera(prim: Usd.Prim) -> Camera:
    """A camera, which was checked."""
    lens = UsdGeom.Camera(prim)
    frame = rigid_frame(prim)
    eye = frame.ExtractTranslation()
    forward = frame.TransformDir(Gf.Vec3d(0.0, 0.0, -1.0))
    target = Gf.Vec3d(value_of(prim, "target", eye))
    if Gf.Dot((target - eye).GetNormalized(), forward) < 1.0 - 1e-6:
        # No target was written, or the camera was moved since.
        target = eye + forward * (float(lens.GetFocusDistanceAttr().Get()) or 1.0)
    width, height = _pixels(prim)
    followed, above = targets_of(prim, "follows"), _carrier(prim)
    return Camera(
        prim=str(prim.GetPath()),
        eye=to_vec3(eye),
        target=to_vec3(target),
        up=to_vec3(frame.TransformDir(Gf.Vec3d(0.0, 1.0, 0.0))),
        fov=field_of_view(lens),
        width=width,
        height=height,
        follows=str(followed[0].GetPath()) if followed else above,
        turns=bool(value_of(prim, "turns", False)) if followed else above is not None,
        fixed=bool(value_of(prim, "fixed", False)) or above is not None,
    )


def _pixels(prim: Usd.Prim) -> tuple[int, int]:
    """Width and height of a picture; where no height is stated, the lens's."""
    lens, width = UsdGeom.Camera(prim), int(value_of(prim, "width", 640))
    across, down = lens.GetHorizontalApertureAttr().Get(), lens.GetVerticalApertureAttr().Get()
    return width, int(value_of(prim, "height", round(width * down / across) if across > 0.0 else 0))


def _carrier(prim: Usd.Prim) -> str | None:
    """Path of the body that a camera is fixed to: the nearest above it, from where no `!resetXformStack!` parts it."""
    each = prim
    while each and not each.IsPseudoRoot():
        if each.HasAPI(UsdPhysics.RigidBodyAPI):
            return str(each.GetPath())
        if each.IsA(UsdGeom.Xformable) and UsdGeom.Xformable(each).GetResetXformStack():
            return None
        each = each.GetParent()
    return None


def field_of_view(lens: UsdGeom.Camera) -> float:
    """From left to right [deg]."""
    across = lens.GetHorizontalApertureAttr().Get()
    return math.degrees(2.0 * math.atan(across / 2.0 / lens.GetFocalLengthAttr().Get()))


def is_view(prim: Usd.Prim) -> bool:
    """Whether a prim is a camera that films; others are sensors."""
    return bool(prim.IsA(UsdGeom.Camera)) and not schema.has(prim, schema.SENSOR_CAMERA)


def camera_problems(prims: Iterable[Usd.Prim]) -> Iterator[str]:
    """Problems of the cameras among a stage's prims: their lenses, and what they follow."""
    for prim in prims:
        if not prim.IsA(UsdGeom.Camera):
            continue
        lens = UsdGeom.Camera(prim)
        across, length = lens.GetHorizontalApertureAttr().Get(), lens.GetFocalLengthAttr().Get()
        if not (across > 0.0 and length > 0.0 and field_of_view(lens) <= _WIDEST):
            said = f"{length:g} of an aperture of {across:g} must see at most {_WIDEST:g} deg"
            yield f"{prim.GetPath()}.focalLength: {said}"
        if not is_view(prim):
            continue
        if across > 0.0 and not all(1 <= each <= _MOST for each in _pixels(prim)):
            width, height = _pixels(prim)
            yield f"{prim.GetPath()}.wsim:width: {width} by {height} pixels must be 1 to {_MOST} each"
        followed, above = targets_of(prim, "follows"), _carrier(prim)
        if len(followed) > 1:
            yield f"{prim.GetPath()}.wsim:follows: it names {len(followed)} bodies; name one"
        if followed and above is not None:
            yield f"{prim.GetPath()}.wsim:follows: the camera is below <{above}>, and moves with it; take one away"
        if value_of(prim, "turns", False) and not followed:
            yield f"{prim.GetPath()}.wsim:turns: it needs wsim:follows, the body that the camera turns with"
