"""Each predicate by itself, against numbers worked out by hand."""

import pytest

from tests.plan.layout.scenes import GROUND, asset, at, box, rel, solve, tank, water, yaw
from wsim.plan.layout import LayoutError, residual, unsatisfied
from wsim.plan.layout.bodies import hollow
from wsim.plan.schema import External, Pose, Proxy, Region

A = box("a", pose=Pose(position=(1.0, 2.0, 0.05)))  # 0.2 x 0.4 x 0.1 m
SMALL = (0.1, 0.2, 0.1)


@pytest.mark.parametrize(
    ("side", "where"),
    [
        ("FRONT-OF", (1.0 + 0.1 + 0.3 + 0.05, 2.0)),
        ("BACK-OF", (1.0 - 0.1 - 0.3 - 0.05, 2.0)),
        ("LEFT-OF", (1.0, 2.0 + 0.2 + 0.3 + 0.1)),
        ("RIGHT-OF", (1.0, 2.0 - 0.2 - 0.3 - 0.1)),
    ],
)
def test_sides(side, where):
    assert at(solve(A, box("b", rel(side, "a", gap=0.3), size=SMALL)), "b")[:2] == pytest.approx(where)
    assert at(solve(A, box("b", rel("FRONT-OF", "a"), size=SMALL)), "b")[0] == pytest.approx(1.2)


@pytest.mark.parametrize(
    ("edge", "axis", "value"),
    [("ALIGN-LEFT", 1, 2.1), ("ALIGN-RIGHT", 1, 1.9), ("ALIGN-FRONT", 0, 1.05), ("ALIGN-BACK", 0, 0.95)],
)
def test_edges(edge, axis, value):
    side = rel("FRONT-OF", "a") if axis == 1 else rel("LEFT-OF", "a")
    assert at(solve(A, box("b", rel(edge, "a"), side, size=SMALL)), "b")[axis] == pytest.approx(value)


@pytest.mark.parametrize(("center", "axis", "value"), [("ALIGN-CENTER-LR", 1, 2.0), ("ALIGN-CENTER-FB", 0, 1.0)])
def test_centers(center, axis, value):
    side = rel("FRONT-OF", "a") if axis == 1 else rel("LEFT-OF", "a")
    placed = solve(A, box("b", rel(center, "a"), side, rel("FACING-LEFT"), size=SMALL))
    assert at(placed, "b")[axis] == pytest.approx(value)


def test_place_on_base():
    raised = GROUND.model_copy(update={"pose": Pose(position=(0, 0, 0.5))})
    assert at(solve(box("b", rel("PLACE-ON-BASE"))), "b") == pytest.approx((0, 0, 0.05))
    assert at(solve(raised, box("b", rel("PLACE-ON-BASE")), box("c", rel("LEFT-OF", "b"))), "c")[2] == 0.55


def test_place_on():
    table = asset("desk", "desk", rel("PLACE-ON-BASE"))
    placed = solve(table, box("b", rel("PLACE-ON", "desk"), size=SMALL))
    assert at(placed, "b") == pytest.approx((0, 0, 0.74 + 0.05))
    small = solve(box("a"), box("b", rel("PLACE-ON", "a"), size=(1.0, 1.0, 0.1)))  # overhangs on every side
    assert at(small, "b") == pytest.approx((0, 0, 0.15))


def test_place_on_a_named_surface():
    chair = asset("chair", "chair", rel("FACING-LEFT"))
    placed = solve(chair, box("b", rel("PLACE-ON", "chair", anchor="seat"), size=SMALL))
    assert at(placed, "b") == pytest.approx((0.0, 0.02783, 0.45 + 0.05), abs=1e-4)
    books = [box(f"book_{k}", rel("PLACE-ON", "shelf", anchor="shelf_2"), size=(0.2, 0.1, 0.3)) for k in range(3)]
    placed = solve(asset("shelf", "shelf"), *books)
    assert {round(at(placed, f"book_{k}")[2], 4) for k in range(3)} == {0.5756}


