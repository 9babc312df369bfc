"""MuJoCo's geometries of a link → what is seen of it, and what collides."""

from __future__ import annotations

from typing import Any

import numpy as np

from wsim.geometry.rotations import conjugate, multiply, rotate
from wsim.importers.mujoco_names import clean, element
from wsim.importers.mujoco_shapes import GEOM, collides, hull_of_points, points_of
from wsim.importers.mujoco_tree import Pose, Tree
from wsim.intake.model import Color
from wsim.intake.robot_model import Form, FormKind

SHOWN_GROUPS = 3  # MuJoCo's viewer draws groups 0 to 2
MOST_SEEN = 6000  # faces of a mesh that is looked at
PLAIN: dict[Any, FormKind] = {
    GEOM.mjGEOM_BOX: "box", GEOM.mjGEOM_SPHERE: "sphere", GEOM.mjGEOM_CAPSULE: "capsule",
    GEOM.mjGEOM_CYLINDER: "cylinder",
}  # fmt: skip


def forms_of(
    model: Any, tree: Tree, members: list[int], frame: Pose, notes: list[str]
) -> tuple[list[Form], list[Form]]:
    """What is seen and what collides of bodies that move as one, in a frame."""
    geoms = [g for b in members for g in tree.geoms(b)]
    touched = [g for g in geoms if collides(model, g)]
    shown = [g for g in geoms if g not in touched and model.geom_group[g] < SHOWN_GROUPS and _alpha(model, g) > 0.0]
    if not any(model.geom_type[g] == int(GEOM.mjGEOM_MESH) for g in shown):
        shown += [g for g in touched if model.geom_group[g] < SHOWN_GROUPS or not shown]
    seen = [form for g in shown if (form := _form(model, tree, g, frame, notes, whole=True)) is not None]
    solid = [form for g in touched if (form := _form(model, tree, g, frame, notes, whole=False)) is not None]
    return seen, solid


def _form(model: Any, tree: Tree, g: int, frame: Pose, notes: list[str], *, whole: bool) -> Form | None:
    """A geometry in a frame; `whole`: a mesh as it is, else its hull."""
    kind = GEOM(int(model.geom_type[g]))
    at, facing = tree.pose(int(model.geom_bodyid[g]))
    back = conjugate(frame[1])
    place = rotate(back, at + rotate(facing, model.geom_pos[g]) - frame[0])
    turn = multiply(back, multiply(facing, Tree.xyzw(model.geom_quat[g])))
    name, friction = clean(element(model, "geom", g)), float(model.geom_friction[g, 0])
    a, b, c = (float(x) for x in model.geom_size[g])
    if kind in PLAIN:
        sizes = {"box": (2 * a, 2 * b, 2 * c), "sphere": (a,)}.get(PLAIN[kind], (a, 2 * b))
        return Form(name, PLAIN[kind], sizes, place, turn, _color(model, g), friction)
    if kind == GEOM.mjGEOM_MESH and whole:
        points, faces = _mesh(model, int(model.geom_dataid[g]), notes)
    elif kind in (GEOM.mjGEOM_MESH, GEOM.mjGEOM_ELLIPSOID):
        points, faces = hull_of_points(points_of(model, g))
    else:
        notes.append(f"not carried: shapes of kind {kind.name[7:].lower()}")
        return None
    return Form(name, "mesh", (), place, turn, _color(model, g), friction, points, faces)


def _alpha(model: Any, g: int) -> float:
    return float(model.geom_rgba[g, 3])


def _color(model: Any, g: int) -> Color:
    material = int(model.geom_matid[g])
    red, green, blue = (model.mat_rgba[material] if material >= 0 else model.geom_rgba[g])[:3]
    return (round(float(red), 4), round(float(green), 4), round(float(blue), 4))


def _mesh(model: Any, mesh: int, notes: list[str]) -> tuple[np.ndarray, np.ndarray]:
    first, count = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
    start, number = int(model.mesh_faceadr[mesh]), int(model.mesh_facenum[mesh])
    points = np.array(model.mesh_vert[first : first + count], dtype=np.float64)
    faces = np.array(model.mesh_face[start : start + number], dtype=np.int64)
    if len(faces) > MOST_SEEN:
        notes.append(f"looks of more than {MOST_SEEN} triangles are thinned out; what collides is as in the file")
        points, faces = thinned(points, faces, MOST_SEEN)
    return points, faces


def thinned(points: np.ndarray, faces: np.ndarray, most: int) -> tuple[np.ndarray, np.ndarray]:
    """At most so many triangles: points of a cell of a grid become one (Rossignac and Borrel 1993)."""
    low, extent = points.min(axis=0), float(np.ptp(points, axis=0).max())
    cells = 256
    while len(faces) > most and cells > 4:
        index = np.floor((points - low) / extent * cells).astype(np.int64)
        _, cell, count = np.unique(index, axis=0, return_inverse=True, return_counts=True)
        cell = cell.ravel()
        middle = np.stack([np.bincount(cell, points[:, k]) for k in range(3)], axis=1) / count[:, None]
        kept = cell[faces]
        whole = (kept[:, 0] != kept[:, 1]) & (kept[:, 1] != kept[:, 2]) & (kept[:, 2] != kept[:, 0])
        points, faces = middle, np.unique(kept[whole], axis=0)
        cells = int(cells * 0.8)
    return points, faces
