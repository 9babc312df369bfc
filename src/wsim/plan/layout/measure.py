"""How far a laid-out plan is from what its rows say, measured on the boxes of the placed objects.

Nothing here solves anything: poses in, residuals out. A residual is 0 when the row holds; it is in metres, or, for an
orientation row, in degrees.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from wsim.plan import templates
from wsim.plan.layout.bodies import around, hollow, local_size, surface
from wsim.plan.layout.boxes import TOUCH, Box, angle_between, rotation, turned, union
from wsim.plan.layout.errors import LayoutError
from wsim.plan.layout.rows import Row
from wsim.plan.schema import Plan, PlanObject, Relation, Vec3

DEGREES = 0.1  # an orientation that is this far off counts as kept [deg]
IN_DEGREES = ("orientation", "posture")  # the kinds of row whose residual is an angle


def residual(plan: Plan, item: PlanObject, row: Relation) -> float:
    """How far a row is from being so.

    Args:
        plan: A plan with poses.
        item: The object that the row is of.
        row: One of its relations.

    Returns:
        Metres, or degrees where the predicate is of a kind in `IN_DEGREES`; 0 when the row holds. A template's is the
        largest of its parts'.
    """
    scene = _Scene(plan)
    return max(_off(scene, part) for part in templates.expand_row(item, row, scene.items))


def unsatisfied(plan: Plan, tolerance: float = TOUCH) -> list[str]:
    """The rows that do not hold, each with its residual.

    Args:
        plan: A plan with poses.
        tolerance: Of a length [m]; an angle may be `DEGREES` off.
    """
    scene = _Scene(plan)
    found = []
    for item in plan.objects:
        for relation in item.relations:
            angular = relation.spec.kind in IN_DEGREES
            for part in templates.expand_row(item, relation, scene.items):
                off = _off(scene, part)
                if off > (DEGREES if angular else tolerance):
                    found.append(f"{part} is off by {off:.4g} {'deg' if angular else 'm'}")
                    break
    return found


class _Scene:
    """Placed objects, and the boxes that names mean."""

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self.items = {item.name: item for item in plan.objects}
        self.units: dict[str, tuple[str, ...]] = {}
        self.groups: dict[str, tuple[str, ...]] = {}
        for item in plan.objects:
            for row in item.relations:
                if row.predicate in ("GROUP", "COPY-GROUP"):
                    self.units[item.name] = (item.name, *(row.members or []))
                if row.predicate == "GROUP" and row.group is not None:
                    self.groups[row.group] = self.units[item.name]

    def box(self, name: str) -> Box:
        return union([around(self.items[one]) for one in self.groups.get(name, (name,))])

    def whole(self, row: Row) -> Box:
        """The box that a side row of this object is about: an anchor's is its group's, but not among its members."""
        unit = self.units.get(row.item, (row.item,))
        refs = self.groups.get(row.ref or "", (row.ref,))
        return union([around(self.items[one]) for one in (unit if not set(refs) & set(unit) else (row.item,))])

    def yaw(self, name: str) -> float:
        pose = self.items[self.groups.get(name, (name,))[0]].pose
        return pose.rotation_deg[2] if pose is not None else 0.0

    def origin(self, name: str) -> tuple[float, float, float]:
        pose = self.items[name].pose
        if pose is None:
            raise LayoutError(f"{name} has no pose; lay the plan out")
        return pose.position

    @property
    def base(self) -> float:
        for item in self.plan.objects:
            if item.primitive == "ground":
                return item.pose.position[2] if item.pose is not None else 0.0
        return 0.0

    def floor(self, container: str) -> float:
        return self.origin(container)[2] + hollow(self.items[container]).low[2]

    def top(self, name: str, anchor: str | None = None) -> float:
        item = self.items.get(name)
        if item is not None and item.primitive == "ground":
            return self.base
        if item is not None and item.primitive == "fluid":
            return self.surface(item)
        if item is not None and anchor is not None:
            return self.box(name).low[2] + surface(item, anchor)[2]
        return self.box(name).high[2]

    def surface(self, fluid: PlanObject) -> float:
        for relation in fluid.relations:
            rows = templates.expand_row(fluid, relation, self.items)
            levels = [row.value for row in rows if row.predicate == "FREE-SURFACE-AT"]
            held = self.container(fluid)
            if levels and levels[0] is not None and held is not None:
                return self.floor(held) + levels[0]
        return self.box(fluid.name).high[2]

    def container(self, fluid: PlanObject) -> str | None:
        for relation in fluid.relations:
            for row in templates.expand_row(fluid, relation, self.items):
                if row.predicate == "PLACE-IN":
                    return row.ref
        return None


def _side(scene: _Scene, row: Row) -> float:
    axis, sign = row.spec.axis, row.spec.sign
    mine, theirs = scene.whole(row), scene.box(row.ref or "")
    gap = mine.low[axis] - theirs.high[axis] if sign > 0 else theirs.low[axis] - mine.high[axis]
    return abs(gap - (row.gap or 0.0))


def _in_line(scene: _Scene, row: Row) -> float:
    mine, theirs = (_face(box, row)[row.spec.axis] for box in (scene.whole(row), scene.box(row.ref or "")))
    return abs(mine - theirs)


def _face(box: Box, row: Row) -> Vec3:
    """A point of the face of a box that a row is about, or its middle."""
    return {1.0: box.high, -1.0: box.low, 0.0: box.center}[row.spec.sign]


def _on_base(scene: _Scene, row: Row) -> float:
    return abs(scene.box(row.item).low[2] - scene.base)


def _on(scene: _Scene, row: Row) -> float:
    """How far its bottom is from the surface, or its centre from being over it."""
    ref = row.ref or ""
    off = abs(scene.box(row.item).low[2] - scene.top(ref, row.anchor) - (row.value or 0.0))
    return max(off, _beyond(scene, row.item, ref))


def _beyond(scene: _Scene, name: str, ref: str) -> float:
    """How far the middle of a body is from being over another, in that one's own rectangle [m]."""
    item = scene.items.get(ref)
    if item is not None and item.primitive == "ground":
        return 0.0
    if item is not None and item.primitive == "fluid" and item.pose is None:
        return _outside(scene, name, scene.container(item) or "")
    here, there = scene.box(name).center, scene.box(ref).center
    upright = item is not None and item.pose is not None and not any(item.pose.rotation_deg[:2])
    size = local_size(item) if item is not None and upright else scene.box(ref).size
    x, y = turned((here[0] - there[0], here[1] - there[1]), -scene.yaw(ref) if upright else 0.0)
    return max(abs(x) - size[0] / 2, abs(y) - size[1] / 2, 0.0)


