"""Write an asset as the catalogue's are: a USD layer of bodies, looks, colliders, anchors and joints.

/<id>            the body, or the Xform above the bodies of an articulated asset
    Looks        materials: how they look and how they rub
    visual       meshes, one a look, that do not collide
    collision    plain shapes and hulls, purpose `guide`, that no renderer shows
    <anchor>     an Xform at each named place
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pxr import Gf, Kind, Sdf, Tf, Usd, UsdGeom, UsdPhysics, UsdShade, Vt
from scipy.spatial.transform import Rotation

from wsim.intake.lattice import hull_of
from wsim.intake.model import Array, Collider, Color, Joint, Mesh
from wsim.intake.weigh import Weight
from wsim.scene.principal import principal
from wsim.scene.static_mesh import smooth_normals

KINK = np.radians(30.0)  # below it two faces stand for a curve
_MOST_SMOOTH = 60_000  # faces; normals would make a file of more three times as large
_DIGITS = 6


@dataclass(frozen=True)
class Part:
    """A body as it is written; places in the asset's frame."""

    name: str
    looks: list[Mesh]
    colliders: list[Collider]
    weight: Weight
    origin: Array
    turn: Array


def look_names(parts: list[Part]) -> dict[Color, str]:
    """A name for each colour, as a prim may be called, the largest look's first."""
    names: dict[Color, str] = {}
    meshes = sorted((mesh for part in parts for mesh in part.looks), key=lambda mesh: -len(mesh.faces))
    for mesh in meshes:
        if mesh.color not in names:
            name = Tf.MakeValidIdentifier(mesh.name or "paint")[:40]
            number, free = 2, name
            while free in names.values():
                number, free = number + 1, f"{name}_{number}"
            names[mesh.color] = free
    return names


def write_usd(
    path: Path, id: str, parts: list[Part], joints: list[Joint], anchors: dict[str, Array], friction: float
) -> None:
    """Write the layer; the anchors belong to the first part."""
    stage = Usd.Stage.CreateInMemory(f"{id}.usda")
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdPhysics.SetStageKilogramsPerUnit(stage, 1.0)
    root = UsdGeom.Xform.Define(stage, f"/{id}").GetPrim()
    stage.SetDefaultPrim(root)
    Usd.ModelAPI(root).SetKind(Kind.Tokens.component)
    UsdGeom.Scope.Define(stage, f"/{id}/Looks")
    names = look_names(parts)
    looks = {color: _material(stage, f"/{id}/Looks/{name}", color, friction) for color, name in names.items()}
    alone = len(parts) == 1
    paths = {part.name: f"/{id}" if alone else f"/{id}/{part.name}" for part in parts}
    for k, part in enumerate(parts):
        _part(stage, paths[part.name], part, names, looks, alone=alone)
        for name, at in anchors.items() if k == 0 else ():
            local = at if alone else (at - part.origin) @ part.turn
            UsdGeom.Xform.Define(stage, f"{paths[part.name]}/{name}").AddTranslateOp().Set(_vector(local))
    for joint in joints:
        _joint(stage, id, joint, {part.name: part for part in parts}, paths)
    for name in {joint.parent for joint in joints} - {joint.child for joint in joints}:
        UsdPhysics.ArticulationRootAPI.Apply(stage.GetPrimAtPath(paths[name]))
    stage.GetRootLayer().Export(str(path))


def _material(stage: Usd.Stage, path: str, color: Color, friction: float) -> UsdShade.Material:
    material = UsdShade.Material.Define(stage, path)
    shader = UsdShade.Shader.Define(stage, f"{path}/surface")
    shader.CreateIdAttr("UsdPreviewSurface")
    shader.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set(Gf.Vec3f(*color))
    shader.CreateInput("roughness", Sdf.ValueTypeNames.Float).Set(0.6)
    material.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
    physics = UsdPhysics.MaterialAPI.Apply(material.GetPrim())
    physics.CreateStaticFrictionAttr(friction)
    physics.CreateDynamicFrictionAttr(friction)
    physics.CreateRestitutionAttr(0.1)
    return material


def _part(
    stage: Usd.Stage, path: str, part: Part, names: dict[Color, str], looks: dict[Color, UsdShade.Material], *,
    alone: bool,
) -> None:  # fmt: skip
    xform = UsdGeom.Xform.Define(stage, path)
    if not alone:
        xform.AddTranslateOp().Set(_vector(part.origin))
        xform.AddOrientOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Quatd(_quat(part.turn)))
    origin, turn = (np.zeros(3), np.eye(3)) if alone else (part.origin, part.turn)
    UsdPhysics.RigidBodyAPI.Apply(xform.GetPrim())
    _mass(xform.GetPrim(), part.weight, origin, turn)
    for group in ("visual", "collision"):
        UsdGeom.Xform.Define(stage, f"{path}/{group}")
    for mesh in part.looks:
        local = mesh.moved(turn.T, -turn.T @ origin)
        prim = _mesh(stage, f"{path}/visual/{names[mesh.color]}", local, smooth=len(mesh.faces) <= _MOST_SMOOTH)
        UsdShade.MaterialBindingAPI.Apply(prim.GetPrim()).Bind(looks[mesh.color])
    main = looks[max(part.looks, key=lambda mesh: len(mesh.faces)).color] if part.looks else next(iter(looks.values()))
    for k, collider in enumerate(part.colliders):
        gprim = _collider(stage, f"{path}/collision/part_{k}", collider.moved(turn.T, -turn.T @ origin))
        gprim.CreatePurposeAttr(UsdGeom.Tokens.guide)
        UsdPhysics.CollisionAPI.Apply(gprim.GetPrim())
        UsdShade.MaterialBindingAPI.Apply(gprim.GetPrim()).Bind(main)


