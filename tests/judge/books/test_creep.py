"""Slow slips by closed form: what goes steadily by some mm/s has what pushes it, or friction would have stopped it."""

import math

import numpy as np
import pytest

from tests.judge.test_turned import simulated
from tests.judge.theory import EDGE, G, ask, box, record, slab, times, with_world
from wsim.judge import judge
from wsim.judge.checks.forces import CheckForces
from wsim.scene import Drive


def creeping(rate, slope=0.0, friction=0.5, belt=0.0, told=True, seconds=1.0):
    """A box that goes at `rate` [m/s] down a slope [rad], on a surface that goes at `belt`; its velocities say so."""
    t = times(seconds, 60.0)
    down = np.array([math.cos(slope), 0.0, -math.sin(slope)])
    out = np.array([math.sin(slope), 0.0, math.cos(slope)])
    lean = (0.0, math.sin(slope / 2), 0.0, math.cos(slope / 2))
    under = slab("slope", (9.0, 9.0, 0.2), tuple(-0.1 * out))
    shape = under.shapes[0].model_copy(
        update={"rotation": lean, "friction": friction, "surface_velocity": (belt, 0.0, 0.0)}
    )
    place = EDGE / 2 * out + np.outer(rate * t, down)
    velocity = np.tile(rate * down, (len(t), 1)) * (1.0 if told else 0.0)
    return record([box(friction=friction)], place, velocity, t, rotation=np.tile(lean, (len(t), 1)),
                  statics=[under.model_copy(update={"shapes": [shape]})])  # fmt: skip


def off(recording):
    return [finding for finding in ask(CheckForces(), recording) if not finding.passed]


SLOPE = math.atan(0.5)


@pytest.mark.parametrize("recording", [
    creeping(0.0), creeping(0.0, 0.3), creeping(0.005, belt=0.005), creeping(0.005, SLOPE), creeping(0.0004, SLOPE),
])  # fmt: skip
def test_what_stands_rides_or_slides_where_its_weight_pays_for_it_is_sound(recording):
    """It stands, on the level and on a slope below the angle of friction; a belt takes it; it slides at that angle."""
    assert off(recording) == []


@pytest.mark.parametrize(("recording", "share"), [
    (creeping(0.0004), 0.5), (creeping(0.005), 0.5), (creeping(0.005, told=False), 0.5),
    (creeping(0.005, 0.3), 0.5 * math.cos(0.3) - math.sin(0.3)), (creeping(0.005, belt=-0.005), 0.5),
    (creeping(0.005, SLOPE, 0.6), 0.1 * math.cos(SLOPE)), (creeping(0.005, SLOPE, 0.4), 0.1 * math.cos(SLOPE)),
])  # fmt: skip
def test_what_creeps_with_nothing_to_push_it_is_found(recording, share):
    """By the force that it takes along, of its weight; the books put a part of it into how hard it is pressed."""
    found = off(recording)
    assert found
    value = found[-1].value / recording.world.bodies[0].mass / G
    assert 0.75 * share < value < 1.01 * share


def test_a_slip_that_comes_and_goes_may_stick_meanwhile():
    """A box that is jerked on, a frame in four, may be held by friction in the others: it does not creep."""
    recording = creeping(0.0)
    steps = np.repeat(np.arange(16), 4)[: len(recording.time)]
    recording.body_q[:, 0, 0] += 1e-4 * steps
    assert not any("creeps" in finding.message for finding in ask(CheckForces(), recording))


def turntable(scene):
    """A box lies on a table that a motor brings to its speed."""
    scene.simulation(gravity=(0, 0, -2.8))
    scene.cylinder("table", radius=1.6, height=0.16, density=400, position=(0, 0, -0.08), friction=0.4)
    scene.joint_revolute("axle", None, "table", axis="Z", drive=Drive(velocity=35.0, damping=20000.0))
    scene.box("box", size=(0.44, 0.27, 0.27), density=700, position=(-0.3, 0.44, 0.135), friction=0.4)


def test_what_a_turntable_carries_may_lag_by_the_order_of_its_steps_and_no_more(tmp_path):
    """By half a time step of its acceleration, 0.12 mm/s: outwards and back; friction would hold what slips by more."""
    recording = simulated(tmp_path, turntable, 0.6, rate=120)
    assert off(recording) == []
    out = recording.body_q[:, 1, :2] / np.linalg.norm(recording.body_q[:, 1, :2], axis=1)[:, None]
    recording.body_q[:, 1, :2] += 4e-4 * (recording.time[:, None] * out)
    assert any("creeps" in finding.message for finding in off(recording))


def wheel(scene):
    """A ball of 1 m that starts to roll down 15 degrees against a resistance of 2 %: by 0.02 rad in 16 frames."""
    lean = math.radians(15.0)
    scene.simulation(gravity=(1.6 * math.sin(lean), 0, -1.6 * math.cos(lean)))
    scene.ground(friction=0.5, rolling_friction=0.02)
    scene.sphere("ball", radius=1.0, density=1500, position=(0, 0, 1), friction=0.5, rolling_friction=0.02)


def test_what_rolls_against_resistance_slips_inside_the_cone(tmp_path):
    """By C / mu x / sqrt(1 - x^2) of its rolling (`wsim.judge.books.sharing`), which is no creep against friction."""
    recording = simulated(tmp_path, wheel, 0.6)
    assert judge(recording).failures == []
    for by in (0.9, 1.1):
        assert judge(resisted(recording, by)).status == "rejected"


def resisted(recording, by):
    """The same motion, of a world whose surfaces are said to resist rolling more."""

    def other(owner):
        shapes = [s.model_copy(update={"rolling": by * s.rolling}) for s in owner.shapes]
        return owner.model_copy(update={"shapes": shapes})

    world = recording.world
    return with_world(recording, bodies=[*map(other, world.bodies)], statics=[*map(other, world.statics)])
