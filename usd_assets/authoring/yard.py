"""What stands about in a yard: ladders, a barrow, drums, cans and boxes."""

from __future__ import annotations

from .asset import Asset, Joint
from .forms import annulus, cylinder, disc, wheel
from .furniture import boards
from .matter import ALUMINIUM, CARDBOARD, PAPER, PINE, RUBBER, STEEL, Paint
from .parts import Mesh, block, box, drum, extrude, hull, join, lathe, prism, rod, tube


def step_ladder(height: float = 1.2) -> Asset:
    """A folding ladder with a platform, opened."""
    alloy = Paint("alloy", ALUMINIUM, (0.50, 0.51, 0.53), 0.4, 0.5)
    red = Paint("platform", ALUMINIUM, (0.55, 0.05, 0.03), 0.5)
    feet = Paint("feet", RUBBER, (0.02, 0.02, 0.02))
    asset = Asset(
        "step_ladder",
        ["step ladder", "stepladder", "ladder", "folding ladder", "steps"],
        "tool/ladder",
        "An opened step ladder with four steps and a platform.",
        "where one climbs",
    )
    body, deep, half = asset.body(), 0.38, 0.24
    for j, side in ((-1, "right"), (1, "left")):
        for i, end, narrow in ((1, "front", 0.0), (-1, "back", 0.03)):
            low, high = (i * deep, j * (half - narrow), 0.012), (i * 0.09, j * (half - 0.05 - narrow), height)
            body.add(_bar(low, high, 0.05, 0.022), alloy, 0.4 * ALUMINIUM.density)
            body.add(box((0.07, 0.034, 0.03), (i * deep, low[1], 0.015)), feet)
            body.collide(f"foot_{end}_{side}", feet, block((0.06, 0.034, 0.03), (i * deep, low[1], 0.015)))
            body.collide(f"leg_{end}_{side}", alloy, hull(_bar(low, high, 0.05, 0.022)))
    for k in range(1, 5):
        share = k / 4.7
        x, y = deep + (0.09 - deep) * share, half - 0.05 * share - 0.011
        z = height * share
        boards(body, alloy, {f"step_{k}": ((0.09, 2 * y, 0.022), (x - 0.01, 0.0, z))}, 0.5 * ALUMINIUM.density)
        body.anchors[f"step_{k}"] = (x - 0.01, 0.0, z + 0.011)
    for share in (0.3, 0.65):
        x = -deep + (deep - 0.09) * share
        body.add(box((0.02, 2 * (half - 0.03 - 0.05 * share), 0.03), (x, 0.0, height * share)), alloy, 0.4 * 2700.0)
    boards(body, red, {"platform": ((0.27, 2 * half - 0.08, 0.03), (0.0, 0.0, height + 0.01))}, 0.5 * ALUMINIUM.density)
    hoop = [
        (-0.1, -half + 0.09, height),
        (-0.12, -half + 0.09, height + 0.5),
        (-0.12, half - 0.09, height + 0.5),
        (-0.1, half - 0.09, height),
    ]
    body.add(tube(hoop, 0.014, 10), alloy, 0.3 * ALUMINIUM.density)
    body.collide("hoop", alloy, rod((-0.12, -half + 0.08, height + 0.5), (-0.12, half - 0.08, height + 0.5), 0.014))
    body.anchors["top"] = (0.0, 0.0, height + 0.025)
    return asset


def _bar(low: tuple[float, float, float], high: tuple[float, float, float], deep: float, wide: float) -> Mesh:
    """A flat bar between two points, level at both ends."""
    rings = [
        [(x + i * deep / 2, y + j * wide / 2, z) for i, j in ((1, -1), (1, 1), (-1, 1), (-1, -1))]
        for x, y, z in (low, high)
    ]
    return prism(rings)


