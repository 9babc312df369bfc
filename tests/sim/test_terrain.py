"""What rolls, slides and stands on terrain, against theory."""

import math

import numpy as np
import pytest

from benchmarks.rigid_cases.case import Bench, G
from wsim.recording.contacts import shapes_of
from wsim.scene import Area, Noise, Road, Scene
from wsim.sim import Simulation


@pytest.fixture(params=["cpu", pytest.param("cuda:0", marks=pytest.mark.cuda)])
def bench(request):
    return Bench(request.param)


def leaning(degrees):
    """A slope that falls along +X."""
    return lambda x, y: -math.tan(math.radians(degrees)) * x


@pytest.mark.parametrize("outline", [None, [(-0.5, -2.0), (0.5, -2.0), (0.5, 2.0), (-0.5, 2.0)]])
def test_a_ball_rolls_down_and_no_seam_of_areas_slows_it(bench, outline):
    """5/7 g sin(slope), within 0.5 %, over two seams as without."""
    radius, lean = 0.1, math.radians(10.0)

    def build(scene):
        areas = [Area("strip", outline=outline, friction=0.7)] if outline else []
        scene.terrain("land", size=(6.0, 4.0), cell=0.25, layers=[leaning(10.0)], areas=areas, friction=0.8)
        place = (-2.0 + radius * math.sin(lean), 0.03, 2.0 * math.tan(lean) + radius * math.cos(lean))
        scene.sphere("ball", radius=radius, position=place, density=1000.0, friction=0.8)

    track = bench.run(build, 1.8)
    assert track.moved() == pytest.approx(5.0 / 14.0 * G * math.sin(lean) * 1.8**2, rel=5e-3)
    assert track.moved() > 1.8  # past the seams at -0.5


def test_a_crate_slides_on_by_the_friction_of_each_area(bench):
    """From 3 m/s 1 m on soil of 0.3, then on ice of 0.05: v² = v0² - 2 g (0.3 s1 + 0.05 s2), within 1 %."""

    def build(scene):
        ice = Area("ice", outline=[(0.0, -2.0), (6.0, -2.0), (6.0, 2.0), (0.0, 2.0)], friction=0.05)
        scene.terrain("land", size=(12.0, 4.0), cell=0.5, layers=[lambda x, y: 0.0], areas=[ice], friction=0.3)
        scene.box("crate", size=(0.02, 0.4, 0.02), position=(-1.0, 0.0, 0.01), velocity=(3.0, 0.0, 0.0), mass=5.0)

    track = bench.run(build, 1.0)
    way = track.moved()
    speed = math.sqrt(9.0 - 2.0 * G * (0.3 * 1.0 + 0.05 * (way - 1.0)))
    assert way > 1.5
    assert track.velocity("crate")[-1, 0] == pytest.approx(speed, rel=1e-2)


def test_wheels_bear_what_a_slope_leaves_them(tmp_path):
    """Nose up by 12 deg the front axle bears m g (share cos - h / L sin), brakes on, each wheel within 2 %."""
    scene, lean = Scene(), math.radians(12.0)
    scene.simulation(frame_rate=20.0)
    land = scene.terrain("land", size=(10.0, 6.0), cell=0.5, layers=[leaning(-12.0)], friction=0.9)
    pitch = -land.slope_deg(0.0, 0.0, heading_deg=0.0)
    vehicle = scene.vehicle("v", "hmmwv", position=land.place(0.0, 0.0), pitch_deg=pitch)
    vehicle.brake()
    simulation = Simulation(scene.save(tmp_path / "v.usda"), device="cpu")
    simulation.rigid.keep_contacts()
    for _ in range(30):
        simulation.advance_frame()
        pushes = simulation.rigid.take_contacts()
    shapes = [shape.prim for shape in shapes_of(simulation.world)]
    spec = vehicle.spec
    lever = spec.com_height / spec.wheelbase * math.sin(lean)
    found = {}
    for corner, wheel in vehicle.wheels.items():
        rows = [any(shapes[k].startswith(f"{wheel.path}/") for k in pair) for pair in pushes.pair]
        found[corner] = float(pushes.sums[rows, 3].sum()) * 20.0
    total = spec.mass * G * math.cos(lean)
    assert sum(found.values()) == pytest.approx(total, rel=5e-3)
    for corner, push in found.items():
        share = spec.front_share if corner.startswith("front") else 1.0 - spec.front_share
        side = -1.0 if corner.startswith("front") else 1.0
        expected = 0.5 * spec.mass * G * (share * math.cos(lean) + side * lever)
        assert push == pytest.approx(expected, rel=0.02), (corner, push, expected)


def test_a_ball_keeps_its_energy_over_rough_ground(bench):
    """Down and up noise without rolling resistance: m g z + 7/10 m v² stays within 2 % of its range in 3 s."""
    radius = 0.15

    def build(scene):
        land = scene.terrain("land", size=(16.0, 8.0), cell=0.25, friction=0.8,
                             layers=[leaning(4.0), Noise(0.25, 6.0, octaves=2, seed=5)])  # fmt: skip
        normal = np.array(land.normal(-6.0, 0.0))
        place = np.array(land.place(-6.0, 0.0)) + radius * normal
        scene.sphere("ball", radius=radius, position=tuple(place), density=1000.0, friction=0.8)

    track = bench.run(build, 3.0)
    speed2 = (track.velocity("ball") ** 2).sum(axis=1)
    energy = G * track.position("ball")[:, 2] + 0.7 * speed2
    assert 0.7 * speed2.max() > 1.0  # it has come into motion
    assert np.ptp(energy) < 0.02 * 0.7 * speed2.max()


def test_a_ball_follows_the_road_that_is_cut_into_a_slope(bench):
    """On a slope across the road its level bed keeps a ball that rolls along it: it does not drift aside."""
    road = Road(points=[(-8.0, 0.0), (8.0, 0.0)], width=3.0, shoulder=1.0)

    def build(scene):
        land = scene.terrain("land", size=(18.0, 8.0), cell=0.25, friction=0.8,
                             layers=[lambda x, y: 0.3 * y, road])  # fmt: skip
        x, y, z = land.place(-4.0, 0.0, above=0.2)
        scene.sphere("ball", radius=0.2, position=(x, y, z), velocity=(2.0, 0.0, 0.0), rolling=True, density=1000.0)

    track = bench.run(build, 3.0)
    end = track.position("ball")[-1]
    assert end[0] == pytest.approx(2.0, rel=1e-3)
    assert abs(end[1]) < 2e-3


@pytest.mark.parametrize("worlds", [1, 2])
def test_among_many_rocks_terrain_is_no_convex_hull(tmp_path, worlds):
    """Newton's masks of what does not touch have 32 colours; a truck, its ground and 40 rocks are more than that."""
    scene = Scene()
    scene.simulation(frame_rate=100.0)
    land = scene.terrain("land", size=(40.0, 24.0), cell=1.0, layers=[lambda x, y: 0.02 * (x * x + y * y)])
    vehicle = scene.vehicle("v", "hmmwv", position=land.place(0.0, 0.0, above=0.06))
    scene.scatter("rock", on=land, count=40, clear=[((0.0, 0.0), 5.0)])
    simulation = Simulation(scene.save(tmp_path / "v.usda"), device="cpu", world_count=worlds)
    body = [body.prim for body in simulation.world.bodies].index(vehicle.path)
    begin = float(simulation.state.body_q.numpy()[body, 2])
    for _ in range(3):
        simulation.advance_frame()
    assert float(simulation.state.body_q.numpy()[body, 2]) == pytest.approx(begin, abs=0.005)  # it was lifted out of it
