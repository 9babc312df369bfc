"""Each template by itself: the rows it expands to, and where the object is in the end."""

import pytest

from tests.plan.layout.scenes import asset, at, box, rel, solve, tank, water, yaw
from wsim.plan.layout import LayoutError, extents, residual, unsatisfied
from wsim.plan.schema import TEMPLATES, PlanObject, Pose, Relation
from wsim.plan.schema.predicates import CLEARANCE
from wsim.plan.templates import expand_row, is_block
from wsim.program.compose import compose

A = box("a", pose=Pose(position=(1.0, 2.0, 0.05)))  # 0.2 x 0.4 x 0.1 m
SMALL = (0.1, 0.2, 0.04)


def test_every_template_expands():
    arguments = {"ref": "tank", "other": "a"}
    items = {"tank": tank(), "b": box("b"), "a": A}
    for name in TEMPLATES:
        needs = {key: arguments[key] for key in Relation.model_fields if key in arguments}
        if name != "bridge_between_a_and_b":
            needs.pop("other")
        rows = expand_row(items["b"], rel(name, **needs), items)
        assert rows and all(row.predicate not in TEMPLATES and row.item == "b" for row in rows)
        assert all(str(row).startswith(f"b {name} tank") for row in rows)  # errors name the row as it was written


def test_spawned_on_top():
    assert at(solve(A, box("b", rel("spawned_on_top", "a"), size=SMALL)), "b") == pytest.approx(
        (1, 2, 0.12 + CLEARANCE)
    )
    assert at(solve(A, box("b", rel("spawned_on_top", "a", gap=0.3), size=SMALL)), "b")[2] == pytest.approx(0.42)


def test_placed_on_top():
    table = asset("desk", "desk")
    placed = solve(table, box("b", rel("placed_on_top", "desk")), box("c", rel("placed_on_top", "desk")))
    assert at(placed, "b") == pytest.approx((0, 0, 0.79)) and at(placed, "c")[2] == pytest.approx(0.79)
    assert at(placed, "c")[:2] != (0, 0)  # the centre is free


def test_centered_on_ref():
    placed = solve(A, box("b", rel("centered_on_ref", "a"), size=SMALL))
    assert at(placed, "b") == pytest.approx((1, 2, 0.12))
    with pytest.raises(LayoutError, match=r"b and c overlap by 0.04 m"):
        solve(A, box("b", rel("centered_on_ref", "a"), size=SMALL), box("c", rel("centered_on_ref", "a"), size=SMALL))


@pytest.mark.parametrize("level", ["top_flush", "bottom_flush", "centers"])
@pytest.mark.parametrize(
    ("side", "where"),
    [("plus_x", (1.15, 2.0)), ("minus_x", (0.85, 2.0)), ("plus_y", (1.0, 2.3)), ("minus_y", (1.0, 1.7))],
)
def test_adjacent(side, where, level):
    row = rel(f"adjacent_{side}_{level}", "a")
    placed = solve(A, box("b", row, size=SMALL))
    height = {"top_flush": 0.08, "bottom_flush": 0.02, "centers": 0.05}[level]
    assert at(placed, "b") == pytest.approx((*where, height))
    assert residual(placed, placed.object("b"), row) < 1e-6
    moved = placed.object("b").model_copy(update={"pose": Pose(position=(*where, height + 0.01))})
    assert residual(placed.model_copy(update={"objects": [A, moved]}), moved, row) == pytest.approx(0.01)


@pytest.mark.parametrize(
    ("template", "height"),
    [("bottom_flush_water_surface", 0.37), ("center_at_water_surface", 0.32), ("top_flush_water_surface", 0.27)],
)
def test_water_surface(template, height):
    assert at(solve(tank(), water(), box("b", rel(template, "water"))), "b") == pytest.approx((0, 0, height))


def test_floats_at_surface_template():
    placed = solve(tank(), water(), box("b", rel("floats_at_surface", "water")))
    assert at(placed, "b") == pytest.approx((0, 0, 0.37))
    elsewhere = box("c", rel("floats_at_surface", "water"), rel("FRONT-OF", "b", gap=0.1))
    placed = solve(tank(), water(), box("b", rel("floats_at_surface", "water")), elsewhere)
    assert at(placed, "c")[0] - at(placed, "b")[0] == pytest.approx(0.3)


@pytest.mark.parametrize(("template", "level"), [("fills_container_to_top", 0.5), ("fills_container_lower_half", 0.25)])
def test_fills_container(template, level):
    placed = solve(tank(), water(rel(template, "tank")), box("b", rel("FLOATS-AT-SURFACE", "water")))
    assert at(placed, "b")[2] == pytest.approx(0.02 + level + 0.05)
    rows = placed.object("water").relations
    assert [row.predicate for row in rows] == ["PLACE-IN", "FREE-SURFACE-AT"] and rows[1].value == level
    bucket = asset("bucket", "bucket", role="container")
    filled = solve(bucket, water(rel(template, "bucket")))
    assert filled.object("water").relation("FREE-SURFACE-AT").value == pytest.approx(0.272 * level / 0.5, abs=5e-3)


