"""What lies on the floor of a tank presses on it by its weight less its lift, or rises where it is the lighter."""

import math

import numpy as np
import pytest

from wsim.judge.checks.fluid_push import CheckFluidPush
from wsim.judge.evidence.evidence import Evidence
from wsim.recording import read
from wsim.scene import Scene
from wsim.sim import Simulation

G, SPACING = 9.81, 0.02
HALF, FLOOR = 3 * SPACING, 0.02  # of bodies; a tank's bottom is so thick


def run(tmp_path, duration, place):
    """A body in a tank of 14 x 14 x 12 particles of water."""
    scene = Scene()
    scene.simulation(duration=duration, frame_rate=60.0)
    tank = scene.tank("tank", inner_size=(14 * SPACING, 14 * SPACING, 20 * SPACING))
    scene.fluid("water", fills=tank, level=12 * SPACING, spacing=SPACING)
    place(scene)
    Simulation(scene.save(tmp_path / "stage.usda"), device="cpu").run(tmp_path / "r.rrd")
    recording = read(tmp_path / "r.rrd")
    assert all(finding.passed for finding in CheckFluidPush().run(Evidence(recording)))
    return recording


def test_a_ball_of_lead_presses_on_the_floor_by_its_weight_less_its_lift(tmp_path):
    """Its lift in stirred water is up to a tenth too much (9.6 N for 8.9), which is 1 % of what it presses with."""
    density = 11340.0
    start = (0.003, 0.0, FLOOR + HALF + 1e-4)
    recording = run(tmp_path, 0.5, lambda scene: scene.sphere("ball", radius=HALF, density=density, position=start))
    later = recording.time > 0.25
    volume = 4.0 / 3.0 * math.pi * HALF**3
    assert recording.contact_force[later, 0, 2].mean() == pytest.approx((density - 1000.0) * G * volume, rel=0.01)
    lift = np.diff(np.cumsum(recording.applied_impulse[:, 0, 2], dtype=float)[later]).mean() * 60.0
    assert lift == pytest.approx(1000.0 * G * volume, rel=0.1)


@pytest.mark.parametrize(
    ("shape", "density", "over"),
    [("sphere", 950.0, 0.0), ("box", 900.0, 0.0), ("box", 900.0, 2.5), ("slab", 600.0, 0.0)],
)
def test_what_is_lighter_than_water_rises_from_the_floor(tmp_path, shape, density, over):
    """By three quarters of a spacing, where water gets in, in 0.6 s; with flush faces ten particles wide, too."""

    def place(scene):
        height = 2 * HALF if shape != "slab" else 3 * SPACING
        position = (0.003, 0.0, FLOOR + 0.5 * height + over * SPACING + 1e-4)
        if shape == "sphere":
            scene.sphere("ball", radius=HALF, density=density, position=position)
        else:
            wide = 2 * HALF if shape == "box" else 10 * SPACING
            scene.box("box", size=(wide, wide, height), density=density, position=position)

    height = run(tmp_path, 0.6, place).body_q[:, 0, 2]
    assert height[-1] > height[0] + 0.75 * SPACING
    assert height.min() > height[0] - 0.5 * SPACING
