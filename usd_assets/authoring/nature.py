"""Trees, stones and wood as they grow and lie."""

from __future__ import annotations

import itertools
import math

import numpy as np

from .asset import Asset, Body
from .forms import cone, cylinder, globe
from .matter import GREENWOOD, LEAF, SOIL, STONE, Paint
from .parts import Mesh, Point, ball, block, drum, hull, join, lathe, prism, rod, tube

BARK = Paint("bark", GREENWOOD, (0.13, 0.075, 0.04), 0.95)
WOOD = Paint("wood", GREENWOOD, (0.55, 0.37, 0.18), 0.9)


def lumps(mesh: Mesh, size: float, seed: int, center: Point = (0.0, 0.0, 0.0), waves: int = 5) -> Mesh:
    """A mesh pushed out and in by waves about a centre, by a share `size` of its radius; the same for the same seed."""
    state = np.random.RandomState(seed)  # its stream is frozen by NumPy's promise
    local = mesh.points - center
    reach = np.linalg.norm(local, axis=1)
    way = local / np.maximum(reach, 1e-9)[:, None]
    push = np.zeros(len(way))
    for _ in range(waves):
        push += np.sin(way @ state.uniform(-4.0, 4.0, 3) + state.uniform(0.0, 6.3))
    return Mesh(center + local * (1.0 + size * push / math.sqrt(waves))[:, None], mesh.faces)


def _cut(mesh: Mesh, low: float = 0.0) -> Mesh:
    """Flat below a height."""
    return Mesh(np.maximum(mesh.points, (-np.inf, -np.inf, low)), mesh.faces)


def _stone(asset: Asset, size: Point, seed: int, color: tuple[float, float, float]) -> Asset:
    grey = Paint("stone", STONE, color, 0.95)
    body = asset.body()
    round_ = lumps(globe(1.0, sides=11, rows=7), 0.13, seed)
    points = round_.points * (size[0] / 2, size[1] / 2, size[2] * 0.62) + (0.0, 0.0, size[2] * 0.38)
    mesh = _cut(Mesh(points, round_.faces))
    body.add(mesh, grey)
    body.collide("stone", grey, hull(mesh))
    body.anchors = {"top": (0.0, 0.0, float(mesh.points[:, 2].max()))}
    return asset


def rock() -> Asset:
    """A stone that two hands lift."""
    names = ["rock", "stone", "field stone", "cobble"]
    asset = Asset("rock", names, "nature/stone", "A rock of granite, flat below.", "any side")
    return _stone(asset, (0.30, 0.24, 0.17), 4, (0.30, 0.29, 0.27))


def boulder() -> Asset:
    """A stone that nobody lifts."""
    names = ["boulder", "large rock", "erratic"]
    asset = Asset("boulder", names, "nature/stone", "A boulder of sandstone, flat below.", "any side")
    return _stone(asset, (1.25, 1.0, 0.8), 11, (0.36, 0.28, 0.20))


def _rooted(body: Body, radius: float, tall: float, top: float) -> None:
    """A trunk, and the plate of roots and earth that holds it."""
    soil = Paint("soil", SOIL, (0.07, 0.045, 0.028), 1.0)
    plate = 4.0 * radius + 0.25
    body.add(cone(plate, plate - 0.1, 0.12, sides=20), soil)
    body.collide("roots", soil, drum(plate - 0.02, 0.0, 0.12))
    body.add(
        lathe([(0.0, 0.1), (1.7 * radius, 0.1), (1.1 * radius, 0.25), (radius, 0.5), (top, tall), (0.0, tall)], 14),
        BARK,
    )
    body.collide("trunk", BARK, hull(cone(radius, top, tall - 0.12, (0.0, 0.0, 0.12), sides=12)))


def conifer(height: float = 5.0) -> Asset:
    """A spruce of 5 m in five tiers."""
    green = Paint("needles", LEAF, (0.015, 0.11, 0.045), 0.95)
    asset = Asset(
        "conifer",
        ["conifer", "fir tree", "spruce", "pine tree", "christmas tree", "fir", "evergreen"],
        "nature/tree",
        "A conifer with its root plate.",
        "any side; it is round",
    )
    body = asset.body()
    _rooted(body, 0.11, height - 0.6, 0.03)
    tiers, low = 6, 0.8
    step = (height - low) / (tiers + 0.6)
    for k in range(tiers):
        z, wide = low + k * step, 1.15 * (1.0 - k / (tiers + 0.35))
        top = min(z + 1.75 * step, height)
        points = 22
        skirt = lathe([(0.0, z + 0.12), (wide, z), (wide * 0.5, z + 0.45 * (top - z)), (0.0, top)], points)
        shape = skirt.points.copy()
        ring = np.hypot(shape[:, 0], shape[:, 1]) > 0.9 * wide
        number = np.flatnonzero(ring)
        shape[number[::2], :2] *= 0.80  # branches stand out, and hang a little
        shape[number[::2], 2] += 0.08
        body.add(Mesh(shape, skirt.faces).turned("Z", 25.0 * k), green, 35.0)
    body.collide("lower", green, hull(cone(1.0, 0.35, height * 0.45, (0.0, 0.0, low), sides=12)))
    body.collide("upper", green, hull(cone(0.65, 0.02, height * 0.5 - 0.05, (0.0, 0.0, height * 0.5), sides=12)))
    body.anchors = {"top": (0.0, 0.0, height), "trunk": (0.1, 0.0, 0.6)}
    return asset


