"""A ball that rocks across a gutter, fast and far, as a pendulum of its length does."""

import math
from functools import partial

import numpy as np
import pytest
from scipy.special import ellipk

from tests.sim.test_bodies import Run
from wsim.scene import Scene

G = 9.81


def rocking(scene: Scene, wide: float, radius: float, lean: float, friction: float, mass: float) -> None:
    """A ball let go on one side of a gutter, `lean` [rad] from its foot."""
    arm = wide - radius
    scene.track("gutter", pieces=[("line", 8 * wide)], start=(-4 * wide, 0, 0), profile="round", width=2 * wide,
                wall=0.9 * wide, thickness=0.15 * wide, friction=friction)  # fmt: skip
    scene.sphere("ball", radius=radius, mass=mass, friction=friction,
                 position=(0, -arm * math.sin(lean), wide - arm * math.cos(lean)))  # fmt: skip


def energy_and_period(run: Run, wide: float, radius: float) -> tuple[np.ndarray, float]:
    """Of a ball over its mass above the foot, through time [J/kg], and the mean time to and fro [s]."""
    q, v, w = run.q["ball"], run.v["ball"], run.w["ball"]
    energy = G * (q[:, 2] - radius) + 0.5 * (v**2).sum(axis=1) + 0.2 * radius**2 * (w**2).sum(axis=1)
    angle = np.arctan2(q[:, 1], wide - q[:, 2])
    k = np.flatnonzero((angle[:-1] < 0.0) & (angle[1:] >= 0.0))
    passes = run.dt * (k - angle[k] / (angle[k + 1] - angle[k]))
    return energy, float(passes[-1] - passes[0]) / (len(passes) - 1)


@pytest.mark.parametrize(
    ("wide", "radius", "lean", "friction", "mass"),
    [
        (0.3, 0.075, 70.0, 1.0, 2.0),  # 6 rad/s
        (0.02, 0.005, 30.0, 0.8, 0.004),  # 22 rad/s; on a step's end it turns back with 0.05 mm/s
        (0.01, 0.0025, 50.0, 0.8, 1e-4),  # 31 rad/s
        (0.006, 0.0015, 50.0, 0.0, 2e-5),  # 47 rad/s: a friction of 1e-5, MuJoCo's least, takes 0.3 %
        (0.006, 0.003, 60.0, 1.0, 1e-4),  # 48 rad/s
    ],
)
def test_a_ball_keeps_its_energy_as_it_rocks(tmp_path, wide, radius, lean, friction, mass):
    """Where its acceleration changes by 0.3 m/s^2 in a step, which was taken for a jolt, it doubled in 3 s.

    Where that did not happen a start's velocities half a step ahead took up to 1.4 %.
    """
    lean, arm = math.radians(lean), wide - radius
    run = Run(tmp_path, "cpu", lambda scene: rocking(scene, wide, radius, lean, friction, mass), 3.0)
    energy, period = energy_and_period(run, wide, radius)
    start = G * arm * (1.0 - math.cos(lean))
    assert energy == pytest.approx(start, rel=0.005)
    rate = math.sqrt(G / arm * (5.0 / 7.0 if friction else 1.0))
    assert period == pytest.approx(4.0 / rate * ellipk(math.sin(0.5 * lean) ** 2), rel=1e-3)


def test_half_the_step_keeps_it_four_times_better(tmp_path):
    """By the second order: what is off is off from the start on, and does not grow."""
    wide, radius, lean = 0.006, 0.0015, math.radians(50.0)
    off = []
    for step in (1.2e-3, 6e-4):
        folder = tmp_path / f"{step}"
        folder.mkdir()
        run = Run(folder, "cpu", lambda scene: rocking(scene, wide, radius, lean, 1.0, 2e-5), 1.5, time_step=step)
        energy = energy_and_period(run, wide, radius)[0]
        off.append(np.abs(energy / (G * (wide - radius) * (1.0 - math.cos(lean))) - 1.0).max())
    assert off[0] < 0.004 and off[1] < 0.4 * off[0]


@pytest.mark.parametrize("device", ["cpu", pytest.param("cuda:0", marks=pytest.mark.cuda)])
def test_a_batch_goes_as_one_world_does(tmp_path, device):
    """The same energies through Warp, in its single precision."""
    build = partial(rocking, wide=0.01, radius=0.0025, lean=math.radians(50.0), friction=0.8, mass=1e-4)
    run = Run(tmp_path, device, build, 0.5, worlds=2)
    energy = energy_and_period(run, 0.01, 0.0025)[0]
    assert energy == pytest.approx(G * 0.0075 * (1.0 - math.cos(math.radians(50.0))), rel=0.005)


@pytest.mark.parametrize("friction", [0.0, 1.0])
def test_a_start_at_the_foot_keeps_it(tmp_path, friction):
    """With the speed of a fall from 50 degrees, in a bend from the first step on."""
    wide, radius = 0.01, 0.0025
    start = G * 0.0075 * (1.0 - math.cos(math.radians(50.0)))
    speed = math.sqrt(2.0 * start * (5.0 / 7.0 if friction else 1.0))

    def build(scene: Scene) -> None:
        scene.track("gutter", pieces=[("line", 0.08)], start=(-0.04, 0, 0), profile="round", width=2 * wide,
                    wall=0.009, thickness=0.0015, friction=friction)  # fmt: skip
        scene.sphere("ball", radius=radius, mass=1e-4, friction=friction, position=(0, 0, radius),
                     velocity=(0, speed, 0), rolling=friction > 0.0)  # fmt: skip

    energy = energy_and_period(Run(tmp_path, "cpu", build, 1.0), wide, radius)[0]
    assert energy == pytest.approx(start, rel=0.01)
