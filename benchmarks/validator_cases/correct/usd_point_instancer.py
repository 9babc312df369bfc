"""A decorative field of instanced pebbles, no collisions, around a falling box."""
import numpy as np
from pxr import Gf, Usd, UsdGeom, Vt
from wsim.scene import Scene


def build(scene: Scene) -> None:
    scene.ground()
    scene.box('block', size=(0.3, 0.3, 0.3), position=(0, 0, 1), density=700)
    stage = scene.stage
    instancer = UsdGeom.PointInstancer.Define(stage, '/World/pebbles')
    pebble = UsdGeom.Sphere.Define(stage, '/World/pebbles/prototype')
    pebble.CreateRadiusAttr(0.02)
    pebble.CreateExtentAttr(Vt.Vec3fArray([Gf.Vec3f(-0.02), Gf.Vec3f(0.02)]))
    instancer.CreatePrototypesRel().SetTargets([pebble.GetPath()])
    xy = scene.random.uniform(-2, 2, size=(200, 2))
    xy = xy[np.hypot(xy[:, 0], xy[:, 1]) > 0.5]
    points = np.c_[xy, np.full(len(xy), 0.02)].astype(np.float32)
    instancer.CreatePositionsAttr(Vt.Vec3fArray.FromNumpy(points))
    instancer.CreateProtoIndicesAttr(Vt.IntArray(len(points), 0))
    instancer.CreateExtentAttr(UsdGeom.PointInstancer.ComputeExtentAtTime(instancer, Usd.TimeCode.Default(), Usd.TimeCode.Default()))
    scene.camera('cam', eye=(2.5, -2.5, 1.5), target=(0, 0, 0.2))
