"""Numbers of a stage that point into arrays, and paths that point at prims: each must hit something.

USD checks few of them, and what reads them writes where they point. Messages name the attribute, the value and the
range.
"""

from __future__ import annotations

from collections.abc import Iterator

from pxr import Usd, UsdGeom, UsdSkel

from wsim.limits import MAX_CORNERS
from wsim.scene.check_arrays import as_many, first_value, sizes, steady, within
from wsim.scene.check_nurbs import curves_problems, patch_problems
from wsim.scene.check_skeletons import skeleton_problems

_SUBSETS = ("face", "point", "tetrahedron")
_PER_COPY = (
    "positions", "orientations", "orientationsf", "scales", "velocities", "angularVelocities", "accelerations", "ids"
)  # fmt: skip
_EACH = {"uniform": "faces", "vertex": "points", "varying": "points", "faceVarying": "corners"}


def check_indices(prim: Usd.Prim) -> Iterator[str]:
    """Problems of one prim."""
    if prim.IsA(UsdGeom.Mesh):
        yield from _mesh(UsdGeom.Mesh(prim))
    elif prim.IsA(UsdGeom.TetMesh):
        yield from _tets(UsdGeom.TetMesh(prim))
    elif prim.IsA(UsdGeom.Curves):
        yield from curves_problems(UsdGeom.Curves(prim))
    elif prim.IsA(UsdGeom.NurbsPatch):
        yield from patch_problems(UsdGeom.NurbsPatch(prim))
    elif prim.IsA(UsdGeom.Points):
        points = UsdGeom.Points(prim)
        yield from as_many(points.GetIdsAttr(), len(points.GetPointsAttr().Get() or ()), "points")
    elif prim.IsA(UsdGeom.PointInstancer):
        yield from _instancer(UsdGeom.PointInstancer(prim))
    elif prim.IsA(UsdGeom.Subset):
        yield from _subset(UsdGeom.Subset(prim))
    yield from skeleton_problems(prim)
    yield from steady(prim)
    if prim.IsA(UsdGeom.Imageable):
        yield from _primvars(prim)


def _mesh(mesh: UsdGeom.Mesh) -> Iterator[str]:
    topology = (mesh.GetPointsAttr(), mesh.GetFaceVertexCountsAttr(), mesh.GetFaceVertexIndicesAttr())
    for attribute in topology:
        if attribute.Get() is None:
            yield f"{attribute.GetPath()}: not given; a mesh needs points, faceVertexCounts and faceVertexIndices"
            return
    points, faces = len(topology[0].Get()), len(topology[1].Get())
    yield from sizes(topology[1], 3, len(topology[2].Get()), "faceVertexIndices")
    largest = max(topology[1].Get(), default=0)
    if largest > MAX_CORNERS:
        yield f"{topology[1].GetPath()}: a face of {largest} corners must have <= {MAX_CORNERS}"
    yield from within(topology[2], points, "points")
    yield from within(mesh.GetHoleIndicesAttr(), faces, "faces")
    yield from within(mesh.GetCornerIndicesAttr(), points, "points")
    corners = len(mesh.GetCornerIndicesAttr().Get() or ())
    yield from as_many(mesh.GetCornerSharpnessesAttr(), corners, "cornerIndices")
    yield from within(mesh.GetCreaseIndicesAttr(), points, "points")
    creases = mesh.GetCreaseIndicesAttr().Get() or ()
    yield from sizes(mesh.GetCreaseLengthsAttr(), 2, len(creases), "creaseIndices")
    lengths = len(mesh.GetCreaseLengthsAttr().Get() or ())
    sharpnesses = mesh.GetCreaseSharpnessesAttr()
    if len(sharpnesses.Get() or ()) != len(creases) - lengths:  # one for each edge of a crease, or for each crease
        yield from as_many(sharpnesses, lengths, "creaseLengths")
    yield from _normals(mesh)


def _normals(mesh: UsdGeom.Mesh) -> Iterator[str]:
    normals = mesh.GetNormalsAttr()
    if normals.HasAuthoredValue():
        interpolation = mesh.GetNormalsInterpolation()
        count, what = _elements(mesh.GetPrim(), interpolation)
        yield from as_many(normals, 1 if interpolation == "constant" else count, what)


def _tets(mesh: UsdGeom.TetMesh) -> Iterator[str]:
    points = len(mesh.GetPointsAttr().Get() or ())
    yield from within(mesh.GetTetVertexIndicesAttr(), points, "points")
    yield from within(mesh.GetSurfaceFaceVertexIndicesAttr(), points, "points")


