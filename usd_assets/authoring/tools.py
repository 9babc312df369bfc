"""Hand tools, a toolbox, and what a workshop works at."""

from __future__ import annotations

import numpy as np

from .asset import Asset, Joint
from .forms import basket, cylinder, wheel
from .furniture import CORNERS, boards
from .matter import ABS, BEECH, CAST_IRON, PINE, STEEL, Paint
from .parts import Mesh, Point, arc, block, box, drum, extrude, hull, join, lathe, prism, rod, taper, tube


def hammer(length: float = 0.32) -> Asset:
    """A carpenter's hammer that lies on its side, its handle along X; the head weighs 0.45 kg."""
    steel = Paint("head", STEEL, (0.22, 0.23, 0.25), 0.35, 0.7)
    wood = Paint("handle", BEECH, (0.50, 0.27, 0.10))
    asset = Asset(
        "hammer",
        ["hammer", "claw hammer", "mallet"],
        "tool/hammer",
        "A claw hammer that lies on its side.",
        "the end of the handle; the head is at -X",
    )
    body, z, x = asset.body(), 0.0135, -length / 2 + 0.014
    face = cylinder(0.0135, 0.028, (x, -0.05, z), "Y", 20)
    neck = cylinder(0.009, 0.024, (x, -0.024, z), "Y", 16)
    eye = box((0.026, 0.032, 0.024), (x, 0.012, z))
    body.add(join([face, neck, eye]), steel, mass=0.36)
    for side in (-1, 1):
        rings = []
        for y, dx, h in (
            (0.026, 0.0, 0.020),
            (0.05, 0.004, 0.014),
            (0.07, 0.013, 0.008),
            (0.084, 0.024, 0.003),
        ):
            a, b = z + side * 0.003, z + side * 0.011
            low, high = min(a, b), max(a, b)
            rings.append(
                [
                    (x + dx - h / 2, y, low),
                    (x + dx - h / 2, y, high),
                    (x + dx + h / 2, y, high),
                    (x + dx + h / 2, y, low),
                ]
            )
        body.add(prism(rings), steel, mass=0.045)
    shaft = [
        (x - 0.013, 0.012, z),
        (x + 0.05, 0.012, z),
        (x + 0.16, 0.012, z),
        (length / 2 - 0.02, 0.012, z),
        (length / 2, 0.012, z),
    ]
    body.add(_swelling(shaft, (0.0095, 0.0085, 0.0105, 0.0125, 0.010)), wood)
    body.collide("face", steel, wheel(0.0135, 0.052, (x, -0.024, z)))
    body.collide("eye", steel, block((0.026, 0.04, 0.027), (x, 0.016, z)))
    body.collide("claw", steel, block((0.016, 0.05, 0.022), (x + 0.01, 0.058, z)))
    body.collide("handle", wood, wheel(0.0115, length - 0.04, (0.015, 0.012, z), "X"))
    body.collide("end", wood, block((0.02, 0.012, z), (length / 2 - 0.015, 0.012, z / 2)))
    body.anchors = {"head": (x, 0.0, z), "handle": (length / 2 - 0.06, 0.012, z)}
    return asset


def _swelling(path: list[Point], radii: tuple[float, ...]) -> Mesh:
    """A bar along X of changing thickness."""
    rings = [arc(at, r, 0.0, 330.0, 12) for at, r in zip(path, radii, strict=True)]
    return prism(rings)


