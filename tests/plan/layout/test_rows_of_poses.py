"""Rows of the whole table that some poses keep can be laid out: the poses come first, the rows are measured on them."""

from random import Random

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.plan.layout.scenes import WOOD, make, rel, solve, tank, water
from wsim.plan.layout import LayoutError, check_clear, layout, residual, unsatisfied
from wsim.plan.layout.bodies import around
from wsim.plan.schema import PREDICATES, Plan, PlanObject, Pose, Relation

QUICK = settings(derandomize=True, max_examples=80, deadline=None, suppress_health_check=list(HealthCheck))
FACING = {0: "FACING-FRONT", 90: "FACING-LEFT", 180: "FACING-BACK", -90: "FACING-RIGHT"}
STEP = 0.2  # poses are on a grid [m], so that edges and centres are often in line
SURFACE = 0.32  # of the water [m]
# Places are not sought for a heading's sake, a group's rows are about several bodies, and these give sizes or regions.
TRIED = [
    name
    for name, spec in PREDICATES.items()
    if not spec.by_place
    and spec.of_role is None
    and not {"members", "other"} & set(spec.needs)
    and spec.kind not in ("size", "posture")
    and name not in ("PLACE-ANYWHERE", "RANDOM-ROT")
]


def scene(random: Random) -> list[PlanObject]:
    """Bodies at rest on the base, on each other, in a tank and in the air; none in another."""
    items = [water(), tank().model_copy(update={"pose": Pose(position=(6.0, 0.0, 0.0))})]
    for _ in range(random.randint(3, 9)):
        size = (random.choice((0.2, 0.4, 0.6)), random.choice((0.2, 0.4)), random.choice((0.2, 0.3, 0.4)))
        x, y, bottom = random.randint(-6, 6) * STEP, random.randint(-6, 6) * STEP, random.choice((0.0, 0.0, 0.0, 0.2))
        where = random.choice(("base", "base", "on", "water"))
        if where == "on" and len(items) > 2:
            below = around(random.choice(items[2:]))
            x, y, bottom = below.center[0], below.center[1] + random.choice((0.0, 0.05)), below.high[2]
        elif where == "water":
            x, y = 6.0 + random.choice((0.0, 0.2, -0.2)), 0.0
            bottom = random.choice((SURFACE, SURFACE - size[2] / 2, SURFACE - size[2], 0.02))
        pose = Pose(position=(x, y, bottom + size[2] / 2), rotation_deg=(0.0, 0.0, random.choice(list(FACING))))
        item = PlanObject.proxy(name=f"b{len(items) - 2}", role="rigid_body", primitive="box", size=size, material=WOOD,
                                pose=pose)  # fmt: skip
        try:
            check_clear(make(*items, item))
        except LayoutError:
            continue
        items.append(item)
    return items


def rows_of(random: Random, plan: Plan, item: PlanObject) -> list[Relation]:
    """Rows that the pose keeps: one support, if any does, and what is true of it and those before it."""
    earlier = [one.name for one in plan.objects[: plan.objects.index(item)]]
    rows = [rel(FACING[int(item.pose.rotation_deg[2])])]
    for name in random.choices(TRIED, k=150):
        spec = PREDICATES[name]
        if len(rows) > 5 or (spec.carries and any(row.spec.carries for row in rows)):
            continue
        # A carrier is not moved under what it carries, so those here have poses; a tank carries nothing on its rim.
        refs = (["tank"] if name == "PLACE-IN" else ["b0", "water"]) if spec.carries else earlier
        stated = {key: random.choice(refs) for key in ("ref", "axis") if key in (*spec.needs, *spec.takes)}
        if spec.ref_role == "fluid" and stated["ref"] != "water":
            continue
        free = "value" if "value" in spec.needs else "gap" if "gap" in spec.takes else None
        row = measured(plan, item, Relation(predicate=name, **stated, **({free: 0.0} if free else {})), free)
        rows += [row] if row is not None else []
    return rows


def measured(plan: Plan, item: PlanObject, row: Relation, free: str | None) -> Relation | None:
    """The row if the pose keeps it, with its free length as measured."""
    try:
        if free is not None:
            row = row.model_copy(update={free: round(residual(plan, item, row), 6)})
        return row if residual(plan, item, row) < 1e-5 else None
    except LayoutError:  # a body of water has no sides
        return None


@QUICK
@given(st.randoms(use_true_random=True))
def test_rows_that_poses_keep_are_laid_out(random):
    items = scene(random)
    plan = make(*items)
    made = []
    for item in items:
        rows = rows_of(random, plan, item) if item.name.startswith("b") and item.name != "b0" else []
        carried = any(row.spec.carries for row in rows)
        made.append(item.related(rows).model_copy(update={"pose": None}) if carried else item)
    placed = solve(*made)
    assert unsatisfied(placed, tolerance=1e-4) == [] and layout(placed) == placed