def test_place_in():
    placed = solve(tank(), box("b", rel("PLACE-IN", "tank")))
    assert at(placed, "b") == pytest.approx((0, 0, 0.02 + 0.05))
    bucket = asset("bucket", "bucket", rel("FACING-LEFT"), role="container")
    ball = solve(bucket, box("b", rel("PLACE-IN", "bucket"), size=(0.05, 0.05, 0.05)))
    free = hollow(bucket)
    assert at(ball, "b") == pytest.approx((0.0, free.center[0], free.low[2] + 0.025), abs=1e-4)
    with pytest.raises(LayoutError, match=r"b is 0.1 x 0.3 m and does not fit into bucket, which is 0.1\d+ x 0.1\d+ m"):
        solve(bucket, box("b", rel("PLACE-IN", "bucket"), size=(0.3, 0.1, 0.05)))
    with pytest.raises(LayoutError, match=r"b is 0.5 m high and does not fit into cabinet, whose hollow is 0.24 m"):
        solve(asset("cabinet", "cabinet"), box("b", rel("PLACE-IN", "cabinet"), size=(0.1, 0.1, 0.5)))


def test_place_anywhere():
    region = Region(low=(1.0, 1.0), high=(2.0, 2.0))
    things = [box(f"b{k}", rel("PLACE-ANYWHERE", region=region), size=(0.4, 0.4, 0.1)) for k in range(4)]
    placed = solve(GROUND, *things)
    for k in range(4):
        x, y, z = at(placed, f"b{k}")
        assert 1.2 - 1e-3 <= x <= 1.8 + 1e-3 and 1.2 - 1e-3 <= y <= 1.8 + 1e-3 and z == pytest.approx(0.05)
    with pytest.raises(LayoutError, match=r"b4 .* 1.2 x 0.2 m and does not fit into the region, which is 1 x 1 m"):
        solve(box("b4", rel("PLACE-ANYWHERE", region=region), size=(1.2, 0.2, 0.1)))
    with pytest.raises(LayoutError, match=r"no room was found for all"):
        solve(*things, box("big", rel("PLACE-ANYWHERE", region=region), size=(0.9, 0.9, 0.1)))
    on = solve(asset("desk", "desk"), *(box(f"c{k}", rel("PLACE-ANYWHERE", "desk"), size=SMALL) for k in range(5)))
    assert {at(on, f"c{k}")[2] for k in range(5)} == {0.79}


def test_spawned_above():
    assert at(solve(A, box("b", rel("SPAWNED-ABOVE", "a", value=0.5))), "b") == pytest.approx((1, 2, 0.65))
    assert at(solve(tank(), water(), box("b", rel("SPAWNED-ABOVE", "water", value=0.1))), "b")[2] == pytest.approx(0.47)


def test_height():
    stand_in = Proxy(primitive="cylinder", size=(0.1, 1.0))
    lamp = box("lamp", rel("HEIGHT", value=1.5))
    lamp = lamp.model_copy(update={"construction": External(candidate="a lamp post", stand_in=stand_in)})
    placed = solve(lamp)
    assert placed.object("lamp").size == (0.1, 1.5) and at(placed, "lamp")[2] == 0.75
    assert solve(box("a", rel("HEIGHT", value=0.1))).object("a").size[2] == 0.1
    with pytest.raises(LayoutError, match=r"desk HEIGHT .value 1.: the asset desk is 0.74 m high"):
        solve(asset("desk", "desk", rel("HEIGHT", value=1.0)))


@pytest.mark.parametrize(
    ("predicate", "heading"), [("FACING-FRONT", 0), ("FACING-LEFT", 90), ("FACING-BACK", 180), ("FACING-RIGHT", -90)]
)
def test_facing_a_side(predicate, heading):
    placed = solve(A, box("b", rel(predicate), rel("FRONT-OF", "a", gap=0.0)))
    assert yaw(placed, "b") == heading
    reach = 0.1 if heading in (0, 180) else 0.2  # its 0.4 m lie along X when it looks left or right
    assert at(placed, "b")[0] == pytest.approx(1.1 + reach)


