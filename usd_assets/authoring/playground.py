"""What children play on: a seesaw, a swing, a slide and a sandbox."""

from __future__ import annotations

import itertools

from .asset import Asset, Body, Joint
from .forms import cylinder
from .furniture import boards
from .matter import ABS, HDPE, PINE, PLYWOOD, RUBBER, SAND, STEEL, Paint
from .parts import Mesh, box, extrude, hull, join, lathe, rod, tube


def seesaw(length: float = 2.4, hinge: float = 0.45, limit: float = 18.0) -> Asset:
    """A seesaw: a plank on a hinge that tilts by `limit` [deg] either way."""
    asset = Asset(
        "seesaw",
        ["seesaw", "see-saw", "teeter", "teeter-totter", "teeterboard", "rocker", "lever"],
        "playground/seesaw",
        "A seesaw: a plank with two seats, balanced on a hinge, on a steel stand.",
        "an end of the plank; it tilts about Y",
    )
    _stand(asset.body("stand"), hinge)
    _seesaw_plank(asset.body("plank", (0.0, 0.0, hinge)), length, hinge)
    asset.joints = [Joint("hinge", "stand", "plank", (0.0, 0.0, hinge), "Y", (-limit, limit))]
    return asset


_RED = Paint("stand", STEEL, (0.50, 0.05, 0.03), 0.4)
_GRIPS = Paint("grips", STEEL, (0.35, 0.35, 0.37), 0.3, 0.8)


def _stand(stand: Body, hinge: float) -> None:
    foot, half, reach, pipe = (0.7, 0.06, 0.03), 0.2, 0.28, 0.022
    for j, side in ((-1, "right"), (1, "left")):
        y = j * half
        boards(stand, _RED, {f"foot_{side}": (foot, (0.0, y, foot[2] / 2))})
        for i, end in ((-1, "back"), (1, "front")):
            leg = tube([(i * reach, y, foot[2]), (0.0, y, hinge)], pipe)
            stand.add(leg, _RED, 0.3 * STEEL.density)  # a pipe
            stand.collide(f"leg_{end}_{side}", _RED, rod((i * reach, y, foot[2] + 0.01), (0.0, y, hinge), pipe))
        bearing = lathe([(0.0, -0.03), (0.04, -0.03), (0.04, 0.03), (0.0, 0.03)], 20).turned("X", 90.0)
        stand.add(bearing.moved(0.0, y, hinge), _RED)
    cross = (0.06, 2 * half - foot[1], foot[2])
    for i, end in ((-1, "back"), (1, "front")):
        boards(stand, _RED, {f"cross_{end}": (cross, (i * 0.3, 0.0, foot[2] / 2))})
    stand.add(tube([(0.0, -half, hinge), (0.0, half, hinge)], 0.015), _GRIPS)


def _seesaw_plank(plank: Body, length: float, hinge: float) -> None:
    wood = Paint("plank", PINE, (0.62, 0.40, 0.16), 0.7)
    blue = Paint("seats", PLYWOOD, (0.03, 0.14, 0.42), 0.5)
    width, thick = 0.26, 0.04
    # It hangs so far below the hinge that its centre of mass, with seats and grips, does too: it swings back to level.
    middle = hinge - 0.035
    top = middle + thick / 2
    boards(plank, wood, {"board": ((length, width, thick), (0.0, 0.0, middle))})
    for i, end in ((-1, "back"), (1, "front")):
        x, at = i * (length / 2 - 0.18), i * (length / 2 - 0.5)
        boards(plank, blue, {f"seat_{end}": ((0.3, width + 0.06, 0.024), (x, 0.0, top + 0.012))})
        bar = [(at, -0.13, top + 0.16), (at, 0.13, top + 0.16)]
        posts = [tube([(at, y, top), (at, y, top + 0.16)], 0.011) for y in (-0.09, 0.09)]
        plank.add(join([*posts, tube(bar, 0.013)]), _GRIPS, 0.3 * STEEL.density)
        plank.collide(f"grip_{end}", _GRIPS, rod(bar[0], bar[1], 0.013))
        plank.anchors[f"{end}_seat"] = (x, 0.0, top + 0.024)
        plank.anchors[f"{end}_end"] = (i * length / 2, 0.0, middle)


