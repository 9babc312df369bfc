"""Balls of sports, with the sizes, masses and rebounds of their rules.

A rebound from a height h to r h is a restitution of sqrt(r). wsim gives a contact the smaller restitution of the two
that are stated: on ground that states none, a ball bounces as its rules say.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

import numpy as np

from .asset import Asset
from .forms import globe
from .matter import Paint, Substance
from .parts import Array, Mesh, Point, ball, drum, hull, join, lathe, prism, tube

FELT = Substance(400.0, 0.6, math.sqrt((1.346 + 1.473) / 2 / 2.54))  # ITF: from 2.54 m to 1.346..1.473 m
LEATHER = Substance(70.0, 0.6, 0.8)  # IFAB: 0.41..0.45 kg; FIFA's test from 2 m: 1.35 m
PEBBLED = Substance(80.0, 0.7, math.sqrt(1.3 / 1.8))  # FIBA: from 1.8 m to 1.2..1.4 m
CELLULOID = Substance(85.0, 0.4, math.sqrt(0.25 / 0.305))  # ITTF: from 0.305 m to 0.24..0.26 m
SURLYN = Substance(1130.0, 0.4, 0.83)  # R&A: at most 0.83 at 43.8 m/s
RESIN = Substance(1720.0, 0.2, 0.95)  # phenolic, on another ball
URETHANE = Substance(1270.0, 0.2, 0.7)
MAPLE = Substance(700.0, 0.3, 0.6)


def _ball(id: str, names: list[str], description: str, radius: float, mass: float, paint: Paint, hollow: bool) -> Asset:
    """A ball; a `hollow` one carries its mass in its skin: I = 2/3 m r^2."""
    asset = Asset(id, names, "sport/ball", description, "any side; it is round")
    body = asset.body()
    center = (0.0, 0.0, radius)
    skin = globe(radius, center, 32, 16)
    body.add(skin, paint, 0.0)
    if hollow:
        inner = globe(0.97 * radius, center, 32, 16)
        shell = skin + Mesh(inner.points, [tuple(reversed(face)) for face in inner.faces])
        body.weigh(shell, mass / shell.volume())
    else:
        body.weigh(skin, mass / skin.volume())
    body.collide("ball", paint, ball(radius, center))
    body.anchors = {"top": (0.0, 0.0, 2 * radius)}
    return asset


def football() -> Asset:
    """A football of size 5: 0.22 m, 0.43 kg (IFAB, law 2)."""
    white = Paint("leather", LEATHER, (0.85, 0.85, 0.83), 0.4)
    black = Paint("patches", LEATHER, (0.015, 0.015, 0.017), 0.4)
    names = ["football", "soccer ball", "soccerball"]
    asset, radius = _ball("football", names, "A football (soccer ball) of size 5.", 0.11, 0.43, white, True), 0.11
    golden = (1.0 + math.sqrt(5.0)) / 2.0
    tips = [(0.0, i, j * golden) for i in (-1, 1) for j in (-1, 1)]
    tips = [*tips, *[(y, z, x) for x, y, z in tips], *[(z, x, y) for x, y, z in tips]]
    seams, dots = [], []
    around = np.array(tips) / math.hypot(1.0, golden)
    for k, tip in enumerate(around):
        near = max(
            (other for other in around if other is not tip), key=lambda other: round(float(other @ tip), 9) % 0.999
        )
        dots.append(_patch(tip, radius, 22.0, 5, near))
        for other in around[k + 1 :]:
            if tip @ other > 0.4:
                seams.append(_seam(tip, other, radius))
    _mark(asset, [*dots, *seams], radius, black)
    return asset


def _patch(tip: Array, radius: float, degrees: float, corners: int = 0, towards: Array | None = None) -> Mesh:
    """A spot that lies on a ball about a direction: round, or a polygon with a corner towards another direction."""
    u = np.array((0.3, 0.5, 0.8)) if towards is None else towards
    u = u - tip * (u @ tip)
    u /= np.linalg.norm(u)
    small = degrees < 8.0
    lift = 1.004 if small else 1.01  # its faces are flat: their middles stay above the ball
    v, count = np.cross(tip, u), 4 * corners or (8 if small else 16)
    rings = []
    for up, share in ((0.97, 1.0), (lift, 1.0), (lift, 0.66), (lift, 0.33))[: 2 if small else 4]:
        ring = []
        for k in range(count):
            turn = 2.0 * math.pi * k / count
            inward = 1.0
            if corners:
                half = math.pi / corners
                inward = math.cos(half) / math.cos(turn % (2.0 * half) - half)
            a = math.radians(degrees * share * inward)
            ring.append(_at(math.cos(a) * tip + math.sin(a) * (math.cos(turn) * u + math.sin(turn) * v), radius * up))
        rings.append(ring)
    return prism(rings)


def _at(way: Array, radius: float) -> Point:
    """The point of a ball in a direction."""
    x, y, z = radius * way / np.linalg.norm(way)
    return (float(x), float(y), float(z))


def _mark(asset: Asset, meshes: list[Mesh], radius: float, paint: Paint) -> None:
    """Show marks on a ball about the origin: they stand out nowhere where it is widest."""
    mesh = join(meshes).moved(z=radius)
    points = mesh.points.clip((-radius, -radius, 0.0), (radius, radius, 2.0 * radius))
    asset.bodies[0].add(Mesh(points, mesh.faces), paint, 0.0)


def _seam(start: Array, end: Array, radius: float, width: float = 0.0013) -> Mesh:
    """A line on a ball, the short way between two directions."""
    ways = [start + (end - start) * share for share in (0.24, 0.37, 0.5, 0.63, 0.76)]
    return tube([_at(way, radius) for way in ways], width, 6)


def _line(radius: float, width: float, way: Callable[[float], tuple[float, float, float]]) -> Mesh:
    """A closed line on a ball, through the directions of a function of an angle."""
    angles = [2.0 * math.pi * k / 48 for k in range(49)]
    return tube([_at(np.array(way(a)), radius) for a in angles], width, 6)


def basketball() -> Asset:
    """A basketball of size 7: 0.242 m, 0.61 kg (FIBA)."""
    orange = Paint("leather", PEBBLED, (0.62, 0.19, 0.04), 0.6)
    black = Paint("seams", PEBBLED, (0.015, 0.015, 0.017), 0.6)
    radius = 0.121
    asset = _ball("basketball", ["basketball", "basket ball"], "A basketball of size 7.", radius, 0.61, orange, True)
    lines = [
        _line(radius, 0.0022, lambda a: (math.cos(a), math.sin(a), 0.0)),
        _line(radius, 0.0022, lambda a: (math.cos(a), 0.0, math.sin(a))),
    ]
    for side in (-1.0, 1.0):
        bow = _line(radius, 0.0022, partial(_bow, side))
        lines.append(bow)
    _mark(asset, [line.turned("X", 24.0).turned("Z", 12.0) for line in lines], radius, black)
    return asset


def _bow(side: float, angle: float) -> tuple[float, float, float]:
    """The curved seams of a basketball, at +Y and -Y."""
    return 0.62 * math.cos(angle), side * (0.78 + 0.1 * math.cos(2.0 * angle)), 0.62 * math.sin(angle)


def tennis_ball() -> Asset:
    """A tennis ball: 66 mm, 57.7 g (ITF)."""
    yellow = Paint("felt", FELT, (0.55, 0.72, 0.03), 0.95)
    white = Paint("seam", FELT, (0.85, 0.85, 0.80), 0.9)
    radius = 0.033
    asset = _ball("tennis_ball", ["tennis ball"], "A tennis ball.", radius, 0.0577, yellow, True)
    c = 2.0 * math.sqrt(3.0)
    seam = _line(
        radius,
        0.0013,
        lambda a: (3 * math.cos(a) + math.cos(3 * a), 3 * math.sin(a) - math.sin(3 * a), c * math.sin(2 * a)),
    )
    _mark(asset, [seam.turned("X", 35.0).turned("Z", 30.0)], radius, white)
    return asset


def golf_ball() -> Asset:
    """A golf ball: 42.67 mm, 45.93 g (R&A)."""
    white = Paint("cover", SURLYN, (0.86, 0.86, 0.84), 0.35)
    grey = Paint("dimples", SURLYN, (0.50, 0.50, 0.50), 0.5)
    radius = 0.021335
    asset = _ball("golf_ball", ["golf ball", "golfball"], "A golf ball with dimples.", radius, 0.04593, white, False)
    dots, count = [], 84
    for k in range(count):
        z = 1.0 - (2.0 * k + 1.0) / count
        a = math.radians(137.508) * k
        tip = np.array([math.sqrt(1.0 - z * z) * math.cos(a), math.sqrt(1.0 - z * z) * math.sin(a), z])
        dots.append(_patch(tip, radius, 5.0))
    _mark(asset, dots, radius, grey)
    return asset


def table_tennis_ball() -> Asset:
    """A table-tennis ball: 40 mm, 2.7 g (ITTF)."""
    orange = Paint("plastic", CELLULOID, (0.85, 0.33, 0.03), 0.5)
    line = Paint("print", CELLULOID, (0.03, 0.03, 0.05), 0.5)
    names = ["table tennis ball", "ping pong ball", "ping-pong ball"]
    radius = 0.02
    asset = _ball("table_tennis_ball", names, "A table-tennis ball.", radius, 0.0027, orange, True)
    marks = [(0.25, 0.0), (0.4, 0.12), (0.4, -0.12)]
    dots = []
    for z, y in marks:
        tip = np.array([1.0, y - 0.05, z])
        dots.append(_patch(tip / np.linalg.norm(tip), radius, 4.0))
    path = [np.array([1.0, -0.35 + 0.1 * k, 0.02 * k - 0.05]) for k in range(7)]
    dots.append(tube([_at(way, radius) for way in path], 0.0007, 6))
    _mark(asset, dots, radius, line)
    return asset


def billiard_ball() -> Asset:
    """A pool ball: 57.15 mm, 0.17 kg (WPA); it is number 8."""
    black = Paint("resin", RESIN, (0.012, 0.012, 0.014), 0.1)
    white = Paint("spot", RESIN, (0.88, 0.87, 0.82), 0.1)
    names = ["billiard ball", "pool ball", "snooker ball"]
    radius = 0.028575
    asset = _ball("billiard_ball", names, "A billiard ball with the number 8.", radius, 0.17, black, False)
    tip = np.array([0.82, -0.22, 0.53])
    tip /= np.linalg.norm(tip)
    _mark(asset, [_patch(tip, radius, 24.0)], radius, white)
    side = np.cross((0.0, 0.0, 1.0), tip)
    side /= np.linalg.norm(side)
    up = np.cross(tip, side)
    rings = []
    for high, r in ((0.0034, 0.0026), (-0.0030, 0.0033)):
        ring = []
        for k in range(17):
            a = 2.0 * math.pi * k / 16
            way = tip * radius + (high + r * math.sin(a)) * up + r * math.cos(a) * side
            ring.append(_at(way, 1.011 * radius))
        rings.append(tube(ring, 0.0009, 6))
    _mark(asset, rings, radius, Paint("number", RESIN, (0.013, 0.012, 0.014), 0.1))
    return asset


def bowling_ball() -> Asset:
    """A bowling ball of 14 pounds: 0.216 m, 6.35 kg (USBC), with three holes."""
    blue = Paint("urethane", URETHANE, (0.03, 0.05, 0.28), 0.15)
    black = Paint("holes", URETHANE, (0.008, 0.008, 0.01), 0.6)
    radius = 0.108
    asset = _ball(
        "bowling_ball", ["bowling ball"], "A bowling ball with three finger holes.", radius, 6.35, blue, False
    )
    dots = []
    for y, z in ((-0.04, 0.82), (0.26, 0.82), (0.1, 0.42)):
        tip = np.array([0.75, y, z])
        dots.append(_patch(tip / np.linalg.norm(tip), radius, 6.5))
    _mark(asset, dots, radius, black)
    return asset


def bowling_pin(height: float = 0.381) -> Asset:
    """A tenpin: 15 inches, 1.55 kg, its profile that of the USBC."""
    white = Paint("coat", MAPLE, (0.86, 0.85, 0.81), 0.25)
    red = Paint("stripes", MAPLE, (0.60, 0.03, 0.03), 0.25)
    names = ["bowling pin", "tenpin", "skittle", "ninepin"]
    asset = Asset("bowling_pin", names, "sport/pin", "A bowling pin with two red stripes.", "any side; it is round")
    # Heights and diameters of the rule, in inches.
    rule = [
        (0.0, 2.03),
        (0.75, 2.828),
        (2.25, 3.906),
        (3.375, 4.51),
        (4.5, 4.766),
        (5.875, 4.563),
        (7.25, 3.703),
        (8.625, 2.472),
        (9.375, 1.965),
        (10.0, 1.797),
        (10.875, 1.87),
        (11.75, 2.094),
        (12.625, 2.406),
        (13.5, 2.547),
        (14.3, 2.2),
        (14.8, 1.3),
        (15.0, 0.0),
    ]
    inch = height / 15.0
    profile = [(d / 2 * inch, z * inch) for z, d in rule]
    body = asset.body()
    body.add(lathe([(0.0, 0.0), *profile], 32), white, mass=1.55)
    for low in (9.5, 10.6):
        radii = np.interp([low, low + 0.45], [z for z, _ in rule], [d / 2 for _, d in rule])
        lo, hi = (float(r) * inch + 0.0006 for r in radii)
        band = [
            (lo - 0.003, low * inch),
            (lo, low * inch),
            (hi, (low + 0.45) * inch),
            (hi - 0.003, (low + 0.45) * inch),
        ]
        body.add(lathe(band, 32), red, 0.0)
    body.collide("belly", white, hull(lathe([(0.0, 0.0), *profile[:8], (0.0, profile[7][1])], 20)))
    body.collide("neck", white, drum(0.024, profile[7][1], profile[11][1]))
    body.collide("head", white, ball(2.547 / 2 * inch, (0.0, 0.0, height - 2.547 / 2 * inch)))
    body.anchors = {"top": (0.0, 0.0, height)}
    return asset