def deciduous_tree() -> Asset:
    """A broad-leaved tree of 5 m."""
    green = Paint("leaves", LEAF, (0.06, 0.23, 0.03), 0.9)
    light = Paint("light_leaves", LEAF, (0.11, 0.31, 0.045), 0.9)
    asset = Asset(
        "deciduous_tree",
        ["tree", "deciduous tree", "oak tree", "broadleaf tree", "apple tree", "maple tree"],
        "nature/tree",
        "A broad-leaved tree with its root plate.",
        "any side",
    )
    body = asset.body()
    _rooted(body, 0.14, 2.6, 0.09)
    crowns = [(0.0, 0.0, 3.75, 1.15), (0.75, 0.25, 3.25, 0.85), (-0.65, 0.45, 3.35, 0.85), (-0.2, -0.8, 3.2, 0.85),
              (0.35, -0.3, 4.35, 0.75), (-0.35, 0.3, 4.3, 0.7), (0.45, 0.75, 3.7, 0.7)]  # fmt: skip
    for k, (x, y, z, r) in enumerate(crowns):
        leaf = lumps(globe(r, (x, y, z), 14, 8), 0.07, 20 + k, (x, y, z))
        body.add(leaf, light if k % 3 == 1 else green, 14.0)
        if k:
            body.add(tube([(0.0, 0.0, 2.1), (0.5 * x, 0.5 * y, 2.5), (x, y, z)], 0.045, 8), BARK)
    body.collide("crown", green, *(ball(r * 0.92, (x, y, z)) for x, y, z, r in crowns))
    body.anchors = {"trunk": (0.14, 0.0, 1.0), "top": (0.3, -0.2, 5.0)}
    return asset


def bush() -> Asset:
    """A clipped shrub of 0.9 m."""
    green = Paint("leaves", LEAF, (0.03, 0.17, 0.03), 0.9)
    light = Paint("light_leaves", LEAF, (0.08, 0.27, 0.05), 0.9)
    berry = Paint("berries", LEAF, (0.60, 0.03, 0.02), 0.4)
    asset = Asset("bush", ["bush", "shrub", "hedge plant"], "nature/bush", "A bush with red berries.", "any side")
    body = asset.body()
    soil = Paint("soil", SOIL, (0.07, 0.045, 0.028), 1.0)
    body.add(cone(0.26, 0.2, 0.06, sides=16), soil)
    body.collide("roots", soil, drum(0.24, 0.0, 0.06))
    globes = [
        (0.0, 0.0, 0.5, 0.36),
        (0.22, 0.1, 0.38, 0.27),
        (-0.2, 0.16, 0.4, 0.26),
        (-0.05, -0.24, 0.36, 0.27),
        (0.1, -0.05, 0.66, 0.24),
    ]
    for k, (x, y, z, r) in enumerate(globes):
        ring = globe(r, (x, y, z), 16, 10)
        body.add(lumps(ring, 0.06, 40 + k, (x, y, z), 9), light if k % 2 else green, 30.0)
    tips = [
        np.array((math.cos(2.4 * k) * math.sqrt(1 - w * w), math.sin(2.4 * k) * math.sqrt(1 - w * w), w))
        for k, w in enumerate(np.linspace(-0.3, 0.95, 40))
    ]
    dots = []
    for k, tip in enumerate(tips):
        x, y, z, r = globes[k % len(globes)]
        at = np.array((x, y, z)) + tip * r * 1.0
        dots.append(globe(0.014, (float(at[0]), float(at[1]), float(at[2])), 6, 4))
    body.add(join(dots), berry, 0.0)
    body.add(cylinder(0.03, 0.4, (0.0, 0.0, 0.05), sides=8), BARK)
    body.collide("leaves", green, *(ball(r * 0.95, (x, y, z)) for x, y, z, r in globes))
    body.anchors = {"top": (0.05, 0.0, 0.88)}
    return asset


