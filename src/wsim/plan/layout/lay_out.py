"""The layout itself: sizes, headings, heights and places in rounds, until every row holds."""

from __future__ import annotations

from wsim.plan import templates, views
from wsim.plan.layout import headings, heights, plane, sizes
from wsim.plan.layout.check import check_clear, check_rows
from wsim.plan.layout.errors import LayoutError
from wsim.plan.layout.land import set_down
from wsim.plan.layout.world import World
from wsim.plan.schema import Plan

ROUNDS = 12  # headings that look at places, and places that follow headings, settle in two or three
STILL = 1e-5  # a round that moves nothing by more has settled [m, deg]


def layout(plan: Plan) -> Plan:
    """A copy of the plan in which every object that occupies space has a pose.

    Raises:
        LayoutError: rows contradict each other, something does not fit where its rows want it, or objects
            interpenetrate; one line that names the rows, the values and the way out.
    """
    plan = templates.write_out_blocks(plan)
    world = World(plan, templates.expand(plan))
    sizes.give_heights(world)
    _settle(world)
    headings.check_headings(world)
    placed = templates.write_out_fluids(world.placed())
    check_clear(placed)
    check_rows(placed)
    return views.resolve_all(set_down(placed))


def _settle(world: World) -> None:
    """Headings, heights and places, until none of them changes any more."""
    for _ in range(ROUNDS):
        before = world.state() if world.centre else {}
        headings.turn_bodies(world)
        heights.raise_bodies(world)
        plane.arrange(world)
        sizes.stretch_bridges(world)
        if not headings.depends_on_places(world) or not _moved(before, world.state()):
            return
    moved = _moved(before, world.state())
    rows = [row for row in world.rows if row.item in moved and row.spec.by_place]
    raise LayoutError(
        f"headings and places chase each other after {ROUNDS} rounds: {'; '.join(map(str, rows or moved))}; "
        "give one of them a fixed heading, such as FACING-FRONT"
    )


def _moved(before: dict[str, tuple[float, ...]], after: dict[str, tuple[float, ...]]) -> list[str]:
    return [
        name
        for name, now in after.items()
        if any(abs(a - b) > STILL for a, b in zip(now, before.get(name, (float("inf"),) * len(now)), strict=True))
    ]
