"""What clauses name is in the plan: objectives by number, objects and joints by name, checked properties."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from wsim.plan.schema.clause import OF_CORDS, OF_JOINTS, OF_OBJECTS, OF_OPENINGS, OF_SCHEDULES, WHOLE

if TYPE_CHECKING:
    from wsim.plan.schema.draft import Draft


def clause_problems(plan: Draft) -> Iterator[str]:
    """What a clause names and the plan has not."""
    fields: dict[str, tuple[str, ...]] = {WHOLE: ("duration",)}
    for things, checked in (
        (plan.schedules, OF_SCHEDULES), (plan.openings, OF_OPENINGS), (plan.cords, OF_CORDS),
        (plan.joints, OF_JOINTS), (plan.objects, OF_OBJECTS),
    ):  # fmt: skip
        fields |= {each.name: checked for each in things}
    fields |= {camera.name: () for camera in plan.cameras if camera.name not in fields}  # "a wide shot" is one
    for i, clause in enumerate(plan.clauses):
        for number in clause.objectives:
            if number >= len(plan.objectives):
                yield (
                    f"clauses.{i}.by: no objective {number}; the plan has {len(plan.objectives)}, and they count from 0"
                )
        for name, field in clause.things:
            if name not in fields:
                kinds = "object, joint, cord, schedule, opening or camera"
                yield f"clauses.{i}.by: no {kinds} {name!r}; name one, or an objective by its number"
            elif field and field not in fields[name]:
                has = ", ".join(fields[name]) or "none"
                yield f"clauses.{i}.by: {name} has no {field!r} that is checked; it has {has}"
