"""What is light beside what is heavy is pressed by what it weighs, in every step."""

import pytest

from tests.judge.test_turned import simulated
from wsim.judge.books.recorded import RecordedContacts
from wsim.judge.evidence.evidence import Evidence

STEPS = 840  # a second: a frame for each


def tables(scene):
    """Boxes and a ball slide on a table that is led round, beside a table of 330 kg on a motor."""
    scene.simulation(gravity=(0, 0, -1.6))
    for k, mass in enumerate((330.0, 96.0)):
        led = {"kinematic": True, "angular_velocity_deg": (0, 0, 60)} if k else {}
        scene.cylinder(f"table_{k}", radius=0.67, height=0.067, mass=mass, position=(0, 3 * k, -0.0335), friction=0.3,
                       **led)  # fmt: skip
    scene.joint_revolute("axle", None, "table_0", axis="Z")
    scene.box("box", size=(0.18, 0.11, 0.11), mass=5.0, position=(0.35, 3, 0.055), friction=0.8)
    scene.box("light", size=(0.18, 0.11, 0.11), mass=1.6, position=(-0.2, 2.65, 0.055), friction=0.5)
    scene.sphere("ball", radius=0.09, mass=6.5, position=(-0.2, 3.4, 0.09), friction=0.7)


def test_no_step_leaves_a_light_body_a_force_without_a_cause(tmp_path):
    """MuJoCo ends where it gains little of the trace of M: up to 1 % of g were left to what weighs 1.6 kg."""
    recording = simulated(tmp_path, tables, 0.1, rate=STEPS)
    evidence = Evidence(recording)
    assert recording.contacts is not None
    balanced = RecordedContacts(evidence, recording.contacts).balanced()
    loose = ~evidence.motion.kinematic & ~evidence.motion.jointed
    left = abs(balanced.force[:, loose]).max()
    assert left == pytest.approx(0.0, abs=2e-3)
