"""Cylinders on flat sides in batches, where MuJoCo Warp's search alone is too coarse; each against theory."""

import math

import numpy as np
import pytest

from wsim.scene import Scene
from wsim.sim import Simulation

G = 9.81


def _run(build, folder, seconds):
    """Pose (7,) and twist (6,) of the first body of the last of two worlds."""
    scene = Scene()
    build(scene)
    simulation = Simulation(scene.save(folder / "stage.usda"), "cpu", 2)
    while simulation.time < seconds - 1e-9:
        simulation.step()
    body = simulation.built.bodies[-1] + simulation.model.body_count // 2
    return (each.numpy()[body].astype(float) for each in (simulation.state.body_q, simulation.state.body_qd))


@pytest.mark.parametrize(("radius", "turn"), [(0.05, 0.0), (0.5, 33.0), (2.0, -120.0)])
def test_a_cylinder_rolls_down_a_box(tmp_path, radius, turn):
    """By g sin a t^2 / 3 along the slope and by nothing across or off it, whichever way the slope is turned."""
    lean, heading = math.radians(10.0), math.radians(turn)
    along = np.array([math.cos(lean) * math.cos(heading), math.cos(lean) * math.sin(heading), -math.sin(lean)])
    up = np.array([math.sin(lean) * math.cos(heading), math.sin(lean) * math.sin(heading), math.cos(lean)])

    def build(scene):
        pose = {"rotation_deg": (0, 10.0, turn)}
        scene.box("slope", size=(20, 8, 0.5), position=tuple(-0.25 * up), static=True, friction=0.9, **pose)
        scene.cylinder("log", radius=radius, height=radius, axis="Y", density=600.0, position=tuple(radius * up),
                       friction=0.9, **pose)  # fmt: skip

    pose, _ = _run(build, tmp_path, 0.8)
    way = G * math.sin(lean) * 0.64 / 3
    assert pose[:3] - radius * up == pytest.approx(along * way, rel=0.003, abs=1e-4 * way + 3e-5)


def test_a_leaning_cylinder_falls_about_its_rim(tmp_path):
    """I w^2 / 2 = m g r (cos a - cos b) about the point of its rim that it stands on: b from balance, I of its line."""
    radius, height = 0.1, 0.6
    arm, inertia = math.hypot(radius, height / 2), (3 * radius**2 + height**2) / 12 + radius**2 + height**2 / 4
    balance, lean = math.atan2(radius, height / 2), math.radians(25.0)
    start = lean - balance  # of its middle beyond its rim

    def build(scene):
        scene.box("table", size=(4, 4, 0.1), position=(0, 0, -0.05), static=True, friction=1.0)
        place = (arm * math.sin(start), 0.0, arm * math.cos(start))
        scene.cylinder("can", radius=radius, height=height, mass=2.0, position=place, rotation_deg=(0, 25.0, 0),
                       friction=1.0)  # fmt: skip

    pose, twist = _run(build, tmp_path, 0.45)
    now = math.acos(1.0 - 2.0 * (pose[3] ** 2 + pose[4] ** 2)) - balance
    assert now > start + 0.3
    assert abs(twist[4]) == pytest.approx(
        math.sqrt(2 * G * arm / inertia * (math.cos(start) - math.cos(now))), rel=0.01
    )
