"""What is small moves as what is large does: falls, throws, slides, rolling and ropes of centimetres, by theory."""

import math

import numpy as np
import pytest

from benchmarks.rigid_cases.case import Bench, elliptic_k, period
from wsim.errors import UserError
from wsim.scene import Scene
from wsim.sim import Simulation

G = 9.81
SIZES = pytest.mark.parametrize("size", [0.005, 0.05])
WORLDS = [1, 2]  # MuJoCo in C, and in Warp


@pytest.mark.parametrize("worlds", WORLDS)
def test_a_fall_by_its_own_size(worlds):
    """g t² / 2 after eight steps: v += g h, x += v h would be 1 / 8 too far."""
    bench, size = Bench("cpu", worlds), 0.005
    track = bench.run(lambda scene: scene.sphere("ball", radius=0.5 * size, density=600.0), 0.01)
    assert bench.step > 0.001
    assert -track.position("ball")[-1, 2] == pytest.approx(0.5 * G * track.time[-1] ** 2, rel=1e-4)


@SIZES
def test_a_throw_by_its_own_size(size):
    """v² / 2 g, between frames by g / 8 of their time squared less."""
    up = math.sqrt(2.0 * G * size)
    track = Bench("cpu").run(
        lambda scene: scene.sphere("ball", radius=0.5 * size, velocity=(0.1, 0.0, up)), 2.0 * up / G, rate=1000.0
    )
    assert track.position("ball")[:, 2].max() == pytest.approx(size, abs=G / 8.0 * 0.001**2 + 1e-5 * size)


@SIZES
@pytest.mark.parametrize("worlds", WORLDS)
def test_a_slide_by_a_few_sizes(size, worlds):
    """v² / 2 μ g: by steps of the first order v h / 2 short, 1.3 % at 5 mm; and it stays on the ground."""
    start = math.sqrt(2.0 * G * size)

    def build(scene):
        scene.ground(friction=0.4)
        edges = (2.0 * size, 2.0 * size, 0.5 * size)
        scene.box("box", size=edges, position=(0, 0, 0.25 * size), friction=0.4, velocity=(start, 0, 0))

    track = Bench("cpu", worlds).run(build, 4.0 * start / G)
    assert track.position("box")[-1, 0] == pytest.approx(start**2 / (0.8 * G), rel=1e-3)
    assert np.abs(track.position("box")[:, 2] - 0.25 * size).max() < 1e-3 * size


@SIZES
def test_a_ball_that_slips_comes_to_roll(size):
    """After 2 v / 7 μ g at 5/7 v, having gone 12 v² / 49 μ g."""
    start, mu = math.sqrt(2.0 * G * size), 0.3

    def build(scene):
        scene.ground(friction=mu)
        scene.sphere("ball", radius=0.5 * size, position=(0, 0, 0.5 * size), friction=mu, velocity=(start, 0, 0))

    track = Bench("cpu").run(build, 6.0 * start / G)
    rolls = track.time[-1] - 2.0 * start / (7.0 * mu * G)
    way = 12.0 * start**2 / (49.0 * mu * G) + 5.0 / 7.0 * start * rolls
    assert track.velocity("ball")[-1, 0] == pytest.approx(5.0 / 7.0 * start, rel=1e-3)
    assert track.position("ball")[-1, 0] == pytest.approx(way, rel=1e-3)


@pytest.mark.parametrize("worlds", WORLDS)
def test_what_nothing_resists_rolls_on_beside_what_is_resisted(worlds):
    """A ball of a centimetre keeps its speed to 2e-4 in half a second: 1e-5 m of resistance took 7 mm/s of it."""

    def build(scene):
        scene.ground()
        for k, resistance in enumerate((0.0, 0.03)):
            scene.sphere(f"ball_{k}", radius=0.01, position=(0, 0.2 * k, 0.01), velocity=(0.3, 0, 0), rolling=True,
                         rolling_friction=resistance)  # fmt: skip

    track = Bench("cpu", worlds).run(build, 0.5)
    assert track.velocity("ball_0")[-1, 0] == pytest.approx(0.3, rel=2e-4)
    assert track.velocity("ball_1")[-1, 0] < 0.22


@pytest.mark.parametrize("worlds", WORLDS)
def test_a_bob_on_a_rope_of_a_centimetre(worlds):
    """By 60° each way in 4 √(l / g) K(sin 30°), on a rope as long as it is, with all its energy."""
    length = 0.01
    known = 4.0 * math.sqrt(length / G) * elliptic_k(0.5)
    place = (-length * math.sin(math.pi / 3.0), 0.0, -0.5 * length)

    def build(scene):
        scene.sphere("bob", radius=0.05 * length, mass=0.001, position=place)
        scene.rope("rope", None, "bob", anchor_a=(0, 0, 0))

    track = Bench("cpu", worlds).run(build, 3.2 * known, rate=500.0)
    q, v = track.position("bob"), track.velocity("bob")
    assert period(track.time, q[:, 0]) == pytest.approx(known, rel=2e-3)
    assert np.linalg.norm(q, axis=1).max() < 1.001 * length
    energy = G * q[:, 2] + 0.5 * (v**2).sum(axis=1)  # the speeds are those of half a step before
    assert np.abs(energy - energy[0]).max() < 0.05 * 0.5 * G * length


def test_small_bodies_turn_by_their_own_inertia(tmp_path):
    """M a² / 6 of a cube of 3 mm, 2e-11 kg m²; Newton by itself would make it 1e-6."""
    scene = Scene()
    scene.box("cube", size=(0.003,) * 3, mass=1.5e-5)
    simulation = Simulation(scene.save(tmp_path / "stage.usda"), "cpu")
    moments = np.diag(simulation.model.body_inertia.numpy()[0])
    assert moments == pytest.approx(1.5e-5 * 0.003**2 / 6.0, rel=1e-4)


def test_what_is_too_light_to_turn_is_refused(tmp_path):
    scene = Scene()
    scene.box("dust", size=(1e-4,) * 3, density=1000.0)
    with pytest.raises(UserError, match=r"/World/dust: its smallest moment of inertia is 1\.7e-18"):
        Simulation(scene.save(tmp_path / "stage.usda"), "cpu")
