"""Glassware and instruments of a laboratory."""

from __future__ import annotations

from .asset import Asset, Joint
from .forms import annulus, around, cone, cylinder, globe
from .furniture import boards
from .matter import ABS, BRASS, CAST_IRON, GLASS, PINE, STEEL, Paint
from .parts import block, box, drum, extrude, hull, join, lathe, rod, tube
from .rounds import vessel

CLEAR = Paint("glass", GLASS, (0.70, 0.82, 0.84), 0.05, 0.0, 0.35)
MARKS = Paint("marks", GLASS, (0.90, 0.90, 0.88), 0.6)


def _scale(asset: Asset, radius: float, levels: list[float], width: float = 0.012) -> None:
    """Lines of a scale on the front of a vessel, the uppermost a box to write in."""
    lines = [box((0.0012, width * (1.0 if k % 2 else 0.6), 0.0012), (radius, 0.0, z)) for k, z in enumerate(levels)]
    asset.bodies[0].add(join(lines), MARKS, 0.0)


def beaker(height: float = 0.12, radius: float = 0.041) -> Asset:
    """A low beaker of 400 ml of borosilicate glass."""
    asset = Asset(
        "beaker",
        ["beaker", "glass beaker", "lab beaker", "laboratory beaker"],
        "laboratory/beaker",
        "A glass beaker with a spout and a scale, open at the top.",
        "the scale; the spout is at +Y",
    )
    body, wall, floor = asset.body(), 0.0025, 0.004
    outside = [(radius - 0.004, 0.0), (radius, 0.004), (radius, height - 0.004), (radius + 0.0025, height)]
    vessel(asset, body, CLEAR, outside, [(radius - wall, floor), (radius - wall, height)], wall, count=16)
    spout = extrude([(-0.008, height - 0.011), (0.0, height - 0.011), (0.009, height), (-0.008, height)], 0.014)
    body.add(spout.turned("Z", 90.0).moved(0.0, radius - 0.0005, 0.0), CLEAR, 0.0)
    _scale(asset, radius, [0.03 + 0.0085 * k for k in range(8)], 0.02)
    rim = annulus(radius + 0.0028, radius - 0.0024, 0.0016, (0.0, 0.0, height - 0.0008), sides=36)
    body.add(rim, MARKS, 0.0)
    return asset


def flask(height: float = 0.145, radius: float = 0.0425) -> Asset:
    """A conical flask of 250 ml (Erlenmeyer)."""
    asset = Asset(
        "flask",
        ["flask", "erlenmeyer flask", "conical flask", "lab flask", "glass flask"],
        "laboratory/flask",
        "A conical glass flask with a scale, open at the top.",
        "the scale",
    )
    body, wall, floor, neck = asset.body(), 0.0025, 0.004, 0.016
    outside = [
        (radius - 0.005, 0.0),
        (radius, 0.005),
        (radius - 0.002, 0.018),
        (neck, 0.1),
        (neck, height - 0.003),
        (neck + 0.003, height),
    ]
    inside = [(radius - 0.006, floor), (radius - wall - 0.002, 0.018), (neck - wall, 0.1), (neck - wall, height)]
    vessel(asset, body, CLEAR, outside, inside, wall, count=14)
    lines = [
        box((0.0016, 0.014, 0.0014), (radius - 0.0025 - (z - 0.018) * (radius - 0.002 - neck) / 0.082, 0.0, z))
        for z in (0.035, 0.048, 0.061, 0.074)
    ]
    body.add(join(lines), MARKS, 0.0)
    body.add(annulus(neck + 0.0032, neck - 0.002, 0.0016, (0.0, 0.0, height - 0.0008), sides=28), MARKS, 0.0)
    return asset


