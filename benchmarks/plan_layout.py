"""How long the layout takes, and how full a tray it fills.

    python benchmarks/plan_layout.py [--tight] [--json FILE]

Prints a table of offices (desks, chairs, what is on the desks, shelves and plants): objects, seconds, rows that are not
kept (there must be none). With --tight, one of trays instead: each is cut into bricks, which are made smaller and put
back; how many of the trays are filled by placing one brick after the other, and how many with the search.
"""

from __future__ import annotations

import argparse
import json
import math
import random
import time
from pathlib import Path

from wsim.plan.layout import LayoutError, layout, unsatisfied
from wsim.plan.layout.free import Search
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


def tray(bricks: int, share: float, rng: random.Random) -> Plan:
    """A tray cut into bricks, each then this share of its length and width."""
    pieces = [(0.8, 1.0)]
    while len(pieces) < bricks:
        x, y = pieces.pop(pieces.index(max(pieces, key=lambda piece: piece[0] * piece[1])))
        cut = rng.uniform(0.35, 0.65)
        pieces += [(x * cut, y), (x - x * cut, y)] if x > y else [(x, y * cut), (x, y - y * cut)]
    rng.shuffle(pieces)
    sizes = [(math.floor(1000 * share * x) / 1000, math.floor(1000 * share * y) / 1000, 0.1) for x, y in pieces]
    objects = [thing("tray", (0.8, 1.0, 0.02)), *(thing(f"b{k}", size, on("tray")) for k, size in enumerate(sizes))]
    return Plan(title="tray", prompt="a tray", objects=objects)


def filled(plan: Plan) -> bool:
    """Whether the layout finds a place for all."""
    try:
        return not unsatisfied(layout(plan))
    except LayoutError:
        return False


def measure_trays() -> list[dict[str, float]]:
    """Fill trays of more and more bricks."""
    rng, rows = random.Random(1), []
    filled(tray(3, 1.0, rng))  # imports
    print("| bricks | of the tray | trays | one by one | with the search | slowest [s] |\n" + "| --- " * 6 + "|")
    for bricks in (3, 4, 6, 8, 10):
        for share in (1.0, 0.92, 0.85):
            plans = [tray(bricks, share, rng) for _ in range(10)]
            search, Search.run = Search.run, lambda _: None
            alone = sum(map(filled, plans))
            Search.run = search
            both, slowest = 0, 0.0
            for plan in plans:
                started = time.process_time()
                both += filled(plan)
                slowest = max(slowest, time.process_time() - started)
            rows.append({"bricks": bricks, "share": share**2, "alone": alone, "search": both, "slowest": slowest})
            print(f"| {bricks} | {share**2:.0%} | {len(plans)} | {alone} | {both} | {slowest:.2f} |", flush=True)
    return rows


def measure_offices() -> list[dict[str, float]]:
    """Furnish offices of more and more desks."""
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
    return rows


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description="Measure the layout.")
    parser.add_argument("--tight", action="store_true", help="fill trays")
    parser.add_argument("--json", type=Path, help="also write the table here")
    given = parser.parse_args()
    rows = measure_trays() if given.tight else measure_offices()
    if given.json:
        given.json.write_text(json.dumps(rows, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
