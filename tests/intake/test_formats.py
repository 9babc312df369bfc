"""One box in each format is one asset: as large, as heavy, standing and facing as it was made."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image

from tests.intake import models
from wsim.assets import get, is_own, load_catalogue, search
from wsim.geometry.rotations import matrices
from wsim.intake import IntakeError, Placing, Wanted, add, remove
from wsim.scene.check import check_stage
from wsim.scene.describe import describe

VOLUME = float(np.prod(models.BOX))
FORMATS = (".glb", ".gltf", ".obj", ".stl", ".ply", ".usda", ".usdc")


def made(folder: Path, kind: str) -> Path:
    path = folder / f"thing{kind}"
    if kind.startswith(".usd"):
        return models.write_usd(path)
    mesh = models.box()
    mesh.apply_translation((3.0, -2.0, 1.0))
    if kind in (".glb", ".gltf", ".obj"):
        mesh.apply_transform(models.Z_TO_Y)
    if kind == ".gltf":
        folder = folder / "gltf"
        folder.mkdir()
        for name, data in trimesh.exchange.gltf.export_gltf(trimesh.Scene(mesh)).items():
            (folder / name).write_bytes(data)
        return folder / "model.gltf"
    return models.write(mesh, path)


@pytest.mark.parametrize("kind", FORMATS)
def test_a_box_is_a_box(own: Path, tmp_path: Path, kind: str) -> None:
    asset = add(made(tmp_path, kind), Wanted("parcel", density=500.0, picture=False))
    assert asset.path == own / "parcel" / "asset.usda"
    assert asset.size == pytest.approx(models.BOX, abs=1e-5)
    assert asset.mass == pytest.approx(500.0 * VOLUME, rel=1e-4)
    assert asset.hollow is None and not asset.articulated
    assert (asset.collision.method, asset.collision.parts) == ("box", 1)
    assert asset.collision.volume_ratio == pytest.approx(1.0, abs=0.02)
    assert asset.collision.hausdorff < 1e-5
    assert check_stage(asset.path, [own]) == []
    (body,) = describe(asset.path).bodies
    x, y, z = models.BOX
    moments = 500.0 * VOLUME / 12.0 * np.array([y * y + z * z, x * x + z * z, x * x + y * y])
    np.testing.assert_allclose(np.array(body.inertia).reshape(3, 3), np.diag(moments), rtol=1e-3, atol=1e-6)
    assert body.com == pytest.approx((0.0, 0.0, z / 2), abs=1e-5)
    (collider,) = (shape for shape in body.shapes if shape.collides)
    assert (collider.kind, collider.size) == ("box", pytest.approx(models.BOX, abs=1e-5))


def test_colours_and_a_picture_come_along(own: Path, tmp_path: Path) -> None:
    asset = add(models.write(models.cabinet(), tmp_path / "c.glb"), Wanted("kitchen cupboard"))
    assert sorted(asset.colors.values()) == [
        pytest.approx((150 / 255, 100 / 255, 50 / 255), abs=0.01),
        pytest.approx((200 / 255, 200 / 255, 190 / 255), abs=0.01),
    ]
    picture = np.asarray(Image.open(own / "kitchen_cupboard" / "thumbnail.png"))
    assert picture.shape == (270, 320, 3)
    assert picture.std() > 10.0


@pytest.mark.parametrize(
    ("forward", "up", "turned"), [("-x", "z", (0, 1, 2)), ("+y", "z", (1, 0, 2)), ("+z", "x", (2, 1, 0))]
)
def test_axes_are_as_said(own: Path, tmp_path: Path, forward: str, up: str, turned: tuple[int, ...]) -> None:
    path = models.write(models.box(), tmp_path / "thing.stl")
    asset = add(path, Wanted("thing", Placing(up, forward), picture=False))
    assert asset.size == pytest.approx([models.BOX[k] for k in turned], abs=1e-5)


def test_the_front_faces_x(own: Path, tmp_path: Path) -> None:
    """Of an L whose low side lies along the file's -Y, that side is in front."""
    low = trimesh.creation.box(
        extents=(0.4, 0.2, 0.1), transform=trimesh.transformations.translation_matrix([0, -0.1, 0.05])
    )
    high = trimesh.creation.box(
        extents=(0.4, 0.2, 0.5), transform=trimesh.transformations.translation_matrix([0, 0.1, 0.25])
    )
    path = models.write(trimesh.util.concatenate([low, high]), tmp_path / "l.stl")
    asset = add(path, Wanted("corner", Placing(forward="-y"), picture=False))
    (body,) = describe(asset.path).bodies
    boxes = sorted((shape for shape in body.shapes if shape.collides), key=lambda shape: shape.position[2])
    tops = [np.abs(matrices(np.array(box.rotation)) @ np.array(box.size))[2] for box in boxes]
    assert tops == pytest.approx([0.1, 0.5], abs=1e-4)
    assert boxes[0].position[0] == pytest.approx(0.1, abs=1e-4)
    assert asset.collision.method == "shapes"