def sawhorse(width: float = 1.0, height: float = 0.75) -> Asset:
    """A trestle of wood: a beam on four splayed legs."""
    wood = Paint("beam", PINE, (0.56, 0.37, 0.18))
    leg = Paint("legs", PINE, (0.44, 0.27, 0.12))
    asset = Asset(
        "sawhorse",
        ["sawhorse", "saw horse", "trestle", "sawbuck"],
        "tool/sawhorse",
        "A wooden sawhorse: a beam on four splayed legs.",
        "a long side",
    )
    body, beam = asset.body(), 0.09
    boards(body, wood, {"beam": ((0.07, width, beam), (0.0, 0.0, height - beam / 2))})
    for j, side in ((-1, "right"), (1, "left")):
        y = j * (width / 2 - 0.12)
        for i, end in ((-1, "back"), (1, "front")):
            bar = _bar((i * 0.27, y + j * 0.06, 0.0), (i * 0.045, y, height - 0.02), 0.04, 0.09)
            body.add(bar, leg)
            body.collide(f"leg_{end}_{side}", leg, hull(bar))
        body.add(box((0.36, 0.022, 0.08), (0.0, y + j * 0.04, 0.3)), wood)
    body.anchors = {"top": (0.0, 0.0, height)}
    return asset


def wheelbarrow() -> Asset:
    """A barrow: a tray on two legs and a wheel that turns."""
    green = Paint("tray", STEEL, (0.03, 0.22, 0.08), 0.4)
    steel = Paint("frame", STEEL, (0.30, 0.31, 0.33), 0.4, 0.6)
    grips = Paint("grips", RUBBER, (0.02, 0.02, 0.02))
    tyre = Paint("tyre", RUBBER, (0.025, 0.025, 0.025), 0.9)
    hub = Paint("hub", STEEL, (0.55, 0.08, 0.03), 0.4)
    asset = Asset(
        "wheelbarrow",
        ["wheelbarrow", "wheel barrow", "barrow", "garden cart"],
        "tool/wheelbarrow",
        "A wheelbarrow with a steel tray, two legs and a wheel that turns.",
        "the wheel; the handles are at -X",
    )
    base, radius, at = asset.body("stand"), 0.18, 0.56
    floor, top = 0.3, 0.55
    low, high = (0.5, 0.4), (0.86, 0.66)
    rings = [
        [(x * a / 2 + dx, y * b / 2, z) for x, y in ((1, -1), (1, 1), (-1, 1), (-1, -1))]
        for z, a, b, dx in ((floor, *low, 0.06), (floor + 0.02, *low, 0.06))
    ]
    base.add(prism(rings), green, mass=2.6)
    base.collide("floor", green, hull(prism(rings)))
    sides = tray(low, high, floor, top, 0.06, 0.012)
    base.add(join(sides), green, mass=6.5)
    base.collide("side", green, *(hull(side) for side in sides))
    for j, side in ((-1, "right"), (1, "left")):
        pole = [
            (at, j * 0.06, radius),
            (0.2, j * 0.17, floor - 0.02),
            (-0.25, j * 0.24, floor - 0.02),
            (-0.85, j * 0.29, 0.52),
        ]
        base.add(tube(pole, 0.016, 10), steel, 0.4 * STEEL.density)
        base.add(tube([(-0.74, j * 0.281, 0.4760), (-0.87, j * 0.292, 0.528)], 0.02, 10), grips, mass=0.1)
        leg = [
            (-0.1, j * 0.22, floor - 0.02),
            (-0.22, j * 0.25, 0.014),
            (-0.38, j * 0.25, 0.014),
            (-0.42, j * 0.25, floor + 0.02),
        ]
        base.add(tube(leg, 0.014, 10), steel, 0.5 * STEEL.density)
        base.collide(f"handle_{side}", grips, rod(pole[2], (-0.87, j * 0.292, 0.528), 0.016))
        base.collide(f"foot_{side}", steel, block((0.16, 0.028, 0.028), (-0.3, j * 0.25, 0.014)))
        base.collide(f"leg_{side}", steel, rod((-0.22, j * 0.25, 0.02), (-0.1, j * 0.22, floor - 0.01), 0.014))
        base.anchors[f"handle_{side}"] = (-0.8, j * 0.286, 0.5)
    rim = asset.body("wheel", (at, 0.0, radius))
    rim.add(
        lathe([(0.10, -0.03), (0.15, -0.04), (radius, -0.018), (radius, 0.018), (0.15, 0.04), (0.10, 0.03)], 36)
        .turned("X", -90.0)
        .moved(at, 0.0, radius),
        tyre,
        mass=1.4,
    )
    rim.add(disc(0.101, 0.03, (at, 0.0, radius)), hub, mass=1.1)
    rim.add(disc(0.02, 0.12, (at, 0.0, radius), sides=16), steel, mass=0.3)
    rim.collide("tyre", tyre, wheel(radius, 0.036, (at, 0.0, radius)))
    asset.joints = [Joint("axle", "stand", "wheel", (at, 0.0, radius), "Y", None, 0.05)]
    base.anchors["inside"] = (0.06, 0.0, floor + 0.02)
    base.anchors["top"] = (0.06, 0.0, top)
    free = top - floor - 0.022
    asset.hollow = ((low[0] - 0.03, low[1] - 0.03, free), (0.06, 0.0, floor + 0.02 + free / 2))
    return asset


