"""The kinds of shape: what each is in its own frame, centred on its origin, round ones about Z.

A kind is one function of the numbers of `wsim.scene.world.Shape.size` [m], and a line in `KINDS`. Of a primitive these
may also be arrays (F, 1): it is of another size then for each of F rows of points, (F, P, 3).
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NoReturn

import numpy as np
from numpy.typing import NDArray

from wsim.geometry.lines import between, leaves, leaves_triangles, within
from wsim.geometry.surfaces import Surface, arc, box_surface, revolved

Floats = NDArray[np.float64]
Ends = tuple[Floats, Floats]

MOST_PROBES = 200  # vertices of a mesh that are probed


def _probed(points: Sequence[Sequence[float]]) -> Floats:
    """Points of a kind's surface (P, 3), in shares of its edges: the same of all that are of it."""
    found = np.array(points)
    found.flags.writeable = False
    return found


_TICKS, _RING = (-0.5, 0.0, 0.5), np.linspace(0.0, 2 * np.pi, 24, endpoint=False)
_OF_BOX = _probed([[x, y, z] for x in _TICKS for y in _TICKS for z in _TICKS if (x, y, z) != (0.0, 0.0, 0.0)])
_OF_CYLINDER = _probed(
    [[x, y, z] for z in _TICKS for x, y in zip(np.cos(_RING), np.sin(_RING), strict=True)]
    + [[0.0, 0.0, -0.5], [0.0, 0.0, 0.5]]
)
_OF_CAPSULE = _probed([[0.0, 0.0, z] for z in np.linspace(-0.5, 0.5, 9)])


@dataclass(frozen=True)
class Kind:
    """A shape, by what is asked of it."""

    edges: tuple[float, ...]
    """Of its bounding box [m]; none where it has no end."""
    radius_about: float
    """Radius of a ball about its origin that holds it [m]."""
    thinnest: float
    """Its smallest extent [m]."""
    beyond: Callable[[Floats], list[Floats]]
    """How far points (..., 3) are beyond each of its sides, which stand at right angles, (...) each [m]."""
    ends: Callable[[Floats], Ends]
    """Where it begins and ends along unit axes (..., 3), from its origin, (...) each [m]."""
    heights: Callable[[Floats], Ends]
    """Its ends along the world's Z, (T, 3) in its frame: another order of operations, which verdicts are bound to."""
    leaves: Callable[[Floats, Floats], Floats]
    """How far along a unit way (3,) lines from points (N, 3) last leave it, (N,) [m]; -inf where they never do."""
    surface: Callable[[], Surface]
    """A closed mesh of it, of its volume."""
    probes: Callable[[], tuple[Floats, float]]
    """Points (P, 3), and how deep inside they are: what balls of that radius about them meet, it meets."""
    volume: float = math.nan
    """[m^3]; not a number where only the surface tells."""
    has_depth: bool = True

    def depth(self, points: Floats) -> Floats:
        """How deep points (..., 3) are inside [m], negative outside; -inf for a mesh, which NumPy has no tree for."""
        if not self.has_depth:
            return np.full(points.shape[:-1], -np.inf)
        sides = self.beyond(points)
        if len(sides) == 1:
            return -sides[0]
        outside = np.sqrt(sum(np.square(np.maximum(side, 0.0)) for side in sides))
        depth: Floats = -(outside + np.minimum(functools.reduce(np.maximum, sides), 0.0))
        return depth


def _both(half: Floats) -> Ends:
    return -half, half


def _about(*lengths: float) -> float:
    """The length of a diagonal."""
    if isinstance(lengths[0], np.ndarray):
        return np.sqrt(sum(np.square(length) for length in lengths))
    return math.hypot(*lengths)


def _least(*lengths: float) -> float:
    return functools.reduce(np.minimum, lengths) if isinstance(lengths[0], np.ndarray) else min(lengths)


def _scaled(points: Floats, *lengths: float) -> Floats:
    """Points (P, 3), each coordinate by its length: (F, P, 3) where these are arrays."""
    return points * np.stack(lengths, axis=-1)


def box(*edges: float) -> Kind:
    """By its full edges."""

    def ends(axes: Floats) -> Ends:
        x, y, z = np.abs(np.moveaxis(axes, -1, 0))
        return _both(np.asarray((x * edges[0] + y * edges[1] + z * edges[2]) / 2))

    return Kind(
        edges=edges,
        radius_about=_about(*edges) / 2,
        thinnest=_least(*edges),
        beyond=lambda points: [np.abs(points[..., k]) - edge / 2 for k, edge in enumerate(edges)],
        ends=ends,
        heights=lambda up: _both(np.abs(up) @ (np.array(edges) / 2)),
        leaves=lambda start, way: leaves(*(between(start[:, k], way[k], edge / 2) for k, edge in enumerate(edges))),
        surface=lambda: box_surface(edges),
        probes=lambda: (_scaled(_OF_BOX, *edges), 0.0),
        volume=math.prod(edges),
    )


def sphere(radius: float) -> Kind:
    """By its radius."""
    volume = 4 / 3 * math.pi * radius**3

    def ends(axes: Floats) -> Ends:
        return _both(np.broadcast_to(radius, axes.shape[:-1]))

    return Kind(
        edges=(2 * radius,) * 3,
        radius_about=radius,
        thinnest=2 * radius,
        beyond=lambda points: [np.linalg.norm(points, axis=-1) - radius],
        ends=ends,
        heights=ends,
        leaves=lambda start, way: leaves(within(start, way, radius)),
        surface=lambda: revolved(*arc(radius, 0.0), volume=volume),
        probes=lambda: (np.zeros((1, 3)), radius),
        volume=volume,
    )


