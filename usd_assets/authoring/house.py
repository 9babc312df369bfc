"""What stands in a house beside its seats and tables: cases with doors, machines, and things to look at."""

from __future__ import annotations

from .asset import Asset, Joint
from .doors import RUBS, leaf
from .forms import annulus, cylinder, globe
from .furniture import boards
from .matter import ABS, CAST_IRON, FIBREBOARD, GLASS, LINEN, PINE, PORCELAIN, STEEL, Paint
from .parts import Point, block, box, drum, hull, join, lathe, prism, tube
from .rounds import vessel


def _case(size: Point, wall: float, deep: float, low: float) -> dict[str, tuple[Point, Point]]:
    """Boards (size, centre) of a case that is open in front, from height `low` up; `deep` of its depth is the case."""
    x, y, z = size
    middle, tall = -(x - deep) / 2, z - low
    return {
        "back": ((wall, y, tall), (-x / 2 + wall / 2, 0.0, low + tall / 2)),
        "bottom": ((deep - wall, y - 2 * wall, wall), (middle + wall / 2, 0.0, low + wall / 2)),
        "top": ((deep - wall, y - 2 * wall, wall), (middle + wall / 2, 0.0, z - wall / 2)),
        "right": ((deep - wall, wall, tall), (middle + wall / 2, -(y - wall) / 2, low + tall / 2)),
        "left": ((deep - wall, wall, tall), (middle + wall / 2, (y - wall) / 2, low + tall / 2)),
    }


def wardrobe(width: float = 1.2, depth: float = 0.6, height: float = 2.0) -> Asset:
    """A wardrobe with two hinged doors, a rail for hangers and a board above it."""
    wood = Paint("oak", PINE, (0.36, 0.18, 0.075))
    light = Paint("doors", FIBREBOARD, (0.50, 0.29, 0.13))
    metal = Paint("grips", STEEL, (0.55, 0.55, 0.57), 0.3, 0.8)
    asset = Asset(
        "wardrobe",
        ["wardrobe", "closet", "armoire", "clothes cupboard"],
        "furniture/wardrobe",
        "A wooden wardrobe with two doors that open on hinges.",
        "the side of the doors",
    )
    case, board, door, foot = asset.body("stand"), 0.02, 0.02, 0.06
    deep = depth - door
    boards(case, wood, _case((depth, width, height), board, deep, foot))
    boards(case, wood, {"plinth": ((deep - 0.04, width - 0.06, foot), (-door / 2, 0.0, foot / 2))}, 150.0)
    shelf = height - 0.35
    boards(case, wood, {"shelf": ((deep - board, width - 2 * board, board), (-door / 2 + board / 2, 0.0, shelf))})
    case.add(
        tube([(0.0, -width / 2 + board, shelf - 0.08), (0.0, width / 2 - board, shelf - 0.08)], 0.012), metal, 2000.0
    )
    low, tall, gap = foot + 0.004, height - foot - 0.008, 0.002
    for j, name in ((-1, "door_right"), (1, "door_left")):
        size, y = (door, width / 2 - gap, tall), j * (width / 4 + gap / 2)
        body = leaf(asset, name, light, size, (depth / 2 - door / 2, y, low + tall / 2), j)
        grip = [(depth / 2, j * 0.05, 0.95), (depth / 2 + 0.035, j * 0.05, 0.97), (depth / 2 + 0.035, j * 0.05, 1.13)]
        body.add(tube([*grip, (depth / 2, j * 0.05, 1.15)], 0.007, 8), metal)
        panel = [
            box((0.006, width / 2 - 0.12, h), (depth / 2 + 0.001, j * width / 4, z))
            for h, z in ((0.75, 0.55), (0.85, 1.45))
        ]
        body.add(join(panel), wood, 0.0)
        body.anchors = {f"grip_{name}": (depth / 2, j * 0.05, 1.05)}
    case.anchors = {"top": (0.0, 0.0, height), "inside": (0.0, 0.0, foot + board)}
    free = shelf - 0.1 - foot - board
    asset.hollow = (
        (deep - board - 0.002, width - 2 * board, free),
        (-door / 2 + board / 2, 0.0, foot + board + free / 2),
    )
    return asset