def test_tube_rack(count: int = 6) -> Asset:
    """A wooden rack with six tubes, four of them filled with something coloured."""
    wood = Paint("rack", PINE, (0.56, 0.37, 0.18))
    colors = ((0.60, 0.04, 0.04), (0.03, 0.14, 0.55), (0.05, 0.40, 0.08), (0.80, 0.55, 0.03))
    asset = Asset(
        "test_tube_rack",
        ["test tube rack", "test tubes", "test tube holder", "test-tube rack"],
        "laboratory/rack",
        "A wooden rack with six test tubes, four of them filled.",
        "a long side",
    )
    body, pitch, radius, tall = asset.body(), 0.032, 0.008, 0.15
    width, deep = count * pitch + 0.03, 0.07
    boards(body, wood, {"foot": ((deep, width, 0.012), (0.0, 0.0, 0.006))})
    for j, side in ((-1, "right"), (1, "left")):
        boards(body, wood, {f"side_{side}": ((deep * 0.7, 0.01, 0.1), (0.0, j * (width - 0.01) / 2, 0.062))})
    for k in range(count + 1):
        y = -width / 2 + 0.01 + k * (width - 0.02) / count
        bar = [box((deep * 0.7, pitch - 0.018, 0.008), (0.0, y, z)) for z in (0.1,)]
        body.add(join(bar), wood)
    rails = [box((0.014, width - 0.02, 0.008), (i * (deep * 0.35 - 0.007), 0.0, 0.1)) for i in (-1, 1)]
    body.add(join(rails), wood)
    body.collide("top", wood, block((deep * 0.7, width - 0.02, 0.008), (0.0, 0.0, 0.1)))
    for k in range(count):
        y = (k - (count - 1) / 2) * (width - 0.02) / count
        low = 0.014
        shell = [
            (0.0, low),
            (radius * 0.7, low + 0.003),
            (radius, low + 0.009),
            (radius, low + tall),
            (radius + 0.001, low + tall),
        ]
        inner = [(radius - 0.001, low + tall), (radius - 0.001, low + 0.009), (0.0, low + 0.003)]
        body.add(lathe([*shell, *inner], 16).moved(y=y), CLEAR)
        body.add(annulus(radius + 0.0012, radius - 0.0008, 0.0016, (0.0, y, low + tall - 0.0008), sides=16), MARKS, 0.0)
        if k < len(colors):
            fill = cylinder(radius - 0.0012, 0.045 + 0.018 * (k % 3), (0.0, y, low + 0.006), sides=14)
            body.add(fill, Paint(f"liquid_{k + 1}", ABS, colors[k], 0.2), 1000.0)
        body.collide(f"tube_{k}", CLEAR, drum(radius, low, low + tall, 0.0, y))
    body.anchors = {"rack": (0.0, 0.0, 0.104)}
    return asset


def microscope() -> Asset:
    """A microscope: foot, arm, stage, a revolver with lenses and an eyepiece."""
    white = Paint("stand", CAST_IRON, (0.62, 0.63, 0.62), 0.4)
    black = Paint("tube", STEEL, (0.03, 0.03, 0.033), 0.35, 0.3)
    steel = Paint("lenses", STEEL, (0.50, 0.51, 0.53), 0.25, 0.8)
    glass = Paint("slide", GLASS, (0.55, 0.70, 0.72), 0.1)
    asset = Asset(
        "microscope",
        ["microscope", "light microscope", "optical microscope"],
        "laboratory/microscope",
        "A microscope with a stage, three lenses and a slanted eyepiece.",
        "the stage; the eyepiece slants to -X, where one looks in",
    )
    body = asset.body()
    body.add(box((0.2, 0.15, 0.03), (0.01, 0.0, 0.015)), white, mass=1.6)
    body.add(cylinder(0.025, 0.02, (0.045, 0.0, 0.03), sides=20), black, mass=0.1)
    arm = [
        (-0.085, 0.03),
        (-0.045, 0.03),
        (-0.045, 0.2),
        (-0.01, 0.245),
        (0.06, 0.26),
        (0.06, 0.295),
        (-0.03, 0.285),
        (-0.085, 0.22),
    ]
    body.add(extrude(arm, 0.05), white, mass=1.5)
    body.add(box((0.13, 0.13, 0.012), (0.035, 0.0, 0.125)), black, mass=0.5)
    body.add(box((0.026, 0.076, 0.002), (0.045, 0.0, 0.132)), glass, 0.0)
    body.add(box((0.05, 0.04, 0.02), (-0.03, 0.0, 0.115)), black, 0.0)
    body.add(cone(0.02, 0.034, 0.03, (0.045, 0.0, 0.23), sides=20), black, mass=0.2)
    lens = cylinder(0.009, 0.045, (0.0, 0.0, -0.045), sides=14)
    for turn, tilt in ((0.0, 0.0), (120.0, 35.0), (240.0, 35.0)):
        body.add(lens.turned("Y", -tilt).turned("Z", turn).moved(0.045, 0.0, 0.235), steel, mass=0.06)
    head = tube([(0.045, 0.0, 0.26), (0.045, 0.0, 0.31), (-0.02, 0.0, 0.36)], 0.024, 16)
    body.add(head, black, mass=0.4)
    body.add(tube([(-0.02, 0.0, 0.36), (-0.046, 0.0, 0.38)], 0.018, 16), steel, mass=0.1)
    body.add(tube([(-0.046, 0.0, 0.38), (-0.054, 0.0, 0.386)], 0.021, 16), black, mass=0.03)
    for j in (-1, 1):
        body.add(cylinder(0.022, 0.02, (-0.065, j * 0.035 - 0.01, 0.09), "Y", 20), black, mass=0.1)
    body.collide("foot", white, block((0.2, 0.15, 0.03), (0.01, 0.0, 0.015)))
    body.collide("arm", white, block((0.04, 0.05, 0.19), (-0.065, 0.0, 0.125)), hull(extrude(arm[2:], 0.05)))
    body.collide("stage", black, block((0.13, 0.13, 0.012), (0.035, 0.0, 0.125)))
    body.collide(
        "head",
        black,
        rod((0.045, 0.0, 0.24), (0.045, 0.0, 0.325), 0.022),
        rod((0.05, 0.0, 0.3), (-0.05, 0.0, 0.382), 0.02),
    )
    body.anchors = {"stage": (0.045, 0.0, 0.133), "eyepiece": (-0.054, 0.0, 0.386)}
    return asset


