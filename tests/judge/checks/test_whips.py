"""What is light beside what it hangs together with: it swings within a frame, and may get all of the energy."""

import math

import pytest

from tests.judge.test_turned import simulated
from tests.judge.theory import ask, edited
from wsim.judge.checks.continuity import CheckContinuity
from wsim.judge.checks.physics import CheckExplosion

SPEED = 2.4  # [m/s]


def strung(scene):
    """A bob of 19 g on a rope, and one of 800 g on another under it: the first swings across by 2 rad a frame."""
    scene.simulation(gravity=(0, 0, -3.4))
    scene.sphere("light", radius=0.02, mass=0.019, position=(0, 0, -0.2), velocity=(SPEED, 0, 0))
    scene.sphere("heavy", radius=0.02, mass=0.8, position=(0, 0, -0.4))
    scene.rope("upper", None, "light", anchor_a=(0, 0, 0))
    scene.rope("lower", "light", "heavy")


def whipped(scene):
    """Adrift: a rod of 50 g is hinged to another of 20 kg that turns, and starts along it, at rest against it."""
    scene.simulation(gravity=(0, 0, 0))
    scene.box("heavy", size=(1.0, 0.1, 0.1), mass=20.0, position=(0, 0, 0), angular_velocity_deg=(0, 0, 200))
    scene.box("light", size=(0.2, 0.02, 0.02), mass=0.05, position=(0.6, 0, 0),
              velocity=(0, 0.6 * math.radians(200.0), 0), angular_velocity_deg=(0, 0, 200))  # fmt: skip
    scene.joint_revolute("hinge", "heavy", "light", anchor=(0.5, 0, 0), axis="Z")


def failures(check, recording):
    return [finding for finding in ask(check, recording) if not finding.passed]


def test_a_light_bob_between_two_ropes_swings_within_a_frame(tmp_path):
    recording = simulated(tmp_path, strung, 1.0, rate=24)
    assert failures(CheckContinuity(), recording) == []
    row = [body.prim for body in recording.world.bodies].index("/World/heavy")
    late = edited(recording, "body_q", (slice(12, None), row, 0), 0.3)
    assert failures(CheckContinuity(), late)


@pytest.mark.parametrize(("times", "passes"), [(0.5, True), (1.1, False)])
def test_a_light_link_may_get_all_that_its_mechanism_has_and_no_more(tmp_path, times, passes):
    """Of a mass m of M that starts at v, v sqrt(M / m): 20 times the speed here."""
    recording = simulated(tmp_path, whipped, 0.5)
    finding = ask(CheckExplosion(), recording)[0]
    assert finding.passed
    most = math.sqrt(20.05 / 0.05)
    start = 0.6 * math.radians(200.0) + math.radians(200.0) * math.hypot(0.1, 0.01, 0.01)  # its outer end, at most
    row = [body.prim for body in recording.world.bodies].index("/World/light")
    speed = times * most * start
    faster = edited(recording, "body_qd", (slice(15, 18), row, 1), speed)
    assert (failures(CheckExplosion(), faster) == []) == passes
