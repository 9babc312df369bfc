import math
import re
from collections.abc import Callable
from pathlib import Path

import pytest
from pxr import Gf, Sdf, Usd, UsdGeom, UsdPhysics, Vt

from wsim.scene import Scene
from wsim.scene.check import check_stage


def _attribute(path: str, name: str, value: object) -> Callable[[Usd.Stage], None]:
    def spoil(stage: Usd.Stage) -> None:
        attribute = stage.GetPrimAtPath(path).GetAttribute(name)
        assert attribute, (path, name)
        attribute.Set(value)

    return spoil


def _too_many_prims(stage: Usd.Stage) -> None:
    with Sdf.ChangeBlock():
        for i in range(20_001):
            Sdf.CreatePrimInLayer(stage.GetRootLayer(), f"/World/p{i}").specifier = Sdf.SpecifierDef


def _nan_point(stage: Usd.Stage) -> None:
    mesh = UsdGeom.Mesh.Define(stage, "/World/mesh")
    mesh.CreatePointsAttr(Vt.Vec3fArray([(0, 0, 0), (1, 0, 0), (0, math.nan, 0)]))


def _nan_later(stage: Usd.Stage) -> None:
    op = UsdGeom.Xformable(stage.GetPrimAtPath("/World/block")).GetOrderedXformOps()[0]
    op.Set(Gf.Vec3d(0, 0, 0), 0.0)
    op.Set(Gf.Vec3d(0, math.nan, 0), 10.0)


def _body_without_a_pose(stage: Usd.Stage) -> None:
    UsdPhysics.RigidBodyAPI.Apply(UsdGeom.Scope.Define(stage, "/World/scope").GetPrim())


SPOILT: list[tuple[Callable[[Usd.Stage], None], str]] = [
    (_attribute("/World/block", "xformOp:translate", Gf.Vec3d(0, math.nan, 0)), "/World/block.xformOp:translate: nan"),
    (_attribute("/World/block", "xformOp:translate", Gf.Vec3d(0, 2e4, 0)), "/World/block.xformOp: y = 20000 m"),
    (_attribute("/World/block", "xformOp:orient", Gf.Quatd(math.inf, 0, 0, 0)), "xformOp:orient: inf must be finite"),
    (_attribute("/World/block/geometry", "size", -1.0), "/World/block/geometry.size: -1 must be > 0 m"),
    (_attribute("/World/block/geometry", "xformOp:scale", Gf.Vec3d(1, 0, 1)), "the scale is zero along an axis"),
    (_attribute("/World/ball/geometry", "radius", 5e3), "/World/ball/geometry.radius: 5000 m must be <= 1000 m"),
    (_attribute("/World/pill", "physics:mass", -1.0), "/World/pill.physics:mass: -1 must be > 0 kg"),
    (_attribute("/World/pill", "physics:mass", 0.0), "/World/pill.physics:mass: 0 must be > 0 kg"),
    (_attribute("/World/pill", "physics:mass", 1e7), "/World/pill.physics:mass: 1e+07 must be <= 100000 kg"),
    (_attribute("/World/ball", "physics:density", math.nan), "/World/ball.physics:density: nan must be finite"),
    (_attribute("/World/water", "wsim:density", 0.0), "/World/water.wsim:density: 0 must be > 0"),
    (_attribute("/World/water", "wsim:spacing", 1e-4), "/World/water.wsim:spacing: 0.0001 m gives 1.8e+11 particles"),
    (_attribute("/World/water", "wsim:size", Gf.Vec3f(1, -1, 1)), "/World/water.wsim:size: -1 must be >= 0 m"),
    (
        _attribute("/World/water", "wsim:size", Gf.Vec3f(1, 0, 1)),
        "must be > 0 along x and y; its height alone may be 0",
    ),
    (_attribute("/World/tank", "wsim:innerSize", Gf.Vec3f(1, 1, 0)), "/World/tank.wsim:innerSize: 0 must be > 0 m"),
    (_attribute("/World/PhysicsScene", "wsim:duration", 1e9), "wsim:duration: 1e+09 must be <= 3600 s"),
    (_attribute("/World/PhysicsScene", "wsim:timeStep", 1e-12), "wsim:timeStep: 1e-12 must be >= 1e-05 s, or 0"),
    (_attribute("/World/hinge", "physics:localPos0", Gf.Vec3f(math.inf, 0, 0)), "physics:localPos0: inf"),
    (_attribute("/World/hinge", "physics:lowerLimit", math.nan), "physics:lowerLimit: nan must be finite"),
    (_nan_point, "/World/mesh.points: nan must be finite"),
    (_nan_later, "/World/block.xformOp:translate: nan must be finite"),
    (_too_many_prims, "more than 20000 prims"),
    (_body_without_a_pose, "/World/scope: Rigid body API has to be applied to a xformable prim"),
    (lambda stage: stage.ClearDefaultPrim(), "no defaultPrim"),
    (lambda stage: UsdGeom.SetStageMetersPerUnit(stage, 0.01), "metersPerUnit = 0.01 must be 1"),
    (lambda stage: UsdGeom.SetStageUpAxis(stage, "Y"), "upAxis = Y must be Z"),
]