def screwdriver(length: float = 0.21) -> Asset:
    """A slotted screwdriver that lies on the flats of its grip."""
    grip = Paint("grip", ABS, (0.60, 0.10, 0.02), 0.35)
    band = Paint("band", ABS, (0.02, 0.02, 0.022), 0.4)
    steel = Paint("blade", STEEL, (0.45, 0.46, 0.48), 0.25, 0.8)
    asset = Asset(
        "screwdriver",
        ["screwdriver", "slotted screwdriver", "screw driver"],
        "tool/screwdriver",
        "A screwdriver that lies down.",
        "the tip of the blade",
    )
    body, r, start = asset.body(), 0.0155, -length / 2
    z = r * np.cos(np.pi / 6)
    steps = ((0.0, 0.7), (0.006, 0.95), (0.03, 1.0), (0.06, 0.98), (0.078, 0.72), (0.088, 0.72), (0.096, 1.0))
    body.add(prism([arc((start + x, 0.0, z), r * s, 0.0, 300.0, 6) for x, s in steps]), grip, mass=0.085)
    body.add(cylinder(r * 0.8, 0.006, (start + 0.094, 0.0, z), "X", 18), band, 0.0)
    shaft = cylinder(0.0033, length - 0.112, (start + 0.098, 0.0, z), "X", 14)
    end = length / 2
    tip = prism(
        [
            [(x, -w, z - h), (x, w, z - h), (x, w, z + h), (x, -w, z + h)]
            for x, w, h in ((end - 0.016, 0.003, 0.003), (end - 0.01, 0.0042, 0.002), (end, 0.0035, 0.0006))
        ]
    )
    body.add(shaft + tip, steel)
    flat = prism([arc((start + x, 0.0, z), r, 0.0, 300.0, 6) for x in (0.006, 0.094)])
    body.collide("grip", grip, hull(flat))
    body.collide("blade", steel, rod((start + 0.09, 0.0, z), (end, 0.0, z), 0.0033))
    body.anchors = {"handle": (start + 0.04, 0.0, z), "tip": (end, 0.0, z)}
    return asset


def toolbox(length: float = 0.48, width: float = 0.23, height: float = 0.2) -> Asset:
    """A steel toolbox; its lid is hinged along the back and lies on the box."""
    red = Paint("box", STEEL, (0.50, 0.03, 0.02), 0.35)
    black = Paint("handle", ABS, (0.02, 0.02, 0.022))
    steel = Paint("latches", STEEL, (0.50, 0.50, 0.52), 0.3, 0.8)
    asset = Asset(
        "toolbox",
        ["toolbox", "tool box", "tool chest", "toolkit"],
        "container/toolbox",
        "A steel toolbox with a hinged lid, a handle and two latches.",
        "the side of the latches; the hinge is at -X",
    )
    case, wall, floor = asset.body("stand"), 0.006, 0.006
    boards(case, red, basket((width, length, height), wall, floor), 0.2 * STEEL.density)
    lid = asset.body("lid", (-width / 2, 0.0, height))
    outline = [
        (-width / 2, height + 0.001),
        (width / 2, height + 0.001),
        (width / 2, height + 0.02),
        (width / 4, height + 0.05),
        (-width / 4, height + 0.05),
        (-width / 2, height + 0.02),
    ]
    lid.add(extrude(outline, length), red, mass=1.0)
    top = height + 0.05
    grip = [(0.0, -0.08, top - 0.01), (0.0, -0.075, top + 0.04), (0.0, 0.075, top + 0.04), (0.0, 0.08, top - 0.01)]
    lid.add(tube(grip, 0.009, 10), black, mass=0.12)
    lid.collide("lid", red, hull(extrude(outline, length)))
    lid.collide("handle", black, rod((0.0, -0.09, top + 0.04), (0.0, 0.09, top + 0.04), 0.009))
    for j in (-1, 1):
        case.add(box((0.008, 0.035, 0.05), (width / 2 + 0.004, j * 0.14, height - 0.03)), steel, mass=0.05)
        lid.add(box((0.006, 0.03, 0.02), (width / 2 + 0.003, j * 0.14, height + 0.011)), steel, 0.0)
    joint = Joint("lid_hinge", "stand", "lid", (-width / 2, 0.0, height), "Y", (-100.0, 0.0), 0.05)
    asset.joints = [joint]
    case.anchors = {"inside": (0.0, 0.0, floor)}
    lid.anchors = {"handle": (0.0, 0.0, top + 0.049)}
    free = height - floor - 0.002
    asset.hollow = ((width - 2 * wall, length - 2 * wall, free), (0.0, 0.0, floor + free / 2))
    return asset


