"""An asset in the making, and how it is written: a USD layer and its metadata.

/<id>            the body, or the Xform above the bodies of an articulated asset
    Looks        materials: how they look and how they rub
    visual       meshes, one a material, that do not collide
    collision    plain shapes, purpose `guide`, that no renderer shows
    <anchor>     an Xform at each named place
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal

import numpy as np
from pxr import Gf, Kind, Sdf, Usd, UsdGeom, UsdPhysics, UsdShade, Vt

from wsim.scene.principal import principal
from wsim.scene.usd_shapes import solid
from wsim.scene.world import Shape

from .matter import Paint
from .parts import Array, Collider, Mesh, Point

DIGITS = 5  # of a coordinate [m]: a hundredth of a millimetre, and a file that can be read
_NEARLY = 1e-3  # of the trace, beside the diagonal: a thing that is round but for its handle keeps its own axes


@dataclass
class Body:
    """A rigid body: what is seen of it, what it weighs, what of it collides.

    `origin` [m] is where its frame stands in the asset; parts are given in the asset's frame.
    """

    name: str
    origin: Point = (0.0, 0.0, 0.0)
    looks: dict[Paint, Mesh] = field(default_factory=dict)
    colliders: list[tuple[str, Collider, Paint]] = field(default_factory=list)
    anchors: dict[str, Point] = field(default_factory=dict)
    _lumps: list[tuple[Mesh, float]] = field(default_factory=list)

    def add(self, mesh: Mesh, paint: Paint, density: float | None = None, *, mass: float | None = None) -> None:
        """Show a closed mesh, and count its mass: of its paint's substance, of a density [kg/m^3] or as given [kg].

        0 is no mass.
        """
        self.looks[paint] = self.looks[paint] + mesh if paint in self.looks else mesh
        if mass is not None:
            density = mass / mesh.volume()
        self.weigh(mesh, paint.substance.density if density is None else density)

    def weigh(self, mesh: Mesh, density: float) -> None:
        """Count the mass of something that is not seen, or not as it is."""
        if density:
            self._lumps.append((mesh, density))

    def collide(self, name: str, paint: Paint, *shapes: Collider) -> None:
        """Let shapes collide with a paint's friction; several are numbered from 0."""
        for k, shape in enumerate(shapes):
            self.colliders.append((name if len(shapes) == 1 else f"{name}_{k}", shape, paint))

    def shift(self, by: Point) -> None:
        """Move the body with all that belongs to it [m]."""
        self.origin = _point(np.add(self.origin, by))
        self.looks = {paint: mesh.moved(*by) for paint, mesh in self.looks.items()}
        self.colliders = [(name, shape.moved(*by), paint) for name, shape, paint in self.colliders]
        self.anchors = {name: _point(np.add(at, by)) for name, at in self.anchors.items()}
        self._lumps = [(mesh.moved(*by), density) for mesh, density in self._lumps]

    def mass_properties(self) -> tuple[float, Array, Array]:
        """Mass [kg], its centre [m] and its inertia about that [kg m^2], in the body's frame."""
        mass, moment, about_origin = 0.0, np.zeros(3), np.zeros((3, 3))
        for mesh, density in self._lumps:
            # Closed meshes: the volume integrals of the simulator's own reader.
            shape = Shape(prim="", kind="mesh", size=(), vertices=(mesh.points - self.origin).tolist())
            part = solid(shape.model_copy(update={"triangles": mesh.triangles().tolist()}))
            mass += density * part.volume
            moment += density * part.volume * part.com
            about_origin += density * (part.inertia + part.volume * _spread(part.com))
        com = moment / mass
        rounded = float(f"{mass:.4g}")
        return rounded, com, (about_origin - mass * _spread(com)) * (rounded / mass)


def _spread(arm: Array) -> Array:
    """Inertia of a unit mass at the end of an arm (Steiner's theorem)."""
    return float(arm @ arm) * np.eye(3) - np.outer(arm, arm)


