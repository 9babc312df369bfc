"""Plans made from poses can be laid out and keep every row; plans with a contradiction are refused by name."""

import math

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.plan.layout.scenes import GROUND, box, make, rel, solve, tank, water
from wsim.plan.layout import LayoutError, layout, unsatisfied
from wsim.plan.layout.boxes import Box, Solid, depth, rotation
from wsim.plan.schema import PlanObject, Pose, Relation

QUICK = settings(derandomize=True, max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
FACINGS = ("FACING-FRONT", "FACING-LEFT", "FACING-BACK", "FACING-RIGHT")
CENTIMETRES = st.integers(4, 60).map(lambda n: n / 100)
SIZES = st.tuples(CENTIMETRES, CENTIMETRES, CENTIMETRES)


def turned_size(size, facing):
    return size if facing in (None, "FACING-FRONT", "FACING-BACK") else (size[1], size[0], size[2])


@st.composite
def worlds(draw):
    """Boxes in columns that do not meet, each with rows derived from where it is. The first has a pose."""
    count = draw(st.integers(2, 7))
    boxes: list[tuple[str, tuple, str | None, tuple]] = []
    items: list[PlanObject] = []
    x = 0.0
    for k in range(count):
        name, size = f"b{k}", draw(SIZES)
        facing = draw(st.sampled_from([None, *FACINGS]))
        wide = turned_size(size, facing)
        if k == 0:
            centre = (0.0, 0.0, size[2] / 2)
            items.append(box(name, size=size, pose=Pose(position=centre)))
            boxes.append((name, size, None, centre))
            x = size[0] / 2
            continue
        stacked = draw(st.booleans()) and k > 1
        ref = boxes[draw(st.integers(0, k - 1))]
        rows: list[Relation] = [rel(facing)] if facing else []
        if stacked and not any(r.ref == ref[0] and r.predicate == "PLACE-ON" for i in items for r in i.relations):
            top = ref[3][2] + ref[1][2] / 2
            centre = (ref[3][0], ref[3][1], top + size[2] / 2)
            if all(not meets(centre, wide, other) for other in boxes):
                rows.append(rel("PLACE-ON", ref[0]))
                rows += derived(draw, name, centre, wide, [ref])
                items.append(box(name, *rows, size=size))
                boxes.append((name, wide, facing, centre))
                continue
        x += 0.7 + wide[0] / 2
        centre = (round(x, 4), draw(st.integers(-100, 100)) / 100, size[2] / 2)
        x += wide[0] / 2
        rows += [rel("PLACE-ON-BASE"), *derived(draw, name, centre, wide, boxes)]
        items.append(box(name, *rows, size=size))
        boxes.append((name, wide, facing, centre))
    order = draw(st.permutations(range(count)))
    return [items[k] for k in order], {name: centre for name, _, _, centre in boxes}


def meets(centre, size, other):
    return all(abs(centre[k] - other[3][k]) < (size[k] + other[1][k]) / 2 - 1e-6 for k in range(3))


def derived(draw, name, centre, size, boxes):
    """One row along each axis, or more, that the pose keeps."""
    rows = []
    for axis in (0, 1):
        for _ in range(draw(st.integers(1, 2))):
            ref, ref_size, _, at = draw(st.sampled_from(boxes))
            rows.append(row_along(draw, axis, centre, size, ref, ref_size, at))
    return [row for row in rows if row is not None]


def row_along(draw, axis, centre, size, ref, ref_size, at):
    """A row that says where a box is against another along an axis; none if only faces in line would say it."""
    gap = abs(centre[axis] - at[axis]) - (size[axis] + ref_size[axis]) / 2
    if gap >= 0.0:
        ahead = centre[axis] > at[axis]
        return rel([("BACK-OF", "FRONT-OF"), ("RIGHT-OF", "LEFT-OF")][axis][ahead], ref, gap=round(gap, 6))
    if abs(centre[axis] - at[axis]) < 1e-9:
        return rel(["ALIGN-CENTER-FB", "ALIGN-CENTER-LR"][axis], ref)
    return None


@QUICK
@given(worlds())
def test_a_consistent_plan_keeps_every_row(world):
    items, _ = world
    placed = solve(GROUND, *items)
    assert unsatisfied(placed, tolerance=1e-4) == []
    assert layout(placed) == placed


@QUICK
@given(worlds(), st.data())
def test_a_contradiction_is_refused_by_name(world, data):
    """One more row, off by 5 cm from where the others put the object."""
    items, _ = world
    rest = [i for i in items if any(r.predicate in ("FRONT-OF", "BACK-OF") for r in i.relations)]
    if not rest:
        return
    item = data.draw(st.sampled_from(rest))
    row = next(r for r in item.relations if r.predicate in ("FRONT-OF", "BACK-OF"))
    wrong = row.model_copy(update={"gap": (row.gap or 0.0) + 0.05})
    changed = [i.related([*i.relations, wrong]) if i is item else i for i in items]
    with pytest.raises(LayoutError) as caught:
        solve(*changed)
    assert f"{item.name} {row.predicate} {row.ref}" in str(caught.value) and "0.05 m along X" in str(caught.value)


@QUICK
@given(st.integers(2, 8), st.integers(0, 7))
def test_a_circle_of_supports_is_refused_by_name(count, first):
    items = [box(f"b{k}", rel("PLACE-ON", f"b{(k + 1) % count}")) for k in range(count)]
    items = items[first % count :] + items[: first % count]
    with pytest.raises(LayoutError) as caught:
        layout(make().model_copy(update={"objects": items}))
    assert all(f"b{k} PLACE-ON b{(k + 1) % count}" in str(caught.value) for k in range(count))


@QUICK
@given(st.integers(101, 300), st.booleans(), st.sampled_from(["PLACE-IN", "FLOATS-AT-SURFACE"]))
def test_what_is_too_large_for_a_container_is_refused_by_name(wide, along_x, row):
    size = (wide / 100, 0.1, 0.1) if along_x else (0.1, wide / 100 - 0.4, 0.1)
    with pytest.raises(LayoutError) as caught:
        solve(tank(), water(), box("giant", rel(row, "tank" if row == "PLACE-IN" else "water"), size=size))
    assert f"giant {row}" in str(caught.value) and "does not fit into tank, which is 1 x 0.6 m" in str(caught.value)


@QUICK
@given(st.permutations(["PLACE-ON-BASE", "PLACE-ON", "PLACE-IN", "SPAWNED-ABOVE", "FLOATS-AT-SURFACE"]))
def test_two_supports_are_refused_by_name(kinds):
    refs = {"PLACE-ON": "a", "PLACE-IN": "tank", "FLOATS-AT-SURFACE": "water", "SPAWNED-ABOVE": "a"}
    rows = [rel(kind, refs.get(kind), **({"value": 0.1} if kind == "SPAWNED-ABOVE" else {})) for kind in kinds[:2]]
    double = box("b").related(rows)
    with pytest.raises(LayoutError, match=f"b {kinds[0]}.*, and b {kinds[1]}.*keep one of them"):
        layout(make().model_copy(update={"objects": [tank(), water(), box("a"), double]}))


@QUICK
@given(st.integers(1, 14), st.integers(0, 5))
def test_what_is_free_is_put_where_it_hinders_nothing(count, seed):
    table = box("table", size=(1.2, 0.8, 0.7))
    things = [box(f"b{k}", rel("PLACE-ON", "table"), rel("RANDOM-ROT"), size=(0.16, 0.1, 0.1)) for k in range(count)]
    placed = solve(GROUND, table, *things, seed=seed)
    assert unsatisfied(placed) == [] and solve(GROUND, table, *things, seed=seed) == placed


@QUICK
@given(st.integers(0, 359), st.integers(0, 359), st.integers(10, 60), st.sampled_from(["box", "cylinder", "sphere"]))
def test_depth_of_turned_bodies_against_samples(a_yaw, b_yaw, apart, kind):
    """A point that is well inside both means that they overlap; apart along the line between, that they do not."""
    a = Solid("box", (0.0, 0.0, 0.0), rotation((0, 0, a_yaw)), (0.2, 0.1, 0.1))
    half = (0.15, 0.15, 0.15) if kind != "box" else (0.15, 0.05, 0.1)
    b = Solid(kind, (apart / 100, 0.05, 0.0), rotation((0, 0, b_yaw)), half)
    inside = [
        (x / 50, y / 50)
        for x in range(-15, 16)
        for y in range(-15, 16)
        if holds(a, x / 50, y / 50) and holds(b, x / 50, y / 50)
    ]
    if inside:
        assert depth(a, b) > 0.0
    if math.hypot(apart / 100, 0.05) > math.hypot(0.2, 0.1) + math.hypot(*half[:2]):
        assert depth(a, b) <= 0.0
    assert (depth(a, b) > 0.0) == (depth(b, a) > 0.0)


def holds(solid: Solid, x: float, y: float) -> bool:
    dx, dy = x - solid.center[0], y - solid.center[1]
    if solid.kind != "box":
        return math.hypot(dx, dy) < solid.half[0]
    return all(abs(dx * solid.axes[0][k] + dy * solid.axes[1][k]) < solid.half[k] for k in (0, 1))


def test_an_axis_aligned_overlap_is_the_shallowest():
    assert Box((0, 0, 0), (1, 1, 1)).overlap(Box((0.9, 0, 0), (2, 1, 1))) == pytest.approx(0.1)