def fridge(width: float = 0.6, depth: float = 0.65, height: float = 1.75) -> Asset:
    """A fridge above a freezer; both doors are hinged at +Y."""
    white = Paint("case", STEEL, (0.72, 0.73, 0.73), 0.35)
    door = Paint("doors", STEEL, (0.80, 0.81, 0.81), 0.3)
    grip = Paint("grips", STEEL, (0.30, 0.30, 0.32), 0.3, 0.7)
    glass = Paint("shelves", GLASS, (0.55, 0.65, 0.66), 0.1)
    asset = Asset(
        "fridge",
        ["fridge", "refrigerator", "fridge freezer", "icebox"],
        "appliance/fridge",
        "A fridge above a freezer, each with a door on hinges.",
        "the side of the doors",
    )
    case, wall, thick, foot = asset.body("stand"), 0.045, 0.06, 0.04
    deep, parting = depth - thick, 0.62
    boards(case, white, _case((depth, width, height), wall, deep, foot), 140.0)  # sheet steel around foam
    middle = -thick / 2
    boards(case, white, {"parting": ((deep - wall, width - 2 * wall, wall), (middle + wall / 2, 0.0, parting))}, 140.0)
    motor = (0.2, width - 2 * wall, 0.14)
    at = (middle - deep / 2 + wall + 0.1, 0.0, foot + wall + 0.07)
    boards(case, white, {"motor": (motor, at)}, 18.0 / (motor[0] * motor[1] * motor[2]))
    boards(case, grip, {"foot": ((deep - 0.06, width - 0.04, foot), (middle - 0.02, 0.0, foot / 2))}, 100.0)
    for k, z in enumerate((1.0, 1.38)):
        size = (deep - wall - 0.06, width - 2 * wall, 0.008)
        boards(case, glass, {f"shelf_{k + 2}": (size, (middle + wall / 2 - 0.03, 0.0, z))})
    gap = 0.006
    spans = {"door": (parting + gap, height - gap), "freezer_door": (foot + gap, parting - gap)}
    for name, (low, high) in spans.items():
        center = (depth / 2 - thick / 2, 0.0, (low + high) / 2)
        body = leaf(asset, name, door, (thick, width - 0.004, high - low), center, 1, mass=9.0 * (high - low))
        ends = (low + 0.06, low + 0.36) if name == "door" else (high - 0.36, high - 0.06)
        x, y = depth / 2, -width / 2 + 0.05
        bar = [
            (x - 0.01, y, ends[0]),
            (x + 0.035, y, ends[0] + 0.02),
            (x + 0.035, y, ends[1] - 0.02),
            (x - 0.01, y, ends[1]),
        ]
        body.add(tube(bar, 0.009, 8), grip)
        body.anchors = {f"grip_{name}": (x + 0.03, y, sum(ends) / 2)}
    floor = parting + wall / 2
    case.anchors = {
        "top": (middle, 0.0, height),
        "inside": (middle, 0.0, floor),
        "shelf_2": (middle - 0.03, 0.0, 1.004),
    }
    case.anchors["shelf_3"] = (middle - 0.03, 0.0, 1.384)
    free = 0.995 - floor
    asset.hollow = ((deep - wall - 0.002, width - 2 * wall, free), (middle + wall / 2, 0.0, floor + free / 2))
    return asset


def washing_machine(width: float = 0.6, depth: float = 0.56, height: float = 0.85) -> Asset:
    """A front loader; its round door is hinged at -Y. Concrete inside makes it heavy."""
    white = Paint("case", STEEL, (0.78, 0.79, 0.79), 0.35)
    grey = Paint("ring", ABS, (0.35, 0.36, 0.38), 0.3)
    glass = Paint("window", GLASS, (0.05, 0.08, 0.11), 0.1)
    dark = Paint("panel", ABS, (0.03, 0.03, 0.035), 0.3)
    asset = Asset(
        "washing_machine",
        ["washing machine", "washer", "laundry machine"],
        "appliance/washing",
        "A washing machine with a round door on a hinge.",
        "the side of the door",
    )
    case, front = asset.body("stand"), depth / 2
    case.add(box((depth, width, height), (0.0, 0.0, height / 2)), white, mass=66.0)
    case.add(box((0.012, width - 0.04, 0.11), (front, 0.0, height - 0.075)), white, 0.0)
    case.add(box((0.02, 0.16, 0.07), (front, -0.18, height - 0.075)), grey, 0.0)
    case.add(box((0.02, 0.13, 0.05), (front, 0.16, height - 0.075)), dark, 0.0)
    case.add(cylinder(0.032, 0.03, (front, 0.02, height - 0.075), "X", 24), grey, 0.0)
    case.collide("case", white, block((depth, width, height), (0.0, 0.0, height / 2)))
    z, radius = 0.44, 0.19
    door = asset.body("door", (front, -radius, z))
    door.add(annulus(radius, radius - 0.055, 0.04, (front + 0.018, 0.0, z), "X", 40), grey, mass=2.0)
    bulge = cylinder(radius - 0.05, 0.02, (front, 0.0, z), "X", 32)
    door.add(bulge, glass, mass=2.2)
    door.add(box((0.02, 0.025, 0.08), (front + 0.04, radius - 0.03, z)), dark, 0.0)
    door.collide("door", grey, hull(cylinder(radius, 0.038, (front, 0.0, z), "X", 20)))
    asset.joints = [Joint("door_hinge", "stand", "door", (front, -radius, z), "Z", (-120.0, 0.0), RUBS)]
    case.anchors = {"top": (0.0, 0.0, height)}
    door.anchors = {"door_front": (front + 0.04, 0.0, z)}
    return asset


