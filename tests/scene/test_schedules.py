"""Schedules as programs state them, as stages have them, and what is refused."""

import math

import pytest
from pxr import Sdf, Vt

from wsim.scene import Drive, Event, Scene, SceneError
from wsim.scene.check import check_stage
from wsim.scene.describe import describe


def world() -> Scene:
    """One of each thing that a schedule may be of."""
    scene = Scene()
    scene.ground(friction=0.3)
    scene.box("block", size=(0.2,) * 3, position=(0, 0, 0.1), mass=1)
    scene.box("gate", size=(0.2,) * 3, position=(0, 3, 0.1), kinematic=True)
    scene.box("belt", size=(1, 1, 0.2), position=(0, 6, 0.1), rotation_deg=(0, 0, 90), static=True)
    for name, x in (("arm", 3), ("bob", 6), ("cart", 9)):
        scene.box(name, size=(0.2,) * 3, position=(x, 0, 1), mass=1)
    scene.joint_revolute("hinge", None, "arm", drive=Drive(velocity=10, damping=1, stiffness=2))
    scene.joint_fixed("hook", None, "bob")
    scene.joint_prismatic("rail", None, "cart", axis="X")
    scene.contact("block", "ground", friction=0.3)
    return scene


GOOD = [
    ("block", "force", [0, 1], [(1, 2, 3), (0, 0, 0)], {"point": (0.1, 0, 0)}),
    ("block", "torque", [0], [(0, 0, 1)], {}),
    ("gate", "velocity", [0, 1], [(0, 0, 1), (0, 0, 0)], {}),
    ("gate", "angular_velocity", [0], [(0, 0, 90)], {"linear": True}),
    ("belt", "surface_velocity", [1], [(1, 0, 0)], {}),
    ("hinge", "position", [1, 2], [90, 0], {}),
    ("hinge", "velocity", [1], [90], {}),
    ("hinge", "effort", [1], [3], {}),
    ("rail", "effort", [1], [3], {}),
    ("hook", "release", [1], None, {}),
    (("block", "ground"), "friction", [1], [0.1], {}),
]


def test_a_stage_says_what_a_program_says(tmp_path):
    scene = world()
    for k, (what, quantity, times, values, more) in enumerate(GOOD):
        after = Event(touch=("block", "ground"), delay=0.5) if k == 0 else None
        scene.schedule(f"s{k}", what, quantity, times=times, values=values, after=after, **more)
    scene.schedule("late", "bob", "force", times=[0], values=[(1, 0, 0)], after=Event(end="s1", delay=1))
    scene.schedule("beyond", "cart", "force", times=[0], values=[(1, 0, 0)], after=Event(joint="hinge", above=45))
    stage = scene.save(tmp_path / "stage.usda")
    assert check_stage(stage, []) == []
    found = {each.prim.rsplit("/", 1)[1]: each for each in describe(stage).schedules}
    assert found["s0"].values[0] == (1, 2, 3) and found["s0"].point == pytest.approx((0.1, 0, 0))
    assert (found["s0"].after.kind, found["s0"].after.second, found["s0"].after.delay) == (
        "touch",
        "/World/ground",
        0.5,
    )
    assert found["s3"].values[0][2] == pytest.approx(math.pi / 2) and found["s3"].linear and not found["s2"].linear
    assert found["s4"].values[0] == pytest.approx((0, 1, 0), abs=1e-6)  # the belt's own X is the world's Y
    assert found["s5"].linear and found["s5"].values[0][0] == pytest.approx(math.pi / 2)
    assert found["s7"].values[0] == (3,) and found["s9"].values == [()]
    assert found["beyond"].after.value == pytest.approx(math.pi / 4) and found["late"].after.first.endswith("s1")
    assert all(each.line and each.line.startswith("test_schedules.py:") for each in found.values())
    assert next(joint for joint in describe(stage).joints if joint.prim.endswith("hook")).may_break


