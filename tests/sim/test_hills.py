"""What rolls over ground whose triangles stand for a curve whose bend changes from place to place."""

import math

import numpy as np
import pytest

from tests.sim.test_bodies import Run

G, RADIUS = 9.81, 0.11
HIGH, WAVE = 0.11, 1.32  # of the ground's waves [m]


def valley(scene, cells=48):
    """A ball let go beside the bottom of a valley; cells of 7 cm, a fifth of the radius that the ground bends with."""
    scene.height_field("land", size=(16 * 0.22, 10 * 0.22), cells=(cells, 30), friction=0.6, thickness=0.2,
                       heights=lambda x, y: HIGH * math.sin(2 * math.pi * x / WAVE))  # fmt: skip
    x, slope = 0.45, HIGH * 2 * math.pi / WAVE * math.cos(2 * math.pi * 0.45 / WAVE)
    out = RADIUS / math.hypot(1.0, slope)
    z = HIGH * math.sin(2 * math.pi * x / WAVE)
    scene.sphere("ball", radius=RADIUS, density=400.0, position=(x - slope * out, 0.02, z + out), friction=0.6)


@pytest.mark.parametrize("worlds", [1, 2], ids=["C", "Warp"])
def test_a_ball_in_a_valley_keeps_its_energy(tmp_path, worlds):
    """Its push is square to the ground that its gap is measured from.

    By the corners' normals as they were, interpolated, it was 1 degree off on the slopes, as the mean of a triangle's
    three is off the triangle where the bend changes; 3.4 % of the energy went on the way down and came back up.
    """
    run = Run(tmp_path, "cpu", valley, 1.2, worlds)
    q, v, w = run.q["ball"], run.v["ball"], run.w["ball"]
    moves = 0.5 * (v**2).sum(axis=1) + 0.2 * RADIUS**2 * (w**2).sum(axis=1)
    found = G * q[:, 2] + moves
    assert np.ptp(q[:, 0]) > 0.4
    assert np.abs(found - found[0]).max() < 5e-3 * moves.max()
