"""How clear a liquid is drawn, against the Beer-Lambert law and Lambert's."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import numpy as np
import pytest

from wsim.scene.world import Camera, Fluid, Shape, Static, World
from wsim.sim import render_materials
from wsim.sim.cameras import CameraImage, CameraRenderer, Style

_spec = importlib.util.spec_from_file_location("camera_stages", Path(__file__).parent / "camera_stages.py")
assert _spec is not None
assert _spec.loader is not None
stages = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(stages)

ONLY_ABSORBS = Style(reflection=0.0, scatter=0.0, checker_contrast=0.0, smooth_edges=False)
MATT = Style(reflection=0.0, smooth_edges=False)
MILK = {"color": (0.9, 0.88, 0.82), "attenuation_length": 0.001}
LAVA = {"color": (0.9, 0.12, 0.01), "attenuation_length": 0.0}
COLA = {"color": (0.1, 0.03, 0.02), "attenuation_length": 0.02}
OIL = {"color": (0.75, 0.55, 0.08), "attenuation_length": 0.1}
BALL, DEEP, RADIUS = "/World/ball/geometry", 0.06, 0.05


def draw(world: World, fluids: dict, style: Style) -> CameraImage:
    model = stages.model_of(world)
    return CameraRenderer(model, world, style=style).render(model.state(), fluids)["/World/c"]


def linear(rgb: np.ndarray) -> np.ndarray:
    c = np.asarray(rgb, dtype=np.float64) / 255.0
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def block(depth: float, spacing: float = 0.02, **look: object) -> Fluid:
    return Fluid(
        prim="/World/liquid", density=1000.0, viscosity=1e-3, spacing=spacing, size=(0.4, 0.3, depth),
        center=(0.0, 0.0, 0.5 * depth), **look,
    )  # fmt: skip


def above(size: int = 32, fov: float = 4.0) -> Camera:
    return Camera(prim="/World/c", eye=(0.0, 0.0, 2.0), target=(0.0, 0.0, 0.0), fov=fov, width=size, height=size)


def plate() -> Static:
    box = Shape(prim="/World/plate/geometry", kind="box", size=(4, 4, 0.1), position=(0, 0, -0.05), color=(0.6,) * 3)
    return Static(prim="/World/plate", shapes=[box])


def with_ball(fluid: Fluid) -> tuple[World, dict[str, np.ndarray]]:
    """A red ball whose top is DEEP under the fluid's surface."""
    z = fluid.size[2] - DEEP - RADIUS
    red = stages.body("ball", Shape(prim="", kind="sphere", size=(RADIUS,), color=(0.7, 0.04, 0.03)), (0.0, 0.0, z))
    points = stages.particles(fluid)
    clear = np.linalg.norm(points - (0.0, 0.0, z), axis=1) > RADIUS + 0.5 * fluid.spacing
    world = World(statics=[plate()], bodies=[red], fluids=[fluid], cameras=[above(fov=12.0)])
    return world, {fluid.prim: points[clear]}


def looks_red(rgb: np.ndarray) -> bool:
    r, g, b = linear(rgb)
    return bool(r > 2.0 * max(g, b))


@pytest.mark.parametrize("look", [MILK, {"color": (0.03, 0.1, 0.5), "attenuation_length": 0.0}])
def test_what_is_in_an_opaque_liquid_is_not_seen(look: dict) -> None:
    world, fluids = with_ball(block(0.2, **look))
    image, without = draw(world, fluids, Style()), draw(world.model_copy(update={"bodies": []}), fluids, Style())
    middle = image.rgb[14:18, 14:18].reshape(-1, 3)
    assert not any(looks_red(rgb) for rgb in middle)
    # Nor is a line to be seen where the ball ends, nor does a pixel count for it; the depth is that of the surface.
    assert np.abs(image.rgb.astype(int) - without.rgb.astype(int)).max() <= 3
    assert (image.shape_index[8:24, 8:24] == -1).all()
    assert image.depth[16, 16] == pytest.approx(2.0 - 0.2, abs=0.004)


def test_what_is_in_water_is_seen_in_its_colour() -> None:
    world, fluids = with_ball(block(0.2))
    image = draw(world, fluids, Style())
    assert looks_red(image.rgb[16, 16])
    assert str(stages.model_of(world).shape_label[image.shape_index[16, 16]]) == BALL
    assert image.depth[16, 16] == pytest.approx(2.0 - 0.2 + DEEP, abs=0.001)


@pytest.mark.parametrize("look", [COLA, OIL])
@pytest.mark.parametrize("depth", [0.06, 0.12])
def test_a_tint_deepens_by_the_beer_lambert_law(look: dict, depth: float) -> None:
    """As much light of each colour comes through as exp(-a d); a mean of 1 / attenuation_length."""
    fluid = block(depth, 0.01, **look)
    wet = World(statics=[plate()], fluids=[fluid], cameras=[above()])
    a = render_materials.extinction_of_fluid(fluid)
    assert a.mean() == pytest.approx(1.0 / fluid.attenuation_length)
    assert np.diff(a / -np.log(fluid.color)) == pytest.approx(0.0, abs=1e-9)
    bare = linear(draw(wet.model_copy(update={"fluids": []}), {}, ONLY_ABSORBS).rgb[8:24, 8:24]).mean(axis=(0, 1))
    seen = linear(draw(wet, {fluid.prim: stages.particles(fluid)}, ONLY_ABSORBS).rgb[8:24, 8:24]).mean(axis=(0, 1))
    # A tenth of a spacing of depth, and a picture's byte, which is half a unit in 255.
    expected = np.exp(-a * depth)
    assert seen / bare == pytest.approx(expected, rel=0.1 * fluid.spacing * a.max() + 0.02, abs=0.002)