@dataclass
class Joint:
    """What ties the bodies `parent` and `child` at a point [m]: a hinge about an axis, a slider along it, or a ball.

    `limits` are in degrees of a hinge and in metres of a slider; `friction` is dry, in N m or N.
    """

    name: str
    parent: str
    child: str
    at: Point
    axis: str = "X"
    limits: tuple[float, float] | None = None
    friction: float = 0.0
    kind: Literal["Revolute", "Prismatic", "Spherical"] = "Revolute"


@dataclass
class Asset:
    """What an asset's function fills in; `names` are what people call it, `forward` what its +X side is."""

    id: str
    names: list[str]
    category: str
    description: str
    forward: str
    bodies: list[Body] = field(default_factory=list)
    joints: list[Joint] = field(default_factory=list)
    hollow: tuple[Point, Point] | None = None  # size and centre [m] of an upright box that is free

    def body(self, name: str = "", origin: Point = (0.0, 0.0, 0.0)) -> Body:
        """A new body; the only one of an asset needs no name."""
        self.bodies.append(Body(name, origin))
        return self.bodies[-1]

    def path(self, body: Body) -> str:
        """Prim path of a body."""
        return f"/{self.id}/{body.name}" if body.name else f"/{self.id}"

    def bounds(self) -> tuple[Array, Array]:
        """Lowest and highest corner of the box around what is seen [m]."""
        points = np.concatenate([_rounded(mesh.points) for body in self.bodies for mesh in body.looks.values()])
        return points.min(axis=0), points.max(axis=0)

    def center(self) -> None:
        """Put the origin at the centre of the box's bottom face, wherever the parts were drawn."""
        low, high = self.bounds()
        middle = (_short((low[0] + high[0]) / 2), _short((low[1] + high[1]) / 2), _short(low[2]))
        if not any(middle):
            return
        if self.hollow:
            self.hollow = self.hollow[0], _point(np.subtract(self.hollow[1], middle))
        if not self.joints:
            (body,) = self.bodies
            body.origin = middle
            body.anchors = {name: _point(np.subtract(at, middle)) for name, at in body.anchors.items()}
            return
        back = _point(np.negative(middle))
        for body in self.bodies:
            body.shift(back)
        self.joints = [replace(joint, at=_point(np.add(joint.at, back))) for joint in self.joints]

    def write(self, folder: Path) -> None:
        """Write asset.usda and asset.json, whole or not at all."""
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in (("asset.usda", _layer(self)), ("asset.json", _metadata(self))):
            partial = folder / f"{name}.partial"
            partial.write_text(text, encoding="utf-8")
            partial.replace(folder / name)


def _metadata(asset: Asset) -> str:
    anchors = {name: [_short(v) for v in at] for body in asset.bodies for name, at in body.anchors.items()}
    paints = {paint.name: list(paint.color) for body in asset.bodies for paint in body.looks}
    hollow = asset.hollow and {
        "size": [_short(v) for v in asset.hollow[0]],
        "center": [_short(v) for v in asset.hollow[1]],
    }
    entries = {
        "id": asset.id,
        "file": "asset.usda",
        "names": asset.names,
        "category": asset.category,
        "description": asset.description,
        "size": [_short(v) for v in np.subtract(*reversed(asset.bounds()))],
        "mass": float(f"{sum(body.mass_properties()[0] for body in asset.bodies):.6g}"),
        "up_axis": "+Z",
        "forward_axis": "+X",
        "forward": asset.forward,
        "origin": "centre of the bottom face",
        "anchors": anchors,
        "hollow": hollow,
        "articulated": bool(asset.joints),
        "colors": paints,
        "units": {"length": "m", "mass": "kg"},
        "source": "made for wsim by usd_assets/author.py",
        "license": "Apache-2.0",
    }
    return "{\n" + ",\n".join(f'  "{key}": {json.dumps(value)}' for key, value in entries.items()) + "\n}\n"


