"""A wavy height field as a raw UsdGeom.Mesh collider, with balls rolling on it."""
import numpy as np
from pxr import Gf, UsdGeom, UsdPhysics, Vt

from wsim.scene import Scene

N = 25
SIZE = 3.0


def height_field(n: int, size: float) -> tuple[np.ndarray, np.ndarray]:
    axis = np.linspace(-size / 2, size / 2, n, dtype=np.float32)
    x, y = np.meshgrid(axis, axis, indexing="ij")
    z = 0.08 * np.sin(2.0 * x) * np.cos(2.5 * y) + 0.05 * x
    points = np.stack([x, y, z], axis=-1).reshape(-1, 3).astype(np.float32)
    i, j = np.meshgrid(np.arange(n - 1), np.arange(n - 1), indexing="ij")
    a = (i * n + j).ravel()
    quads = np.column_stack([a, a + n, a + n + 1, a + 1])
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    return points, triangles.astype(np.int32)


def build(scene: Scene) -> None:
    scene.simulation(duration=4.0)
    points, triangles = height_field(N, SIZE)
    mesh = UsdGeom.Mesh.Define(scene.stage, "/World/terrain")
    mesh.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(points))
    mesh.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(np.full(len(triangles), 3, dtype=np.int32)))
    mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(triangles.reshape(-1)))
    mesh.CreateSubdivisionSchemeAttr().Set(UsdGeom.Tokens.none)
    mesh.CreateExtentAttr(UsdGeom.PointBased.ComputeExtent(mesh.GetPointsAttr().Get()))
    mesh.CreateDisplayColorAttr(Vt.Vec3fArray([Gf.Vec3f(0.3, 0.4, 0.2)]))
    UsdPhysics.CollisionAPI.Apply(mesh.GetPrim())
    UsdPhysics.MeshCollisionAPI.Apply(mesh.GetPrim()).CreateApproximationAttr(UsdPhysics.Tokens.none)

    for k, x in enumerate(np.linspace(0.3, 1.2, 4)):
        scene.sphere(f"ball_{k}", radius=0.06, position=(float(x), 0.2 * k - 0.3, 0.4), density=1200.0)
    scene.camera("corner", eye=(3.0, -3.0, 2.0), target=(0.0, 0.0, 0.0))
