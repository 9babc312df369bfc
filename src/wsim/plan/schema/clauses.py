"""What clauses name is in the plan: objectives by number, objects and joints by name, checked properties."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from wsim.plan.schema.clause import OF_CORDS, OF_JOINTS, OF_OBJECTS, WHOLE

if TYPE_CHECKING:
    from wsim.plan.schema.draft import Draft


def clause_problems(plan: Draft) -> Iterator[str]:
    """What a clause names and the plan has not."""
    objects, joints = {item.name for item in plan.objects}, {joint.name for joint in plan.joints}
    cords = {cord.name for cord in plan.cords}
    for i, clause in enumerate(plan.clauses):
        for number in clause.objectives:
            if number >= len(plan.objectives):
                yield (
                    f"clauses.{i}.by: no objective {number}; the plan has {len(plan.objectives)}, and they count from 0"
                )
        for name, field in clause.things:
            fields: tuple[str, ...] = OF_OBJECTS if name in objects else OF_JOINTS if name in joints else OF_CORDS
            fields = fields if name != WHOLE else ("duration",)
            if name not in objects | joints | cords | {WHOLE}:
                yield f"clauses.{i}.by: no object, joint or cord {name!r}; name one, or an objective by its number"
            elif field and field not in fields:
                yield f"clauses.{i}.by: {name} has no {field!r} that is checked; it has {', '.join(fields)}"
