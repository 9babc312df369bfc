"""Places by velocities where something pulls hard between two frames."""

from tests.judge.test_turned import simulated
from tests.judge.theory import ask, edited, with_world
from wsim.judge import judge
from wsim.judge.checks.continuity import CheckContinuity


def pressed(scene):
    """A ball that a spring presses to an elastic floor by up to 100 m/s^2, so that it bounces at 6 m/s in a frame."""
    scene.simulation(gravity=(0, 0, -1.6))
    scene.ground(restitution=1)
    scene.sphere("ball", radius=0.05, mass=1, position=(0, 0, 0.3), restitution=1)
    scene.spring("spring", None, "ball", stiffness=200, rest_length=1.2, anchor_a=(0, 0, 1), anchor_b=(0, 0, 0.3))


def failed(recording):
    return [finding.message for finding in ask(CheckContinuity(), recording) if not finding.passed]


def test_a_ball_that_a_spring_presses_bounces_within_a_frame(tmp_path):
    recording = simulated(tmp_path, pressed, 0.7)
    assert failed(recording) == []
    assert failed(edited(recording, "body_q", (slice(30, None), 0, 2), 0.3)) != []
    spring = recording.world.springs[0]
    for by in (0.9, 1.1):
        other = spring.model_copy(update={"stiffness": by * spring.stiffness})
        assert judge(with_world(recording, springs=[other])).status == "rejected"