@pytest.mark.parametrize(("spoil", "message"), SPOILT, ids=[message for _, message in SPOILT])
def test_spoilt_stage_is_named(stage_path: Path, spoil: Callable[[Usd.Stage], None], message: str) -> None:
    stage = Usd.Stage.Open(str(stage_path))
    spoil(stage)
    spoilt = stage_path.with_name("spoilt.usda")
    stage.GetRootLayer().Export(str(spoilt))
    problems = check_stage(spoilt, [stage_path.parent])
    assert any(message in problem for problem in problems), problems


def test_a_value_out_of_range_is_told_once_and_with_the_value(workshop: Scene, tmp_path: Path) -> None:
    path = workshop.save(tmp_path / "stage.usda")
    stage = Usd.Stage.Open(str(path))
    stage.GetPrimAtPath("/World/pill").GetAttribute("physics:mass").Set(-1.0)
    stage.GetRootLayer().Save()
    assert check_stage(path, [tmp_path]) == ["/World/pill.physics:mass: -1 must be > 0 kg"]


def test_unlimited_joints_may_say_so(workshop: Scene, tmp_path: Path) -> None:
    hinge = workshop.stage.GetPrimAtPath("/World/hinge")
    hinge.GetAttribute("physics:lowerLimit").Set(-math.inf)
    hinge.GetAttribute("drive:angular:physics:maxForce").Set(math.inf)
    assert check_stage(workshop.save(tmp_path / "stage.usda"), [tmp_path]) == []


@pytest.mark.parametrize("text", ["", "rubbish", '#usda 1.0\ndef Xform "World" {'])
def test_file_that_does_not_parse(tmp_path: Path, text: str) -> None:
    path = tmp_path / "stage.usda"
    path.write_text(text)
    (problem,) = check_stage(path, [tmp_path])
    assert "not a USD layer: " in problem
    assert "\n" not in problem


def test_missing_and_foreign_files(tmp_path: Path) -> None:
    (tmp_path / "stage.txt").write_text("")
    assert "no such file" in check_stage(tmp_path / "none.usda", [tmp_path])[0]
    assert "must end in" in check_stage(tmp_path / "stage.txt", [tmp_path])[0]


def test_file_of_absurd_size(tmp_path: Path) -> None:
    path = tmp_path / "stage.usda"
    with path.open("wb") as file:
        file.truncate(100_000_001)
    assert "100000001 bytes" in check_stage(path, [tmp_path])[0]


HEAD = (
    '#usda 1.0\n(\n    defaultPrim = "World"\n    metersPerUnit = 1\n    kilogramsPerUnit = 1\n    upAxis = "Z"\n%s)\n'
)
BODY = 'def Xform "World" %s\n{\n%s\n}\n'
ASSET = '#usda 1.0\n(\n    defaultPrim = "part"\n)\ndef Xform "part" {}\n'
VARIANT = '(\n    variantSets = "v"\n    variants = {string v = "b"}\n)'
IN_VARIANT = '    variantSet "v" = {\n        "a" (references = @%s@) {}\n        "b" {}\n    }'
NAMES: dict[str, Callable[[str], str]] = {
    "reference": lambda a: HEAD % "" + BODY % (f"(references = @{a}@)", ""),
    "payload": lambda a: HEAD % "" + BODY % (f"(payload = @{a}@)", ""),
    "sublayer": lambda a: HEAD % f"    subLayers = [@{a}@]\n" + BODY % ("", ""),
    "attribute": lambda a: HEAD % "" + BODY % ("", f"    asset inputs:file = @{a}@"),
    "array": lambda a: HEAD % "" + BODY % ("", f"    asset[] files = [@{a}@]"),
    "sample": lambda a: HEAD % "" + BODY % ("", f"    asset file.timeSamples = {{ 0: @{a}@ }}"),
    "customData": lambda a: HEAD % "" + BODY % (f"(customData = {{asset file = @{a}@}})", ""),
    "inactive": lambda a: (
        HEAD % "" + BODY % ("", f'    def "off" (\n        active = false\n        references = @{a}@\n    ) {{}}')
    ),
    "variant": lambda a: HEAD % "" + BODY % (VARIANT, IN_VARIANT % a),
}


