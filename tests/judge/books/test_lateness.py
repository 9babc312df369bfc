"""Poses and velocities alone, of an engine that says nothing of its steps: what a spring gives is told all the same."""

from dataclasses import replace

import numpy as np
import pytest

from tests.judge.test_turned import simulated
from tests.judge.theory import ask, with_world
from wsim.judge.books.lateness import steps_at_most
from wsim.judge.checks.forces import CheckForces
from wsim.judge.evidence.evidence import Evidence
from wsim.scene import Drive

RATE, STIFFNESS, SPEED = 60.0, 150.0, 2.0  # of a weight of 1 kg: 0.2 rad a frame
FLOOR = {"size": (0.1, 0.1, 0.1), "position": (0.7, 0, 0.05), "mass": 1, "velocity": (SPEED, 0, 0)}


def sprung(damping=0.0, gravity=0.0, floor=False):
    def build(scene):
        scene.simulation(duration=1.0, frame_rate=RATE, gravity=(0, 0, -gravity))
        scene.box("weight", **FLOOR, friction=0)
        scene.spring("spring", None, "weight", stiffness=STIFFNESS, damping=damping, rest_length=0.5,
                     anchor_a=(0.1, 0, 0.05), anchor_b=(0.65, 0, 0.05))  # fmt: skip
        if floor:
            scene.ground(friction=0)

    return build


def bare(recording):
    """What a table of poses and velocities says."""
    world = recording.world.model_copy(update={"time_step": 0.0})
    return replace(recording, world=world, metadata={"complete": True}, contacts=None, ties=None)


def passes(recording):
    return all(finding.passed for finding in ask(CheckForces(), recording))


@pytest.mark.parametrize(("gravity", "floor"), [(0.0, False), (9.81, True)])
@pytest.mark.parametrize("damping", [0.2, 1.0])
def test_a_damper_that_is_not_there_is_found(tmp_path, gravity, floor, damping):
    """Energy goes by e^(-c t / m): 18 % and 63 % of it in a second. c v is 0.4 N and 2 N, of a spring's 24 N."""
    sound = simulated(tmp_path / "sound", sprung(0.0, gravity, floor), 1.0)
    damped = simulated(tmp_path / "damped", sprung(damping, gravity, floor), 1.0)
    assert passes(bare(sound))
    assert passes(bare(damped))
    assert not passes(bare(with_world(damped, springs=sound.world.springs)))


def lift(scene):
    """A cage of 364 kg that its drive brings 0.7 m high: at first with all that it has."""
    scene.simulation(duration=1.2, frame_rate=RATE, gravity=(0, 0, -2.41))
    scene.box("cage", size=(0.6, 0.6, 0.6), mass=364)
    drive = Drive(position=0.7, stiffness=41_850, damping=4_970, max_force=2_717)
    scene.joint_prismatic("rail", None, "cage", axis="Z", drive=drive)


def test_what_a_drive_gives_is_told_where_its_spring_and_its_damper_are_at_odds(tmp_path):
    """They are 6 and 6 kN, and together 0.6: the mean of both ends misses 25 N, of a sum that is known to 5."""
    sound = simulated(tmp_path, lift, 1.2)
    (rail,) = sound.world.joints
    assert passes(bare(sound))
    for wrong in ({"damping": 1.05 * rail.drive.damping}, {"stiffness": 1.05 * rail.drive.stiffness}):
        drive = rail.drive.model_copy(update=wrong)
        assert not passes(bare(with_world(sound, joints=[rail.model_copy(update={"drive": drive})])))


# ---- other engines, by closed form
def of_engine(recording, step, substeps):
    """The weight as an engine has it go along its line, with some steps a frame."""
    h, place, rate = 1.0 / RATE / substeps, 0.0, SPEED  # from its rest length, which 0.55 m is not
    weight = recording.body_q.astype(np.float64).copy()
    velocity = np.zeros_like(recording.body_qd)
    start, rest = weight[0, 0, 0], 0.05
    for k in range(len(weight)):
        weight[k, 0] = (start + place, *weight[0, 0, 1:])
        velocity[k, 0, 0] = rate
        for _ in range(substeps):
            place, rate = step(place + rest, rate, h, STIFFNESS)
            place -= rest
    return replace(bare(recording), body_q=weight, body_qd=velocity)


def kick_drift(x, v, h, k):
    v -= h * k * x
    return x + h * v, v


def leapfrog(x, v, h, k):
    v -= 0.5 * h * k * x
    x += h * v
    return x, v - 0.5 * h * k * x


def trapezoid(x, v, h, k):
    p = 0.25 * h * h * k
    after = ((1.0 - p) * v - h * k * x) / (1.0 + p)
    return x + 0.5 * h * (v + after), after


@pytest.mark.parametrize("step", [kick_drift, leapfrog, trapezoid])
@pytest.mark.parametrize("substeps", [1, 4, 50])
def test_other_engines_steps_are_told_by_the_motion(tmp_path, step, substeps):
    """Of first order 1 / n of a frame; of second order 2 or 1 of what the trapezoidal rule leaves, by the square."""
    recording = of_engine(simulated(tmp_path, sprung(), 1.0), step, substeps)
    first, second = steps_at_most(Evidence(recording))
    one = 1.0 / substeps if step is kick_drift else 0.0
    assert first[0] * RATE > one - 0.02  # by steps as long as frames it may not be told apart
    if substeps > 1:
        assert first[0] * RATE == pytest.approx(one, abs=0.02)
    if step is not kick_drift:
        share = (2.0 if step is leapfrog else 1.0) / substeps**2
        assert second[0] == pytest.approx(min(share, 1.0), abs=0.03)
    assert passes(recording)


def test_where_nothing_tells_steps_may_be_as_long_as_frames(tmp_path):
    """What stands, and what a blow throws about in each interval."""
    recording = bare(simulated(tmp_path, sprung(), 1.0))
    still = replace(recording, body_qd=np.zeros_like(recording.body_qd), body_q=recording.body_q[:1].repeat(61, axis=0))
    thrown = replace(recording, body_qd=np.random.default_rng(1).normal(size=recording.body_qd.shape))
    for each in (still, thrown):
        first, second = steps_at_most(Evidence(each))
        assert first[0] == pytest.approx(1.0 / RATE)
        assert second[0] == 1.0
