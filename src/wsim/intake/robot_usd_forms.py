"""Shapes of USD bodies → what is seen of a link, and what collides."""

from __future__ import annotations

import numpy as np
from pxr import Usd, UsdGeom

from wsim.defaults import FRICTION
from wsim.geometry.rotations import multiply, rotate
from wsim.importers.mujoco_names import clean
from wsim.importers.mujoco_shapes import hull_of_points
from wsim.intake.model import Array
from wsim.intake.robot_forms import MOST_SEEN, thinned
from wsim.intake.robot_model import Form
from wsim.scene.world import Body, Shape

Pose = tuple[Array, Array]


def forms_of(stage: Usd.Stage, bodies: list[tuple[Body, Pose]]) -> tuple[list[Form], list[Form]]:
    """What is seen and what collides of bodies that are one link, each at a pose in it."""
    shapes = [(shape, pose) for body, pose in bodies for shape in body.shapes if shape.kind != "plane"]
    shown = [each for each in shapes if _is_seen(stage, each[0])]
    seen = [_form(shape, pose, whole=True) for shape, pose in shown]
    return seen, [_form(shape, pose, whole=False) for shape, pose in shapes if shape.collides]


def _is_seen(stage: Usd.Stage, shape: Shape) -> bool:
    image = UsdGeom.Imageable(stage.GetPrimAtPath(shape.prim))
    hidden = image.ComputeVisibility() == UsdGeom.Tokens.invisible
    return not hidden and image.ComputePurpose() != UsdGeom.Tokens.guide


def _form(shape: Shape, pose: Pose, *, whole: bool) -> Form:
    """A shape in the link's frame; `whole`: a mesh as it is, else its hull."""
    at = pose[0] + rotate(pose[1], np.array(shape.position))
    turn = multiply(pose[1], np.array(shape.rotation))
    name = clean(shape.prim.rpartition("/")[2])
    friction = FRICTION if shape.friction is None else shape.friction
    red, green, blue = (round(float(part), 4) for part in shape.color)
    if shape.kind != "mesh":
        return Form(name, shape.kind, shape.size, at, turn, (red, green, blue), friction)  # type: ignore[arg-type]
    points, faces = np.array(shape.vertices), np.array(shape.triangles, dtype=np.int64)
    points, faces = thinned(points, faces, MOST_SEEN) if whole else hull_of_points(points)
    return Form(name, "mesh", (), at, turn, (red, green, blue), friction, points, faces)