def test_facing_to():
    b = box("b", rel("FACING-TO", "a"), rel("RIGHT-OF", "a", gap=1.0), rel("ALIGN-CENTER-FB", "a"))
    assert yaw(solve(A, b), "b") == pytest.approx(90.0)
    c = box("c", rel("FACING-OPPOSITE-TO", "a"), rel("RIGHT-OF", "a", gap=1.0), rel("ALIGN-CENTER-FB", "a"))
    assert yaw(solve(A, c), "c") == pytest.approx(-90.0)
    with pytest.raises(LayoutError, match=r"b and a are over each other, there is no direction"):
        solve(A, box("b", rel("centered_on_ref", "a"), rel("FACING-TO", "a")))


def test_facing_each_other():
    b = box("b", rel("FACING-TO", "c"), rel("FRONT-OF", "c", gap=0.5), rel("LEFT-OF", "c", gap=0.5))
    placed = solve(b, box("c", rel("FACING-TO", "b")))
    assert yaw(placed, "c") == pytest.approx((yaw(placed, "b") + 180.0) % 360.0, abs=0.01)
    assert unsatisfied(placed) == []


def test_facing_same_as():
    placed = solve(
        box("a", rel("FACING-LEFT")), box("b", rel("FACING-SAME-AS", "a")), box("c", rel("FACING-SAME-AS", "b"))
    )
    assert yaw(placed, "b") == yaw(placed, "c") == 90.0


def test_random_rot():
    one = box("a", rel("RANDOM-ROT", range=(10.0, 20.0)))
    assert 10.0 <= yaw(solve(one), "a") <= 20.0
    assert yaw(solve(one), "a") == yaw(solve(one), "a") != yaw(solve(one, seed=1), "a")
    both = solve(box("a", rel("RANDOM-ROT")), box("b", rel("RANDOM-ROT")))
    assert yaw(both, "a") != yaw(both, "b")


@pytest.mark.parametrize(
    ("side", "turn", "heading"),
    [("FRONT-OF", None, 180), ("BACK-OF", None, 0), ("LEFT-OF", None, -90), ("RIGHT-OF", "FACING-LEFT", 90)],
)
def test_orient_by_relative_side(side, turn, heading):
    desk = asset("desk", "desk", *([rel(turn)] if turn else []))
    placed = solve(desk, asset("chair", "chair", rel(side, "desk", gap=0.1), rel("ORIENT-BY-RELATIVE-SIDE", "desk")))
    assert yaw(placed, "chair") == pytest.approx(heading)


def test_lies_along():
    from wsim.plan.schema import PlanObject

    def log(*rows):
        return PlanObject.proxy(name="log", role="rigid_body", primitive="cylinder", size=(0.1, 0.6),
                                material=A.material, relations=list(rows))  # fmt: skip

    along = solve(box("a"), log(rel("LIES-ALONG-X"), rel("FRONT-OF", "a", gap=0.0)))
    assert at(along, "log") == pytest.approx((at(along, "a")[0] + 0.1 + 0.3, at(along, "a")[1], 0.1))
    across = solve(box("a"), log(rel("LIES-ALONG-Y"), rel("FRONT-OF", "a", gap=0.0)))
    assert at(across, "log")[0] - at(across, "a")[0] == pytest.approx(0.2)
    turned = solve(log(rel("LIES-ALONG-X"), rel("FACING-LEFT")))
    assert turned.object("log").pose.rotation_deg == (0.0, 90.0, 90.0) and unsatisfied(turned) == []


