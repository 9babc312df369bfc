"""What stands on a post beside a street, and a gate between two."""

from __future__ import annotations

import math

from .asset import Asset
from .doors import leaf
from .forms import circle, cylinder, upright
from .furniture import boards
from .matter import CAST_IRON, PAPER, PINE, RUBBER, STEEL, Paint
from .parts import Mesh, arc, block, box, drum, hull, join, lathe, prism
from .street import FOOTING, GALVANISED


def traffic_sign(height: float = 2.2) -> Asset:
    """A stop sign on a post with a rubber foot."""
    red = Paint("red", STEEL, (0.58, 0.02, 0.02), 0.4)
    white = Paint("white", STEEL, (0.88, 0.88, 0.86), 0.4)
    foot = Paint("foot", RUBBER, (0.03, 0.03, 0.03), 0.9)
    asset = Asset(
        "traffic_sign",
        ["traffic sign", "stop sign", "road sign", "street sign"],
        "street/sign",
        "A stop sign on a post that stands in a heavy foot.",
        "the face of the sign",
    )
    body, radius = asset.body(), 0.325
    boards(body, foot, {"foot": ((0.8, 0.5, 0.14), (0.0, 0.0, 0.07))})
    body.add(cylinder(0.03, height - 0.25, (0.0, 0.0, 0.14), sides=16), GALVANISED, 0.25 * STEEL.density)
    middle = height - radius * math.cos(math.radians(22.5))
    for r, x, paint in ((radius, 0.033, white), (radius - 0.02, 0.0345, red)):
        body.add(
            upright(circle(r, 8, 22.5, (0.0, middle)), 0.004).moved(x=x),
            paint,
            0.5 * STEEL.density if paint is white else 0.0,
        )
    body.add(_letters("STOP", 0.17).moved(0.037, 0.0, middle), white, 0.0)
    body.collide("post", GALVANISED, drum(0.03, 0.14, height - 0.3))
    body.collide("sign", red, hull(upright(circle(radius, 8, 22.5, (0.0, middle)), 0.006).moved(x=0.034)))
    body.anchors = {"sign": (0.037, 0.0, middle)}
    return asset


# Strokes of letters on a grid of 2 by 4: from (y, z) to (y, z).
STROKES = {
    "S": [((2, 4), (0, 4)), ((0, 4), (0, 2)), ((0, 2), (2, 2)), ((2, 2), (2, 0)), ((2, 0), (0, 0))],
    "T": [((0, 4), (2, 4)), ((1, 4), (1, 0))],
    "O": [((0, 0), (0, 4)), ((0, 4), (2, 4)), ((2, 4), (2, 0)), ((2, 0), (0, 0))],
    "P": [((0, 0), (0, 4)), ((0, 4), (2, 4)), ((2, 4), (2, 2)), ((2, 2), (0, 2))],
    "M": [((0, 0), (0, 4)), ((0, 4), (1, 2)), ((1, 2), (2, 4)), ((2, 4), (2, 0))],
    "A": [((0, 0), (0, 4)), ((0, 4), (2, 4)), ((2, 4), (2, 0)), ((0, 2), (2, 2))],
    "I": [((1, 0), (1, 4))],
    "L": [((0, 4), (0, 0)), ((0, 0), (2, 0))],
}


def _letters(word: str, tall: float) -> Mesh:
    """A word in strokes, read from +X, about the origin."""
    unit, thick = tall / 4, tall / 7
    bars = []
    for k, letter in enumerate(word):
        left = (k - (len(word) - 1) / 2) * 3.0 * unit - unit
        for (y0, z0), (y1, z1) in STROKES[letter]:
            a = (0.0, left + y0 * unit, z0 * unit - tall / 2)
            b = (0.0, left + y1 * unit, z1 * unit - tall / 2)
            turn = math.degrees(math.atan2(b[2] - a[2], b[1] - a[1]))
            length = math.hypot(b[1] - a[1], b[2] - a[2]) + thick
            bar = box((0.004, length, thick)).turned("X", turn)
            bars.append(bar.moved(0.0, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2))
    return join(bars)