def washbasin(height: float = 0.85) -> Asset:
    """A washbasin of porcelain on its pedestal, with a tap."""
    white = Paint("porcelain", PORCELAIN, (0.82, 0.83, 0.82), 0.2)
    chrome = Paint("tap", STEEL, (0.55, 0.56, 0.58), 0.15, 0.9)
    asset = Asset(
        "washbasin",
        ["washbasin", "wash basin", "sink", "bathroom sink", "hand basin", "washstand"],
        "appliance/washbasin",
        "A washbasin on a pedestal with a tap; the basin is open at the top.",
        "where one stands to wash; the tap is at -X",
    )
    body, radius, floor = asset.body(), 0.2, height - 0.16
    rings = [[(x * s, y * s, z) for x, y in ((0.13, -0.11), (0.13, 0.11), (-0.13, 0.11), (-0.13, -0.11))]
             for z, s in ((0.0, 1.0), (0.1, 0.85), (floor - 0.04, 0.8))]  # fmt: skip
    body.add(prism(rings), white, 0.3 * 2400.0)
    body.collide("pedestal", white, hull(prism(rings)))
    inside = [(0.09, floor), (0.16, floor + 0.05), (radius, height)]
    outside = [(0.1, floor - 0.04), (0.19, floor + 0.03), (0.25, height - 0.03), (0.25, height)]
    vessel(asset, body, white, outside, inside, 0.03, mass=11.0, count=16)
    body.add(box((0.13, 0.44, 0.05), (-0.24, 0.0, height - 0.025)), white, mass=3.0)
    body.collide("ledge", white, block((0.07, 0.44, 0.05), (-0.27, 0.0, height - 0.025)))
    spout = [
        (-0.25, 0.0, height),
        (-0.25, 0.0, height + 0.12),
        (-0.22, 0.0, height + 0.15),
        (-0.14, 0.0, height + 0.14),
        (-0.12, 0.0, height + 0.11),
    ]
    body.add(tube(spout, 0.012, 12), chrome, mass=0.7)
    knobs = [cylinder(0.022, 0.045, (-0.25, j * 0.1, height), sides=16) for j in (-1, 1)]
    body.add(join(knobs), chrome, mass=0.3)
    body.collide("tap", chrome, drum(0.014, height, height + 0.14, -0.25))
    return asset


def floor_lamp(height: float = 1.6) -> Asset:
    """A standard lamp: a drum shade on a tall stem."""
    iron = Paint("foot", CAST_IRON, (0.03, 0.03, 0.035), 0.4)
    steel = Paint("stem", STEEL, (0.40, 0.36, 0.28), 0.3, 0.8)
    cloth = Paint("shade", LINEN, (0.85, 0.74, 0.55), 0.9)
    bulb = Paint("bulb", ABS, (1.0, 0.93, 0.70), 0.2)
    asset = Asset(
        "floor_lamp",
        ["floor lamp", "standard lamp", "standing lamp"],
        "furnishing/lamp",
        "A floor lamp: a cloth shade on a tall stem with a heavy foot.",
        "any side; it is round",
    )
    body, low, shade, wall = asset.body(), height - 0.3, 0.22, 0.003
    body.add(lathe([(0.0, 0.0), (0.15, 0.0), (0.15, 0.016), (0.03, 0.03), (0.0, 0.032)]), iron, mass=6.5)
    body.add(cylinder(0.011, height - 0.22, (0.0, 0.0, 0.03), sides=16), steel, 0.3 * STEEL.density)
    body.add(globe(0.03, (0.0, 0.0, height - 0.16), 16, 8), bulb, 300.0)
    top = 0.16
    body.add(lathe([(shade, low), (top, height), (top - wall, height), (shade - wall, low)]), cloth)
    spokes = [box((2 * top - 0.004, 0.006, 0.006), (0.0, 0.0, height - 0.02)).turned("Z", a) for a in (0.0, 90.0)]
    body.add(join([*spokes, box((0.006, 0.006, 0.14), (0.0, 0.0, height - 0.085))]), steel, 0.0)
    body.collide("foot", iron, drum(0.15, 0.0, 0.017))
    body.collide("stem", steel, drum(0.014, 0.017, low))
    body.collide("shade", cloth, hull(lathe([(0.0, low), (shade, low), (top, height), (0.0, height)], 20)))
    body.anchors = {"top": (0.0, 0.0, height), "light": (0.0, 0.0, height - 0.16)}
    return asset
