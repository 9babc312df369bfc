"""Whether fluid can leave a tap's mouth: what solid it lies in, if any."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray
from pxr import Gf, Usd, UsdGeom

from wsim.geometry.rotations import rotate
from wsim.geometry.shapes import into, kind_of
from wsim.scene import schema
from wsim.scene.usd_prims import rigid_frame
from wsim.scene.usd_shapes import collides, read_shape, to_quat, to_vec3
from wsim.scene.usd_values import value_of
from wsim.scene.world import Shape

Array = NDArray[np.float64]
_WORLD = Gf.Matrix4d(1.0)
_RIM = 0.8  # of the mouth's half width and height: where its points are, beside its centre
_AROUND = np.linspace(0.0, 2.0 * np.pi, 8, endpoint=False)


def blocked_by(tap: Usd.Prim, spacing: float, prims: Iterable[Usd.Prim]) -> tuple[str, float] | None:
    """The solid that most of a tap's mouth lies in, and how deep its centre does [m]; None where water may leave it.

    Asked where its first particles come to, half a spacing in front of it: the mouth itself may lie in the surface of
    a floor or a wall, and its pipe inside. A tank's hollow is free, if it is sunk into the ground, too.

    Args:
        tap: The prim.
        spacing: Of the fluid's particles [m].
        prims: What may be in its way; those of moving bodies where they start.
    """
    prims = list(prims)
    points = _in_front(tap, 0.5 * spacing)
    hollow = np.zeros(len(points), dtype=bool)
    for tank in (prim for prim in prims if schema.has(prim, schema.CONTAINER)):
        hollow |= _in_hollow(tank, points)
    for prim in prims:
        if not prim.IsA(UsdGeom.Gprim) or not collides(prim):
            continue
        shape = read_shape(prim, _WORLD)
        if shape is None:
            continue
        deep = _depth(shape, points)
        inside = (deep > 0.0) & ~(hollow & (shape.kind == "plane"))
        if 2 * int(inside.sum()) > len(points):
            return str(prim.GetPath()), float(deep[0])
    return None


def told(tap: Usd.Prim, solid: str, depth: float) -> str:
    """What a message says of a tap that is blocked: where it is, in what, and what to do."""
    place = tuple(round(x, 6) for x in rigid_frame(tap).ExtractTranslation())
    return (
        f"{place} m is {depth:.3g} m deep inside of {solid}, where no water can leave the mouth; "
        "put it outside, or in the surface and with its direction out of it"
    )


def _in_front(tap: Usd.Prim, ahead: float) -> Array:
    """The centre and eight points about it, some way in front of a mouth (9, 3) [m]."""
    way = Gf.Vec3d(value_of(tap, "direction", Gf.Vec3d(0.0, 0.0, -1.0))).GetNormalized()
    radius, size = value_of(tap, "radius", 0.0), value_of(tap, "size", Gf.Vec2d(0.0))
    half = _RIM * np.array([radius, radius] if radius else [0.5 * size[0], 0.5 * size[1]])
    if abs(way[2]) > 1.0 - 1e-9:
        across, up = np.eye(3)[:2]
    else:
        across = np.cross([0.0, 0.0, 1.0], way)
        across /= np.linalg.norm(across)
        up = np.cross(way, across)
    rim = half * np.stack([np.cos(_AROUND), np.sin(_AROUND)], axis=1)
    centre = np.array(rigid_frame(tap).ExtractTranslation()) + ahead * np.array(way)
    return np.asarray(centre + np.concatenate([[np.zeros(3)], rim @ np.stack([across, up])]))


def _in_hollow(tank: Usd.Prim, points: Array) -> NDArray[np.bool_]:
    """Which points are in a tank's hollow."""
    frame = rigid_frame(tank)
    centre = frame.Transform(Gf.Vec3d(value_of(tank, "innerCenter", Gf.Vec3f(0.0))))
    half = 0.5 * np.array(value_of(tank, "innerSize", Gf.Vec3f(0.0)))
    turn = np.array(to_quat(frame.ExtractRotationQuat())) * np.array([-1.0, -1.0, -1.0, 1.0])
    beyond = np.abs(rotate(turn, points - np.array(to_vec3(centre)))) - half
    return np.asarray(beyond.max(axis=1) <= 0.0)


def _depth(shape: Shape, points: Array) -> Array:
    """How deep points (n, 3) are in a shape [m]; negative outside."""
    own = into(shape, points)
    if shape.kind != "mesh":
        return kind_of(shape).depth(own)
    corners = np.array(shape.vertices)
    if not ((own >= corners.min(axis=0)) & (own <= corners.max(axis=0))).all(axis=1).any():
        return np.full(len(points), -np.inf)
    inside = np.abs(_turns(own, corners[np.array(shape.triangles)])) > 0.5
    nearest = np.linalg.norm(own[:, None] - corners, axis=2).min(axis=1)
    return np.where(inside, nearest, -nearest)


def _turns(points: Array, corners: Array) -> Array:
    """How often triangles (m, 3, 3) wind about points (n, 3): 1 inside of a closed mesh, 0 outside, (n,).

    Their solid angles over 4 pi, by van Oosterom & Strackee (1983).
    """
    found = np.zeros(len(points))
    for k, point in enumerate(points):
        a, b, c = np.moveaxis(corners - point, 1, 0)
        la, lb, lc = (np.linalg.norm(each, axis=1) for each in (a, b, c))
        over = (a * np.cross(b, c)).sum(axis=1)
        under = la * lb * lc + (a * b).sum(axis=1) * lc + (b * c).sum(axis=1) * la + (c * a).sum(axis=1) * lb
        found[k] = np.arctan2(over, under).sum() / (2.0 * np.pi)
    return found
