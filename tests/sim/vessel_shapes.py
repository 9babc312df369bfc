"""Vessels of revolution and others, as meshes with walls of any thickness, or none."""

import math

import numpy as np
import trimesh

SIDES = 32
AXIS = 1e-6  # [m]: a corner of a profile on the axis


def turned(profile: list[tuple[float, float]], closed: bool = True) -> trimesh.Trimesh:
    """A profile (radius, z) [m] turned about Z; closed, its last point is joined to its first."""
    r, z = np.array(profile).T
    r = np.maximum(r, AXIS)
    wider = math.sqrt(2.0 * math.pi / (SIDES * math.sin(2.0 * math.pi / SIDES)))  # as much area as a circle has
    angle = np.arange(SIDES) * 2.0 * math.pi / SIDES
    rings = [
        np.column_stack([wider * a * np.cos(angle), wider * a * np.sin(angle), np.full(SIDES, b)])
        for a, b in zip(r, z, strict=True)
    ]
    i, j, faces = np.arange(SIDES), (np.arange(SIDES) + 1) % SIDES, []
    for k in range(len(r) if closed else len(r) - 1):
        a, b = k * SIDES, (k + 1) % len(r) * SIDES
        faces += [np.stack([a + i, a + j, b + j], axis=1), np.stack([a + i, b + j, b + i], axis=1)]
    mesh = trimesh.Trimesh(np.concatenate(rings), np.concatenate(faces), process=False)
    mesh.merge_vertices()
    if closed:
        mesh.update_faces(mesh.nondegenerate_faces())
        if mesh.volume < 0.0:
            mesh.invert()
    return mesh


def walled(inner: list[tuple[float, float]], wall: float) -> trimesh.Trimesh:
    """A vessel of an inner profile from the axis to the rim [m], with a wall outward."""
    points = np.array(inner)
    way = np.gradient(points, axis=0)
    normal = np.column_stack([way[:, 1], -way[:, 0]]) / np.linalg.norm(way, axis=1)[:, None]
    outer = points + wall * normal
    outer[0] = 0.0, points[0, 1] - wall
    outer[-1, 1] = points[-1, 1]
    return turned([*outer.tolist(), *points[::-1].tolist()])


def cup(radius: float, height: float, wall: float, flare: float = 0.0) -> trimesh.Trimesh:
    """A cylinder with a floor, or a cone cut off, growing by `flare` a metre; its hollow begins at z = wall."""
    top = radius + flare * height
    return turned(
        [(0, 0), (radius + wall, 0), (top + wall, height + wall), (top, height + wall), (radius, wall), (0, wall)]
    )


def sheet_cup(radius: float, height: float) -> trimesh.Trimesh:
    """A cup without thickness, open above."""
    return turned([(0.0, 0.0), (radius, 0.0), (radius, height)], closed=False)


def bowl(radius: float, wall: float) -> trimesh.Trimesh:
    """Half a ball."""
    angle = np.linspace(0.0, math.pi / 2.0, 9)
    return walled(np.column_stack([radius * np.sin(angle), radius * (1.0 - np.cos(angle))]).tolist(), wall)


def bottle(radius: float, neck: float, height: float, wall: float) -> trimesh.Trimesh:
    """A body as wide as its radius up to two thirds, then a shoulder, and a neck."""
    h = height
    inner = [(0.0, 0.0), (radius, 0.0), (radius, 0.6 * h), (neck, 0.75 * h), (neck, h)]
    outer = [(0.0, -wall), (radius + wall, -wall), (radius + wall, 0.62 * h), (neck + wall, 0.77 * h), (neck + wall, h)]
    return turned([*outer, *inner[::-1]])


def trough(radius: float, length: float, wall: float) -> trimesh.Trimesh:
    """Half a pipe along X, with ends, its rim at z = 0."""
    angle, k, half = np.linspace(0.0, math.pi, 13), np.arange(12), 0.5 * length
    arc = np.column_stack([-np.cos(angle), -np.sin(angle)])
    sections = ((radius + wall, -half - wall), (radius, -half), (radius, half), (radius + wall, half + wall))
    points = np.concatenate([np.column_stack([np.full(13, x), r * arc]) for r, x in sections])
    faces, out = [], []
    for a, b, side in ((0, 39, 1.0), (13, 26, -1.0)):  # outside, inside
        faces += [np.stack([a + k, b + k, b + k + 1], 1), np.stack([a + k, b + k + 1, a + k + 1], 1)]
        middle = 0.5 * (arc[:-1] + arc[1:])
        out += 2 * [side * np.column_stack([np.zeros(12), middle])]
    for a, side in ((0, -1.0), (13, 1.0), (26, -1.0), (39, 1.0)):  # ends
        faces.append(np.stack([np.full(11, a), a + k[1:], a + k[1:] + 1], 1))
        out.append(np.tile([side, 0.0, 0.0], (11, 1)))
    rim = [(0, 13, 26), (0, 26, 39), (12, 25, 38), (12, 38, 51), (0, 12, 25), (0, 25, 13), (39, 26, 38), (39, 38, 51)]
    faces.append(np.array(rim))
    out.append(np.tile([0.0, 0.0, 1.0], (len(rim), 1)))
    triangles, outward = np.concatenate(faces), np.concatenate(out)
    corners = points[triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    wrong = (normal * outward).sum(axis=1) < 0.0
    triangles[wrong] = triangles[wrong][:, ::-1]
    return trimesh.Trimesh(points, triangles, process=False)
