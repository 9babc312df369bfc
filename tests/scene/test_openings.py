"""Taps and drains, from a program's calls to a stage and back."""

import math

import pytest
import trimesh

from wsim.scene import Scene, SceneError, schema
from wsim.scene.check import check_stage
from wsim.scene.describe import describe
from wsim.solvers.shapes import OpenBox, sample_container
from wsim.solvers.sph_config import ConfigSPH


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


def test_a_tap_inside_of_what_is_solid_is_refused(scene):
    scene.ground("ground")
    scene.box("block", size=(0.2, 0.2, 0.2), position=(0.0, 0.0, 0.12), static=True)
    scene.cylinder("post", radius=0.1, height=0.4, position=(1.0, 0.0, 0.5))
    for position, said in (
        ((0.0, 0.0, 0.15), r"position = \(0.0, 0.0, 0.15\) m is 0.08 m deep inside of /World/block"),
        ((2.0, 0.0, -0.2), r"m is 0.21 m deep inside of /World/ground.*put it outside, or in the surface"),
        ((1.0, 0.0, 0.5), r"inside of /World/post"),
    ):
        with pytest.raises(SceneError, match=said):
            scene.tap("tap" + str(abs(hash(position))), "water", rate=0.001, position=position, radius=0.05)


@pytest.mark.parametrize(
    ("position", "direction"),
    [
        ((0.0, 0.0, 0.02), (0.0, 0.0, 1.0)),  # in the floor
        ((-0.2, 0.0, 0.15), (1.0, 0.0, 0.0)),  # in a wall
        ((-0.2, 0.0, 0.15), (1.0, 0.0, 1.0)),  # aslant
        ((0.0, 0.0, 0.1), (0.0, 0.0, 1.0)),  # above the floor
        ((0.0, 0.0, 0.4), (0.0, 0.0, -1.0)),  # over the tank
    ],
)
@pytest.mark.parametrize("sunk", [0.0, -0.2])
def test_inlets_in_floors_and_walls_are_let_be(position, direction, sunk, tmp_path):
    scene = Scene()
    scene.ground("ground")
    scene.tank("tank", inner_size=(0.4, 0.4, 0.3), position=(0.0, 0.0, sunk))
    scene.fluid("water", fills="tank", level=0.1, spacing=0.02)
    x, y, z = position
    scene.tap("tap", "water", rate=0.001, position=(x, y, z + sunk), direction=direction, radius=0.05)
    assert check_stage(scene.save(tmp_path / "stage.usda"), [tmp_path]) == []


def test_a_solid_that_is_put_about_a_tap_later_is_found(scene, tmp_path):
    scene.tap("tap", "water", rate=0.001, position=(0.0, 0.0, 0.25), radius=0.05)
    scene.box("lid", size=(0.5, 0.5, 0.2), position=(0.0, 0.0, 0.3), static=True)
    (found,) = check_stage(scene.save(tmp_path / "stage.usda"), [tmp_path])
    assert "/World/tap: its position (0.0, 0.0, 0.25) m is 0.04 m deep inside of /World/lid" in found


def test_a_mesh_is_solid_where_it_winds_about_a_mouth(scene, tmp_path):
    trimesh.creation.annulus(0.1, 0.2, 0.4).export(tmp_path / "ring.obj")
    scene.mesh("ring", file=tmp_path / "ring.obj", position=(1.0, 0.0, 0.5), static=True)
    scene.tap("hole", "water", rate=0.001, position=(1.0, 0.0, 0.5), radius=0.05)
    with pytest.raises(SceneError, match="inside of /World/ring"):
        scene.tap("tap", "water", rate=0.001, position=(1.15, 0.0, 0.5), radius=0.04)


@pytest.mark.parametrize(("speed", "least"), [(0.0, 0.5 * 20 * 0.02**3), (2.0, 0.5 * 0.02**3)])
def test_a_tap_that_is_too_slow_for_its_first_particles_is_refused(scene, tmp_path, speed, least):
    scene.simulation(duration=3.0)
    scene.tap("tap", "water", rate=1.01 * least / 2.0, position=(0.0, 0.0, 1.0), radius=0.05, start=1.0, speed=speed)
    assert check_stage(scene.save(tmp_path / "stage.usda"), [tmp_path]) == []
    scene.simulation(duration=2.9)
    (found,) = check_stage(scene.save(tmp_path / "slow.usda"), [tmp_path])
    assert "/World/tap.wsim:rate" in found and f"its first particles come with {least:.3g} m^3" in found
    assert f"take a rate > {least / 1.9:.3g} m^3/s, a longer run" in found


def test_a_tank_that_is_too_narrow_for_a_fluid_is_found_wherever_it_stands(tmp_path):
    """The solver samples the walls of each tank, of whatever fluid, and needs four particles across."""
    scene = Scene()
    scene.fluid("drop", size=(0.3, 0.3, 0.3), position=(3.0, 0.0, 1.0), spacing=0.03)
    scene.tank("tank", inner_size=(2.0, 0.6, 0.1))
    with pytest.raises(SceneError, match=r"0.03 m is too coarse for tank .*least edge 0.1 m, must hold 4 .*<= 0.025"):
        scene.fluid("water", fills="tank", level=0.0, spacing=0.03)
    (found,) = check_stage(scene.save(tmp_path / "stage.usda"), [tmp_path])
    assert "/World/drop.wsim:spacing: 0.03 m is too coarse for /World/tank" in found and "spacing <= 0.025 m" in found


@pytest.mark.parametrize("edge", [0.1, 0.7, 0.3, 1.1])
def test_a_tank_of_just_four_particles_is_let_be(edge, tmp_path):
    scene = Scene()
    scene.tank("tank", inner_size=(1.2, 1.2, edge))
    scene.fluid("water", fills="tank", volume=1.2 * 1.2 * edge / 2, spacing=edge / 4)
    assert check_stage(scene.save(tmp_path / "stage.usda"), [tmp_path]) == []
    size = describe(scene.stage).containers[0].inner_size
    sample_container(OpenBox((0.0, 0.0, 0.0), size), ConfigSPH(spacing=edge / 4, speed_of_sound=10.0))


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
