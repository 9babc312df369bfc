"""Templates: composites of the topology, written out as primitive rows.

`expand(plan)` gives every row of the plan in primitive form. Where no primitive says it (faces level, a bridge), a
template makes one of the layout's own rows, which `wsim.plan.layout.rows` lists.
"""

from __future__ import annotations

from wsim.plan.layout.bodies import hollow
from wsim.plan.layout.rows import Row
from wsim.plan.schema import Plan, PlanObject, Relation, Topology

CLEARANCE = 0.02  # under what is let go over something [m]
OVERLAP = 0.05  # of a bridge's end on what carries it [m]
FILLS = {"fills_container_to_top": 1.0, "fills_container_lower_half": 0.5}  # share of the hollow's height

_BESIDE = {"plus_x": "FRONT-OF", "minus_x": "BACK-OF", "plus_y": "LEFT-OF", "minus_y": "RIGHT-OF"}
_LEVEL = {"top_flush": "LEVEL-TOPS", "bottom_flush": "LEVEL-BOTTOMS", "centers": "LEVEL-CENTERS"}


def expand(plan: Plan) -> list[Row]:
    """Every row of the plan as primitive rows, in the plan's order.

    Raises:
        LayoutError: a fluid fills what has no hollow.
    """
    items = {item.name: item for item in plan.objects}
    return [row for item in plan.objects for relation in item.relations for row in expand_row(item, relation, items)]


def expand_row(item: PlanObject, relation: Relation, items: dict[str, PlanObject]) -> list[Row]:
    """The primitive rows of one row; a primitive row is its own expansion."""
    if relation.predicate in FILLS:
        return [
            Row.of(item.name, relation, "PLACE-IN"),
            Row.of(item.name, relation, "FREE-SURFACE-AT", ref=None, value=_level(relation, items)),
        ]
    made = _PARTS.get(relation.predicate)
    if made is None:
        return [Row.of(item.name, relation)]
    defaults = _DEFAULTS.get(relation.predicate, {})
    rows = []
    for predicate in made:
        wanted = {key: value for key, value in defaults.items() if getattr(relation, key, None) is None}
        if predicate == "SPAWNED-ABOVE":
            wanted = {"value": relation.gap if relation.gap is not None else defaults.get("gap", 0.0), "gap": None}
        rows.append(Row.of(item.name, relation, predicate, **wanted))
    return rows


def _level(relation: Relation, items: dict[str, PlanObject]) -> float:
    return round(hollow(items[relation.ref or ""]).size[2] * FILLS[relation.predicate], 6)


def write_out_fluids(plan: Plan) -> Plan:
    """A copy in which fluids that fill a container say so in PLACE-IN and FREE-SURFACE-AT, which later steps read."""
    items = {item.name: item for item in plan.objects}

    def written(item: PlanObject) -> PlanObject:
        if not any(row.predicate in FILLS for row in item.relations):
            return item
        rows: list[Relation] = []
        for row in item.relations:
            if row.predicate in FILLS:
                rows.append(Relation(predicate="PLACE-IN", ref=row.ref))
                rows.append(Relation(predicate="FREE-SURFACE-AT", value=_level(row, items)))
            else:
                rows.append(row)
        return item.model_copy(update={"topology": Topology(relation=rows)})

    return plan.model_copy(update={"objects": [written(item) for item in plan.objects]})


_PARTS: dict[str, tuple[str, ...]] = {
    "spawned_on_top": ("SPAWNED-ABOVE", "ALIGN-CENTER-FB", "ALIGN-CENTER-LR"),
    "placed_on_top": ("PLACE-ON",),
    "centered_on_ref": ("PLACE-ON", "ALIGN-CENTER-FB", "ALIGN-CENTER-LR"),
    "bottom_flush_water_surface": ("SPAWNED-ABOVE",),
    "center_at_water_surface": ("SUBMERGED",),
    "top_flush_water_surface": ("SUBMERGED",),
    "floats_at_surface": ("FLOATS-AT-SURFACE",),
    "bridge_between_a_and_b": ("SPAN",),
    "flush_with_platform_top": ("LEVEL-TOPS",),
    **{
        f"adjacent_{side}_{level}": (beside, height)
        for side, beside in _BESIDE.items()
        for level, height in _LEVEL.items()
    },
}
_DEFAULTS: dict[str, dict[str, object]] = {
    "spawned_on_top": {"gap": CLEARANCE},
    "center_at_water_surface": {"value": 0.0, "by": "center"},
    "top_flush_water_surface": {"value": 0.0, "by": "top"},
    "bridge_between_a_and_b": {"overlap": OVERLAP},
    **{name: {"gap": 0.0} for name in _PARTS if name.startswith("adjacent_")},  # "against" the face: touching it
}
