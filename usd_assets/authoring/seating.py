"""Seats and beds that are upholstered, a stool, and a chair that swivels and rolls."""

from __future__ import annotations

from .asset import Asset, Joint
from .forms import around, cone, cushion, cylinder, globe
from .furniture import CORNERS
from .matter import ABS, BEECH, FOAM, PINE, STEEL, Paint
from .parts import ball, block, box, drum, hull, join, rod, taper, tube


def stool(height: float = 0.46, seat: float = 0.17) -> Asset:
    """A three-legged stool of beech, as stands in a workshop."""
    wood = Paint("seat", BEECH, (0.52, 0.28, 0.11))
    leg = Paint("legs", BEECH, (0.33, 0.16, 0.06))
    asset = Asset(
        "stool",
        ["stool", "wooden stool", "three-legged stool", "milking stool", "footstool"],
        "furniture/stool",
        "A round wooden stool on three splayed legs.",
        "any side; it is round",
    )
    body, board = asset.body(), 0.032
    body.add(cone(seat - 0.01, seat, board, (0.0, 0.0, height - board)), wood)
    stick = tube([(0.165, 0.0, 0.0), (0.1, 0.0, height - board)], 0.017, 12)
    flat = stick.points.copy()
    flat[:12, 2] = 0.0  # sawn level with the floor
    legs = around(type(stick)(flat, stick.faces), 3)
    body.add(join(legs), leg)
    bar = tube([(0.13, 0.0, 0.18), (-0.0650, 0.1126, 0.18)], 0.009, 8)
    body.add(join(around(bar, 3)), leg)
    body.collide("seat", wood, drum(seat, height - board, height))
    body.collide("leg", leg, *(hull(each) for each in legs))
    body.anchors = {"seat": (0.0, 0.0, height), "top": (0.0, 0.0, height)}
    return asset


def _upholstered(asset: Asset, seats: int, color: tuple[float, float, float], mass: float) -> Asset:
    cloth = Paint("cloth", FOAM, color, 0.9)
    cushions = Paint("cushions", FOAM, tuple(min(1.0, 1.35 * c + 0.01) for c in color), 0.95)  # type: ignore[arg-type]
    feet = Paint("feet", BEECH, (0.10, 0.05, 0.02))
    body, foot, deep, arm, wide = asset.body(), 0.1, 0.88, 0.18, 0.62
    width = seats * wide + 2 * arm
    under = cushion((deep, width, 0.2), (0.0, 0.0, foot + 0.1), 0.02)
    back = cushion((0.24, width - 0.02, 0.72), (-deep / 2 + 0.12, 0.0, foot + 0.36), 0.05)
    arms = [cushion((deep - 0.02, arm, 0.5), (0.01, j * (width - arm) / 2, foot + 0.25), 0.05) for j in (-1, 1)]
    body.add(join([under, back, *arms]), cloth, mass=0.75 * mass)
    soft = []
    for k in range(seats):
        y = (k - (seats - 1) / 2) * wide
        soft.append(cushion((deep - 0.24, wide - 0.01, 0.15), (0.12, y, foot + 0.27), 0.04))
        soft.append(cushion((0.16, wide - 0.02, 0.4), (-0.13, y, foot + 0.55), 0.06))
    body.add(join(soft), cushions, mass=0.22 * mass)
    legs = [(i * (deep / 2 - 0.07), j * (width / 2 - 0.08)) for i, j in CORNERS]
    body.add(join(taper((0.035, 0.035), (0.055, 0.055), foot, (x, y, 0.0)) for x, y in legs), feet)
    body.collide("foot", feet, *(block((0.045, 0.045, foot), (x, y, foot / 2)) for x, y in legs))
    seat = foot + 0.345
    body.collide("seat", cushions, block((deep, width, seat - foot), (0.0, 0.0, (seat + foot) / 2)))
    body.collide("back", cloth, block((0.38, width - 0.04, 0.72), (-deep / 2 + 0.2, 0.0, foot + 0.36)))
    for j, side in ((-1, "right"), (1, "left")):
        body.collide(f"arm_{side}", cloth, block((deep - 0.02, arm, 0.5), (0.01, j * (width - arm) / 2, foot + 0.25)))
    body.anchors = {"seat": (0.12, 0.0, seat), "back": (-0.05, 0.0, seat + 0.2)}
    return asset