def _layer(asset: Asset) -> str:
    stage = Usd.Stage.CreateInMemory(f"{asset.id}.usda")
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdPhysics.SetStageKilogramsPerUnit(stage, 1.0)
    root = UsdGeom.Xform.Define(stage, f"/{asset.id}").GetPrim()
    stage.SetDefaultPrim(root)
    Usd.ModelAPI(root).SetKind(Kind.Tokens.component)
    UsdGeom.Scope.Define(stage, f"/{asset.id}/Looks")
    paints = {paint: None for body in asset.bodies for paint in (*body.looks, *(p for _, _, p in body.colliders))}
    materials = {paint: _material(stage, f"/{asset.id}/Looks/{paint.name}", paint) for paint in paints}
    for body in asset.bodies:
        _body(stage, asset.path(body), body, materials)
    for joint in asset.joints:
        _joint(stage, asset, joint)
    if asset.joints:
        UsdPhysics.ArticulationRootAPI.Apply(stage.GetPrimAtPath(asset.path(asset.bodies[0])))
    return str(stage.GetRootLayer().ExportToString())


def _material(stage: Usd.Stage, path: str, paint: Paint) -> UsdShade.Material:
    material = UsdShade.Material.Define(stage, path)
    shader = UsdShade.Shader.Define(stage, f"{path}/surface")
    shader.CreateIdAttr("UsdPreviewSurface")
    shader.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set(Gf.Vec3f(*paint.color))
    shader.CreateInput("roughness", Sdf.ValueTypeNames.Float).Set(paint.roughness)
    shader.CreateInput("metallic", Sdf.ValueTypeNames.Float).Set(paint.metallic)
    if paint.opacity < 1.0:
        shader.CreateInput("opacity", Sdf.ValueTypeNames.Float).Set(paint.opacity)
    material.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
    physics = UsdPhysics.MaterialAPI.Apply(material.GetPrim())
    physics.CreateStaticFrictionAttr(paint.substance.friction)
    physics.CreateDynamicFrictionAttr(paint.substance.friction)
    physics.CreateRestitutionAttr(paint.substance.restitution)
    return material


def _body(stage: Usd.Stage, path: str, body: Body, materials: dict[Paint, UsdShade.Material]) -> None:
    xform = UsdGeom.Xform.Define(stage, path)
    if body.name and any(body.origin):
        xform.AddTranslateOp().Set(Gf.Vec3d(*body.origin))
    UsdPhysics.RigidBodyAPI.Apply(xform.GetPrim())
    _author_mass(xform.GetPrim(), body)
    for group in ("visual", "collision"):
        UsdGeom.Xform.Define(stage, f"{path}/{group}")
    for paint, mesh in body.looks.items():
        prim = _mesh(stage, f"{path}/visual/{paint.name}", Mesh(mesh.points - body.origin, mesh.faces)).GetPrim()
        UsdShade.MaterialBindingAPI.Apply(prim).Bind(materials[paint])
    for name, shape, paint in body.colliders:
        gprim = _collider(stage, f"{path}/collision/{name}", shape, body.origin)
        gprim.CreatePurposeAttr(UsdGeom.Tokens.guide)
        UsdPhysics.CollisionAPI.Apply(gprim.GetPrim())
        UsdShade.MaterialBindingAPI.Apply(gprim.GetPrim()).Bind(materials[paint])
    above = body.origin if body.name else (0.0, 0.0, 0.0)  # the anchors of a lone body are in the asset's frame already
    for name, at in body.anchors.items():
        UsdGeom.Xform.Define(stage, f"{path}/{name}").AddTranslateOp().Set(_vector(np.subtract(at, above)))


def _author_mass(prim: Usd.Prim, body: Body) -> None:
    """State the mass properties of what is seen; what collides is simpler, and would weigh otherwise."""
    mass, com, inertia = body.mass_properties()
    diagonal, axes = principal(inertia, _NEARLY)
    api = UsdPhysics.MassAPI.Apply(prim)
    api.CreateMassAttr(mass)
    api.CreateCenterOfMassAttr(Gf.Vec3f(_vector(com)))
    api.CreateDiagonalInertiaAttr(Gf.Vec3f(*(float(f"{v:.5g}") for v in diagonal)))
    api.CreatePrincipalAxesAttr(axes)


