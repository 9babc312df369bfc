"""Objects that differ in position and number only are made in one loop."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from wsim.plan.schema import PlanObject
from wsim.plan.schema.objects import SPREAD
from wsim.program.compose import shapes
from wsim.program.compose.draft import AXES, Draft
from wsim.program.compose.poses import position
from wsim.program.source import WIDTH, call, number


def groups(objects: Sequence[PlanObject], apart: Collection[str | None] = ()) -> list[list[PlanObject]]:
    """Runs of three or more neighbours named x_0, x_1, ... or x_1, x_2, ... that are alike in all but position.

    What is `apart` needs a variable of its own, and is never one of them.
    """
    found: list[list[PlanObject]] = []
    for item in objects:
        if found and not {item.name, found[-1][-1].name} & {*apart} and _continues(found[-1], item):
            found[-1].append(item)
        else:
            found.append([item])
    return [part for group in found for part in ([group] if len(group) != 2 else [[group[0]], [group[1]]])]


def _continues(group: list[PlanObject], item: PlanObject) -> bool:
    first = group[0]
    prefix, _, start = first.name.rpartition("_")
    if (
        item.surface_velocity is not None
        or start not in ("0", "1")
        or item.name != f"{prefix}_{int(start) + len(group)}"
        or item.primitive in ("tank", "fluid", "ground", "asset", "robot", "vehicle", *SPREAD)
    ):
        return False
    return _alike(first) == _alike(item) and position(first) != position(item)


def _alike(item: PlanObject) -> object:
    rotation = item.pose.rotation_deg if item.pose is not None else None
    motion = (item.velocity, item.angular_velocity_deg, item.rolling)
    return (item.primitive, item.size, item.material, item.state, motion, rotation, shapes.weight(item))


def loop(draft: Draft, group: Sequence[PlanObject]) -> list[str]:
    """The `for` statement that makes a group."""
    positions = [[number(value) for value in position(item)] for item in group]
    differing = [axis for axis in range(3) if len({each[axis] for each in positions}) > 1]
    where = [AXES[axis] if axis in differing else positions[0][axis] for axis in range(3)]
    prefix, _, first = group[0].name.rpartition("_")
    arguments = shapes.arguments(draft, group[0], at=f"({', '.join(where)})")
    lines = ["    " + line for line in _head(positions, differing, int(first))]
    return lines + call(f"scene.{group[0].primitive}", [f'f"{prefix}_{{i}}"', *arguments], depth=2)


def _head(positions: Sequence[Sequence[str]], differing: Sequence[int], first: int) -> list[str]:
    """The line that says what the loop goes through, or the lines where it does not fit one."""
    if len(differing) == 1:
        variable = AXES[differing[0]]
        values = [each[differing[0]] for each in positions]
    else:
        variable = f"({', '.join(AXES[axis] for axis in differing)})"
        values = [f"({', '.join(each[axis] for axis in differing)})" for each in positions]
    start = ["start=1"] if first == 1 else []
    counted = ", ".join(["(" + ", ".join(values) + ")", *start])
    head = f"for i, {variable} in enumerate({counted}):"
    if len(head) + 4 <= WIDTH:
        return [head]
    lines = [f"for i, {variable} in enumerate(", "    ("]
    lines += [*(f"        {value}," for value in values), "    )" + "," * bool(start)]
    return [*lines, *(f"    {argument}," for argument in start), "):"]
