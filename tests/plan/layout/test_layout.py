import pytest

from wsim.plan.layout import LayoutError, check_floats, extents, layout
from wsim.plan.schema import Material, Plan, PlanObject, Pose, Relation

WOOD = Material(name="wood", density=600.0)


def box(name: str, *relations: Relation, size=(0.2, 0.4, 0.1), **fields) -> PlanObject:
    return PlanObject.proxy(
        name=name, role="rigid_body", primitive="box", size=size, material=WOOD, relations=list(relations), **fields
    )


def rel(predicate: str, ref: str | None = None, **numbers) -> Relation:
    return Relation(predicate=predicate, ref=ref, **numbers)


GROUND = PlanObject.proxy(name="ground", role="terrain", primitive="ground", state="static")
TANK = PlanObject.proxy(
    name="tank",
    role="container",
    primitive="tank",
    size=(1.0, 0.6, 0.5),
    state="static",
    relations=[rel("PLACE-ON-BASE")],
)
WATER = PlanObject.proxy(
    name="water", role="fluid", primitive="fluid", state="fluid",
    relations=[rel("PLACE-IN", "tank"), rel("FREE-SURFACE-AT", value=0.3)],
)  # fmt: skip


def place(*objects: PlanObject) -> dict[str, tuple[float, float, float]]:
    placed = layout(Plan(title="t", prompt="p", objects=list(objects)))
    return {item.name: item.pose.position for item in placed.objects if item.pose is not None}


def test_supports():
    a = box("a", rel("PLACE-ON-BASE"))
    b = box("b", rel("PLACE-ON", "a"))
    c = box("c", rel("SPAWNED-ABOVE", "b", value=0.5))
    assert place(GROUND, a, b, c) == {"a": (0, 0, 0.05), "b": (0, 0, 0.15), "c": (0, 0, 0.75)}
    assert place(box("d", rel("SPAWNED-ABOVE", value=1.0))) == {"d": (0, 0, 1.05)}


def test_order_in_the_file_does_not_matter():
    a = box("a", rel("PLACE-ON-BASE"))
    b = box("b", rel("PLACE-ON", "a"))
    assert place(b, a) == place(a, b)


@pytest.mark.parametrize(
    ("side", "where"),
    [
        ("FRONT-OF", (0.3, 0.0, 0.05)),
        ("BACK-OF", (-0.3, 0.0, 0.05)),
        ("LEFT-OF", (0.0, 0.5, 0.05)),
        ("RIGHT-OF", (0.0, -0.5, 0.05)),
    ],
)
def test_sides_keep_their_gap(side, where):
    anchor = box("a", pose=Pose(position=(0.0, 0.0, 0.05)))
    assert place(anchor, box("b", rel("PLACE-ON-BASE"), rel(side, "a", gap=0.1)))["b"] == pytest.approx(where)


def test_a_row_is_centred_as_a_whole():
    a = box("a", rel("PLACE-ON-BASE"))
    b = box("b", rel("PLACE-ON-BASE"), rel("FRONT-OF", "a", gap=0.2))
    c = box("c", rel("PLACE-ON-BASE"), rel("FRONT-OF", "b", gap=0.2), size=(0.4, 0.1, 0.1))
    at = place(a, b, c)
    assert at["a"][0] - 0.1 == pytest.approx(-(at["c"][0] + 0.2))
    assert at["b"][0] - at["a"][0] == pytest.approx(0.4)


def test_water():
    floater = box("floater", rel("FLOATS-AT-SURFACE", "water", gap=0.01))
    diver = box("diver", rel("SUBMERGED", "water", value=0.05), rel("FRONT-OF", "floater", gap=0.1))
    at = place(GROUND, TANK, WATER, floater, diver)
    assert at["tank"] == (0, 0, 0)
    assert at["floater"] == pytest.approx((-0.15, 0.0, 0.02 + 0.3 + 0.01 + 0.05))
    assert at["diver"] == pytest.approx((0.15, 0.0, 0.02 + 0.3 - 0.05 - 0.05))
    assert place(GROUND, TANK, box("sunk", rel("PLACE-IN", "tank")))["sunk"] == pytest.approx((0, 0, 0.07))