def swing(height: float = 2.1, seat: float = 0.45) -> Asset:
    """A swing: a seat on two chains that turn on hinges of the frame's bar."""
    steel = Paint("frame", STEEL, (0.04, 0.20, 0.42), 0.4)
    chain = Paint("chains", STEEL, (0.35, 0.35, 0.37), 0.4, 0.7)
    rubber = Paint("seat", RUBBER, (0.03, 0.03, 0.03), 0.8)
    asset = Asset(
        "swing",
        ["swing", "swing set", "playground swing", "child swing"],
        "playground/swing",
        "A swing: a seat on chains under a steel frame.",
        "where the child faces; it swings along X",
    )
    stand, half, reach, pipe = asset.body("stand"), 0.95, 0.85, 0.03
    boards(stand, steel, {"bar": ((2 * pipe, 2 * half + 0.1, 2 * pipe), (0.0, 0.0, height))}, 0.35 * STEEL.density)
    for j, side in ((-1, "right"), (1, "left")):
        for i, end in ((-1, "back"), (1, "front")):
            low, high = (i * reach, j * (half + 0.12), 0.02), (0.0, j * half, height)
            stand.add(tube([low, high], pipe, 10), steel, 0.35 * STEEL.density)
            stand.collide(f"leg_{end}_{side}", steel, rod((low[0], low[1], 0.05), high, pipe))
            boards(stand, steel, {f"foot_{end}_{side}": ((0.2, 0.16, 0.03), (low[0], low[1], 0.015))})
        stand.add(
            tube([(-reach * 0.6, j * (half + 0.07), 0.85), (reach * 0.6, j * (half + 0.07), 0.85)], 0.02, 8),
            steel,
            2500.0,
        )
    hinge = (0.0, 0.0, height - pipe - 0.02)
    body, grip = asset.body("hanging", hinge), 0.24
    for j, side in ((-1, "right"), (1, "left")):
        line = [(0.0, j * grip, hinge[2]), (0.0, j * grip, seat)]
        body.add(tube(line, 0.007, 6), chain, 0.6 * STEEL.density)
        body.add(join(_links(j * grip, seat + 0.05, hinge[2])), chain, 0.0)
        stand.add(cylinder(0.02, 0.05, (0.0, j * grip, hinge[2] - 0.01), sides=12), steel, mass=0.2)
        body.collide(f"chain_{side}", chain, rod((0.0, j * grip, seat), (0.0, j * grip, hinge[2] - 0.03), 0.009))
    boards(body, rubber, {"seat": ((0.2, 2 * grip + 0.04, 0.03), (0.0, 0.0, seat - 0.015))})
    asset.joints = [Joint("hinge", "stand", "hanging", hinge, "Y", (-100.0, 100.0), 0.02)]
    body.anchors = {"on_seat": (0.0, 0.0, seat)}
    stand.anchors = {"top": (0.0, 0.0, height + pipe)}
    return asset


def _links(y: float, low: float, high: float) -> list[Mesh]:
    """Links of a chain, turned by turns."""
    count = 14
    step = (high - low) / count
    return [
        box((0.026 if k % 2 else 0.008, 0.008 if k % 2 else 0.026, step * 0.75), (0.0, y, low + (k + 0.5) * step))
        for k in range(count)
    ]


def slide(height: float = 1.5, length: float = 2.6) -> Asset:
    """A children's slide: a ladder, a platform and a chute of 32 degrees that runs out level."""
    red = Paint("chute", HDPE, (0.62, 0.05, 0.03), 0.3)
    yellow = Paint("sides", HDPE, (0.85, 0.58, 0.03), 0.4)
    steel = Paint("ladder", STEEL, (0.04, 0.20, 0.42), 0.4)
    asset = Asset(
        "slide",
        ["slide", "playground slide", "chute", "children slide"],
        "playground/slide",
        "A playground slide with a ladder and a chute.",
        "where the chute ends",
    )
    body, wide, thick, flat = asset.body(), 0.5, 0.025, 0.45
    top, out = (-0.75, height), (0.85, 0.32)
    end = (length - 0.75 - flat, 0.27)
    path = [(top[0] - flat, height), top, out, end]
    slick = Paint("surface", HDPE, (0.62, 0.05, 0.03), 0.3)
    for k, ((x0, z0), (x1, z1)) in enumerate(itertools.pairwise(path)):
        outline = [(x0, z0 - thick), (x1, z1 - thick), (x1, z1), (x0, z0)]
        body.add(extrude(outline, wide), red)
        body.collide(("platform", "chute", "runout")[k], slick, hull(extrude(outline, wide)))
        if k == 0:
            continue
        wall = [(x0, z0 - thick), (x1, z1 - thick), (x1, z1 + 0.11), (x0, z0 + 0.11)]
        for j, side in ((-1, "right"), (1, "left")):
            cheek = extrude(wall, 0.03).moved(y=j * (wide + 0.03) / 2)
            body.add(cheek, yellow)
            body.collide(f"side_{k}_{side}", yellow, hull(cheek))
    back = top[0] - flat
    for j, side in ((-1, "right"), (1, "left")):
        y = j * (wide / 2 + 0.03)
        rail = [
            (back - 0.4, y, 0.02),
            (back, y, height),
            (back + 0.03, y, height + 0.55),
            (top[0] - 0.05, y, height + 0.55),
            (top[0] + 0.05, y, height + 0.08),
        ]
        body.add(tube(rail, 0.02, 8), steel, 0.35 * STEEL.density)
        body.collide(f"ladder_{side}", steel, rod((back - 0.4, y, 0.03), (back, y, height), 0.02))
        body.collide(
            f"rail_{side}", steel, rod((back + 0.03, y, height + 0.55), (top[0] - 0.05, y, height + 0.55), 0.02)
        )
        leg = [(top[0] + 0.02, y, height - 0.05), (top[0] + 0.12, y, 0.02)]
        body.add(tube(leg, 0.02, 8), steel, 0.35 * STEEL.density)
        body.collide(f"leg_{side}", steel, rod((leg[1][0], y, 0.03), leg[0], 0.02))
        stub = [(out[0] + 0.25, y, 0.26), (out[0] + 0.25, y, 0.02)]
        body.add(tube(stub, 0.02, 8), steel, 0.35 * STEEL.density)
        for name, x in (("back", back - 0.4), ("middle", leg[1][0]), ("front", stub[1][0])):
            boards(body, steel, {f"foot_{name}_{side}": ((0.16, 0.12, 0.03), (x, y, 0.015))})
    for k in range(1, 6):
        share = k / 6.0
        x, z = back - 0.4 * (1.0 - share), height * share
        boards(body, steel, {f"rung_{k}": ((0.09, wide + 0.06, 0.02), (x, 0.0, z))}, 0.5 * STEEL.density)
    middle = (top[0] + out[0]) / 2
    body.anchors = {"top": (top[0] - flat / 2, 0.0, height), "middle": (middle, 0.0, (height + out[1]) / 2)}
    body.anchors["end"] = (end[0], 0.0, end[1])
    return asset