def tray(
    low: tuple[float, float], high: tuple[float, float], z0: float, z1: float, x: float, wall: float
) -> list[Mesh]:
    """The four slanted walls of a tray."""
    corners = [(1, -1), (1, 1), (-1, 1), (-1, -1)]
    walls = []
    for k in range(4):
        pair = corners[k], corners[(k + 1) % 4]
        rings = []
        for (a, b), z in ((low, z0), (high, z1)):
            outer = [(x + i * a / 2, j * b / 2, z) for i, j in pair]
            inner = [(x + i * (a / 2 - wall), j * (b / 2 - wall), z) for i, j in reversed(pair)]
            rings.append([*outer, *inner])
        walls.append(prism(rings))
    return walls


def shelf_rack(width: float = 1.2, depth: float = 0.5, height: float = 1.8) -> Asset:
    """A steel rack for a store, with four boards."""
    blue = Paint("posts", STEEL, (0.03, 0.10, 0.32), 0.4)
    orange = Paint("beams", STEEL, (0.70, 0.22, 0.02), 0.4)
    wood = Paint("boards", PINE, (0.56, 0.40, 0.22))
    asset = Asset(
        "shelf_rack",
        ["shelf rack", "storage rack", "steel rack", "warehouse shelf", "shelving unit"],
        "furniture/rack",
        "A steel rack with four boards, open on all sides.",
        "a long side",
    )
    body, post, levels = asset.body(), 0.045, (0.1, 0.62, 1.14, 1.66)
    x, y = depth / 2 - post / 2, width / 2 - post / 2
    for i, end in ((-1, "back"), (1, "front")):
        for j, side in ((-1, "right"), (1, "left")):
            boards(
                body, blue, {f"post_{end}_{side}": ((post, post, height), (i * x, j * y, height / 2))}, 0.16 * 7850.0
            )
    for k, z in enumerate(levels, start=1):
        boards(body, wood, {f"board_{k}": ((depth - 0.03, width - 2 * post - 0.004, 0.018), (0.0, 0.0, z + 0.009))})
        beams = [box((0.03, 2 * y - post, 0.06), (i * (x + 0.002), 0.0, z - 0.022)) for i in (-1, 1)]
        body.add(join(beams), orange, 0.16 * 7850.0)
        body.collide(f"beam_{k}", orange, *(block((0.03, 2 * y - post, 0.06), (i * x, 0.0, z - 0.03)) for i in (-1, 1)))
        body.anchors[f"shelf_{k}"] = (0.0, 0.0, z + 0.018)
    for j in (-1, 1):
        ways = [((-x, z), (x, z + 0.5)) for z in (0.1, 1.1)] + [((x, 0.6), (-x, 1.1))]
        body.add(join(tube([(a[0], j * y, a[1]), (b[0], j * y, b[1])], 0.008, 6) for a, b in ways), blue, 2000.0)
    free = levels[1] - levels[0] - 0.018 - 0.062
    asset.hollow = ((depth - 0.1, width - 2 * post - 0.01, free), (0.0, 0.0, levels[0] + 0.018 + free / 2))
    return asset


