"""Tables that are not the catalogue's, of a size or a material of their own: a top on four legs."""

from __future__ import annotations

from wsim.plan.schema import External, PlanObject, Proxy, Relation
from wsim.rules.cast import Cast, Thing
from wsim.rules.scenes.catalogue import itself

LEGGED = ("table", "desk", "workbench")
THICK, LEG = 0.04, 0.06  # of the top, and a leg's edge [m]
_CORNERS = (("FRONT", "LEFT"), ("FRONT", "RIGHT"), ("BACK", "LEFT"), ("BACK", "RIGHT"))


def on_legs(thing: Thing, item: PlanObject, cast: Cast, taken: set[str]) -> list[PlanObject]:
    """The top in place of a table's stand-in, and its legs, each with the rows that say where; else the item alone."""
    if thing.noun.key not in LEGGED or itself(item, thing, cast) is not None or thing.support is not None:
        return [item]
    x, y, height = item.size
    top = item.model_copy(update={"construction": Proxy(primitive="box", size=(x, y, THICK))})
    rows = [row for row in item.relations if row.predicate != "PLACE-ON-BASE"]
    made = [top.related([Relation(predicate="SPAWNED-ABOVE", value=round(height - THICK, 6)), *rows])]
    leg = Proxy(primitive="box", size=(LEG, LEG, round(height - THICK, 6)))
    for number, corner in enumerate(_CORNERS, 1):
        name = f"{item.name}_leg_{number}"
        taken.add(name)
        edges = [Relation(predicate=f"ALIGN-{edge}", ref=item.name) for edge in corner]
        placed = item.model_copy(update={"name": name, "construction": leg})
        made.append(placed.related([Relation(predicate="PLACE-ON-BASE"), *edges]))
    cast.assumptions = [
        one for one in cast.assumptions if (one.subject, one.choice) != (thing.words, "a box stands for it")
    ]
    if isinstance(item.construction, External):
        cast.assume(thing.words, "a top on four legs", "the catalogue's is of another size, or looks other")
    return made
