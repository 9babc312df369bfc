"""Relations become poses: deterministic, in one pass over the supports, with a check that nothing interpenetrates.

Heights come from the support relation (PLACE-ON-BASE, PLACE-ON, PLACE-IN, FLOATS-AT-SURFACE, SUBMERGED,
SPAWNED-ABOVE). In the plane an object stands centred on its support; side relations (FRONT-OF ...) chain objects into a
row, and the row is centred as a whole. An object with a pose and no relation keeps its pose.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from wsim.errors import UserError
from wsim.plan.schema import Plan, PlanObject, Pose, Vec3

WALL = 0.02  # thickness of a tank's walls and floor [m], the default of wsim.scene
GAP = 0.05  # between neighbours whose side relation states no gap [m]
TOUCH = 1e-6  # faces that meet overlap by no more than this [m]

_SIDES: dict[str, tuple[int, float]] = {
    "FRONT-OF": (0, 1.0),
    "BACK-OF": (0, -1.0),
    "LEFT-OF": (1, 1.0),
    "RIGHT-OF": (1, -1.0),
}
_SUPPORTS = ("PLACE-ON-BASE", "PLACE-ON", "PLACE-IN", "FLOATS-AT-SURFACE", "SUBMERGED", "SPAWNED-ABOVE")


class LayoutError(UserError):
    """The plan's relations cannot be laid out."""


@dataclass(frozen=True)
class Box:
    """An axis-aligned box [m]."""

    low: Vec3
    high: Vec3

    def overlap(self, other: Box) -> float:
        """How deep two boxes are in each other along their shallowest axis; not positive when they are apart [m]."""
        return min(
            min(a_high, b_high) - max(a_low, b_low)
            for a_low, a_high, b_low, b_high in zip(self.low, self.high, other.low, other.high, strict=True)
        )


def extents(item: PlanObject, rotation_deg: Vec3 = (0.0, 0.0, 0.0)) -> Vec3:
    """Edge lengths of an object's bounding box under roll, pitch, yaw [m]; a tank's are its outer ones."""
    size = item.size
    if item.primitive == "box":
        local = (size[0], size[1], size[2])
    elif item.primitive == "sphere":
        return (2 * size[0], 2 * size[0], 2 * size[0])
    elif item.primitive == "cylinder":
        local = (2 * size[0], 2 * size[0], size[1])
    elif item.primitive == "capsule":
        local = (2 * size[0], 2 * size[0], size[1] + 2 * size[0])
    elif item.primitive == "tank":
        return (size[0] + 2 * WALL, size[1] + 2 * WALL, size[2] + WALL)
    else:
        raise LayoutError(f"{item.name}: a {item.primitive} has no bounding box; no object can be placed by its sides")
    matrix = _rotation(rotation_deg)
    rows = [sum(abs(matrix[i][j]) * local[j] for j in range(3)) for i in range(3)]
    return (rows[0], rows[1], rows[2])


def _rotation(rotation_deg: Vec3) -> list[list[float]]:
    """Roll about X, then pitch about Y, then yaw about Z, as a matrix."""
    roll, pitch, yaw = (math.radians(angle) for angle in rotation_deg)
    cr, sr, cp, sp, cy, sy = (f(a) for a in (roll, pitch, yaw) for f in (math.cos, math.sin))
    return [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]


def layout(plan: Plan) -> Plan:
    """A copy of the plan in which every object that occupies space has a pose.

    Raises:
        LayoutError: a relation goes round in a circle, two relations contradict, or objects interpenetrate.
    """
    poses = _Layout(plan).solve()
    objects = [item.model_copy(update={"pose": poses.get(item.name, item.pose)}) for item in plan.objects]
    placed = plan.model_copy(update={"objects": objects})
    check_clear(placed)
    return placed


