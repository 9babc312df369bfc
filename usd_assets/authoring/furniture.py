"""Tables, seats and cases."""

from __future__ import annotations

from .asset import Asset, Body
from .matter import BEECH, CAST_IRON, FIBREBOARD, OAK, PINE, STEEL, Paint
from .parts import Mesh, Point, arc, block, box, extrude, join, lathe, taper, tube

CORNERS = [(x, y) for x in (-1, 1) for y in (-1, 1)]


def boards(body: Body, paint: Paint, named: dict[str, tuple[Point, Point]], density: float | None = None) -> None:
    """Boxes (size, centre) that are seen, weighed and collide alike."""
    for name, (size, center) in named.items():
        body.add(box(size, center), paint, density)
        body.collide(name, paint, block(size, center))


def table(width: float = 1.4, depth: float = 0.8, height: float = 0.75) -> Asset:
    """A dining table; `width` is along Y."""
    oak = Paint("oak", OAK, (0.40, 0.20, 0.08))
    dark = Paint("oak_frame", OAK, (0.26, 0.12, 0.05))
    asset = Asset(
        "table",
        ["table", "dining table", "kitchen table", "wooden table"],
        "furniture/table",
        "A dining table of oak with four tapered legs.",
        "a long side, where one sits",
    )
    body, top, leg, rail = asset.body(), 0.03, 0.07, 0.09
    boards(body, oak, {"top": ((depth, width, top), (0.0, 0.0, height - top / 2))})
    x, y, under = depth / 2 - 0.07, width / 2 - 0.07, height - top
    body.add(join(taper((0.045, 0.045), (leg, leg), under, (i * x, j * y, 0.0)) for i, j in CORNERS), dark)
    legs = [block((leg, leg, under), (i * x, j * y, under / 2)) for i, j in CORNERS]
    body.collide("leg", dark, *legs)
    long, short = (0.022, 2 * y - leg, rail), (2 * x - leg, 0.022, rail)
    body.add(join(box(long, (i * x, 0.0, under - rail / 2)) for i in (-1, 1)), dark)
    body.add(join(box(short, (0.0, j * y, under - rail / 2)) for j in (-1, 1)), dark)
    body.anchors = {"top": (0.0, 0.0, height), "under": (0.0, 0.0, 0.0)}
    return asset


def desk(width: float = 1.4, depth: float = 0.7, height: float = 0.74) -> Asset:
    """A writing desk with three drawers under its right end, seen by who sits at it."""
    wood = Paint("worktop", FIBREBOARD, (0.55, 0.33, 0.15))
    white = Paint("white_board", FIBREBOARD, (0.72, 0.72, 0.70))
    grip = Paint("grips", STEEL, (0.12, 0.12, 0.13), 0.3, 0.8)
    asset = Asset(
        "desk",
        ["desk", "writing desk", "office desk", "computer desk", "work desk", "workstation"],
        "furniture/desk",
        "A writing desk: a wooden top on a white side panel and a case of three drawers.",
        "the side of the drawers, where one sits",
    )
    body, top, panel, case = asset.body(), 0.028, 0.028, 0.4
    boards(body, wood, {"top": ((depth, width, top), (0.0, 0.0, height - top / 2))})
    under, deep, edge = height - top, depth - 0.06, width / 2 - 0.03
    boards(body, white, {"side": ((deep, panel, under), (0.0, -edge + panel / 2, under / 2))})
    span = 2 * edge - panel - case
    boards(body, white, {"back": ((0.018, span, 0.36), (-deep / 2 + 0.03, panel / 2 - case / 2, under - 0.18))})
    middle = edge - case / 2
    case_size, case_center = (deep, case, under), (0.0, middle, under / 2)
    # Boards and empty drawers: about a fifth of the case is wood.
    body.add(box((deep - 0.02, case, under), (-0.01, middle, under / 2)), white, 0.2 * FIBREBOARD.density)
    body.collide("case", white, block(case_size, case_center))
    gap, heights = 0.006, (0.17, 0.17, 0.34)
    z = under
    for tall in heights:
        z -= tall + gap
        body.add(box((0.02, case - 0.012, tall), (deep / 2 - 0.01, middle, z + tall / 2)), white, 0.0)
        body.add(box((0.026, 0.16, 0.014), (deep / 2 + 0.008, middle, z + tall - 0.05)), grip)
    body.anchors = {"top": (0.0, 0.0, height), "knees": (0.1, -case / 2, 0.0)}
    return asset


