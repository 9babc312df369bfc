"""A preview-surface material built by hand and bound to a helper's geometry."""
from pxr import Gf, Sdf, UsdGeom, UsdPhysics, UsdShade

from wsim.scene import Scene

LOOKS = Sdf.Path("/World/Looks")


def make_metal(stage, name: str, *, color, roughness=0.25, metallic=1.0):
    material = UsdShade.Material.Define(stage, LOOKS.AppendChild(name))
    shader = UsdShade.Shader.Define(stage, material.GetPath().AppendPath("surface"))
    shader.CreateIdAttr("UsdPreviewSurface")
    shader.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set(Gf.Vec3f(*color))
    shader.CreateInput("roughness", Sdf.ValueTypeNames.Float).Set(roughness)
    shader.CreateInput("metallic", Sdf.ValueTypeNames.Float).Set(metallic)
    material.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
    physics = UsdPhysics.MaterialAPI.Apply(material.GetPrim())
    physics.CreateStaticFrictionAttr().Set(0.3)
    physics.CreateDynamicFrictionAttr().Set(0.25)
    physics.CreateRestitutionAttr().Set(0.2)
    physics.CreateDensityAttr(8900.0)
    return material


def build(scene: Scene) -> None:
    stage = scene.stage
    scene.ground()
    ball = scene.sphere("ball", radius=0.1, position=(0, 0, 0.6), mass=1.0)
    copper = make_metal(stage, "copper", color=(0.72, 0.3, 0.15))
    geometry = stage.GetPrimAtPath(ball.path + "/geometry")
    binding = UsdShade.MaterialBindingAPI(geometry)
    binding.Bind(copper)
    binding.Bind(copper, UsdShade.Tokens.weakerThanDescendants, "physics")
    UsdGeom.Gprim(geometry).GetDisplayColorAttr().Set([Gf.Vec3f(0.72, 0.3, 0.15)])
    scene.camera("side", eye=(0, -2, 0.6), target=(0, 0, 0.3))
