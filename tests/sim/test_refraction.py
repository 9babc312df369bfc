"""Where a camera sees what lies under water, against Snell's law at a level surface."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import numpy as np
import pytest

from wsim.scene.world import Camera, Fluid, Shape, Static, World
from wsim.sim.cameras import CameraImage, CameraRenderer, Style
from wsim.sim.render_views import camera_pose, vertical_fov

_spec = importlib.util.spec_from_file_location("camera_stages", Path(__file__).parent / "camera_stages.py")
assert _spec is not None
assert _spec.loader is not None
stages = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(stages)

IOR, DEPTH, RADIUS = 1.33, 0.3, 0.05
BALL = np.array([0.0, 0.05, 0.12])


def pool(eye: tuple[float, float, float], **look: object) -> tuple[World, dict[str, np.ndarray]]:
    fluid = Fluid(
        prim="/World/liquid", density=1000.0, viscosity=1e-3, spacing=0.02, size=(0.8, 0.8, DEPTH),
        center=(0.0, 0.0, 0.5 * DEPTH), **look,
    )  # fmt: skip
    floor = Shape(prim="/World/floor/geometry", kind="box", size=(4, 4, 0.1), position=(0, 0, -0.05), color=(0.6,) * 3)
    ball = stages.body("ball", Shape(prim="", kind="sphere", size=(RADIUS,), color=(0.7, 0.04, 0.03)), tuple(BALL))
    camera = Camera(prim="/World/c", eye=eye, target=(0.0, 0.0, 0.2), fov=20.0, width=120, height=90)
    points = stages.particles(fluid)
    clear = np.linalg.norm(points - BALL, axis=1) > RADIUS + 0.5 * fluid.spacing
    world = World(
        statics=[Static(prim="/World/floor", shapes=[floor])], bodies=[ball], fluids=[fluid], cameras=[camera]
    )
    return world, {fluid.prim: points[clear]}


def draw(world: World, fluids: dict[str, np.ndarray], refraction: bool) -> tuple[CameraImage, int]:
    """The picture, and the ball's index in it."""
    model = stages.model_of(world)
    image = CameraRenderer(model, world, style=Style(refraction=refraction)).render(model.state(), fluids)["/World/c"]
    return image, [str(label) for label in model.shape_label].index("/World/ball/geometry")


def sees(camera: Camera, ior: float) -> np.ndarray:
    """Which pixels' rays meet the ball (H, W), bent at z = DEPTH by Snell's law."""
    pose = camera_pose(camera)
    x, y, z, w = pose[3:]
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    half = np.tan(0.5 * vertical_fov(camera))
    across = (2.0 * (np.arange(camera.width) + 0.5) / camera.width - 1.0) * half * camera.width / camera.height
    down = (1.0 - 2.0 * (np.arange(camera.height) + 0.5) / camera.height) * half
    rays = np.stack([*np.meshgrid(across, down), -np.ones((camera.height, camera.width))], axis=-1) @ turn.T
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    eye = np.array(camera.eye)
    surface = eye + rays * ((DEPTH - eye[2]) / rays[..., 2:])
    level = rays[..., :2] / ior  # sin of the angle to the vertical, by Snell
    below = np.concatenate([level, -np.sqrt(1.0 - (level**2).sum(axis=-1, keepdims=True))], axis=-1)
    to = BALL - surface
    along = (to * below).sum(axis=-1)
    return (np.linalg.norm(to - along[..., None] * below, axis=-1) < RADIUS) & (along > 0.0)


@pytest.mark.parametrize("eye", [(0.0, -1.2, 1.0), (1.0, -0.8, 0.9), (0.0, -0.2, 1.5)])
def test_a_ball_under_water_is_where_snells_law_has_it(eye: tuple[float, float, float]) -> None:
    world, fluids = pool(eye)
    for refraction, ior in ((True, IOR), (False, 1.0)):
        image, ball = draw(world, fluids, refraction)
        seen, expected = image.shape_index == ball, sees(world.cameras[0], ior)
        assert expected.sum() > 100
        # The surface around particles is level to a tenth of a spacing, and a pixel is 4 mm.
        assert (seen & expected).sum() / (seen | expected).sum() > 0.85
        middle, known = (np.argwhere(mask).mean(axis=0) for mask in (seen, expected))
        assert middle == pytest.approx(known, abs=0.8)  # [px]
    # The two are told apart.
    bent, straight = (np.argwhere(sees(world.cameras[0], ior)).mean(axis=0) for ior in (IOR, 1.0))
    assert np.linalg.norm(bent - straight) > 2.0


def test_depth_is_along_the_optical_axis_to_where_the_bent_ray_ends() -> None:
    world, fluids = pool((0.0, 0.05, 1.5))  # straight above the ball, which lies in the picture's upper middle
    image, ball = draw(world, fluids, refraction=True)
    rows, columns = np.nonzero(image.shape_index == ball)
    nearest = image.depth[rows, columns].min()
    eye, target = np.array(world.cameras[0].eye), np.array(world.cameras[0].target)
    axis = (target - eye) / np.linalg.norm(target - eye)
    assert nearest == pytest.approx((BALL - eye) @ axis - RADIUS, abs=0.002)


def test_what_a_liquid_hides_stays_hidden_and_a_dry_world_is_as_it_was() -> None:
    world, fluids = pool((0.0, -1.2, 1.0), color=(0.9, 0.88, 0.82), attenuation_length=0.001)
    milk = [draw(world, fluids, refraction)[0] for refraction in (True, False)]
    assert (milk[0].rgb == milk[1].rgb).all() and (milk[0].depth == milk[1].depth).all()
    dry = [draw(world, {}, refraction)[0] for refraction in (True, False)]
    assert (dry[0].rgb == dry[1].rgb).all()