def test_free_surface_at():
    assert at(solve(tank(), water(), box("b", rel("FLOATS-AT-SURFACE", "water"))), "b")[2] == pytest.approx(0.37)
    full = water(rel("PLACE-IN", "tank"), rel("FREE-SURFACE-AT", value=0.7))
    with pytest.raises(LayoutError, match=r"water FREE-SURFACE-AT .value 0.7.: the hollow of tank is 0.5 m deep"):
        solve(tank(), full, box("b", rel("FLOATS-AT-SURFACE", "water")))


def test_a_fluid_has_one_level():
    """Of two rows the first was taken, and the second counted as kept."""
    first, other = rel("FREE-SURFACE-AT", value=0.3), rel("FREE-SURFACE-AT", value=0.2)
    for rows in ([rel("PLACE-IN", "tank"), first, other], [rel("fills_container_to_top", "tank"), other]):
        with pytest.raises(LayoutError, match=r"water FREE-SURFACE-AT .value 0.2. is off by 0.[13] m"):
            solve(tank(), water(*rows))
    assert unsatisfied(solve(tank(), water(rel("PLACE-IN", "tank"), first, first))) == []


def test_floats_at_surface():
    things = [box(f"b{k}", rel("FLOATS-AT-SURFACE", "water", gap=0.01)) for k in range(3)]
    placed = solve(tank(), water(), *things)
    assert {at(placed, f"b{k}")[2] for k in range(3)} == {0.38}
    assert at(placed, "b0")[:2] == (0, 0) and unsatisfied(placed) == []
    assert all(abs(at(placed, f"b{k}")[0]) <= 0.4 and abs(at(placed, f"b{k}")[1]) <= 0.1 for k in range(3))


@pytest.mark.parametrize(("by", "height"), [("top", 0.32 - 0.1 - 0.05), ("center", 0.32 - 0.1), (None, 0.17)])
def test_submerged(by, height):
    placed = solve(tank(), water(), box("b", rel("SUBMERGED", "water", value=0.1, by=by)))
    assert at(placed, "b") == pytest.approx((0, 0, height))


def test_a_fluid_of_its_own_size():
    pool = water(rel("PLACE-ON-BASE"))
    pool = pool.model_copy(update={"construction": Proxy(primitive="fluid", size=(2.0, 1.0, 0.4))})
    placed = solve(pool, box("b", rel("FLOATS-AT-SURFACE", "water")))
    assert at(placed, "water") == pytest.approx((0, 0, 0.2)) and at(placed, "b") == pytest.approx((0, 0, 0.45))
    with pytest.raises(LayoutError, match=r"the fluid is 0.4 m deep"):
        solve(pool, box("b", rel("SUBMERGED", "water", value=0.35)))


def test_contains_fluid():
    placed = solve(water(), tank(rel("CONTAINS-FLUID", "water")).model_copy(update={"pose": Pose(position=(3, 0, 0))}))
    assert at(placed, "tank") == (3, 0, 0)  # it says nothing of the place


@pytest.mark.parametrize(("turn", "where"), [("FACING-FRONT", (0.5, 1.5)), ("FACING-LEFT", (1.5, 2.5))])
def test_symmetry_along(turn, where):
    ref = box("r", pose=Pose(position=(0.5, 2.5, 0.05), rotation_deg=(0, 0, 30.0)), size=SMALL)
    heading = 90.0 if turn == "FACING-LEFT" else 0.0
    axis = box("m", pose=Pose(position=(1.0, 2.0, 0.05), rotation_deg=(0, 0, heading)), size=SMALL)
    placed = solve(ref, axis, box("b", rel("SYMMETRY-ALONG", "r", axis="m"), size=SMALL))
    assert at(placed, "b")[:2] == pytest.approx(where)
    assert yaw(placed, "b") == pytest.approx(-30.0 if turn == "FACING-FRONT" else 150.0)