def sofa() -> Asset:
    """A sofa for three."""
    asset = Asset(
        "sofa",
        ["sofa", "couch", "settee", "three-seat sofa", "living room sofa"],
        "furniture/sofa",
        "An upholstered sofa for three, with armrests and loose cushions.",
        "where the sitters face; the back is at -X",
    )
    return _upholstered(asset, 3, (0.06, 0.13, 0.20), 52.0)


def armchair() -> Asset:
    """An easy chair."""
    asset = Asset(
        "armchair",
        ["armchair", "easy chair", "lounge chair", "upholstered chair"],
        "furniture/armchair",
        "An upholstered armchair with loose cushions.",
        "where the sitter faces; the back is at -X",
    )
    return _upholstered(asset, 1, (0.34, 0.07, 0.03), 26.0)


def bed(length: float = 2.06, width: float = 1.5) -> Asset:
    """A double bed with its mattress, pillows and a blanket."""
    wood = Paint("frame", PINE, (0.42, 0.22, 0.09))
    sheet = Paint("mattress", FOAM, (0.80, 0.79, 0.75), 0.95)
    pillow = Paint("pillows", FOAM, (0.88, 0.87, 0.85), 0.95)
    quilt = Paint("blanket", FOAM, (0.10, 0.20, 0.36), 0.95)
    asset = Asset(
        "bed",
        ["bed", "double bed", "bedstead"],
        "furniture/bed",
        "A double bed of wood with a mattress, two pillows and a blanket.",
        "the foot end; the headboard is at -X",
    )
    body, high, rail, post = asset.body(), 0.95, 0.03, 0.07
    head, foot = -length / 2, length / 2
    parts = [box((0.04, width - 0.02, 0.6), (head + 0.035, 0.0, high - 0.32))]
    parts += [box((0.04, width - 0.02, 0.3), (foot - 0.035, 0.0, 0.37))]
    for j in (-1, 1):
        y = j * (width - post) / 2
        parts += [
            box((post, post, high), (head + post / 2, y, high / 2)),
            box((post, post, 0.55), (foot - 0.035, y, 0.275)),
        ]
        parts += [box((length - 2 * post, rail, 0.2), (0.0, j * (width - rail) / 2, 0.32))]
    slats = [box((0.09, width - 2 * rail, 0.02), (head + 0.2 + 0.18 * k, 0.0, 0.3)) for k in range(10)]
    body.add(join([*parts, *slats]), wood)
    deep = length - 2 * post - 0.02
    body.add(cushion((deep, width - 2 * rail - 0.01, 0.22), (0.0, 0.0, 0.42), 0.03), sheet, mass=22.0)
    top = 0.53
    places = [(-deep / 2 + 0.24, j * 0.36, top + 0.06) for j in (-1, 1)]
    body.add(join(cushion((0.42, 0.62, 0.13), at, 0.055) for at in places), pillow, mass=1.8)
    cover = cushion((deep * 0.68, width - 0.08, 0.05), (deep * 0.155, 0.0, top + 0.02), 0.02)
    body.add(cover, quilt, mass=2.5)
    legs = [(head + post / 2, high), (foot - post / 2, 0.55)]
    for (x, tall), end in zip(legs, ("head", "foot"), strict=True):
        for j, side in ((-1, "right"), (1, "left")):
            body.collide(f"post_{end}_{side}", wood, block((post, post, tall), (x, j * (width - post) / 2, tall / 2)))
        board = (post, width - 2 * post, tall - 0.22)
        body.collide(f"board_{end}", wood, block(board, (x, 0.0, 0.2 + board[2] / 2)))
    body.collide("mattress", sheet, block((length - 2 * post, width, top - 0.22), (0.0, 0.0, (top + 0.22) / 2)))
    body.collide("pillow", pillow, *(block((0.4, 0.58, 0.11), (x, y, z)) for x, y, z in places))
    body.anchors = {"top": (0.2, 0.0, top + 0.045), "pillow": places[0]}
    return asset


