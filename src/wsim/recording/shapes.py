"""The part of a recording that never changes: what the viewer draws for bodies, statics, cords and cameras."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
import rerun as rr
from scipy.spatial.transform import Rotation

from wsim.geometry.colour import srgb_of
from wsim.geometry.rotations import line_of_sight, multiply, rotate
from wsim.recording.columns import entity_path
from wsim.scene.cord_lines import line_radii
from wsim.scene.following import way_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.scene.world import Body, Camera, Rope, Shape, Spring, Static, World

PLANE_THICKNESS = 0.02  # [m]
ROOT_FRAME = "tf#/"  # Rerun's name for the world's frame


def log_scene(stream: Any, world: World) -> None:
    """Log shapes, cords and what is known of each prim, all static, to a Rerun stream; cameras are known at the end."""
    stream.log("World", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True, strict=True)
    reach = scene_reach(world)
    owners: list[Body | Static] = [*world.bodies, *world.statics]
    for owner in owners:
        for shape in owner.shapes:
            visual = shape_visual(shape, reach)
            if visual is not None:
                stream.log(entity_path(shape.prim), visual, static=True, strict=True)
        stream.log(entity_path(owner.prim), _facts(owner), static=True, strict=True)
    for fluid in world.fluids:
        # One radius for all particles and all frames; positions and colours follow in time.
        radii = rr.Points3D.from_fields(radii=[0.5 * fluid.spacing])
        stream.log(entity_path(fluid.prim), radii, static=True, strict=True)
    for cord in world.cords:
        log_cord(stream, cord, nested=is_nested(cord.prim, world))


def log_cord(stream: Any, cord: Spring | Rope, nested: bool = False) -> None:
    """Log a spring's or a rope's colour and how thick its lines are, static; the lines follow in time."""
    radii = line_radii(cord)
    look = rr.LineStrips3D.from_fields(radii=radii, colors=[rgba(cord.color)] * len(radii))
    stream.log(entity_path(cord.prim), look, _facts(cord), static=True, strict=True)
    if nested:  # its lines are in the world, not in the frame of the body above it
        frame = rr.Transform3D(translation=(0.0, 0.0, 0.0), parent_frame=ROOT_FRAME)
        stream.log(entity_path(cord.prim), frame, static=True, strict=True)


def log_camera(stream: Any, camera: Camera, width: int, height: int, nested: bool = False) -> None:
    """Log a camera's pinhole, and its pose unless it follows a body, static.

    Its pictures have the size `width` and `height` [pixels]. The poses of one that follows come with the frames.
    """
    focal = 0.5 * width / math.tan(math.radians(camera.fov) / 2)
    distance = float(np.linalg.norm(np.subtract(camera.target, camera.eye)))
    pose = rr.Transform3D(
        translation=camera.eye,
        mat3x3=look_at(camera),
        parent_frame=ROOT_FRAME if nested else None,
    )
    pinhole = rr.Pinhole(
        focal_length=focal,
        width=width,
        height=height,
        camera_xyz=rr.ViewCoordinates.RDF,
        image_plane_distance=max(0.15 * distance, 1e-3),
    )
    stands = [pose] if camera.follows is None else []
    stream.log(entity_path(camera.prim), *stands, pinhole, static=True, strict=True)


def camera_poses(camera: Camera, world: World, poses: NDArray[Any]) -> NDArray[np.float32]:
    """Poses of a camera that follows (F, 7), by those of its body (F, 7), of axes x right, y down, z forward."""
    eyes, turned = way_of(camera, world, poses)
    turns = multiply(turned, Rotation.from_matrix(look_at(camera)).as_quat())
    return np.concatenate([eyes, turns], axis=1).astype(np.float32)


def look_at(camera: Camera) -> NDArray[np.float64]:
    """Rotation (3, 3) from camera axes (x right, y down, z forward) to the world."""
    right, forward = line_of_sight(camera.eye, camera.target, camera.up)
    return np.stack([right, np.cross(forward, right), forward], axis=1)


def is_nested(prim: str, world: World) -> bool:
    """Whether a body stands above `prim` in the tree: Rerun would then apply that body's pose as well."""
    return any(prim.startswith(body.prim + "/") for body in world.bodies)