def chair(width: float = 0.44, seat: float = 0.45, height: float = 0.88) -> Asset:
    """A wooden kitchen chair."""
    wood = Paint("beech", BEECH, (0.48, 0.25, 0.10))
    frame = Paint("beech_frame", BEECH, (0.33, 0.16, 0.06))
    asset = Asset(
        "chair",
        ["chair", "seat", "kitchen chair", "dining chair", "wooden chair"],
        "furniture/chair",
        "A wooden chair with a slatted back.",
        "where the sitter faces; the back is at -X",
    )
    body, board, leg = asset.body(), 0.025, 0.038
    x = y = width / 2 - leg / 2
    boards(body, wood, {"seat": ((width + 0.02, width, board), (0.01, 0.0, seat - board / 2))})
    for j, side in ((-1, "right"), (1, "left")):
        tall = seat - board
        boards(body, frame, {f"front_leg_{side}": ((leg, leg, tall), (x, j * y, tall / 2))})
        boards(body, frame, {f"back_leg_{side}": ((leg, leg, tall), (-x, j * y, tall / 2))})
        # The upright leans back by 8 degrees above the seat.
        upright = box((leg, leg, height - seat), (0.0, 0.0, (height - seat) / 2)).turned("Y", -8.0)
        body.add(upright.moved(-x + 0.004, j * y, seat), frame)
        for z in (0.12, 0.3):
            body.add(box((2 * x - leg, 0.018, 0.025), (0.0, j * y, z)), frame)
    body.add(box((0.018, 2 * y - leg, 0.025), (x, 0.0, 0.2)), frame)
    lean = box((0.02, 2 * y - leg, 0.075), (0.0, 0.0, 0.385)).turned("Y", -8.0).moved(-x + 0.004, 0.0, seat)
    rail = box((0.02, 2 * y - leg, 0.05), (0.0, 0.0, 0.105)).turned("Y", -8.0).moved(-x + 0.004, 0.0, seat)
    bars = (box((0.014, 0.04, 0.23), (0.0, k * 0.08, 0.238)).turned("Y", -8.0) for k in (-1.5, -0.5, 0.5, 1.5))
    body.add(lean + rail + join(bar.moved(-x + 0.004, 0.0, seat) for bar in bars), wood)
    back = (leg, width, height - seat - 0.01)
    body.collide("back", frame, block(back, (-x - 0.026, 0.0, (height + seat) / 2), "Y", -8.0))
    body.anchors = {"seat": (0.01, 0.0, seat), "back": (-x, 0.0, seat + 0.25)}
    return asset


def bench(width: float = 1.5, seat: float = 0.45, height: float = 0.82) -> Asset:
    """A park bench: wooden slats on two frames of cast iron."""
    wood = Paint("slats", PINE, (0.36, 0.15, 0.05))
    iron = Paint("iron", CAST_IRON, (0.03, 0.05, 0.035), 0.5)
    asset = Asset(
        "bench",
        ["bench", "park bench", "garden bench", "wooden bench"],
        "furniture/bench",
        "A park bench: wooden slats on two frames of cast iron, with a back and armrests.",
        "where the sitter faces; the back is at -X",
    )
    body, slat = asset.body(), 0.03
    for k in range(4):
        size, center = (0.085, width, slat), (-0.11 + k * 0.1, 0.0, seat - slat / 2)
        boards(body, wood, {f"seat_{k}": (size, center)})
    for k in range(3):
        at = (-0.205 - 0.022 * k, 0.0, seat + 0.12 + 0.105 * k)
        body.add(box((slat, width, 0.085)).turned("Y", -12.0).moved(*at), wood)
        body.collide(f"back_{k}", wood, block((slat, width, 0.085), at, "Y", -12.0))
    for j, side in ((-1, "right"), (1, "left")):
        y, thick = j * (width / 2 - 0.15), 0.04
        body.add(_bench_frame(seat - slat, height, thick).moved(y=y), iron)
        armrest = [(0.22, y, seat), *arc((0.16, y, seat + 0.13), 0.06, 0.0, 90.0, 5, "XZ"), (-0.22, y, seat + 0.19)]
        body.add(tube(armrest, 0.014), iron)
        body.collide(f"foot_front_{side}", iron, block((0.05, thick, seat - slat), (0.2, y, (seat - slat) / 2)))
        body.collide(f"foot_back_{side}", iron, block((0.05, thick, seat - slat), (-0.2, y, (seat - slat) / 2)))
        body.collide(f"armrest_{side}", iron, block((0.36, 0.028, 0.03), (-0.01, y, seat + 0.19)))
    body.anchors = {"seat": (0.04, 0.0, seat), "back": (-0.2, 0.0, seat + 0.2)}
    return asset


def _bench_frame(under: float, height: float, thick: float) -> Mesh:
    front = extrude([(0.175, 0.0), (0.225, 0.0), (0.215, under), (0.185, under)], thick)
    back = extrude([(-0.225, 0.0), (-0.175, 0.0), (-0.185, under), (-0.215, under)], thick)
    across = box((0.37, thick, 0.04), (0.0, 0.0, under - 0.02))
    brace = box((0.38, thick * 0.6, 0.025), (0.0, 0.0, 0.12))
    post = box((0.03, thick, height - under), (0.0, 0.0, (height - under) / 2)).turned("Y", -12.0)
    return front + back + across + brace + post.moved(-0.2, 0.0, under - 0.003)


