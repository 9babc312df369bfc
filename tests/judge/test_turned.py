"""A world turned as a whole, gravity too, gets the verdict that it gets upright: nothing in it can tell."""

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.judge.checks.test_contact import bowled, trembling
from tests.judge.theory import EDGE, G, bouncing, edited, resting, sliding, swinging, thrown
from tests.judge.turned import any_turn, turned
from wsim.judge import judge
from wsim.judge.language import Signals, evaluate, parse
from wsim.recording import read
from wsim.scene import Scene
from wsim.sim import Simulation

UPSIDE_DOWN, ON_A_WALL = np.array([1.0, 0.0, 0.0, 0.0]), np.array([0.0, math.sqrt(0.5), 0.0, math.sqrt(0.5)])
OBJECTIVES = (
    "finally (rests_on(mug, ground))", "always (upright(mug))", "finally (rolls_without_slip(ball))",
    "always (rolls_without_slip(sled_ball, ramp))", "finally (supported_by(mug, ground))",
)  # fmt: skip
TURNS = [UPSIDE_DOWN, ON_A_WALL, *(any_turn(seed) for seed in range(3))]
WORLDS = {
    "thrown": thrown,
    "falls too slowly": lambda: edited(thrown(), "body_qd", (slice(None), 0, 2), 0.5 * np.arange(31) / 30),
    "bounces": lambda: bouncing(0.6),
    "slides": lambda: sliding(0.5 * G),
    "slides without friction": lambda: sliding(0.02 * G),
    "slides with too much": lambda: sliding(0.9 * G),
    "bowled": bowled,
    "bowled without friction": lambda: bowled(0.1),
    "rests": resting,
    "hovers": lambda: edited(resting(), "body_q", (slice(None), 0, 2), 0.02),
    "sinks": lambda: edited(resting(), "body_q", (slice(None), 0, 2), -0.03),
    "creeps": lambda: edited(resting(), "body_q", (slice(None), 0, 0), 0.02 * EDGE * np.arange(61) / 30),
    "trembles": lambda: trembling(0.002),
    "swings": swinging,
    "swings ever higher": lambda: swinging(0.2),
}


def found(recording):
    """What each check says."""
    return [(f.check, f.passed) for f in judge(recording).findings]


def failing(recording):
    return {f.check for f in judge(recording).findings if not f.passed}


@pytest.mark.parametrize("name", WORLDS)
def test_a_turned_recording_is_judged_as_an_upright_one(name):
    upright = WORLDS[name]()
    for q in TURNS:
        assert found(turned(upright, q)) == found(upright)


def simulated(folder, build, seconds, rate=60):
    scene = Scene()
    build(scene)
    scene.simulation(duration=seconds, frame_rate=rate)
    Simulation(scene.save(folder / "stage.usda"), "cpu").run(folder / "run.rrd")
    return read(folder / "run.rrd")


