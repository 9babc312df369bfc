"""What grows."""

from __future__ import annotations

import itertools
import math

import numpy as np

from .asset import Asset
from .matter import LEAF, SOIL, TERRACOTTA, Paint
from .parts import Mesh, ball, drum, hull, lathe, tube

GOLDEN = 137.508  # [deg] from a leaf to the next, as plants turn them


def plant() -> Asset:
    """A rubber plant in a pot; the soil in the pot keeps it upright."""
    clay = Paint("pot", TERRACOTTA, (0.50, 0.17, 0.07), 0.8)
    soil = Paint("soil", SOIL, (0.045, 0.028, 0.018), 1.0)
    green = Paint("leaves", LEAF, (0.04, 0.20, 0.035), 0.4)
    bark = Paint("stem", LEAF, (0.16, 0.13, 0.05), 0.8)
    asset = Asset(
        "plant",
        ["plant", "potted plant", "house plant", "houseplant", "pot plant", "flower pot", "flowerpot", "rubber plant"],
        "furnishing/plant",
        "A rubber plant in a terracotta pot.",
        "any side; its leaves stand all around",
    )
    body, tall, top, bottom, wall = asset.body(), 0.2, 0.12, 0.082, 0.008
    outside = [(bottom, 0.0), (top - 0.012, 0.155), (top, 0.155), (top, tall)]
    inside = [(top - 0.012 - wall, tall), (bottom - wall, 0.012)]
    body.add(lathe([(0.0, 0.0), *outside, *inside, (0.0, 0.012)]), clay)
    level, low = tall - 0.02, inside[1]
    body.add(lathe([(0.0, low[1]), low, (top - 0.022, level), (0.0, level + 0.006)]), soil)
    body.add(tube([(0.0, 0.0, level), (0.006, 0.004, 0.4), (-0.004, -0.003, 0.52), (0.0, 0.0, 0.62)], 0.008), bark)
    count = 16
    for k in range(count):
        share = k / (count - 1)
        rise = 12.0 + 60.0 * share**1.5
        leaf = _leaf(0.25 - 0.08 * share, 0.10 - 0.025 * share).turned("Y", -rise)
        at = 0.3 + (0.6 - 0.3) * share
        body.add(leaf.turned("Z", k * GOLDEN).moved(z=at), green)
    crown = max(float(mesh.points[:, 2].max()) for mesh in body.looks.values())
    body.collide("pot", clay, hull(lathe([(0.0, 0.0), (bottom, 0.0), (top, 0.155), (top, tall), (0.0, tall)], 20)))
    body.collide("stem", bark, drum(0.01, tall, 0.42))
    body.collide("crown", green, ball(0.13, (0.0, 0.0, 0.52)))
    body.anchors = {"soil": (0.0, 0.0, level), "top": (0.0, 0.0, crown)}
    return asset


def _leaf(length: float, width: float) -> Mesh:
    """A leaf along +X on its stalk, folded a little and bent down to its tip."""
    stalk, steps = 0.05, 7
    spine, edges = [], []
    for k in range(steps + 1):
        share = k / steps
        half = 0.5 * width * math.sin(math.pi * share**0.8) ** 0.8 if 0 < k < steps else 0.003
        x = stalk + share * (length - stalk)
        z = -0.06 * share**2
        spine.append((x, z))
        edges.append(half)
    points, thick = [], 0.0012
    for (x, z), half in zip(spine, edges, strict=True):
        lift = 0.25 * half
        points += [(x, half, z + lift), (x, 0.0, z + thick), (x, -half, z + lift), (x, 0.0, z - thick)]
    rings = [range(4 * k, 4 * k + 4) for k in range(steps + 1)]
    faces: list[tuple[int, ...]] = [tuple(reversed(rings[0])), tuple(rings[-1])]
    for near, far in itertools.pairwise(rings):
        faces += [(near[j], near[(j + 1) % 4], far[(j + 1) % 4], far[j]) for j in range(4)]
    return Mesh(np.array(points), faces) + tube([(0.0, 0.0, 0.0), (stalk + 0.01, 0.0, 0.0)], 0.0035, 6)
