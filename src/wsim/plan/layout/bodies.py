"""What is known of one object alone: its box, its hollow, its surfaces, what of it is solid.

An object's own frame has its origin where its pose is: the centre of the bottom face of a tank, an asset, a robot and a
vehicle, the centre of anything else.
"""

from __future__ import annotations

from typing import Any

from wsim.assets import get
from wsim.defaults import WALL
from wsim.plan.layout.boxes import TOUCH, Box, Matrix, Solid, rotation
from wsim.plan.layout.errors import LayoutError
from wsim.plan.schema import FromAsset, FromVehicle, PlanObject, Vec3

STANDS = ("tank", "asset", "robot", "vehicle")  # their pose is the centre of the bottom face
UPRIGHT: Vec3 = (0.0, 0.0, 0.0)


def entry(item: PlanObject) -> Any:
    """The catalogue's entry of an asset."""
    if not isinstance(item.built, FromAsset):
        raise LayoutError(f"{item.name} is no asset of the catalogue")
    return get(item.built.asset)


def local_size(item: PlanObject) -> Vec3:
    """Edge lengths of the bounding box before it is turned [m]; a tank's are its outer ones."""
    size = item.size
    if item.primitive in ("box", "robot") or (item.primitive == "fluid" and size):
        return (size[0], size[1], size[2])
    if item.primitive == "sphere":
        return (2 * size[0],) * 3
    if item.primitive == "cylinder":
        return (2 * size[0], 2 * size[0], size[1])
    if item.primitive == "capsule":
        return (2 * size[0], 2 * size[0], size[1] + 2 * size[0])
    if item.primitive == "tank":
        return (size[0] + 2 * WALL, size[1] + 2 * WALL, size[2] + WALL)
    if item.primitive == "asset":
        x, y, z = entry(item).size
        return (float(x), float(y), float(z))
    if isinstance(item.built, FromVehicle):
        from wsim.scene.vehicle_spec import preset  # with USD, and few plans have a vehicle

        spec = preset(item.built.vehicle)
        return (spec.length, max(spec.width, spec.track + spec.wheel_width), spec.height)
    raise LayoutError(f"{item.name}: a {item.primitive} has no bounding box; no object can be placed by its sides")


def extents(item: PlanObject, rotation_deg: Vec3 = UPRIGHT) -> Vec3:
    """Edge lengths of an object's bounding box under roll, pitch, yaw [m]; a tank's are its outer ones."""
    return _hull(item, rotation(rotation_deg), (0.0, 0.0, 0.0)).box().size


def hollow(item: PlanObject) -> Box:
    """The free box inside a container, in its own frame [m].

    Raises:
        LayoutError: the object has none.
    """
    if item.primitive == "tank":
        x, y, z = item.size
        return Box((-x / 2, -y / 2, WALL), (x / 2, y / 2, WALL + z))
    free = entry(item).hollow if item.primitive == "asset" else None
    if free is None:
        what = f"the asset {item.built.asset}" if isinstance(item.built, FromAsset) else f"a {item.primitive}"
        raise LayoutError(f"{item.name}: {what} is not hollow, nothing can be put in it; use PLACE-ON, or a tank")
    half = [edge / 2 for edge in free.size]
    low = [free.center[k] - half[k] for k in range(3)]
    high = [free.center[k] + half[k] for k in range(3)]
    return Box((low[0], low[1], low[2]), (high[0], high[1], high[2]))


def is_hollow(item: PlanObject) -> bool:
    """Whether something can be put in it."""
    return item.primitive == "tank" or (item.primitive == "asset" and entry(item).hollow is not None)


def surface(item: PlanObject, anchor: str | None) -> Vec3:
    """A point on the top face, or on the named surface, from the centre of the object's bottom face [m]."""
    if item.primitive == "tank" and anchor is None:
        raise LayoutError(f"{item.name}: a tank has no top to stand on; use PLACE-IN")
    known = dict(entry(item).anchors) if item.primitive == "asset" else {}
    known["top"] = (0.0, 0.0, local_size(item)[2])
    if anchor is not None and anchor not in known:
        raise LayoutError(f"{item.name} has no surface {anchor!r}; it has {', '.join(sorted(known))}")
    return known[anchor or "top"]


def solids(item: PlanObject) -> list[Box]:
    """The axis-aligned boxes round what an object with a pose fills: one, or the floor and walls of what is hollow."""
    return [solid.box() for solid in convex(item)]


def convex(item: PlanObject) -> list[Solid]:
    """The convex bodies that an object with a pose fills: one, or the floor and walls of what is hollow."""
    if item.pose is None or item.primitive in ("ground", "fluid"):  # terrain has no pose
        return []
    turn = rotation(item.pose.rotation_deg)
    if is_hollow(item):
        return [_part(box, turn, item.pose.position) for box in _walls(item)]
    return [_hull(item, turn, item.pose.position)]


def around(item: PlanObject) -> Box:
    """The axis-aligned box round an object with a pose."""
    if item.pose is None:
        raise LayoutError(f"{item.name} has no pose; lay the plan out")
    return _hull(item, rotation(item.pose.rotation_deg), item.pose.position).box()


def _hull(item: PlanObject, turn: Matrix, at: Vec3) -> Solid:
    x, y, z = local_size(item)
    if item.primitive not in STANDS:
        return Solid(item.primitive, at, turn, (x / 2, y / 2, z / 2))
    return _part(Box((-x / 2, -y / 2, 0.0), (x / 2, y / 2, z)), turn, at)


def _part(box: Box, turn: Matrix, at: Vec3) -> Solid:
    """A box of the object's own frame, in the world."""
    centre = [at[i] + sum(turn[i][k] * box.center[k] for k in range(3)) for i in range(3)]
    x, y, z = box.size
    return Solid("box", (centre[0], centre[1], centre[2]), turn, (x / 2, y / 2, z / 2))


def _walls(item: PlanObject) -> list[Box]:
    """What is solid of a hollow object, in its own frame: its box without its hollow, open above if the hollow is."""
    free = hollow(item)
    x, y, top = local_size(item)
    (ax, ay, az), (bx, by, bz) = free.low, free.high
    parts = [
        Box((-x / 2, -y / 2, 0.0), (x / 2, y / 2, az)),
        Box((-x / 2, -y / 2, az), (ax, y / 2, top)),
        Box((bx, -y / 2, az), (x / 2, y / 2, top)),
        Box((ax, -y / 2, az), (bx, ay, top)),
        Box((ax, by, az), (bx, y / 2, top)),
        Box((ax, ay, bz), (bx, by, top)),
    ]
    return [part for part in parts if min(part.size) > TOUCH]
