"""What is written straight into a layer is what a stage then says."""

import pytest
from pxr import Sdf, Usd, UsdGeom

from wsim.scene.specs import apply, put, spec_of


@pytest.mark.parametrize("listed", ["explicit", "prepended", "appended"])
def test_schemas_are_applied_beside_those_that_are(listed):
    stage = Usd.Stage.CreateInMemory()
    prim = UsdGeom.Cube.Define(stage, "/cube").GetPrim()
    made = {f"{listed}Items": ["PhysicsCollisionAPI", "PhysicsRigidBodyAPI"]}
    how = Sdf.TokenListOp.CreateExplicit if listed == "explicit" else Sdf.TokenListOp.Create
    prim.SetMetadata("apiSchemas", how(**made))
    for _ in range(2):
        apply(spec_of(prim), "MaterialBindingAPI")
    assert sorted(prim.GetAppliedSchemas()) == ["MaterialBindingAPI", "PhysicsCollisionAPI", "PhysicsRigidBodyAPI"]


def test_an_attribute_that_is_there_is_set_anew():
    stage = Usd.Stage.CreateInMemory()
    prim = UsdGeom.Xform.Define(stage, "/x").GetPrim()
    for value in (1.0, 2.0):
        put(spec_of(prim), "wsim:some", Sdf.ValueTypeNames.Double, value)
    assert prim.GetAttribute("wsim:some").Get() == 2.0 and not prim.GetAttribute("wsim:some").IsCustom()
