"""From Python a simulation refuses what `wsim run` refuses, and looks at each stage once."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest
from pxr import Sdf

from wsim.errors import UserError
from wsim.runs.settings import Settings
from wsim.runs.simulation import open_simulation
from wsim.scene import Scene
from wsim.scene.describe import describe
from wsim.sim import Simulation, entering


def hung(tmp_path: Path, prim: str = "/World/a", attribute: str = "", value: float = 0.0) -> Path:
    """A ball that hangs on a weld, with one attribute as given."""
    scene = Scene()
    scene.sphere("a", radius=0.1, position=(0.0, 0.0, 1.0), mass=1.0)
    scene.joint_fixed("j", None, "a", break_force=100.0)
    if attribute:
        kind = Sdf.ValueTypeNames.Double if attribute == "radius" else Sdf.ValueTypeNames.Float
        scene.stage.GetPrimAtPath(prim).CreateAttribute(attribute, kind).Set(value)
    return scene.save(tmp_path / "stage.usda")


@pytest.mark.parametrize(
    ("prim", "attribute", "value", "message"),
    [
        ("/World/a", "physics:mass", -1.0, "/World/a.physics:mass: -1 must be > 0 kg"),
        ("/World/j", "physics:breakForce", -1.0, "/World/j.physics:breakForce: -1 must be > 0; inf never breaks"),
        ("/World/j", "physics:breakForce", math.nan, "/World/j.physics:breakForce: nan must be finite"),
        ("/World/a/geometry", "radius", math.nan, "/World/a/geometry.radius: nan must be finite"),
    ],
)
def test_a_number_that_cannot_be_is_refused(
    tmp_path: Path, prim: str, attribute: str, value: float, message: str
) -> None:
    with pytest.raises(UserError, match=re.escape(message)) as caught:
        Simulation(hung(tmp_path, prim, attribute, value), "cpu")
    assert "\n" not in str(caught.value)


def test_a_body_between_what_goes_its_own_way_and_the_world_is_refused(tmp_path: Path) -> None:
    scene = Scene()
    scene.box("k", size=(0.1, 0.1, 0.1), position=(0, 0, 1), kinematic=True, velocity=(1, 0, 0))
    scene.box("b", size=(0.1, 0.1, 0.1), position=(1, 0, 1))
    scene.joint_revolute("p", None, "b", anchor=(1, 0, 1), axis="Y")
    scene.joint_fixed("f", "k", "b")
    held = "/World/f: joints hold the world and </World/k> together, of which neither gives way"
    with pytest.raises(UserError, match=held):
        Simulation(scene.save(tmp_path / "stage.usda"), "cpu")


def test_a_stage_is_checked_once_and_not_where_it_was_before(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    stage, looked = hung(tmp_path), []
    whole = entering.check_stage
    monkeypatch.setattr(entering, "check_stage", lambda *given: looked.append(given[0]) or whole(*given))
    Simulation([stage, stage], "cpu")
    assert looked == [stage]
    Simulation(stage, "cpu", worlds=[describe(stage)])
    with open_simulation(stage, Path(__file__), Settings(pictures=False)):  # whoever built it checked it
        pass
    assert looked == [stage]


def test_files_of_a_stage_may_lie_where_its_owner_put_them(tmp_path: Path) -> None:
    for folder in ("far", "near"):
        (tmp_path / folder).mkdir()
    hung(tmp_path / "far")
    stage = Scene().save(tmp_path / "near" / "stage.usda")
    layer = Sdf.Layer.FindOrOpen(str(stage))
    layer.subLayerPaths.append("../far/stage.usda")
    layer.Save()
    assert Simulation(stage, "cpu").world.bodies[0].prim == "/World/a"
