"""Templates: composites of the topology, written out as the primitive rows that their entry of the table names."""

from __future__ import annotations

from wsim.plan.layout.bodies import hollow
from wsim.plan.layout.boxes import TOUCH
from wsim.plan.layout.rows import Row, stated_by
from wsim.plan.schema import Plan, PlanObject, Relation


def expand(plan: Plan) -> list[Row]:
    """Every row of the plan as primitive rows, in the plan's order.

    Raises:
        LayoutError: a fluid fills what has no hollow.
    """
    items = {item.name: item for item in plan.objects}
    return [row for item in plan.objects for relation in item.relations for row in expand_row(item, relation, items)]


def expand_row(item: PlanObject, relation: Relation, items: dict[str, PlanObject]) -> list[Row]:
    """The primitive rows of one row; a primitive row is its own expansion."""
    spec = relation.spec
    if not spec.expands:
        return [Row.of(item.name, relation)]
    given = {**spec.defaults, **stated_by(relation)}
    given |= {name: given[own] for name, own in spec.renames.items()}
    if spec.fills is not None:
        given["value"] = round(hollow(items[relation.ref or ""]).size[2] * spec.fills, 6)
    return [Row.of(item.name, relation, part, **given) for part in spec.expands]


def is_block(item: PlanObject, items: dict[str, PlanObject]) -> bool:
    """Whether a fluid in a tank, of a size of its own, is as high as its level and leaves some of the tank empty."""
    held, level = item.relation("PLACE-IN"), item.relation("FREE-SURFACE-AT")
    tank = items.get(held.ref or "") if held is not None else None
    if tank is None or not tank.size or tank.primitive != "tank" or level is None or level.value is None:
        return False
    if len(item.size) != len(tank.size) or abs(item.size[2] - level.value) > TOUCH:
        return False
    spare = [whole - edge for edge, whole in zip(item.size, tank.size, strict=True)][:2]
    return min(spare) >= -TOUCH and max(spare) > TOUCH


def write_out_blocks(plan: Plan) -> Plan:
    """A copy in which blocks of fluid have no level beside their height, which says the same: only fillings have."""
    items = {item.name: item for item in plan.objects}

    def written(item: PlanObject) -> PlanObject:
        if not is_block(item, items):
            return item
        return item.related([row for row in item.relations if row.predicate != "FREE-SURFACE-AT"])

    return plan.model_copy(update={"objects": [written(item) for item in plan.objects]})


def write_out_fluids(plan: Plan) -> Plan:
    """A copy in which fluids that fill a container say so in PLACE-IN and FREE-SURFACE-AT, which later steps read."""
    items = {item.name: item for item in plan.objects}

    def written(item: PlanObject, row: Relation) -> list[Relation]:
        if row.spec.fills is None:
            return [row]
        made = expand_row(item, row, items)
        return [Relation(predicate=part.predicate, ref=part.ref, value=part.value) for part in made]

    def poured(item: PlanObject) -> PlanObject:
        if all(row.spec.fills is None for row in item.relations):
            return item
        return item.related([part for row in item.relations for part in written(item, row)])

    return plan.model_copy(update={"objects": [poured(item) for item in plan.objects]})
