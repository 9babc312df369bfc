"""Every shipped asset: sound USD, as large, heavy and hollow as its metadata says, and what its script writes."""

import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom, UsdPhysics
from scipy.spatial import ConvexHull

from wsim.assets import Asset, load_catalogue
from wsim.geometry.rotations import matrices
from wsim.scene import Scene
from wsim.scene.check import check_stage
from wsim.scene.describe import describe
from wsim.scene.world import Shape

ASSETS = Path(__file__).parents[2] / "usd_assets"
CATALOGUE = load_catalogue(ASSETS)
HOLLOW = [asset for asset in CATALOGUE.values() if asset.hollow]


def bounds(asset: Asset, purpose: str) -> tuple[np.ndarray, np.ndarray]:
    stage = Usd.Stage.Open(str(asset.path))
    box = UsdGeom.BBoxCache(Usd.TimeCode.Default(), [purpose]).ComputeWorldBound(stage.GetDefaultPrim())
    return np.array(box.ComputeAlignedRange().GetMin()), np.array(box.ComputeAlignedRange().GetMax())


def colliders(asset: Asset) -> list[tuple[Shape, np.ndarray, np.ndarray]]:
    """Each with its rotation matrix and its place in the asset's frame."""
    found = []
    for body in describe(asset.path).bodies:
        turn = matrices(np.array(body.rotation))
        for shape in body.shapes:
            if shape.collides:
                place = np.array(body.position) + turn @ np.array(shape.position)
                found.append((shape, turn @ matrices(np.array(shape.rotation)), place))
    return found


def test_all_are_there() -> None:
    assert len(CATALOGUE) >= 60
    assert sorted(path.parent.name for path in ASSETS.glob("*/asset.usda")) == sorted(CATALOGUE)


def test_files_are_what_the_script_writes(tmp_path: Path) -> None:
    subprocess.run([sys.executable, str(ASSETS / "author.py"), "--into", str(tmp_path)], check=True)
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(CATALOGUE)
    for id in CATALOGUE:
        for name in ("asset.usda", "asset.json"):
            assert (tmp_path / id / name).read_text() == (ASSETS / id / name).read_text(), f"{id}/{name}"


def test_files_are_small() -> None:
    sizes = [asset.path.stat().st_size for asset in CATALOGUE.values()]
    assert max(sizes) < 200_000
    assert sum(sizes) < 4_000_000


@pytest.mark.parametrize("asset", CATALOGUE.values(), ids=CATALOGUE)
class TestAsset:
    def test_stage_is_sound_and_names_nothing_outside_its_folder(self, asset: Asset) -> None:
        assert check_stage(asset.path, [asset.path.parent]) == []

    def test_size_is_what_the_metadata_says(self, asset: Asset) -> None:
        low, high = bounds(asset, UsdGeom.Tokens.default_)
        assert high - low == pytest.approx(asset.size, abs=1e-3)
        assert (low[:2] + high[:2]) / 2 == pytest.approx(0.0, abs=1e-3)
        assert low[2] == pytest.approx(0.0, abs=1e-6)

    def test_what_collides_is_where_what_is_seen_is(self, asset: Asset) -> None:
        seen, touched = bounds(asset, UsdGeom.Tokens.default_), bounds(asset, UsdGeom.Tokens.guide)
        assert (touched[0] > seen[0] - 0.01).all() and (touched[1] < seen[1] + 0.01).all()
        assert touched[0][2] == pytest.approx(0.0, abs=1e-5)

    def test_what_is_seen_does_not_collide_and_what_collides_is_not_seen(self, asset: Asset) -> None:
        stage = Usd.Stage.Open(str(asset.path))
        for prim in stage.Traverse():
            if prim.IsA(UsdGeom.Gprim):
                hidden = UsdGeom.Imageable(prim).ComputePurpose() == UsdGeom.Tokens.guide
                assert prim.HasAPI(UsdPhysics.CollisionAPI) == hidden, prim.GetPath()

    def test_anchors_are_where_the_metadata_says(self, asset: Asset) -> None:
        stage = Usd.Stage.Open(str(asset.path))
        for name, point in asset.anchors.items():
            (anchor,) = [prim for prim in stage.Traverse() if prim.GetName() == name and prim.IsA(UsdGeom.Xform)]
            where = UsdGeom.Xformable(anchor).ComputeLocalToWorldTransform(Usd.TimeCode.Default())
            assert list(where.ExtractTranslation()) == pytest.approx(point, abs=1e-5)

    def test_colors_are_those_of_its_materials(self, asset: Asset) -> None:
        stage = Usd.Stage.Open(str(asset.path))
        for name, color in asset.colors.items():
            surface = stage.GetPrimAtPath(f"/{asset.id}/Looks/{name}/surface")
            assert list(surface.GetAttribute("inputs:diffuseColor").Get()) == pytest.approx(color)

    def test_newton_takes_its_bodies_and_their_mass(self, asset: Asset) -> None:
        newton = pytest.importorskip("newton")
        world = describe(asset.path)
        builder = newton.ModelBuilder()
        builder.add_usd(str(asset.path))
        order = {label: k for k, label in enumerate(builder.body_label)}  # Newton's own, along the joints
        assert sorted(order) == sorted(body.prim for body in world.bodies)
        assert sum(body.mass for body in world.bodies) == pytest.approx(asset.mass, rel=1e-4)
        assert bool(world.joints) == asset.articulated == (len(world.bodies) > 1)
        for body in world.bodies:
            k = order[body.prim]
            assert builder.body_mass[k] == pytest.approx(body.mass, rel=1e-4)
            np.testing.assert_allclose(np.array(builder.body_com[k]), body.com, atol=1e-6)
            inertia, taken = (np.array(tensor).reshape(3, 3) for tensor in (body.inertia, builder.body_inertia[k]))
            np.testing.assert_allclose(taken, inertia, atol=1e-4 * np.trace(inertia))

    def test_inertia_is_that_of_something_within_its_box(self, asset: Asset) -> None:
        """No principal moment exceeds the other two together, nor that of the mass at the box's corners."""
        for body in describe(asset.path).bodies:
            moments = np.linalg.eigvalsh(np.array(body.inertia).reshape(3, 3))
            assert moments[0] > 0.0 and moments[2] < (moments[0] + moments[1]) * (1.0 + 1e-3)
            assert moments[2] < body.mass * float(np.square(asset.size).sum())

    def test_it_stands_firm(self, asset: Asset) -> None:
        """Tipped by 5 degrees, its centre of mass is still above its foot."""
        if asset.category == "sport/ball":
            return  # it stands on a point
        world = describe(asset.path)
        mass = sum(body.mass for body in world.bodies)
        com = sum(
            body.mass * (np.array(body.position) + matrices(np.array(body.rotation)) @ np.array(body.com))
            for body in world.bodies
        )
        com /= mass
        foot = ConvexHull(np.concatenate([_lowest(*collider) for collider in colliders(asset)]))
        margin = -(foot.equations[:, :2] @ com[:2] + foot.equations[:, 2]).max()
        assert math.degrees(math.atan2(margin, com[2])) > 5.0


