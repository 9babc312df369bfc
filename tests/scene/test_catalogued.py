"""`scene.asset`: a copy of the catalogue's object that needs no file beside the stage."""

from pathlib import Path

import pytest
from pxr import Usd, UsdShade

from wsim.assets import load_catalogue
from wsim.scene import Scene, SceneError
from wsim.scene.check import check_stage
from wsim.scene.describe import describe


@pytest.mark.parametrize("id", list(load_catalogue()))
def test_every_asset_is_copied_whole(id: str, tmp_path: Path) -> None:
    scene = Scene()
    handle = scene.asset("thing", id, position=(1.0, 2.0, 0.0), rotation_deg=(0.0, 0.0, 30.0))
    path = scene.save(tmp_path / "stage.usda")
    assert not Usd.Stage.Open(str(path)).GetRootLayer().GetCompositionAssetDependencies()
    assert check_stage(path, []) == []
    bodies = [body for body in describe(path).bodies if body.prim.startswith(handle.path)]
    assert bodies
    assert sum(body.mass for body in bodies) == pytest.approx(load_catalogue()[id].mass, rel=0.02)
    stage = Usd.Stage.Open(str(path))
    for prim in Usd.PrimRange(stage.GetPrimAtPath(handle.path)):
        for target in UsdShade.MaterialBindingAPI(prim).GetDirectBindingRel().GetTargets():
            assert stage.GetPrimAtPath(target), f"{prim.GetPath()} is bound to {target}, which is not there"
    assert stage.GetPrimAtPath(handle.path).GetCustomDataByKey("wsim:line").startswith("test_catalogued.py:")


def test_a_static_asset_does_not_move_and_a_jointed_one_cannot_be(tmp_path: Path) -> None:
    scene = Scene()
    assert scene.asset("desk", "desk", static=True).kind == "static"
    world = describe(scene.save(tmp_path / "stage.usda"))
    assert not world.bodies and [item.prim for item in world.statics] == ["/World/desk"]
    with pytest.raises(SceneError, match=r"seesaw.*joint"):
        scene.asset("toy", "seesaw", static=True)


def test_what_is_not_in_the_catalogue_is_refused_with_what_is() -> None:
    with pytest.raises(SceneError, match="shelf"):
        Scene().asset("thing", "bookcase")