def shelf(width: float = 0.8, depth: float = 0.3, height: float = 1.8, rooms: int = 5) -> Asset:
    """A bookcase, open in front."""
    wood = Paint("pine", PINE, (0.62, 0.40, 0.20))
    back = Paint("back_board", FIBREBOARD, (0.45, 0.28, 0.14))
    asset = Asset(
        "shelf",
        ["shelf", "shelves", "bookcase", "bookshelf", "book case", "shelving", "rack"],
        "furniture/shelf",
        "A bookcase of pine with five rooms, open in front.",
        "the open side",
    )
    body, board, plinth, thin = asset.body(), 0.022, 0.06, 0.008
    inner = width - 2 * board
    sides = {
        side: ((depth, board, height), (0.0, j * (width - board) / 2, height / 2))
        for j, side in ((-1, "right"), (1, "left"))
    }
    boards(body, wood, sides)
    boards(body, back, {"back": ((thin, inner, height - plinth), (-(depth - thin) / 2, 0.0, (height + plinth) / 2))})
    boards(body, wood, {"plinth": ((0.015, inner, plinth), (depth / 2 - 0.02, 0.0, plinth / 2))})
    step = (height - plinth - board) / rooms
    deep, x = depth - thin, thin / 2
    for k in range(rooms + 1):
        low = plinth + k * step
        boards(body, wood, {f"board_{k}": ((deep, inner, board), (x, 0.0, low + board / 2))})
        if k < rooms:
            body.anchors[f"shelf_{k + 1}"] = (x, 0.0, low + board)
    body.anchors["top"] = (0.0, 0.0, height)
    floor = plinth + (rooms // 2) * step + board
    asset.hollow = ((deep, inner, step - board), (x, 0.0, floor + (step - board) / 2))
    return asset


def cabinet(width: float = 0.9, depth: float = 0.45, height: float = 0.85) -> Asset:
    """A sideboard with two closed doors below an open room."""
    wood = Paint("walnut", OAK, (0.22, 0.10, 0.045))
    door = Paint("doors", FIBREBOARD, (0.50, 0.55, 0.50))
    knob = Paint("knobs", STEEL, (0.60, 0.48, 0.25), 0.3, 0.9)
    asset = Asset(
        "cabinet",
        ["cabinet", "cupboard", "sideboard", "dresser", "commode"],
        "furniture/cabinet",
        "A sideboard: two closed doors, and above them a room that is open in front.",
        "the side of the doors",
    )
    body, board, foot, room = asset.body(), 0.02, 0.1, 0.24
    low, inner, deep = foot, width - 2 * board, depth - board
    tall = height - foot
    boards(body, wood, {"top": ((depth, width, board), (0.0, 0.0, height - board / 2))})
    boards(body, wood, {"bottom": ((deep, inner, board), (-board / 2, 0.0, low + board / 2))})
    for j, side in ((-1, "right"), (1, "left")):
        boards(
            body,
            wood,
            {side: ((deep, board, tall - board), (-board / 2, j * (width - board) / 2, foot + (tall - board) / 2))},
        )
    floor = height - board - room
    boards(body, wood, {"middle": ((deep, inner, board), (-board / 2, 0.0, floor - board / 2))})
    back = (0.008, inner, tall - 2 * board)
    boards(body, wood, {"back": (back, (-depth / 2 + 0.004, 0.0, foot + tall / 2))})
    for i, j in CORNERS:
        at = (i * (depth / 2 - 0.05), j * (width / 2 - 0.06), 0.0)
        body.add(taper((0.028, 0.028), (0.045, 0.045), foot, at), wood)
        body.collide(
            f"foot_{'back' if i < 0 else 'front'}_{'right' if j < 0 else 'left'}",
            wood,
            block((0.04, 0.04, foot), (at[0], at[1], foot / 2)),
        )
    gap, door_low, door_high = 0.003, foot + 0.004, floor - 0.004
    for j, side in ((-1, "right"), (1, "left")):
        size = (board, width / 2 - 2 * gap, door_high - door_low)
        center = (depth / 2 - board / 2, j * width / 4, (door_high + door_low) / 2)
        boards(body, door, {f"door_{side}": (size, center)})
        body.add(_knob().moved(depth / 2, j * 0.04, (door_low + door_high) / 2 + 0.05), knob)
    body.anchors = {"top": (0.0, 0.0, height), "inside": (0.0, 0.0, floor), "behind_doors": (0.0, 0.0, low + board)}
    free = room
    asset.hollow = ((deep - 0.008, inner, free), (-board / 2 + 0.004, 0.0, floor + free / 2))
    return asset


def _knob() -> Mesh:
    return lathe([(0.0, 0.0), (0.006, 0.0), (0.006, 0.01), (0.013, 0.014), (0.013, 0.02), (0.0, 0.024)], 16).turned(
        "Y", 90.0
    )
