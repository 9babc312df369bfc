"""Motion that a program states: written as USD, read back, and refused where it cannot be."""

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom

from wsim.scene import Scene, SceneError
from wsim.scene.check import check_stage
from wsim.scene.describe import describe
from wsim.scene.usd_motion import curve_of

KEYS = {"times": (0, 1), "positions": ((0, 0, 1), (0, 0, 2))}


@pytest.fixture
def scene():
    made = Scene()
    made.ground()
    made.box("belt", size=(4, 1, 0.2), position=(0, 0, 0.1), rotation_deg=(0, 0, 90), static=True)
    made.box("crate", size=(1, 1, 1), position=(0, 0, 3))
    made.box("lift", size=(1, 1, 0.1), position=(0, 0, 1), kinematic=True)
    made.box("belted", size=(1, 1, 0.1), position=(5, 0, 1), rotation_deg=(0, 0, 90), kinematic=True)
    return made


def test_a_surface_velocity_is_read_in_the_owners_axes(scene):
    """A static shape's are the world's; a body's its own."""
    for name in ("belt", "belted"):
        scene.surface_velocity(name, velocity=(1, 0, 0))
    world = describe(scene.stage)
    (belt,) = (static for static in world.statics if static.prim == "/World/belt")
    assert belt.shapes[0].surface_velocity == pytest.approx((0, 1, 0), abs=1e-9)
    assert world.body("/World/belted").shapes[0].surface_velocity == pytest.approx((1, 0, 0), abs=1e-9)


def test_a_path_is_keys_and_time_samples(scene, tmp_path):
    """usdview plays what the simulator does, at any frame rate, though the rate was said later."""
    turns = ((0, 0, 0), (0, 0, 90))
    scene.path("lift", **KEYS, rotations_deg=turns)
    scene.simulation(duration=2.0, frame_rate=50.0)
    path = scene.save(tmp_path / "stage.usda")
    assert check_stage(path, [tmp_path]) == []
    stage = Usd.Stage.Open(str(path))
    lift = UsdGeom.Xformable(stage.GetPrimAtPath("/World/lift"))
    body = describe(stage).body("/World/lift")
    curve = curve_of(body.path)
    assert body.path.times == [0, 1] and body.position == pytest.approx((0, 0, 1))
    for code in (0, 25, 50, 100):
        place = lift.ComputeLocalToWorldTransform(Usd.TimeCode(code)).ExtractTranslation()
        assert np.allclose(place, curve.pose(code / 50.0)[0], atol=1e-9)


def test_time_samples_of_a_hand_written_stage_are_a_path(scene, tmp_path):
    op = UsdGeom.Xformable(scene.stage.GetPrimAtPath("/World/lift")).GetOrderedXformOps()[0]
    for code, height in ((0, 1.0), (30, 2.0), (60, 1.5)):
        op.Set(Gf.Vec3d(0, 0, height), code)
    stage = scene.save(tmp_path / "stage.usda")
    assert check_stage(stage, [tmp_path]) == []
    path = describe(stage).body("/World/lift").path
    assert path.times == pytest.approx([0, 1, 2])
    assert np.array(path.positions)[:, 2] == pytest.approx([1.0, 2.0, 1.5])


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"body": "crate", **KEYS}, 'body = "crate" is not kinematic; make it with kinematic=True'),
        ({"body": "lft", **KEYS}, 'did you mean "lift"'),
        ({"body": "lift", "times": (0, 1)}, "neither positions nor rotations_deg"),
        ({"body": "lift", **KEYS, "times": (1, 1)}, r"times\[1\] = 1 s must be later than times\[0\] = 1 s"),
        ({"body": "lift", **KEYS, "times": (0, 1, 2)}, "positions has 2 keys, and times has 3"),
        ({"body": "lift", **KEYS, "times": (0, 0.01)}, "150 m/s, a jump; at most 100 m/s: give it more time"),
        ({"body": "lift", **KEYS, "repeat": True}, "end as it begins"),
        ({"body": "lift", "times": (0, 1), "rotations_deg": ((0, 0, 0), (0, 0, 360))}, "give keys between"),
        ({"body": "lift", "times": (0,), "positions": ((0, 0, 0),)}, "must have 2 to"),
    ],
)
def test_a_path_that_cannot_be_is_refused(scene, given, said):
    with pytest.raises(SceneError, match=said):
        scene.path(**given)


@pytest.mark.parametrize(
    ("kind", "given", "said"),
    [
        ("sphere", {"radius": 0.1}, "needs a velocity"),
        ("sphere", {"radius": 0.1, "velocity": (0, 0, 1)}, "would roll on a wall"),
        ("sphere", {"radius": 0.1, "velocity": (1, 0, 0), "kinematic": True}, "only a loose body rolls"),
        ("sphere", {"radius": 0.1, "velocity": (1, 0, 0), "angular_velocity_deg": (0, 1, 0)}, "keep one"),
        ("cylinder", {"radius": 0.1, "height": 1, "velocity": (1, 0, 0)}, "lay it down"),
        ("cylinder", {"radius": 0.1, "height": 1, "axis": "X", "velocity": (1, 0, 0)}, "not square to the X axis"),
    ],
)
def test_what_cannot_roll_is_refused(kind, given, said):
    with pytest.raises(SceneError, match=said):
        getattr(Scene(), kind)("thing", rolling=True, **given)


@pytest.mark.parametrize("late", [False, True])
@pytest.mark.parametrize(
    ("gravity", "spin"),
    [((0, 0, -9.81), (-10, 0, 0)), ((9.81, 0, 0), (0, 0, -10)), ((0, 0, 1.6), (10, 0, 0)), ((0, 0, 0), (-10, 0, 0))],
)
def test_what_rolls_rolls_on_what_gravity_presses_it_to(late, gravity, spin):
    """n x v / r, n against gravity, wherever in the program that is stated; without any, up is Z."""
    scene = Scene()
    if not late:
        scene.simulation(gravity=gravity)
    scene.sphere("ball", radius=0.1, velocity=(0, 1, 0), rotation_deg=(20, 30, 40), rolling=True)
    scene.simulation(gravity=gravity)
    (ball,) = describe(scene.stage).bodies
    assert np.array(ball.angular_velocity) == pytest.approx(np.array(spin), abs=1e-5)


def test_a_gravity_along_which_a_ball_was_to_roll_is_refused():
    scene = Scene()
    scene.sphere("ball", radius=0.1, velocity=(0, 1, 0), rolling=True)
    with pytest.raises(SceneError, match=r'sphere\("ball"\): rolling = True .* would roll on a wall'):
        scene.simulation(gravity=(0, 9.81, 0))


def test_a_body_has_one_path(scene):
    scene.path("lift", **KEYS)
    with pytest.raises(SceneError, match='body = "lift" has a path already; give it one'):
        scene.path("lift", **KEYS)


def test_a_stage_by_other_means_is_checked(scene, tmp_path):
    """Keys out of order."""
    scene.path("lift", **KEYS)
    prim = scene.stage.GetPrimAtPath("/World/lift")
    prim.GetAttribute("wsim:times").Set([1.0, 0.0])
    problems = "\n".join(check_stage(scene.save(tmp_path / "stage.usda"), [tmp_path]))
    assert "/World/lift.wsim:times: times must rise" in problems
