"""Whatever points into an array or at a prim is refused where it points past it; the rest Newton imports."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pxr import Gf, Sdf, Usd, UsdGeom, UsdPhysics, UsdShade, UsdSkel, Vt

from wsim.scene import Scene
from wsim.scene.articulation import mark_articulations
from wsim.scene.check import check_stage
from wsim.scene.check_indices import check_indices

POINTS = [(0.0, 0.0, 2.0), (1.0, 0.0, 2.0), (0.0, 1.0, 2.0), (0.0, 0.0, 3.0)]
COUNTS = [3, 3, 3, 3]
INDICES = [0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3]
MESH = "/World/thing/geometry"
Spoil = Callable[[UsdGeom.Mesh], object]


@pytest.fixture
def mesh(tmp_path: Path) -> Iterator[UsdGeom.Mesh]:
    scene = Scene()
    scene.ground()
    scene.box("block", size=(0.2, 0.2, 0.2), position=(0.0, 0.0, 1.0), density=500.0)
    stage = Usd.Stage.Open(str(scene.save(tmp_path / "stage.usda")))
    yield _tetrahedron(stage)
    assert stage  # it lives as long as its mesh is used


def _tetrahedron(stage: Usd.Stage) -> UsdGeom.Mesh:
    UsdPhysics.RigidBodyAPI.Apply(UsdGeom.Xform.Define(stage, "/World/thing").GetPrim())
    mesh = UsdGeom.Mesh.Define(stage, MESH)
    UsdPhysics.CollisionAPI.Apply(mesh.GetPrim())
    UsdPhysics.MeshCollisionAPI.Apply(mesh.GetPrim()).CreateApproximationAttr("convexHull")
    mesh.CreatePointsAttr(POINTS)
    mesh.CreateFaceVertexCountsAttr(COUNTS)
    mesh.CreateFaceVertexIndicesAttr(INDICES)
    return mesh


def _check(mesh: UsdGeom.Mesh, folder: Path) -> list[str]:
    path = folder / "spoilt.usda"
    mesh.GetPrim().GetStage().GetRootLayer().Export(str(path))
    return check_stage(path, [folder])


def _set(name: str, *value: object, at: str = MESH) -> Spoil:
    """Set an attribute of the mesh, or of another prim, at the default time or at another."""

    def spoil(mesh: UsdGeom.Mesh) -> None:
        attribute = mesh.GetPrim().GetStage().GetPrimAtPath(at).GetAttribute(name)
        assert attribute, name
        attribute.Set(*value)

    return spoil


def _primvar(name: str, kind: Sdf.ValueTypeName, interpolation: str, values: object, indices: object = None) -> Spoil:
    def spoil(mesh: UsdGeom.Mesh) -> None:
        primvar = UsdGeom.PrimvarsAPI(mesh).CreatePrimvar(name, kind, interpolation)
        primvar.Set(values)
        if indices is not None:
            primvar.SetIndices(Vt.IntArray(indices))

    return spoil


def _subset(kind: str, indices: list[int]) -> Spoil:
    return lambda mesh: (
        UsdGeom.Subset.Define(mesh.GetPrim().GetStage(), f"{MESH}/part").CreateIndicesAttr(indices)
        and UsdGeom.Subset.Get(mesh.GetPrim().GetStage(), f"{MESH}/part").CreateElementTypeAttr(kind)
    )


def _other(kind: str, **values: object) -> Spoil:
    """A prim of another type beside the mesh."""

    def spoil(mesh: UsdGeom.Mesh) -> None:
        prim = mesh.GetPrim().GetStage().DefinePrim("/World/other", kind)
        for name, value in values.items():
            attribute, relation = prim.GetAttribute(name), prim.GetRelationship(name)
            assert attribute or relation, name
            attribute.Set(value) if attribute else relation.SetTargets(value)

    return spoil


def _joint(first: str, second: str) -> Spoil:
    def spoil(mesh: UsdGeom.Mesh) -> None:
        joint = UsdPhysics.FixedJoint.Define(mesh.GetPrim().GetStage(), "/World/joint")
        joint.CreateBody0Rel().SetTargets([first])
        joint.CreateBody1Rel().SetTargets([second])

    return spoil


def _pairs(*paths: str) -> Spoil:
    return lambda mesh: (
        UsdPhysics.FilteredPairsAPI.Apply(mesh.GetPrim()).CreateFilteredPairsRel().SetTargets(list(paths))
    )


def _joints_of_a_skeleton(mesh: UsdGeom.Mesh) -> None:
    binding = UsdSkel.BindingAPI.Apply(mesh.GetPrim())
    binding.CreateJointsAttr(["hip", "hip/knee"])
    binding.CreateJointIndicesPrimvar(constant=False, elementSize=1).Set([0, 1, 2, 0])


def _later(name: str, default: object, sample: object) -> Spoil:
    def spoil(mesh: UsdGeom.Mesh) -> None:
        mesh.GetPrim().GetAttribute(name).Set(default)
        mesh.GetPrim().GetAttribute(name).Set(sample, 1.0)

    return spoil


def _indices_of_no_values(mesh: UsdGeom.Mesh) -> None:
    UsdGeom.PrimvarsAPI(mesh).CreatePrimvar("st", PAIRS, "vertex").SetIndices(Vt.IntArray([0, 0, 0, 0]))


def _connected(*targets: str) -> Spoil:
    def spoil(mesh: UsdGeom.Mesh) -> None:
        material = UsdShade.Material.Define(mesh.GetPrim().GetStage(), "/World/look")
        material.CreateSurfaceOutput().GetAttr().SetConnections([Sdf.Path(target) for target in targets])

    return spoil


def _in_a_ring(mesh: UsdGeom.Mesh) -> None:
    stage = mesh.GetPrim().GetStage()
    for name, other in (("one", "other"), ("other", "one")):
        node = UsdShade.NodeGraph.Define(stage, f"/World/{name}")
        node.CreateOutput("out", Sdf.ValueTypeNames.Float).GetAttr().SetConnections([f"/World/{other}.outputs:out"])


def _blend_shape_beyond(mesh: UsdGeom.Mesh) -> None:
    _other("BlendShape", offsets=SQUARE[:1], pointIndices=[4])(mesh)
    binding = UsdSkel.BindingAPI.Apply(mesh.GetPrim())
    binding.CreateBlendShapesAttr(["smile"])
    binding.CreateBlendShapeTargetsRel().SetTargets(["/World/other"])


def _trimmed(**trim: object) -> Spoil:
    values = {f"trimCurve:{name}": value for name, value in trim.items()}
    return _other("NurbsPatch", **PATCH, **values)


def _retyped(mesh: UsdGeom.Mesh) -> None:
    mesh.GetPrim().RemoveProperty("faceVertexIndices")
    spec = mesh.GetPrim().GetStage().GetRootLayer().GetPrimAtPath(MESH)
    retyped = Sdf.AttributeSpec(spec, "faceVertexIndices", Sdf.ValueTypeNames.FloatArray)
    retyped.default = Vt.FloatArray([float(i) for i in INDICES])


COLORS, PAIRS = Sdf.ValueTypeNames.Color3fArray, Sdf.ValueTypeNames.TexCoord2fArray
VECTORS = Sdf.ValueTypeNames.Normal3fArray
SQUARE = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)]
PATCH = {
    "points": SQUARE, "uVertexCount": 2, "vVertexCount": 2, "uOrder": 2, "vOrder": 2,
    "uKnots": [0.0, 0.0, 1.0, 1.0], "vKnots": [0.0, 0.0, 1.0, 1.0],
}  # fmt: skip
TRIM = {
    "counts": [1], "vertexCounts": [3], "orders": [2], "knots": [0.0, 0.0, 1.0, 2.0, 2.0], "ranges": [(0.0, 2.0)],
    "points": SQUARE[:3],
}  # fmt: skip
CURVE = {"points": SQUARE, "curveVertexCounts": [4], "order": [2], "knots": [0.0, 0.0, 1.0, 2.0, 3.0, 3.0]}
COPIES = {"positions": SQUARE, "protoIndices": [0, 0, 0, 0], "prototypes": ["/World/block"]}
BONES = {
    "joints": ["hip", "hip/knee"],
    "bindTransforms": [Gf.Matrix4d(1.0)] * 2,
    "restTransforms": [Gf.Matrix4d(1.0)] * 2,
}
SPOILT: list[tuple[Spoil, str]] = [
    (_set("faceVertexIndices", [*INDICES[:-1], 4]), "faceVertexIndices: [11] = 4 must be 0 to 3; there are 4 points"),
    (_set("faceVertexIndices", [-1, *INDICES[1:]]), "faceVertexIndices: [0] = -1 must be 0 to 3; there are 4 points"),
    (_set("faceVertexIndices", [2**31 - 1, *INDICES[1:]]), "faceVertexIndices: [0] = 2147483647 must be 0 to 3"),
    (_set("faceVertexIndices", INDICES, 1.0), "faceVertexIndices: must not change over time"),
    (_retyped, "faceVertexIndices: float32 numbers; they must be whole"),
    (_set("faceVertexCounts", [3, 3, 3, 4]), "faceVertexCounts: their sum is 13; there are 12 faceVertexIndices"),
    (_set("faceVertexCounts", [3, 3]), "faceVertexCounts: their sum is 6; there are 12 faceVertexIndices"),
    (_set("faceVertexCounts", [3, 3, 3, 3, -3, 3]), "faceVertexCounts: [4] = -3 must be >= 3"),
    (_set("faceVertexCounts", [2, 4, 3, 3]), "faceVertexCounts: [0] = 2 must be >= 3"),
    (_set("faceVertexCounts", [2**31 - 1] * 2 + [2, 12]), "faceVertexCounts: [2] = 2 must be >= 3"),
    (_set("faceVertexCounts", [2**31 - 1] * 2 + [14]), "faceVertexCounts: their sum is 4294967308; there are 12"),
    (_set("faceVertexCounts", [10_001]), "faceVertexCounts: a face of 10001 corners must have <= 10000"),
    (_set("points", POINTS[:3]), "faceVertexIndices: [5] = 3 must be 0 to 2; there are 3 points"),
    (_set("points", [(1e30, y, z) for _, y, z in POINTS]), ".points: 1e+30 m must be within 10000 m of the origin"),
    (lambda mesh: mesh.GetPointsAttr().Clear(), ".points: not given; a mesh needs points, faceVertexCounts and"),
    (lambda mesh: mesh.GetFaceVertexIndicesAttr().Clear(), ".faceVertexIndices: not given; a mesh needs"),
    (_set("holeIndices", [0, 4]), "holeIndices: [1] = 4 must be 0 to 3; there are 4 faces"),
    (_set("cornerIndices", [4]), "cornerIndices: [0] = 4 must be 0 to 3; there are 4 points"),
    (_set("cornerSharpnesses", [1.0]), "cornerSharpnesses: 1 values; there are 0 cornerIndices"),
    (_set("creaseIndices", [0, 9]), "creaseIndices: [1] = 9 must be 0 to 3; there are 4 points"),
    (_set("creaseLengths", [2]), "creaseLengths: their sum is 2; there are 0 creaseIndices"),
    (_set("creaseSharpnesses", [1.0]), "creaseSharpnesses: 1 values; there are 0 creaseLengths"),
    (_set("normals", [(0.0, 0.0, 1.0)] * 3), "normals: 3 values; there are 4 points"),
    (_primvar("normals", VECTORS, "constant", SQUARE), "primvars:normals: 4 values; constant is one for all"),
    (
        _primvar("st", PAIRS, "faceVarying", [(0, 0)], [5] * 12),
        "st:indices: [0] = 5 must be 0 to 0; there are 1 values",
    ),
    (_primvar("st", PAIRS, "vertex", [(0, 0)] * 4, [0, 1, 2, -1]), "st:indices: [3] = -1 must be 0 to 3"),
    (_primvar("st", PAIRS, "vertex", [(0, 0)] * 3), "primvars:st: 3 values; there are 4 points"),
    (_primvar("st", PAIRS, "faceVarying", [(0, 0)] * 2, [0] * 11), "st:indices: 11 values; there are 12 corners"),
    (_primvar("displayColor", COLORS, "uniform", [(1, 0, 0)], [1] * 4), "displayColor:indices: [0] = 1 must be 0 to 0"),
    (_subset("face", [4]), "part.indices: [0] = 4 must be 0 to 3; there are 4 faces"),
    (_subset("point", [-1]), "part.indices: [0] = -1 must be 0 to 3; there are 4 points"),
    (_subset("edge", [0, 4]), "part.indices: [1] = 4 must be 0 to 3; there are 4 points"),
    (_subset("tetrahedron", [0]), "part.indices: /World/thing/geometry has no elements of the kind tetrahedron"),
    (_joints_of_a_skeleton, "skel:jointIndices: [2] = 2 must be 0 to 1; there are 2 joints"),
    (_other("Points", points=SQUARE, ids=[1, 2]), "other.ids: 2 values; there are 4 points"),
    (_other("TetMesh", points=SQUARE, tetVertexIndices=[Gf.Vec4i(0, 1, 2, 4)]), "tetVertexIndices: [3] = 4 must be"),
    (
        _other("TetMesh", points=SQUARE, surfaceFaceVertexIndices=[Gf.Vec3i(0, 1, -2)]),
        "surfaceFaceVertexIndices: [2] = -2 must be",
    ),
    (_other("BasisCurves", points=SQUARE, curveVertexCounts=[5]), "curveVertexCounts: their sum is 5; there are 4"),
    (_other("BasisCurves", points=SQUARE, curveVertexCounts=[8, -4]), "curveVertexCounts: [1] = -4 must be >= 2"),
    (_other("NurbsPatch", points=SQUARE, uVertexCount=3, vVertexCount=3), "3 by 3 vertices; there are 4 points"),
    (
        _other("PointInstancer", positions=SQUARE, protoIndices=[0, 0, 0, 1], prototypes=["/World/block"]),
        "protoIndices: [3] = 1 must be 0 to 0; there are 1 prototypes",
    ),
    (
        _other("PointInstancer", positions=SQUARE, protoIndices=[0], prototypes=["/World/block"]),
        "positions: 4 values; there are 1 protoIndices",
    ),
    (_other("BlendShape", offsets=SQUARE, pointIndices=[0]), "pointIndices: 1 values; there are 4 offsets"),
    (_other("BlendShape", offsets=SQUARE[:1], pointIndices=[-1]), "pointIndices: [0] = -1 must be >= 0"),
    (_blend_shape_beyond, "pointIndices: [0] = 4 must be 0 to 3; there are 4 points of </World/thing/geometry>"),
    (_other("NurbsCurves", **{**CURVE, "order": [99]}), "order: [0] = 99 must be 2 to 4; the curve has 4 vertices"),
    (_other("NurbsCurves", **{**CURVE, "order": [2, 2]}), "order: 2 values; there are 1 curves"),
    (_other("NurbsCurves", **{**CURVE, "knots": [0.0, 1.0]}), "knots: 2 values; vertices and orders ask for 6"),
    (_other("NurbsCurves", **CURVE, ranges=[(0, 1), (0, 1)]), "ranges: 2 values; there are 1 curves"),
    (_other("NurbsPatch", **{**PATCH, "uOrder": 9}), "uOrder: 9 must be 2 to 2; there are 2 vertices"),
    (_other("NurbsPatch", **{**PATCH, "vOrder": -1}), "vOrder: -1 must be 2 to 2"),
    (_other("NurbsPatch", **{**PATCH, "vKnots": [0.0]}), "vKnots: 1 values; vertices and order ask for 4"),
    (_trimmed(**{**TRIM, "counts": [2]}), "trimCurve:counts: their sum is 2; there are 1 trimCurve:vertexCounts"),
    (_trimmed(**{**TRIM, "vertexCounts": [4]}), "trimCurve:vertexCounts: their sum is 4; there are 3 trimCurve:points"),
    (_trimmed(**{**TRIM, "orders": [7]}), "trimCurve:orders: [0] = 7 must be 2 to 3"),
    (_other("PointInstancer", **{**COPIES, "prototypes": ["/World/no"]}), "other.prototypes: </World/no> is not there"),
    (
        _other("PointInstancer", **{**COPIES, "prototypes": ["/World/other"]}),
        "</World/other> is or holds the instancer",
    ),
    (_other("PointInstancer", **{**COPIES, "prototypes": ["/World"]}), "</World> is or holds the instancer"),
    (_other("PointInstancer", **{**COPIES, "positions": []}), "positions: 0 values; there are 4 protoIndices"),
    (
        _other("PointInstancer", **COPIES, orientations=[Gf.Quath(1)]),
        "orientations: 1 values; there are 4 protoIndices",
    ),
    (_other("PointInstancer", **COPIES, orientationsf=[Gf.Quatf(1)]), "orientationsf: 1 values; there are 4"),
    (
        _other("Skeleton", **{**BONES, "bindTransforms": [Gf.Matrix4d(1.0)]}),
        "bindTransforms: 1 values; there are 2 joints",
    ),
    (
        _other("Skeleton", **{**BONES, "joints": ["hip", "arm/hand"]}),
        "joints: 'arm/hand' needs its parent 'arm' before",
    ),
    (
        _other("SkelAnimation", joints=["hip"], translations=SQUARE),
        "other.translations: 4 values; there are 1 joints",
    ),
    (_other("SkelAnimation", blendShapes=["smile"], blendShapeWeights=[1.0, 0.0]), "there are 1 blendShapes"),
    (_indices_of_no_values, "st:indices: points at nothing; /World/thing/geometry.primvars:st has no values"),
    (_later("points", POINTS, POINTS[:1]), ".points: 1 values at time 1; there are 4 before it"),
    (_connected("/World/nowhere.outputs:surface"), "outputs:surface.connect: </World/nowhere.outputs:surface> is not"),
    (_connected("/World/look.outputs:surface"), "/World/look.outputs:surface.connect: comes back to itself"),
    (_in_a_ring, "/World/one.outputs:out.connect: comes back to itself"),
    (
        lambda mesh: mesh.CreateXformOpOrderAttr(["xformOp:translate:gone"]),
        "geometry.xformOpOrder: 'xformOp:translate:gone' is not there",
    ),
    (_other("PhysicsAttachment"), "/World/other: PhysicsAttachment is not supported"),
    (
        _joint("/World/block", "/World/block/geometry"),
        "joint.physics:body1: </World/block> is at the joint's other end",
    ),
    (_joint("/World/block", "/World/nowhere"), "joint.physics:body1: </World/nowhere> is not there"),
    (_pairs("/World/nowhere"), "physics:filteredPairs: </World/nowhere> is not there"),
    (_pairs("/World/PhysicsScene"), "</World/PhysicsScene> is a PhysicsScene; it must be a rigid body, a collider"),
]


@pytest.mark.parametrize(("spoil", "message"), SPOILT, ids=[message for _, message in SPOILT])
def test_what_points_past_its_array_is_named(mesh: UsdGeom.Mesh, tmp_path: Path, spoil: Spoil, message: str) -> None:
    assert _check(mesh, tmp_path) == []
    spoil(mesh)
    problems = _check(mesh, tmp_path)
    assert any(message in problem for problem in problems), problems


FITTING = {
    "curves": _other("NurbsCurves", **CURVE, ranges=[(0.0, 3.0)]),
    "patch": _trimmed(**TRIM),
    "copies": _other("PointInstancer", **COPIES, orientationsf=[Gf.Quatf(1)] * 4),
    "bones": _other("Skeleton", **BONES),
    "motion": _other("SkelAnimation", joints=["hip", "hip/knee"], translations=SQUARE[:2]),
    "points that move": _later("points", POINTS, POINTS[::-1]),
}


@pytest.mark.parametrize("fit", FITTING.values(), ids=FITTING.keys())
def test_what_fits_is_taken(mesh: UsdGeom.Mesh, tmp_path: Path, fit: Spoil) -> None:
    fit(mesh)
    assert _check(mesh, tmp_path) == []


def test_what_points_into_its_array_is_taken(mesh: UsdGeom.Mesh, tmp_path: Path) -> None:
    for spoil in (
        _primvar("st", PAIRS, "faceVarying", [(0, 0), (1, 1)], [0, 1] * 6),
        _primvar("displayColor", COLORS, "constant", [(1, 0, 0)]),
        _set("holeIndices", [3]),
        _set("cornerIndices", [3]),
        _set("cornerSharpnesses", [1.0]),
        _set("creaseIndices", [0, 1, 2]),
        _set("creaseLengths", [3]),
        _set("creaseSharpnesses", [1.0, 2.0]),
        _subset("point", [0, 3]),
        _pairs("/World/block"),
        _joint("/World/block", MESH),
    ):
        spoil(mesh)
    mark_articulations(mesh.GetPrim().GetStage())
    assert _check(mesh, tmp_path) == []


SMALL = st.integers(-2, 6)


@given(counts=st.lists(SMALL, max_size=6), indices=st.lists(SMALL, max_size=20), points=st.integers(0, 6))
@settings(max_examples=500, deadline=None)
def test_a_topology_is_refused_where_usd_calls_it_invalid(counts: list[int], indices: list[int], points: int) -> None:
    stage = Usd.Stage.CreateInMemory()
    mesh = UsdGeom.Mesh.Define(stage, "/mesh")
    mesh.CreatePointsAttr([(float(i), 0.0, 0.0) for i in range(points)])
    mesh.CreateFaceVertexCountsAttr(counts)
    mesh.CreateFaceVertexIndicesAttr(indices)
    valid, _ = UsdGeom.Mesh.ValidateTopology(Vt.IntArray(indices), Vt.IntArray(counts), points)
    assert (list(check_indices(mesh.GetPrim())) == []) == (valid and all(count >= 3 for count in counts))


IMPORT = """
import sys, warnings
import newton
from pathlib import Path
from wsim.scene.describe import describe
from wsim.sim.model import build_model
for name in sys.argv[1:]:
    print(name, flush=True)  # the last name is the one that crashed
    build_model(Path(name), describe(Path(name)), "cpu")