@pytest.mark.parametrize("look", [MILK, LAVA])
def test_an_opaque_liquid_is_lit_as_a_solid_of_its_colour(look: dict) -> None:
    """Its top beside that of a box of the same colour, under the same sun."""
    fluid = block(0.1, **look)
    lid = Shape(
        prim="/World/lid/geometry", kind="box", size=(0.4, 0.3, 0.1), position=(0, 0, 0.05), color=look["color"]
    )
    solid = World(statics=[Static(prim="/World/lid", shapes=[lid])], cameras=[above()])
    liquid = World(statics=[plate()], fluids=[fluid], cameras=[above()])
    wet = linear(draw(liquid, {fluid.prim: stages.particles(fluid)}, MATT).rgb[8:24, 8:24]).mean(axis=(0, 1))
    dry = linear(draw(solid, {}, MATT).rgb[8:24, 8:24]).mean(axis=(0, 1))
    assert wet == pytest.approx(dry, rel=0.06, abs=0.01)


def test_a_glass_tank_alone_is_drawn_as_beside_a_solid() -> None:
    """Where nothing is opaque the shapes' poses are not Newton's to set: those of the memory were drawn."""
    container, milk = stages.water_in_tank((0.3, 0.2, 0.3), 0.2, 0.02)
    milk = milk.model_copy(update=MILK)
    camera = above(64, 30.0).model_copy(update={"eye": (0.3, -0.9, 0.5), "target": (0.0, 0.0, 0.15)})
    alone = World(statics=[stages.tank((0.3, 0.2, 0.3))], containers=[container], fluids=[milk], cameras=[camera])
    far = stages.body("far", Shape(prim="", kind="sphere", size=(0.01,)), (0.0, -50.0, 0.0))  # behind the camera
    pictures = []
    for world in (alone, alone.model_copy(update={"bodies": [far]})):
        model = stages.model_of(world)
        renderer = CameraRenderer(model, world, style=MATT)
        if not world.bodies:
            model.bvh_shape_world_transforms.fill_(float("nan"))
        pictures.append(renderer.render(model.state(), {milk.prim: stages.particles(milk)})["/World/c"].rgb)
    assert np.ptp(pictures[0].astype(int)) > 50
    assert np.abs(pictures[0].astype(int) - pictures[1].astype(int)).max() <= 2


def test_an_opaque_liquid_turned_from_the_sun_is_darker_and_a_clear_one_is_filled_with_light() -> None:
    sides = {}
    for name, look in (("milk", MILK), ("water", {})):
        fluid = block(0.2, **look)
        for side in (-1.0, 1.0):  # the sun comes from +x
            camera = above().model_copy(update={"eye": (2.0 * side, 0.0, 0.1), "target": (0.0, 0.0, 0.1)})
            world = World(fluids=[fluid], cameras=[camera])
            image = draw(world, {fluid.prim: stages.particles(fluid)}, MATT)
            sides[name, side] = linear(image.rgb[8:24, 8:24]).mean()
    assert sides["milk", 1.0] > 1.5 * sides["milk", -1.0]
    assert sides["water", 1.0] == pytest.approx(sides["water", -1.0], rel=0.05)


@pytest.mark.parametrize("lap", [-0.004, 0.004])
def test_two_liquids_on_each_other_are_drawn_each_in_its_own_colour(lap: float) -> None:
    """Light through both is exp(-a d - a' d'), whether their surfaces overlap by a little or leave a little air."""
    low, high = block(0.08, 0.01, **COLA), block(0.06, 0.01, **OIL)
    high = high.model_copy(update={"prim": "/World/oil", "center": (0.0, 0.0, 0.08 + 0.03)})
    wet = World(statics=[plate()], fluids=[low, high], cameras=[above()])
    points = {low.prim: stages.particles(low), high.prim: stages.particles(high) - (0.0, 0.0, lap)}
    bare = linear(draw(wet.model_copy(update={"fluids": []}), {}, ONLY_ABSORBS).rgb[8:24, 8:24]).mean(axis=(0, 1))
    seen = linear(draw(wet, points, ONLY_ABSORBS).rgb[8:24, 8:24]).mean(axis=(0, 1))
    a, b = (render_materials.extinction_of_fluid(fluid) for fluid in (low, high))
    expected = np.exp(-a * 0.08 - b * 0.06)
    assert seen / bare == pytest.approx(expected, rel=(0.1 * 0.01 + abs(lap)) * max(a.max(), b.max()) + 0.02, abs=0.002)