def fallen_log(length: float = 2.0, radius: float = 0.16) -> Asset:
    """A sawn log that lies along X, on a flat of its bark."""
    asset = Asset(
        "fallen_log",
        ["log", "fallen log", "tree trunk", "tree log"],
        "nature/log",
        "A log with its bark, sawn at both ends; it lies on a flat.",
        "an end; it lies along X",
    )
    body, count = asset.body(), 18
    rings = []
    for k in range(9):
        x = -length / 2 + length * k / 8
        r = radius * (1.0 + 0.04 * math.sin(2.1 * k) - 0.006 * k)
        angles = [2.0 * math.pi * (j + 0.5) / count for j in range(count)]
        bumps = [r * (1.0 + 0.035 * math.sin(5 * a + k) + 0.02 * math.sin(9 * a)) for a in angles]
        rings.append([(x, b * math.cos(a), max(b * math.sin(a), -0.125)) for a, b in zip(angles, bumps, strict=True)])

    body.add(prism(rings).moved(z=0.125), BARK)
    core = [
        cylinder(radius * s, 0.006, (i * (length / 2) - 0.003, 0.0, 0.125), "X", 20) for i, s in ((-1, 0.9), (1, 0.84))
    ]
    body.add(_cut(join(core)), WOOD, 0.0)
    dark = Paint("rings", GREENWOOD, (0.34, 0.19, 0.08), 0.9)
    marks = []
    for i, s in ((-1, 0.9), (1, 0.84)):
        for share in (0.25, 0.5, 0.75):
            ring = lathe(
                [
                    (radius * s * share - 0.003, -0.0045),
                    (radius * s * share, -0.0045),
                    (radius * s * share, 0.0045),
                    (radius * s * share - 0.003, 0.0045),
                ],
                20,
            )
            marks.append(ring.turned("Y", 90.0).moved(i * length / 2, 0.0, 0.125))
    body.add(join(marks), dark, 0.0)
    stub = tube([(0.3, 0.08, 0.2), (0.38, 0.2, 0.32)], 0.035, 8)
    body.add(stub, BARK)
    for (k, a), (_, b) in itertools.pairwise(enumerate((0, 4, 8))):
        body.collide(f"log_{k}", BARK, hull(prism([rings[a], rings[b]]).moved(z=0.125)))
    body.collide("stub", BARK, rod((0.3, 0.08, 0.2), (0.38, 0.2, 0.32), 0.03))
    body.anchors = {
        "top": (0.0, 0.0, 0.275),
        "front_end": (length / 2, 0.0, 0.125),
        "back_end": (-length / 2, 0.0, 0.125),
    }
    return asset


def stump(height: float = 0.42, radius: float = 0.22) -> Asset:
    """A tree stump with roots, its rings on top."""
    asset = Asset(
        "stump",
        ["stump", "tree stump", "chopping block"],
        "nature/stump",
        "A tree stump with its roots and rings.",
        "any side",
    )
    body = asset.body()
    trunk = lathe(
        [
            (0.0, 0.0),
            (radius * 1.3, 0.0),
            (radius * 1.1, 0.1),
            (radius, 0.22),
            (radius * 0.97, height - 0.004),
            (0.0, height - 0.004),
        ],
        22,
    )
    points = trunk.points.copy()
    angle = np.arctan2(points[:, 1], points[:, 0])
    points[:, :2] *= (1.0 + (0.05 + 0.1 * (points[:, 2] < 0.05)) * np.sin(5 * angle + 0.6))[:, None]
    body.add(Mesh(points, trunk.faces), BARK)
    for k in range(5):
        root = tube([(radius * 0.9, 0.0, 0.1), (radius * 1.5, 0.0, 0.045), (radius * 1.95, 0.03, 0.005)], 0.05, 8)
        body.add(_cut(root).turned("Z", 72.0 * k + 12.0), BARK)
    body.add(cylinder(radius * 0.9, 0.005, (0.0, 0.0, height - 0.005), sides=24), WOOD, 0.0)
    dark = Paint("rings", GREENWOOD, (0.34, 0.19, 0.08), 0.9)
    marks = [
        lathe(
            [(r - 0.004, height - 0.004), (r, height - 0.004), (r, height + 0.0006), (r - 0.004, height + 0.0006)], 24
        )
        for r in (0.04, 0.08, 0.12, 0.16)
    ]
    body.add(join(marks), dark, 0.0)
    body.collide(
        "stump",
        BARK,
        hull(lathe([(0.0, 0.0), (radius * 1.25, 0.0), (radius, 0.2), (radius * 0.95, height), (0.0, height)], 16)),
    )
    body.collide(
        "root",
        BARK,
        *(
            block((0.2, 0.08, 0.03), (float(c * 0.32), float(s * 0.32), 0.015), "Z", 72.0 * k + 12.0)
            for k in range(5)
            for c, s in [(math.cos(math.radians(72 * k + 14)), math.sin(math.radians(72 * k + 14)))]
        ),
    )
    body.anchors = {"top": (0.0, 0.0, height)}
    return asset