def any_world(seed):
    """Bodies that slide, roll, swing, stand and fall, on a ground and on a ramp; a random world for each seed."""
    rng = np.random.default_rng(seed)

    def build(scene):
        slope, mu = rng.uniform(8.0, 30.0), rng.uniform(0.1, 0.5)
        tilt, up = math.radians(slope), np.array([math.sin(math.radians(slope)), 0.0, math.cos(math.radians(slope))])
        along = np.array([math.cos(tilt), 0.0, -math.sin(tilt)])
        scene.ground()
        ramp = np.array([0.0, 4.0, 2.0])
        scene.box("ramp", size=(4, 2, 0.1), position=tuple(ramp - 0.05 * up), rotation_deg=(0, slope, 0), static=True)
        size = rng.uniform(0.1, 0.3)
        scene.box("crate", size=(size,) * 3, density=600.0, position=(0, 0, size / 2), friction=mu,
                  velocity=(*rng.uniform(1.0, 3.0, 2), 0))  # fmt: skip
        scene.box("sled", size=(size, size, 0.1), density=600.0, position=tuple(ramp - along + 0.05 * up), friction=mu,
                  rotation_deg=(0, slope, 0), velocity=tuple(along * rng.uniform(0.0, 2.0)))  # fmt: skip
        scene.sphere("ball", radius=size / 2, density=600.0, position=(0, -3, size / 2), friction=mu,
                     velocity=(rng.uniform(2.0, 4.0), 0, 0))  # fmt: skip
        scene.sphere("sled_ball", radius=0.1, density=600.0, friction=0.9, rolling=True,
                     position=tuple(ramp - along + 0.1 * up + (0, 0.6, 0)), velocity=tuple(along))  # fmt: skip
        scene.sphere("marble", radius=0.05, density=2500.0, position=(3, -3, rng.uniform(0.3, 1.0)), restitution=0.7)
        scene.cylinder("mug", radius=0.1, height=0.2, density=600.0, position=(-3, 0, 0.1))
        scene.box("rod", size=(0.04, 0.04, 0.6), density=600.0, position=(-3, -3, 1.0), rotation_deg=(0, 50, 0))
        scene.joint_revolute("pivot", None, "rod", axis="Y", anchor=(0, 0, 0.3))

    return build


@pytest.mark.parametrize("seed", range(3))
def test_a_random_sound_world_is_accepted_however_it_is_turned(tmp_path, seed):
    upright = simulated(tmp_path, any_world(seed), 1.0)
    assert failing(upright) == set()
    for q in TURNS:
        assert found(turned(upright, q)) == found(upright)
        assert weighed(turned(upright, q)) == pytest.approx(weighed(upright), rel=5e-3)


def weighed(recording):
    """By how much some objectives are met that know an up."""
    signals = Signals.of_recording(recording)
    return [float(evaluate(parse(text), signals).robustness[0]) for text in OBJECTIVES]


@pytest.mark.parametrize(("slope", "mu"), [(0.0, 0.1), (5.0, 0.1), (20.0, 0.3), (40.0, 0.1)])
def test_a_slope_may_be_stated_by_its_gravity(tmp_path, slope, mu):
    """In the slope's own axes the ground is level and gravity tilted: x = v t + g (sin a - mu cos a) t^2 / 2."""
    a, seconds = math.radians(slope), 0.8

    def build(scene):
        scene.simulation(gravity=(G * math.sin(a), 0.0, -G * math.cos(a)))
        scene.ground()
        scene.box("box", size=(0.2,) * 3, density=600.0, position=(0, 0, 0.1), velocity=(2, 0, 0), friction=mu)

    recording = simulated(tmp_path, build, seconds)
    way = 2.0 * seconds + 0.5 * G * (math.sin(a) - mu * math.cos(a)) * seconds**2
    assert recording.body_q[-1, 0, 0] == pytest.approx(way, rel=2e-3)
    assert failing(recording) == set()
    bodies = [body.model_copy(update={"shapes": [s.model_copy(update={"friction": 1.1 * mu}) for s in body.shapes]})
              for body in recording.world.bodies]  # fmt: skip
    assert "CheckForces" in failing(replace(recording, world=recording.world.model_copy(update={"bodies": bodies})))


@pytest.mark.parametrize("slope", [5.0, 20.0])
def test_what_slides_down_a_slope_without_its_friction_is_found(slope):
    """As if it were free of friction: on the level mu g is missing, and down a slope too."""
    a = math.radians(slope)
    sound = sliding(0.5 * G * math.cos(a) - G * math.sin(a), speed=6.0, seconds=0.5)
    tilted = sound.world.model_copy(update={"gravity": (G * math.sin(a), 0.0, -G * math.cos(a))})
    wrong = sliding(-G * math.sin(a), speed=6.0, seconds=0.5)
    assert "CheckForces" not in failing(replace(sound, world=tilted))
    assert "CheckForces" in failing(replace(wrong, world=tilted))
