"""Things that hold things: open ones are hollow to what falls in."""

from __future__ import annotations

import itertools

from .asset import Asset
from .forms import inscribed
from .matter import HDPE, OAK, PINE, STEEL, STONEWARE, Paint
from .parts import Point, Profile, arc, block, box, drum, join, lathe, ring, rod, staves, tube


def mug(height: float = 0.095, radius: float = 0.041) -> Asset:
    """A mug of stoneware for 0.35 l; the handle is at the drinker's right."""
    glaze = Paint("glaze", STONEWARE, (0.55, 0.05, 0.04), 0.25)
    inner = Paint("inside", STONEWARE, (0.80, 0.76, 0.68), 0.25)
    asset = Asset(
        "mug",
        ["mug", "cup", "coffee cup", "coffee mug", "tea cup", "teacup"],
        "tableware/mug",
        "A coffee mug of stoneware with a handle, open at the top.",
        "the drinker's side; the handle is at +Y, to the drinker's right",
    )
    body, wall, floor = asset.body(), 0.005, 0.006
    free = radius - wall
    outside: Profile = [
        (0.0, 0.0),
        (radius - 0.004, 0.0),
        (radius, 0.004),
        (radius, height - 0.002),
        (radius - 0.002, height),
    ]
    body.add(
        lathe([*outside, (free, height - 0.003), (free, floor + 0.003), (free - 0.003, floor), (0.0, floor)]), glaze
    )
    lining: Profile = [
        (free, floor),
        (free, height - 0.008),
        (free - 0.0006, height - 0.008),
        (free - 0.0006, floor + 0.0006),
    ]
    body.add(lathe([(0.0, floor), *lining, (0.0, floor + 0.0006)]), inner, 0.0)
    z, reach = 0.05, 0.027
    path = [(0.0, radius - 0.003, z + reach - 0.002), *arc((0.0, radius + 0.006, z), reach, 80.0, -80.0, 12)]
    body.add(tube([*path, (0.0, radius - 0.003, z - reach + 0.002)], 0.0055), glaze)
    body.collide("floor", glaze, drum(radius - 0.001, 0.0, floor))
    body.collide("wall", glaze, *ring(free, wall, floor, height, 16))
    out = radius + 0.006 + reach
    bends: list[Point] = [(0.0, radius, z + reach), (0.0, out - 0.008, z + reach - 0.003), (0.0, out, z + 0.012)]
    bends += [(y, w, 2 * z - h) for y, w, h in reversed(bends)]
    rods = [rod(a, b, 0.0055) for a, b in itertools.pairwise(bends)]
    body.collide("handle", glaze, *rods)
    body.anchors = {
        "top": (0.0, 0.0, height),
        "inside": (0.0, 0.0, floor),
        "handle": (0.0, out, z),
    }
    edge = inscribed(free)
    asset.hollow = ((edge, edge, height - floor), (0.0, 0.0, (height + floor) / 2))
    return asset


def bowl(height: float = 0.07, radius: float = 0.085) -> Asset:
    """A breakfast bowl of stoneware."""
    glaze = Paint("glaze", STONEWARE, (0.06, 0.18, 0.36), 0.25)
    inner = Paint("inside", STONEWARE, (0.80, 0.77, 0.70), 0.25)
    asset = Asset(
        "bowl",
        ["bowl", "soup bowl", "cereal bowl", "dish", "basin"],
        "tableware/bowl",
        "A breakfast bowl of stoneware, open at the top.",
        "any side; it is round",
    )
    body, wall, floor, foot = asset.body(), 0.005, 0.009, 0.042
    inside = [(0.040, floor), (0.062, 0.026), (0.076, 0.048), (radius - wall, height)]
    outside = [(foot, 0.0), (foot, 0.006), (0.067, 0.023), (0.081, 0.046), (radius, height - 0.001)]
    body.add(lathe([(0.0, 0.0), *outside, *reversed(inside), (0.0, floor)], 40), glaze)
    skin = 0.0006
    lining = [(r, z) for r, z in inside[:-1]] + [(radius - wall - 0.001, height - 0.006)]
    up = [(r - skin, z + skin) for r, z in reversed(lining)]
    body.add(lathe([(0.0, floor), *lining, *up, (0.0, floor + skin)], 40), inner, 0.0)
    body.collide("floor", glaze, drum(foot, 0.0, floor))
    for k, ((r0, z0), (r1, z1)) in enumerate(itertools.pairwise(inside)):
        body.collide(f"wall_{k}", glaze, *staves((r0, r1), wall, z0, z1, 12))
    body.anchors = {"top": (0.0, 0.0, height), "inside": (0.0, 0.0, floor)}
    edge = inscribed(inside[0][0])
    asset.hollow = ((edge, edge, height - floor), (0.0, 0.0, (height + floor) / 2))
    return asset