def scene_reach(world: World) -> float:
    """How far the scene extends from the origin, at least 2 [m]; a ground plane is drawn a few times that."""
    points = [body.position for body in world.bodies]
    points += [shape.position for static in world.statics for shape in static.shapes]
    points += [fluid.center for fluid in world.fluids]
    if not points:
        return 2.0
    return max(2.0, float(np.abs(np.asarray(points, dtype=np.float64)[:, :2]).max()))


def rgba(color: tuple[float, float, float], opacity: float = 1.0) -> list[int]:
    """Linear RGB in 0..1 as the sRGB bytes that Rerun draws, with alpha."""
    linear = np.clip(np.asarray(color, dtype=np.float64), 0.0, 1.0)
    return [*(int(v) for v in np.rint(255 * srgb_of(linear))), round(255 * min(max(opacity, 0.0), 1.0))]


def shape_visual(shape: Shape, reach: float = 2.0) -> Any | None:
    """The Rerun archetype that draws a shape in its owner's frame; None for a mesh without vertices.

    The shape's own pose is in the archetype rather than in a transform of its entity, so that a shape whose prim is
    the body itself is drawn right too.
    """
    color = rgba(shape.color, shape.opacity)
    pose = {"centers": [shape.position], "quaternions": [shape.rotation]}
    look = {"colors": [color], "fill_mode": rr.components.FillMode.Solid}
    match shape.kind:
        case "box":
            return rr.Boxes3D(sizes=[shape.size], **pose, **look)
        case "sphere":
            return rr.Ellipsoids3D(radii=[shape.size[0]], **pose, **look)
        case "cylinder":
            return rr.Cylinders3D(radii=[shape.size[0]], lengths=[shape.size[1]], **pose, **look)
        case "capsule":
            radius, height = shape.size
            # Rerun's capsule starts at its origin; ours is centred on it.
            start = np.add(shape.position, rotate(np.array(shape.rotation), np.array([0.0, 0.0, -0.5 * height])))
            return rr.Capsules3D(
                radii=[radius], lengths=[height], translations=[start], quaternions=[shape.rotation], **look
            )
        case "plane":
            center = np.add(
                shape.position, rotate(np.array(shape.rotation), np.array([0.0, 0.0, -0.5 * PLANE_THICKNESS]))
            )
            size = (6.0 * reach, 6.0 * reach, PLANE_THICKNESS)
            return rr.Boxes3D(sizes=[size], centers=[center], quaternions=[shape.rotation], **look)
        case "mesh":
            return _mesh_visual(shape, color)


def _mesh_visual(shape: Shape, color: list[int]) -> Any | None:
    if not shape.vertices:
        return None
    vertices = rotate(np.array(shape.rotation), np.asarray(shape.vertices, dtype=np.float64)) + np.asarray(
        shape.position
    )
    # Corners of its own for each triangle give flat shading, which reads better than smoothed hulls.
    if shape.triangles:
        vertices = vertices[np.asarray(shape.triangles, dtype=np.int64).reshape(-1)]
    corners = vertices.reshape(-1, 3, 3)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    normals = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0.0)
    return rr.Mesh3D(vertex_positions=vertices, vertex_normals=np.repeat(normals, 3, axis=0), albedo_factor=color)


def _facts(owner: Body | Static | Spring | Rope) -> Any:
    """What the viewer's selection panel says of a prim."""
    facts: dict[str, Any] = {"prim": owner.prim}
    if owner.line is not None:
        facts["line"] = owner.line
    mass = getattr(owner, "mass", None)
    if mass is not None:
        facts["mass"] = mass
    return rr.DynamicArchetype("wsim.Prim", components=facts)