def _mass(prim: Usd.Prim, weight: Weight, origin: Array, turn: Array) -> None:
    moments, axes = principal(turn.T @ weight.inertia @ turn)
    api = UsdPhysics.MassAPI.Apply(prim)
    api.CreateMassAttr(weight.mass)
    api.CreateCenterOfMassAttr(Gf.Vec3f(_vector((weight.com - origin) @ turn)))
    api.CreateDiagonalInertiaAttr(Gf.Vec3f(*(float(f"{v:.6g}") for v in moments)))
    api.CreatePrincipalAxesAttr(axes)


def _mesh(stage: Usd.Stage, path: str, mesh: Mesh, *, smooth: bool = False) -> UsdGeom.Mesh:
    prim = UsdGeom.Mesh.Define(stage, path)
    points = np.round(mesh.points, _DIGITS) + 0.0
    prim.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(points.astype(np.float32)))
    prim.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(np.full(len(mesh.faces), 3, dtype=np.int32)))
    prim.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(mesh.faces.reshape(-1).astype(np.int32)))
    prim.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    prim.CreateExtentAttr(UsdGeom.PointBased.ComputeExtent(prim.GetPointsAttr().Get()))
    normals = smooth_normals(mesh.points, mesh.faces, float(KINK)) if smooth else None
    if normals is not None and np.isfinite(normals).all():
        shown = np.round(normals.reshape(-1, 3), 3).astype(np.float32)
        prim.CreateNormalsAttr(Vt.Vec3fArray.FromNumpy(shown))
        prim.SetNormalsInterpolation(UsdGeom.Tokens.faceVarying)
    return prim


def _collider(stage: Usd.Stage, path: str, shape: Collider) -> UsdGeom.Gprim:
    if shape.kind == "hull":
        hull = hull_of(shape)
        used, index = np.unique(hull.faces, return_inverse=True)
        mesh = _mesh(stage, path, Mesh("", hull.points[used], index.reshape(-1, 3)))
        UsdPhysics.MeshCollisionAPI.Apply(mesh.GetPrim()).CreateApproximationAttr(UsdPhysics.Tokens.convexHull)
        return mesh
    sizes = [float(f"{v:.6g}") for v in shape.size]
    if shape.kind == "box":
        gprim: UsdGeom.Gprim = UsdGeom.Cube.Define(stage, path)
        gprim.CreateSizeAttr(1.0)
    elif shape.kind == "sphere":
        gprim = UsdGeom.Sphere.Define(stage, path)
        gprim.CreateRadiusAttr(sizes[0])
    else:
        gprim = UsdGeom.Cylinder.Define(stage, path)
        gprim.CreateRadiusAttr(sizes[0])
        gprim.CreateHeightAttr(sizes[1])
        gprim.CreateAxisAttr(UsdGeom.Tokens.z)
    gprim.CreateExtentAttr(UsdGeom.Boundable.ComputeExtentFromPlugins(gprim, Usd.TimeCode.Default()))
    gprim.AddTranslateOp().Set(_vector(shape.center))
    if not np.allclose(shape.turn, np.eye(3), atol=1e-9):
        gprim.AddOrientOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Quatd(_quat(shape.turn)))
    if shape.kind == "box":
        gprim.AddScaleOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Vec3d(*sizes))
    return gprim


def _joint(stage: Usd.Stage, id: str, joint: Joint, parts: dict[str, Part], paths: dict[str, str]) -> None:
    path = f"/{id}/{joint.name}"
    kinds = {
        "revolute": UsdPhysics.RevoluteJoint, "prismatic": UsdPhysics.PrismaticJoint,
        "spherical": UsdPhysics.SphericalJoint,
    }  # fmt: skip
    made = kinds[joint.kind].Define(stage, path)
    frame = _frame(joint.axis)
    for end, name in ((0, joint.parent), (1, joint.child)):
        part = parts[name]
        getattr(made, f"CreateBody{end}Rel")().SetTargets([paths[name]])
        getattr(made, f"CreateLocalPos{end}Attr")(Gf.Vec3f(_vector((joint.at - part.origin) @ part.turn)))
        getattr(made, f"CreateLocalRot{end}Attr")(_quat(part.turn.T @ frame))
    if joint.kind != "spherical":
        made.CreateAxisAttr("X")
        if joint.limits is not None:
            made.CreateLowerLimitAttr(float(f"{joint.limits[0]:.6g}"))
            made.CreateUpperLimitAttr(float(f"{joint.limits[1]:.6g}"))


def _frame(axis: Array) -> Array:
    """A rotation (3, 3) that takes X to an axis."""
    x = axis / np.linalg.norm(axis)
    y = np.cross(np.eye(3)[int(np.abs(x).argmin())], x)
    y /= np.linalg.norm(y)
    return np.stack([x, y, np.cross(x, y)], axis=1)


def _quat(turn: Array) -> Gf.Quatf:
    x, y, z, w = (round(float(v), 8) + 0.0 for v in Rotation.from_matrix(turn).as_quat())
    return Gf.Quatf(w, x, y, z).GetNormalized()


def _vector(values: Array) -> Gf.Vec3d:
    return Gf.Vec3d(*(round(float(v), _DIGITS) + 0.0 for v in values))
