"""What a camera sees, against geometry and the Beer-Lambert law."""

from __future__ import annotations

import importlib.util
import math
from pathlib import Path

import newton
import numpy as np
import pytest

from wsim.scene.world import Camera, Fluid, Shape, Static, World
from wsim.sim import render_materials, render_views
from wsim.sim.cameras import CameraImage, CameraRenderer, Style
from wsim.sim.render_surface import FluidMesh

_spec = importlib.util.spec_from_file_location("camera_stages", Path(__file__).parent / "camera_stages.py")
assert _spec is not None
assert _spec.loader is not None
stages = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(stages)

PLAIN = Style(reflection=0.0, scatter=0.0, checker_contrast=0.0, smooth_edges=False)


def look_down(height: float, size: int = 48, fov: float = 20.0) -> Camera:
    return Camera(prim="/World/down", eye=(0.0, 0.0, height), target=(0.0, 0.0, 0.0), fov=fov, width=size, height=size)


def draw(world: World, fluids: dict | None = None, style: Style = PLAIN, **size: int) -> CameraImage:
    model = stages.model_of(world)
    images = CameraRenderer(model, world, style=style, **size).render(model.state(), fluids)
    assert len(images) == 1
    return next(iter(images.values()))


def linear(rgb: np.ndarray) -> np.ndarray:
    c = np.asarray(rgb, dtype=np.float64) / 255.0
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def plate(color: float = 0.6) -> Static:
    shape = Shape(
        prim="/World/plate/geometry", kind="box", size=(4.0, 4.0, 0.1), position=(0, 0, -0.05), color=(color,) * 3
    )
    return Static(prim="/World/plate", shapes=[shape])


def ball(radius: float, z: float) -> object:
    return stages.body("ball", Shape(prim="", kind="sphere", size=(radius,), color=(0.6, 0.2, 0.1)), (0.0, 0.0, z))


def free_water(depth: float, spacing: float = 0.1) -> Fluid:
    return Fluid(
        prim="/World/water",
        density=1000.0,
        viscosity=1e-3,
        spacing=spacing,
        size=(1.6, 1.6, depth),
        center=(0.0, 0.0, 0.2 + 0.5 * depth),
    )


def test_sphere_covers_its_solid_angle_and_its_depth_is_right() -> None:
    radius, distance, size, fov = 0.3, 3.0, 160, 20.0
    world = World(bodies=[ball(radius, 0.0)], cameras=[look_down(distance, size, fov)])
    image = draw(world)
    focal = 0.5 * size / math.tan(math.radians(0.5 * fov))
    # Seen down its axis, a sphere's outline is the circle of the tangent cone: sin(angle) = radius / distance.
    expected = math.pi * (focal * math.tan(math.asin(radius / distance))) ** 2
    index = world_index(world, "/World/ball/geometry")
    assert (image.shape_index == index).sum() == pytest.approx(expected, rel=0.01)
    middle = size // 2
    assert image.shape_index[middle, middle] == index
    assert image.depth[middle, middle] == pytest.approx(distance - radius, abs=1e-3)
    assert image.shape_index[0, 0] == -1
    assert image.depth[0, 0] == 0.0


def world_index(world: World, prim: str) -> int:
    return list(stages.model_of(world).shape_label).index(prim)


def test_depth_is_along_the_optical_axis() -> None:
    image = draw(World(statics=[plate()], cameras=[look_down(2.0, fov=60.0)]))
    assert image.depth == pytest.approx(2.0, abs=1e-3)


def test_horizontal_field_of_view() -> None:
    # A plate 4 m wide at 2 m fills exactly 90 degrees across.
    camera = look_down(2.0, fov=100.0).model_copy(update={"width": 200, "height": 50})
    image = draw(World(statics=[plate()], cameras=[camera]))
    expected = 200 / math.tan(math.radians(50.0))
    assert (image.shape_index[25] >= 0).sum() == pytest.approx(expected, abs=2)


def test_image_is_upright_and_not_mirrored() -> None:
    camera = Camera(prim="/World/side", eye=(0, -4, 0.0), target=(0, 0, 0), width=64, height=64)
    box = Shape(prim="", kind="box", size=(0.4, 0.4, 0.4))
    world = World(bodies=[stages.body("b", box, (0.8, 0.0, 0.8))], cameras=[camera])
    rows, columns = np.nonzero(draw(world).shape_index == 0)
    assert rows.max() < 32  # above
    assert columns.min() > 32  # +x is on the right of one who looks along +y


