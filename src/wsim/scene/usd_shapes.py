"""Read a stage's geometry: Gprims as plain shapes, and what each weighs at density 1."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pxr import Gf, Usd, UsdGeom, UsdPhysics, UsdShade

from wsim.geometry.rotations import matrices, multiply
from wsim.scene.solids import solid
from wsim.scene.world import Quat, Shape, ShapeKind, Vec3

Array = NDArray[np.float64]

CONE_SIDES = 32
_TO_X = (0.0, math.sqrt(0.5), 0.0, math.sqrt(0.5))  # turns Z to X
_TO_Y = (-math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5))  # turns Z to Y


def read_shape(prim: Usd.Prim, base: Gf.Matrix4d) -> Shape | None:
    """A Gprim as a shape in the frame `base` (a rigid transform, to the world); None for what is no solid."""
    matrix = UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(Usd.TimeCode.Default()) * base.GetInverse()
    position = to_vec3(matrix.ExtractTranslation())
    turn = to_quat(matrix.RemoveScaleShear().ExtractRotationQuat())
    scale = tuple(abs(matrix.GetRow3(i).GetLength()) for i in range(3))
    found = _measure(prim, scale)
    vertices: Array | None = None
    triangles: NDArray[np.int64] | None = None
    normals: Array | None = None
    if found is None:
        mesh = _mesh(prim)
        if mesh is None:
            return None
        local, triangles, normals = mesh
        placed = np.c_[local, np.ones(len(local))] @ np.array(matrix)
        vertices = (placed[:, :3] - position) @ matrices(np.array(turn))
        if matrix.GetDeterminant() < 0.0:
            triangles = triangles[:, ::-1]
            normals = None if normals is None else normals[:, ::-1]
        if normals is not None:
            normals = _turned(normals, np.array(matrix)[:3, :3]) @ matrices(np.array(turn))
        found = ("mesh", tuple(np.ptp(vertices, axis=0).tolist()), (0.0, 0.0, 0.0, 1.0))
    kind, size, own_turn = found
    color, opacity = _look(prim)
    friction, restitution, rolling = _surface(prim)
    return Shape(
        prim=str(prim.GetPath()),
        kind=kind,
        size=size,
        position=position,
        rotation=tuple(multiply(np.array(turn), np.array(own_turn)).tolist()),
        color=color,
        opacity=opacity,
        collides=collides(prim),
        friction=friction,
        restitution=restitution,
        rolling=rolling,
        vertices=[] if vertices is None else vertices.tolist(),
        triangles=[] if triangles is None else triangles.tolist(),
        normals=[] if normals is None else normals.reshape(-1, 3).tolist(),
    )


def volume_of(prim: Usd.Prim) -> float:
    """Of a Gprim [m^3]; 0 of what is no solid."""
    matrix = UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(Usd.TimeCode.Default())
    found = _measure(prim, tuple(matrix.GetRow3(i).GetLength() for i in range(3)))
    shape = Shape(prim="", kind=found[0], size=found[1]) if found else read_shape(prim, Gf.Matrix4d(1.0))
    return solid(shape).volume if shape else 0.0


def collides(prim: Usd.Prim) -> bool:
    """Whether a prim is a collider that is switched on."""
    if not prim.HasAPI(UsdPhysics.CollisionAPI):
        return False
    return bool(UsdPhysics.CollisionAPI(prim).GetCollisionEnabledAttr().Get())


def collides_exactly(prim: Usd.Prim) -> bool:
    """Whether a static collider is the triangles of a mesh, as they are."""
    if not prim.IsA(UsdGeom.Mesh) or not collides(prim):
        return False
    return UsdPhysics.MeshCollisionAPI(prim).GetApproximationAttr().Get() in (None, UsdPhysics.Tokens.none)


def collides_as_hull(prim: Usd.Prim, *, moves: bool) -> bool:
    """Whether a mesh's convex hull collides for it: as its stage says, or where it moves and says nothing else."""
    if not prim.IsA(UsdGeom.Mesh) or not collides(prim):
        return False
    said = UsdPhysics.MeshCollisionAPI(prim).GetApproximationAttr().Get()
    return said == UsdPhysics.Tokens.convexHull or (moves and said != UsdPhysics.Tokens.convexDecomposition)


