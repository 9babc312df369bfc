"""Where cylinders touch with an end or along a side, capsules side by side, and boxes with faces: all that both share.

MuJoCo tells a point or two of it.

Of what stands flat, or lies along a line, any point may bear, and which one a search for the nearest finds is chance:
of a roller across a dome it may be the roller's end. Here an end's disc is held against the points of the other shape
that come nearest to it, and against a box's edge across it; a plane or a box's face against points of the cylinder's
rim or side; and a side against what is round, or a box's edge. Of two capsules nearly side by side one point is the
nearest, at either end, and goes from one to the other and back as they rock by 1e-6 rad. Where boxes' faces lie on each
other with fewer points than a face has, each is held against the other's corners. Each point has its own gap.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import conjugate, rotate

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from wsim.scene.world import Shape

    Floats = NDArray[np.float64]
    Rows = NDArray[np.intp]
    Points = tuple[Floats, Floats, Floats]  # halfway (n, 3), normals from the first shape (n, 3), gaps (n,)

LEANS = 0.1  # [rad]: an end, a side or a face that leans by more touches with one point, which the search finds
RIM = 16  # points of a rim,
ALONG = 9  # and of a line
CORNERS = 0.5 * np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=np.float64)
HAIR = 1e-9  # of a line, by which points stay within a rim or an edge
FACE = 4  # corners of a box's face
KINDS = {("cylinder", other) for other in ("sphere", "capsule", "box", "cylinder", "plane")}
KINDS.add(("capsule", "capsule"))
Z = np.array([0.0, 0.0, 1.0])
_POINTS = np.zeros((0, 3))


@dataclass(frozen=True)
class Further:
    """Points beside those that were found, m of them."""

    of: Rows  # (m,), a contact of the same pair
    point: Floats  # (m, 3) [m], halfway
    normal: Floats  # (m, 3), from the first shape to the second
    gap: Floats  # (m,) [m]


def flats(pairs: Rows, normal: Floats, at: Rows, shapes: Sequence[Shape], places: Floats) -> Further:
    """Further points of the contacts that cylinders take part in, and of boxes.

    Args:
        pairs: Of the shapes of each contact, (n, 2).
        normal: From the first to the second, (n, 3).
        at: Which of several poses of all bodies each contact is at, (n,).
        shapes: All that collide.
        places: Where both shapes of each contact are in the world, (n, 2, 7) [m; xyzw].
    """
    first, counts = np.unique((at * len(shapes) + pairs[:, 0]) * len(shapes) + pairs[:, 1], return_index=True,
                              return_counts=True)[1:]  # fmt: skip
    kinds = np.array([shape.kind for shape in shapes])[pairs[first]]
    boxes = np.all(kinds == "box", axis=1) & (counts < FACE)
    parts = [_boxes(pairs, normal, first[boxes], shapes, places)]
    lines = np.any(kinds == "cylinder", axis=1) | np.all(kinds == "capsule", axis=1)
    for n in first[lines].tolist():
        for side, sign in ((0, 1.0), (1, -1.0)):
            own, other = (int(s) for s in pairs[n, [side, 1 - side]])
            if (shapes[own].kind, shapes[other].kind) not in KINDS:
                continue
            ends = (shapes[own], places[n, side]), (shapes[other], places[n, 1 - side])
            for point, way, gap in _shared(*ends, sign * normal[n]):
                parts.append(Further(np.full(len(gap), n), point, sign * way, gap))
    rank = np.zeros(len(pairs), dtype=np.intp)
    rank[first] = np.arange(len(first))
    order = np.argsort(rank[np.concatenate([part.of for part in parts])], kind="stable")
    return Further(*(np.concatenate([getattr(part, f.name) for part in parts])[order] for f in fields(Further)))


def _boxes(pairs: Rows, normal: Floats, chosen: Rows, shapes: Sequence[Shape], places: Floats) -> Further:
    """The corners of each of two boxes over the other's face, of some contacts."""
    size = np.array([shape.size if shape.kind == "box" else (0.0, 0.0, 0.0) for shape in shapes]).reshape(-1, 3)
    of, sign = np.repeat(chosen, 2), np.tile([1.0, -1.0], len(chosen))
    own, other = pairs[chosen].ravel(), pairs[chosen][:, ::-1].ravel()
    pose, there = places[chosen].reshape(-1, 1, 7), places[chosen][:, ::-1].reshape(-1, 7)
    corners = pose[..., :3] + rotate(pose[..., 3:], CORNERS * size[own][:, None])
    way = rotate(conjugate(there[:, 3:]), -sign[:, None] * normal[of])
    k, row = np.argmax(np.abs(way), axis=1), np.arange(len(of))
    edges, inner = 0.5 * size[other], rotate(conjugate(there[:, None, 3:]), corners - there[:, None, :3])
    out = np.sign(way[row, k])
    normals = -rotate(there[:, 3:], out[:, None] * np.eye(3)[k])
    gap = out[:, None] * inner[row, :, k] - edges[row, k][:, None]
    over = np.all((np.abs(inner) <= edges[:, None]) | (np.arange(3) == k[:, None])[:, None], axis=2)
    over &= (np.abs(way[row, k]) >= np.cos(LEANS))[:, None]
    points = corners + 0.5 * gap[..., None] * normals[:, None]
    which = np.nonzero(over)[0]
    return Further(of[which], points[over], (sign[:, None] * normals)[which], gap[over])


