"""What stands in an office, apart from its screens and its furniture to sit at."""

from __future__ import annotations

import math

from .asset import Asset
from .doors import drawer
from .forms import annulus, basket, cylinder, disc, inscribed
from .furniture import boards
from .matter import ABS, ALUMINIUM, PAPER, RUBBER, STEEL, Paint
from .parts import Mesh, Point, block, box, drum, extrude, hull, join, prism, staves, tube


def filing_cabinet(width: float = 0.4, depth: float = 0.6, height: float = 1.02) -> Asset:
    """A steel case of three drawers for hanging files; they slide out."""
    grey = Paint("case", STEEL, (0.30, 0.33, 0.34), 0.5, 0.1)
    light = Paint("drawers", STEEL, (0.42, 0.45, 0.46), 0.5, 0.1)
    grip = Paint("grips", STEEL, (0.08, 0.08, 0.09), 0.3, 0.7)
    label = Paint("labels", PAPER, (0.85, 0.83, 0.76), 0.9)
    asset = Asset(
        "filing_cabinet",
        ["filing cabinet", "file cabinet", "chest of drawers", "drawer unit", "drawers"],
        "furniture/filing",
        "A steel filing cabinet with three drawers that slide out.",
        "the side of the drawers",
    )
    case, wall, count, gap, face = asset.body("stand"), 0.012, 3, 0.006, 0.018
    deep, thin = depth - face, STEEL.density * 0.09  # folded sheet of 1 mm
    x = -face / 2
    for name, (size, at) in basket((deep, width, height), wall, 0.03).items():
        if name != "front":
            boards(
                case, grey, {name: (size, (at[0] + x, at[1], at[2]))}, 0.5 * STEEL.density if name == "floor" else thin
            )
    top = (deep - wall, width - 2 * wall, wall)
    boards(case, grey, {"top": (top, (x + wall / 2, 0.0, height - wall / 2))}, thin)
    step = (height - 0.03 - wall) / count
    for k in range(count):
        middle = 0.03 + (k + 0.5) * step
        size = (deep - wall - 0.02, width - 2 * wall - 0.02, step - 0.03)
        center = (x + (deep - size[0]) / 2, 0.0, middle)
        body = drawer(asset, f"drawer_{k + 1}", light, size, center, 0.42, 0.015 - gap / 2)
        body._lumps[:] = [(mesh, 0.13 * STEEL.density) for mesh, _ in body._lumps]  # sheet steel, too
        body.add(box((0.02, 0.14, 0.018), (depth / 2 + 0.009, 0.0, middle + 0.03)), grip, mass=0.1)
        body.add(box((0.006, 0.08, 0.04), (depth / 2 + 0.001, 0.0, middle + 0.085)), label, 0.0)
        body.anchors = {f"in_drawer_{k + 1}": (center[0], 0.0, middle - size[2] / 2 + 0.008)}
    case.anchors = {"top": (x, 0.0, height)}
    return asset


def printer(width: float = 0.42, depth: float = 0.38) -> Asset:
    """A laser printer with paper in its tray and a sheet on its output."""
    white = Paint("case", ABS, (0.70, 0.70, 0.68), 0.5)
    dark = Paint("trim", ABS, (0.05, 0.05, 0.055), 0.4)
    sheet = Paint("paper", PAPER, (0.92, 0.92, 0.90), 0.9)
    glow = Paint("display", ABS, (0.10, 0.38, 0.72), 0.2)
    asset = Asset(
        "printer",
        ["printer", "laser printer", "office printer", "copier", "photocopier"],
        "electronics/printer",
        "A laser printer: a paper tray below, a sheet coming out on top, a small display.",
        "the side of the paper tray",
    )
    body, high, front = asset.body(), 0.25, depth / 2
    outline = [
        (-front, 0.0),
        (front, 0.0),
        (front, 0.17),
        (front - 0.03, 0.2),
        (0.06, 0.2),
        (-0.08, high),
        (-front, high),
    ]
    body.add(extrude(outline, width), white, mass=9.0)
    body.add(box((0.012, width - 0.06, 0.07), (front, 0.0, 0.055)), dark, mass=0.3)
    body.add(box((0.02, 0.12, 0.014), (front + 0.006, 0.0, 0.078)), white, 0.0)
    body.add(box((0.16, 0.24, 0.006), (0.075, 0.03, 0.201)), dark, 0.0)
    paper = extrude([(-0.06, 0.236), (0.0, 0.2225), (0.14, 0.212), (0.14, 0.215), (0.0, 0.2255), (-0.06, 0.239)], 0.21)
    body.add(paper.moved(y=0.03), sheet, 0.0)
    body.add(box((0.06, 0.07, 0.008), (front - 0.055, -width / 2 + 0.06, 0.2)), dark, 0.0)
    body.add(box((0.03, 0.05, 0.01), (front - 0.06, -width / 2 + 0.06, 0.2)), glow, 0.0)
    body.collide("case", white, hull(extrude(outline, width)))
    body.anchors = {"top": (-0.13, 0.0, high), "tray": (front, 0.0, 0.055), "output": (0.07, 0.03, 0.213)}
    return asset


