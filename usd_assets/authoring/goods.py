"""Boards, and what is built of boards to be stood, rolled or laid on."""

from __future__ import annotations

import math

from .asset import Asset
from .furniture import boards
from .matter import ACRYLIC, PINE, PLYWOOD, RUBBER, Paint
from .parts import block, box, extrude, hull, join, lathe


def plank(length: float = 2.0, width: float = 0.2, thick: float = 0.04) -> Asset:
    """A sawn plank that lies along X."""
    wood = Paint("pine", PINE, (0.60, 0.38, 0.17), 0.8)
    grain = Paint("grain", PINE, (0.42, 0.23, 0.09), 0.9)
    asset = Asset(
        "plank",
        ["plank", "board", "wooden plank", "wooden board", "beam", "timber", "lumber"],
        "building/plank",
        "A sawn plank of pine.",
        "an end; the plank lies along X",
    )
    body = asset.body()
    skin, end = 0.0006, 0.003
    body.add(box((length - 2 * end, width, thick - 2 * skin), (0.0, 0.0, thick / 2)), wood)
    # Growth rings: dark end faces, and stripes along both faces.
    ends = [box((end, width - 0.002, thick - 0.003), (i * (length - end) / 2, 0.0, thick / 2)) for i in (-1, 1)]
    stripes = [
        (-0.075, 0.004, 0.0, 1.0),
        (-0.042, 0.007, 0.06, 0.9),
        (0.008, 0.005, -0.05, 0.85),
        (0.05, 0.008, 0.02, 0.95),
    ]
    lines = [
        box((share * (length - 0.06), across, thick), (x * length / 2, y, thick / 2)) for y, across, x, share in stripes
    ]
    knots = [lathe([(0.0, 0.0), (r, 0.0), (r, thick), (0.0, thick)], 14).moved(x, y) for x, y, r in _KNOTS]
    body.add(join([*ends, *lines, *knots]), grain, 0.0)
    body.weigh(join(ends), PINE.density)
    body.collide("board", wood, block((length, width, thick), (0.0, 0.0, thick / 2)))
    body.anchors = {"top": (0.0, 0.0, thick), "front_end": (length / 2, 0.0, thick / 2)}
    body.anchors["back_end"] = (-length / 2, 0.0, thick / 2)
    return asset


_KNOTS = ((0.55, 0.03, 0.016), (-0.3, -0.06, 0.012), (-0.72, 0.02, 0.018))


def ramp(length: float = 1.2, width: float = 0.6, height: float = 0.4) -> Asset:
    """A ramp of plywood that falls towards +X."""
    deck = Paint("deck", PLYWOOD, (0.58, 0.38, 0.19), 0.8)
    side = Paint("sides", PLYWOOD, (0.40, 0.24, 0.11), 0.8)
    grip = Paint("grip_strips", RUBBER, (0.03, 0.03, 0.03), 0.9)
    asset = Asset(
        "ramp",
        ["ramp", "inclined plane", "incline", "slope", "wedge"],
        "building/ramp",
        "A ramp of plywood with strips against slipping; it rises by 0.4 m over 1.2 m.",
        "downhill: the low edge is at +X",
    )
    body, cheek, sheet, proud = asset.body(), 0.018, 0.02, 0.0015
    low, high, rise = length / 2, -length / 2, height / length
    toe = low - sheet / rise  # where the underside of the deck meets the ground
    deck_outline = [(high, height - sheet), (toe, 0.0), (low, 0.0), (high, height)]
    body.add(extrude(deck_outline, width), deck)
    below = extrude([(high, 0.0), (toe - 0.01, 0.0), (high, height - sheet - 0.01 * rise)], cheek)
    body.add(join(below.moved(y=j * (width - cheek) / 2) for j in (-1, 1)), side)
    tall = height - sheet - cheek * rise
    body.add(box((cheek, width - 2 * cheek, tall), (high + cheek / 2, 0.0, tall / 2)), side)
    slope, fall, count = math.degrees(math.atan(rise)), math.hypot(length, height), 8
    strip = box((0.03, width - 0.06, 0.01), (0.0, 0.0, proud - 0.005))
    places = [fall * ((k + 0.5) / count - 0.5) for k in range(count)]
    body.add(join(strip.moved(x=x).turned("Y", slope).moved(z=height / 2) for x in places), grip, 0.0)
    body.collide("wedge", deck, hull(extrude([(high, 0.0), (low, 0.0), (high, height)], width)))
    body.anchors = {"top": (high, 0.0, height), "middle": (0.0, 0.0, height / 2), "foot": (low, 0.0, 0.0)}
    return asset