def mailbox(height: float = 1.15) -> Asset:
    """A letter box with a rounded roof on a post, with its flag and a door on a hinge."""
    blue = Paint("box", STEEL, (0.03, 0.09, 0.34), 0.4)
    red = Paint("flag", STEEL, (0.65, 0.03, 0.02), 0.4)
    white = Paint("letters", PAPER, (0.88, 0.88, 0.85), 0.6)
    wood = Paint("post", PINE, (0.42, 0.25, 0.11), 0.9)
    asset = Asset(
        "mailbox",
        ["mailbox", "letter box", "letterbox", "postbox", "post box", "mail box"],
        "street/mailbox",
        "A mailbox with a flag on a wooden post.",
        "the door",
    )
    body, wide, long, straight = asset.body(), 0.18, 0.48, 0.12
    low = height - straight - wide / 2
    section = [
        (-wide / 2, low),
        (wide / 2, low),
        *[(y, z) for _, y, z in arc((0.0, 0.0, low + straight), wide / 2, 0.0, 180.0, 13)],
    ]
    shell = upright(section, long - 0.02)
    body.add(shell, blue, mass=2.6)
    door = upright([(1.04 * y, low + 1.03 * (z - low)) for y, z in section], 0.02).moved(x=long / 2)
    body.add(door, blue, mass=0.4)
    body.add(box((0.03, 0.05, 0.02), (long / 2 + 0.02, 0.0, height - 0.06)), GALVANISED, 0.0)
    body.add(box((0.02, 0.006, 0.17), (0.05, wide / 2 + 0.004, low + 0.15)), red, mass=0.03)
    body.add(box((0.1, 0.006, 0.06), (0.09, wide / 2 + 0.004, low + 0.21)), red, mass=0.03)
    body.add(_letters("MAIL", 0.06).turned("Z", -90.0).moved(0.0, -wide / 2, low + 0.08), white, 0.0)
    body.add(_letters("MAIL", 0.04).moved(long / 2 + 0.01, 0.0, low + 0.08), white, 0.0)
    boards(body, wood, {"post": ((0.09, 0.09, low), (0.0, 0.0, low / 2))})
    boards(body, wood, {"shelf": ((0.44, 0.15, 0.025), (0.0, 0.0, low - 0.0125))})
    boards(body, FOOTING, {"footing": ((0.4, 0.4, 0.12), (0.0, 0.0, 0.06))})
    body.collide("box", blue, hull(upright(section, long)))
    body.anchors = {"top": (0.0, 0.0, height), "door": (long / 2, 0.0, low + 0.1)}
    return asset


def hydrant(height: float = 0.8) -> Asset:
    """A fire hydrant of cast iron with two side outlets and one in front."""
    red = Paint("iron", CAST_IRON, (0.58, 0.04, 0.02), 0.4)
    cap = Paint("caps", CAST_IRON, (0.72, 0.62, 0.10), 0.4)
    asset = Asset(
        "hydrant",
        ["hydrant", "fire hydrant", "fireplug"],
        "street/hydrant",
        "A fire hydrant with three capped outlets.",
        "the large outlet",
    )
    body, r = asset.body(), 0.1
    outline = [
        (0.0, 0.0),
        (0.17, 0.0),
        (0.17, 0.035),
        (0.11, 0.045),
        (0.105, 0.12),
        (r, 0.14),
        (r, 0.52),
        (0.135, 0.53),
        (0.135, 0.565),
        (0.11, 0.575),
        (0.1, 0.65),
        (0.06, 0.72),
        (0.03, 0.735),
        (0.0, 0.74),
    ]
    body.add(lathe(outline, 24), red, mass=62.0)
    body.add(cylinder(0.03, 0.065, (0.0, 0.0, height - 0.065), sides=5), cap, mass=0.8)
    for axis, reach, radius in (("X", 0.17, 0.06), ("Y", 0.16, 0.042)):
        for side in (1,) if axis == "X" else (-1, 1):
            stub = cylinder(radius, reach - 0.02, (0.0, 0.0, 0.0), axis, 18)
            end = cylinder(radius + 0.012, 0.035, tuple(reach - 0.03 if a == axis else 0.0 for a in "XYZ"), axis, 8)  # type: ignore[arg-type]
            nut = cylinder(0.018, 0.055, tuple(reach - 0.03 if a == axis else 0.0 for a in "XYZ"), axis, 5)  # type: ignore[arg-type]
            turn = 0.0 if side > 0 else 180.0
            body.add(stub.turned("Z", turn).moved(z=0.42), red, mass=1.5)
            body.add(join([end, nut]).turned("Z", turn).moved(z=0.42), cap, mass=1.2)
            body.collide(
                f"outlet_{axis.lower()}_{'left' if side > 0 else 'right'}",
                cap,
                hull((stub + end).turned("Z", turn).moved(z=0.42)),
            )
    bolts = [cylinder(0.012, 0.02, (0.145, 0.0, 0.035), sides=6).turned("Z", 60.0 * k) for k in range(6)]
    body.add(join(bolts), cap, 0.0)
    body.collide("plate", red, drum(0.17, 0.0, 0.04))
    body.collide("barrel", red, drum(0.105, 0.03, 0.66))
    body.collide("flange", red, drum(0.135, 0.52, 0.57))
    body.collide("bonnet", red, drum(0.05, 0.64, height - 0.04))
    body.anchors = {"top": (0.0, 0.0, height), "outlet": (0.19, 0.0, 0.42)}
    return asset