def test_beer_lambert_through_water() -> None:
    depths = (0.4, 0.8)
    dry = linear(draw(World(statics=[plate()], cameras=[look_down(4.0, fov=5.0)])).rgb[20:28, 20:28]).mean(axis=(0, 1))
    for depth in depths:
        fluid = free_water(depth)
        world = World(statics=[plate()], fluids=[fluid], cameras=[look_down(4.0, fov=5.0)])
        wet = linear(draw(world, {fluid.prim: stages.particles(fluid)}).rgb[20:28, 20:28]).mean(axis=(0, 1))
        expected = np.exp(-render_materials.extinction_of_fluid(fluid) * depth)
        assert expected.max() - expected.min() > 0.1
        # The surface is extracted on a grid: its thickness is right to a small part of the spacing.
        assert wet / dry == pytest.approx(expected, rel=0.025)


def test_glass_dims_by_its_thickness_and_leaves_the_shape_index() -> None:
    pane = Shape(
        prim="/World/pane/geometry",
        kind="box",
        size=(3, 3, 0.1),
        position=(0, 0, 1),
        color=(0.5, 0.8, 0.9),
        opacity=0.5,
    )
    behind = World(statics=[plate()], bodies=[ball(0.3, 0.3)], cameras=[look_down(4.0)])
    through = behind.model_copy(update={"statics": [plate(), Static(prim="/World/pane", shapes=[pane])]})
    bare, glazed = draw(behind), draw(through)
    prims = {w: np.asarray(["", *stages.model_of(w_).shape_label]) for w, w_ in (("bare", behind), ("glazed", through))}
    assert (prims["bare"][bare.shape_index + 1] == prims["glazed"][glazed.shape_index + 1]).all()
    assert glazed.depth == pytest.approx(bare.depth, abs=1e-4)
    ratio = linear(glazed.rgb[22:26, 22:26]).mean(axis=(0, 1)) / linear(bare.rgb[22:26, 22:26]).mean(axis=(0, 1))
    expected = np.exp(-render_materials.extinction_of_glass(pane, 0.1) * 0.1)
    assert ratio == pytest.approx(expected, rel=0.03)


def test_ground_of_ice_is_drawn_as_ground() -> None:
    """A plane has no thickness to look through."""
    plane = Shape(prim="/World/ground/geometry", kind="plane", size=(), color=(0.7, 0.8, 0.9), opacity=0.6)
    image = draw(World(statics=[Static(prim="/World/ground", shapes=[plane])], cameras=[look_down(3.0)]))
    assert np.all(image.shape_index == 0)


@pytest.mark.parametrize("kind", ["sphere", "cylinder"])
def test_round_glass_absorbs_along_its_chord(kind: str) -> None:
    size = (0.4,) if kind == "sphere" else (0.4, 0.8)
    glass = Shape(prim="", kind=kind, size=size, color=(0.3, 0.6, 0.9), opacity=0.6)
    world = World(statics=[plate()], bodies=[stages.body("glass", glass, (0.0, 0.0, 1.0))], cameras=[look_down(4.0)])
    bare = draw(World(statics=[plate()], cameras=[look_down(4.0)]))
    glazed = draw(world)
    assert (glazed.shape_index == 0).all()
    ratio = linear(glazed.rgb[23:25, 23:25]).mean(axis=(0, 1)) / linear(bare.rgb[23:25, 23:25]).mean(axis=(0, 1))
    assert ratio == pytest.approx(np.exp(-render_materials.extinction_of_glass(glass, 0.8) * 0.8), rel=0.05)


def test_water_at_rest_is_level_and_reaches_the_walls() -> None:
    inner, level, spacing = (1.0, 0.6, 0.6), 0.3, 0.05
    container, fluid = stages.water_in_tank(inner, level, spacing)
    world = World(statics=[stages.tank(inner)], containers=[container], fluids=[fluid])
    mesh = FluidMesh(stages.model_of(world), world)
    mesh.update({fluid.prim: stages.particles(fluid)})
    points = mesh.points()
    top = points[(np.abs(points[:, 0]) < 0.35) & (np.abs(points[:, 1]) < 0.2) & (points[:, 2] > 0.2)][:, 2]
    assert len(top) > 50
    assert top.mean() == pytest.approx(0.02 + level, abs=0.1 * spacing)
    assert top.std() < 0.03 * spacing
    low, high = points.min(axis=0), points.max(axis=0)
    # It ends in the glass: no gap, and not beyond the wall.
    assert 0.0 <= high[0] - 0.5 < 0.02
    assert 0.0 <= -0.5 - low[0] < 0.02
    assert 0.0 <= high[1] - 0.3 < 0.02
    assert 0.0 <= 0.02 - low[2] < 0.02


