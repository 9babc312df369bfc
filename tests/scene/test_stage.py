import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from pxr import Usd, UsdGeom, UsdPhysics

from wsim.scene import Scene, SceneError
from wsim.scene.check import check_stage
from wsim.scene.describe import describe


def test_stage_states_units_axis_and_default_prim(stage_path: Path) -> None:
    stage = Usd.Stage.Open(str(stage_path))
    assert stage.GetDefaultPrim().GetPath() == "/World"
    assert UsdGeom.GetStageMetersPerUnit(stage) == 1.0
    assert UsdPhysics.GetStageKilogramsPerUnit(stage) == 1.0
    assert UsdGeom.GetStageUpAxis(stage) == "Z"
    assert stage.GetEndTimeCode() == 50
    assert stage.GetTimeCodesPerSecond() == 25.0


def test_stage_passes_usd_validators(stage_path: Path) -> None:
    assert check_stage(stage_path, [stage_path.parent]) == []


PLAIN = """
import json, sys
from pxr import Plug, Usd, UsdValidation
assert not any("wsim" in plugin.name for plugin in Plug.Registry().GetAllPlugins())
stage = Usd.Stage.Open(sys.argv[1])
validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
errors = UsdValidation.ValidationContext(validators).Validate(stage)
prim = stage.GetPrimAtPath("/World/water")
print(json.dumps({
    "errors": [error.GetMessage() for error in errors],
    "spacing": prim.GetAttribute("wsim:spacing").Get(),
    "container": [str(p) for p in prim.GetRelationship("wsim:container").GetTargets()],
    "types": sorted({str(p.GetTypeName()) for p in stage.Traverse()}),
}))
"""


def test_stage_opens_in_plain_usd_without_our_schema(stage_path: Path) -> None:
    done = subprocess.run([sys.executable, "-c", PLAIN, str(stage_path)], capture_output=True, text=True, cwd="/")
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    found = json.loads(done.stdout)
    assert found["errors"] == []
    assert found["spacing"] == 0.05
    assert found["container"] == ["/World/tank"]
    assert {"Xform", "PhysicsScene", "PhysicsRevoluteJoint", "Camera", "DomeLight"} <= set(found["types"])


def test_schema_is_known_to_usd_once_imported(workshop: Scene) -> None:
    registry = Usd.SchemaRegistry()
    for name in ("WsimSceneAPI", "WsimFluidAPI", "WsimContainerAPI", "WsimCameraAPI", "WsimParameterAPI"):
        assert registry.FindAppliedAPIPrimDefinition(name) is not None, name
    water = workshop.stage.GetPrimAtPath("/World/water")
    assert water.HasAPI("WsimFluidAPI")
    assert water.GetAttribute("wsim:viscosity").GetTypeName() == "double"


LIGHT = """
import sys
import wsim.scene
heavy = {"newton", "warp", "pydantic", "trimesh", "scipy", "mujoco", "rerun"}
print(sorted(heavy & {name.split(".")[0] for name in sys.modules}))
"""