def _measure(prim: Usd.Prim, scale: tuple[float, ...]) -> tuple[ShapeKind, tuple[float, ...], Quat] | None:
    """Kind, size [m] and the turn of its Z axis, as UsdPhysics scales primitives; None for a mesh or nothing."""
    still = (0.0, 0.0, 0.0, 1.0)
    if prim.IsA(UsdGeom.Cube):
        edge = UsdGeom.Cube(prim).GetSizeAttr().Get()
        return "box", tuple(edge * s for s in scale), still
    if prim.IsA(UsdGeom.Sphere):
        return "sphere", (UsdGeom.Sphere(prim).GetRadiusAttr().Get() * max(scale),), still
    for usd, kind in ((UsdGeom.Cylinder, "cylinder"), (UsdGeom.Capsule, "capsule")):
        if prim.IsA(usd):
            gprim = usd(prim)
            along = "XYZ".index(gprim.GetAxisAttr().Get())
            across = max(s for i, s in enumerate(scale) if i != along)
            size = (gprim.GetRadiusAttr().Get() * across, gprim.GetHeightAttr().Get() * scale[along])
            return ("cylinder" if kind == "cylinder" else "capsule"), size, (_TO_X, _TO_Y, still)[along]
    if prim.IsA(UsdGeom.Plane):
        along = "XYZ".index(UsdGeom.Plane(prim).GetAxisAttr().Get())
        return "plane", (), (_TO_X, _TO_Y, still)[along]
    return None


def _turned(normals: Array, matrix: Array) -> Array:
    """Normals (F, 3, 3) under a linear map of points, as rows."""
    moved = normals @ np.linalg.inv(matrix).T
    unit: Array = moved / np.linalg.norm(moved, axis=2, keepdims=True)
    return unit


def _mesh(prim: Usd.Prim) -> tuple[Array, NDArray[np.int64], Array | None] | None:
    """Vertices, triangles and their corners' normals in the prim's own coordinates; a cone counts as a mesh."""
    if prim.IsA(UsdGeom.Cone):
        return *_cone(UsdGeom.Cone(prim)), None
    if not prim.IsA(UsdGeom.Mesh):
        return None
    mesh = UsdGeom.Mesh(prim)
    points, counts = mesh.GetPointsAttr().Get(), mesh.GetFaceVertexCountsAttr().Get()
    indices = mesh.GetFaceVertexIndicesAttr().Get()
    if not points or not counts or not indices:
        return None
    corners = np.asarray(indices, dtype=np.int64)
    sizes = np.asarray(counts, dtype=np.int64)
    starts = np.concatenate([[0], np.cumsum(sizes)[:-1]])
    fans = []
    for k in range(1, int(sizes.max()) - 1):  # the k-th triangle of each face that has one
        reaches = sizes > k + 1
        sizes, starts = sizes[reaches], starts[reaches]  # a face of many corners does not cost a look at all others
        fans.append(np.stack([starts, starts + k, starts + k + 1], axis=1))
    order = np.concatenate(fans) if fans else np.zeros((0, 3), dtype=np.int64)
    if mesh.GetOrientationAttr().Get() == UsdGeom.Tokens.leftHanded:
        order = order[:, ::-1]
    return np.asarray(points, dtype=np.float64), corners[order], _corner_normals(mesh, order, corners, len(points))


