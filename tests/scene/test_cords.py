"""Springs, ropes and cables that cannot be: one line that names the call, the value and the way out."""

import math

import numpy as np
import pytest

from wsim.scene import Scene, SceneError
from wsim.scene.check import check_stage
from wsim.scene.describe import describe


@pytest.fixture
def scene():
    scene = Scene()
    scene.box("a", size=(0.1, 0.1, 0.1), position=(0, 0, 1))
    scene.box("b", size=(0.1, 0.1, 0.1), position=(0, 0, 2))
    scene.box("far", size=(0.1, 0.1, 0.1), position=(500, 0, 2))
    scene.box("wall", size=(0.1, 1, 1), position=(1, 0, 1), static=True)
    scene.cylinder("wheel", radius=0.2, height=0.1, axis="Y", position=(0.3, 0, 3), static=True)
    return scene


@pytest.mark.parametrize(
    ("ends", "more", "message"),
    [
        (("a", "b"), {"stiffness": -1.0}, "stiffness = -1 must be >= 0 N/m"),
        (("a", "b"), {"stiffness": 1.0, "damping": -2.0}, "damping = -2 must be >= 0 N s/m"),
        (("a", "b"), {"stiffness": 0.0}, "would do nothing; give one of them"),
        (("a", "b"), {"stiffness": float("nan")}, "stiffness = nan must be finite"),
        (("a", "a"), {"stiffness": 1.0}, 'a = b = "a": its ends need two bodies'),
        (("wall", None), {"stiffness": 1.0, "anchor_b": (0, 0, 0)}, "neither a nor b is a body that it could move"),
        ((None, "b"), {"stiffness": 1.0}, "a = None is the world; give anchor_a"),
        (("a", "far"), {"stiffness": 1.0}, "its ends are 500 m apart; at most 100 m"),
        (("a", "b"), {"stiffness": 1.0, "rest_length": 0.05}, "rest_length = 0.05 m, and its ends are 1 m apart"),
        (("a", None), {"stiffness": 1.0, "anchor_b": (0, 0, 1)}, r"both its ends are at \(0, 0, 1\) m"),
        (("a", "nobody"), {"stiffness": 1.0}, 'b = "nobody" is not in the scene'),
    ],
)
def test_a_spring_that_cannot_be(scene, ends, more, message):
    with pytest.raises(SceneError, match=rf'spring\("s"\): .*{message}'):
        scene.spring("s", *ends, **more)


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"length": 0.5}, "length = 0.5 m is shorter than its way at the start, 1 m"),
        ({"around": ["wall"]}, r'around\[0\] = "wall" has no cylinder that collides'),
        ({"around": [("wheel", "beside")]}, 'side = "beside" must be "over", "under"'),
        ({"around": [("wheel", (0, 1, 0))]}, "is along the axis of"),
        ({"around": ["wheel", "wheel"]}, 'around names "wheel" twice'),
        ({"around": ["wheel"], "anchor_b": (0.3, 0, 3.1)}, "lies inside the cylinder"),
    ],
)
def test_a_rope_that_cannot_be(scene, more, message):
    with pytest.raises(SceneError, match=rf'rope\("r"\): .*{message}'):
        scene.rope("r", "a", "b", **more)
    assert not scene.stage.GetPrimAtPath("/World/r")


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"length": 0.5}, "length = 0.5 m is shorter"),
        ({"radius": 0.3}, "too thick for a cable of 1 m"),
        ({"loose": True}, "an end that is tied to something is not loose"),
        ({"links": 1}, "links = 1 must be >= 2"),
        ({"mass_per_length": 0.0}, "mass_per_length = 0 must be > 0 kg/m"),
    ],
)
def test_a_cable_that_cannot_be(scene, more, message):
    with pytest.raises(SceneError, match=rf'cable\("c"\): .*{message}'):
        scene.cable("c", "a", "b", **more)


def test_a_cable_whose_way_hardly_bends_is_refused_where_links_would_be_in_each_other(scene):
    """By 7 degrees over a post of 16 cm: the link there would be 1 cm long, and those beside it are 1.6 cm thick."""
    lean, ring = math.radians(3.5), 0.168
    turn = [(ring * math.sin(a), 0, ring * math.cos(a)) for a in np.linspace(-lean, lean, 5)]
    reach = [turn[-1][k] + 0.7 * way for k, way in zip((0, 2), (math.cos(lean), -math.sin(lean)), strict=True)]
    with pytest.raises(SceneError, match=r"through bends by so little at .* 0.0103 m long.* a radius below 0.0051 m"):
        scene.cable("c", None, None, anchor_a=(-reach[0], 0, reach[1]), anchor_b=(reach[0], 0, reach[1]),
                    through=turn, links=14, radius=0.008)  # fmt: skip


def test_a_stage_states_what_the_calls_were_given(scene, tmp_path):
    scene.spring("s", "a", "wall", stiffness=30.0, damping=2.0, rest_length=0.5, anchor_b=(0.95, 0, 1))
    scene.rope("r", "b", None, anchor_b=(0.6, 0, 2), around=["wheel"])
    stage = scene.save(tmp_path / "stage.usda")
    assert check_stage(stage, [tmp_path]) == []
    world = describe(stage)
    (spring,), (rope,) = world.springs, world.ropes
    assert (spring.stiffness, spring.damping, spring.rest_length) == (30.0, 2.0, 0.5)
    assert [guide.body for guide in spring.path] == ["/World/a", None]
    assert spring.line.startswith("test_cords.py:")
    assert [guide.radius for guide in rope.path] == [0.0, 0.2, 0.0]
    assert rope.length > 2.0


@pytest.mark.parametrize(
    ("attribute", "value", "message"),
    [
        ("wsim:stiffness", -1.0, "/World/s.wsim:stiffness: -1 must be >= 0"),
        ("wsim:restLength", 0.001, "/World/s.wsim:restLength: 0.001 m, and its ends are 1 m apart"),
        ("wsim:radius", 0.0, "/World/s.wsim:radius: 0 m must be > 0"),
    ],
)
def test_a_stage_with_a_spring_that_cannot_be_is_refused(scene, tmp_path, attribute, value, message):
    scene.spring("s", "a", "b", stiffness=30.0)
    scene.stage.GetPrimAtPath("/World/s").GetAttribute(attribute).Set(value)
    assert message in check_stage(scene.save(tmp_path / "stage.usda"), [tmp_path])[0]


def test_a_cable_of_links_that_are_too_short_says_how_many_fit():
    scene = Scene()
    scene.sphere("ball", radius=0.1, position=(0, 0, 1))
    with pytest.raises(SceneError, match=r"links = 10 of 0.1 m are too short for a radius of 0.05 m.*at most 5 links"):
        scene.cable("cable", None, "ball", anchor_a=(0, 0, 2), anchor_b=(0, 0, 1), radius=0.05, links=10)
