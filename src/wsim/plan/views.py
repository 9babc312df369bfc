"""Cameras that show a laid-out plan: the two that a plan gets by default, and those that ask for a view.

A view is named for the side of the box where the camera stands: `side_plus_x` stands in front, at +X, and looks along
-X. Those that end in `_room` stay inside the walls of the room.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import product

from wsim.defaults import FIELD_OF_VIEW
from wsim.plan.layout.bodies import around, extents, hollow, is_hollow, solids
from wsim.plan.layout.boxes import Box, turned, union
from wsim.plan.layout.errors import LayoutError
from wsim.plan.rooms import between_walls
from wsim.plan.schema import CameraPlan, Plan, PlanObject, Vec3

ASPECT = 9 / 16
MARGIN = 1.2
RAISED = 0.22  # of its distance: how much higher than what it looks at the eye is, so that tops are seen
OFF_AXIS = 0.05  # of its height: how far a camera that looks down stands aside, so that "up" in the picture is defined
STEP = 1.05  # by which a camera that does not see all steps back
FROM_WALL = 0.1  # between a camera in a room and the wall behind it [m]

_SIDES: dict[str, tuple[int, float]] = {
    "side_plus_x": (0, 1.0),
    "side_minus_x": (0, -1.0),
    "side_plus_y": (1, 1.0),
    "side_minus_y": (1, -1.0),
}
_HALF = math.tan(math.radians(FIELD_OF_VIEW / 2))


def bounds(plan: Plan) -> tuple[Vec3, Vec3]:
    """Lowest and highest corner of everything placed [m]; a metre round the origin if nothing is."""
    boxes = [box for item in plan.objects for box in solids(item)]
    if not boxes:
        return (-0.5, -0.5, 0.0), (0.5, 0.5, 1.0)
    box = union(boxes)
    return box.low, box.high


def cameras(
    plan: Plan, above: float | None = None, goes: Mapping[str, Sequence[Vec3]] | None = None
) -> list[CameraPlan]:
    """A view from the side, a little off the axis, and one from the top.

    Args:
        plan: A plan with poses.
        above: A height that the side view looks across from slightly higher up, such as a water surface [m].
        goes: From its start to where else an object comes, by its name [m].
    """
    ways = [(around(plan.object(name)), way) for name, ways in (goes or {}).items() for way in ways]
    box = union([Box(*bounds(plan)), *(_shifted(start, way, _ground(plan)) for start, way in ways)])
    low, high = box.low, box.high
    centre = box.center
    width, depth, height = box.size
    level = above if above is not None else centre[2]
    distance = _distance(width, height) + depth / 2
    up = _distance(width, depth)

    def from_side(back: float) -> Vec3:
        return (centre[0] - 0.18 * back, centre[1] - back, level + RAISED * back)

    def from_top(back: float) -> Vec3:
        return (centre[0], centre[1] - OFF_AXIS * (high[2] + back), high[2] + back)

    views = (("side", from_side, distance, centre), ("top", from_top, up, (centre[0], centre[1], low[2])))
    made = []
    for name, eye, back, target in views:
        while not _sees(eye(back), target, box):
            back *= STEP
        made.append(CameraPlan(name=name, eye=_rounded(*eye(back)), target=_rounded(*target)))
    return made


def _ground(plan: Plan) -> float:
    """Height of the ground, below which nothing comes [m]."""
    grounds = [item for item in plan.objects if item.primitive == "ground"]
    return max((item.pose.position[2] if item.pose is not None else 0.0 for item in grounds), default=-math.inf)


def _shifted(box: Box, way: Vec3, floor: float) -> Box:
    rise = max(way[2], floor - box.low[2])
    low, high = ((at[0] + way[0], at[1] + way[1], at[2] + rise) for at in (box.low, box.high))
    return Box(low, high)


def resolve_all(plan: Plan, keep: bool = False) -> Plan:
    """The plan with an eye and a target for every camera; with `keep`, those that have them stay where they are.

    Raises:
        LayoutError: As `resolve`.
    """
    cameras = [camera if keep and camera.eye and camera.target else resolve(plan, camera) for camera in plan.cameras]
    return plan.model_copy(update={"cameras": cameras})


def resolve(plan: Plan, camera: CameraPlan) -> CameraPlan:
    """The camera with an eye and a target for its view of the scene, or of the object `of` [m].

    Args:
        plan: A plan with poses.
        camera: Kept as it is if it has no view.

    Raises:
        LayoutError: the object has no place, or the room leaves the camera none.
    """
    if camera.view is None:
        return camera
    shown = _shown(plan, camera)
    room = inside(plan) if camera.view.endswith("_room") else None
    if camera.of is None and room is not None:
        shown = _furnished(plan, room) or shown
    eye, target = _from_side(shown, camera.view.removesuffix("_room"))
    if camera.view.endswith("_room"):
        walls = room or Box(*bounds(plan))
        eye = _within(eye, walls, FROM_WALL if room is not None else 0.0)
        if math.dist(eye, target) < 1e-3:
            raise LayoutError(f"camera {camera.name}: {camera.view} leaves no room between eye and target; drop _room")
    return camera.model_copy(update={"eye": _rounded(*eye), "target": _rounded(*target)})


def inside(plan: Plan) -> Box | None:
    """The free box of the room that the scene is in: of a container round everything else, or between static walls."""
    placed = [item for item in plan.objects if solids(item)]
    for item in placed:
        others = [around(other) for other in placed if other is not item]
        if is_hollow(item) and others:
            free = _hollow_in_world(item)
            if all(_holds(free, box) for box in others):
                return free
    walls = [around(item) for item in placed if item.role == "background" and item.state == "static"]
    return between_walls(walls)


def _shown(plan: Plan, camera: CameraPlan) -> Box:
    if camera.of is None:
        return Box(*bounds(plan))
    item = plan.object(camera.of)
    if item.primitive == "fluid" and item.pose is None:
        held = next((row.ref for row in item.relations if row.predicate == "PLACE-IN" and row.ref), None)
        if held is not None:
            return around(plan.object(held))
    if item.pose is None or item.primitive == "ground":  # terrain has none
        raise LayoutError(f"camera {camera.name}: {camera.of} has no box of its own; look at a body")
    if item.primitive == "fluid":
        x, y, z = item.pose.position
        dx, dy, dz = (edge / 2 for edge in extents(item))
        return Box((x - dx, y - dy, z - dz), (x + dx, y + dy, z + dz))
    return around(item)


def _furnished(plan: Plan, room: Box) -> Box | None:
    """What is in a room, without the room."""
    boxes = [around(item) for item in plan.objects if solids(item) and item.role != "background"]
    boxes = [box for box in boxes if _holds(room, box)]
    return union(boxes) if boxes else None


def _from_side(box: Box, view: str) -> tuple[Vec3, Vec3]:
    """Eye and target: as near as shows the whole box, a step further back at a time."""
    x, y, z = box.center
    width, depth, height = box.size
    axis, sign = _SIDES.get(view, (2, 1.0))
    across, along, up = {0: (depth, width, height), 1: (width, depth, height), 2: (width, height, depth)}[axis]
    distance = _distance(across, up) + along / 2
    while True:
        eye = [x, y, z]
        eye[axis] += sign * distance
        if axis == 2:
            eye[1] -= OFF_AXIS * distance
        else:
            eye[2] += RAISED * distance
        seen_from = (eye[0], eye[1], eye[2])
        if _sees(seen_from, box.center, box):
            return seen_from, box.center
        distance *= STEP


def _sees(eye: Vec3, target: Vec3, box: Box) -> bool:
    """Whether a camera has all corners of a box in the picture."""
    f = _unit([b - a for a, b in zip(eye, target, strict=True)])
    right = _unit([f[1], -f[0], 0.0])
    up = (right[1] * f[2] - right[2] * f[1], right[2] * f[0] - right[0] * f[2], right[0] * f[1] - right[1] * f[0])
    for corner in product(*zip(box.low, box.high, strict=True)):
        to = [a - b for a, b in zip(corner, eye, strict=True)]
        x, y, depth = (sum(a * b for a, b in zip(to, n, strict=True)) for n in (right, up, f))
        if depth <= 0.0 or abs(x) > _HALF * depth or abs(y) > _HALF * ASPECT * depth:
            return False
    return True


def _unit(v: list[float]) -> Vec3:
    length = math.hypot(*v)
    return (v[0] / length, v[1] / length, v[2] / length)


def _distance(width: float, height: float) -> float:
    """From which a width and a height fill the picture, with a margin [m]."""
    return MARGIN * max(width / 2 / _HALF, height / 2 / (_HALF * ASPECT))


def _within(eye: Vec3, room: Box, margin: float) -> Vec3:
    """The point of a room that is nearest to the eye."""
    near = []
    for value, low, high in zip(eye, room.low, room.high, strict=True):
        keep = min(margin, (high - low) / 4)
        near.append(min(max(value, low + keep), high - keep))
    return (near[0], near[1], near[2])


def _hollow_in_world(item: PlanObject) -> Box:
    free = hollow(item)
    assert item.pose is not None  # the callers have looked
    x, y, z = item.pose.position
    yaw = item.pose.rotation_deg[2]
    corners = [turned((a, b), yaw) for a in (free.low[0], free.high[0]) for b in (free.low[1], free.high[1])]
    xs, ys = [c[0] for c in corners], [c[1] for c in corners]
    return Box((x + min(xs), y + min(ys), z + free.low[2]), (x + max(xs), y + max(ys), z + free.high[2]))


def _holds(outer: Box, inner: Box) -> bool:
    """Whether a box is in another along X and Y, and not below it."""
    across = all(outer.low[k] - 1e-3 <= inner.low[k] and inner.high[k] <= outer.high[k] + 1e-3 for k in (0, 1))
    return across and outer.low[2] - 1e-3 <= inner.low[2]


def _rounded(x: float, y: float, z: float) -> Vec3:
    return (round(x, 3) + 0.0, round(y, 3) + 0.0, round(z, 3) + 0.0)