def _mesh(stage: Usd.Stage, path: str, mesh: Mesh) -> UsdGeom.Mesh:
    prim = UsdGeom.Mesh.Define(stage, path)
    prim.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(_rounded(mesh.points).astype(np.float32)))
    prim.CreateFaceVertexCountsAttr([len(face) for face in mesh.faces])
    prim.CreateFaceVertexIndicesAttr([corner for face in mesh.faces for corner in face])
    prim.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    prim.CreateExtentAttr(UsdGeom.PointBased.ComputeExtent(prim.GetPointsAttr().Get()))
    return prim


def _collider(stage: Usd.Stage, path: str, shape: Collider, origin: Point) -> UsdGeom.Gprim:
    if shape.mesh is not None:
        mesh = _mesh(stage, path, Mesh(shape.mesh.points - origin, shape.mesh.faces))
        UsdPhysics.MeshCollisionAPI.Apply(mesh.GetPrim()).CreateApproximationAttr(UsdPhysics.Tokens.convexHull)
        return mesh
    gprim = getattr(UsdGeom, shape.kind).Define(stage, path)
    sizes = [_short(v) for v in shape.size]
    if shape.kind == "Cube":
        gprim.CreateSizeAttr(1.0)
    else:
        gprim.CreateRadiusAttr(sizes[0])
    if shape.kind in ("Cylinder", "Capsule"):
        gprim.CreateHeightAttr(sizes[1])
        gprim.CreateAxisAttr(UsdGeom.Tokens.z)
    gprim.CreateExtentAttr(UsdGeom.Boundable.ComputeExtentFromPlugins(gprim, Usd.TimeCode.Default()))
    gprim.AddTranslateOp().Set(_vector(np.subtract(shape.center, origin)))
    x, y, z, w = (round(v, 7) + 0.0 for v in shape.turn)
    if (x, y, z) != (0.0, 0.0, 0.0):
        gprim.AddOrientOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Quatd(w, x, y, z).GetNormalized())
    if shape.kind == "Cube":
        gprim.AddScaleOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Vec3d(*sizes))
    return gprim


def _joint(stage: Usd.Stage, asset: Asset, joint: Joint) -> None:
    ends = [next(body for body in asset.bodies if body.name == name) for name in (joint.parent, joint.child)]
    prim = getattr(UsdPhysics, f"{joint.kind}Joint").Define(stage, f"/{asset.id}/{joint.name}")
    prim.CreateBody0Rel().SetTargets([asset.path(ends[0])])
    prim.CreateBody1Rel().SetTargets([asset.path(ends[1])])
    prim.CreateLocalPos0Attr(Gf.Vec3f(_vector(np.subtract(joint.at, ends[0].origin))))
    prim.CreateLocalPos1Attr(Gf.Vec3f(_vector(np.subtract(joint.at, ends[1].origin))))
    prim.CreateLocalRot0Attr(Gf.Quatf(1.0))
    prim.CreateLocalRot1Attr(Gf.Quatf(1.0))
    prim.CreateAxisAttr(joint.axis)
    if joint.limits is not None:
        prim.CreateLowerLimitAttr(joint.limits[0])
        prim.CreateUpperLimitAttr(joint.limits[1])
    if joint.friction:
        prim.GetPrim().CreateAttribute("newton:friction", Sdf.ValueTypeNames.Float, False).Set(joint.friction)


def _rounded(points: Array) -> Array:
    return np.round(points, DIGITS) + 0.0  # no negative zeros


def _short(value: float) -> float:
    return round(float(value), DIGITS) + 0.0


def _point(values: Array) -> Point:
    return (_short(values[0]), _short(values[1]), _short(values[2]))


def _vector(values: Array) -> Gf.Vec3d:
    return Gf.Vec3d(*(_short(v) for v in values))
