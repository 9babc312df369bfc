"""What stands along a street."""

from __future__ import annotations

from .asset import Asset, Joint
from .forms import cone, cylinder, disc, upright, wheel
from .furniture import boards
from .matter import ABS, CAST_IRON, CONCRETE, HDPE, RUBBER, STEEL, Paint
from .parts import arc, block, box, drum, extrude, hull, join, lathe, prism, rod, tube
from .yard import tray

GALVANISED = Paint("steel", STEEL, (0.36, 0.37, 0.39), 0.4, 0.5)
FOOTING = Paint("footing", CONCRETE, (0.36, 0.35, 0.33), 0.9)


def traffic_cone(height: float = 0.5) -> Asset:
    """A cone of 50 cm with two white bands, on a square foot."""
    orange = Paint("cone", HDPE, (0.80, 0.17, 0.02), 0.5)
    white = Paint("bands", HDPE, (0.88, 0.88, 0.86), 0.4)
    black = Paint("foot", RUBBER, (0.025, 0.025, 0.025), 0.8)
    asset = Asset(
        "traffic_cone",
        ["traffic cone", "cone", "road cone", "pylon", "safety cone"],
        "street/cone",
        "An orange traffic cone with white bands on a square foot.",
        "any side",
    )
    body, foot, low, top = asset.body(), 0.028, 0.115, 0.03

    def at(z: float) -> float:
        return low + (top - low) * (z - foot) / (height - foot)

    boards(body, black, {"foot": ((0.3, 0.3, foot), (0.0, 0.0, foot / 2))}, 550.0)
    shell = [(low, foot), (top, height), (top - 0.004, height), (low - 0.004, foot)]
    body.add(lathe(shell, 36), orange, mass=0.55)
    for a, b in ((0.2, 0.29), (0.36, 0.43)):
        body.add(
            lathe([(at(a) - 0.002, a), (at(a) + 0.001, a), (at(b) + 0.001, b), (at(b) - 0.002, b)], 36), white, 0.0
        )
    body.collide("cone", orange, hull(cone(low, top, height - foot, (0.0, 0.0, foot), sides=20)))
    body.anchors = {"top": (0.0, 0.0, height)}
    return asset


def bollard(height: float = 1.0, radius: float = 0.08) -> Asset:
    """A cast-iron bollard with its footing plate."""
    iron = Paint("iron", CAST_IRON, (0.03, 0.035, 0.04), 0.45)
    white = Paint("bands", CAST_IRON, (0.80, 0.80, 0.78), 0.5)
    asset = Asset(
        "bollard",
        ["bollard", "street post", "parking post"],
        "street/bollard",
        "A cast-iron bollard with a white band, on its plate.",
        "any side; it is round",
    )
    body = asset.body()
    outline = [
        (0.0, 0.0),
        (0.18, 0.0),
        (0.18, 0.02),
        (0.115, 0.03),
        (0.11, 0.12),
        (radius, 0.16),
        (radius - 0.008, height - 0.17),
        (radius + 0.012, height - 0.16),
        (radius + 0.012, height - 0.14),
        (radius - 0.01, height - 0.13),
        (radius + 0.005, height - 0.08),
        (radius - 0.02, height - 0.02),
        (0.02, height),
        (0.0, height),
    ]
    body.add(lathe(outline, 24), iron, mass=38.0)
    z = height - 0.32
    body.add(
        lathe([(radius - 0.02, z), (radius - 0.003, z), (radius - 0.004, z + 0.1), (radius - 0.02, z + 0.1)], 24),
        white,
        0.0,
    )
    body.collide("plate", iron, drum(0.18, 0.0, 0.025))
    body.collide("foot", iron, drum(0.11, 0.02, 0.14))
    body.collide("post", iron, drum(radius, 0.1, height - 0.03))
    body.anchors = {"top": (0.0, 0.0, height)}
    return asset