def workbench(width: float = 1.5, depth: float = 0.65, height: float = 0.85) -> Asset:
    """A joiner's bench: a thick top with a board of pegs behind, a shelf below."""
    top = Paint("top", BEECH, (0.52, 0.31, 0.14))
    wood = Paint("frame", PINE, (0.42, 0.25, 0.11))
    board = Paint("back_board", PINE, (0.56, 0.40, 0.22))
    steel = Paint("tools", STEEL, (0.25, 0.26, 0.28), 0.4, 0.6)
    asset = Asset(
        "workbench",
        ["workbench", "work bench", "tool bench", "workshop table"],
        "furniture/workbench",
        "A workbench with a thick top, a shelf below and a board with tools behind it.",
        "where one works; the board is at -X",
    )
    body, thick, leg = asset.body(), 0.06, 0.09
    boards(body, top, {"top": ((depth, width, thick), (0.0, 0.0, height - thick / 2))})
    under = height - thick
    for i, j in CORNERS:
        name = f"leg_{'back' if i < 0 else 'front'}_{'right' if j < 0 else 'left'}"
        boards(body, wood, {name: ((leg, leg, under), (i * (depth / 2 - 0.07), j * (width / 2 - 0.1), under / 2))})
    boards(body, wood, {"shelf": ((depth - 0.1, width - 0.2, 0.025), (0.0, 0.0, 0.22))})
    rails = [box((0.04, width - 0.2 - leg, 0.1), (i * (depth / 2 - 0.07), 0.0, under - 0.05)) for i in (-1, 1)]
    body.add(join(rails), wood)
    x = -depth / 2 + 0.01
    boards(body, board, {"board": ((0.02, width, 0.55), (x, 0.0, height + 0.275))})
    saw = [(0.0, 0.0), (0.42, 0.03), (0.42, 0.07), (0.0, 0.12)]
    face = prism(
        [
            [(x + 0.012, -0.6 + y, height + 0.2 + z) for y, z in saw],
            [(x + 0.02, -0.6 + y, height + 0.2 + z) for y, z in saw],
        ]
    )
    wrench = [box((0.01, 0.025, 0.2 + 0.03 * k), (x + 0.014, 0.1 + 0.07 * k, height + 0.3)) for k in range(4)]
    body.add(join([face, *wrench]), steel, 0.0)
    body.add(box((0.025, 0.09, 0.13), (x + 0.02, -0.63, height + 0.26)), top, 0.0)
    body.anchors = {"top": (0.05, 0.0, height), "shelf": (0.0, 0.0, 0.2325)}
    return asset