def balance(span: float = 0.4, height: float = 0.42) -> Asset:
    """A pair of scales: a beam on a hinge, each pan hung from its end by a hinge."""
    brass = Paint("brass", BRASS, (0.70, 0.50, 0.18), 0.25, 0.8)
    wood = Paint("foot", PINE, (0.28, 0.12, 0.05))
    steel = Paint("cords", STEEL, (0.30, 0.30, 0.32), 0.4, 0.6)
    asset = Asset(
        "balance",
        ["balance", "scales", "balance scale", "beam balance", "pair of scales", "weighing scales"],
        "laboratory/balance",
        "A balance with two pans that hang from a beam on a hinge.",
        "the reader's side; the beam tilts about X",
    )
    stand = asset.body("stand")
    boards(stand, wood, {"foot": ((0.16, 0.26, 0.03), (0.0, 0.0, 0.015))})
    post = [
        (0.0, 0.03),
        (0.03, 0.03),
        (0.02, 0.045),
        (0.009, 0.07),
        (0.008, 0.2),
        (0.013, 0.22),
        (0.008, 0.24),
        (0.008, height - 0.02),
        (0.0, height - 0.02),
    ]
    stand.add(lathe(post, 16), brass)
    stand.collide("post", brass, drum(0.01, 0.03, height - 0.02))
    pivot = (0.0, 0.0, height - 0.012)
    beam = asset.body("beam", pivot)
    # It hangs a little below its pivot, and so comes back to level.
    half = span / 2
    bar = extrude(
        [(-half, -0.014), (0.0, -0.026), (half, -0.014), (half, -0.006), (0.0, 0.004), (-half, -0.006)], 0.008
    )
    beam.add(bar.turned("Z", 90.0).moved(0.0, 0.0, pivot[2]), brass)
    beam.add(globe(0.012, (0.0, 0.0, height), 14, 8), brass, 0.0)
    beam.add(box((0.004, 0.004, 0.13), (0.009, 0.0, height - 0.1)), steel)
    beam.collide("beam", brass, block((0.008, span, 0.012), (0.0, 0.0, pivot[2] - 0.012)))
    asset.joints.append(Joint("pivot", "stand", "beam", pivot, "X", (-12.0, 12.0)))
    for j, side in ((-1, "right"), (1, "left")):
        y, hook, low = j * (half - 0.004), pivot[2] - 0.01, 0.11
        pan = asset.body(f"pan_{side}", (0.0, y, hook))
        radius = 0.065
        dish = [
            (0.0, low),
            (radius - 0.02, low),
            (radius, low + 0.012),
            (radius - 0.002, low + 0.012),
            (radius - 0.022, low + 0.003),
            (0.0, low + 0.003),
        ]
        pan.add(lathe(dish, 28).moved(y=y), brass)
        cord = tube([(0.0, 0.0, hook), (radius - 0.003, 0.0, low + 0.01)], 0.0011, 6)
        pan.add(join(around(cord, 3, 30.0)).moved(y=y), steel)
        pan.collide("pan", brass, drum(radius, low, low + 0.004, 0.0, y))
        rim = annulus(radius, radius - 0.003, 0.008, (0.0, y, low + 0.008), sides=28)
        pan.add(rim, brass, 0.0)
        pan.anchors = {f"on_pan_{side}": (0.0, y, low + 0.004)}
        asset.joints.append(Joint(f"hook_{side}", "beam", f"pan_{side}", (0.0, y, hook), "X", (-60.0, 60.0), 1e-4))
    return asset
