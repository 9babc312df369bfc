"""Things with a screen, and a lamp."""

from __future__ import annotations

from .asset import Asset
from .matter import ABS, ALUMINIUM, CAST_IRON, LINEN, STEEL, Paint
from .parts import Mesh, block, box, drum, hull, join, lathe

SCREEN = (0.02, 0.09, 0.24)
GLOW = (0.10, 0.38, 0.72)


def laptop(width: float = 0.32, depth: float = 0.22, lean: float = 18.0) -> Asset:
    """An open laptop, its screen leaning back by `lean` [deg]; the mass of its parts is that of usual ones."""
    case = Paint("case", ALUMINIUM, (0.42, 0.43, 0.45), 0.4, 0.3)
    black = Paint("keys", ABS, (0.015, 0.015, 0.018))
    glass = Paint("screen", ABS, SCREEN, 0.2)
    window = Paint("screen_window", ABS, GLOW, 0.2)
    asset = Asset(
        "laptop",
        ["laptop", "laptop computer", "notebook computer", "notebook", "portable computer"],
        "electronics/laptop",
        "An open laptop computer.",
        "the side of the keyboard, where one sits; the screen faces it",
    )
    body, base, lid, tall = asset.body(), 0.016, 0.008, 0.212
    low = -depth / 2
    body.add(box((depth, width, base - 0.002), (0.0, 0.0, base / 2 + 0.001)), case, 1.0 / (depth * width * base))
    feet = [box((0.012, width - 0.06, 0.002), (x, 0.0, 0.001)) for x in (low + 0.02, -low - 0.02)]
    body.add(join(feet), black, 0.0)
    pitch = (width - 0.03) / 14
    keys = [
        box((0.0155, pitch * 0.84, 0.003), (low + 0.034 + 0.0185 * row, -width / 2 + 0.015 + pitch * (k + 0.5), base))
        for row in range(5)
        for k in range(14)
        if row < 4 or k not in range(5, 9)
    ]
    space = box((0.0155, pitch * 3.84, 0.003), (low + 0.034 + 0.0185 * 4, -width / 2 + 0.015 + pitch * 7, base))
    body.add(join([*keys, space]), black, 0.0)
    pad = box((0.062, 0.1, 0.01), (depth / 2 - 0.043, 0.0, base - 0.0045))
    body.add(pad, Paint("touch_pad", ABS, (0.25, 0.25, 0.27)), 0.0)

    def hinged(mesh: Mesh) -> Mesh:
        return mesh.turned("Y", -lean).moved(low + 0.012, 0.0, base - 0.002)

    body.add(hinged(box((lid, width, tall), (-lid / 2, 0.0, tall / 2 + 0.003))), case, 0.45 / (lid * width * tall))
    view = (0.004, width - 0.016, tall - 0.03)
    body.add(hinged(box((view[0], view[1] + 0.008, view[2] + 0.01), (-0.0015, 0.0, tall / 2 + 0.006))), black, 0.0)
    body.add(hinged(box(view, (-0.0007, 0.0, tall / 2 + 0.006))), glass, 0.0)
    body.add(hinged(box((0.004, 0.15, 0.09), (-0.0002, 0.03, tall / 2 + 0.012))), window, 0.0)
    body.collide("base", case, block((depth, width, base), (0.0, 0.0, base / 2)))
    middle = hinged(box((lid, width, tall), (-lid / 2, 0.0, tall / 2 + 0.003))).points.mean(axis=0)
    center = (float(middle[0]), float(middle[1]), float(middle[2]))
    body.collide("lid", case, block((lid, width, tall), center, "Y", -lean))
    eye = hinged(box((0.0, 0.0, 0.0), (0.001, 0.0, tall / 2 + 0.006))).points[0]
    body.anchors = {"keyboard": (low + 0.07, 0.0, base), "screen": (float(eye[0]), 0.0, float(eye[2]))}
    return asset