def keyboard(width: float = 0.44, depth: float = 0.13) -> Asset:
    """A keyboard of full size, with arrows and a number pad."""
    case = Paint("case", ABS, (0.04, 0.04, 0.045), 0.5)
    keys = Paint("keys", ABS, (0.60, 0.60, 0.58), 0.5)
    dark = Paint("dark_keys", ABS, (0.20, 0.21, 0.23), 0.5)
    asset = Asset(
        "keyboard",
        ["keyboard", "computer keyboard", "pc keyboard"],
        "electronics/keyboard",
        "A computer keyboard with a number pad.",
        "the side of the typist",
    )
    body, pitch = asset.body(), 0.019
    outline = [(-depth / 2, 0.0), (depth / 2, 0.0), (depth / 2, 0.012), (-depth / 2, 0.022)]
    body.add(extrude(outline, width), case, mass=0.62)

    def key(x: float, y: float, wide: float = 1.0, deep: float = 1.0) -> Mesh:
        size = (pitch * deep - 0.003, pitch * wide - 0.003, 0.008)
        return box(size, (x, -y, 0.02 - 0.0769 * x - 0.001))

    left, plain, special = width / 2 - 0.012, [], []
    for row in range(5):
        x = -depth / 2 + 0.036 + pitch * row
        count = 11 if row < 4 else 0
        first = 1.0 + 0.25 * row
        special.append(key(x, left - pitch * first / 2, first))
        plain += [key(x, left - pitch * (first + k + 0.5)) for k in range(count)]
        if row < 4:
            rest = 15.0 - first - count
            special.append(key(x, left - pitch * (first + count + rest / 2), rest))
        else:
            plain.append(key(x, left - pitch * 6.5, 6.0))
            special += [key(x, left - pitch * y, 1.25) for y in (2.75, 10.6, 12.3, 14.1)]
        plain += [key(x, left - pitch * (19.3 + k)) for k in range(3)]
        if row in (0, 1):
            special += [key(x, left - pitch * (15.9 + k)) for k in range(3)]
    special += [key(-depth / 2 + 0.036 + pitch * 3, left - pitch * 16.9)]
    special += [key(-depth / 2 + 0.036 + pitch * 4, left - pitch * (15.9 + k)) for k in range(3)]
    special += [key(-depth / 2 + 0.014, left - pitch * (0.5 + k + 0.4 * (k // 4))) for k in range(13)]
    body.add(join(plain), keys, 0.0)
    body.add(join(special), dark, 0.0)
    body.collide("case", case, hull(extrude([*outline[:2], (depth / 2, 0.019), (-depth / 2, 0.029)], width)))
    body.anchors = {"keys": (0.0, 0.05, 0.024)}
    return asset


def mouse(length: float = 0.118, width: float = 0.066, height: float = 0.037) -> Asset:
    """A computer mouse with two buttons, a wheel and the beginning of its cord."""
    shell = Paint("shell", ABS, (0.30, 0.31, 0.32), 0.4)
    dark = Paint("buttons", ABS, (0.035, 0.035, 0.04), 0.35)
    wheel = Paint("wheel", RUBBER, (0.60, 0.09, 0.05), 0.5)
    asset = Asset(
        "mouse",
        ["mouse", "computer mouse", "pc mouse"],
        "electronics/mouse",
        "A computer mouse with two buttons, a wheel and the beginning of its cord.",
        "the side of the buttons, away from the palm",
    )
    body = asset.body()
    shape = [(0.0, 0.55, 0.45), (0.06, 0.8, 0.7), (0.2, 0.97, 0.93), (0.4, 1.0, 1.0), (0.65, 0.93, 0.85),
             (0.85, 0.9, 0.6), (0.97, 0.8, 0.42), (1.0, 0.7, 0.3)]  # fmt: skip
    half = [(length * (share - 0.5), width / 2 * w, height * h) for share, w, h in shape]

    def arch(x: float, w: float, h: float, start: float, end: float, grow: float) -> list[Point]:
        angles = [math.radians(start + (end - start) * k / 8) for k in range(9)]
        return [(x, (w + grow) * math.cos(a), (h + grow) * math.sin(a) ** 0.7) for a in angles]

    hand = prism([arch(*each, 0.0, 180.0, 0.0) for each in half])
    body.add(hand, shell, mass=0.095)
    for start, end in ((8.0, 84.0), (96.0, 172.0)):
        rings = [[*arch(*each, start, end, 0.0012), *reversed(arch(*each, start, end, -0.002))] for each in half[3:]]
        body.add(prism(rings), dark, 0.0)
    body.add(disc(0.011, 0.006, (length * 0.3, 0.0, height * 0.66), sides=20), wheel, 0.0)
    end = length / 2
    cord = [
        (end - 0.004, 0.0, 0.006),
        (end + 0.01, 0.0, 0.005),
        (end + 0.03, 0.004, 0.0025),
        (end + 0.05, 0.012, 0.0025),
    ]
    body.add(tube(cord, 0.0022, 8), dark, 0.0)
    body.collide("shell", shell, hull(hand))
    body.anchors = {"top": (0.0, 0.0, height), "cord": (end, 0.0, 0.005)}
    return asset


def waste_basket(height: float = 0.3, top: float = 0.135, bottom: float = 0.1) -> Asset:
    """A waste-paper basket of steel mesh, with rims."""
    mesh = Paint("basket", STEEL, (0.06, 0.065, 0.07), 0.5, 0.4)
    rim = Paint("rims", STEEL, (0.25, 0.25, 0.27), 0.3, 0.7)
    asset = Asset(
        "waste_basket",
        ["waste basket", "wastebasket", "waste paper basket", "paper basket", "wastepaper bin", "office bin"],
        "container/basket",
        "A waste-paper basket of wire, open at the top.",
        "any side; it is round",
    )
    body, floor, count = asset.body(), 0.006, 28
    wires = [
        tube([(bottom, 0.0, 0.004), (top - 0.002, 0.0, height - 0.006)], 0.0022, 6).turned("Z", 360.0 * k / count)
        for k in range(count)
    ]
    hoops = [
        annulus(r + 0.003, r - 0.0015, 0.005, (0.0, 0.0, z), sides=40)
        for r, z in ((0.108, 0.075), (0.117, 0.15), (0.126, 0.225))
    ]
    body.add(join([*wires, *hoops]), mesh)
    body.add(annulus(top + 0.002, top - 0.006, 0.014, (0.0, 0.0, height - 0.007), sides=40), rim, mass=0.22)
    body.add(cylinder(bottom + 0.003, floor, sides=40), rim, mass=0.3)
    body.collide("floor", mesh, drum(bottom + 0.003, 0.0, floor))
    body.collide("wall", mesh, *staves((bottom - 0.003, top - 0.006), 0.006, floor, height, 16))
    body.anchors = {"top": (0.0, 0.0, height), "inside": (0.0, 0.0, floor)}
    edge = inscribed(bottom - 0.003)
    asset.hollow = ((edge, edge, height - floor), (0.0, 0.0, (height + floor) / 2))
    return asset


def whiteboard(width: float = 1.2, tall: float = 0.9, height: float = 1.85) -> Asset:
    """A whiteboard on a stand, with a drawing and pens."""
    white = Paint("board", STEEL, (0.88, 0.89, 0.88), 0.2)
    frame = Paint("frame", ALUMINIUM, (0.42, 0.43, 0.45), 0.4, 0.5)
    blue = Paint("blue_ink", ABS, (0.03, 0.08, 0.50))
    red = Paint("red_ink", ABS, (0.60, 0.03, 0.03))
    asset = Asset(
        "whiteboard",
        ["whiteboard", "white board", "marker board", "dry erase board", "flip chart", "flipchart"],
        "furniture/whiteboard",
        "A whiteboard on a stand with two feet, and a tray with pens.",
        "the side that is written on",
    )
    body, middle, edge = asset.body(), height - tall / 2, 0.03
    body.add(box((0.018, width - 2 * edge, tall - 2 * edge), (0.0, 0.0, middle)), white, mass=9.0)
    rails = [box((0.03, width, edge), (0.0, 0.0, middle + j * (tall - edge) / 2)) for j in (-1, 1)]
    rails += [box((0.03, edge, tall - 2 * edge), (0.0, j * (width - edge) / 2, middle)) for j in (-1, 1)]
    rails += [box((0.07, width * 0.6, 0.012), (0.045, 0.0, middle - tall / 2 + 0.008))]
    body.add(join(rails), frame, mass=2.5)
    low = middle - tall / 2
    for j, side in ((-1, "right"), (1, "left")):
        y = j * (width / 2 - 0.08)
        boards(
            body, frame, {f"post_{side}": ((0.03, 0.05, low - 0.04), (0.0, y, 0.04 + (low - 0.04) / 2))}, 0.35 * 2700
        )
        boards(body, frame, {f"foot_{side}": ((0.6, 0.06, 0.04), (0.0, y, 0.02))}, 2700.0)
    body.add(box((0.025, width - 0.16, 0.04), (0.0, 0.0, 0.3)), frame, 0.35 * 2700.0)
    curve = [(0.0095, 0.42 - 0.04 * k, middle - 0.15 + 0.0035 * k * k) for k in range(12)]
    body.add(tube(curve, 0.006, 6), red, 0.0)
    axes = [box((0.02, 0.012, 0.42), (0.0, 0.46, middle + 0.02)), box((0.02, 0.5, 0.012), (0.0, 0.21, middle - 0.19))]
    text = [
        box((0.02, w, 0.02), (0.0, -0.08 - w / 2, middle + z)) for w, z in ((0.38, 0.26), (0.3, 0.19), (0.34, 0.12))
    ]
    pen = tube([(0.06, 0.1, low + 0.022), (0.06, 0.22, low + 0.022)], 0.009, 8)
    body.add(join([*axes, *text, pen]), blue, 0.0)
    body.add(tube([(0.06, -0.18, low + 0.022), (0.06, -0.06, low + 0.022)], 0.009, 8), red, 0.0)
    body.collide("board", white, block((0.03, width, tall), (0.0, 0.0, middle)))
    body.collide("tray", frame, block((0.07, width * 0.6, 0.012), (0.045, 0.0, low + 0.008)))
    body.anchors = {"board": (0.015, 0.0, middle), "tray": (0.05, 0.0, low + 0.014)}
    return asset


def book(height: float = 0.235, width: float = 0.155, thick: float = 0.035) -> Asset:
    """A bound book that lies on its back cover: its spine is at -Y."""
    cover = Paint("cover", PAPER, (0.36, 0.03, 0.03), 0.6)
    pages = Paint("pages", PAPER, (0.85, 0.80, 0.66), 0.9)
    gold = Paint("title", PAPER, (0.75, 0.52, 0.14), 0.4, 0.6)
    asset = Asset(
        "book",
        ["book", "hardcover", "hardback book", "novel", "textbook"],
        "stationery/book",
        "A bound book that lies flat.",
        "the foot of its pages; its spine is at -Y",
    )
    body, board = asset.body(), 0.003
    covers = [box((height, width, board), (0.0, 0.0, z)) for z in (board / 2, thick - board / 2)]
    back = [
        (-0.0, -thick / 2),
        (0.004, -thick / 2),
        (0.004, thick / 2),
        (0.0, thick / 2),
        (-0.0045, thick / 4),
        (-0.0045, -thick / 4),
    ]
    spine = extrude([(x, z) for x, z in back], height).turned("Z", 90.0).moved(0.0, -width / 2, thick / 2)
    body.add(join([*covers, spine]), cover, 900.0)
    body.add(box((height - 0.008, width - 0.006, thick - 2 * board), (0.0, 0.0, thick / 2)), pages)
    marks = [box((0.016, 0.1, 0.0012), (x, 0.005, thick)) for x in (-0.065, -0.035)]
    marks += [
        box((0.006, 0.06, 0.0012), (0.075, 0.005, thick)),
        box((0.018, 0.002, 0.018), (0.0, -width / 2 - 0.0042, thick / 2)),
    ]
    marks += [box((0.003, width - 0.03, 0.0012), (i * (height / 2 - 0.014), 0.003, thick)) for i in (-1, 1)]
    body.add(join(marks), gold, 0.0)
    body.collide("book", cover, block((height, width + 0.004, thick), (0.0, -0.002, thick / 2)))
    body.anchors = {"top": (0.0, 0.0, thick)}
    return asset