def _corner_normals(
    mesh: UsdGeom.Mesh, order: NDArray[np.int64], corners: NDArray[np.int64], points: int
) -> Array | None:
    """The normals that a mesh states at the corners of its triangles, (F, 3, 3); None where it states none."""
    given = mesh.GetNormalsAttr().Get()
    if not given:
        return None
    normals = np.asarray(given, dtype=np.float64)
    each = mesh.GetNormalsInterpolation()
    if each in (UsdGeom.Tokens.vertex, UsdGeom.Tokens.varying) and len(normals) == points:
        found = normals[corners[order]]
    elif each == UsdGeom.Tokens.faceVarying and len(normals) == len(corners):
        found = normals[order]
    else:
        return None  # one a face, or one for all: flat
    length = np.linalg.norm(found, axis=2, keepdims=True)
    return found / length if np.isfinite(length).all() and (length > 0.0).all() else None


def _cone(cone: UsdGeom.Cone) -> tuple[Array, NDArray[np.int64]]:
    r, h = cone.GetRadiusAttr().Get(), cone.GetHeightAttr().Get()
    angle = np.linspace(0.0, 2.0 * math.pi, CONE_SIDES, endpoint=False)
    ring = np.stack([r * np.cos(angle), r * np.sin(angle), np.full(CONE_SIDES, -h / 2.0)], 1)
    points = np.concatenate([ring, [[0.0, 0.0, -h / 2.0], [0.0, 0.0, h / 2.0]]])
    first = np.arange(CONE_SIDES)
    then = (first + 1) % CONE_SIDES
    bottom, top = np.full(CONE_SIDES, CONE_SIDES), np.full(CONE_SIDES, CONE_SIDES + 1)
    triangles = np.concatenate([np.stack([then, first, bottom], 1), np.stack([first, then, top], 1)])
    along = "XYZ".index(cone.GetAxisAttr().Get())
    order = {0: [2, 0, 1], 1: [1, 2, 0], 2: [0, 1, 2]}[along]
    return points[:, order], triangles.astype(np.int64)


def _look(prim: Usd.Prim) -> tuple[Vec3, float]:
    """Linear RGB and opacity of a Gprim: its material's, else its display colour."""
    material, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()
    shader = material.ComputeSurfaceSource()[0] if material else None
    color, opacity = (_input(shader, name) if shader else None for name in ("diffuseColor", "opacity"))
    if color is None:
        colors = UsdGeom.Gprim(prim).GetDisplayColorAttr().Get()
        color = colors[0] if colors else (0.7, 0.7, 0.7)
    if opacity is None:
        opacities = UsdGeom.Gprim(prim).GetDisplayOpacityAttr().Get()
        opacity = opacities[0] if opacities else 1.0
    return to_vec3(color), float(opacity)


def _input(shader: UsdShade.Shader, name: str) -> Any:
    """What a shader's input is set to; None where it is not."""
    given = shader.GetInput(name)
    return given.Get() if given else None


def _surface(prim: Usd.Prim) -> tuple[float | None, float | None, float | None]:
    """Friction, restitution and rolling resistance of the bound physics material; None where it states none."""
    material, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial("physics")
    if not material or not material.GetPrim().HasAPI(UsdPhysics.MaterialAPI):
        return None, None, None
    api = UsdPhysics.MaterialAPI(material.GetPrim())
    rolling = material.GetPrim().GetAttribute("wsim:rolling")
    friction, restitution, resistance = (
        float(attribute.Get()) if attribute and attribute.HasAuthoredValue() else None
        for attribute in (api.GetDynamicFrictionAttr(), api.GetRestitutionAttr(), rolling)
    )
    return friction, restitution, resistance


def to_vec3(vector: Gf.Vec3d) -> Vec3:
    """A USD vector as plain numbers: by their places, as its end is told by an exception."""
    return (float(vector[0]), float(vector[1]), float(vector[2]))


def to_quat(quat: Gf.Quatd) -> Quat:
    """A USD quaternion (w first) as (x, y, z, w), of length 1."""
    (x, y, z), w = to_vec3(quat.GetImaginary()), quat.GetReal()
    length = math.sqrt(x * x + y * y + z * z + w * w) or 1.0
    return (x / length, y / length, z / length, w / length)