def test_what_is_under_water_is_seen_and_named() -> None:
    world, fluids = stages.aquarium(wave=0.0)
    image = draw(world, fluids, style=Style(refraction=False), width=320)
    dry = draw(world, {}, style=Style(), width=320)
    assert (image.shape_index == dry.shape_index).all()
    ball_index = world_index(world, "/World/ball/geometry")
    seen = image.shape_index == ball_index
    assert seen.sum() > 100
    change = np.abs(image.rgb[seen].astype(int) - dry.rgb[seen].astype(int)).mean()
    assert change > 4.0
    assert image.rgb.min() > 5  # no black pixels
    walls = [i for i, label in enumerate(stages.model_of(world).shape_label) if "/tank/" in label]
    assert not np.isin(image.shape_index, walls).any()


def test_water_stays_in_its_tank() -> None:
    world, fluids = stages.aquarium(wave=0.0)
    wet = draw(world, fluids, style=Style(smooth_edges=False), width=320)
    dry = draw(world, {}, style=Style(smooth_edges=False), width=320)
    changed = (np.abs(wet.rgb.astype(int) - dry.rgb.astype(int)) > 1).any(axis=2)
    glass = World(statics=[_opaque(s) for s in world.statics if s.prim == "/World/tank"], cameras=world.cameras)
    tank = draw(glass, width=320).shape_index >= 0
    assert changed.sum() > 0.1 * changed.size
    assert not (changed & ~tank).any()


def _opaque(static: Static) -> Static:
    return static.model_copy(update={"shapes": [s.model_copy(update={"opacity": 1.0}) for s in static.shapes]})


def test_default_view_has_everything_in_frame() -> None:
    world, fluids = stages.aquarium()
    world = world.model_copy(
        update={"cameras": [], "statics": [stages.ground(), *(_opaque(s) for s in world.statics[1:])]}
    )
    image = draw(world, fluids)
    assert image.rgb.shape == (360, 640, 3)
    ground = world_index(world, "/World/ground/geometry")
    rows, columns = np.nonzero((image.shape_index >= 0) & (image.shape_index != ground))
    assert rows.min() > 0
    assert rows.max() < 359
    assert columns.min() > 0
    assert columns.max() < 639
    assert max((np.ptp(rows)) / 360, np.ptp(columns) / 640) > 0.6  # and not lost in it


def test_default_camera_of_an_empty_world() -> None:
    camera = render_views.default_camera(World())
    assert camera.eye[2] > camera.target[2] > 0.0


def test_size_override_keeps_aspect_and_numbers_are_refused() -> None:
    camera = look_down(1.0).model_copy(update={"width": 640, "height": 360})
    assert (render_views.resized(camera, 320, None).width, render_views.resized(camera, 320, None).height) == (320, 180)
    assert render_views.resized(camera, None, 90).width == 160
    with pytest.raises(ValueError, match="at least 1"):
        render_views.resized(camera, 0, None)


def test_camera_that_looks_at_itself_is_refused() -> None:
    with pytest.raises(ValueError, match="/World/c"):
        render_views.camera_pose(Camera(prim="/World/c", eye=(1, 1, 1), target=(1, 1, 1)))


@pytest.mark.parametrize("turns", [False, True])
def test_a_camera_that_follows_keeps_its_body_where_it_was_in_the_picture(turns: bool) -> None:
    """A box that is 30 m away and has turned by 90 degrees: one that turns too sees the same face of it."""
    box = stages.body("box", Shape(prim="", kind="box", size=(1.0, 0.4, 0.2), color=(0.6, 0.2, 0.1)), (0.0, 0.0, 1.0))
    behind = Camera(prim="/World/c", eye=(-3.0, 0.0, 1.0), target=(0.0, 0.0, 1.0), width=96, height=54, turns=turns)
    world = World(bodies=[box], cameras=[behind.model_copy(update={"follows": box.prim})])
    model = stages.model_of(world)
    state, renderer = model.state(), CameraRenderer(model, world, style=PLAIN)
    before = renderer.render(state)[behind.prim].shape_index >= 0
    half = math.sqrt(0.5)
    state.body_q.assign(np.array([(30.0, -7.0, 2.0, 0.0, 0.0, half, half)], dtype=np.float32))
    after = renderer.render(state)[behind.prim].shape_index >= 0
    middle = np.argwhere(after).mean(axis=0) - np.argwhere(before).mean(axis=0)
    assert np.abs(middle).max() <= 0.5
    if turns:
        assert (before != after).mean() < 0.01
    else:  # its long side, at 2.8 m of its nearest face, in place of its short one at 2.5 m
        wide = [int(np.ptp(np.nonzero(seen.any(axis=0))[0])) + 1 for seen in (before, after)]
        focal = 48.0 / math.tan(math.radians(25.0))
        assert wide == pytest.approx([focal * 0.4 / 2.5, focal * 1.0 / 2.8], abs=1.5)
    state.body_q.assign(np.array([(0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)], dtype=np.float32))
    assert (renderer.render(state)[behind.prim].shape_index >= 0).tolist() == before.tolist()


