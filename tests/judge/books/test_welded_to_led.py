"""What hangs on a body that a path leads: sound, and told so; of what is a little off the judge says it."""

from dataclasses import replace

import numpy as np
import pytest

from wsim.judge.decide import judge
from wsim.recording import read
from wsim.scene import Scene
from wsim.sim import Simulation

AT = (0.0, 0.0, 1.0)
PATHS = {
    "lift": {"times": (0, 0.4, 0.8), "positions": (AT, (0.3, 0.1, 1.4), AT)},
    "swung": {"times": (0.1, 0.4, 0.8), "positions": (AT, (0.2, 0, 1.1), (0, 0.1, 1)),
              "rotations_deg": ((0, 0, 0), (0, 0, 40), (0, 0, -20))},
    "tilted": {"times": (0.1, 0.45, 0.9), "rotations_deg": ((0, 0, 0), (0, 25, 0), (0, -20, 0))},
    # It comes round to its first key at speed, and so it starts.
    "round": {"times": (0, 0.3, 0.6, 0.9), "positions": (AT, (0.2, 0, 1), (0.1, 0.2, 1.1), AT), "repeat": True},
}  # fmt: skip


def weld(scene):
    scene.joint_fixed("tie", "plate", "load")


def brittle(scene):
    scene.joint_fixed("tie", "plate", "load", break_force=1e6, break_torque=1e6)


def hinge(scene):
    scene.joint_revolute("tie", "plate", "load", anchor=(0, 0, 1.05), axis="Y")


def ball(scene):
    scene.joint_spherical("tie", "plate", "load", anchor=(0, 0, 1.05))


def slider(scene):
    scene.joint_prismatic("tie", "plate", "load", axis="X")


def recorded(folder, path, tie, mass, place):
    scene = Scene()
    scene.simulation(duration=1.0, frame_rate=60.0)
    scene.box("plate", size=(1, 1, 0.1), position=AT, kinematic=True)
    scene.path("plate", **PATHS[path])
    scene.box("load", size=(0.2 * (mass / 8.0) ** (1 / 3),) * 3, mass=mass, position=place)
    tie(scene)
    Simulation(scene.save(folder / "stage.usda"), device="cpu").run(folder / "run.rrd")
    return read(folder / "run.rrd")


HUNG = [
    ("lift", weld, 0.01, (0.1, 0, 1.2)),
    ("lift", weld, 300.0, (0, 0, 1.5)),
    ("swung", weld, 4.0, (0.4, 0.4, 1.2)),
    ("tilted", weld, 0.01, (0, 0.1, 1.15)),
    ("tilted", weld, 3.0, (0.2, 0, 1.5)),
    ("round", weld, 1.0, (0.2, 0.1, 1.2)),
    ("lift", brittle, 2.0, (0.1, 0, 1.2)),
    ("lift", hinge, 2.0, (0.1, 0, 0.6)),
    ("swung", ball, 2.0, (0.1, 0.2, 0.6)),
    ("round", slider, 1.0, (0.2, 0.1, 1.2)),
]


@pytest.mark.parametrize(("path", "tie", "mass", "place"), HUNG, ids=lambda each: getattr(each, "__name__", str(each)))
def test_what_hangs_on_a_led_body_is_sound(tmp_path, path, tie, mass, place):
    """Its ties are recorded as they act under each step's force, which jumps from step to step, and its first step goes
    on from the speed that the path has at the start."""
    verdict = judge(recorded(tmp_path, path, tie, mass, place))
    assert verdict.status == "accepted", [finding.message for finding in verdict.findings if not finding.passed]


def test_a_weld_to_a_led_body_that_gives_a_hundredth_less_is_found(tmp_path):
    recording = recorded(tmp_path, "lift", weld, 2.0, (0.1, 0, 1.2))
    ties = recording.ties
    weaker = replace(recording, ties=replace(ties, joints=(0.99 * ties.joints).astype(np.float32)))
    found = [finding.check for finding in judge(weaker).findings if not finding.passed]
    assert "CheckRecordedForces" in found