def sandbox(edge: float = 1.5, height: float = 0.28) -> Asset:
    """A sandbox: boards around sand, with seats on two sides, a mould and a spade. The sand is solid."""
    wood = Paint("boards", PINE, (0.50, 0.31, 0.14), 0.8)
    seat = Paint("seats", PLYWOOD, (0.03, 0.16, 0.40), 0.6)
    sand = Paint("sand", SAND, (0.72, 0.55, 0.30), 1.0)
    toy = Paint("toys", ABS, (0.70, 0.05, 0.03), 0.4)
    asset = Asset(
        "sandbox",
        ["sandbox", "sandpit", "sand pit", "sand box"],
        "playground/sandbox",
        "A sandbox of boards filled with sand, with seats at its corners. The sand is solid.",
        "any side",
    )
    body, board, level = asset.body(), 0.04, 0.15
    inner = edge - 2 * board
    boards(body, sand, {"sand": ((inner, inner, level), (0.0, 0.0, level / 2))})
    for j, side in ((-1, "right"), (1, "left")):
        boards(body, wood, {side: ((edge, board, height), (0.0, j * (edge - board) / 2, height / 2))})
    for i, side in ((-1, "back"), (1, "front")):
        boards(body, wood, {side: ((board, inner, height), (i * (edge - board) / 2, 0.0, height / 2))})
    for k in range(4):
        half = edge / 2
        rings = [[(half, half - 0.4), (half, half), (half - 0.4, half)]]
        corner = extrude([(x, y) for x, y in rings[0]], 0.03)
        plate = corner.turned("X", 90.0).moved(z=height + 0.015).turned("Z", 90.0 * k)
        body.add(plate, seat)
        body.collide(f"seat_{k}", seat, hull(plate))
    heap = lathe(
        [(0.0, level - 0.01), (0.26, level - 0.01), (0.16, level + 0.07), (0.05, level + 0.13), (0.0, level + 0.14)], 14
    )
    body.add(heap.moved(-0.25, 0.2, 0.0), sand)
    body.collide("heap", sand, hull(heap.moved(-0.25, 0.2, 0.0)))
    pail = lathe(
        [
            (0.0, level),
            (0.06, level),
            (0.085, level + 0.14),
            (0.08, level + 0.14),
            (0.056, level + 0.005),
            (0.0, level + 0.005),
        ],
        20,
    )
    spade = [
        tube([(0.35, -0.1, level + 0.012), (0.2, -0.2, level + 0.012)], 0.01, 8),
        box((0.14, 0.09, 0.012)).turned("Z", 33.7).moved(0.42, -0.053, level + 0.008),
    ]
    body.add(join([pail.moved(0.25, 0.3, 0.0), *spade]), toy, mass=0.4)
    body.anchors = {"inside": (0.0, 0.0, level)}
    free = height - level
    asset.hollow = ((0.45, 0.45, free), (0.2, -0.25, level + free / 2))
    return asset
