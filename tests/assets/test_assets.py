"""Every shipped asset: sound USD, as large and heavy as its metadata says, and Newton takes it."""

import json
import runpy
from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom, UsdPhysics

from wsim.scene import Scene
from wsim.scene.check import check_stage
from wsim.scene.describe import describe

ASSETS = Path(__file__).parents[2] / "usd_assets"
FOLDERS = sorted(path.parent for path in ASSETS.glob("*/asset.json"))
FIELDS = {"id", "file", "names", "category", "size", "mass", "forward_axis", "source", "license", "anchors"}


def metadata(folder: Path) -> dict:
    return json.loads((folder / "asset.json").read_text(encoding="utf-8"))


def test_every_asset_has_its_metadata() -> None:
    assert FOLDERS
    assert sorted(path.parent for path in ASSETS.glob("*/asset.usd*")) == FOLDERS


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda path: path.name)
class TestAsset:
    def test_metadata(self, folder: Path) -> None:
        data = metadata(folder)
        assert set(data) >= FIELDS
        assert data["id"] == folder.name
        assert data["names"] and all(name == name.lower() for name in data["names"])
        assert data["forward_axis"] == "+X" and data["license"]

    def test_stage_is_sound_and_names_nothing_outside_its_folder(self, folder: Path) -> None:
        assert check_stage(folder / metadata(folder)["file"], [folder]) == []

    def test_size_is_what_the_metadata_says(self, folder: Path) -> None:
        data = metadata(folder)
        stage = Usd.Stage.Open(str(folder / data["file"]))
        for purpose in (UsdGeom.Tokens.default_, UsdGeom.Tokens.guide):  # what is seen, and what collides
            cache = UsdGeom.BBoxCache(Usd.TimeCode.Default(), [purpose])
            box = cache.ComputeWorldBound(stage.GetDefaultPrim()).ComputeAlignedRange()
            assert list(box.GetSize()) == pytest.approx(data["size"], abs=1e-6), purpose
            assert box.GetMin()[2] == pytest.approx(0.0, abs=1e-6)

    def test_anchors_are_where_the_metadata_says(self, folder: Path) -> None:
        data = metadata(folder)
        stage = Usd.Stage.Open(str(folder / data["file"]))
        for name, point in data["anchors"].items():
            anchor = stage.GetDefaultPrim().GetChild(name)
            assert anchor.IsA(UsdGeom.Xform)
            where = UsdGeom.Xformable(anchor).ComputeLocalToWorldTransform(Usd.TimeCode.Default())
            assert list(where.ExtractTranslation()) == pytest.approx(point)

    def test_newton_takes_it_as_one_body_of_its_mass(self, folder: Path) -> None:
        newton = pytest.importorskip("newton")
        data = metadata(folder)
        (body,) = describe(folder / data["file"]).bodies
        builder = newton.ModelBuilder()
        builder.add_usd(str(folder / data["file"]))
        assert builder.body_label == [body.prim]
        assert builder.body_mass[0] == pytest.approx(data["mass"], rel=1e-4)
        assert body.mass == pytest.approx(data["mass"], rel=1e-4)
        np.testing.assert_allclose(np.array(builder.body_com[0]), body.com, atol=1e-6)


def test_crate_is_what_its_script_writes(tmp_path: Path) -> None:
    script = runpy.run_path(str(ASSETS / "author_crate.py"))
    script["author"](tmp_path / "asset.usda")
    assert (tmp_path / "asset.usda").read_text() == (ASSETS / "crate" / "asset.usda").read_text()


def test_boards_of_the_crate_are_not_in_each_other() -> None:
    script = runpy.run_path(str(ASSETS / "author_crate.py"))
    boards = [(np.array(center), np.array(size)) for center, size in script["posts"]() + script["slats"]()]
    for i, (p, a) in enumerate(boards):
        for q, b in boards[:i]:
            assert (np.abs(p - q) - (a + b) / 2).max() > -1e-9


def test_crate_falls_and_stands(tmp_path: Path) -> None:
    """It falls by g t^2 / 2 before it lands, and then stands upright on the ground, carried with its weight."""
    from wsim.recording import read
    from wsim.sim import Simulation

    drop = 0.05
    scene = Scene()
    scene.simulation(duration=0.5, frame_rate=50.0)
    scene.ground()
    crate = UsdGeom.Xform.Define(scene.stage, "/World/crate")
    crate.GetPrim().GetReferences().AddReference(str(ASSETS / "crate" / "asset.usda"))
    crate.AddTranslateOp().Set(Gf.Vec3d(0.1, -0.2, drop))
    assert crate.GetPrim().HasAPI(UsdPhysics.RigidBodyAPI)
    stage = scene.save(tmp_path / "stage.usda")
    assert check_stage(stage, [tmp_path, ASSETS]) == []

    simulation = Simulation(stage, device="cpu")
    assert simulation.run(tmp_path / "r.rrd").problems == []
    recording = read(tmp_path / "r.rrd")
    position = recording.position("/World/crate")
    falling = recording.time < 0.09  # it lands after sqrt(2 drop / g) = 0.101 s
    expected = drop - 0.5 * 9.81 * recording.time**2
    assert position[falling, 2] == pytest.approx(expected[falling], abs=9.81 * 0.09 * simulation.dt)
    assert position[-1] == pytest.approx([0.1, -0.2, 0.0], abs=2e-3)
    assert recording.body_q[-1, 0, 3:] == pytest.approx([0.0, 0.0, 0.0, 1.0], abs=2e-3)
    assert recording.contact_force[-5:, 0, 2].mean() == pytest.approx(6.8 * 9.81, rel=0.05)