@pytest.mark.parametrize(
    ("scale", "placing", "size", "said"),
    [
        (1.0, Placing(), 0.4, "; m, which"),
        (1000.0, Placing(), 0.4, "; mm, which"),
        (100.0, Placing(unit="cm"), 0.4, ""),
        (7.0, Placing(height=0.75), 0.75, ""),
    ],
)
def test_units_are_taken_or_said(
    own: Path, tmp_path: Path, scale: float, placing: Placing, size: float, said: str
) -> None:
    mesh = models.box()
    mesh.apply_scale(scale)
    asset = add(models.write(mesh, tmp_path / "thing.stl"), Wanted("thing", placing, picture=False))
    assert asset.size[2] == pytest.approx(size, rel=1e-4)
    assert any(said in note for note in asset.notes) if said else not any("no unit" in note for note in asset.notes)


def test_mass_is_as_said(own: Path, tmp_path: Path) -> None:
    path = models.write(models.box(), tmp_path / "thing.ply")
    asset = add(path, Wanted("thing", mass=3.5, picture=False))
    (body,) = describe(asset.path).bodies
    assert asset.mass == body.mass == pytest.approx(3.5)
    x, y, _ = models.BOX
    assert body.inertia[8] == pytest.approx(3.5 / 12.0 * (x * x + y * y), rel=1e-3)


@pytest.mark.parametrize(
    ("mesh", "method"),
    [
        (trimesh.creation.icosphere(radius=0.1, subdivisions=4), "sphere"),
        (trimesh.creation.cylinder(radius=0.05, height=0.3, sections=32), "cylinder"),
        (trimesh.creation.cone(radius=0.1, height=0.3, sections=32), "hull"),
        (trimesh.creation.capsule(radius=0.05, height=0.2), "hull"),
    ],
)
def test_what_is_plain_collides_as_that(own: Path, tmp_path: Path, mesh: trimesh.Trimesh, method: str) -> None:
    asset = add(models.write(mesh, tmp_path / "thing.stl"), Wanted("thing", picture=False))
    assert (asset.collision.method, asset.collision.parts) == (method, 1)
    assert asset.collision.volume_ratio == pytest.approx(1.0, abs=0.05)


def test_it_is_found_at_once_and_goes_at_once(own: Path, tmp_path: Path) -> None:
    before = load_catalogue()
    path = models.write(models.box(), tmp_path / "thing.stl")
    add(path, Wanted("Yellow submarine", synonyms=["u-boat"], picture=False))
    assert is_own(get("yellow_submarine"))
    assert search("u-boat")[0].asset.id == "yellow_submarine"
    assert set(load_catalogue()) == {*before, "yellow_submarine"}
    remove("yellow_submarine")
    assert set(load_catalogue()) == set(before)
    with pytest.raises(IntakeError, match="shipped with wsim and stays"):
        remove("mug")


def test_a_name_is_taken_once(own: Path, tmp_path: Path) -> None:
    path = models.write(models.box(), tmp_path / "thing.stl")
    with pytest.raises(IntakeError, match=r"name = 'Mug' is that of a shipped asset; choose another"):
        add(path, Wanted("Mug", picture=False))
    add(path, Wanted("thing", picture=False))
    with pytest.raises(IntakeError, match="name = 'thing' is there already; --replace"):
        add(path, Wanted("thing", picture=False))
    asset = add(path, Wanted("thing", density=1000.0, replace=True, picture=False))
    assert asset.mass == pytest.approx(1000.0 * VOLUME, rel=1e-4)
    assert json.loads((own / "thing" / "asset.json").read_text())["mass"] == asset.mass
    assert sorted(path.name for path in own.iterdir()) == ["thing"]
