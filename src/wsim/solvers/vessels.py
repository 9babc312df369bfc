"""Vessels of any shape that hold a fluid: particles behind the inside of their walls, however thin these are.

As with a tank (`OpenBox`), a thin wall's own volume would leave the kernel of a particle beside it half empty.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from wsim.geometry.filled import Samples
from wsim.geometry.hollows import Hollow, is_closed
from wsim.geometry.rotations import conjugate, rotate
from wsim.geometry.surfaces import Surface
from wsim.solvers.layers import RELAXED, spread_layers

Array = np.ndarray
CELLS = 3  # of the grid that its hollow is found on, along a spacing at least
PIECES = 4  # of a spacing: what its inside is cut into
FRONT = (0.6, 1.2)  # cells in front of an inner face that the hollow begins
BESIDE = 0.6  # of a piece's edge: how far off its middle it still goes on
EVENLY = (5, 3)  # sweeps and pieces that its walls are spread with: volumes to 0.15, as ten and four have to 0.12
KEPT = 16  # vessels whose walls are remembered
NOWHERE = -1e9  # [m]: as deep as what is no wall


def own_label(label: str) -> str:
    """The label of the mesh that Newton made a convex part of."""
    return re.sub(r"_convex_\d+$", "", label)


@dataclass(frozen=True)
class Vessel:
    """A hollow object that fluid is in. Where it stands still its frame is the world's, else its body's."""

    surfaces: tuple[Surface, ...]
    """Of its parts; one that is not closed is a sheet."""
    upright: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0)
    """Rotation, xyzw, that turns it so that its hollow opens upward."""
    shapes: frozenset[str] = frozenset()
    """Labels of the model's shapes that are its walls; they are not sampled again."""
    body: str | None = None
    """Label of the body that it is; None: it stands still."""
    goes: tuple[tuple[float, float, float], tuple[float, float, float]] | None = None
    """Lower and upper corner of the room that it is or moves in [m]; None: it stays where its fluid starts."""
    world: int = -1
    """The world that it stands in; -1 is every world."""

    def homes(self, model: Any) -> list[tuple[int, int]]:
        """The worlds of a model that it is in, and its body in each, or -1."""
        worlds = range(max(1, model.world_count)) if self.world < 0 else (self.world,)
        if self.body is None:
            return [(world, -1) for world in worlds]
        own = model.body_world.numpy()
        found = [(max(0, int(own[k])), k) for k, label in enumerate(model.body_label) if str(label) == self.body]
        return [(world, body) for world, body in found if world in worlds]

    def walls(self, spacing: float) -> Samples:
        """Layers of particles behind its inside up to the rim, as deep as a kernel reaches, in its frame.

        Raises:
            ValueError: If it has no hollow.
        """
        parts = tuple((each.vertices.tobytes(), each.triangles.tobytes()) for each in self.surfaces)
        return _walls(parts, self.upright, spacing)


@lru_cache(maxsize=KEPT)
def _walls(
    parts: tuple[tuple[bytes, bytes], ...], upright: tuple[float, float, float, float], spacing: float
) -> Samples:
    """Walls of surfaces, as the bytes of their vertices and triangles: worlds that are alike share them."""
    turn = np.array(upright, dtype=np.float64)
    surfaces = [
        Surface(np.frombuffer(v).reshape(-1, 3), np.frombuffer(t, dtype=np.intp).reshape(-1, 3)).turned(turn)
        for v, t in parts
    ]
    hollow = Hollow(surfaces, spacing / CELLS)
    behind = _Behind(surfaces, hollow, spacing)
    reach = (RELAXED + 1) * spacing
    low, high = behind.middles.min(axis=0) - reach, behind.middles.max(axis=0) + reach
    ticks = [np.arange(a, b, spacing) + 0.5 * spacing for a, b in zip(low, high, strict=True)]
    cells = np.stack(np.meshgrid(*ticks, indexing="ij"), axis=-1).reshape(-1, 3)
    depth = behind(cells)
    near = (depth > -2.0 * spacing) & (depth < (RELAXED + 1) * spacing)
    found = spread_layers(cells[near], depth[near], np.full(3, spacing), spacing, behind, *EVENLY)
    return Samples(rotate(conjugate(turn), found.position), found.volume)


class _Behind:
    """How deep points (n, 3) are behind the inside of a vessel, (n,) [m]; negative in front, and over its rim."""

    def __init__(self, surfaces: list[Surface], hollow: Hollow, spacing: float) -> None:
        self._rim = np.inf if hollow.sealed else hollow.rim
        self._beside = BESIDE * spacing / PIECES
        pieces = [_inside_of(surface, hollow, spacing / PIECES) for surface in surfaces]
        self.middles = np.concatenate([middles for middles, _ in pieces])
        self._normals = np.concatenate([normals for _, normals in pieces])
        self._tree = cKDTree(self.middles)

    def __call__(self, points: Array) -> Array:
        away, nearest = self._tree.query(points, workers=-1)
        straight = -((points - self.middles[nearest]) * self._normals[nearest]).sum(axis=1)
        aside = np.sqrt(np.maximum(away**2 - straight**2, 0.0))
        deep = np.sign(straight) * np.hypot(straight, np.maximum(aside - self._beside, 0.0))
        return np.where(points[:, 2] > self._rim, NOWHERE, deep)


def _inside_of(surface: Surface, hollow: Hollow, edge: float) -> tuple[Array, Array]:
    """Middles (n, 3) [m] and normals (n, 3), towards the hollow, of a surface's pieces that face it."""
    corners = _pieces(surface.vertices[surface.triangles], edge)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1)
    flat = length > 1e-9 * edge**2
    middles, normals = corners[flat].mean(axis=1), normal[flat] / length[flat, None]
    if surface.volume < 0.0:
        normals = -normals
    front, back = (
        np.any([hollow.holds(middles + side * far * hollow.edge * normals) for far in FRONT], axis=0)
        for side in (1.0, -1.0)
    )
    if not is_closed(surface):
        normals = np.where((back & ~front)[:, None], -normals, normals)
        front = front != back
    return middles[front], normals[front]


def _pieces(corners: Array, edge: float) -> Array:
    """Triangles (n, 3, 3) [m], each cut across its longest edge until that is no longer than `edge`."""
    done = []
    while len(corners):
        sides = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2)
        small = sides.max(axis=1) <= edge
        done.append(corners[small])
        longest = (sides[~small].argmax(axis=1)[:, None] + np.arange(3)) % 3
        a, b, c = np.moveaxis(np.take_along_axis(corners[~small], longest[:, :, None], axis=1), 1, 0)
        middle = 0.5 * (a + b)
        corners = np.concatenate([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])
    return np.concatenate(done)