def oil_drum(height: float = 0.88, radius: float = 0.29) -> Asset:
    """An empty steel drum of 200 l."""
    blue = Paint("steel", STEEL, (0.02, 0.10, 0.30), 0.4)
    dark = Paint("bungs", STEEL, (0.05, 0.05, 0.055), 0.4, 0.6)
    white = Paint("band", STEEL, (0.75, 0.74, 0.70), 0.5)
    asset = Asset(
        "oil_drum",
        ["oil drum", "oil barrel", "drum", "metal drum", "fuel drum"],
        "container/drum",
        "A closed, empty steel drum of 200 litres.",
        "any side; it is round",
    )
    body, r = asset.body(), radius - 0.008
    third = height / 3
    outline = [
        (0.0, 0.012),
        (r - 0.01, 0.012),
        (r - 0.01, 0.0),
        (r, 0.0),
        (r, third - 0.02),
        (radius, third),
        (r, third + 0.02),
        (r, 2 * third - 0.02),
        (radius, 2 * third),
        (r, 2 * third + 0.02),
        (r, height),
        (r - 0.01, height),
        (r - 0.01, height - 0.012),
        (0.0, height - 0.012),
    ]
    body.add(lathe(outline, 40), blue, mass=18.5)
    body.add(
        lathe(
            [
                (r - 0.002, third + 0.05),
                (r + 0.001, third + 0.05),
                (r + 0.001, 2 * third - 0.05),
                (r - 0.002, 2 * third - 0.05),
            ],
            40,
        ),
        white,
        0.0,
    )
    body.add(
        join(cylinder(0.03 - 0.01 * k, 0.012, (0.2 - 0.4 * k, 0.0, height - 0.014), sides=16) for k in range(2)),
        dark,
        0.0,
    )
    body.collide("drum", blue, drum(r, 0.0, height))
    body.anchors = {"top": (0.0, 0.0, height)}
    return asset


def jerry_can(height: float = 0.47) -> Asset:
    """A full jerry can of 20 l: three handles, a spout under a lid."""
    green = Paint("can", STEEL, (0.07, 0.10, 0.035), 0.5)
    dark = Paint("cap", STEEL, (0.04, 0.05, 0.02), 0.4)
    asset = Asset(
        "jerry_can",
        ["jerry can", "jerrycan", "petrol can", "fuel can", "gas can", "canister"],
        "container/can",
        "A full fuel can of 20 litres with three handles.",
        "a flat side",
    )
    body, long, thick, high = asset.body(), 0.345, 0.165, 0.43
    outline = [
        (-long / 2, 0.015),
        (-long / 2 + 0.015, 0.0),
        (long / 2 - 0.015, 0.0),
        (long / 2, 0.015),
        (long / 2, high - 0.07),
        (long / 2 - 0.07, high),
        (-long / 2 + 0.03, high),
        (-long / 2, high - 0.03),
    ]
    can = extrude(outline, thick).turned("Z", 90.0)
    body.add(can, green, mass=19.0)
    for i in (-1, 1):
        lines = [((-0.12, 0.06), (0.12, 0.34)), ((0.12, 0.06), (-0.12, 0.34))]
        body.add(
            join(tube([(i * thick / 2, a[0], a[1]), (i * thick / 2, b[0], b[1])], 0.008, 6) for a, b in lines),
            dark,
            0.0,
        )
    for x in (-0.05, 0.0, 0.05):
        bar = [(x, -0.11, high - 0.01), (x, -0.1, high + 0.032), (x, 0.05, high + 0.032), (x, 0.06, high - 0.01)]
        body.add(tube(bar, 0.008, 8), green, mass=0.15)
    neck = cylinder(0.032, 0.07, (0.0, 0.0, 0.0), sides=20).turned("X", -40.0).moved(0.0, long / 2 - 0.07, high - 0.04)
    body.add(neck, dark, mass=0.5)
    body.collide("can", green, hull(can))
    body.collide("handle", green, block((0.116, 0.16, 0.016), (0.0, -0.025, high + 0.032)))
    body.anchors = {"handle": (0.0, -0.025, high + 0.04), "spout": (0.0, long / 2 - 0.03, high + 0.005)}
    return asset


