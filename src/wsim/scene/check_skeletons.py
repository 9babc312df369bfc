"""Skeletons, their animations and blend shapes: as many transforms as joints, and no joint without its parent."""

from __future__ import annotations

from collections.abc import Iterator

from pxr import Sdf, Usd, UsdGeom, UsdSkel

from wsim.scene.check_arrays import as_many, integers, within


def skeleton_problems(prim: Usd.Prim) -> Iterator[str]:
    """Problems of one prim."""
    if prim.IsA(UsdSkel.BlendShape):
        yield from _shape(UsdSkel.BlendShape(prim))
    elif prim.IsA(UsdSkel.Skeleton):
        yield from _skeleton(UsdSkel.Skeleton(prim))
    elif prim.IsA(UsdSkel.Animation):
        yield from _animation(UsdSkel.Animation(prim))
    elif prim.IsA(UsdGeom.PointBased):
        yield from _shaped(UsdGeom.PointBased(prim))


def _shape(shape: UsdSkel.BlendShape) -> Iterator[str]:
    offsets = len(shape.GetOffsetsAttr().Get() or ())
    yield from as_many(shape.GetPointIndicesAttr(), offsets, "offsets")
    yield from as_many(shape.GetNormalOffsetsAttr(), offsets, "offsets")
    numbers = integers(shape.GetPointIndicesAttr())
    if isinstance(numbers, str):
        yield numbers
    elif numbers.size and numbers.min() < 0:
        yield f"{shape.GetPointIndicesAttr().GetPath()}: [{numbers.argmin()}] = {numbers.min()} must be >= 0"


def _shaped(points: UsdGeom.PointBased) -> Iterator[str]:
    """Blend shapes of a prim, which point at its points."""
    binding = UsdSkel.BindingAPI(points.GetPrim())
    count = len(points.GetPointsAttr().Get() or ())
    for path in binding.GetBlendShapeTargetsRel().GetTargets() if binding.GetBlendShapeTargetsRel() else ():
        shape = UsdSkel.BlendShape(points.GetPrim().GetStage().GetPrimAtPath(path))
        if shape:
            yield from within(shape.GetPointIndicesAttr(), count, f"points of <{points.GetPath()}>")
        else:
            yield f"{binding.GetBlendShapeTargetsRel().GetPath()}: <{path}> is no blend shape"


def _skeleton(skeleton: UsdSkel.Skeleton) -> Iterator[str]:
    joints = list(skeleton.GetJointsAttr().Get() or ())
    for attribute in (skeleton.GetBindTransformsAttr(), skeleton.GetRestTransformsAttr(), skeleton.GetJointNamesAttr()):
        yield from as_many(attribute, len(joints), "joints")
    seen = set()
    for joint in joints:
        if not Sdf.Path.IsValidPathString(joint)[0]:
            yield f"{skeleton.GetJointsAttr().GetPath()}: {joint!r} is no path"
            return
        parent = Sdf.Path(joint).GetParentPath().pathString
        if parent not in (".", "/", "") and parent not in seen:
            yield f"{skeleton.GetJointsAttr().GetPath()}: {joint!r} needs its parent {parent!r} before it"
        seen.add(joint)


def _animation(animation: UsdSkel.Animation) -> Iterator[str]:
    joints = len(animation.GetJointsAttr().Get() or ())
    for attribute in (animation.GetTranslationsAttr(), animation.GetRotationsAttr(), animation.GetScalesAttr()):
        yield from as_many(attribute, joints, "joints")
    shapes = len(animation.GetBlendShapesAttr().Get() or ())
    yield from as_many(animation.GetBlendShapeWeightsAttr(), shapes, "blendShapes")