def _instancer(instancer: UsdGeom.PointInstancer) -> Iterator[str]:
    prototypes = instancer.GetPrototypesRel().GetTargets()
    yield from within(instancer.GetProtoIndicesAttr(), len(prototypes), "prototypes")
    copies = len(instancer.GetProtoIndicesAttr().Get() or ())
    for name in _PER_COPY:
        yield from as_many(instancer.GetPrim().GetAttribute(name), copies, "protoIndices")
    positions = instancer.GetPositionsAttr()
    if copies and not first_value(positions):
        yield f"{positions.GetPath()}: 0 values; there are {copies} protoIndices"


def _subset(subset: UsdGeom.Subset) -> Iterator[str]:
    kind, parent = subset.GetElementTypeAttr().Get(), subset.GetPrim().GetParent()
    indices = subset.GetIndicesAttr()
    if kind not in _SUBSETS:  # edges and segments come in pairs; either number is below that of the points
        kind = "point"
    if kind == "face" and parent.IsA(UsdGeom.Mesh):
        yield from within(indices, len(UsdGeom.Mesh(parent).GetFaceVertexCountsAttr().Get() or ()), "faces")
    elif kind == "face" and parent.IsA(UsdGeom.TetMesh):
        faces = UsdGeom.TetMesh(parent).GetSurfaceFaceVertexIndicesAttr().Get() or ()
        yield from within(indices, len(faces), "faces")
    elif kind == "tetrahedron" and parent.IsA(UsdGeom.TetMesh):
        tets = UsdGeom.TetMesh(parent).GetTetVertexIndicesAttr().Get() or ()
        yield from within(indices, len(tets), "tetrahedra")
    elif kind == "point" and parent.IsA(UsdGeom.PointBased):
        yield from within(indices, len(UsdGeom.PointBased(parent).GetPointsAttr().Get() or ()), "points")
    elif indices.Get():
        yield f"{indices.GetPath()}: {parent.GetPath()} has no elements of the kind {kind}"


def _primvars(prim: Usd.Prim) -> Iterator[str]:
    for primvar in UsdGeom.PrimvarsAPI(prim).GetPrimvars():
        indices = primvar.GetIndicesAttr()
        if indices and indices.HasAuthoredValue() and not primvar.HasAuthoredValue():
            yield f"{indices.GetPath()}: points at nothing; {primvar.GetAttr().GetPath()} has no values"
    for primvar in UsdGeom.PrimvarsAPI(prim).GetPrimvarsWithAuthoredValues():
        attribute = primvar.GetAttr()
        size = primvar.GetElementSize()
        if size < 1:
            yield f"{attribute.GetPath()}: elementSize = {size} must be >= 1"
            continue
        values = attribute.Get()
        if values is None or not attribute.GetTypeName().isArray:
            continue
        given, stands = len(values) // size, attribute
        indices = primvar.GetIndicesAttr()
        if indices and indices.HasAuthoredValue():
            yield from within(indices, given, "values")
            given, stands = len(indices.Get() or ()), indices
        interpolation = primvar.GetInterpolation()
        if prim.IsA(UsdGeom.Mesh) and interpolation in _EACH:
            count, what = _elements(prim, interpolation)
            if given != count:
                yield f"{stands.GetPath()}: {given} values; there are {count} {what}"
        elif prim.IsA(UsdGeom.Mesh) and primvar.GetPrimvarName() == "normals" and given != 1:
            yield f"{stands.GetPath()}: {given} values; {interpolation} is one for all"
        if primvar.GetPrimvarName() == "skel:jointIndices":
            yield from within(attribute, _joints(prim), "joints")


def _joints(prim: Usd.Prim) -> int:
    """How many joints a skinned prim may point at."""
    binding = UsdSkel.BindingAPI(prim)
    own = binding.GetJointsAttr()
    skeleton = binding.GetInheritedSkeleton()
    joints = own.Get() if own and own.HasAuthoredValue() else skeleton.GetJointsAttr().Get() if skeleton else ()
    return len(joints or ())


def _elements(prim: Usd.Prim, interpolation: str) -> tuple[int, str]:
    """How many values a mesh takes, and what there is one for each of."""
    mesh = UsdGeom.Mesh(prim)
    what = _EACH.get(interpolation, "points")
    attribute = {
        "faces": mesh.GetFaceVertexCountsAttr(),
        "points": mesh.GetPointsAttr(),
        "corners": mesh.GetFaceVertexIndicesAttr(),
    }[what]
    return len(attribute.Get() or ()), what
