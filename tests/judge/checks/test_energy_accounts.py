"""What is lost goes to something: real runs of wrong worlds, held against the right ones."""

from dataclasses import replace

import numpy as np
import pytest

from tests.judge.theory import ask
from wsim.judge.checks.energy import CheckEnergy
from wsim.recording import read
from wsim.scene import Drive, Scene
from wsim.scene.describe import describe
from wsim.sim import Simulation

RATE, SECONDS = 60.0, 1.2


@pytest.fixture
def account(tmp_path):
    """What the energy budget says of one world's run, taken for another's: the sign of what is wrong, or 0."""

    def stage(build, name, seconds):
        scene = Scene()
        scene.simulation(duration=seconds, frame_rate=RATE)
        build(scene)
        return scene.save(tmp_path / name)

    def answer(made, stated=None, change=lambda recording: recording, seconds=SECONDS):
        Simulation(stage(made, "made.usda", seconds), device="cpu").run(tmp_path / "r.rrd")
        recording = change(read(tmp_path / "r.rrd"))
        if stated is not None:
            recording = replace(recording, world=describe(stage(stated, "stated.usda", seconds)))
        wrong = [finding.message for finding in ask(CheckEnergy(), recording) if not finding.passed]
        return sum(-1 if "loses" in message else 1 for message in wrong)

    return answer


def pendulum(friction=0.0):
    def build(scene):
        scene.sphere("bob", radius=0.1, mass=1.0, position=(0.5, 0, 1.0 - np.sqrt(0.75)))
        scene.joint_revolute("pivot", None, "bob", anchor=(0, 0, 1), axis="Y", friction=friction)

    return build


def cradle(restitution):
    def build(scene):
        for i, lean in enumerate((-0.6, 0.0, 0.0)):
            scene.sphere(f"ball_{i}", radius=0.05, mass=1.0, restitution=restitution, friction=0.0,
                         position=(0.1 * i + 0.5 * np.sin(lean), 0, 1.0 - 0.5 * np.cos(lean)))  # fmt: skip
            scene.joint_revolute(f"hinge_{i}", None, f"ball_{i}", anchor=(0.1 * i, 0, 1), axis="Y")

    return build


def oscillator(damping):
    def build(scene):
        scene.box("block", size=(0.2, 0.2, 0.2), mass=1.0, position=(0.6, 0, 0))
        scene.joint_prismatic("rail", None, "block", axis="X")
        scene.spring("coil", None, "block", stiffness=100.0, damping=damping, rest_length=0.4,
                     anchor_a=(0, 0, 0), anchor_b=(-0.1, 0, 0))  # fmt: skip

    return build


def driven(damping):
    def build(scene):
        scene.box("block", size=(0.2, 0.2, 0.2), mass=1.0)
        drive = Drive(position=0.2, stiffness=100.0, damping=damping)
        scene.joint_prismatic("rail", None, "block", axis="X", drive=drive)

    return build


def rolling(resistance):
    def build(scene):
        scene.ground(friction=0.5)
        scene.sphere("ball", radius=0.1, mass=1.0, position=(0, 0, 0.1), velocity=(1, 0, 0), friction=0.5,
                     angular_velocity_deg=(0, np.degrees(10.0), 0), rolling_friction=resistance)  # fmt: skip

    return build


def untold(recording):
    """Without a word of what rubbed in joints."""
    joints = recording.ties.joints.copy()
    joints[..., 12:] = 0.0
    return replace(recording, ties=replace(recording.ties, joints=joints))


@pytest.mark.parametrize(
    "build",
    [pendulum(), pendulum(0.1), cradle(1.0), cradle(0.5), oscillator(1.0), driven(1.0), rolling(0.0), rolling(0.01)],
    ids=["pendulum", "rubbing", "cradle", "dull cradle", "oscillator", "driven", "rolling", "resisted"],
)
def test_what_sound_worlds_lose_is_taken_by_something(account, build):
    assert account(build) == 0


def test_a_pendulum_that_loses_a_hundredth_a_second(account):
    """0.01 N m over a radian a second, of 1.31 J."""
    assert account(pendulum(0.01), pendulum(), untold, seconds=2.0) == -1


@pytest.mark.parametrize("restitution", [0.5, 0.95])
def test_elastic_balls_that_touch_and_lose_their_energy(account, restitution):
    assert account(cradle(restitution), cradle(1.0)) == -1


