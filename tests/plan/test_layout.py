import pytest

from wsim.plan.layout import LayoutError, extents, layout
from wsim.plan.schema import Material, Plan, PlanObject, Pose, Relation

WOOD = Material(name="wood", density=600.0)


def box(name: str, *relations: Relation, size=(0.2, 0.4, 0.1), **fields) -> PlanObject:
    return PlanObject(
        name=name, role="rigid_body", primitive="box", size=size, material=WOOD, relations=list(relations), **fields
    )


def rel(predicate: str, ref: str | None = None, **numbers) -> Relation:
    return Relation(predicate=predicate, ref=ref, **numbers)


GROUND = PlanObject(name="ground", role="terrain", primitive="ground", state="static")
TANK = PlanObject(
    name="tank",
    role="container",
    primitive="tank",
    size=(1.0, 0.6, 0.5),
    state="static",
    relations=[rel("PLACE-ON-BASE")],
)
WATER = PlanObject(
    name="water", role="fluid", primitive="fluid", state="fluid",
    relations=[rel("PLACE-IN", "tank"), rel("FREE-SURFACE-AT", "tank", value=0.3)],
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
    log = PlanObject(name="log", role="rigid_body", primitive="cylinder", size=(0.1, 0.5), material=WOOD,
                     relations=[rel("PLACE-ON-BASE"), rel("LIES-ALONG-Y")])  # fmt: skip
    placed = layout(Plan(title="t", prompt="p", objects=[log])).objects[0]
    assert placed.pose.position == pytest.approx((0, 0, 0.1))
    assert extents(placed, placed.pose.rotation_deg) == pytest.approx((0.2, 0.5, 0.2))


@pytest.mark.parametrize(
    ("objects", "words"),
    [
        ([box("a", rel("PLACE-ON", "b")), box("b", rel("PLACE-ON", "a"))], "circle: a -> b -> a"),
        ([box("a", pose=Pose(position=(0, 0, 0.05))), box("b", pose=Pose(position=(0.1, 0, 0.05)))], "a and b overlap"),
        ([GROUND, box("a", pose=Pose(position=(0, 0, 0.0)))], "a starts 0.05 m below the ground"),
        ([TANK, WATER, box("a", rel("FLOATS-AT-SURFACE", "water"), size=(1.2, 0.1, 0.1))], "tank and a overlap"),
        ([box("a", rel("PLACE-ON-BASE"), rel("SPAWNED-ABOVE", value=1.0))], "keep one of them"),
        (
            [box("a"), box("b", rel("FRONT-OF", "a", gap=0.1)), box("c", rel("FRONT-OF", "b"), rel("BACK-OF", "a"))],
            "cannot be BACK-OF a",
        ),
        ([box("a"), box("b")], "a and b overlap"),
        ([TANK, box("a", rel("PLACE-ON", "tank"))], "use PLACE-IN"),
    ],
)
def test_what_cannot_be_laid_out_is_refused(objects, words):
    with pytest.raises(LayoutError, match=words):
        place(*objects)


def test_balls_may_be_closer_than_their_boxes():
    def ball(name, x, y):
        return PlanObject(name=name, role="rigid_body", primitive="sphere", size=(0.1,), material=WOOD,
                          pose=Pose(position=(x, y, 0.1)))  # fmt: skip

    place(ball("a", 0.0, 0.0), ball("b", 0.15, 0.15))
    with pytest.raises(LayoutError, match="overlap"):
        place(ball("a", 0.0, 0.0), ball("b", 0.13, 0.13))
