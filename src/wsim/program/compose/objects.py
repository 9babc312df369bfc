"""The objects of a plan, in order: each a call of the scene, or a loop of calls."""

from __future__ import annotations

from collections.abc import Sequence

from wsim.plan.schema import FromScatter, FromTerrain, PlanObject
from wsim.program.compose import assets, fluids, land, loops, robots, shapes, vehicles
from wsim.program.compose.draft import Draft
from wsim.program.source import call, tuple_of


def statements(draft: Draft) -> list[str]:
    """All objects; those that the program speaks of again get a variable."""
    plan = draft.plan
    lines: list[str] = []
    containers = {fluids.container(item) for item in plan.objects if item.primitive == "fluid"}
    jointed = {name for joint in plan.joints for name in (joint.child, joint.parent)}
    jointed |= {name for cord in plan.cords for name in (cord.a, cord.b, *(each.object for each in cord.around or ()))}
    for group in loops.groups(_ordered(plan.objects), jointed):
        if len(group) > 1:
            lines += loops.loop(draft, group)
            continue
        item = group[0]
        if isinstance(item.built, FromTerrain):
            lines += land.terrain(draft, item, item.built)
            continue
        if isinstance(item.built, FromScatter):
            lines += land.scatter(draft, item, item.built)
            continue
        target = "scene." + item.primitive
        if item.name in containers | jointed or robots.moved(item) or vehicles.driven(item):
            draft.handles[item.name] = draft.variable(item.name)
            target = f"{draft.handles[item.name]} = {target}"
        lines += call(target, [f'"{item.name}"', *_arguments(draft, item)])
        if item.surface_velocity is not None:
            moved = f"velocity={tuple_of(item.surface_velocity)}"
            lines += call("scene.surface_velocity", [f'"{item.name}"', moved])
    return lines


def _arguments(draft: Draft, item: PlanObject) -> list[str]:
    if item.primitive == "fluid":
        return fluids.arguments(draft, item)
    if item.primitive == "asset":
        return assets.arguments(item)
    if item.primitive == "robot":
        return robots.arguments(item)
    if item.primitive == "vehicle":
        return vehicles.arguments(draft, item)
    return shapes.arguments(draft, item)


def _ordered(objects: Sequence[PlanObject]) -> list[PlanObject]:
    """In the plan's order, but terrain first, and fluids straight after the tank that they fill, from below."""
    filling = [item for item in objects if item.primitive == "fluid" and fluids.container(item) is not None]
    filling.sort(key=fluids.level)
    ordered = []
    for item in sorted(objects, key=lambda one: one.primitive != "terrain"):
        if item not in filling:
            ordered += [item, *(fluid for fluid in filling if fluids.container(fluid) == item.name)]
    return ordered
