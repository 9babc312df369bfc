"""MuJoCo's geometries → a world's shapes."""

from __future__ import annotations

import math
from typing import Any

import mujoco
import numpy as np
from scipy.spatial import ConvexHull

from wsim.geometry.rotations import multiply, rotate
from wsim.importers.mujoco_names import clean, element, prim_of
from wsim.importers.mujoco_tree import Pose, Tree
from wsim.scene.world import Shape

GEOM = mujoco.mjtGeom
RINGS = 12  # of the mesh that stands for an ellipsoid, from pole to pole


def collides(model: Any, g: int) -> bool:
    """Whether anything may collide with a geometry."""
    return bool(model.geom_contype[g] or model.geom_conaffinity[g])


def shape_of(model: Any, g: int, frame: Pose, owner: str | None = None) -> Shape | None:
    """A geometry of a body whose pose is `frame`; None of a kind that a world has no shape for.

    Args:
        model: MuJoCo's.
        g: Its number.
        frame: The pose of its body, in the frame that the shape is to be in.
        owner: Prim of the body that moves with it; by default its own, which never moves.
    """
    form = _form(model, g)
    if form is None:
        return None
    name = clean(element(model, "geom", g))
    body = int(model.geom_bodyid[g])
    above = owner or (None if body == 0 else prim_of(element(model, "body", body)))
    return Shape.model_validate(
        {
            "prim": f"{above}/{name}" if above else prim_of(name),
            "position": tuple((frame[0] + rotate(frame[1], model.geom_pos[g])).tolist()),
            "rotation": tuple(multiply(frame[1], Tree.xyzw(model.geom_quat[g])).tolist()),
            "color": tuple(float(x) for x in np.clip(model.geom_rgba[g, :3], 0.0, 1.0)),
            "opacity": float(model.geom_rgba[g, 3]),
            "collides": collides(model, g),
            "friction": float(model.geom_friction[g, 0]),
            "margin": float(model.geom_margin[g]),
            **form,
        }
    )


def stand_in(prim: str, com: np.ndarray, inertia: np.ndarray, mass: float) -> Shape:
    """A ball that collides with nothing, for a body without a shape: of that mass's mean moment of inertia."""
    moment = float(np.trace(inertia)) / 3.0
    radius = math.sqrt(2.5 * moment / mass) if mass > 0.0 and moment > 0.0 else 1e-3
    return Shape(prim=f"{prim}/mass", kind="sphere", size=(radius,), position=tuple(com.tolist()), collides=False)


def _form(model: Any, g: int) -> dict[str, Any] | None:
    """Kind, size, and of a mesh vertices and triangles."""
    a, b, c = (float(x) for x in model.geom_size[g])
    sizes: dict[Any, tuple[str, tuple[float, ...]]] = {
        GEOM.mjGEOM_BOX: ("box", (2 * a, 2 * b, 2 * c)),  # MuJoCo has half the edges and half the lengths
        GEOM.mjGEOM_SPHERE: ("sphere", (a,)),
        GEOM.mjGEOM_CAPSULE: ("capsule", (a, 2 * b)),
        GEOM.mjGEOM_CYLINDER: ("cylinder", (a, 2 * b)),
        GEOM.mjGEOM_PLANE: ("plane", ()),
    }
    kind = GEOM(int(model.geom_type[g]))
    if kind in sizes:
        return {"kind": sizes[kind][0], "size": sizes[kind][1]}
    if kind == GEOM.mjGEOM_HFIELD:
        return _field(model, int(model.geom_dataid[g]))
    if kind in (GEOM.mjGEOM_ELLIPSOID, GEOM.mjGEOM_MESH):
        return _mesh(*hull_of_points(points_of(model, g)))
    return None


def points_of(model: Any, g: int) -> np.ndarray:
    """Points of a mesh, or on an ellipsoid, (n, 3) [m]."""
    if GEOM(int(model.geom_type[g])) == GEOM.mjGEOM_ELLIPSOID:
        return _ellipsoid(*(float(x) for x in model.geom_size[g]))
    mesh = int(model.geom_dataid[g])
    first = model.mesh_vertadr[mesh]
    return np.array(model.mesh_vert[first : first + model.mesh_vertnum[mesh]], dtype=np.float64)


def hull_of_points(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What MuJoCo collides of a mesh: vertices (n, 3) and triangles (m, 3) of the convex hull."""
    hull = ConvexHull(np.asarray(points, dtype=np.float64), qhull_options="QJ Pp")  # a flat mesh has one, too
    kept, numbers = np.unique(hull.simplices, return_inverse=True)
    vertices, triangles = hull.points[kept], numbers.reshape(-1, 3)
    corners = vertices[triangles]
    outwards = np.einsum("ni,ni->n", np.cross(*(corners[:, k] - corners[:, 0] for k in (1, 2))), hull.equations[:, :3])
    triangles = np.where(outwards[:, None] < 0.0, triangles[:, ::-1], triangles)
    return vertices, triangles


def _ellipsoid(a: float, b: float, c: float) -> np.ndarray:
    """Points on an ellipsoid by its half axes, (n, 3)."""
    polar, around = np.pi * np.arange(RINGS + 1) / RINGS, np.pi * np.arange(2 * RINGS) / RINGS
    theta, phi = (grid.ravel() for grid in np.meshgrid(polar, around))
    return np.stack([a * np.sin(theta) * np.cos(phi), b * np.sin(theta) * np.sin(phi), c * np.cos(theta)], axis=1)


def _field(model: Any, field: int) -> dict[str, Any]:
    """A height field's surface, as triangles that collide themselves."""
    rows, columns, first = (int(getattr(model, f"hfield_{name}")[field]) for name in ("nrow", "ncol", "adr"))
    x, y, top, _ = model.hfield_size[field]
    grid = np.meshgrid(np.linspace(-x, x, columns), np.linspace(-y, y, rows))
    heights = top * model.hfield_data[first : first + rows * columns]
    vertices = np.stack([grid[0].ravel(), grid[1].ravel(), heights], axis=1)
    corner = (columns * np.arange(rows - 1)[:, None] + np.arange(columns - 1)).ravel()
    # MuJoCo cuts each cell from its first corner to the one across.
    lower = np.stack([corner, corner + 1, corner + columns + 1], axis=1)
    upper = np.stack([corner, corner + columns + 1, corner + columns], axis=1)
    return _mesh(vertices, np.concatenate([lower, upper])) | {"exact": True}


def _mesh(vertices: np.ndarray, triangles: np.ndarray) -> dict[str, Any]:
    size = tuple(float(x) for x in np.ptp(vertices, axis=0))
    return {"kind": "mesh", "size": size, "vertices": vertices.tolist(), "triangles": triangles.tolist()}