def _in(scene: _Scene, row: Row) -> float:
    if row.item not in scene.items or scene.items[row.item].pose is None:
        return 0.0  # a fluid takes the container's shape
    off = abs(scene.box(row.item).low[2] - scene.floor(row.ref or ""))
    return max(off, _outside(scene, row.item, row.ref or ""))


def _outside(scene: _Scene, name: str, container: str) -> float:
    """How far a body's footprint reaches out of a hollow, along the hollow's own axes [m]."""
    item, holder = scene.items[name], scene.items[container]
    free, yaw = hollow(holder), scene.yaw(container)
    here, there = scene.box(name).center, scene.origin(container)
    x, y = turned((here[0] - there[0], here[1] - there[1]), -yaw)
    size = local_size(item)
    turn = scene.yaw(name) - yaw
    pose = item.pose
    if (pose is not None and any(pose.rotation_deg[:2])) or item.primitive in ("sphere", "cylinder", "capsule"):
        size, turn = scene.box(name).size, 0.0 if item.primitive != "box" else -yaw
    c, s = turned((1.0, 0.0), turn)
    half = ((abs(c) * size[0] + abs(s) * size[1]) / 2, (abs(s) * size[0] + abs(c) * size[1]) / 2)
    out = [abs((x, y)[k] - free.center[k]) + half[k] - free.size[k] / 2 for k in (0, 1)]
    return max(*out, 0.0)