def test_lying_cylinders_are_as_high_as_they_are_wide():
    log = PlanObject.proxy(name="log", role="rigid_body", primitive="cylinder", size=(0.1, 0.5), material=WOOD,
                     relations=[rel("PLACE-ON-BASE"), rel("LIES-ALONG-Y")])  # fmt: skip
    placed = layout(Plan(title="t", prompt="p", objects=[log])).objects[0]
    assert placed.pose.position == pytest.approx((0, 0, 0.1))
    assert extents(placed, placed.pose.rotation_deg) == pytest.approx((0.2, 0.5, 0.2))


@pytest.mark.parametrize(
    ("objects", "words"),
    [
        ([box("a", rel("FACING-SAME-AS", "b")), box("b", rel("FACING-SAME-AS", "a"))],
         r"headings go round in a circle: a FACING-SAME-AS b; b FACING-SAME-AS a"),
        ([box("a", pose=Pose(position=(0, 0, 0.05))), box("b", pose=Pose(position=(0.1, 0, 0.05)))], "a and b overlap"),
        ([GROUND, box("a", pose=Pose(position=(0, 0, 0.0)))], "a starts 0.05 m below the ground"),
        ([TANK, WATER, box("a", rel("FLOATS-AT-SURFACE", "water"), size=(1.2, 0.1, 0.1))],
         "a FLOATS-AT-SURFACE water: a is 1.2 x 0.1 m and does not fit into tank, which is 1 x 0.6 m inside"),
        ([TANK, WATER, box("a", rel("SUBMERGED", "water", value=0.25))],
         "a SUBMERGED water .value 0.25.: its bottom would be 0.35 m under the surface, and the fluid is 0.3 m deep"),
        ([box("a"), box("b", rel("FRONT-OF", "a", gap=0.1)), box("c", rel("FRONT-OF", "b"), rel("BACK-OF", "a"))],
         r"contradict each other by 0.8 m along X: b FRONT-OF a \(gap 0.1\); c FRONT-OF b; c BACK-OF a;"),
        ([TANK, box("a", rel("PLACE-ON", "tank"))], "use PLACE-IN"),
        ([box("a"), box("b", rel("PLACE-IN", "a"))], "a: a box is not hollow"),
        ([box("a"), box("b", rel("PLACE-ON", "a", anchor="seat"))], "a has no surface 'seat'; it has top"),
        ([box("a"), box("b", rel("PLACE-ON", "a"), rel("FRONT-OF", "a"))],
         "b PLACE-ON a: its centre is not over what carries it, by 0.15 m; it is placed by b FRONT-OF a"),
        ([box("a", rel("FACING-LEFT"), rel("FACING-FRONT"))], "a FACING-LEFT turns it to 90 deg, a FACING-FRONT to 0"),
        ([TANK.related([rel("FACING-LEFT")])], "a tank stands along X and Y and is not turned"),
        ([box("a", rel("HEIGHT", value=0.3))], "a HEIGHT .value 0.3.: the size .* is 0.1 m high"),
        ([box("a", rel("PLACE-ON-BASE"), rel("adjacent_plus_x_top_flush", "b")), box("b", size=(1, 1, 1))],
         "a adjacent_plus_x_top_flush b: it is -0.9 m from there, by a PLACE-ON-BASE"),
    ],
)  # fmt: skip
def test_what_cannot_be_laid_out_is_refused(objects, words):
    with pytest.raises(LayoutError, match=words):
        place(*objects)


def test_the_layout_itself_refuses_circles_and_two_supports():
    """Plans that were not validated."""
    a, b = box("a", rel("PLACE-ON", "b")), box("b", rel("PLACE-ON", "a"))
    plan = Plan(title="t", prompt="p", objects=[box("a")])
    with pytest.raises(LayoutError, match=r"supports go round in a circle: a PLACE-ON b; b PLACE-ON a"):
        layout(plan.model_copy(update={"objects": [a, b]}))
    a = box("a", rel("PLACE-ON-BASE"), rel("SPAWNED-ABOVE", value=1.0))
    with pytest.raises(LayoutError, match=r"a PLACE-ON-BASE, and a SPAWNED-ABOVE .value 1.: both say how high"):
        layout(plan.model_copy(update={"objects": [a]}))


