"""Where in the plane a body may be: over the top that carries it, inside a hollow, in a region, on the base."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from wsim.plan.layout.bodies import hollow, is_hollow, local_size, surface
from wsim.plan.layout.boxes import TOUCH, turned
from wsim.plan.layout.errors import LayoutError
from wsim.plan.layout.heights import source, support

if TYPE_CHECKING:
    from wsim.plan.layout.rows import Row
    from wsim.plan.layout.world import World


@dataclass(frozen=True)
class Area:
    """A rectangle that a body's footprint must be in, or at least its centre.

    Attributes:
        kind: What it is.
        row: The row that says so; none for what stands on the base without a row.
        carrier: The body that it moves with; none if it stands still.
        middle: Its centre, from the carrier's centre, or in the world [m].
        half: Half its edges, along its own axes [m].
        yaw: Of its axes [deg].
        wish: Where the body's centre is best, from the carrier's centre, or in the world [m].
    """

    kind: Literal["base", "top", "hollow", "region"]
    row: Row | None
    carrier: str | None
    middle: tuple[float, float] = (0.0, 0.0)
    half: tuple[float, float] = (0.0, 0.0)
    yaw: float = 0.0
    wish: tuple[float, float] = (0.0, 0.0)


def areas(world: World, name: str) -> list[Area]:
    """The areas that a body must be in; the first says where it is best."""
    if name in world.kept or world.row(name, "SPAN") is not None:
        return []
    found = []
    anywhere = world.row(name, "PLACE-ANYWHERE")
    if anywhere is not None and anywhere.region is not None:
        low, high = anywhere.region.low, anywhere.region.high
        middle = ((low[0] + high[0]) / 2, (low[1] + high[1]) / 2)
        half = ((high[0] - low[0]) / 2, (high[1] - low[1]) / 2)
        found.append(Area("region", anywhere, None, middle, half, 0.0, middle))
    carried = carrier(world, name)
    return [*found, carried] if carried is not None else found


def carrier(world: World, name: str) -> Area | None:
    """The area of what carries a body; none if nothing does."""
    seen = set()
    row = support(world, name)
    while row is None:
        taken = source(world, name)
        if taken is None:
            return Area("base", None, None)
        if taken[1].predicate not in ("GROUP", "SYMMETRY-ALONG") or taken[0] in seen or taken[0] not in world.of:
            return None
        seen.add(taken[0])
        name = taken[0]
        row = support(world, name)
        if name in world.kept:
            return None
    if row.predicate == "SPAN":
        return None
    ref = row.ref
    if ref is None or (ref in world.items and world.items[ref].primitive == "ground"):
        return Area("base", row, None)
    if ref in world.items and world.items[ref].primitive == "fluid":
        held = world.container(ref)
        return _fluid(world, ref, row) if held is None or ref in world.bodies else _hollow(world, held, row)
    if row.predicate == "PLACE-IN":
        return _hollow(world, ref, row)
    return _top(world, ref, row)


def _fluid(world: World, fluid: str, row: Row) -> Area:
    x, y, _ = world.extents(fluid)
    return Area("hollow", row, fluid, (0.0, 0.0), (x / 2, y / 2))


def _hollow(world: World, name: str, row: Row) -> Area:
    if name not in world.items:
        raise LayoutError(f"{row}: {name} is a group and has no hollow; name one of its members")
    free, yaw = hollow(world.items[name]), world.yaw[name]
    middle = turned((free.center[0], free.center[1]), yaw)
    return Area("hollow", row, name, middle, (free.size[0] / 2, free.size[1] / 2), yaw, middle)


def _top(world: World, ref: str, row: Row) -> Area:
    if ref in world.groups:
        owner = world.owner(ref)
        spans = [world.span(owner, axis) for axis in (0, 1)]
        middle = (sum(spans[0]) / 2, sum(spans[1]) / 2)
        half = ((spans[0][1] - spans[0][0]) / 2, (spans[1][1] - spans[1][0]) / 2)
        return Area("top", row, owner, middle, half, 0.0, middle)
    item, yaw = world.items[ref], world.yaw[ref]
    if any(world.rotation(ref)[:2]):  # lying: the box round it
        x, y, _ = world.extents(ref)
        return Area("top", row, ref, (0.0, 0.0), (x / 2, y / 2))
    x, y, _ = local_size(item)
    at = surface(item, row.anchor) if row.anchor is not None else (0.0, 0.0, 0.0)
    return Area("top", row, ref, (0.0, 0.0), (x / 2, y / 2), yaw, turned(at[:2], yaw))


def rider_of(world: World, name: str) -> str | None:
    """The body that a body moves with when that one is moved."""
    area = carrier(world, name) if name not in world.kept else None
    return area.carrier if area is not None else None


def footprint(world: World, name: str, yaw: float) -> tuple[float, float]:
    """Half a body's footprint along axes turned by `yaw` [m]."""
    if any(world.rotation(name)[:2]) or world.items[name].primitive in ("sphere", "cylinder", "capsule"):
        x, y, _ = world.extents(name)
        turn = yaw
        round_one = world.items[name].primitive != "box" and not any(world.rotation(name)[:2])
        if round_one:
            return x / 2, y / 2
    else:
        x, y, _ = local_size(world.items[name])
        turn = yaw - world.yaw[name]
    c, s = turned((1.0, 0.0), turn)
    return (abs(c) * x + abs(s) * y) / 2, (abs(s) * x + abs(c) * y) / 2


def room_in(world: World, name: str, area: Area) -> tuple[float, float]:
    """How far a body's centre may be from an area's middle along the area's axes [m].

    Raises:
        LayoutError: it does not fit into a hollow or a region.
    """
    mine = footprint(world, name, area.yaw)
    spare = (area.half[0] - mine[0], area.half[1] - mine[1])
    if area.kind == "top":  # what is wider than its support lies with its centre over it
        return (spare[0] if spare[0] >= 0 else area.half[0], spare[1] if spare[1] >= 0 else area.half[1])
    if min(spare) < -TOUCH / 2:
        where = "the region" if area.kind == "region" else area.carrier
        raise LayoutError(
            f"{area.row}: {name} is {2 * mine[0]:g} x {2 * mine[1]:g} m and does not fit into {where}, which is "
            f"{2 * area.half[0]:g} x {2 * area.half[1]:g} m inside; make one of them another size"
        )
    return max(spare[0], 0.0), max(spare[1], 0.0)


def check_room_above(world: World, name: str) -> None:
    """Refuse what is higher than a hollow that is closed above.

    Raises:
        LayoutError: names both heights.
    """
    row = support(world, name) if name not in world.kept else None
    if row is None or row.predicate != "PLACE-IN" or row.ref not in world.items:
        return
    holder = world.items[row.ref]
    if not is_hollow(holder):
        hollow(holder)
    free = hollow(holder)
    closed = free.high[2] < local_size(holder)[2] - TOUCH
    if closed and world.extents(name)[2] > free.size[2] + TOUCH:
        raise LayoutError(
            f"{row}: {name} is {world.extents(name)[2]:g} m high and does not fit into {row.ref}, whose hollow is "
            f"{free.size[2]:g} m high; make one of them another size"
        )