class _Layout:
    def __init__(self, plan: Plan) -> None:
        self.objects = {item.name: item for item in plan.objects}
        self.rotations = {item.name: _lying(item) for item in plan.objects}
        self.plane: dict[str, tuple[float, float]] = {}
        self.height: dict[str, float] = {}  # of the bounding box's bottom
        self.busy: list[str] = []

    def solve(self) -> dict[str, Pose]:
        solid = [item for item in self.objects.values() if item.primitive not in ("ground", "fluid")]
        for item in solid:
            if not self._kept(item):
                self._place(item)
        poses = {}
        for item in solid:
            if self._kept(item):
                continue
            x, y = self.plane[item.name]
            z = self.height[item.name]
            if item.primitive != "tank":
                z += self._extents(item)[2] / 2
            position = (_tidy(x), _tidy(y), _tidy(z))
            poses[item.name] = Pose(position=position, rotation_deg=self.rotations[item.name])
        return poses

    def _kept(self, item: PlanObject) -> bool:
        return item.pose is not None and not item.relations

    def _extents(self, item: PlanObject) -> Vec3:
        return extents(item, self.rotations[item.name])

    def _place(self, item: PlanObject) -> None:
        if item.name in self.plane:
            return
        if item.name in self.busy:
            circle = " -> ".join([*self.busy[self.busy.index(item.name) :], item.name])
            raise LayoutError(f"relations go round in a circle: {circle}; remove one of them")
        self.busy.append(item.name)
        row = self._row(item)
        centre_x, centre_y = self._centre_of_support(item, row)
        for name, (x, y) in row.items():
            self.plane[name] = (centre_x + x, centre_y + y)
        for name in row:
            self.height[name] = self._bottom(self.objects[name])
        self.busy.pop()

    def _row(self, item: PlanObject) -> dict[str, tuple[float, float]]:
        """The objects that side relations tie to this one, relative to the middle of them all."""
        ties = []
        for other in self.objects.values():
            for relation in other.relations:
                if relation.predicate in _SIDES and relation.ref is not None and not self._kept(other):
                    ties.append((other.name, relation.ref, relation))
        at = {item.name: (0.0, 0.0)}
        grown = True
        while grown:
            grown = False
            for name, ref, relation in ties:
                if name not in at and ref not in at:
                    continue
                axis, sign = _SIDES[relation.predicate]
                gap = GAP if relation.gap is None else relation.gap
                half = self._extents(self.objects[name])[axis] / 2 + self._extents(self.objects[ref])[axis] / 2
                step = [0.0, 0.0]
                step[axis] = sign * (half + gap)
                if ref in at and name in at:
                    if abs(at[name][axis] - at[ref][axis] - step[axis]) > TOUCH:
                        raise LayoutError(f"{name} cannot be {relation.predicate} {ref} as well as where others put it")
                    continue
                if ref in at:
                    at[name] = (at[ref][0] + step[0], at[ref][1] + step[1])
                else:
                    at[ref] = (at[name][0] - step[0], at[name][1] - step[1])
                grown = True
        middle = []
        for axis in (0, 1):
            low = min(at[name][axis] - self._extents(self.objects[name])[axis] / 2 for name in at)
            high = max(at[name][axis] + self._extents(self.objects[name])[axis] / 2 for name in at)
            middle.append((low + high) / 2)
        return {name: (x - middle[0], y - middle[1]) for name, (x, y) in at.items()}

    def _centre_of_support(self, item: PlanObject, row: dict[str, tuple[float, float]]) -> tuple[float, float]:
        """Where the middle of a row goes: over the container or the top that holds it, else at the origin.

        A member with a pose of its own, and no relation, fixes the row instead.
        """
        for name, (x, y) in row.items():
            fixed = self.objects[name].pose
            if fixed is not None and self._kept(self.objects[name]):
                return (fixed.position[0] - x, fixed.position[1] - y)
        centres = []
        for name, (x, y) in row.items():
            support = self._support_name(self.objects[name])
            if support is None or support in row:
                continue
            at = self._plane_of(support)
            if self.objects[support].role == "container" or len(row) == 1:
                centres.append(at)
            else:  # on a top: the member that stands on it fixes the row
                centres.append((at[0] - x, at[1] - y))
        if not centres:
            return (0.0, 0.0)
        if any(math.dist(centre, centres[0]) > TOUCH for centre in centres):
            raise LayoutError(
                f"{item.name}: its row {', '.join(row)} stands on supports that are not in line; drop a relation"
            )
        return centres[0]

    def _support_name(self, item: PlanObject) -> str | None:
        """The object that carries it, with a place in the plane: a fluid stands for its container."""
        for relation in item.relations:
            if relation.predicate in _SUPPORTS and relation.ref is not None:
                ref = self.objects[relation.ref]
                if ref.primitive == "ground":
                    return None
                return self._container_of(ref) if ref.primitive == "fluid" else ref.name
        return None

    def _container_of(self, fluid: PlanObject) -> str | None:
        relation = fluid.relation("PLACE-IN")
        return relation.ref if relation is not None else None

    def _plane_of(self, name: str) -> tuple[float, float]:
        item = self.objects[name]
        if item.pose is not None and self._kept(item):
            return (item.pose.position[0], item.pose.position[1])
        self._place(item)
        return self.plane[name]

    def _base_of(self, name: str) -> float:
        """Height of an object's bottom [m]."""
        item = self.objects[name]
        if item.pose is not None and self._kept(item):
            below = 0.0 if item.primitive == "tank" else extents(item, item.pose.rotation_deg)[2] / 2
            return item.pose.position[2] - below
        self._plane_of(name)
        if name not in self.height:
            self.height[name] = self._bottom(item)
        return self.height[name]

    def _top_of(self, name: str) -> float:
        item = self.objects[name]
        if item.primitive == "ground":
            return item.pose.position[2] if item.pose is not None else 0.0
        if item.primitive == "fluid":
            return self._surface_of(item)
        if item.primitive == "tank":
            raise LayoutError(f"{name}: a tank has no top to stand on; use PLACE-IN")
        rotation = item.pose.rotation_deg if item.pose is not None and self._kept(item) else self.rotations[name]
        return self._base_of(name) + extents(item, rotation)[2]

    def _surface_of(self, fluid: PlanObject) -> float:
        relation = fluid.relation("FREE-SURFACE-AT")
        container = self._container_of(fluid)
        if container is not None and relation is not None and relation.value is not None:
            return self._base_of(container) + WALL + relation.value
        if fluid.pose is not None and fluid.size:
            return fluid.pose.position[2] + fluid.size[2] / 2
        raise LayoutError(
            f"{fluid.name}: its surface is unknown; give it PLACE-IN and FREE-SURFACE-AT, or a size and a pose"
        )

    def _bottom(self, item: PlanObject) -> float:
        supports = [relation for relation in item.relations if relation.predicate in _SUPPORTS]
        if len(supports) > 1:
            names = ", ".join(relation.predicate for relation in supports)
            raise LayoutError(f"{item.name}: {names} each say how high it starts; keep one of them")
        if not supports or supports[0].predicate == "PLACE-ON-BASE":
            return 0.0
        relation = supports[0]
        if relation.ref is None:  # SPAWNED-ABOVE the base
            return relation.value or 0.0
        if relation.predicate == "PLACE-IN":
            return self._base_of(relation.ref) + WALL
        top = self._top_of(relation.ref)
        if relation.predicate == "FLOATS-AT-SURFACE":
            return top + (relation.gap or 0.0)
        if relation.predicate == "SUBMERGED":
            return top - (relation.value or 0.0) - self._extents(item)[2]
        return top + (relation.value or 0.0)  # PLACE-ON, SPAWNED-ABOVE


