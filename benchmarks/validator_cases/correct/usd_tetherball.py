"""A tetherball on a raw prismatic and spherical pair, and a filtered pair of plates."""
from pxr import Gf, UsdGeom, UsdPhysics
import pxr.Sdf as Sdf
from wsim.scene import Scene

def build(scene: Scene) -> None:
    scene.ground()
    pole = scene.cylinder("pole", radius=0.04, height=2.0, position=(0, 0, 1.0), static=True)
    ball = scene.sphere("ball", radius=0.1, position=(0.8, 0, 1.2), density=150, velocity=(0, 2.0, 0))
    tether = UsdPhysics.SphericalJoint.Define(scene.stage, Sdf.Path("/World/tether"))
    tether.CreateAxisAttr("X")
    tether.CreateBody1Rel().SetTargets([Sdf.Path(ball.path)])
    tether.CreateLocalPos0Attr().Set(Gf.Vec3f(0, 0, 1.9))
    tether.CreateLocalRot0Attr().Set(Gf.Quatf(1.0, Gf.Vec3f(0.0)))
    tether.CreateLocalPos1Attr().Set(Gf.Vec3f(-0.8, 0, 0.7))
    tether.CreateLocalRot1Attr().Set(Gf.Quatf.GetIdentity())
    tether.CreateConeAngle0LimitAttr(80.0)
    tether.CreateCollisionEnabledAttr(True)
    rope = UsdGeom.BasisCurves.Define(scene.stage, "/World/rope_look")
    rope.CreateTypeAttr(UsdGeom.Tokens.linear)
    rope.CreateCurveVertexCountsAttr([2])
    rope.CreatePointsAttr([Gf.Vec3f(0, 0, 1.9), Gf.Vec3f(0.8, 0, 1.2)])
    rope.CreateWidthsAttr([0.01])
    rope.CreateExtentAttr([(0, 0, 1.2), (0.8, 0, 1.9)])
    UsdGeom.Imageable(rope).CreateVisibilityAttr(UsdGeom.Tokens.invisible)
    UsdGeom.Imageable(rope.GetPrim()).CreatePurposeAttr("guide")
    scene.camera("side", eye=(0, -4, 1.5), target=(0, 0, 1)); print(pole)
