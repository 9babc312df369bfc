"""A dumbbell and a hammer: one rigid body with several colliders each."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Iterable, Optional

from pxr import Gf, Sdf, Usd, UsdGeom, UsdPhysics
from wsim.scene import Scene


@dataclass
class Part:
    shape: type
    at: tuple[float, float, float]
    radius: Optional[float] = None
    height: Optional[float] = None
    scale: Optional[tuple[float, float, float]] = None
    density: float = 1000.0


@dataclass
class Compound:
    name: str
    position: Gf.Vec3d
    parts: list[Part] = field(default_factory=list)

    @classmethod
    def dumbbell(cls, name: str, position: Iterable[float]) -> Compound:
        ends = [Part(UsdGeom.Sphere, (s * 0.2, 0, 0), radius=0.08, density=7000) for s in (-1, 1)]
        bar = Part(UsdGeom.Cylinder, (0, 0, 0), radius=0.02, height=0.4, density=7000)
        return cls(name, Gf.Vec3d(*position), [*ends, bar])

    @staticmethod
    def hammer(name: str, position) -> "Compound":
        head = Part(UsdGeom.Cube, (0.0, 0, 0.2), scale=(0.16, 0.07, 0.07), density=7800)
        handle = Part(UsdGeom.Cube, (0.0, 0, 0.0), scale=(0.03, 0.03, 0.33), density=650)
        return Compound(name=name, position=Gf.Vec3d(*position), parts=[head, handle])

    def author(self, stage: Usd.Stage) -> Usd.Prim:
        root = UsdGeom.Xform.Define(stage, f"/World/{self.name}")
        root.AddTranslateOp().Set(self.position)
        UsdPhysics.RigidBodyAPI.Apply(root.GetPrim())
        for k, part in enumerate(self.parts):
            shape = part.shape.Define(stage, root.GetPath().AppendChild(f"part_{k}"))
            xform = UsdGeom.Xformable(shape)
            xform.AddTranslateOp().Set(Gf.Vec3d(*part.at))
            if part.radius is not None:
                shape.GetRadiusAttr().Set(part.radius)
            if part.height is not None:
                shape.GetHeightAttr().Set(part.height)
                shape.GetAxisAttr().Set("X")
            if part.scale is not None:
                shape.GetSizeAttr().Set(1.0)
                xform.AddScaleOp().Set(Gf.Vec3f(*part.scale))
            shape.CreateExtentAttr(UsdGeom.Boundable.ComputeExtentFromPlugins(shape, Usd.TimeCode.Default()))
            UsdPhysics.CollisionAPI.Apply(shape.GetPrim())
            UsdPhysics.MassAPI.Apply(shape.GetPrim()).CreateDensityAttr(part.density)
        return root.GetPrim()


def build(scene: Scene) -> None:
    scene.simulation(duration=2.0)
    scene.ground(friction=0.8)
    for compound in (Compound.dumbbell("dumbbell", (0, 0, 0.5)), Compound.hammer("hammer", (0.8, 0, 0.6))):
        prim = compound.author(scene.stage)
        UsdPhysics.RigidBodyAPI(prim).CreateAngularVelocityAttr(Gf.Vec3f(0, 0, 180))
    scene.camera("side", eye=(0.4, -2.5, 0.9), target=(0.4, 0, 0.3))