def _anywhere(scene: _Scene, row: Row) -> float:
    off = 0.0
    others = [r for r in scene.items[row.item].relations if r.spec.kind == "support" and r.predicate != row.predicate]
    if row.ref is not None:
        off = _on(scene, row)
    elif not others:
        off = _on_base(scene, row)
    if row.region is not None:
        box = scene.box(row.item)
        for axis in (0, 1):
            off = max(off, row.region.low[axis] - box.low[axis], box.high[axis] - row.region.high[axis])
    return off


def _above(scene: _Scene, row: Row) -> float:
    if row.ref is None:
        return abs(scene.box(row.item).low[2] - scene.base - (row.value or 0.0))
    return _on(scene, row)


def _height(scene: _Scene, row: Row) -> float:
    return abs(local_size(scene.items[row.item])[2] - (row.value or 0.0))


def _facing(scene: _Scene, row: Row) -> float:
    """From where it looks to the direction along an axis of the world, or to, or away from, another's middle."""
    way = [0.0, 0.0]
    way[row.spec.axis] = 1.0
    if row.spec.by_place:
        here, there = scene.box(row.item).center, scene.box(row.ref or "").center
        way = [there[0] - here[0], there[1] - here[1]]
    direction = math.degrees(math.atan2(row.spec.sign * way[1], row.spec.sign * way[0]))
    return angle_between(scene.yaw(row.item), direction)


def _same_heading(scene: _Scene, row: Row) -> float:
    return angle_between(scene.yaw(row.item), scene.yaw(row.ref or ""))


def _random(scene: _Scene, row: Row) -> float:
    """How far its heading is outside the range."""
    if row.range is None:
        return 0.0
    low, high = sorted(row.range)
    if high - low >= 360.0:
        return 0.0
    middle = (low + high) / 2
    return max(0.0, angle_between(scene.yaw(row.item), middle) - (high - low) / 2)


def _square(scene: _Scene, row: Row) -> float:
    """From looking at the side of `ref` that it is most outside of, or nearest to."""
    ref = row.ref or ""
    here, there = scene.box(row.item).center, scene.box(ref).center
    single = ref in scene.items
    yaw = scene.yaw(ref) if single else 0.0
    size = local_size(scene.items[ref]) if single else scene.box(ref).size
    x, y = turned((here[0] - there[0], here[1] - there[1]), -yaw)
    out = {180.0: x - size[0] / 2, 0.0: -x - size[0] / 2, -90.0: y - size[1] / 2, 90.0: -y - size[1] / 2}
    most = max(out.values())
    looks = [yaw + turn for turn, value in out.items() if value > most - TOUCH]
    return min(angle_between(scene.yaw(row.item), look) for look in looks)


def _lies(scene: _Scene, row: Row) -> float:
    """The angle between its axis and the one named, in the frame of its heading."""
    pose = scene.items[row.item].pose
    if pose is None:
        return 0.0
    turn = rotation((pose.rotation_deg[0], pose.rotation_deg[1], 0.0))
    along = abs(turn[row.spec.axis][2])
    return math.degrees(math.acos(min(1.0, along)))


def _still_surface(scene: _Scene, row: Row) -> float:
    """How far the level is above the rim, or from where another row has it."""
    fluid, level = scene.items[row.item], row.value or 0.0
    held = scene.container(fluid)
    if held is None:
        return 0.0
    return max(level - hollow(scene.items[held]).size[2], abs(scene.floor(held) + level - scene.surface(fluid)))


def _floating(scene: _Scene, row: Row) -> float:
    off = abs(scene.box(row.item).low[2] - scene.top(row.ref or "") - (row.gap or 0.0))
    return max(off, _beyond(scene, row.item, row.ref or ""))


def _submerged(scene: _Scene, row: Row) -> float:
    box = scene.box(row.item)
    face = box.center[2] if row.by == "center" else box.high[2]
    off = abs(scene.top(row.ref or "") - face - (row.value or 0.0))
    return max(off, _beyond(scene, row.item, row.ref or ""))


def _mirror(scene: _Scene, row: Row) -> float:
    """How far from the mirror image: the centre [m], and the heading as the arc of its half diagonal [m]."""
    a, p, c = scene.box(row.ref or "").center, scene.box(row.axis or "").center, scene.box(row.item).center
    axis = scene.yaw(row.axis or "")
    x, y = turned((a[0] - p[0], a[1] - p[1]), -axis)
    ix, iy = turned((x, -y), axis)
    off = math.dist((p[0] + ix, p[1] + iy), c[:2])
    stated = any(r.spec.kind in IN_DEGREES for r in scene.items[row.item].relations)
    turn = 0.0 if stated else angle_between(scene.yaw(row.item), 2 * axis - scene.yaw(row.ref or ""))
    return max(off, _arc(scene, row.item, turn))