def _lowest(shape: Shape, turn: np.ndarray, place: np.ndarray) -> np.ndarray:
    """Points (n, 2) of a shape that touch the ground."""
    if shape.kind == "cylinder":
        angle = np.linspace(0.0, 2.0 * math.pi, 33)
        ring = shape.size[0] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        ends = [np.c_[ring, np.full(len(ring), side * shape.size[1] / 2)] for side in (-1, 1)]
        points = place + np.concatenate(ends) @ turn.T
    elif shape.kind in ("sphere", "capsule"):
        half = shape.size[1] / 2 if shape.kind == "capsule" else 0.0
        ends = np.array([(0.0, 0.0, -half), (0.0, 0.0, half)])
        points = place + ends @ turn.T - (0.0, 0.0, shape.size[0])
    elif shape.kind == "box":
        corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * shape.size / 2
        points = place + corners @ turn.T
    else:
        points = place + np.array(shape.vertices).reshape(-1, 3) @ turn.T
    return points[points[:, 2] < 1e-4, :2]


@pytest.mark.parametrize("asset", HOLLOW, ids=lambda asset: asset.id)
def test_no_collider_reaches_into_the_hollow(asset: Asset) -> None:
    share = np.linspace(-0.499, 0.499, 9)
    grid = np.stack(np.meshgrid(share, share, share), axis=-1).reshape(-1, 3)
    points = asset.hollow.center + grid * asset.hollow.size
    floor = asset.hollow.center[2] - asset.hollow.size[2] / 2
    below = np.array([[*asset.hollow.center[:2], floor - 0.001]])
    found = colliders(asset)
    for collider in found:
        assert not _inside(points, *collider).any(), collider[0].prim
    assert any(_inside(below, *collider).any() for collider in found), "it has no floor"


def _inside(points: np.ndarray, shape: Shape, turn: np.ndarray, place: np.ndarray) -> np.ndarray:
    local = (points - place) @ turn
    if shape.kind == "box":
        return (np.abs(local) < np.array(shape.size) / 2).all(axis=1)
    if shape.kind in ("cylinder", "capsule"):
        radius, height = shape.size
        beyond = np.maximum(np.abs(local[:, 2]) - height / 2, 0.0)
        across = np.hypot(local[:, 0], local[:, 1])
        if shape.kind == "cylinder":
            return (across < radius) & (beyond == 0.0)
        return np.hypot(across, beyond) < radius
    if shape.kind == "sphere":
        return np.linalg.norm(local, axis=1) < shape.size[0]
    faces = ConvexHull(np.array(shape.vertices)).equations
    return (local @ faces[:, :3].T + faces[:, 3] < 0.0).all(axis=1)


def test_boards_of_the_crate_are_not_in_each_other() -> None:
    boxes = []
    stage = Usd.Stage.Open(str(CATALOGUE["crate"].path))
    for prim in stage.Traverse():
        if prim.IsA(UsdGeom.Mesh):
            corners = np.array(UsdGeom.Mesh(prim).GetPointsAttr().Get()).reshape(-1, 8, 3)
            boxes += [(points.min(axis=0), points.max(axis=0)) for points in corners]
    assert len(boxes) == 28
    for i, (low, high) in enumerate(boxes):
        for other_low, other_high in boxes[:i]:
            assert np.maximum(low - other_high, other_low - high).max() > -1e-5


def test_crate_falls_and_stands(tmp_path: Path) -> None:
    """It falls by g t^2 / 2 before it lands, and then stands upright on the ground, carried with its weight."""
    from wsim.recording import read
    from wsim.sim import Simulation

    drop = 0.05
    scene = Scene()
    scene.simulation(duration=0.5, frame_rate=50.0)
    scene.ground()
    crate = UsdGeom.Xform.Define(scene.stage, "/World/crate")
    crate.GetPrim().GetReferences().AddReference(str(CATALOGUE["crate"].path))
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
