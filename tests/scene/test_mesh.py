from pathlib import Path

import newton
import numpy as np
import pytest
import trimesh
from pxr import UsdGeom, UsdPhysics

from wsim.scene import Scene, SceneError
from wsim.scene.check import check_stage
from wsim.scene.describe import describe


@pytest.fixture(params=["obj", "stl", "ply", "glb"])
def wedge(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """A closed wedge of 2 x 1 x 1 file units with a corner at the origin: nothing of it is symmetric."""
    points = [(0, 0, 0), (2, 0, 0), (0, 1, 0), (2, 1, 0), (0, 0, 1), (0, 1, 1)]
    mesh = trimesh.convex.convex_hull(np.array(points, dtype=float))
    path = tmp_path / f"wedge.{request.param}"
    mesh.export(path)
    return path


def test_mesh_weighs_as_newton_says(wedge: Path, tmp_path: Path) -> None:
    scene = Scene()
    scene.mesh("wedge", file=wedge, scale=0.1, density=500.0, rotation_deg=(0, 0, 30), position=(0, 0, 1))
    path = scene.save(tmp_path / "stage.usda")
    assert check_stage(path, [tmp_path]) == []
    body = describe(path).body("/World/wedge")
    assert body.volume == pytest.approx(0.1**3, rel=1e-5)
    assert body.mass == pytest.approx(0.5, rel=1e-5)
    np.testing.assert_allclose(body.com, (2 / 30, 0.05, 1 / 30), atol=1e-6)
    builder = newton.ModelBuilder()
    builder.add_usd(str(path))
    assert builder.body_mass[0] == pytest.approx(body.mass, rel=1e-4)
    np.testing.assert_allclose(np.array(builder.body_com[0]), body.com, atol=1e-5)
    inertia = np.array(builder.body_inertia[0]).reshape(3, 3)
    np.testing.assert_allclose(np.reshape(body.inertia, (3, 3)), inertia, atol=1e-4 * np.abs(inertia).max())


def test_mesh_with_y_up_is_turned_upright(wedge: Path) -> None:
    scene = Scene()
    scene.mesh("wedge", file=wedge, up_axis="Y", static=True)
    points = np.array(UsdGeom.Mesh(scene.stage.GetPrimAtPath("/World/wedge/geometry")).GetPointsAttr().Get())
    np.testing.assert_allclose(points.min(axis=0), (0, -1, 0), atol=1e-6)
    np.testing.assert_allclose(points.max(axis=0), (2, 0, 1), atol=1e-6)


@pytest.mark.parametrize(
    ("static", "asked", "expected"),
    [(False, None, "convexHull"), (True, None, "none"), (False, "convexDecomposition", "convexDecomposition")],
)
def test_collision_approximation(wedge: Path, static: bool, asked: str | None, expected: str) -> None:
    scene = Scene()
    scene.mesh("wedge", file=wedge, static=static, collision=asked)
    prim = scene.stage.GetPrimAtPath("/World/wedge/geometry")
    assert UsdPhysics.MeshCollisionAPI(prim).GetApproximationAttr().Get() == expected


def test_open_mesh_weighs_as_its_hull(tmp_path: Path) -> None:
    mesh = trimesh.creation.box(extents=(0.2, 0.4, 0.6))
    mesh.update_faces(np.arange(len(mesh.faces)) > 1)  # a side is missing
    mesh.export(tmp_path / "open.stl")
    scene = Scene()
    scene.mesh("crate", file=tmp_path / "open.stl", density=100.0)
    path = scene.save(tmp_path / "stage.usda")
    body = describe(path).body("/World/crate")
    assert body.mass == pytest.approx(100 * 0.2 * 0.4 * 0.6, rel=1e-5)
    np.testing.assert_allclose(np.reshape(body.inertia, (3, 3)), np.diag([0.52, 0.4, 0.2]) * body.mass / 12, atol=1e-6)
    builder = newton.ModelBuilder()
    builder.add_usd(str(path))
    assert builder.body_mass[0] == pytest.approx(body.mass, rel=1e-4)
    np.testing.assert_allclose(np.array(builder.body_inertia[0]).reshape(-1), body.inertia, atol=1e-5)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"scale": 1e-6}, r"mesh\(\"m\"\): scale = 1e-06 makes wedge"),
        ({"scale": 1e4}, "needs? scale=0.001|m long"),
        ({"scale": (1, 1)}, "must be one number or three"),
        ({"collision": "sdf"}, "must be one of convexHull"),
        ({"collision": "none"}, "needs static=True"),
        ({"up_axis": "X"}, 'must be "Z" or "Y"'),
    ],
)
def test_bad_mesh_options_are_named(wedge: Path, options: dict[str, object], message: str) -> None:
    with pytest.raises(SceneError, match=message):
        Scene().mesh("m", file=wedge, **options)  # type: ignore[arg-type]


def test_broken_file_is_named(tmp_path: Path) -> None:
    (tmp_path / "bad.glb").write_bytes(b"not a mesh")
    with pytest.raises(SceneError, match=r'file = ".*bad.glb" (cannot be read|holds no triangles)'):
        Scene().mesh("m", file=tmp_path / "bad.glb")


CORNERS = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
PLY = """ply
format ascii 1.0
element vertex 3
property float x
property float y
property float z
element face 1
property list uchar int vertex_indices
end_header
0 0 0
1 0 0
0 1 0
3 0 1 8
"""


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        (
            "m.obj",
            CORNERS + "f 1 2 9\n",
            r"a face names vertex 8 \(from 0\) of 4, which is not there; .*export it again",
        ),
        ("m.obj", CORNERS + "f 1 2 -9\n", r"a face names vertex -9 \(from 0\) of 4, which is not there"),
        ("m.ply", PLY, r"a face names vertex 8 \(from 0\) of 3, which is not there; mend the file"),
        ("m.ply", PLY.replace("1 8", "1 -2"), r"a face names vertex -2 \(from 0\) of 3, which is not there"),
        (
            "m.obj",
            CORNERS.replace("1 0 0", "1 0 nan") + "f 1 2 3\nf 1 2 4\n",
            r"holds 1 vertices that are not finite, such as number 1 \(from 0\), \(1.0, 0.0, nan\); export it again",
        ),
        ("m.obj", CORNERS + "f 1 2 3\n", "is flat: it has no volume that could move; static=True"),
    ],
)
@pytest.mark.filterwarnings("error")
def test_what_is_wrong_in_a_file_is_told_in_a_meshs_words(tmp_path: Path, name: str, text: str, message: str) -> None:
    (tmp_path / name).write_text(text)
    with pytest.raises(SceneError, match=message):
        Scene().mesh("m", file=tmp_path / name)