def test_symmetry_about_what_stands_askew():
    ref = box("r", pose=Pose(position=(1.0, 0.0, 0.55)), size=SMALL)
    axis = box("m", pose=Pose(position=(0.0, 0.0, 0.05), rotation_deg=(0, 0, 30.0)), size=SMALL)
    placed = solve(ref, axis, box("b", rel("SYMMETRY-ALONG", "r", axis="m"), size=SMALL))
    assert at(placed, "b") == pytest.approx((0.5, 3**0.5 / 2, 0.55), abs=1e-5)


def group(name: str, x: float | None, *rows):
    """A desk and a chair behind it."""
    pose = {"pose": Pose(position=(x, 0.0, 0.35))} if x is not None else {}
    desk = box(name, *rows, size=(0.6, 1.2, 0.7), **pose)
    return desk, box(f"{name}_chair", rel("BACK-OF", name, gap=0.1), size=(0.4, 0.4, 0.4))


def test_group():
    desk, chair = group("desk", None, rel("GROUP", group="work", members=["desk_chair"]), rel("FRONT-OF", "a", gap=0.5))
    placed = solve(A, desk, chair, box("b", rel("FRONT-OF", "work", gap=0.2)), box("c", rel("BACK-OF", "desk_chair")))
    assert at(placed, "desk_chair")[0] - 0.2 == pytest.approx(1.1 + 0.5)  # the whole group is in front of a
    assert at(placed, "desk")[0] == pytest.approx(at(placed, "desk_chair")[0] + 0.2 + 0.1 + 0.3)
    assert at(placed, "b")[0] == pytest.approx(at(placed, "desk")[0] + 0.3 + 0.2 + 0.1)
    assert unsatisfied(placed) == []


def test_copy_group():
    desk, chair = group("desk", None, rel("GROUP", group="work", members=["desk_chair", "mug"]))
    mug = box("mug", rel("PLACE-ON", "desk"), size=(0.1, 0.1, 0.1))
    copies = [box("desk_2", rel("COPY-GROUP", group="work", members=["chair_2", "mug_2"]), rel("FACING-LEFT"),
                  rel("LEFT-OF", "work", gap=1.0), rel("ALIGN-CENTER-FB", "desk"), size=(0.6, 1.2, 0.7)),
              box("chair_2", size=(0.4, 0.4, 0.4)), box("mug_2", size=(0.1, 0.1, 0.1))]  # fmt: skip
    placed = solve(desk, chair, mug, *copies)
    x, y, _ = at(placed, "desk_2")
    assert at(placed, "chair_2") == pytest.approx((x, y - 0.6, 0.2)) and yaw(placed, "chair_2") == 90.0
    assert at(placed, "mug_2")[2] == pytest.approx(0.75)
    assert unsatisfied(placed) == [] and residual(placed, placed.object("desk_2"), copies[0].relations[0]) < 1e-5


def test_members_stay_where_the_group_stands():
    vase = box("vase", rel("PLACE-ON", "desk"), rel("GROUP", group="g", members=["book"]), size=SMALL)
    placed = solve(asset("desk", "desk"), vase, box("book", rel("LEFT-OF", "vase"), size=SMALL))
    assert at(placed, "book")[2] == pytest.approx(0.79)


def test_rows_that_chase_each_other_are_named():
    """Its low faces stay where they are; turned to one side of the desk, its middle is on the other side."""
    desk = box("desk", size=(1.0, 1.0, 0.7), pose=Pose(position=(0.0, 0.0, 0.35)))
    marker = box("marker", size=SMALL, pose=Pose(position=(0.65, 0.7, 5.0)))
    rows = [rel("ALIGN-BACK", "marker"), rel("ALIGN-RIGHT", "marker"), rel("ORIENT-BY-RELATIVE-SIDE", "desk")]
    with pytest.raises(LayoutError, match="chase each other after 12 rounds: bench ORIENT-BY-RELATIVE-SIDE desk; give"):
        solve(desk, marker, box("bench", *rows, size=(0.2, 2.0, 0.4)))
