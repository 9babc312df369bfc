"""Pots, plates and bottles."""

from __future__ import annotations

import itertools

from .asset import Asset
from .forms import globe
from .matter import ABS, CAST_IRON, GLASS, PORCELAIN, STEEL, Paint
from .parts import Mesh, arc, drum, hull, lathe, rod, tube
from .rounds import vessel


def pot(height: float = 0.14, radius: float = 0.12) -> Asset:
    """A cooking pot of stainless steel for 5 l, without its lid."""
    steel = Paint("steel", STEEL, (0.50, 0.51, 0.53), 0.25, 0.7)
    inner = Paint("inside", STEEL, (0.30, 0.31, 0.32), 0.4, 0.6)
    black = Paint("handles", ABS, (0.02, 0.02, 0.022))
    asset = Asset(
        "pot",
        ["pot", "cooking pot", "saucepan", "stew pot", "stock pot", "casserole"],
        "tableware/pot",
        "A cooking pot of steel with two handles, open at the top.",
        "any side; the handles are at +Y and -Y",
    )
    body, wall, floor = asset.body(), 0.004, 0.008
    free = radius - wall
    outside = [(radius - 0.006, 0.0), (radius, 0.006), (radius, height - 0.004), (radius + 0.004, height)]
    vessel(asset, body, steel, outside, [(free, floor), (free, height)], wall, mass=1.9, count=18)
    lining = [(free, floor), (free, height - 0.006), (free - 0.0008, height - 0.006), (free - 0.0008, floor + 0.0008)]
    body.add(lathe([(0.0, floor), *lining, (0.0, floor + 0.0008)], 40), inner, 0.0)
    for j, side in ((-1, "right"), (1, "left")):
        y, z = j * radius, height - 0.03
        ends = [(-0.045, y - j * 0.004, z), (-0.045, y + j * 0.03, z + 0.004), (0.045, y + j * 0.03, z + 0.004),
                (0.045, y - j * 0.004, z)]  # fmt: skip
        body.add(tube(ends, 0.008, 10), black, mass=0.06)
        body.collide(f"handle_{side}", black, rod(ends[1], ends[2], 0.008))
        body.anchors[f"handle_{side}"] = (0.0, ends[1][1], z)
    return asset


def pan(radius: float = 0.14, height: float = 0.05) -> Asset:
    """A frying pan of 28 cm of cast iron."""
    iron = Paint("iron", CAST_IRON, (0.025, 0.026, 0.03), 0.5)
    inner = Paint("inside", CAST_IRON, (0.10, 0.10, 0.105), 0.4)
    wood = Paint("handle", ABS, (0.20, 0.08, 0.03))
    asset = Asset(
        "pan",
        ["pan", "frying pan", "skillet", "fry pan"],
        "tableware/pan",
        "A frying pan with a long handle, open at the top.",
        "the handle, where the cook stands",
    )
    body, wall, floor, foot = asset.body(), 0.005, 0.006, 0.11
    outside = [(foot, 0.0), (radius, height)]
    vessel(asset, body, iron, outside, [(foot - 0.003, floor), (radius - wall, height)], wall, mass=1.75, count=18)
    lining = [(foot - 0.003, floor), (radius - wall - 0.002, height - 0.004), (foot - 0.005, floor + 0.001)]
    body.add(lathe([(0.0, floor), *lining, (0.0, floor + 0.001)], 40), inner, 0.0)
    start, bend, end = (radius - 0.015, 0.0, 0.036), (radius + 0.05, 0.0, 0.05), (radius + 0.2, 0.0, 0.075)
    body.add(tube([start, bend], 0.008, 10), iron, mass=0.12)
    body.add(tube([bend, end], 0.0125, 12), wood, mass=0.1)
    body.collide("handle", wood, rod((radius + 0.008, 0.0, 0.044), end, 0.011))
    body.anchors["handle"] = (radius + 0.13, 0.0, 0.063)
    return asset