def test_what_is_free_gives_way():
    at = place(box("a"), box("b"), box("c"))
    assert at["a"] == (0, 0, 0.05)
    assert sorted((at["b"][0], at["c"][0])) == pytest.approx([-0.25, 0.25]) and at["b"][1] == at["c"][1] == 0


def test_what_has_no_room_is_named():
    tray = box("tray", size=(0.5, 0.5, 0.02))
    things = [box(f"brick_{k}", rel("PLACE-ON", "tray"), size=(0.3, 0.3, 0.1)) for k in range(2)]
    with pytest.raises(LayoutError, match=r"no room .*brick_0, brick_1 on or in tray.*brick_0 PLACE-ON tray"):
        place(tray, *things)


def test_the_solver_finds_what_one_after_the_other_does_not():
    """Four bricks fit into a square of 0.8 m only as a pinwheel round a hole of 0.2 m: none may take the middle."""
    tray = box("tray", size=(0.8, 0.8, 0.02))
    sizes = [(0.5, 0.3, 0.1), (0.5, 0.3, 0.1), (0.3, 0.5, 0.1), (0.3, 0.5, 0.1)]
    things = [box(f"brick_{k}", rel("PLACE-ON", "tray"), size=size) for k, size in enumerate(sizes)]
    at = place(tray, *things)
    assert {(abs(round(x, 3)), abs(round(y, 3))) for x, y, _ in (at[f"brick_{k}"] for k in (0, 1))} == {(0.15, 0.25)}
    assert place(tray, *things) == at


def test_a_plan_that_was_laid_out_is_laid_out_the_same():
    objects = [GROUND, TANK, WATER, box("a", rel("FLOATS-AT-SURFACE", "water")), box("b", rel("BACK-OF", "tank")),
               box("c", rel("RANDOM-ROT"), rel("LEFT-OF", "b"))]  # fmt: skip
    once = layout(Plan(title="t", prompt="p", objects=objects))
    assert layout(once) == once


def test_turned_bodies_may_be_closer_than_their_boxes():
    a = box("a", pose=Pose(position=(0, 0, 0.05), rotation_deg=(0, 0, 45.0)))
    b = box("b", pose=Pose(position=(0.16, 0.16, 0.05), rotation_deg=(0, 0, 45.0)))
    place(a, b)
    with pytest.raises(LayoutError, match=r"a and b overlap by 0.0444 m"):
        place(a, box("b", pose=Pose(position=(0.11, 0.11, 0.05), rotation_deg=(0, 0, 45.0))))


def test_what_is_too_dense_to_float_is_told_not_refused():
    steel = box("anvil", rel("FLOATS-AT-SURFACE", "water"))
    steel = steel.model_copy(update={"material": Material(name="steel", density=7850.0)})
    plan = Plan(title="t", prompt="p", objects=[TANK, WATER, steel, box("raft", rel("FLOATS-AT-SURFACE", "water"))])
    assert layout(plan).object("anvil").pose is not None
    [said] = check_floats(plan)
    assert "anvil FLOATS-AT-SURFACE water: anvil has 7850 kg/m^3 and water 1000 kg/m^3, it sinks" in said


def test_balls_may_be_closer_than_their_boxes():
    def ball(name, x, y):
        return PlanObject.proxy(name=name, role="rigid_body", primitive="sphere", size=(0.1,), material=WOOD,
                          pose=Pose(position=(x, y, 0.1)))  # fmt: skip

    place(ball("a", 0.0, 0.0), ball("b", 0.15, 0.15))
    with pytest.raises(LayoutError, match=r"overlap"):
        place(ball("a", 0.0, 0.0), ball("b", 0.13, 0.13))