def test_shape_colors_come_from_the_world_and_flags_stay() -> None:
    world, _ = stages.aquarium()
    model = stages.model_of(world)
    flags = model.shape_flags.numpy().copy()
    renderer = CameraRenderer(model, world, width=32)
    index = renderer.shape_prims.index("/World/block_0/geometry")
    assert linear(model.shape_color.numpy()[index] * 255.0) == pytest.approx((0.55, 0.30, 0.12), abs=1e-4)
    assert (model.shape_flags.numpy() == flags).all()


def test_bad_fluids_are_refused() -> None:
    world, fluids = stages.aquarium()
    model = stages.model_of(world)
    renderer = CameraRenderer(model, world, width=32)
    with pytest.raises(KeyError, match="/World/water"):
        renderer.render(model.state(), {"/World/wine": np.zeros((1, 3))})
    with pytest.raises(ValueError, match=r"\(N, 3\)"):
        renderer.render(model.state(), {"/World/water": np.zeros((4, 2))})
    points = np.concatenate(([[np.nan] * 3, [1e9, 0.0, 0.0]], fluids["/World/water"]))
    lost = renderer.render(model.state(), {"/World/water": points})["/World/side"]
    whole = renderer.render(model.state(), fluids)["/World/side"]
    assert np.abs(lost.rgb.astype(int) - whole.rgb.astype(int)).max() <= 2


def test_moving_body_moves_in_the_picture() -> None:
    world = World(bodies=[ball(0.3, 0.0)], cameras=[look_down(4.0)])
    model = stages.model_of(world)
    renderer = CameraRenderer(model, world, style=PLAIN)
    state = model.state()
    before = renderer.render(state)["/World/down"].shape_index
    pose = state.body_q.numpy()
    pose[0, 0] += 0.2
    state.body_q.assign(pose)
    after = renderer.render(state)["/World/down"].shape_index
    assert (before == 0).sum() == pytest.approx((after == 0).sum(), rel=0.1)
    assert np.nonzero(after == 0)[1].mean() > np.nonzero(before == 0)[1].mean() + 3


def test_each_world_of_a_batch_is_drawn_as_if_alone() -> None:
    world, fluids = stages.aquarium()
    alone = draw(world, fluids, style=Style(), width=96)
    batch = newton.ModelBuilder()
    batch.replicate(stages.builder_of(world), 3)
    model = batch.finalize(device="cpu")
    state = model.state()
    pose = state.body_q.numpy()
    pose[2::3, 2] += 1.0  # every world's third body is the ball: in the others it is lifted
    pose[5, 2] -= 1.0
    state.body_q.assign(pose)
    image = CameraRenderer(model, world, width=96, world_index=1).render(state, fluids)["/World/side"]
    assert np.abs(image.rgb.astype(int) - alone.rgb.astype(int)).max() <= 2
    labels = [model.shape_label[i] for i in np.unique(image.shape_index) if i >= 0]
    assert any(str(label).endswith("/World/ball/geometry") for label in labels)
    with pytest.raises(ValueError, match="world_index 3"):
        CameraRenderer(model, world, width=96, world_index=3)


def test_progress_is_told() -> None:
    told: list[tuple[str, float, float]] = []
    world = World(bodies=[ball(0.3, 0.0)], cameras=[look_down(4.0)])
    CameraRenderer(stages.model_of(world), world, progress=lambda *step: told.append(step))
    assert told[0][1:] == (0.0, 1.0)
    assert told[-1][1:] == (1.0, 1.0)


@pytest.mark.parametrize("distance", [6.0, 17.0, 40.0, 150.0])
@pytest.mark.parametrize(("kind", "size"), [("box", (2.0, 2.0, 2.0)), ("cylinder", (1.0, 2.0))])
def test_a_flat_face_is_of_one_shade_from_any_distance(kind: str, size: tuple[float, ...], distance: float) -> None:
    """A slanting view of a lit top: in single precision no face may be lost as distances grow."""
    solid = stages.body("solid", Shape(prim="", kind=kind, size=size, color=(0.6, 0.6, 0.6)), (0.0, 0.0, 0.0))
    eye = np.array((0.6, 0.0, 0.8)) * distance + (0.0, 0.0, 1.0)
    fov = math.degrees(2.0 * math.atan(0.5 / distance))  # half a metre of the top about its middle, and no edge
    camera = Camera(prim="/World/c", eye=tuple(eye), target=(0.0, 0.0, 1.0), fov=fov, width=64, height=48)
    image = draw(World(bodies=[solid], cameras=[camera]))
    np.testing.assert_array_equal(image.shape_index, world_index(World(bodies=[solid]), "/World/solid/geometry"))
    assert np.ptp(image.rgb.reshape(-1, 3).astype(int), axis=0).max() <= 2
    assert image.depth[24, 32] == pytest.approx(distance, rel=0.01)