def _shared(own: tuple[Shape, Floats], other: tuple[Shape, Floats], outwards: Floats) -> list[Points]:
    """What an end or a side of a cylinder, or a capsule's side, that faces another shape shares with it."""
    (shape, pose), (against, there) = own, other
    axis = rotate(pose[3:], Z)
    upright, lies = abs(axis @ outwards) >= np.cos(LEANS), abs(axis @ outwards) <= np.sin(LEANS)
    upright &= shape.kind == "cylinder"
    if against.kind == "plane":  # of a side MuJoCo finds both ends
        return [_on_plane(_facing(shape, pose, outwards), there)] if upright else []
    found = []
    if upright:
        down, points = np.sign(axis @ outwards) * axis, _facing(against, there, -outwards)
        if against.kind == "box":
            edges = _edges(against, there, -outwards)
            points = np.concatenate([points, *(_across(edge, down, pose, shape.size[0]) for edge in edges)])
        found.append(_on_disc(shape, pose, down, points))
    across = shape.kind == "capsule" and abs(axis @ rotate(there[3:], Z)) < np.cos(LEANS)
    rounded = against.kind in ("sphere", "capsule") or abs(rotate(there[3:], Z) @ outwards) <= np.sin(LEANS)
    if lies and against.kind != "box" and rounded and not across:  # a cylinder's end is no ball's
        found.append(_on_side(shape, pose, *_round(against, there)))
    if (upright or lies) and against.kind == "box":
        points = _facing(shape, pose, outwards)
        found.append(_on_face(_over(points, against, there, outwards) if lies else points, against, there, outwards))
    if lies and against.kind == "box":
        for edge in _edges(against, there, -outwards):
            found.append(_on_side(shape, pose, _beside(edge, axis, pose, shape.size[1]), 0.0))
    return found


def _on_disc(shape: Shape, pose: Floats, axis: Floats, points: Floats) -> Points:
    """Of some points those that are over a cylinder's end on the way of its axis."""
    end = pose[:3] + 0.5 * shape.size[1] * axis
    gap = (points - end) @ axis
    inside = np.linalg.norm(points - end - gap[:, None] * axis, axis=1) <= shape.size[0]
    return _halfway(points - gap[:, None] * axis, np.tile(axis, (len(points), 1)), gap, inside)


def _on_side(shape: Shape, pose: Floats, centres: Floats, radius: float) -> Points:
    """Where balls of a radius are nearest to a cylinder's side, beside it."""
    axis = rotate(pose[3:], Z)
    along = (centres - pose[:3]) @ axis
    apart = centres - pose[:3] - along[:, None] * axis
    far = np.linalg.norm(apart, axis=1)
    way = apart / np.maximum(far, 1e-300)[:, None]
    surface = pose[:3] + along[:, None] * axis + shape.size[0] * way
    beside = (np.abs(along) <= 0.5 * shape.size[1]) & (far > 0.0)
    return _halfway(surface, way, far - shape.size[0] - radius, beside)


def _edges(box: Shape, pose: Floats, way: Floats) -> Floats:
    """Both ends of the four edges of a box's face that is turned a way, (4, 2, 3)."""
    own = rotate(conjugate(pose[3:]), way)
    k = int(np.argmax(np.abs(own)))
    face = CORNERS[CORNERS[:, k] * own[k] > 0.0]
    ring = face[[0, 1, 3, 2]]  # round it: corners are in the order of their coordinates
    corners = pose[:3] + rotate(pose[3:], ring * np.asarray(box.size))
    return np.stack([corners, np.roll(corners, 1, axis=0)], axis=1)


def _beside(ends: Floats, axis: Floats, pose: Floats, length: float) -> Floats:
    """Points of a line from end to end that are beside a cylinder that lies along it, (n, 3)."""
    along = (ends - pose[:3]) @ axis
    if abs(along[1] - along[0]) < np.cos(LEANS) * np.linalg.norm(ends[1] - ends[0]):
        return _POINTS
    low, high = max(along.min(), -0.5 * length), min(along.max(), 0.5 * length)
    share = (np.linspace(low, high, ALONG) - along[0]) / (along[1] - along[0])
    return np.asarray(ends[0] + share[:, None] * (ends[1] - ends[0])) if high > low else _POINTS