def pillar(name: str, x: float, y: float, height: float = 1.0):
    return box(name, size=(0.4, 0.4, height), pose=Pose(position=(x, y, height / 2)))


def test_bridge_between_a_and_b():
    deck = box("deck", rel("bridge_between_a_and_b", "p", other="q"), size=(0.1, 0.3, 0.05))
    placed = solve(pillar("p", 1.0, 0.0), pillar("q", 3.0, 0.0), deck)
    assert placed.object("deck").size == pytest.approx((1.6 + 0.1, 0.3, 0.05))
    assert at(placed, "deck") == pytest.approx((2.0, 0.0, 1.025)) and yaw(placed, "deck") == 0.0
    longer = box("deck", rel("bridge_between_a_and_b", "p", other="q", overlap=0.2), size=(0.1, 0.3, 0.05))
    askew = solve(pillar("p", 0.0, 0.0), pillar("q", 1.0, 1.0), longer)
    assert askew.object("deck").size[0] == pytest.approx(2**0.5 * (1.0 - 0.4) + 0.4, abs=1e-6)
    assert yaw(askew, "deck") == pytest.approx(45.0) and at(askew, "deck") == pytest.approx((0.5, 0.5, 1.025))
    assert unsatisfied(askew) == []
    with pytest.raises(LayoutError, match=r"the top of p is at 1 m, that of q at 1.2 m; make them level"):
        solve(pillar("p", 1.0, 0.0), pillar("q", 3.0, 0.0, 1.2), deck)
    with pytest.raises(LayoutError, match=r"there is no gap between p and q"):
        solve(pillar("p", 1.0, 0.0), pillar("q", 1.4, 0.0), deck)
    with pytest.raises(LayoutError, match=r"a bridge is a box; deck is a sphere"):
        solve(pillar("p", 1.0, 0.0), pillar("q", 3.0, 0.0), deck.model_copy(update={"construction": BALL}))


BALL = box("ball").construction.model_copy(update={"primitive": "sphere", "size": (0.1,)})


def test_a_bridge_over_what_is_free():
    deck = box("deck", rel("bridge_between_a_and_b", "p", other="q"), size=(0.1, 0.3, 0.05))
    on_it = box("b", rel("PLACE-ON", "deck"), rel("ALIGN-CENTER-FB", "deck"), size=SMALL)
    p, q = box("p", size=(0.4, 0.4, 1.0)), box("q", rel("FRONT-OF", "p", gap=1.0), size=(0.4, 0.4, 1.0))
    placed = solve(p, q, deck, on_it)
    assert placed.object("deck").size[0] == pytest.approx(1.1)
    assert at(placed, "b") == pytest.approx((0.0, 0.0, 1.07)) and unsatisfied(placed) == []


@pytest.mark.parametrize(("level", "height"), [("top_flush", 0.5), ("bottom_flush", 0.02), ("centers", 0.26)])
def test_faces_level_with_a_tank(level, height):
    """Nothing stands on a tank's top, but its rim has a height: 0.5 m of water over a floor of 0.02 m."""
    row = rel(f"adjacent_plus_x_{level}", "tank")
    placed = solve(tank(), box("b", row, size=SMALL))
    assert at(placed, "b") == pytest.approx((at(placed, "tank")[0] + 0.52 + 0.05, at(placed, "tank")[1], height))
    assert residual(placed, placed.object("b"), row) < 1e-6


def test_flush_with_platform_top():
    step = box("b", rel("flush_with_platform_top", "a"), rel("FRONT-OF", "a", gap=0.0), size=SMALL)
    placed = solve(A, step)
    b = placed.object("b")
    assert at(placed, "b")[2] + extents(b)[2] / 2 == pytest.approx(0.1)


def test_a_block_as_high_as_its_level_stays_a_block():
    """It stands on the tank's floor, beside what is empty; a filling needs no size, and another height is no level."""
    held = tank()
    wide, deep, _ = held.size
    rows = [rel("PLACE-IN", "tank"), rel("FREE-SURFACE-AT", value=0.3)]

    def sized(*size: float) -> PlanObject:
        return PlanObject.proxy(name="water", role="fluid", primitive="fluid", size=size, state="fluid", relations=rows)

    for size, block in (((0.2, deep, 0.3), True), ((wide, deep, 0.3), False), ((0.2, deep, 0.2), False), ((), False)):
        assert is_block(sized(*size), {"tank": held}) == block
    placed = solve(held, sized(0.2, deep, 0.3))
    assert at(placed, "water") == pytest.approx((*at(placed, "tank")[:2], 0.02 + 0.15))
    program = compose(placed)
    assert f"size=(0.2, {deep}, 0.3)" in program and "fills=" not in program
