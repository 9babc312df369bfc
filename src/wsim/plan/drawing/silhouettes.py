"""What each object of a laid-out plan looks like from above and from the side: convex outlines in metres.

From above, +X (FRONT) is to the right and +Y (LEFT) is up. From the side one looks along +Y, from the right: +X is to
the right and +Z is up. The two views share their X axis.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from wsim.defaults import WALL
from wsim.errors import UserError
from wsim.plan.layout import extents
from wsim.plan.layout.bodies import hollow
from wsim.plan.schema import FromTerrain, Plan, PlanObject, Pose, Vec3
from wsim.plan.vessels import filled_box

View = Literal["above", "side"]
Style = Literal["solid", "glass", "fluid", "wide"]
Point = tuple[float, float]
VIEWS: tuple[View, ...] = ("above", "side")
ROUND = 40  # corners of a circle
FLAT = 0.1  # [m]: how high terrain without hills is drawn
WIDE = 0.6  # share of the scene's area from which a flat thing is a floor that others are drawn on
_GREY = (0.5, 0.5, 0.5)


@dataclass(frozen=True)
class Silhouette:
    """One object in one view.

    Attributes:
        name: The object's.
        style: How it is drawn: what is behind glass or in a fluid is seen.
        color: Linear RGB.
        points: Corners of its convex outline [m], anticlockwise.
        order: Its nearest point's place along the line of sight [m]; what has more is in front.
        front: Middle of its front, from above, if it matters which way it looks [m].
    """

    name: str
    style: Style
    color: Vec3
    points: tuple[Point, ...]
    order: float
    front: Point | None = None

    @property
    def low(self) -> Point:
        """Lowest corner of its bounding rectangle [m]."""
        return min(p[0] for p in self.points), min(p[1] for p in self.points)

    @property
    def high(self) -> Point:
        """Highest corner of its bounding rectangle [m]."""
        return max(p[0] for p in self.points), max(p[1] for p in self.points)

    @property
    def upright(self) -> bool:
        """Whether it is a rectangle along the axes."""
        (left, bottom), (right, top) = self.low, self.high
        near = 1e-6 * (1.0 + right - left + top - bottom)
        return len(self.points) == 4 and all(
            min(abs(x - left), abs(x - right)) < near and min(abs(y - bottom), abs(y - top)) < near
            for x, y in self.points
        )


@dataclass(frozen=True)
class Scene:
    """A plan as both views need it: its outlines, back to front, and the corners of what they span [m]."""

    views: dict[View, list[Silhouette]]
    low: Vec3
    high: Vec3
    ground: float | None  # height of the ground [m], if there is one


def scene_of(plan: Plan) -> Scene:
    """The outlines of everything that has a place; the ground has no end and is no outline."""
    items = {item.name: item for item in plan.objects}
    solids = [(item, solid) for item in plan.objects if (solid := _solid(item, items)) is not None]
    corners = [corner for _, solid in solids for corner in solid.bounds()]
    low, high = _bounds(corners)
    area = max((high[0] - low[0]) * (high[1] - low[1]), 1e-12)
    views: dict[View, list[Silhouette]] = {}
    for view in VIEWS:
        drawn = [_silhouette(item, solid, view, area) for item, solid in solids]
        rank = {"wide": 0, "fluid": 1, "glass": 2, "solid": 3}
        views[view] = sorted(drawn, key=lambda one: (rank[one.style], one.order))
    grounds = [item for item in plan.objects if item.primitive == "ground"]
    height = (grounds[0].pose.position[2] if grounds[0].pose else 0.0) if grounds else None
    return Scene(views, low, high, height)


@dataclass(frozen=True)
class _Solid:
    """Centres of spheres (a point has radius 0) whose hull is the solid; all that a silhouette needs."""

    points: tuple[tuple[Vec3, float], ...]

    def bounds(self) -> list[Vec3]:
        return [(p[0] + sign * r, p[1] + sign * r, p[2] + sign * r) for p, r in self.points for sign in (-1.0, 1.0)]


def _bounds(corners: list[Vec3]) -> tuple[Vec3, Vec3]:
    if not corners:
        return (-0.5, -0.5, 0.0), (0.5, 0.5, 0.5)
    xs, ys, zs = zip(*corners, strict=True)
    return (min(xs), min(ys), min(zs)), (max(xs), max(ys), max(zs))


def _solid(item: PlanObject, items: dict[str, PlanObject]) -> _Solid | None:
    if item.primitive == "ground":
        return None
    if item.primitive == "fluid":
        return _fluid(item, items)
    if isinstance(item.built, FromTerrain):
        x, y = item.built.extent
        top = max((each.height for each in item.built.layers if each.kind == "hill"), default=0.0)
        return _box(Pose(position=(0.0, 0.0, 0.0)), (x, y, max(top, FLAT)), 0.5 * max(top, FLAT))
    if item.pose is None:
        return None
    pose, size = item.pose, item.size
    if item.primitive == "sphere":
        return _Solid(((pose.position, size[0]),))
    if item.primitive == "capsule":
        half = size[1] / 2
        return _Solid(tuple((_placed(pose, (0.0, 0.0, end)), size[0]) for end in (-half, half)))
    if item.primitive == "cylinder":
        turns = [2 * math.pi * k / ROUND for k in range(ROUND)]
        rim = [(size[0] * math.cos(turn), size[0] * math.sin(turn)) for turn in turns]
        return _Solid(tuple((_placed(pose, (x, y, z)), 0.0) for x, y in rim for z in (-size[1] / 2, size[1] / 2)))
    return _box(pose, *_edges(item))


def _edges(item: PlanObject) -> tuple[Vec3, float]:
    """Edge lengths, and how far the pose is below the middle [m]: of a tank or an asset it is at the bottom."""
    if item.primitive == "box":
        return (item.size[0], item.size[1], item.size[2]), 0.0
    if item.primitive == "tank":
        x, y, z = item.size
        outer = (x + 2 * WALL, y + 2 * WALL, z + WALL)
        return outer, outer[2] / 2
    try:
        edges = item.dimensions or extents(item)
    except UserError:  # an asset that this catalogue lacks: a drawing shows the rest
        edges = (0.3, 0.3, 0.3)
    return edges, edges[2] / 2


def _box(pose: Pose, edges: Vec3, raised: float) -> _Solid:
    corners = [(x * edges[0] / 2, y * edges[1] / 2) for x in (-1, 1) for y in (-1, 1)]
    ends = (raised - edges[2] / 2, raised + edges[2] / 2)
    return _Solid(tuple((_placed(pose, (x, y, z)), 0.0) for x, y in corners for z in ends))


def _fluid(item: PlanObject, items: dict[str, PlanObject]) -> _Solid | None:
    if len(item.size) == 3 and item.pose is not None:
        return _box(item.pose, (item.size[0], item.size[1], item.size[2]), 0.0)
    row = next(
        (row for row in item.relations if row.predicate == "PLACE-IN" or row.predicate.startswith("fills_")), None
    )
    tank = items.get(row.ref or "") if row is not None else None
    if row is not None and tank is not None and tank.pose is not None and tank.primitive == "asset":
        return _in_vessel(item, tank, tank.pose)
    if row is None or tank is None or tank.primitive != "tank" or tank.pose is None:
        return None
    x, y, z = tank.size
    surface = item.relation("FREE-SURFACE-AT")
    if len(item.size) == 3:
        x, y, level = item.size
    elif surface is not None and surface.value is not None:
        level = min(surface.value, z)
    else:
        level = z / 2 if row.predicate == "fills_container_lower_half" else z
    return _box(tank.pose, (x, y, level), WALL + level / 2)


def _in_vessel(item: PlanObject, vessel: PlanObject, pose: Pose) -> _Solid | None:
    level = item.relation("FREE-SURFACE-AT")
    try:
        edges = filled_box(vessel, level.value if level is not None else None, item.registration.volume)
        low = hollow(vessel).low
    except UserError:  # an asset that this catalogue lacks, or that is not hollow
        return None
    return _box(pose, edges, low[2] + edges[2] / 2)


def _placed(pose: Pose, local: Vec3) -> Vec3:
    """A point of an object in the world: roll about X, then pitch about Y, then yaw about Z."""
    roll, pitch, yaw = (math.radians(angle) for angle in pose.rotation_deg)
    x, y, z = local
    y, z = y * math.cos(roll) - z * math.sin(roll), y * math.sin(roll) + z * math.cos(roll)
    x, z = x * math.cos(pitch) + z * math.sin(pitch), z * math.cos(pitch) - x * math.sin(pitch)
    x, y = x * math.cos(yaw) - y * math.sin(yaw), x * math.sin(yaw) + y * math.cos(yaw)
    return (x + pose.position[0], y + pose.position[1], z + pose.position[2])


def _silhouette(item: PlanObject, solid: _Solid, view: View, area: float) -> Silhouette:
    up, towards = (1, (0.0, 0.0, 1.0)) if view == "above" else (2, (0.0, -1.0, 0.0))
    flat: list[Point] = []
    for point, radius in solid.points:
        if radius == 0.0:
            flat.append((point[0], point[up]))
            continue
        turns = [2 * math.pi * k / ROUND for k in range(ROUND)]
        flat += [(point[0] + radius * math.cos(a), point[up] + radius * math.sin(a)) for a in turns]
    order = max(sum(a * b for a, b in zip(point, towards, strict=True)) + radius for point, radius in solid.points)
    outline = tuple(_hull(flat))
    spans = (max(p[0] for p in outline) - min(p[0] for p in outline)) * (
        max(p[1] for p in outline) - min(p[1] for p in outline)
    )
    style: Style = "solid"
    if item.primitive == "fluid":
        style = "fluid"
    elif item.primitive == "tank" or (item.material is not None and item.material.opacity < 0.5):
        style = "glass"
    elif (item.role == "terrain" and item.primitive in ("box", "terrain")) or (
        item.state == "static" and view == "above" and spans > WIDE * area
    ):
        style = "wide"
    front = _front(item) if view == "above" else None
    return Silhouette(item.name, style, item.material.color if item.material else _GREY, outline, order, front)


def _front(item: PlanObject) -> Point | None:
    """Where a thing's +X face is, of what drives or walks, and of what a row turns."""
    turned = any(row.spec.kind == "orientation" for row in item.relations)
    if item.pose is None or not (turned or item.role in ("vehicle", "robot")):
        return None
    ahead = _placed(
        item.pose,
        (_edges(item)[0][0] / 2 if item.primitive in ("box", "asset", "robot", "vehicle") else item.size[0], 0.0, 0.0),
    )
    return ahead[0], ahead[1]


def _hull(points: list[Point]) -> list[Point]:
    """Corners of the convex hull, anticlockwise (Andrew's monotone chain)."""
    ordered = sorted({(round(x, 9), round(y, 9)) for x, y in points})
    if len(ordered) < 3:
        return ordered
    chains: list[list[Point]] = []
    for run in (ordered, ordered[::-1]):
        chain: list[Point] = []
        for point in run:
            while len(chain) > 1 and _turn(chain[-2], chain[-1], point) <= 1e-15:
                chain.pop()
            chain.append(point)
        chains.append(chain[:-1])
    return chains[0] + chains[1]


def _turn(a: Point, b: Point, c: Point) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