@pytest.mark.parametrize("kind", [oscillator, driven])
@pytest.mark.parametrize(("by", "wrong"), [(1.15, -1), (0.85, 1)], ids=["more", "less"])
def test_damping_that_is_another(account, kind, by, wrong):
    assert account(kind(by), kind(1.0)) == wrong


def test_a_ball_that_slows_without_rolling_resistance(account):
    """By a fifteenth of its speed a second at C = 0.005, of which its world knows nothing."""
    assert account(rolling(0.005), rolling(0.0)) == -1


def heap(gap):
    """Three boxes that are set down from `gap` above each other and the ground, and a ball that flies towards them."""

    def build(scene):
        scene.ground()
        for i in range(3):
            height = (0.1 + gap) + i * (0.2 + gap)
            scene.box(f"box_{i}", size=(0.2, 0.2, 0.2), mass=4.0, position=(0, 0, height))
        scene.sphere("ball", radius=0.1, mass=2.0, position=(-3.0, 0, 0.8), velocity=(6.0, 0, 0))

    return build


def slowed(share):
    """The ball keeps but a part of its energy from the first frame on, long before it comes to the boxes."""

    def change(recording):
        qd = np.array(recording.body_qd)
        qd[1:, 3, 0] *= np.sqrt(1.0 - share)
        return replace(recording, body_qd=qd)

    return change


@pytest.mark.parametrize("gap", [0.0, 2e-4, 1e-3])
def test_what_is_set_down_from_a_hair_above_loses_that_and_no_more(account, gap):
    """In their first frame boxes fall g h^2 / 2 = 1.4 mm at most.

    By P g h / 2 of what contacts press with all of them together lose 0.32 J, however fast what comes to them later is.
    The ball has 36 J; of these 0.9 may go unseen, with 0.01 of what changes hands. Once all of them might.
    """
    assert account(heap(gap)) == 0
    assert account(heap(gap), change=slowed(0.04)) == -1


def row(restitution, radii, densities, gaps, wall=None, speed=2.0):
    """A heavy ball that runs into ever lighter ones, in one line without gravity, before a wall or none."""

    def build(scene):
        scene.simulation(duration=0.25, frame_rate=24.0, gravity=(0, 0, 0))
        speeds, place = [speed, 0.0, 0.0, 0.0, 0.0], 0.0
        for i, (radius, density, gap) in enumerate(zip(radii, densities, gaps, strict=True)):
            place += radius
            scene.sphere(f"ball_{i}", radius=radius, density=density, position=(place, 0, 0), restitution=restitution,
                         velocity=(speeds[i], 0, 0))  # fmt: skip
            place += radius + gap
        if wall is not None:
            scene.box("wall", size=(0.2, 1, 1), position=(place + 0.1 + wall, 0, 0), static=True,
                      restitution=restitution)  # fmt: skip

    return build


def drawn_row(seed):
    random = np.random.default_rng(1000 + seed)
    restitution, first, speed = random.choice([0.5, 0.7, 0.9]), random.uniform(0.005, 0.03), random.uniform(1, 3)
    radii, densities, gaps = [0.1], [8000.0], [first]
    for _ in range(random.integers(2, 5)):
        radii.append(radii[-1] * random.uniform(0.5, 0.9))
        densities.append(densities[-1] * random.uniform(0.3, 0.9))
        gaps.append(random.uniform(0.0005, 0.003))
    wall = random.uniform(0.001, 0.05) if random.random() < 0.6 else None
    return row(float(restitution), radii, densities, gaps, wall, speed)


@pytest.mark.parametrize("seed", [0, 2, 8, 20, 24, 25, 26])
def test_light_balls_that_are_hit_several_times_within_a_frame(account, seed):
    """Thrown to and fro between a wall and a heavy ball they are slow at both ends of a frame, and fast between.

    What each blow takes goes by how fast the blows before it may have made them: by the momentum that these gave, and
    the energy that all had.
    """
    assert account(drawn_row(seed), seconds=0.25) == 0


@pytest.mark.parametrize("share", [0.2, 0.4])
def test_what_such_balls_lose_in_flight_is_lost(account, share):
    """Of elastic balls, whose blows take nothing, all of it."""

    def change(recording):
        qd = np.array(recording.body_qd)
        qd[4:] *= np.sqrt(1.0 - share)
        return replace(recording, body_qd=qd)

    build = row(1.0, [0.1, 0.07, 0.05], [8000.0, 4000.0, 1000.0], [0.01, 0.001, 0.0])
    assert account(build, seconds=0.25) == 0
    assert account(build, change=change, seconds=0.25) == -1