def plate(radius: float = 0.135, height: float = 0.024) -> Asset:
    """A dinner plate of porcelain."""
    white = Paint("glaze", PORCELAIN, (0.85, 0.85, 0.82), 0.2)
    blue = Paint("rim", PORCELAIN, (0.05, 0.12, 0.38), 0.2)
    asset = Asset(
        "plate",
        ["plate", "dinner plate", "china plate", "saucer"],
        "tableware/plate",
        "A dinner plate of porcelain.",
        "any side; it is round",
    )
    body, floor, flat = asset.body(), 0.007, 0.085
    inside = [(flat, floor), (flat + 0.008, floor + 0.006), (radius - 0.002, height)]
    outside = [(flat - 0.005, 0.0), (flat - 0.003, 0.004), (flat + 0.012, 0.008), (radius, height - 0.003)]
    vessel(asset, body, white, outside, inside, 0.004, mass=0.58, count=16, named=False)

    def up(r: float) -> float:
        return floor + 0.006 + (r - flat - 0.008) * (height - floor - 0.006) / (radius - 0.002 - flat - 0.008)

    for low, high in ((radius - 0.013, radius - 0.0035), (flat + 0.011, flat + 0.0135)):
        band = [(low, up(low) - 0.001), (high, up(high) - 0.001), (high, up(high) + 0.0006), (low, up(low) + 0.0006)]
        body.add(lathe(band, 40), blue, 0.0)
    body.anchors = {"top": (0.0, 0.0, floor)}
    return asset


def drinking_glass(height: float = 0.125, radius: float = 0.038) -> Asset:
    """A tumbler for 0.3 l."""
    clear = Paint("glass", GLASS, (0.70, 0.82, 0.84), 0.05, 0.0, 0.35)
    asset = Asset(
        "drinking_glass",
        ["glass", "drinking glass", "water glass", "tumbler", "glass cup"],
        "tableware/glass",
        "A drinking glass, open at the top.",
        "any side; it is round",
    )
    body, wall, floor, foot = asset.body(), 0.003, 0.012, 0.031
    outside = [(foot - 0.002, 0.0), (foot, 0.002), (radius, height)]
    vessel(asset, body, clear, outside, [(foot - wall, floor), (radius - wall, height)], wall, count=16)
    return asset


def wine_bottle(height: float = 0.3, radius: float = 0.0375) -> Asset:
    """A full, corked Bordeaux bottle of 0.75 l."""
    green = Paint("glass", GLASS, (0.015, 0.07, 0.03), 0.1)
    foil = Paint("foil", STEEL, (0.35, 0.02, 0.04), 0.3, 0.4)
    label = Paint("label", PORCELAIN, (0.85, 0.80, 0.66), 0.8)
    print_ = Paint("print", PORCELAIN, (0.30, 0.04, 0.05), 0.8)
    asset = Asset(
        "wine_bottle",
        ["wine bottle", "bottle", "bottle of wine", "glass bottle"],
        "tableware/bottle",
        "A full bottle of wine with its label.",
        "the label",
    )
    body, neck = asset.body(), 0.0145
    outline = [(0.0, 0.0), (radius - 0.003, 0.0), (radius, 0.003), (radius, 0.185), (radius - 0.004, 0.2),
               (neck + 0.006, 0.222), (neck, 0.235), (neck, height - 0.005), (0.0, height - 0.005)]  # fmt: skip
    body.add(lathe(outline), green, mass=1.28)
    top = [(neck, 0.245), (neck + 0.0008, 0.245), (neck + 0.0008, height - 0.018), (neck + 0.002, height - 0.017),
           (neck + 0.002, height), (0.0, height)]  # fmt: skip
    body.add(lathe([(0.0, 0.245), *top]), foil, mass=0.01)
    paper = _around(
        lathe(
            [(radius - 0.002, 0.055), (radius + 0.0005, 0.055), (radius + 0.0005, 0.145), (radius - 0.002, 0.145)], 40
        )
    )
    body.add(paper, label, 0.0)
    for low, high in ((0.062, 0.067), (0.098, 0.118), (0.133, 0.138)):
        band = [(radius - 0.002, low), (radius + 0.001, low), (radius + 0.001, high), (radius - 0.002, high)]
        body.add(_around(lathe(band, 40), 0.028), print_, 0.0)
    body.collide("body", green, drum(radius, 0.0, 0.195))
    body.collide(
        "shoulder", green, hull(lathe([(0.0, 0.19), (radius - 0.004, 0.195), (neck, 0.235), (0.0, 0.235)], 16))
    )
    body.collide("neck", green, drum(neck + 0.0012, 0.23, height))
    body.anchors = {"top": (0.0, 0.0, height), "neck": (neck, 0.0, 0.26), "label": (radius, 0.0, 0.1)}
    return asset


