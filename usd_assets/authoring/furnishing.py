"""Small things that furnish a room, and a door in its frame."""

from __future__ import annotations

from .asset import Asset
from .doors import leaf
from .forms import annulus, cylinder, disc
from .furniture import boards
from .matter import ABS, BRASS, CONCRETE, LINEN, PINE, STEEL, STONEWARE, Paint
from .parts import block, box, hull, join, lathe, tube
from .rounds import vessel


def clock(radius: float = 0.055) -> Asset:
    """An alarm clock with two bells; it shows ten past ten."""
    red = Paint("case", STEEL, (0.50, 0.04, 0.03), 0.3)
    dial = Paint("dial", ABS, (0.90, 0.89, 0.84), 0.5)
    black = Paint("hands", ABS, (0.02, 0.02, 0.02))
    brass = Paint("bells", BRASS, (0.72, 0.52, 0.18), 0.25, 0.8)
    asset = Asset(
        "clock",
        ["clock", "alarm clock", "table clock", "timepiece"],
        "furnishing/clock",
        "An alarm clock with two bells on top, on two feet.",
        "the dial",
    )
    body, thick, z = asset.body(), 0.05, radius + 0.014
    body.add(annulus(radius, radius - 0.006, thick, (0.0, 0.0, z), "X", 40), red, mass=0.1)
    body.add(disc(radius - 0.005, thick - 0.012, (-0.002, 0.0, z), "X", 40), dial, mass=0.16)
    face = thick / 2 - 0.008
    marks = [
        box((0.003, 0.0025 if k % 3 else 0.004, 0.007 if k % 3 else 0.01), (face, 0.0, radius - 0.014)).turned(
            "X", 30.0 * k
        )
        for k in range(12)
    ]
    hands = [
        box((0.002, 0.004, 0.024), (face + 0.001, 0.0, 0.011)).turned("X", 55.0),
        box((0.002, 0.003, 0.036), (face + 0.002, 0.0, 0.017)).turned("X", -60.0),
    ]
    body.add(
        join(mesh.moved(z=z) for mesh in [*marks, *hands, disc(0.004, 0.004, (face + 0.002, 0.0, 0.0), "X", 12)]),
        black,
        0.0,
    )
    for j in (-1, 1):
        bell = lathe([(0.0, 0.0), (0.021, 0.0), (0.019, 0.009), (0.012, 0.017), (0.0, 0.02)], 20)
        body.add(bell.moved(z=radius + 0.008).turned("X", j * 32.0).moved(z=z), brass, mass=0.035)
        body.add(
            tube([(0.0, 0.0, radius - 0.002), (0.0, 0.0, radius + 0.01)], 0.003, 8).turned("X", j * 32.0).moved(z=z),
            black,
            0.0,
        )
        foot = tube([(0.0, j * 0.032, 0.0215), (0.0, j * 0.042, 0.0)], 0.006, 10)
        body.add(type(foot)(foot.points.clip(min=(-9.0, -9.0, 0.0)), foot.faces), black, mass=0.01)
        body.add(box((0.036, 0.012, 0.006), (0.0, j * 0.041, 0.003)), black, mass=0.006)
        body.collide(f"foot_{'left' if j > 0 else 'right'}", black, block((0.036, 0.012, 0.02), (0.0, j * 0.041, 0.01)))
        body.collide(
            f"bell_{'left' if j > 0 else 'right'}",
            brass,
            hull(bell.moved(z=radius + 0.008).turned("X", j * 32.0).moved(z=z)),
        )
    body.add(cylinder(0.004, 0.022, (0.0, 0.0, z + radius), sides=10), black, 0.0)
    body.collide("case", red, hull(cylinder(radius, thick, (-thick / 2, 0.0, z), "X", 24)))
    body.anchors = {"dial": (face, 0.0, z)}
    return asset


def vase(height: float = 0.28) -> Asset:
    """A vase of stoneware with a narrow neck."""
    glaze = Paint("glaze", STONEWARE, (0.04, 0.24, 0.27), 0.25)
    band = Paint("bands", STONEWARE, (0.75, 0.62, 0.36), 0.3)
    asset = Asset(
        "vase",
        ["vase", "flower vase", "urn", "amphora", "jar"],
        "furnishing/vase",
        "A vase of stoneware with a wide belly and a narrow neck, open at the top.",
        "any side; it is round",
    )
    body, wall = asset.body(), 0.006
    curve = [
        (0.048, 0.0),
        (0.052, 0.006),
        (0.075, 0.06),
        (0.086, 0.11),
        (0.082, 0.15),
        (0.06, 0.195),
        (0.041, 0.225),
        (0.04, 0.245),
        (0.055, height),
    ]
    inside = [(0.042, 0.01), *((r - wall, z) for r, z in curve[2:])]
    vessel(asset, body, glaze, curve, inside, wall, count=12)
    for low, high, r0, r1 in ((0.098, 0.104, 0.0842, 0.0853), (0.118, 0.124, 0.0857, 0.0851)):
        body.add(lathe([(r0 - 0.002, low), (r0 + 0.0012, low), (r1 + 0.0012, high), (r1 - 0.002, high)], 40), band, 0.0)
    return asset