def _across(ends: Floats, axis: Floats, pose: Floats, radius: float) -> Floats:
    """Both ends and the middle of what of a line is over a cylinder's end, on the way of its axis, (3 or 0, 3)."""
    flat = ends - pose[:3] - ((ends - pose[:3]) @ axis)[:, None] * axis
    way = flat[1] - flat[0]
    length = max(float(way @ way), 1e-300)
    nearest = -float(flat[0] @ way) / length
    inside = radius**2 - float(np.sum((flat[0] + nearest * way) ** 2))
    if inside <= 0.0:
        return _POINTS
    half = (1.0 - HAIR) * np.sqrt(inside / length)
    share = np.linspace(np.clip(nearest - half, 0.0, 1.0), np.clip(nearest + half, 0.0, 1.0), 3)
    return np.asarray(ends[0] + share[:, None] * (ends[1] - ends[0]))


def _over(line: Floats, box: Shape, pose: Floats, outwards: Floats) -> Floats:
    """Points of a line (n, 3) from end to end of what of it is over the face of a box that is turned to it.

    What lies across two boxes bears at the seam between them, too.
    """
    face = np.arange(3) != int(np.argmax(np.abs(rotate(conjugate(pose[3:]), outwards))))
    first, last = rotate(conjugate(pose[3:]), line[[0, -1]] - pose[:3])[:, face]
    way, edges = last - first, 0.5 * np.asarray(box.size)[face]
    way = np.where(np.abs(way) < 1e-12, 1e-12, way)
    ends = np.sort(np.stack([(-edges - first) / way, (edges - first) / way]), axis=0)
    low, high = max(ends[0].max(), 0.0), min(ends[1].min(), 1.0)
    share = np.linspace(low + HAIR, high - HAIR, ALONG)
    return np.asarray(line[0] + share[:, None] * (line[-1] - line[0])) if high > low + 2.0 * HAIR else _POINTS


def _on_plane(points: Floats, plane: Floats) -> Points:
    """Of some points of a shape what they have to a plane."""
    normal = rotate(plane[3:], Z)
    gap = (points - plane[:3]) @ normal
    return _halfway(points, np.tile(-normal, (len(points), 1)), gap, np.ones(len(points), dtype=bool))


def _on_face(points: Floats, box: Shape, pose: Floats, outwards: Floats) -> Points:
    """Of some points of a shape those over the face of a box that is turned to it."""
    way = rotate(conjugate(pose[3:]), -outwards)
    k, edges = int(np.argmax(np.abs(way))), 0.5 * np.asarray(box.size)
    if abs(way[k]) < np.cos(LEANS):
        return _POINTS, _POINTS, np.zeros(0)
    own, sign = rotate(conjugate(pose[3:]), points - pose[:3]), float(np.sign(way[k]))
    normal = -rotate(pose[3:], sign * np.eye(3)[k])
    gap = sign * own[:, k] - edges[k]
    inside = np.all((np.abs(own) <= edges) | (np.arange(3) == k), axis=1)
    return _halfway(points, np.tile(normal, (len(points), 1)), gap, inside)


def _halfway(surface: Floats, way: Floats, gap: Floats, which: NDArray[np.bool_]) -> Points:
    """Some contacts, by their points on the first shape's surface."""
    return (surface + 0.5 * gap[:, None] * way)[which], way[which], gap[which]


def _facing(shape: Shape, pose: Floats, way: Floats) -> Floats:
    """The points of a shape that may be its farthest on a way, (n, 3)."""
    if shape.kind == "box":
        return np.asarray(pose[:3] + rotate(pose[3:], CORNERS * np.asarray(shape.size)))
    centres, radius = _round(shape, pose)
    axis = rotate(pose[3:], Z)
    if shape.kind != "cylinder":
        return np.asarray(centres + radius * way)
    if abs(axis @ way) < np.cos(LEANS):
        across = way - (axis @ way) * axis
        return np.asarray(centres + radius * across / np.linalg.norm(across))
    angle = 2.0 * np.pi * np.arange(RIM) / RIM
    ring = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(RIM)])
    end = pose[:3] + 0.5 * shape.size[1] * np.sign(axis @ way) * axis
    return np.asarray(end + radius * rotate(pose[3:], ring))


def _round(shape: Shape, pose: Floats) -> tuple[Floats, float]:
    """The centres (n, 3) of the balls that make up a sphere, a capsule or a cylinder's side, and their radius [m]."""
    length = 0.0 if shape.kind == "sphere" else shape.size[1]
    share = np.linspace(-0.5, 0.5, ALONG) if length > 0.0 else np.zeros(1)
    return np.asarray(pose[:3] + (share * length)[:, None] * rotate(pose[3:], Z)), float(shape.size[0])