def gate(width: float = 1.0, tall: float = 1.0) -> Asset:
    """A garden gate of pales between two posts; it swings both ways."""
    wood = Paint("pales", PINE, (0.70, 0.69, 0.65), 0.8)
    post = Paint("posts", PINE, (0.36, 0.20, 0.09), 0.9)
    iron = Paint("fittings", STEEL, (0.04, 0.04, 0.045), 0.5, 0.5)
    asset = Asset(
        "gate",
        ["gate", "garden gate", "fence gate", "wooden gate"],
        "building/gate",
        "A garden gate on hinges between two posts in a concrete sill.",
        "outside",
    )
    stand, square, base = asset.body("stand"), 0.12, 0.12
    boards(stand, FOOTING, {"sill": ((1.0, width + 2 * square + 0.2, base), (0.0, 0.0, base / 2))})
    for j, side in ((-1, "right"), (1, "left")):
        y = j * (width / 2 + square / 2 + 0.01)
        boards(stand, post, {f"post_{side}": ((square, square, tall + 0.15), (0.0, y, base + (tall + 0.15) / 2))})
        stand.add(
            prism(
                [
                    [(x * s, y + w * s, z) for x, w in ((1, -1), (1, 1), (-1, 1), (-1, -1))]
                    for z, s in ((base + tall + 0.15, 0.07), (base + tall + 0.2, 0.01))
                ]
            ),
            post,
            500.0,
        )
    body = leaf(asset, "leaf", wood, (0.05, width, 0.02), (0.0, 0.0, base + 0.3), 1, swing=100.0, both_ways=True)
    parts = [box((0.03, width, 0.08), (0.0, 0.0, base + z)) for z in (0.25, 0.75)]
    count = 8
    for k in range(count):
        y = (k - (count - 1) / 2) * (width - 0.08) / (count - 1)
        tip = [
            (y - 0.04, base + 0.06),
            (y + 0.04, base + 0.06),
            (y + 0.04, base + tall - 0.06),
            (y, base + tall),
            (y - 0.04, base + tall - 0.06),
        ]
        parts.append(upright(tip, 0.02).moved(x=0.025))
    brace = box((0.025, math.hypot(width - 0.1, 0.5), 0.07)).turned("X", math.degrees(math.atan2(-0.5, width - 0.1)))
    body.add(join([*parts, brace.moved(0.0, 0.0, base + 0.5)]), wood)
    body.collide("gate", wood, block((0.055, width, tall - 0.08), (0.007, 0.0, base + 0.06 + (tall - 0.08) / 2)))
    straps = [box((0.01, 0.25, 0.03), (0.037, width / 2 - 0.12, base + z)) for z in (0.25, 0.75)]
    body.add(join([*straps, box((0.02, 0.12, 0.03), (0.045, -width / 2 + 0.06, base + 0.75))]), iron, mass=0.6)
    body.anchors = {"handle": (0.05, -width / 2 + 0.06, base + 0.75)}
    return asset