def rug(length: float = 2.0, width: float = 1.4, thick: float = 0.012) -> Asset:
    """A woven rug with borders and fringes; it is stiff, and lies along X."""
    red = Paint("wool", LINEN, (0.32, 0.035, 0.03), 0.95)
    sand = Paint("pattern", LINEN, (0.62, 0.48, 0.28), 0.95)
    navy = Paint("border", LINEN, (0.03, 0.05, 0.14), 0.95)
    asset = Asset(
        "rug",
        ["rug", "carpet", "mat", "floor mat", "doormat"],
        "furnishing/rug",
        "A patterned woollen rug with fringes. It does not bend.",
        "an end with fringes",
    )
    body, wool = asset.body(), 0.1
    body.add(box((length - wool, width, thick - 0.002), (0.0, 0.0, thick / 2 - 0.001)), red)

    def frame(inset: float, wide: float, up: float) -> list[object]:
        x, y = length / 2 - wool / 2 - inset, width / 2 - inset
        size = (2 * x, wide, up), (wide, 2 * y - 2 * wide, up)
        return [box(size[0], (0.0, j * (y - wide / 2), up / 2)) for j in (-1, 1)] + [
            box(size[1], (i * (x - wide / 2), 0.0, up / 2)) for i in (-1, 1)
        ]

    body.add(join([*frame(0.05, 0.1, thick - 0.001)]), navy, 0.0)
    diamonds = [box((w, w, thick), (x, 0.0, thick / 2)) for x, w in ((0.0, 0.0),)]
    diamonds = [cylinder(r, thick, (x, 0.0, 0.0), sides=4) for x, r in ((-0.5, 0.24), (0.0, 0.3), (0.5, 0.24))]
    fringe = [
        box((wool / 2, 0.012, 0.004), (i * (length / 2 - wool / 4), -width / 2 + 0.02 + 0.0343 * k, 0.002))
        for i in (-1, 1)
        for k in range(41)
    ]
    body.add(join([*frame(0.08, 0.015, thick), *frame(0.19, 0.02, thick), *diamonds, *fringe]), sand, 0.0)
    body.add(
        join(cylinder(r, thick + 0.0004, (x, 0.0, 0.0), sides=4) for x, r in ((-0.5, 0.12), (0.0, 0.15), (0.5, 0.12))),
        navy,
        0.0,
    )
    body.collide("rug", red, block((length, width, thick), (0.0, 0.0, thick / 2)))
    body.anchors = {"top": (0.0, 0.0, thick)}
    return asset


def door(width: float = 0.86, tall: float = 2.0) -> Asset:
    """A room door in its frame, on a piece of floor that keeps it upright; it opens towards +X."""
    white = Paint("leaf", PINE, (0.72, 0.71, 0.67))
    panel = Paint("panels", PINE, (0.55, 0.54, 0.50))
    frame = Paint("frame", PINE, (0.30, 0.15, 0.06))
    floor = Paint("floor", CONCRETE, (0.36, 0.35, 0.33), 0.9)
    metal = Paint("handles", BRASS, (0.70, 0.52, 0.20), 0.25, 0.8)
    asset = Asset(
        "door",
        ["door", "room door", "front door", "doorway", "door frame"],
        "building/door",
        "A door on hinges in a wooden frame, which stands on a slab.",
        "the side to which the door opens",
    )
    stand, slab_, post = asset.body("stand"), 0.06, 0.08
    boards(stand, floor, {"slab": ((1.3, width + 2 * post + 0.1, slab_), (0.0, 0.0, slab_ / 2))})
    outer = width / 2 + post / 2 + 0.004
    for j, side in ((-1, "right"), (1, "left")):
        boards(stand, frame, {f"post_{side}": ((0.12, post, tall + 0.01), (0.0, j * outer, slab_ + (tall + 0.01) / 2))})
    boards(
        stand, frame, {"lintel": ((0.12, width + 2 * post + 0.008, post), (0.0, 0.0, slab_ + tall + 0.01 + post / 2))}
    )
    low = slab_ + 0.006
    body = leaf(asset, "leaf", white, (0.04, width, tall - 0.008), (0.04, 0.0, low + (tall - 0.008) / 2), 1, mass=22.0)
    fields = [
        box((0.046, width / 2 - 0.16, h), (0.04, j * (width / 4 - 0.02), low + z))
        for j in (-1, 1)
        for h, z in ((0.62, 0.48), (0.75, 1.4))
    ]
    body.add(join(fields), panel, 0.0)
    y, z = -width / 2 + 0.07, low + 1.0
    for i in (-1, 1):
        x = 0.04 + i * 0.02
        body.add(tube([(x, y, z), (x + i * 0.05, y, z), (x + i * 0.05, y + 0.12, z)], 0.01, 10), metal, mass=0.3)
        body.add(box((0.006, 0.04, 0.2), (x + i * 0.002, y, z - 0.03)), metal, mass=0.15)
    body.anchors = {"handle": (0.11, y + 0.06, z)}
    stand.anchors = {"top": (0.0, 0.0, slab_ + tall + 0.01 + post), "threshold": (0.0, 0.0, slab_)}
    return asset
