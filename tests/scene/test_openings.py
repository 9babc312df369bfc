"""Taps and drains, from a program's calls to a stage and back."""

import math

import pytest

from wsim.scene import Scene, SceneError, schema
from wsim.scene.check import check_stage
from wsim.scene.describe import describe


@pytest.fixture
def scene() -> Scene:
    scene = Scene()
    scene.tank("tank", inner_size=(0.4, 0.4, 0.3))
    scene.fluid("water", fills="tank", level=0.0, spacing=0.02)
    return scene


def test_what_is_said_of_taps_and_drains_is_read_back(scene, tmp_path):
    scene.tap("hose", "water", rate=0.002, position=(0.1, 0.0, 0.5), direction=(1.0, 0.0, -1.0), radius=0.03, stop=2.0)
    scene.tap("rain", "water", rate=1e-4, position=(0.0, 0.0, 1.0), size=(0.4, 0.3), start=1.0, speed=3.0)
    scene.drain("hole", "water", position=(0.0, 0.1, 0.0), radius=0.05)
    world = describe(scene.save(tmp_path / "stage.usda"))
    hose, rain = world.taps
    assert (hose.rate, hose.radius, hose.start, hose.stop, hose.drop_speed) == (0.002, 0.03, 0.0, 2.0, 0.0)
    assert hose.position == pytest.approx((0.1, 0.0, 0.5))
    assert hose.direction == pytest.approx((math.sqrt(0.5), 0.0, -math.sqrt(0.5)))
    assert hose.speed == pytest.approx(0.002 / (math.pi * 0.03**2))
    assert hose.poured(5.0) == pytest.approx(0.004)
    assert (rain.size, rain.drop_speed, rain.stop) == ((0.4, 0.3), 3.0, None)
    assert rain.poured(3.0) == pytest.approx(2e-4)
    assert [(d.prim, d.fluid, d.radius, d.falls) for d in world.drains] == [("/World/hole", "/World/water", 0.05, True)]
    assert world.fluids[0].size[2] == 0.0
    assert check_stage(tmp_path / "stage.usda", [tmp_path]) == []


def test_a_fluid_that_is_empty_needs_a_tap(scene, tmp_path):
    stage = scene.save(tmp_path / "stage.usda")
    assert any("holds nothing, and no tap pours it" in problem for problem in check_stage(stage, [tmp_path]))


def test_a_tap_beside_a_second_fluid_is_refused(scene):
    scene.fluid("oil", size=(0.1, 0.1, 0.1), position=(3.0, 0.0, 1.0), spacing=0.02)
    with pytest.raises(SceneError, match='"oil" is there too'):
        scene.tap("tap", "water", rate=0.001, position=(0.0, 0.0, 1.0), radius=0.05)


@pytest.mark.parametrize(
    ("call", "arguments", "said"),
    [
        ("tap", {"rate": 0.001, "radius": 0.01}, "the mouth is 0.02 m across"),
        ("drain", {"radius": 0.03}, "which block it; make it 0.08 m wide"),
        ("tap", {"rate": 0.001, "radius": 0.05, "size": (0.1, 0.1)}, "give the radius of a round mouth, or the size"),
        ("tap", {"rate": 0.001}, "give the radius of a round mouth, or the size"),
        ("tap", {"rate": 0.001, "radius": 0.05, "start": 2.0, "stop": 1.0}, "stop = 1 s is not after start = 2 s"),
    ],
)
def test_a_mouth_that_cannot_be_says_what_to_do(scene, call, arguments, said):
    with pytest.raises(SceneError, match=said):
        getattr(scene, call)("mouth", "water", position=(0.0, 0.0, 1.0), **arguments)


def test_a_stage_whose_tap_is_out_of_range_is_refused(scene, tmp_path):
    tap = scene.tap("tap", "water", rate=0.001, position=(0.0, 0.0, 1.0), radius=0.05)
    prim = scene.stage.GetPrimAtPath(tap.path)
    assert schema.has(prim, schema.TAP)
    prim.GetAttribute("wsim:rate").Set(-1.0)
    prim.GetAttribute("wsim:radius").Set(0.0)
    found = "; ".join(check_stage(scene.save(tmp_path / "stage.usda"), [tmp_path]))
    assert "wsim:rate: -1 must be within" in found
    assert "one of them must be more than 0" in found
