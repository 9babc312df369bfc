"""What opens: leaves on hinges and drawers on runners, tied to the body that stands."""

from __future__ import annotations

from .asset import Asset, Body, Joint
from .furniture import boards
from .matter import Paint
from .parts import Point

SWING = 110.0  # [deg] that a door opens
RUBS = 0.3  # [N m] in its hinges: it stays where it is left


def leaf(
    asset: Asset,
    name: str,
    paint: Paint,
    size: Point,
    center: Point,
    side: int,
    *,
    mass: float | None = None,
    swing: float = SWING,
    both_ways: bool = False,
) -> Body:
    """A closed door across X that opens towards +X, hinged at its edge at +Y (`side` 1) or -Y (-1).

    The asset's first body carries the hinge. `size` is its thickness, width and height [m], `center` its middle; it
    weighs as its paint's substance or `mass` [kg], and opens by `swing` [deg]; `both_ways` opens it towards -X, too.
    """
    hinge = (center[0], center[1] + side * size[1] / 2, center[2])
    body = asset.body(name, hinge)
    density = None if mass is None else mass / (size[0] * size[1] * size[2])
    boards(body, paint, {"leaf": (size, center)}, density)
    low, high = (0.0, swing) if side > 0 else (-swing, 0.0)
    limits = (-swing, swing) if both_ways else (low, high)
    asset.joints.append(Joint(f"{name}_hinge", asset.bodies[0].name, name, hinge, "Z", limits, RUBS))
    return body


def drawer(asset: Asset, name: str, paint: Paint, size: Point, center: Point, reach: float, front: float) -> Body:
    """A drawer, open at its top, that slides out along +X.

    The asset's first body carries the runners. `size` and `center` are of the box behind the front [m], `reach` is how
    far it comes out, `front` by how much its front stands out over the box at its sides, top and bottom [m].
    """
    body, wall, face = asset.body(name, center), 0.008, 0.018
    x, y, z = size
    tall = z * 0.8  # papers and hands need room above the sides
    low = center[2] - z / 2
    parts: dict[str, tuple[Point, Point]] = {
        "floor": ((x, y, wall), (center[0], center[1], low + wall / 2)),
        "back": ((wall, y, tall - wall), (center[0] - (x - wall) / 2, center[1], low + (tall + wall) / 2)),
        "front": ((face, y + 2 * front, z + 2 * front), (center[0] + (x + face) / 2, center[1], center[2])),
    }
    for j, side in ((-1, "right"), (1, "left")):
        at = (center[0] + wall / 2, center[1] + j * (y - wall) / 2, low + (tall + wall) / 2)
        parts[side] = ((x - wall, wall, tall - wall), at)
    boards(body, paint, parts)
    joint = Joint(f"{name}_runner", asset.bodies[0].name, name, center, "X", (0.0, reach), 2.0, "Prismatic")
    asset.joints.append(joint)
    return body
