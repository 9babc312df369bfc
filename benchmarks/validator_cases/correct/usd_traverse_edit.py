"""Helpers author the scene; afterwards raw USD changes what they made."""
from pxr import Gf, Sdf, Usd, UsdGeom, UsdPhysics, UsdShade

from wsim.scene import Scene


def build(scene: Scene) -> None:
    scene.ground()
    for i in range(4):
        scene.box(f"box_{i}", size=(0.2, 0.2, 0.2), position=(0.4 * i, 0, 0.3), mass=1 + i)

    stage = scene.stage
    world = stage.GetPrimAtPath(Sdf.Path("/World"))
    for prim in Usd.PrimRange(world):
        if not prim.HasAPI(UsdPhysics.RigidBodyAPI):
            continue
        api = UsdPhysics.RigidBodyAPI(prim)
        api.CreateStartsAsleepAttr(False)
        api.GetAngularVelocityAttr().Set(Gf.Vec3f(0, 0, 90))
        mass = UsdPhysics.MassAPI(prim)
        if (value := mass.GetMassAttr().Get()) is not None and value > 2:
            mass.GetMassAttr().Set(value * 1.5)
            mass.CreateDiagonalInertiaAttr(Gf.Vec3f(0.02, 0.02, 0.02) * value)
            mass.CreatePrincipalAxesAttr(Gf.Quatf(1.0))
        for child in prim.GetChildren():
            if child.IsA(UsdGeom.Cube):
                material, _ = UsdShade.MaterialBindingAPI(child).ComputeBoundMaterial()
                friction = UsdPhysics.MaterialAPI(material.GetPrim()).GetDynamicFrictionAttr()
                friction.Set(0.2)
                print(child.GetPath(), child.GetTypeName(), friction.Get(), child.GetParent().GetName())
    last = stage.GetPrimAtPath("/World").GetChild("box_3")
    if last.IsValid() and last.HasAttribute("physics:velocity"):
        last.GetAttribute("physics:velocity").Set((0.0, 0.0, 3.0))
    scene.camera("side", eye=(0.6, -3, 1), target=(0.6, 0, 0.2))