def anvil(length: float = 0.55) -> Asset:
    """A smith's anvil with a horn: about 90 kg of iron."""
    iron = Paint("iron", CAST_IRON, (0.055, 0.058, 0.065), 0.45, 0.4)
    face = Paint("face", STEEL, (0.25, 0.26, 0.28), 0.3, 0.7)
    asset = Asset(
        "anvil",
        ["anvil", "blacksmith anvil", "smithy anvil"],
        "tool/anvil",
        "A blacksmith's anvil with its horn.",
        "the horn",
    )
    body, height, wide = asset.body(), 0.27, 0.11
    foot = taper((0.30, 0.24), (0.26, 0.20), 0.05)
    waist = prism(
        [
            [(x * a, y * b, z) for x, y in ((1, -1), (1, 1), (-1, 1), (-1, -1))]
            for z, a, b in ((0.05, 0.12, 0.09), (0.1, 0.075, 0.045), (0.15, 0.08, 0.045), (0.2, 0.14, wide / 2))
        ]
    )
    block_ = box((0.34, wide, 0.062), (-0.03, 0.0, height - 0.04))
    body.add(join([foot, waist, block_]), iron)
    body.add(box((0.34, wide, 0.01), (-0.03, 0.0, height - 0.005)), face)
    horn = lathe([(0.0, 0.0), (0.05, 0.0), (0.046, 0.06), (0.034, 0.12), (0.016, 0.17), (0.0, 0.185)], 20).turned(
        "Y", 90.0
    )
    horn = Mesh(horn.points * (1.0, 1.0, 0.7) + (0.14, 0.0, height - 0.037), horn.faces)
    body.add(horn, iron)
    body.collide("foot", iron, hull(foot))
    body.collide("waist", iron, block((0.16, 0.1, 0.15), (0.0, 0.0, 0.125)))
    body.collide("top", face, block((0.34, wide, 0.07), (-0.03, 0.0, height - 0.035)))
    body.collide("horn", iron, hull(horn))
    body.anchors = {"top": (-0.03, 0.0, height), "horn": (0.25, 0.0, height - 0.03)}
    return asset


def vice(width: float = 0.12) -> Asset:
    """A bench vice: its front jaw slides on the screw, 0.1 m open at most."""
    blue = Paint("body", CAST_IRON, (0.03, 0.10, 0.30), 0.45)
    steel = Paint("jaws", STEEL, (0.42, 0.43, 0.45), 0.3, 0.8)
    asset = Asset(
        "vice",
        ["vice", "vise", "bench vice", "bench vise"],
        "tool/vice",
        "A bench vice with a jaw that slides.",
        "the screw with its handle",
    )
    base, high = asset.body("stand"), 0.17
    boards(base, blue, {"foot": ((0.22, 0.16, 0.025), (0.0, 0.0, 0.0125))})
    boards(base, blue, {"post": ((0.12, 0.09, 0.075), (-0.02, 0.0, 0.0625))})
    boards(base, blue, {"back_jaw": ((0.05, width, 0.07), (-0.055, 0.0, 0.135))}, 0.8 * 7200.0)
    base.add(box((0.008, width, 0.03), (-0.027, 0.0, high - 0.015)), steel)
    bolts = [cylinder(0.012, 0.012, (i * 0.085, j * 0.06, 0.025), sides=6) for i, j in CORNERS]
    base.add(join(bolts), steel, 0.0)
    jaw = asset.body("jaw", (0.06, 0.0, 0.1))
    jaw.add(box((0.05, width, 0.07), (0.055, 0.0, 0.135)), blue, 0.8 * 7200.0)
    jaw.add(box((0.16, 0.06, 0.045), (0.02, 0.0, 0.085)), blue, 0.6 * 7200.0)
    jaw.add(box((0.008, width, 0.03), (0.027, 0.0, high - 0.015)), steel)
    jaw.add(cylinder(0.015, 0.06, (0.09, 0.0, 0.085), "X", 20), steel)
    jaw.add(cylinder(0.022, 0.03, (0.14, 0.0, 0.085), "X", 20), steel)
    jaw.add(tube([(0.155, 0.0, 0.012), (0.155, 0.0, 0.165)], 0.006, 10), steel)
    jaw.add(join(cylinder(0.01, 0.012, (0.155, 0.0, z), sides=12) for z in (0.006, 0.157)), steel)
    jaw.collide("jaw", blue, block((0.05, width, 0.07), (0.055, 0.0, 0.135)))
    jaw.collide("screw", steel, wheel(0.02, 0.09, (0.125, 0.0, 0.085), "X"))
    jaw.collide("handle", steel, drum(0.006, 0.02, 0.165, 0.155))
    asset.joints = [Joint("screw", "stand", "jaw", (0.06, 0.0, 0.1), "X", (-0.05, 0.05), 20.0, "Prismatic")]
    base.anchors = {"jaws": (0.0, 0.0, high)}
    return asset