def _lying(item: PlanObject) -> Vec3:
    if item.relation("LIES-ALONG-X") is not None:
        return (0.0, 90.0, 0.0)
    if item.relation("LIES-ALONG-Y") is not None:
        return (90.0, 0.0, 0.0)
    return item.pose.rotation_deg if item.pose is not None else (0.0, 0.0, 0.0)


def _tidy(value: float) -> float:
    """Rounded to a micrometre, without a negative zero: plans are read by people."""
    return round(value, 6) + 0.0


def solids(item: PlanObject) -> list[Box]:
    """The boxes that an object with a pose fills: one, or a tank's floor and four walls."""
    if item.pose is None or item.primitive in ("ground", "fluid"):
        return []
    x, y, z = item.pose.position
    if item.primitive != "tank":
        dx, dy, dz = extents(item, item.pose.rotation_deg)
        return [Box((x - dx / 2, y - dy / 2, z - dz / 2), (x + dx / 2, y + dy / 2, z + dz / 2))]
    lx, ly, lz = item.size
    hx, hy, top = lx / 2, ly / 2, z + WALL + lz
    return [
        Box((x - hx - WALL, y - hy - WALL, z), (x + hx + WALL, y + hy + WALL, z + WALL)),
        Box((x - hx - WALL, y - hy - WALL, z), (x - hx, y + hy + WALL, top)),
        Box((x + hx, y - hy - WALL, z), (x + hx + WALL, y + hy + WALL, top)),
        Box((x - hx - WALL, y - hy - WALL, z), (x + hx + WALL, y - hy, top)),
        Box((x - hx - WALL, y + hy, z), (x + hx + WALL, y + hy + WALL, top)),
    ]


def check_clear(plan: Plan) -> None:
    """Refuse a plan whose objects overlap or lie below the ground.

    Raises:
        LayoutError: names the two objects and how deep they overlap.
    """
    filled = [(item, box) for item in plan.objects for box in solids(item)]
    for index, (item, box) in enumerate(filled):
        for other, other_box in filled[:index]:
            depth = box.overlap(other_box)
            if item.name == other.name or depth <= TOUCH or _balls_clear(item, other):
                continue
            raise LayoutError(
                f"{other.name} and {item.name} overlap by {depth:.3g} m where they start; "
                "move one of them, or relate one to the other with a gap"
            )
        has_ground = any(other.primitive == "ground" for other in plan.objects)
        if has_ground and box.low[2] < -TOUCH:
            raise LayoutError(f"{item.name} starts {-box.low[2]:.3g} m below the ground; raise it")


def _balls_clear(a: PlanObject, b: PlanObject) -> bool:
    """Two spheres may be apart though their boxes are not."""
    if a.primitive != "sphere" or b.primitive != "sphere" or a.pose is None or b.pose is None:
        return False
    return math.dist(a.pose.position, b.pose.position) >= a.size[0] + b.size[0] - TOUCH
