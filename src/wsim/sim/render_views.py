"""Where cameras stand and which rays they cast."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial.transform import Rotation

from wsim.geometry.rotations import line_of_sight
from wsim.geometry.shapes import kind_of
from wsim.scene.world import Camera

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsim.scene.world import Shape, World

DEFAULT_CAMERA = "/World/default_camera"
FILLED = 0.86  # share of the frame that a default view fills
GROUND_EDGE = 20.0  # [m]: a box at least this long in x and y is taken for ground


def camera_pose(camera: Camera) -> tuple[float, ...]:
    """Position and quaternion (xyzw) of a frame that looks along its -Z from eye to target, +Y up."""
    if math.dist(camera.eye, camera.target) < 1e-9:
        raise ValueError(f"camera {camera.prim}: eye and target are the same point, {camera.eye}")
    right, forward = line_of_sight(camera.eye, camera.target, camera.up)
    up = np.cross(right, forward)
    rotation = Rotation.from_matrix(np.column_stack((right, up, -forward)))
    return (*map(float, camera.eye), *map(float, rotation.as_quat()))


def vertical_fov(camera: Camera) -> float:
    """Vertical field of view [rad] of a camera whose `fov` is horizontal [deg]."""
    return 2.0 * math.atan(math.tan(math.radians(camera.fov) / 2.0) * camera.height / camera.width)


def resized(camera: Camera, width: int | None, height: int | None) -> Camera:
    """The camera with another picture size; one number alone keeps the aspect ratio."""
    if width is None and height is None:
        return camera
    aspect = camera.width / camera.height
    w = width if width is not None else max(1, round((height or camera.height) * aspect))
    h = height if height is not None else max(1, round(w / aspect))
    if w < 1 or h < 1:
        raise ValueError(f"camera {camera.prim}: width and height must be at least 1, not {w} x {h}")
    return camera.model_copy(update={"width": w, "height": h})


def is_ground(shape: Shape) -> bool:
    """Whether a static shape is the ground: a plane, or a very wide box."""
    if shape.kind == "plane":
        return True
    return shape.kind == "box" and min(shape.size[0], shape.size[1]) >= GROUND_EDGE


def bounds(world: World) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest corner [m] of all there is but the ground, at t = 0; a metre's cube if there is nothing."""
    corners = [points for points in _corners(world) if len(points)]
    if not corners:
        return np.array((-0.5, -0.5, 0.0)), np.array((0.5, 0.5, 1.0))
    points = np.concatenate(corners)
    return points.min(axis=0), points.max(axis=0)


def default_camera(world: World, width: int = 640, height: int = 360) -> Camera:
    """A three-quarter view from the front left, a little from above, that has everything in frame."""
    low, high = bounds(world)
    corners = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * (high - low) + low
    camera = Camera(prim=DEFAULT_CAMERA, eye=(1, 0, 0), target=(0, 0, 0), fov=45.0, width=width, height=height)
    return fitted(corners, -62.0, 20.0, camera)


def fitted(points: np.ndarray, azimuth: float, elevation: float, camera: Camera) -> Camera:
    """A camera of a lens and a picture, standing where points just fill its frame.

    Args:
        points: (n, 3) [m].
        azimuth: Of the side where it stands [deg], from +X to +Y.
        elevation: [deg].
        camera: Whose lens, picture and prim it has; it follows nothing.
    """
    turn, rise = math.radians(azimuth), math.radians(min(elevation, 89.0))
    back = np.array((math.cos(turn) * math.cos(rise), math.sin(turn) * math.cos(rise), math.sin(rise)))
    right = np.array((-math.sin(turn), math.cos(turn), 0.0))
    up = np.cross(back, right)
    half_width = FILLED * math.tan(0.5 * math.radians(camera.fov))
    half_height = FILLED * math.tan(0.5 * vertical_fov(camera))
    # Seen along `back`, a corner is in frame if its offset across is at most its distance times the frame's slope.
    across, above, toward = points @ right, points @ up, points @ back
    x = 0.5 * (across.min() + across.max())
    y = 0.5 * (above.min() + above.max())
    eye_at = max(
        float((toward + np.abs(across - x) / half_width).max()), float((toward + np.abs(above - y) / half_height).max())
    )
    target_at = 0.5 * float(toward.min() + toward.max())
    eye, target = (x * right + y * up + at * back for at in (max(eye_at, target_at + 1e-3), target_at))
    place, aim = (tuple(float(v) for v in each) for each in (eye, target))
    return camera.model_copy(
        update={"eye": place, "target": aim, "up": (0.0, 0.0, 1.0), "follows": None, "turns": False}
    )


def _corners(world: World) -> Iterator[np.ndarray]:
    """Points that enclose everything but the ground, in the world's frame."""
    for static in world.statics:
        for shape in static.shapes:
            if not is_ground(shape):
                yield placed(outline(shape), shape.position, shape.rotation)
    for body in world.bodies:
        for shape in body.shapes:
            points = placed(outline(shape), shape.position, shape.rotation)
            yield placed(points, body.position, body.rotation)
    for fluid in world.fluids:
        yield _box(0.5 * np.asarray(fluid.size)) + np.asarray(fluid.center)


def outline(shape: Shape) -> np.ndarray:
    """Points whose hull encloses a shape, in its own frame [m]."""
    if shape.vertices:
        return np.asarray(shape.vertices)
    return _box(0.5 * np.asarray(kind_of(shape).edges)) if shape.kind != "plane" else np.zeros((1, 3))


def _box(half: np.ndarray) -> np.ndarray:
    return np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * half


def placed(points: np.ndarray, position: tuple[float, ...], rotation: tuple[float, ...]) -> np.ndarray:
    """Points (n, 3) of a frame that stands and is turned in another, in that one."""
    return Rotation.from_quat(rotation).apply(points) + np.asarray(position)