def gas_bottle(height: float = 0.58, radius: float = 0.15) -> Asset:
    """A full propane bottle of 11 kg."""
    red = Paint("steel", STEEL, (0.55, 0.05, 0.03), 0.4)
    grey = Paint("collar", STEEL, (0.35, 0.36, 0.37), 0.4, 0.3)
    brass = Paint("valve", STEEL, (0.65, 0.48, 0.16), 0.3, 0.8)
    asset = Asset(
        "gas_bottle",
        ["gas bottle", "gas cylinder", "propane tank", "propane bottle", "gas canister"],
        "container/cylinder",
        "A full propane bottle of 11 kg with a collar around its valve.",
        "any side; it is round",
    )
    body, low, high = asset.body(), 0.05, 0.46
    shell = [
        (0.0, low),
        (0.09, low),
        (radius - 0.02, low + 0.025),
        (radius, low + 0.07),
        (radius, high - 0.07),
        (radius - 0.02, high - 0.025),
        (0.08, high),
        (0.0, high + 0.005),
    ]
    body.add(lathe(shell, 36), red, mass=20.0)
    body.add(annulus(0.115, 0.109, low + 0.02, (0.0, 0.0, (low + 0.02) / 2)), red, mass=1.0)
    body.add(cylinder(0.02, 0.06, (0.0, 0.0, high), sides=16), brass, mass=0.4)
    body.add(cylinder(0.03, 0.015, (0.0, 0.0, high + 0.06), sides=8), brass, mass=0.1)
    collar = lathe([(0.098, high - 0.025), (0.104, high - 0.025), (0.104, height), (0.098, height)], 36)
    body.add(collar, grey, mass=1.0)
    for k in range(4):
        body.add(box((0.012, 0.05, 0.03), (0.105, 0.0, height - 0.045)).turned("Z", 90.0 * k + 45.0), brass, 0.0)
    body.collide("ring", red, drum(0.115, 0.0, low + 0.03))
    body.collide("bottle", red, drum(radius, low + 0.05, high - 0.04))
    body.collide("collar", grey, drum(0.104, high - 0.04, height))
    body.anchors = {"top": (0.0, 0.0, height), "valve": (0.0, 0.0, high + 0.07)}
    return asset


def cardboard_box(length: float = 0.4, width: float = 0.3, height: float = 0.3) -> Asset:
    """A closed removal box, filled to 6 kg."""
    card = Paint("cardboard", CARDBOARD, (0.42, 0.26, 0.12), 0.9)
    tape = Paint("tape", PAPER, (0.62, 0.48, 0.28), 0.4)
    ink = Paint("print", PAPER, (0.05, 0.04, 0.03), 0.9)
    asset = Asset(
        "cardboard_box",
        ["cardboard box", "carton", "parcel", "package", "moving box"],
        "container/box",
        "A closed cardboard box with tape over its flaps, filled to 6 kg.",
        "a short side",
    )
    body = asset.body()
    body.add(box((length, width, height - 0.001), (0.0, 0.0, (height - 0.001) / 2)), card, mass=6.0)
    body.add(box((length + 0.001, 0.05, 0.01), (0.0, 0.0, height - 0.005)), tape, 0.0)
    body.add(join(box((0.001, 0.05, 0.07), (i * (length / 2), 0.0, height - 0.035)) for i in (-1, 1)), tape, 0.0)
    arrows = [box((0.002, 0.008, 0.05), (length / 2, 0.07 + dy, 0.08)) for dy in (0.0, 0.03)]
    arrows += [
        prism(
            [
                [(length / 2 + dx, 0.07 + dy + y, 0.105 + z) for y, z in ((-0.012, 0.0), (0.012, 0.0), (0.0, 0.016))]
                for dx in (-0.001, 0.001)
            ]
        )
        for dy in (0.0, 0.03)
    ]
    arrows += [
        box((0.002, 0.05, 0.004), (length / 2, 0.085, 0.05)),
        box((length, 0.002, 0.003), (0.0, -0.0255, height - 0.0014)),
    ]
    arrows += [
        box((0.18 - 0.04 * k, 0.002, 0.014), (0.0, side * width / 2, 0.17 - 0.03 * k))
        for k in range(3)
        for side in (-1, 1)
    ]
    body.add(join(arrows), ink, 0.0)
    body.collide("box", card, block((length, width, height), (0.0, 0.0, height / 2)))
    body.anchors = {"top": (0.0, 0.0, height)}
    return asset