print("all of them")
"""
NAMES = ("faceVertexIndices", "faceVertexCounts", "holeIndices", "creaseIndices", "creaseLengths", "cornerIndices")


def _mutate(mesh: UsdGeom.Mesh, random: np.random.Generator) -> None:
    """One to three small changes of the mesh's arrays of whole numbers."""
    indexed = _primvar("st", PAIRS, "faceVarying", [(0, 0), (1, 0), (0, 1), (1, 1)], INDICES)
    indexed(mesh)
    for _ in range(random.integers(1, 4)):
        name = str(random.choice([*NAMES, "primvars:st:indices", "approximation", "subdivisionScheme", "orientation"]))
        if name == "approximation":
            choice = str(
                random.choice(["none", "convexHull", "convexDecomposition", "boundingCube", "meshSimplification"])
            )
            UsdPhysics.MeshCollisionAPI(mesh).GetApproximationAttr().Set(choice)
            continue
        if name == "subdivisionScheme":
            mesh.CreateSubdivisionSchemeAttr(str(random.choice(["none", "catmullClark", "bilinear"])))
            continue
        if name == "orientation":
            mesh.CreateOrientationAttr(str(random.choice(["leftHanded", "rightHanded"])))
            continue
        attribute = mesh.GetPrim().GetAttribute(name)
        values = list(attribute.Get() or [])
        kind = random.integers(4)
        if kind == 0 or not values:
            values.insert(random.integers(len(values) + 1), int(random.integers(-1, 5)))
        elif kind == 1:
            del values[random.integers(len(values))]
        elif kind == 2:
            values[random.integers(len(values))] = int(random.choice([-(2**31), -1, 0, 1, 2, 3, 4, 5, 100, 2**31 - 1]))
        else:
            random.shuffle(values)
        attribute.Set(values)


def test_newton_imports_what_passes(mesh: UsdGeom.Mesh, tmp_path: Path) -> None:
    stage = mesh.GetPrim().GetStage()
    taken = []
    for seed in range(120):
        stage.Reload()
        changed = _tetrahedron(stage)
        _mutate(changed, np.random.default_rng(seed))
        path = tmp_path / f"{seed}.usda"
        stage.GetRootLayer().Export(str(path))
        if not check_stage(path, [tmp_path]):
            taken.append(str(path))
    assert 5 < len(taken) < 100
    done = subprocess.run(
        [sys.executable, "-c", IMPORT, *taken], capture_output=True, text=True, timeout=300, check=False
    )
    assert (done.returncode, done.stdout.splitlines()[-1:]) == (0, ["all of them"]), done.stdout[-300:] + done.stderr