def test_import_loads_nothing_heavy() -> None:
    done = subprocess.run([sys.executable, "-c", LIGHT], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_every_prim_notes_the_line_that_made_it() -> None:
    scene = Scene()
    here = sys._getframe().f_lineno + 1
    scene.box("block", size=(1, 1, 1))
    tank = scene.tank("tank", inner_size=(1, 1, 1))
    scene.fluid("water", fills=tank, level=0.5, spacing=0.1)
    for path in ("/World/block", "/World/block/geometry", "/World/Looks/block"):
        assert scene.stage.GetPrimAtPath(path).GetCustomDataByKey("wsim:line") == f"test_stage.py:{here}"
    assert scene.stage.GetPrimAtPath("/World/tank").GetCustomDataByKey("wsim:line") == f"test_stage.py:{here + 1}"
    assert scene.stage.GetPrimAtPath("/World/water").GetCustomDataByKey("wsim:line") == f"test_stage.py:{here + 2}"


def test_tank_stands_on_its_outer_bottom() -> None:
    scene = Scene()
    tank = scene.tank("tank", inner_size=(1.0, 0.6, 0.5), position=(3.0, 2.0, 0.0), wall=0.03)
    assert tank.floor == pytest.approx(0.03)
    box = UsdGeom.BBoxCache(Usd.TimeCode.Default(), ["default"]).ComputeWorldBound(scene.stage.GetPrimAtPath(tank.path))
    bounds = box.ComputeAlignedRange()
    np.testing.assert_allclose(bounds.GetMin(), (2.47, 1.67, 0.0), atol=1e-9)
    np.testing.assert_allclose(bounds.GetMax(), (3.53, 2.33, 0.53), atol=1e-9)


def test_fluid_fills_the_hollow_to_its_level() -> None:
    scene = Scene()
    tank = scene.tank("tank", inner_size=(1.0, 0.6, 0.5), position=(3.0, 2.0, 1.0), wall=0.03)
    water = scene.fluid("water", fills="tank", level=0.2, spacing=0.05)
    assert water.size == (1.0, 0.6, 0.2)
    assert water.center == pytest.approx((3.0, 2.0, 1.13))
    assert water.surface == pytest.approx(tank.floor + 0.2)


def test_free_box_of_fluid_finds_its_tank() -> None:
    scene = Scene()
    scene.tank("tank", inner_size=(1.0, 1.0, 1.0))
    scene.fluid("column", size=(0.2, 1.0, 0.5), position=(-0.4, 0.0, 0.27), spacing=0.05)
    scene.fluid("drop", size=(0.2, 0.2, 0.2), position=(5.0, 0.0, 3.0), spacing=0.05)
    targets = [
        scene.stage.GetPrimAtPath(f"/World/{n}").GetRelationship("wsim:container").GetTargets()
        for n in ("column", "drop")
    ]
    assert [[str(path) for path in paths] for paths in targets] == [["/World/tank"], []]


def test_param_returns_its_default_or_the_override() -> None:
    assert Scene().param("density", 600, low=300, high=900) == 600.0
    scene = Scene(params={"density": 50.0})  # outside the range of a sweep, on purpose
    assert scene.param("density", 600.0, low=300.0, high=900.0, unit="kg/m^3") == 50.0
    prim = scene.stage.GetPrimAtPath("/World/Parameters/density")
    assert [prim.GetAttribute(f"wsim:{key}").Get() for key in ("value", "default", "low", "high", "unit")] == [
        50.0,
        600.0,
        300.0,
        900.0,
        "kg/m^3",
    ]


def test_override_of_an_unknown_param_fails_on_save(tmp_path: Path) -> None:
    scene = Scene(params={"densty": 50.0})
    scene.param("density", 600.0)
    with pytest.raises(SceneError, match=r'"densty" is no parameter.*did you mean "density"'):
        scene.save(tmp_path / "stage.usda")
    assert list(tmp_path.iterdir()) == []


def test_builds_are_reproducible(tmp_path: Path) -> None:
    files = []
    for i in range(2):
        scene = Scene(seed=7)
        for j in range(3):
            scene.box(f"b{j}", size=(0.1, 0.1, 0.1), position=scene.random.uniform(-1, 1, 3))
        files.append(scene.save(tmp_path / f"{i}.usda").read_text())
    assert files[0] == files[1]


@pytest.mark.parametrize(("given", "expected"), [((0.0, 0.0, -1.62), (0.0, 0.0, -1.62)), ((0, 0, 0), (0, 0, 0))])
def test_gravity(given: tuple[float, float, float], expected: tuple[float, float, float]) -> None:
    scene = Scene()
    scene.simulation(gravity=given)
    physics = UsdPhysics.Scene(scene.stage.GetPrimAtPath("/World/PhysicsScene"))
    vector = np.array(physics.GetGravityDirectionAttr().Get()) * physics.GetGravityMagnitudeAttr().Get()
    np.testing.assert_allclose(vector, expected, atol=1e-6)


def test_joint_trees_have_one_articulation_root_and_loops_are_cut() -> None:
    scene = Scene()
    bodies = [scene.box(f"b{i}", size=(0.1, 0.1, 0.1), position=(i, 0.0, 0.0)) for i in range(4)]
    for i in range(3):
        scene.joint_revolute(f"j{i}", bodies[i], bodies[i + 1], axis="Y")
    roots = [p.GetName() for p in scene.stage.Traverse() if p.HasAPI(UsdPhysics.ArticulationRootAPI)]
    assert roots == ["b0"]
    scene.joint_fixed("anchor", None, bodies[0])
    scene.joint_fixed("loop", None, bodies[3])
    roots = [p.GetName() for p in scene.stage.Traverse() if p.HasAPI(UsdPhysics.ArticulationRootAPI)]
    assert roots == ["anchor"]
    cut = [
        p.GetName()
        for p in scene.stage.Traverse()
        if p.IsA(UsdPhysics.Joint) and UsdPhysics.Joint(p).GetExcludeFromArticulationAttr().Get()
    ]
    assert cut == ["loop"]


def test_what_is_saved_again_is_what_is_read(tmp_path):
    """While somebody still holds the first stage open, too: USD keeps its layers by path."""
    path = tmp_path / "world.usda"
    held = []
    for size in (0.2, 0.5):
        scene = Scene()
        scene.box("crate", size=(size,) * 3, position=(0, 0, 1))
        scene.save(path)
        held.append(Usd.Stage.Open(str(path)))
    assert describe(path).bodies[0].shapes[0].size == pytest.approx((0.5, 0.5, 0.5))
    assert held[0].GetPrimAtPath("/World/crate")
