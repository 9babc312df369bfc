"""Boxes labelled with attributes, custom data, variants of metadata and a relationship of one's own."""
from pxr import Gf, Kind, Sdf, Tf, Usd, UsdGeom, Vt

from wsim.scene import Scene


def label(prim: Usd.Prim, **values) -> None:
    kinds = {int: Sdf.ValueTypeNames.Int, float: Sdf.ValueTypeNames.Double, str: Sdf.ValueTypeNames.String, bool: Sdf.ValueTypeNames.Bool}
    for key, value in values.items():
        attribute = prim.CreateAttribute(f"userProperties:{key}", kinds[type(value)], custom=True)
        attribute.Set(value)
        if not attribute.HasAuthoredValue():
            raise RuntimeError(f"{attribute.GetName()} was not set")


def build(scene: Scene) -> None:
    scene.ground()
    stage = scene.stage
    handles = [scene.box(Tf.MakeValidIdentifier(n), size=(0.2, 0.2, 0.2), position=(0.3 * i, 0, 0.1), density=600) for i, n in enumerate(["crate A", "crate B"])]
    for i, handle in enumerate(handles):
        prim = stage.GetPrimAtPath(handle.path)
        label(prim, serial=100 + i, weight=4.8, owner="lab", fragile=bool(i))
        prim.SetCustomDataByKey("source", "warehouse")
        Usd.ModelAPI(prim).SetKind(Kind.Tokens.component)
        prim.SetMetadata("comment", "labelled")
        assert prim.GetAttribute("userProperties:serial").Get() == 100 + i
    relation = stage.GetPrimAtPath(handles[0].path).CreateRelationship("userProperties:neighbour", custom=True)
    relation.AddTarget(handles[1].path)
    points = Vt.Vec3fArray([Gf.Vec3f(0, 0, 0), Gf.Vec3f(0.1, 0, 0)])
    print(len(points), stage.GetDefaultPrim().GetPath(), UsdGeom.GetStageUpAxis(stage), [p.GetName() for p in stage.Traverse() if p.IsA(UsdGeom.Cube)])
    scene.camera("cam", eye=(0, -2, 1), target=(0.1, 0, 0.1))