@pytest.mark.parametrize("way", NAMES)
def test_everything_named_must_lie_in_the_roots(tmp_path: Path, way: str) -> None:
    run, assets, outside = tmp_path / "run", tmp_path / "assets", tmp_path / "outside"
    for folder in (run, assets, outside):
        folder.mkdir()
        (folder / "part.usda").write_text(ASSET)
    stage = run / "stage.usda"
    for inside in ("./part.usda", "../assets/part.usda", str(assets / "part.usda")):
        stage.write_text(NAMES[way](inside))
        assert check_stage(stage, [run, assets]) == []
    for foreign in ("../outside/part.usda", str(outside / "part.usda"), "/etc/passwd"):
        stage.write_text(NAMES[way](foreign))
        problems = check_stage(stage, [run, assets])
        assert any(re.search(rf"@{foreign}@ lies outside", problem) for problem in problems), problems


def test_layers_are_followed_and_links_resolved(tmp_path: Path) -> None:
    run, outside = tmp_path / "run", tmp_path / "outside"
    run.mkdir()
    outside.mkdir()
    (outside / "secret.usda").write_text(ASSET)
    (run / "link.usda").symlink_to(outside / "secret.usda")
    (run / "middle.usda").write_text(HEAD % "    subLayers = [@./link.usda@]\n" + BODY % ("", ""))
    (run / "stage.usda").write_text(HEAD % "    subLayers = [@./middle.usda@]\n" + BODY % ("", ""))
    (problem,) = check_stage(run / "stage.usda", [run])
    assert problem == "middle.usda: @./link.usda@ lies outside the folders that a stage may read"


@pytest.mark.parametrize(
    ("asset", "message"),
    [
        ("https://example.com/a.usda", "is not a file of this machine"),
        ("missing.usda", "is not there"),
        ("a.usdz[b.png]", "is in a package"),
        ("./look.mtlx", "must end in one of .usd"),
        ("./a.sdf:SDF_FORMAT_ARGS:target=/etc", "carries file format arguments"),
    ],
)
def test_odd_asset_paths(tmp_path: Path, asset: str, message: str) -> None:
    (tmp_path / "stage.usda").write_text(NAMES["reference"](asset))
    assert any(message in problem for problem in check_stage(tmp_path / "stage.usda", [tmp_path]))


def test_a_stage_is_read_as_it_is_on_disk(stage_path: Path) -> None:
    held = Usd.Stage.Open(str(stage_path))
    text = stage_path.read_text()
    assert "double wsim:spacing = 0.05" in text
    stage_path.write_text(text.replace("double wsim:spacing = 0.05", "double wsim:spacing = -0.0625"))
    assert any("-0.0625" in problem for problem in check_stage(stage_path, [stage_path.parent]))
    assert held


def test_value_clips_are_refused(tmp_path: Path) -> None:
    clips = '(clips = {dictionary default = {string templateAssetPath = "/etc/a.#.usda"}})'
    (tmp_path / "stage.usda").write_text(HEAD % "" + BODY % (clips, ""))
    assert any("value clips" in problem for problem in check_stage(tmp_path / "stage.usda", [tmp_path]))


def test_attribute_of_a_wrong_type_is_a_problem_not_a_crash(tmp_path: Path) -> None:
    text = HEAD % "" + BODY % ("", '    def Sphere "ball" {\n        string radius = "big"\n    }')
    (tmp_path / "stage.usda").write_text(text)
    assert check_stage(tmp_path / "stage.usda", [tmp_path]) != []
