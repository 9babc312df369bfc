"""Cameras that follow a body: where they are once it has moved, and how a scene looks to one that goes along.

A camera is stated where it is when the world starts. One that follows keeps its offset from the body's origin; one that
turns as well keeps its place and its direction in the body's frame.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wsim.geometry.rotations import conjugate, multiply, rotate
from wsim.scene.world import Camera, Vec3, World
from wsim.scene.world_sensors import SensorCamera

Floats = NDArray[np.float64]


def camera_at(camera: Camera, world: World, pose: ArrayLike) -> Camera:
    """A camera that follows, as it is when its body has a pose.

    Args:
        camera: As the world starts.
        world: That it is of.
        pose: Of the body that it follows, (7,): position [m] and quaternion xyzw.

    Raises:
        KeyError: The world has no such body.
    """
    if camera.follows is None:
        return camera
    begin, turned = _start(camera, world, pose)
    now = np.asarray(pose, dtype=np.float64)[:3]
    eye, target = (_vec3(now + rotate(turned, np.subtract(place, begin))) for place in (camera.eye, camera.target))
    return camera.model_copy(
        update={"eye": eye, "target": target, "up": _vec3(rotate(turned, np.array(camera.up, dtype=np.float64)))}
    )


def view_of(sensor: SensorCamera, world: World) -> Camera:
    """The camera that a sensor is, as its world starts: it looks along +X of its frame, +Z up."""
    place, turn = np.array(sensor.position), np.array(sensor.rotation)
    if sensor.body is not None:
        body = world.body(sensor.body)
        turned = np.array(body.rotation)
        place, turn = np.array(body.position) + rotate(turned, place), multiply(turned, turn)
    ahead, up = (rotate(turn, axis) for axis in (np.array((1.0, 0.0, 0.0)), np.array((0.0, 0.0, 1.0))))
    return Camera(
        prim=sensor.prim, eye=_vec3(place), target=_vec3(place + ahead), up=_vec3(up), fov=sensor.fov,
        width=sensor.width, height=sensor.height, follows=sensor.body, turns=sensor.body is not None,
    )  # fmt: skip


def way_of(camera: Camera, world: World, poses: ArrayLike) -> tuple[Floats, Floats]:
    """Where the eye of a camera that follows is (F, 3) [m], and by how much it has turned since its start, (F, 4).

    Args:
        camera: As the world starts.
        world: That it is of.
        poses: Of the body that it follows, one for each frame, (F, 7).
    """
    begin, turned = _start(camera, world, poses)
    return np.asarray(poses, dtype=np.float64)[:, :3] + rotate(turned, np.subtract(camera.eye, begin)), turned


def as_at_start(camera: Camera, world: World, poses: ArrayLike, points: Floats) -> Floats:
    """Points as the camera would have to see them at its start, for the picture that it has of them when it has moved.

    Args:
        camera: As the world starts.
        world: That it is of.
        poses: Of the body that it follows, one for each frame, (F, 7).
        points: (F, n, 3) [m].

    Returns:
        (F, n, 3) [m].
    """
    if camera.follows is None:
        return points
    begin, turned = _start(camera, world, poses)
    now = np.asarray(poses, dtype=np.float64)[:, None, :3]
    return begin + rotate(conjugate(turned)[:, None, :], points - now)


def _start(camera: Camera, world: World, pose: ArrayLike) -> tuple[Floats, Floats]:
    """Where the body that is followed starts (3,) [m], and by how much the camera has turned since, (..., 4)."""
    assert camera.follows is not None  # the callers have looked
    body, q = world.body(camera.follows), np.asarray(pose, dtype=np.float64)[..., 3:]
    if camera.turns:
        turned = multiply(q, conjugate(np.array(body.rotation)))
    else:
        turned = np.broadcast_to((0.0, 0.0, 0.0, 1.0), q.shape)
    return np.array(body.position), turned


def _vec3(v: Floats) -> Vec3:
    return (float(v[0]), float(v[1]), float(v[2]))