def _around(band: Mesh, reach: float = 0.033) -> Mesh:
    """The part of a ring that faces +X: what lies behind is drawn into the bottle."""
    points = band.points.copy()
    hidden = (points[:, 0] < 0.0) | (abs(points[:, 1]) > reach)
    points[hidden, :2] *= 0.9
    return Mesh(points, band.faces)


def kettle(radius: float = 0.1, height: float = 0.14) -> Asset:
    """A stove kettle of enamelled steel with a spout, a lid and a handle above."""
    red = Paint("enamel", STEEL, (0.55, 0.03, 0.03), 0.25)
    black = Paint("handle", ABS, (0.02, 0.02, 0.022))
    steel = Paint("bow", STEEL, (0.45, 0.45, 0.47), 0.3, 0.8)
    asset = Asset(
        "kettle",
        ["kettle", "tea kettle", "teakettle", "water kettle", "teapot"],
        "tableware/kettle",
        "A closed stove kettle with a spout, a lid and a handle above it.",
        "the side; the spout is at +Y",
    )
    body = asset.body()
    curve = [
        (radius - 0.006, 0.0),
        (radius, 0.008),
        (radius, 0.05),
        (radius - 0.012, 0.085),
        (0.065, 0.115),
        (0.048, 0.122),
    ]
    body.add(lathe([(0.0, 0.0), *curve, (0.0, 0.122)], 36), red, mass=0.95)
    lid = [(0.0, 0.12), (0.05, 0.12), (0.05, 0.125), (0.025, 0.134), (0.0, 0.136)]
    body.add(lathe(lid, 28), red, mass=0.12)
    body.add(globe(0.012, (0.0, 0.0, 0.147), 14, 8), black, mass=0.02)
    spout = [(0.0, 0.06, 0.05), (0.0, 0.11, 0.075), (0.0, 0.145, 0.118)]
    body.add(tube(spout, 0.014, 12), red, mass=0.08)
    body.add(tube([spout[2], (0.0, 0.152, 0.126)], 0.010, 12), steel, 0.0)
    bow = arc((0.0, 0.0, 0.1), 0.09, 15.0, 165.0, 15)
    bow = [(x, y, 0.1 + (z - 0.1) * 1.2) for x, y, z in bow]
    body.add(tube(bow, 0.005, 8), steel, mass=0.12)
    body.add(tube(bow[4:11], 0.011, 10), black, mass=0.05)
    body.collide("pot", red, drum(radius, 0.0, 0.07))
    body.collide(
        "shoulder", red, hull(lathe([(0.0, 0.07), (radius, 0.07), (0.065, 0.115), (0.048, 0.125), (0.0, 0.125)], 16))
    )
    body.collide("spout", red, rod((0.0, 0.085, 0.06), (0.0, 0.148, 0.122), 0.012))
    rods = [rod(a, b, 0.008) for a, b in itertools.pairwise(bow[1:14:3])]
    body.collide("handle", black, *rods)
    body.anchors = {"top": (0.0, 0.0, 0.155), "handle": bow[7], "spout": (0.0, 0.145, 0.124)}
    return asset