def domino(height: float = 0.048, width: float = 0.024, thick: float = 0.0075) -> Asset:
    """A domino that stands on its short edge: three over four."""
    ivory = Paint("tile", ACRYLIC, (0.78, 0.74, 0.62), 0.3)
    black = Paint("pips", ACRYLIC, (0.015, 0.015, 0.015), 0.4)
    asset = Asset(
        "domino",
        ["domino", "domino tile", "domino piece", "domino stone"],
        "game/domino",
        "A domino that stands on its short edge.",
        "a face; dominoes that stand in a row along X knock each other over",
    )
    body, proud = asset.body(), 0.0002
    body.add(box((thick - 2 * proud, width, height), (0.0, 0.0, height / 2)), ivory, 0.0)
    body.weigh(box((thick, width, height), (0.0, 0.0, height / 2)), ivory.substance.density)
    pip = lathe([(0.0, -thick / 2), (0.0022, -thick / 2), (0.0022, thick / 2), (0.0, thick / 2)], 16).turned("Y", 90.0)
    quarter, step = height / 4, 0.0062
    three = [(-step, -step), (0.0, 0.0), (step, step)]
    four = [(i * step, j * step) for i in (-1, 1) for j in (-1, 1)]
    marks = [pip.moved(0.0, y, 3 * quarter + z) for y, z in three] + [pip.moved(0.0, y, quarter + z) for y, z in four]
    # The marks go right through: both faces show them, and nothing is as thin as a coat of paint.
    body.add(join([*marks, box((thick, width - 0.005, 0.0012), (0.0, 0.0, height / 2))]), black, 0.0)
    body.collide("tile", ivory, block((thick, width, height), (0.0, 0.0, height / 2)))
    body.anchors = {"top": (0.0, 0.0, height)}
    return asset


def pallet(length: float = 1.2, width: float = 0.8) -> Asset:
    """A EUR pallet (EN 13698-1): 0.144 m high, open to forks from all sides."""
    wood = Paint("boards", PINE, (0.60, 0.41, 0.21), 0.9)
    dark = Paint("blocks", PINE, (0.44, 0.28, 0.13), 0.9)
    asset = Asset(
        "pallet",
        ["pallet", "wooden pallet", "euro pallet", "skid"],
        "container/pallet",
        "A wooden pallet for forklifts, 1.2 m by 0.8 m.",
        "a short side, where the forks go in",
    )
    body, board, cube = asset.body(), 0.022, 0.078
    rows, columns = (-(width - 0.145) / 2, 0.0, (width - 0.145) / 2), (-(length - 0.1) / 2, 0.0, (length - 0.1) / 2)
    for name, y in zip(("right", "middle", "left"), rows, strict=True):
        wide = 0.145 if y else 0.1
        boards(body, wood, {f"runner_{name}": ((length, wide, board), (0.0, y, board / 2))})
        for place, x in zip(("back", "middle", "front"), columns, strict=True):
            size = (0.145 if x == 0.0 else 0.1, wide, cube)
            boards(body, dark, {f"block_{place}_{name}": (size, (x, y, board + cube / 2))})
    z = board + cube
    for place, x in zip(("back", "middle", "front"), columns, strict=True):
        size = (0.145 if x == 0.0 else 0.1, width, board)
        boards(body, wood, {f"cross_{place}": (size, (x, 0.0, z + board / 2))})
    edges = (0.145, 0.1, 0.145, 0.1, 0.145)
    gap = (width - sum(edges)) / 4
    low = -width / 2
    for k, wide in enumerate(edges):
        boards(body, wood, {f"deck_{k}": ((length, wide, board), (0.0, low + wide / 2, z + 1.5 * board))})
        low += wide + gap
    body.anchors = {"top": (0.0, 0.0, z + 2 * board)}
    return asset