BAD = [
    (("block", "velocity", [0], [(1, 0, 0)]), {}, "is a loose body, which has force, torque"),
    (("blok", "force", [0], [(1, 0, 0)]), {}, 'did you mean "block"?'),
    (("block", "force", [-1], [(1, 0, 0)]), {}, "must be >= 0 s"),
    (("block", "force", [1, 1], [(1, 0, 0)] * 2), {}, "must rise"),
    (("block", "force", [], []), {}, "0 keys"),
    (("block", "force", [0, 1], [(1, 0, 0)]), {}, "values has 1 and times 2"),
    (("block", "force", [0], [5.0]), {}, "must be 3 numbers"),
    (("block", "force", [0], [(1e9, 0, 0)]), {}, "must be <= 1e+07 N"),
    (("block", "force", [0], [(math.nan, 0, 0)]), {}, "must be finite"),
    (("block", "torque", [0], [(1, 0, 0)]), {"point": (0, 0, 0)}, "point is where a force acts"),
    (("hinge", "force", [0], [1]), {}, "which has position, velocity, effort, release"),
    (("hook", "velocity", [0], [1]), {}, "a joint of its kind has no velocity"),
    (("rail", "velocity", [0], [1]), {}, "it has none with a damping"),
    (("rail", "release", [0], None), {}, "cannot let go"),
    (("hook", "release", [0, 1], None), {}, "one time and no values"),
    (("belt", "force", [0], [(1, 0, 0)]), {}, "which has surface_velocity"),
    ((("block", "gate"), "friction", [0], [0.1]), {}, "has no friction of its own"),
    ((("block", "ground"), "friction", [0], [-0.1]), {}, "must be >= 0"),
    (("block", "force", [0], [(1, 0, 0)]), {"after": Event()}, "after has none of"),
    (("block", "force", [0], [(1, 0, 0)]), {"after": Event(touch=("gate", "belt"))}, "they never meet"),
    (("block", "force", [0], [(1, 0, 0)]), {"after": Event(touch=("block", "block"))}, "two objects"),
    (("block", "force", [0], [(1, 0, 0)]), {"after": Event(body="block", above=1)}, "axis"),
    (("block", "force", [0], [(1, 0, 0)]), {"after": Event(body="block", axis="X")}, "above or below"),
    (("block", "force", [0], [(1, 0, 0)]), {"after": Event(joint="hook", above=1)}, "no hinge and no slider"),
    (("block", "force", [0], [(1, 0, 0)]), {"after": Event(end="other")}, "no schedule made before"),
    (("block", "force", [0], [(1, 0, 0)]), {"after": Event(end="s", delay=-1)}, "must be >= 0 s"),
    (("block", "force", [0], [(1, 0, 0)]), {"after": "touch"}, "must be an Event"),
]


@pytest.mark.parametrize(("given", "more", "says"), BAD, ids=[each[2][:30] for each in BAD])
def test_what_cannot_be_is_refused(given, more, says):
    what, quantity, times, values = given
    with pytest.raises(SceneError) as error:
        world().schedule("s", what, quantity, times=times, values=values, **more)
    assert says in str(error.value) and "schedule" in str(error.value)


def test_a_quantity_has_one_schedule_and_a_name_one_meaning():
    scene = world()
    scene.schedule("s", "block", "force", times=[0], values=[(1, 0, 0)])
    with pytest.raises(SceneError, match='has the schedule "s" already'):
        scene.schedule("t", "block", "force", times=[0], values=[(1, 0, 0)])
    with pytest.raises(SceneError, match="already used"):
        scene.schedule("s", "block", "torque", times=[0], values=[(1, 0, 0)])


EDITS = [
    ("wsim:times", Sdf.ValueTypeNames.DoubleArray, Vt.DoubleArray([2.0, 1.0]), "must rise"),
    ("wsim:times", Sdf.ValueTypeNames.DoubleArray, Vt.DoubleArray([-1.0, 1.0]), "must rise"),
    ("wsim:values", Sdf.ValueTypeNames.DoubleArray, Vt.DoubleArray([1.0]), "1 numbers; 3 for each of 2"),
    ("wsim:values", Sdf.ValueTypeNames.DoubleArray, Vt.DoubleArray([1e12] * 6), "each must be from"),
    ("wsim:quantity", Sdf.ValueTypeNames.Token, "velocity", "loose body, which has force"),
    ("wsim:event", Sdf.ValueTypeNames.Token, "dawn", '"dawn" is none of'),
    ("wsim:event", Sdf.ValueTypeNames.Token, "end", "names 0"),
    ("wsim:eventDelay", Sdf.ValueTypeNames.Double, -1.0, "eventDelay"),
]


@pytest.mark.parametrize(("name", "kind", "value", "says"), EDITS, ids=lambda each: str(each)[:24])
def test_a_stage_by_other_hands_is_checked(tmp_path, name, kind, value, says):
    scene = world()
    scene.schedule("s", "block", "force", times=[0, 1], values=[(1, 2, 3), (0, 0, 0)])
    prim = scene.stage.GetPrimAtPath("/World/Schedules/s")
    prim.CreateAttribute(name, kind, False).Set(value)
    if name == "wsim:eventDelay":
        prim.CreateAttribute("wsim:event", Sdf.ValueTypeNames.Token, False).Set("touch")
    assert any(says in problem for problem in check_stage(scene.save(tmp_path / "stage.usda"), []))


