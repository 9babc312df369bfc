"""Cross-sections of tracks: closed outlines as an inner and an outer side, with the direction of each corner."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_AROUND = 24  # edges of a round section


@dataclass(frozen=True)
class Section:
    """One closed outline, from left to right on its upper side: (left, up) [m].

    `corner[k]` to `corner[k + 1]` is an edge; `way[k]` has the outline's direction at its two ends.
    """

    corner: Floats  # (M, 2), the first is not said again
    way: Floats  # (M, 2, 2)
    cap: list[tuple[int, int, int]]  # triangles that close an end


def flat(width: float, wall: float, thickness: float) -> list[Section]:
    """A ribbon of a width, between walls of a height if that is not 0, all as thick."""
    w, t = width / 2.0, thickness
    inner = [(w, 0.0), (-w, 0.0)] if wall == 0.0 else [(w, wall), (w, 0.0), (-w, 0.0), (-w, wall)]
    outer = [(w, -t), (-w, -t)] if wall == 0.0 else [(w + t, wall), (w + t, -t), (-w - t, -t), (-w - t, wall)]
    return [_straight(np.array(inner), np.array(outer))]


def round_(width: float, depth: float, thickness: float) -> list[Section]:
    """A gutter: an arc of a circle of a width across, up to a height of `depth` over its lowest line."""
    radius = width / 2.0
    half = math.acos(max(-1.0, 1.0 - depth / radius))
    count = max(4, math.ceil(2.0 * half / math.radians(7.5)))
    angle = np.linspace(half, -half, count + 1)
    spoke = np.column_stack([np.sin(angle), -np.cos(angle)])
    inner, outer = radius * spoke + (0.0, radius), (radius + thickness) * spoke + (0.0, radius)
    section = _straight(inner, outer)
    # Along the arcs the outline turns with them: that of the inner one goes on to the right, of the outer one back.
    tangent = np.column_stack([-np.cos(angle), -np.sin(angle)])
    way = section.way.copy()
    for k in range(count):
        way[k] = tangent[k], tangent[k + 1]
        way[count + 1 + k] = -tangent[count - k], -tangent[count - k - 1]
    return [Section(section.corner, way, section.cap)]


def rails(gauge: float, diameter: float) -> list[Section]:
    """Two round rods, their axes a gauge apart and level with the track's line."""
    return [_rod(side * gauge / 2.0, diameter / 2.0) for side in (1.0, -1.0)]


def _rod(aside: float, radius: float) -> Section:
    angle = np.linspace(0.0, 2.0 * math.pi, _AROUND, endpoint=False)
    corner = np.column_stack([aside + radius * np.cos(angle), radius * np.sin(angle)])
    tangent = np.column_stack([-np.sin(angle), np.cos(angle)])
    way = np.stack([tangent, np.roll(tangent, -1, axis=0)], axis=1)
    return Section(corner, way, [(0, k, k + 1) for k in range(1, _AROUND - 1)])


def _straight(inner: Floats, outer: Floats) -> Section:
    """An outline of straight edges: along the inner side, back along the outer one."""
    corner = np.concatenate([inner, outer[::-1]])
    edge = np.roll(corner, -1, axis=0) - corner
    edge /= np.linalg.norm(edge, axis=1, keepdims=True)
    count, total = len(inner), len(corner)
    cap = []
    for k in range(count - 1):
        a, b, c, d = k, k + 1, total - 2 - k, total - 1 - k
        cap += [(a, b, c), (a, c, d)]
    return Section(corner, np.stack([edge, edge], axis=1), cap)