def cylinder(radius: float, height: float) -> Kind:
    """Along Z."""
    volume = math.pi * radius**2 * height

    def ends(axes: Floats) -> Ends:
        x, y, z = np.abs(np.moveaxis(axes, -1, 0))
        return _both(np.asarray(radius * np.hypot(x, y) + height / 2 * z))

    def heights(up: Floats) -> Ends:
        return _both(np.abs(up[:, 2]) * height / 2 + radius * np.sqrt(np.maximum(0.0, 1.0 - up[:, 2] ** 2)))

    def surface() -> Surface:
        profile = (np.array([0.0, radius, radius, 0.0]), np.array([-1.0, -1.0, 1.0, 1.0]) * height / 2)
        return revolved(*profile, volume=volume, radial=True)

    return Kind(
        edges=(2 * radius, 2 * radius, height),
        radius_about=_about(radius, height / 2),
        thinnest=_least(2 * radius, height),
        beyond=lambda p: [np.hypot(p[..., 0], p[..., 1]) - radius, np.abs(p[..., 2]) - height / 2],
        ends=ends,
        heights=heights,
        leaves=lambda p, way: leaves(within(p[:, :2], way[:2], radius), between(p[:, 2], way[2], height / 2)),
        surface=surface,
        probes=lambda: (_scaled(_OF_CYLINDER, radius, radius, height), 0.0),
        volume=volume,
    )


def capsule(radius: float, height: float) -> Kind:
    """Along Z; the height is without the caps."""
    volume = math.pi * radius**2 * (height + 4 / 3 * radius)

    def beyond(points: Floats) -> list[Floats]:
        x, y, z = points[..., 0], points[..., 1], points[..., 2]
        along = np.maximum(np.abs(z) - height / 2, 0.0)
        return [np.sqrt(x * x + y * y + along * along) - radius]

    def ends(axes: Floats) -> Ends:
        return _both(np.asarray(radius + height / 2 * np.abs(axes[..., 2])))

    def last(start: Floats, way: Floats) -> Floats:
        tops = [within(start - np.array([0.0, 0.0, z]), way, radius) for z in (-height / 2, height / 2)]
        return np.max([cylinder(radius, height).leaves(start, way), *(leaves(top) for top in tops)], axis=0)

    return Kind(
        edges=(2 * radius, 2 * radius, height + 2 * radius),
        radius_about=radius + height / 2,
        thinnest=2 * radius,
        beyond=beyond,
        ends=ends,
        heights=ends,
        leaves=last,
        surface=lambda: revolved(*arc(radius, height), volume=volume),
        probes=lambda: (
            _scaled(_OF_CAPSULE, radius, radius, height),
            radius,
        ),
        volume=volume,
    )


def plane() -> Kind:
    """All that is below z = 0."""

    def endless(*_: Floats) -> NoReturn:
        raise ValueError("a plane has no end")

    def last(start: Floats, way: Floats) -> Floats:
        return between(start[:, 2], way[2], 0.0)[1] if way[2] > 0.0 else np.full(len(start), -np.inf)

    return Kind(
        edges=(),
        radius_about=math.inf,
        thinnest=math.inf,
        beyond=lambda points: [points[..., 2]],
        ends=endless,
        heights=endless,
        leaves=last,
        surface=endless,
        probes=endless,
    )


def mesh(edges: tuple[float, ...], points: Sequence[Sequence[float]], faces: Sequence[Sequence[int]]) -> Kind:
    """By its bounding box, vertices [m] and triangles; without vertices its box stands for it."""
    hull = replace(box(*edges), volume=math.nan, has_depth=False)
    if not points:
        return hull
    vertices = np.array(points, dtype=np.float64)

    def ends(axes: Floats) -> Ends:
        along = axes @ vertices.T
        return along.min(axis=-1), along.max(axis=-1)

    def last(start: Floats, way: Floats) -> Floats:
        return leaves_triangles(start, way, vertices[np.array(faces, dtype=np.intp)])

    return replace(
        hull,
        radius_about=float(np.linalg.norm(vertices, axis=1).max()),
        ends=ends,
        heights=ends,
        leaves=last if faces else hull.leaves,
        surface=(lambda: Surface(vertices, np.array(faces, dtype=np.intp))) if faces else hull.surface,
        probes=lambda: (vertices[:: max(1, len(vertices) // MOST_PROBES)], 0.0),
    )


PRIMITIVES: dict[str, Callable[..., Kind]] = {"box": box, "sphere": sphere, "cylinder": cylinder, "capsule": capsule}
KINDS: dict[str, Callable[..., Kind]] = {**PRIMITIVES, "plane": plane, "mesh": mesh}
ROUND = frozenset({"sphere", "cylinder", "capsule"})


def varying(kind: str, *sizes: Floats) -> Kind:
    """A primitive of another size at each of F rows of points, by its numbers (F, 1) each; one way (F, 3) at each."""
    found = PRIMITIVES[kind](*sizes) if sizes else KINDS[kind]()

    def heights(up: Floats) -> Ends:
        low, high = found.ends(up[:, None])
        return low[:, 0], high[:, 0]

    return replace(found, heights=heights)
