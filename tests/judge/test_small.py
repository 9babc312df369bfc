"""Sound worlds of millimetres to centimetres are accepted."""

import math

import pytest

from wsim.judge import judge
from wsim.recording import read
from wsim.scene import Scene
from wsim.sim import Simulation


def _bounces_on(scene):
    """Its bounces fit into frames, and it rolls on between them: it slips over nothing."""
    scene.sphere("ball", radius=0.005, position=(0, 0, 0.06), velocity=(0.47, 0, 0.1), friction=0.4, restitution=0.85,
                 density=1000.0)  # fmt: skip


def _hardly_bounces(scene):
    """By less than it falls in a step."""
    scene.sphere("ball", radius=0.005, position=(0, 0, 0.045), velocity=(0.15, 0, 0), friction=0.4, restitution=0.08,
                 density=1000.0)  # fmt: skip


def _tumbles(scene):
    """Its least moment of inertia is 2e-11 kg m²."""
    scene.box("box", size=(0.005, 0.0035, 0.0025), position=(0, 0, 0.01), rotation_deg=(25, 50, 0), density=1000.0,
              velocity=(0.1, 0, 0))  # fmt: skip


def _is_knocked(scene):
    for name, x, y, speed in (("striker", 0.0, 0.0, 0.6), ("target", 0.02, 0.003, 0.0)):
        scene.box(name, size=(0.01,) * 3, position=(x, y, 0.005), velocity=(speed, 0, 0), friction=0.3, density=1000.0)


def _swings(scene):
    place = (-0.01 * math.sin(1.0), 0.0, 0.05 - 0.01 * math.cos(1.0))
    scene.sphere("bob", radius=0.001, mass=3e-5, position=place)
    scene.rope("rope", None, "bob", anchor_a=(0, 0, 0.05))


LOOSE = (_bounces_on, _hardly_bounces, _tumbles, _is_knocked)


@pytest.mark.parametrize(
    ("fill", "rate"), [*((fill, rate) for fill in LOOSE for rate in (24.0, 60.0)), (_swings, 60.0)]
)
def test_small_sound_worlds_are_accepted(tmp_path, fill, rate):
    scene = Scene()
    scene.simulation(duration=0.7, frame_rate=rate)
    scene.ground()
    fill(scene)
    Simulation(scene.save(tmp_path / "stage.usda"), "cpu").run(tmp_path / "run.rrd")
    verdict = judge(read(tmp_path / "run.rrd"), None)
    assert [finding.message for finding in verdict.findings if not finding.passed] == []