def office_chair(seat: float = 0.48) -> Asset:
    """A desk chair: it swivels on its column and rolls on five ball castors."""
    black = Paint("frame", ABS, (0.02, 0.02, 0.022), 0.5)
    cloth = Paint("cloth", FOAM, (0.05, 0.08, 0.13), 0.9)
    steel = Paint("column", STEEL, (0.45, 0.45, 0.47), 0.3, 0.8)
    castor = Paint("castors", ABS, (0.10, 0.10, 0.11), 0.3)
    asset = Asset(
        "office_chair",
        ["office chair", "swivel chair", "desk chair", "rolling chair", "computer chair"],
        "furniture/chair",
        "An office chair: a seat that swivels on a five-armed foot with castors that roll.",
        "where the sitter faces; the back is at -X",
    )
    base, reach, small = asset.body("stand"), 0.3, 0.03
    arm = tube([(0.03, 0.0, 0.115), (0.16, 0.0, 0.105), (reach + 0.012, 0.0, 0.085)], 0.017, 8)
    base.add(join(around(arm, 5)), black, mass=2.2)
    base.add(cylinder(0.035, 0.09, (0.0, 0.0, 0.08)), black, mass=1.0)
    base.add(cylinder(0.014, 0.25, (0.0, 0.0, 0.17), sides=16), steel, mass=1.6)
    hoods = [globe(small + 0.004, (reach, 0.0, small + 0.012), 12, 6)]
    hoods[0].points[:, 2] = hoods[0].points[:, 2].clip(min=small + 0.012)
    base.add(join(around(hoods[0], 5)), black, mass=0.3)
    base.collide("column", steel, drum(0.03, 0.09, seat - 0.06))
    for k, end in enumerate(around(box((0.0, 0.0, 0.0), (reach, 0.0, small)), 5)):
        at = (float(end.points[0, 0]), float(end.points[0, 1]), small)
        base.collide(f"arm_{k}", black, rod((at[0] / 9, at[1] / 9, 0.115), (at[0], at[1], 0.085), 0.017))
        wheel = asset.body(f"castor_{k}", at)
        wheel.add(globe(small, at, 16, 8), castor, mass=0.11)
        wheel.collide("ball", castor, ball(small, at))
        asset.joints.append(Joint(f"castor_joint_{k}", "stand", f"castor_{k}", at, kind="Spherical"))
    _swivelling(asset, seat, black, cloth)
    asset.joints.append(Joint("swivel", "stand", "upper", (0.0, 0.0, seat - 0.09), "Z", None, 0.5))
    return asset


def _swivelling(asset: Asset, seat: float, black: Paint, cloth: Paint) -> None:
    upper = asset.body("upper", (0.0, 0.0, seat - 0.09))
    upper.add(cushion((0.48, 0.48, 0.08), (0.02, 0.0, seat - 0.04), 0.03), cloth, mass=2.2)
    upper.add(box((0.24, 0.2, 0.03), (0.0, 0.0, seat - 0.09)), black, mass=1.6)
    upper.add(
        cushion((0.07, 0.44, 0.52), (0.0, 0.0, 0.0), 0.03).turned("Y", -10.0).moved(-0.245, 0.0, seat + 0.38),
        cloth,
        mass=1.6,
    )
    spine = [(-0.06, 0.0, seat - 0.09), (-0.25, 0.0, seat - 0.085), (-0.275, 0.0, seat), (-0.285, 0.0, seat + 0.4)]
    upper.add(tube(spine, 0.018, 8), black, mass=0.8)
    upper.collide("seat", cloth, block((0.48, 0.48, 0.1), (0.02, 0.0, seat - 0.05)))
    upper.collide("back", cloth, block((0.075, 0.44, 0.52), (-0.245, 0.0, seat + 0.38), "Y", -10.0))
    for j, side in ((-1, "right"), (1, "left")):
        y = j * 0.275
        rest = [(0.0, y - j * 0.06, seat - 0.09), (0.0, y, seat - 0.07), (0.0, y, seat + 0.17)]
        upper.add(tube(rest, 0.014, 8), black, mass=0.3)
        upper.add(cushion((0.26, 0.06, 0.035), (0.02, y, seat + 0.18), 0.012), black, mass=0.25)
        upper.collide(f"armrest_{side}", black, block((0.26, 0.06, 0.035), (0.02, y, seat + 0.18)))
    upper.anchors = {"seat": (0.03, 0.0, seat), "back": (-0.21, 0.0, seat + 0.3)}