def street_lamp(height: float = 5.0) -> Asset:
    """A street lamp with an arm over the road, on its concrete footing."""
    grey = Paint("mast", STEEL, (0.16, 0.18, 0.19), 0.45, 0.4)
    glow = Paint("lamp", ABS, (1.0, 0.93, 0.70), 0.2)
    asset = Asset(
        "street_lamp",
        ["street lamp", "street light", "streetlight", "lamp post", "lamppost"],
        "street/lamp",
        "A street lamp with an arm, on a concrete footing.",
        "the road: the arm reaches out to +X",
    )
    body, base, reach = asset.body(), 0.3, 1.1
    boards(body, FOOTING, {"footing": ((0.7, 0.7, base), (0.0, 0.0, base / 2))})
    body.add(cylinder(0.09, 0.9, (0.0, 0.0, base), sides=16), grey, 0.2 * STEEL.density)
    mast = [
        (0.0, 0.0, base),
        (0.0, 0.0, height - 0.6),
        *arc((0.6, 0.0, height - 0.65), 0.6, 180.0, 100.0, 7, "XZ"),
        (reach, 0.0, height - 0.02),
    ]
    body.add(tube(mast, 0.05, 12), grey, 0.2 * STEEL.density)
    head = prism(
        [
            [(reach + x * s, y * s, z) for x, y in ((0.35, -0.1), (0.35, 0.1), (-0.2, 0.14), (-0.2, -0.14))]
            for z, s in ((height - 0.09, 1.0), (height - 0.05, 1.0), (height, 0.6))
        ]
    )
    body.add(head, grey, mass=7.0)
    body.add(
        prism(
            [
                [(reach + x, y, z) for x, y in ((0.28, -0.08), (0.28, 0.08), (-0.12, 0.1), (-0.12, -0.1))]
                for z in (height - 0.105, height - 0.08)
            ]
        ),
        glow,
        0.0,
    )
    body.add(box((0.02, 0.1, 0.35), (0.083, 0.0, base + 0.5)), GALVANISED, 0.0)
    body.collide("mast", grey, drum(0.06, base, height - 0.5))
    body.collide("arm", grey, rod((0.05, 0.0, height - 0.4), (reach, 0.0, height - 0.05), 0.05))
    body.collide("head", grey, hull(head))
    body.anchors = {"light": (reach + 0.08, 0.0, height - 0.1)}
    return asset


def wheelie_bin(height: float = 1.05) -> Asset:
    """A bin of 240 l on two wheels, with a hinged lid."""
    green = Paint("bin", HDPE, (0.03, 0.14, 0.06), 0.5)
    lidded = Paint("lid_plastic", HDPE, (0.02, 0.09, 0.04), 0.5)
    black = Paint("wheels", RUBBER, (0.02, 0.02, 0.02), 0.8)
    asset = Asset(
        "wheelie_bin",
        [
            "wheelie bin",
            "bin",
            "trash bin",
            "garbage bin",
            "dustbin",
            "trash can",
            "garbage can",
            "rubbish bin",
            "refuse bin",
        ],
        "street/bin",
        "A plastic refuse bin with a hinged lid and two wheels.",
        "the front, away from the wheels and the handle",
    )
    base, wall, floor, top = asset.body("stand"), 0.012, 0.07, height - 0.05
    low, high, x = (0.44, 0.44), (0.6, 0.56), 0.0
    walls = tray(low, high, floor, top, x, wall)
    base.add(join(walls), green, mass=9.0)
    base.add(box((low[0], low[1], 0.015), (0.0, 0.0, floor - 0.0075)), green, mass=1.5)
    base.collide("wall", green, *(hull(each) for each in walls))
    base.collide("floor", green, block((low[0], low[1], 0.015), (0.0, 0.0, floor - 0.0075)))
    base.add(box((0.06, 0.36, floor - 0.01), (0.17, 0.0, (floor - 0.01) / 2)), green, mass=0.5)
    base.collide("foot", green, block((0.06, 0.36, floor - 0.01), (0.17, 0.0, (floor - 0.01) / 2)))
    for j, side in ((-1, "right"), (1, "left")):
        base.add(disc(0.1, 0.05, (-0.22, j * 0.25, 0.1)), black, mass=0.7)
        base.add(disc(0.04, 0.054, (-0.22, j * 0.25, 0.1), sides=16), lidded, 0.0)
        base.collide(f"wheel_{side}", black, wheel(0.1, 0.05, (-0.22, j * 0.25, 0.1)))
    handle = [(-0.3, -0.2, top - 0.02), (-0.36, -0.2, top - 0.01), (-0.36, 0.2, top - 0.01), (-0.3, 0.2, top - 0.02)]
    base.add(tube(handle, 0.016, 10), green, mass=0.4)
    at = (-0.31, 0.0, top + 0.01)
    lid = asset.body("lid", at)
    outline = [
        (-0.31, top + 0.002),
        (0.32, top + 0.002),
        (0.32, top + 0.02),
        (0.15, top + 0.05),
        (-0.2, top + 0.05),
        (-0.31, top + 0.02),
    ]
    lid.add(extrude(outline, 0.58), lidded, mass=1.6)
    lid.collide("lid", lidded, hull(extrude(outline, 0.58)))
    asset.joints = [Joint("lid_hinge", "stand", "lid", at, "Y", (-240.0, 0.0), 0.05)]
    base.anchors = {"inside": (0.0, 0.0, floor)}
    lid.anchors = {"top": (0.0, 0.0, top + 0.05)}
    free = top - floor - 0.005
    asset.hollow = ((low[0] - 2 * wall - 0.01, low[1] - 2 * wall - 0.01, free), (0.0, 0.0, floor + free / 2))
    return asset