@pytest.mark.parametrize(
    ("times", "after", "says"),
    [
        ([0, 9], None, "times: 9 s is after the end, at 5 s; leave that key out, or make the run longer"),
        ([0, 2], Event(touch=("block", "ground"), delay=6), "eventDelay: its delay, and what it counts from, put its"),
        ([0, 2], Event(end="first", delay=2.5), "times: 2 s, which count from 3.5 s or later, is after the end"),
        ([0, 2], Event(start="first", delay=2.5), None),
    ],
)  # fmt: skip
def test_what_no_run_comes_to_is_said(tmp_path, times, after, says):
    scene = world()
    scene.schedule("first", "bob", "force", times=[0, 1], values=[(1, 0, 0), (0, 0, 0)])
    scene.schedule("s", "block", "force", times=times, values=[(1, 0, 0), (0, 0, 0)], after=after)
    problems = check_stage(scene.save(tmp_path / "stage.usda"), [])
    assert [says] == [says for problem in problems if says in problem] if says else problems == []
    scene.simulation(duration=10.0)
    assert check_stage(scene.save(tmp_path / "longer.usda"), []) == []


def test_the_joints_of_robots_are_listed():
    scene = Scene()
    scene.robot("arm", "desk_arm")
    for what, says in (
        ("shoulder", "is not in the scene; known: arm, arm/joints/pan"),
        ("arm", "of its own; name one"),
    ):
        with pytest.raises(SceneError, match=says) as error:
            scene.schedule("s", what, "velocity", times=[0], values=[1])
        assert "arm/joints/right_finger" in str(error.value)


def loop(*driven):
    """A four-bar of three bars and four hinges, some with drives."""
    scene = Scene()
    for k, (x, z) in enumerate(((0, 0.5), (0.5, 1), (1, 0.5))):
        scene.box(f"bar_{k}", size=(0.1, 0.1, 0.1), position=(x, 0, z), mass=1)
    pins = [(None, "bar_0", (0, 0, 0)), ("bar_0", "bar_1", (0, 0, 1)), ("bar_1", "bar_2", (1, 0, 1)),
            (None, "bar_2", (1, 0, 0))]  # fmt: skip
    for k, (parent, child, anchor) in enumerate(pins):
        drive = Drive(damping=1.0) if k in driven else None
        scene.joint_revolute(f"pin_{k}", parent, child, anchor=anchor, axis="Y", drive=drive)
    return scene


def closing(scene, path):
    """The joints that close loops."""
    return [joint.prim.rsplit("/", 1)[1] for joint in describe(scene.save(path)).joints if joint.closing]


def test_another_joint_closes_a_loop_in_place_of_one_that_is_scheduled(tmp_path):
    scene = loop()
    (first,) = closing(scene, tmp_path / "plain.usda")
    scene.schedule("turn", first, "effort", times=[0], values=[1])
    (second,) = closing(scene, tmp_path / "turned.usda")
    late = Event(joint=second, above=5.0)
    scene.schedule("push", "bar_1", "force", times=[0], values=[(1, 0, 0)], after=late)
    (third,) = closing(scene, tmp_path / "pushed.usda")
    assert len({first, second, third}) == 3
    assert check_stage(tmp_path / "pushed.usda", []) == []
    scene.box("more", size=(0.1,) * 3, position=(5, 0, 1), mass=1)
    scene.joint_revolute("pin", None, "more", axis="Y")  # joints that come later leave it so
    assert closing(scene, tmp_path / "more.usda") == [third]


def test_where_every_joint_of_a_loop_has_a_coordinate_none_is_free_for_a_schedule(tmp_path):
    scene = loop(0, 1, 2)
    assert closing(scene, tmp_path / "plain.usda") == ["pin_3"]
    with pytest.raises(SceneError, match=r"it closes a loop, .* leave one of them a plain hinge"):
        scene.schedule("turn", "pin_3", "effort", times=[0], values=[1])
    assert closing(scene, tmp_path / "after.usda") == ["pin_3"]


def test_a_joint_that_may_let_go_has_no_effort_and_tells_no_event(tmp_path):
    """It is a constraint, and none of the trees' coordinates: said when the stage is checked, whatever comes first."""
    scene = Scene()
    scene.box("bar", size=(0.6, 0.1, 0.1), position=(0.3, 0.0, 1.0), mass=1.0)
    scene.box("block", size=(0.2,) * 3, position=(3.0, 0.0, 0.1), mass=1.0)
    scene.joint_revolute("pin", None, "bar", anchor=(0.0, 0.0, 1.0), axis="Y")
    scene.schedule("pull", "pin", "effort", times=[0.0], values=[1.0])
    scene.schedule("push", "block", "force", times=[0.0], values=[(1, 0, 0)], after=Event(joint="pin", above=45.0))
    assert check_stage(scene.save(tmp_path / "held.usda"), []) == []
    scene.schedule("let_go", "pin", "release", times=[0.5])
    problems = "\n".join(check_stage(scene.save(tmp_path / "loose.usda"), []))
    assert "it may break or let go, and has no effort: schedule a force or a torque of its body" in problems
    assert (
        "/World/pin> closes a loop, or may break or let go, and where it is is not told; let the event be" in problems
    )
