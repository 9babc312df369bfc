"""Which way each body's +X points: the orientation rows, as far as the places found so far allow."""

from __future__ import annotations

import hashlib
import math
from typing import TYPE_CHECKING

import numpy as np

from wsim.plan.layout.bodies import local_size
from wsim.plan.layout.boxes import TOUCH, angle_between, turned
from wsim.plan.layout.errors import LayoutError
from wsim.plan.layout.world import in_order

if TYPE_CHECKING:
    from wsim.plan.layout.rows import Row
    from wsim.plan.layout.world import World

ALIKE = 0.05  # headings that two rows give a body may differ by this [deg]


def turn_bodies(world: World) -> None:
    """Fill in `world.yaw`; a row that needs a place that is not found yet leaves the heading as it is.

    Raises:
        LayoutError: headings refer to each other in a circle, or a body that stands along X and Y is turned.
    """
    for name in in_order({name: _needs(world, name) for name in world.bodies}, "headings"):
        if name in world.bodies:
            world.yaw[name] = _heading(world, name)


def check_headings(world: World) -> None:
    """Refuse rows that turn one body in two ways, and those that turn what cannot be turned.

    Raises:
        LayoutError: names the rows and the headings.
    """
    for name in world.bodies:
        rows = _rows(world, name)
        for row in rows:
            heading = by_row(world, row)
            if heading is None:
                raise LayoutError(f"{row}: {name} and {row.ref} are over each other, there is no direction; move one")
            if angle_between(heading, world.yaw[name]) > ALIKE:
                raise LayoutError(
                    f"{rows[0]} turns it to {world.yaw[name]:.4g} deg, {row} to {heading:.4g} deg; remove one of them"
                )
        if world.items[name].primitive in ("tank", "fluid") and angle_between(world.yaw[name], 0.0) > ALIKE:
            raise LayoutError(
                f"{rows[0] if rows else name}: a {world.items[name].primitive} stands along X and Y and is not turned; "
                "swap the numbers of its size, and remove the row"
            )


def depends_on_places(world: World) -> bool:
    """Whether a row needs places to say a heading or a size, so that one round is not enough."""
    return any(row.spec.by_place for row in world.rows)


def _rows(world: World, name: str) -> list[Row]:
    return [] if name in world.kept else [row for row in world.of[name] if row.spec.kind == "orientation"]


def _needs(world: World, name: str) -> list[tuple[str, Row]]:
    """Whose heading comes first."""
    rows = _rows(world, name)
    if rows:
        # Rows that look at a place take the headings of the round before, so that two may look at each other.
        row = rows[0]
        return [(name, row) for name in world.names(row.ref or "")[:1]] if row.predicate == "FACING-SAME-AS" else []
    if name in world.kept:
        return []
    mirror = world.row(name, "SYMMETRY-ALONG")
    if mirror is not None:
        return [(world.owner(ref), mirror) for ref in (mirror.ref or "", mirror.axis or "")]
    unit = world.unit_of.get(name)
    if unit is not None and unit.row.predicate == "COPY-GROUP":
        copied = world.groups[unit.row.group or ""]
        original = copied.members[unit.members.index(name)]
        return [(ref, unit.row) for ref in (unit.anchor, copied.anchor, original)]
    return []


def _heading(world: World, name: str) -> float:
    rows = _rows(world, name)
    before = world.yaw.get(name, 0.0)
    if rows:
        found = by_row(world, rows[0])
        return before if found is None else found
    span = world.row(name, "SPAN")
    if name not in world.kept and span is not None:
        along = _towards(world, span.ref or "", span.other or "")
        return before if along is None else along
    mirror = world.row(name, "SYMMETRY-ALONG")
    if name not in world.kept and mirror is not None:
        axis, ref = world.owner(mirror.axis or ""), world.owner(mirror.ref or "")
        return tidy_angle(2 * world.yaw.get(axis, 0.0) - world.yaw.get(ref, 0.0))
    unit = world.unit_of.get(name)
    if name not in world.kept and unit is not None and unit.row.predicate == "COPY-GROUP":
        copied = world.groups[unit.row.group or ""]
        original = copied.members[unit.members.index(name)]
        return tidy_angle(world.yaw[unit.anchor] + world.yaw[original] - world.yaw[copied.anchor])
    pose = world.items[name].pose
    return pose.rotation_deg[2] if pose is not None else 0.0


def by_row(world: World, row: Row) -> float | None:
    """The heading that a row gives [deg]; none while a place that it needs is unknown, or two are the same."""
    if row.predicate == "RANDOM-ROT":
        return drawn(world.plan.simulation.seed, row.item, row.range)
    if row.predicate == "FACING-SAME-AS":
        return world.yaw.get(world.owner(row.ref or ""), 0.0)
    if not row.spec.by_place:
        return tidy_angle(90.0 * row.spec.axis + (180.0 if row.spec.sign < 0 else 0.0))
    if not world.centre or any(name not in world.centre for name in (row.item, *world.names(row.ref or ""))):
        return None
    if row.predicate == "ORIENT-BY-RELATIVE-SIDE":
        return _square_to(world, row)
    heading = _towards(world, row.item, row.ref or "")
    if heading is None or row.spec.sign > 0:
        return heading
    return tidy_angle(heading + 180.0)


def drawn(seed: int, name: str, within: tuple[float, float] | None) -> float:
    """A yaw that depends on the plan's seed and the object's name alone [deg]."""
    digest = hashlib.sha256(name.encode()).digest()
    random = np.random.default_rng([seed, int.from_bytes(digest[:8], "little")])
    low, high = sorted(within or (-180.0, 180.0))
    return (
        tidy_angle(float(random.uniform(low, high))) if within is None else round(float(random.uniform(low, high)), 6)
    )


def _towards(world: World, a: str, b: str) -> float | None:
    """The direction from one to another [deg]; none while a place is unknown, or both are the same."""
    if any(name not in world.centre for ref in (a, b) for name in world.names(ref)):
        return None
    (ax, ay), (bx, by) = world.box(a).center[:2], world.box(b).center[:2]
    if math.hypot(bx - ax, by - ay) < TOUCH:
        return None
    return tidy_angle(math.degrees(math.atan2(by - ay, bx - ax)))


def _square_to(world: World, row: Row) -> float | None:
    """Opposite to the outward normal of the side of `ref` that the body is most outside of, or nearest to."""
    ref = row.ref or ""
    single = ref in world.items
    yaw = world.yaw[ref] if single else 0.0
    size = local_size(world.items[ref]) if single else world.box(ref).size
    here, there = world.centre[row.item], world.box(ref).center
    along, across = turned((here[0] - there[0], here[1] - there[1]), -yaw)
    if max(abs(along), abs(across)) < TOUCH:
        return None
    if abs(along) - size[0] / 2 >= abs(across) - size[1] / 2:
        return tidy_angle(yaw + (180.0 if along > 0 else 0.0))
    return tidy_angle(yaw + (-90.0 if across > 0 else 90.0))


def tidy_angle(value: float) -> float:
    """A heading between -180 and 180, 180 included, rounded [deg]."""
    turned_to = round((value + 180.0) % 360.0 - 180.0, 6) + 0.0
    return 180.0 if turned_to == -180.0 else turned_to