def kerb_stone(length: float = 1.0) -> Asset:
    """A kerb of concrete, 1 m long, that lies along Y."""
    grey = Paint("concrete", CONCRETE, (0.38, 0.37, 0.35), 0.9)
    asset = Asset(
        "kerb_stone",
        ["kerb stone", "kerbstone", "kerb", "curb", "curbstone"],
        "street/kerb",
        "A kerb stone of concrete with its edge bevelled.",
        "the road: the bevelled edge",
    )
    body, wide, tall = asset.body(), 0.15, 0.25
    shape = extrude(
        [(-wide / 2, 0.0), (wide / 2, 0.0), (wide / 2, tall - 0.07), (wide / 2 - 0.03, tall), (-wide / 2, tall)], length
    )
    body.add(shape, grey)
    seams = [box((0.002, 0.004, tall * 0.7), (wide / 2, j * (length / 2 - 0.004), tall * 0.36)) for j in (-1, 1)]
    body.add(join(seams), Paint("edges", CONCRETE, (0.25, 0.24, 0.23), 0.9), 0.0)
    body.collide("kerb", grey, hull(shape))
    body.anchors = {"top": (-0.015, 0.0, tall)}
    return asset


def road_barrier(width: float = 2.0, height: float = 1.0) -> Asset:
    """A works barrier: a board in red and white on two feet, with lamps."""
    red = Paint("red", HDPE, (0.65, 0.03, 0.02), 0.5)
    white = Paint("white", HDPE, (0.86, 0.86, 0.84), 0.5)
    feet = Paint("feet", RUBBER, (0.03, 0.03, 0.03), 0.9)
    amber = Paint("lamps", ABS, (0.95, 0.45, 0.02), 0.2)
    asset = Asset(
        "road_barrier",
        ["road barrier", "barrier", "traffic barrier", "barricade", "construction barrier"],
        "street/barrier",
        "A road barrier with red and white stripes on two feet, with warning lamps.",
        "the traffic",
    )
    body, count = asset.body(), 7
    for z in (height - 0.125, 0.5):
        wide = width / count
        for k in range(count):
            y0, slant = -width / 2 + k * wide, 0.06
            a, b = (y0 - slant, y0 + wide - slant), (y0 + slant, y0 + wide + slant)
            low = [max(-width / 2, a[0]) if k else -width / 2, a[1] if k < count - 1 else width / 2]
            high = [b[0] if k else -width / 2, min(width / 2, b[1]) if k < count - 1 else width / 2]
            outline = [(low[0], z - 0.1), (low[1], z - 0.1), (high[1], z + 0.1), (high[0], z + 0.1)]
            body.add(upright(outline, 0.03), white if k % 2 else red, 500.0)
    body.collide("board", red, block((0.03, width, 0.2), (0.0, 0.0, height - 0.125)))
    body.collide("lower_board", red, block((0.03, width, 0.2), (0.0, 0.0, 0.5)))
    for j, side in ((-1, "right"), (1, "left")):
        y = j * (width / 2 - 0.25)
        boards(
            body,
            GALVANISED,
            {f"post_{side}": ((0.04, 0.04, height - 0.06), (-0.035, y, 0.05 + (height - 0.06) / 2))},
            1200.0,
        )
        boards(body, feet, {f"foot_{side}": ((0.7, 0.24, 0.1), (-0.02, y, 0.05))})
        body.add(cylinder(0.08, 0.07, (-0.07, y, height + 0.08), "X", 20), amber, mass=0.3)
        body.add(box((0.07, 0.06, 0.06), (-0.035, y, height)), GALVANISED, mass=0.1)
    body.anchors = {"board": (0.015, 0.0, height - 0.125)}
    return asset


def bicycle_stand(width: float = 1.5) -> Asset:
    """A rack for five bicycles: hoops on two rails."""
    asset = Asset(
        "bicycle_stand",
        ["bicycle stand", "bike rack", "bicycle rack", "bike stand", "cycle stand"],
        "street/rack",
        "A bicycle stand: five pairs of hoops on two rails.",
        "where the bicycles come from",
    )
    body, pipe = asset.body(), 0.016
    for i, end in ((-1, "back"), (1, "front")):
        boards(body, GALVANISED, {f"rail_{end}": ((0.05, width, 0.03), (i * 0.22, 0.0, 0.015))}, 0.4 * STEEL.density)
    for k in range(5):
        for side in (-1, 1):
            y = (k - 2) * 0.31 + side * 0.035
            hoop = [(-0.22, y, 0.02), (-0.22, y, 0.3), *arc((0.0, y, 0.3), 0.22, 170.0, 10.0, 7, "XZ"), (0.22, y, 0.02)]
            body.add(tube(hoop, pipe / 2, 8), GALVANISED)
            name = f"{k}_{'left' if side > 0 else 'right'}"
            body.collide(
                f"hoop_{name}",
                GALVANISED,
                *(rod(hoop[a], hoop[b], pipe / 2) for a, b in ((0, 1), (1, 5), (5, 8), (8, 9))),
            )
    body.anchors = {"front": (0.22, 0.0, 0.03)}
    return asset