def bucket(height: float = 0.28, top: float = 0.148, bottom: float = 0.105) -> Asset:
    """A bucket of plastic for 12 l; its bail hangs over the front."""
    plastic = Paint("plastic", HDPE, (0.02, 0.16, 0.42), 0.4)
    inner = Paint("inside", HDPE, (0.015, 0.10, 0.28), 0.5)
    wire = Paint("bail", STEEL, (0.50, 0.50, 0.52), 0.3, 0.8)
    asset = Asset(
        "bucket",
        ["bucket", "pail", "water bucket", "plastic bucket"],
        "container/bucket",
        "A plastic bucket of 12 litres with a wire bail, open at the top.",
        "the side over which the bail hangs",
    )
    body, wall, floor, rim = asset.body(), 0.003, 0.008, 0.006
    outside = [(bottom, 0.0), (top - rim, height - 0.02), (top, height - 0.02), (top, height)]
    inside = [(top - rim - wall + 0.001, height), (bottom - wall, floor)]
    body.add(lathe([(0.0, 0.0), *outside, *inside, (0.0, floor)], 40), plastic)
    (r1, z1), (r0, z0) = inside
    lining = [(r0 - 0.0005, z0), (r1 - 0.0005, z1 - 0.004), (r1 - 0.0015, z1 - 0.004), (r0 - 0.0015, z0 + 0.001)]
    body.add(lathe([(0.0, floor), *lining, (0.0, floor + 0.001)], 40), inner, 0.0)
    ears = [box((0.03, 0.008, 0.04), (0.0, j * (top + 0.002), height - 0.022)) for j in (-1, 1)]
    body.add(join(ears), plastic)
    hang, reach = height - 0.025, top + 0.008
    bail = tube(arc((0.0, 0.0, 0.0), reach, -90.0, 90.0, 25, "XY"), 0.0025, 8).turned("Y", 18.0).moved(z=hang)
    grip = tube(arc((0.0, 0.0, 0.0), reach, -18.0, 18.0, 9, "XY"), 0.009, 10).turned("Y", 18.0).moved(z=hang)
    body.add(bail, wire)
    body.add(grip, Paint("grip", HDPE, (0.72, 0.70, 0.62)))
    body.collide("floor", plastic, drum(bottom, 0.0, floor))
    body.collide("wall", plastic, *staves((r0, r1), wall, floor, height, 20))
    body.anchors = {"top": (0.0, 0.0, height), "inside": (0.0, 0.0, floor), "handle": (reach, 0.0, hang)}
    edge = inscribed(r0)
    asset.hollow = ((edge, edge, height - floor), (0.0, 0.0, (height + floor) / 2))
    return asset


def barrel(height: float = 0.88, belly: float = 0.31, end: float = 0.255) -> Asset:
    """A closed, empty barrel of oak, bound with steel hoops."""
    oak = Paint("staves", OAK, (0.38, 0.18, 0.065))
    heads = Paint("heads", OAK, (0.50, 0.28, 0.12))
    hoop = Paint("hoops", STEEL, (0.10, 0.10, 0.11), 0.4, 0.6)
    asset = Asset(
        "barrel",
        ["barrel", "cask", "keg", "wine barrel", "wooden barrel"],
        "container/barrel",
        "A closed, empty barrel of oak with steel hoops.",
        "any side; it is round",
    )
    body, stave, sunk, rows = asset.body(), 0.026, 0.03, 14

    def bulge(z: float) -> float:
        return belly - (belly - end) * (2.0 * z / height - 1.0) ** 2

    heights = [height * k / rows for k in range(rows + 1)]
    curve = [(bulge(z), z) for z in heights]
    shell = [*curve, *((r - stave, z) for r, z in reversed(curve))]
    body.add(lathe(shell), oak)
    for z in (sunk, height - sunk - 0.02):
        radius = bulge(z) - stave
        body.add(lathe([(0.0, z), (radius, z), (radius, z + 0.02), (0.0, z + 0.02)]), heads)
    for low in (0.015, 0.16, 0.3):
        for z in (low, height - low - 0.045):
            edges = [(bulge(z) + 0.003, z), (bulge(z + 0.045) + 0.003, z + 0.045)]
            body.add(lathe([*edges, *((r - 0.006, h) for r, h in reversed(edges))]), hoop)
    body.collide("ends", oak, drum(end, 0.0, height))
    body.collide("shoulders", oak, drum(bulge(height * 0.2), height * 0.11, height * 0.89))
    body.collide("belly", oak, drum(bulge(height * 0.38), height * 0.3, height * 0.7))
    body.anchors = {"top": (0.0, 0.0, height)}
    return asset


def crate(edge: float = 0.4) -> Asset:
    """A closed, empty crate, nailed of boards."""
    light = Paint("wood", PINE, (0.62, 0.42, 0.22), 0.8)
    dark = Paint("wood_posts", PINE, (0.45, 0.28, 0.13), 0.8)
    asset = Asset(
        "crate",
        ["crate", "wooden crate", "packing crate", "slatted box", "packing case"],
        "container/crate",
        "A closed, empty crate of pine boards. It collides as a solid box.",
        "any side; all are alike",
    )
    body, board, width, post, count = asset.body(), 0.015, 0.08, 0.04, 4
    at, tall, wall = edge / 2 - board - post / 2, edge - 2 * board, edge / 2 - board / 2
    body.add(join(box((post, post, tall), (x * at, y * at, edge / 2)) for x in (-1, 1) for y in (-1, 1)), dark)
    for k in range(count):
        up = board + width / 2 + k * (tall - width) / (count - 1)
        across = -edge / 2 + width / 2 + k * (edge - width) / (count - 1)
        slats = [box((edge, board, width), (0.0, side * wall, up)) for side in (-1, 1)]
        slats += [box((board, tall, width), (side * wall, 0.0, up)) for side in (-1, 1)]
        slats += [box((edge, width, board), (0.0, across, z)) for z in (board / 2, edge - board / 2)]
        body.add(join(slats), light)
    body.collide("box", light, block((edge, edge, edge), (0.0, 0.0, edge / 2)))
    body.anchors = {"top": (0.0, 0.0, edge)}
    return asset
