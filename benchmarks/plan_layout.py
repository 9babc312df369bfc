"""How long the layout takes: offices of desks, chairs, what is on the desks, shelves and plants.

    python benchmarks/plan_layout.py [--json FILE]

Prints a table: objects, seconds, rows that are not kept (there must be none).
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path

from wsim.plan.layout import layout, unsatisfied
from wsim.plan.schema import Material, Plan, PlanObject, Pose, Region, Relation

WOOD = Material(name="wood", density=600.0)
ON_DESK = {"monitor": (0.2, 0.5, 0.4), "laptop": (0.25, 0.35, 0.2), "mug": (0.08, 0.1, 0.1)}


def thing(
    name: str, size: tuple[float, ...], *rows: Relation, role: str = "rigid_body", **fields: object
) -> PlanObject:
    """A box of wood."""
    return PlanObject.proxy(
        name=name, role=role, primitive="box", size=size, material=WOOD, relations=list(rows), **fields
    )


def on(ref: str) -> Relation:
    """A row that puts something on `ref`."""
    return Relation(predicate="PLACE-ON", ref=ref)


def office(desks: int) -> Plan:
    """A room with this many workplaces of five objects each, shelves along its walls, plants in a corner."""
    side = 3.0 + 2.0 * desks**0.5
    base = Relation(predicate="PLACE-ON-BASE")
    anywhere = Relation(predicate="PLACE-ANYWHERE", region=Region(low=(-side, -side), high=(side, side)))
    objects = [PlanObject.proxy(name="ground", role="terrain", primitive="ground", state="static")]
    walls = [
        (side, 0.0, 0.1, 2 * side),
        (-side, 0.0, 0.1, 2 * side),
        (0.0, side, 2 * side, 0.1),
        (0.0, -side, 2 * side, 0.1),
    ]
    for k, (x, y, dx, dy) in enumerate(walls):
        pose = Pose(position=(x * 1.1, y * 1.1, 1.25))
        objects.append(thing(f"wall_{k}", (dx, dy, 2.5), role="background", state="static", pose=pose))
    for k in range(desks):
        desk, chair = f"desk_{k}", f"chair_{k}"
        objects.append(thing(desk, (0.7, 1.4, 0.74), anywhere))
        objects.append(
            thing(
                chair,
                (0.5, 0.5, 0.9),
                Relation(predicate="BACK-OF", ref=desk, gap=0.1),
                Relation(predicate="ORIENT-BY-RELATIVE-SIDE", ref=desk),
            )
        )
        objects += [thing(f"{name}_{k}", size, on(desk)) for name, size in ON_DESK.items()]
    for k in range(max(1, desks // 4)):
        rows = [base, Relation(predicate="BACK-OF", ref="wall_0", gap=0.0), Relation(predicate="FACING-BACK")]
        objects.append(thing(f"shelf_{k}", (0.3, 0.8, 1.8), *rows))
        corner = Region(low=(-side, -side), high=(-side / 3, -side / 3))
        objects.append(thing(f"plant_{k}", (0.4, 0.4, 1.2), Relation(predicate="PLACE-ANYWHERE", region=corner)))
    return Plan(title="office", prompt="an office", objects=objects)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description="Measure the layout.")
    parser.add_argument("--json", type=Path, help="also write the table here")
    given = parser.parse_args()
    layout(office(1))  # imports
    rows = []
    print("| objects | seconds | rows not kept |\n| --- | --- | --- |")
    for desks in (4, 9, 18, 36):
        plan = office(desks)
        started = time.perf_counter()
        placed = layout(plan)
        seconds = time.perf_counter() - started
        rows.append({"objects": len(plan.objects), "seconds": seconds, "not_kept": len(unsatisfied(placed))})
        print(f"| {len(plan.objects)} | {seconds:.2f} | {rows[-1]['not_kept']} |", flush=True)
    if given.json:
        given.json.write_text(json.dumps(rows, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