def monitor(width: float = 0.54, tall: float = 0.32, height: float = 0.47) -> Asset:
    """A desktop screen of 24 inches on a stand; the panel weighs 2.9 kg with its electronics."""
    black = Paint("case", ABS, (0.02, 0.02, 0.023), 0.4)
    glass = Paint("screen", ABS, SCREEN, 0.2)
    window = Paint("screen_window", ABS, GLOW, 0.2)
    metal = Paint("stand", STEEL, (0.20, 0.20, 0.21), 0.4, 0.5)
    asset = Asset(
        "monitor",
        ["monitor", "screen", "display", "computer monitor", "computer screen", "flat screen", "television", "tv"],
        "electronics/monitor",
        "A computer monitor of 24 inches on a stand.",
        "the side of the screen",
    )
    body, thick, deep, front = asset.body(), 0.022, 0.2, 0.03
    middle = height - tall / 2
    panel = box((thick, width, tall), (front - thick / 2, 0.0, middle))
    body.add(panel, black, 2.4 / (thick * width * tall))
    bulge = box((0.025, 0.3, 0.2), (front - thick - 0.0125, 0.0, middle))
    body.add(bulge, black, 0.5 / (0.025 * 0.3 * 0.2))
    body.add(box((0.008, width - 0.018, tall - 0.028), (front - 0.0035, 0.0, middle + 0.005)), glass, 0.0)
    pane = [((0.22, 0.16), (-0.1, 0.02)), ((0.17, 0.11), (0.13, -0.04))]
    panes = [box((0.008, w, h), (front - 0.003, y, middle + z)) for (w, h), (y, z) in pane]
    body.add(join(panes), window, 0.0)
    body.add(box((deep, 0.24, 0.008), (0.0, 0.0, 0.004)), metal, 1.3 / (deep * 0.24 * 0.008))
    neck = box((0.02, 0.06, middle), (front - thick - 0.035, 0.0, middle / 2))
    body.add(neck, metal, 0.5 / (0.02 * 0.06 * middle))
    body.collide("foot", metal, block((deep, 0.24, 0.008), (0.0, 0.0, 0.004)))
    body.collide("neck", metal, block((0.02, 0.06, middle), (front - thick - 0.035, 0.0, middle / 2)))
    body.collide("panel", black, block((thick, width, tall), (front - thick / 2, 0.0, middle)))
    body.anchors = {"screen": (front, 0.0, middle), "top": (front - thick / 2, 0.0, height)}
    return asset


def lamp(height: float = 0.46, shade: float = 0.14) -> Asset:
    """A table lamp; its foot of cast iron holds it."""
    iron = Paint("foot", CAST_IRON, (0.05, 0.07, 0.09), 0.4)
    brass = Paint("stem", STEEL, (0.55, 0.38, 0.12), 0.3, 0.9)
    cloth = Paint("shade", LINEN, (0.85, 0.68, 0.40), 0.9)
    bulb = Paint("bulb", ABS, (1.0, 0.93, 0.70), 0.2)
    asset = Asset(
        "lamp",
        ["lamp", "table lamp", "desk lamp", "bedside lamp", "light", "reading lamp"],
        "furnishing/lamp",
        "A table lamp: a cloth shade over a brass stem on a foot of cast iron.",
        "any side; it is round",
    )
    body, foot, low, wall = asset.body(), 0.075, 0.26, 0.003
    body.add(lathe([(0.0, 0.0), (foot, 0.0), (foot, 0.012), (0.02, 0.028), (0.0, 0.03)]), iron)
    stem = [
        (0.0, 0.03),
        (0.009, 0.03),
        (0.009, 0.09),
        (0.022, 0.12),
        (0.024, 0.145),
        (0.009, 0.18),
        (0.009, 0.29),
        (0.0, 0.29),
    ]
    body.add(lathe(stem, 16), brass, 0.25 * STEEL.density)  # a tube
    glass = [(0.0, 0.29), (0.015, 0.3), (0.03, 0.34), (0.03, 0.36), (0.018, 0.385), (0.0, 0.392)]
    body.add(lathe(glass, 16), bulb, 300.0)
    top = 0.085
    cone = [(shade, low), (top, height), (top - wall, height), (shade - wall, low)]
    body.add(lathe(cone), cloth)
    spokes = [box((2 * top - 0.004, 0.005, 0.005), (0.0, 0.0, height - 0.02)).turned("Z", a) for a in (0.0, 90.0)]
    body.add(join([*spokes, box((0.006, 0.006, 0.06), (0.0, 0.0, height - 0.05))]), brass, 0.0)
    body.collide("foot", iron, drum(foot, 0.0, 0.013))
    body.collide("stem", brass, drum(0.022, 0.013, low))
    body.collide("shade", cloth, hull(lathe([(0.0, low), (shade, low), (top, height), (0.0, height)], 20)))
    body.anchors = {"top": (0.0, 0.0, height), "light": (0.0, 0.0, 0.35)}
    return asset