def _arc(scene: _Scene, name: str, degrees: float) -> float:
    return math.radians(degrees) * math.hypot(*scene.box(name).size[:2]) / 2


def _copied(scene: _Scene, row: Row) -> float:
    """The largest distance of a member from where the original's is from its anchor, turned with the anchor."""
    anchor, *members = scene.groups[row.group or ""]
    turn = scene.yaw(row.item) - scene.yaw(anchor)
    off = 0.0
    for like, name in zip(members, row.members, strict=True):
        a, b = scene.box(anchor), scene.box(like)
        x, y = turned((b.center[0] - a.center[0], b.center[1] - a.center[1]), turn)
        c, d = scene.box(row.item), scene.box(name)
        off = max(off, math.dist((c.center[0] + x, c.center[1] + y), d.center[:2]))
        off = max(off, abs(b.low[2] - a.low[2] - d.low[2] + c.low[2]))
        off = max(off, _arc(scene, name, angle_between(scene.yaw(name), scene.yaw(like) + turn)))
    return off


def _level(scene: _Scene, row: Row) -> float:
    ref = row.ref or ""
    ground = scene.items.get(ref)
    flat = ground is not None and ground.primitive in ("ground", "fluid")
    theirs = scene.top(ref) if flat else _face(scene.box(ref), row)[2]
    return abs(_face(scene.box(row.item), row)[2] - theirs)


def _span(scene: _Scene, row: Row) -> float:
    """How far the ends are from lying on both tops, `overlap` deep, measured along the bridge."""
    box, length = scene.box(row.item), local_size(scene.items[row.item])[0]
    ux, uy = turned((1.0, 0.0), scene.yaw(row.item))
    off = 0.0
    for ref, side in ((row.ref or "", -1.0), (row.other or "", 1.0)):
        off = max(off, abs(box.low[2] - scene.top(ref)))
        reach = side * (length / 2 - (row.overlap or 0.0))  # here the bridge crosses the edge of what carries it
        x, y = box.center[0] + reach * ux, box.center[1] + reach * uy
        there = scene.box(ref)
        size = local_size(scene.items[ref]) if ref in scene.items else there.size
        a, b = turned((x - there.center[0], y - there.center[1]), -scene.yaw(ref) if ref in scene.items else 0.0)
        off = max(off, abs(max(abs(a) - size[0] / 2, abs(b) - size[1] / 2)))
    return off


def _no_measure(scene: _Scene, row: Row) -> float:
    """Rows about membership: what they mean shows in other rows."""
    return 0.0


_OF_KIND: dict[str, Callable[[_Scene, Row], float]] = {
    "side": _side,
    "alignment": _in_line,
    "level": _level,
    "orientation": _facing,
    "posture": _lies,
}
_OF_ITS_OWN: dict[str, Callable[[_Scene, Row], float]] = {
    "PLACE-ON-BASE": _on_base,
    "PLACE-ON": _on,
    "PLACE-IN": _in,
    "PLACE-ANYWHERE": _anywhere,
    "SPAWNED-ABOVE": _above,
    "HEIGHT": _height,
    "FACING-SAME-AS": _same_heading,
    "RANDOM-ROT": _random,
    "ORIENT-BY-RELATIVE-SIDE": _square,
    "FREE-SURFACE-AT": _still_surface,
    "FLOATS-AT-SURFACE": _floating,
    "SUBMERGED": _submerged,
    "CONTAINS-FLUID": _no_measure,
    "SYMMETRY-ALONG": _mirror,
    "GROUP": _no_measure,
    "COPY-GROUP": _copied,
    "SPAN": _span,
}


def _off(scene: _Scene, row: Row) -> float:
    return (_OF_ITS_OWN.get(row.predicate) or _OF_KIND[row.spec.kind])(scene, row)
