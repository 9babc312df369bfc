"""What the layout knows so far: each body's size, heading, centre in the plane and height, and the rows it has."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

from wsim.plan.layout.bodies import STANDS, extents
from wsim.plan.layout.boxes import Box, union
from wsim.plan.layout.errors import LayoutError
from wsim.plan.layout.rows import Row, placing
from wsim.plan.schema import Plan, PlanObject, Pose, Vec3
from wsim.plan.schema.circles import in_turn, round_again
from wsim.plan.schema.objects import SPREAD
from wsim.plan.schema.predicates import Kind


@dataclass
class Unit:
    """A group, or a copy of one: its anchor, its members, and where they are from the anchor's centre [m]."""

    row: Row
    anchor: str
    members: tuple[str, ...]
    offsets: dict[str, tuple[float, float]] = field(default_factory=dict)

    @property
    def all(self) -> tuple[str, ...]:
        """The anchor and its members."""
        return (self.anchor, *self.members)


class World:
    """The state that the stages of the layout fill in.

    Attributes:
        items: The objects by name; their sizes change where a row gives them.
        rows: The primitive rows.
        units: Groups and copies by the name of their anchor.
        groups: The groups alone, by the group's name.
        yaw: Heading of each body [deg].
        bottom: Height of each body's bottom [m].
        centre: Centre of each body's box in the plane [m].
        settled: Where the free placing put a body's coordinate before: it stays there if it can.
    """

    def __init__(self, plan: Plan, rows: list[Row]) -> None:
        self.plan = plan
        self.items: dict[str, PlanObject] = {item.name: item for item in plan.objects}
        self.rows = rows
        self.of: dict[str, list[Row]] = {name: [] for name in self.items}
        for row in rows:
            self.of[row.item].append(row)
        made = [r for r in rows if r.predicate in ("GROUP", "COPY-GROUP")]
        self.units = {r.item: Unit(r, r.item, r.members) for r in made}
        self.groups = {r.group: self.units[r.item] for r in made if r.predicate == "GROUP" and r.group}
        self.unit_of = {name: unit for unit in self.units.values() for name in unit.members}
        self.yaw: dict[str, float] = {}
        self.bottom: dict[str, float] = {}
        self.centre: dict[str, tuple[float, float]] = {}
        self.settled: dict[tuple[int, str], float] = {}
        self._extents: dict[tuple[str, Vec3, tuple[float, ...]], Vec3] = {}

    @cached_property
    def bodies(self) -> dict[str, None]:
        """What gets a pose, in the plan's order: all but the ground, and fluids that take their container's shape."""
        return {name: None for name, item in self.items.items() if not self._shapeless(item)}

    def _shapeless(self, item: PlanObject) -> bool:
        if item.primitive != "fluid":
            return item.primitive in ("ground", *SPREAD)
        poured = any(row.predicate == "FREE-SURFACE-AT" for row in self.of[item.name])
        return not item.size or poured

    @cached_property
    def kept(self) -> set[str]:
        """What stays where its pose says: nothing else says where it is."""
        stays = {n for n in self.bodies if self.items[n].pose is not None and not placing(self.items[n])}
        for unit in self.units.values():
            if unit.row.predicate == "COPY-GROUP" or unit.anchor not in stays:
                stays -= set(unit.members)
        return stays

    @cached_property
    def holders(self) -> set[str]:
        """What has something in it."""
        return {row.ref for row in self.rows if row.predicate == "PLACE-IN" and row.ref in self.bodies}

    def row(self, name: str, *predicates: str) -> Row | None:
        """The object's first row of one of these predicates."""
        return next((row for row in self.of[name] if row.predicate in predicates), None)

    def row_of(self, name: str, kind: Kind) -> Row | None:
        """The object's first row of a kind."""
        return next((row for row in self.of[name] if row.spec.kind == kind), None)

    def rotation(self, name: str) -> Vec3:
        """Roll, pitch, yaw of a body [deg]."""
        roll, pitch = self._lying(name)
        return (roll, pitch, self.yaw.get(name, 0.0))

    def _lying(self, name: str) -> tuple[float, float]:
        row = self.row_of(name, "posture")
        if row is not None:
            return (0.0, 90.0) if row.spec.axis == 0 else (90.0, 0.0)
        pose = self.items[name].pose
        return pose.rotation_deg[:2] if pose is not None else (0.0, 0.0)

    def extents(self, name: str) -> Vec3:
        """Edge lengths of a body's axis-aligned box as it is turned now [m]."""
        key = (name, self.rotation(name), self.items[name].size)
        if key not in self._extents:
            self._extents[key] = extents(self.items[name], key[1])
        return self._extents[key]

    @property
    def base(self) -> float:
        """Height of the world's base plane: the ground's, if there is one [m]."""
        for item in self.items.values():
            if item.primitive == "ground":
                return item.pose.position[2] if item.pose is not None else 0.0
        return 0.0

    def names(self, ref: str) -> tuple[str, ...]:
        """The bodies that a reference means: one, or those of a group."""
        return (ref,) if ref in self.items else self.groups[ref].all

    def box(self, ref: str) -> Box:
        """The axis-aligned box round a body or a group, where it is now."""
        boxes = []
        for name in self.names(ref):
            (x, y), z, (dx, dy, dz) = self.centre[name], self.bottom[name], self.extents(name)
            boxes.append(Box((x - dx / 2, y - dy / 2, z), (x + dx / 2, y + dy / 2, z + dz)))
        return union(boxes)

    def span(self, name: str, axis: int) -> tuple[float, float]:
        """Where a unit's box begins and ends along an axis, from its anchor's centre [m]."""
        unit = self.units[name]
        at = {name: (0.0, 0.0), **unit.offsets}
        low = min(at[n][axis] - self.extents(n)[axis] / 2 for n in unit.all)
        high = max(at[n][axis] + self.extents(n)[axis] / 2 for n in unit.all)
        return low, high

    def owner(self, ref: str) -> str:
        """The body whose centre moves with a reference: itself, or a group's anchor."""
        return ref if ref in self.items else self.groups[ref].anchor

    def container(self, fluid: str) -> str | None:
        """What holds a fluid."""
        row = self.row(fluid, "PLACE-IN")
        return row.ref if row is not None else None

    def state(self) -> dict[str, tuple[float, ...]]:
        """Everything that a round changes, to see whether it did."""
        return {
            name: (*self.centre[name], self.bottom[name], self.yaw[name], *self.items[name].size)
            for name in self.bodies
        }

    def placed(self) -> Plan:
        """The plan with the poses and sizes found."""
        return self.plan.model_copy(update={"objects": [self._posed(item) for item in self.items.values()]})

    def _posed(self, item: PlanObject) -> PlanObject:
        name = item.name
        if name not in self.centre or name in self.kept:
            return item
        x, y = self.centre[name]
        z = self.bottom[name] + (0.0 if item.primitive in STANDS else self.extents(name)[2] / 2)
        roll, pitch, yaw = self.rotation(name)
        pose = Pose(position=(tidy(x), tidy(y), tidy(z)), rotation_deg=(roll, pitch, tidy(yaw)))
        return item.model_copy(update={"pose": pose})


def tidy(value: float) -> float:
    """Rounded to a micrometre, without a negative zero: plans are read by people."""
    return round(value, 6) + 0.0


def in_order(needs: dict[str, list[tuple[str, Row]]], what: str) -> list[str]:
    """Names in an order in which each comes after those it needs.

    Raises:
        LayoutError: they need each other in a circle; names its rows.
    """
    order: list[str] = []
    for found in in_turn(needs, lambda name: [one for one, _ in needs.get(name, [])]):
        if isinstance(found, list):
            circle = [next(row for one, row in needs[a] if one == b) for a, b in round_again(found)]
            raise LayoutError(f"{what} go round in a circle: {'; '.join(map(str, circle))}; remove one of them")
        order.append(found)
    return order
