"""What two fingers hold: friction alone carries it, as far as Coulomb's law says."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.judge.theory import ask
from wsim.judge.checks.forces import CheckForces
from wsim.plan.store import load
from wsim.program.compose import compose
from wsim.recording import Recording, read
from wsim.scene import Scene
from wsim.scene.describe import describe
from wsim.sim import Simulation

SIZE, MASS, GRAVITY = 0.04, 0.1, 9.81  # [m], [kg], [m/s^2]
LIFT, RISE = 0.03, 0.6  # [m], [s]
GRIPS = 0.4  # when it is gripped [s]
HAND = {"rotation_deg": (180.0, 0.0, 90.0), "point": (0.0, 0.0, 0.07)}
STIFFNESS, GIVES = 800.0, 0.018  # of desk_arm's grip [N/m], and how far the cube keeps its finger from its aim [m]
HOLDS = STIFFNESS * GIVES  # of both fingers together [N]: 2 F
ABOVE = {
    "pan": 15.9454,
    "lift": 55.5409,
    "elbow": 95.3785,
    "wrist": 29.0816,
    "roll": 105.9453,
}  # fingers round the cube
LEAST = MASS * (GRAVITY + 6.0 * LIFT / RISE**2) / HOLDS  # friction that lifts it, mu 2 F = m (g + a)


def gripped(folder: Path, friction: float) -> Recording:
    """A cube that is gripped and lifted by 3 cm."""
    scene = Scene()
    scene.simulation(duration=GRIPS + RISE + 0.2, frame_rate=50.0)
    scene.ground()
    cube = scene.material("cube", friction=friction)
    scene.box("cube", size=(SIZE,) * 3, position=(0.35, 0.1, SIZE / 2.0), mass=MASS, material=cube)
    arm = scene.robot("arm", "desk_arm", joints=ABOVE)
    arm.follow("hand", path=[(0.35, 0.1, SIZE / 2.0)], times=[0.05], **HAND)
    arm.follow("hand", path=[(0.35, 0.1, SIZE / 2.0 + LIFT)], times=[GRIPS + RISE], start=GRIPS, **HAND)
    arm.drive("left_finger", times=[0.05, 0.3], positions=[0.03, 0.0])
    simulation = Simulation(scene.save(folder / "stage.usda"), device="cpu")
    assert simulation.run(folder / "recording.rrd").problems == []
    return read(folder / "recording.rrd")


def height(recording: Recording) -> float:
    """Of the cube above where it stood, at the end [m]."""
    row = [body.prim for body in recording.world.bodies].index("/World/cube")
    return float(recording.body_q[-1, row, 2] - SIZE / 2.0)


def test_a_cube_is_lifted_above_the_limit_and_its_books_close(tmp_path: Path) -> None:
    """A sixth above m (g + a) / 2 F it comes along to 0.2 mm; and that it creeps by more than steps leave is found."""
    recording = gripped(tmp_path, 1.16 * LEAST)
    assert height(recording) == pytest.approx(LIFT, abs=1e-3)
    assert all(finding.passed for finding in ask(CheckForces(), recording))
    row = [body.prim for body in recording.world.bodies].index("/World/cube")
    poses, rises = recording.body_q.copy(), recording.time > GRIPS + 0.1
    poses[rises, row, 2] += 2e-3 * (recording.time[rises] - GRIPS - 0.1)  # by 2 mm/s, up in the fingers
    assert not all(finding.passed for finding in ask(CheckForces(), replace(recording, body_q=poses)))


def test_below_the_limit_it_stays_on_the_ground(tmp_path: Path) -> None:
    """A sixth below m g / 2 F, which does not even carry it."""
    recording = gripped(tmp_path, MASS * GRAVITY / HOLDS / 1.16)
    assert np.abs(height(recording)) < 1e-3


def test_the_example_and_its_plan_say_the_same() -> None:
    """What its plan's program and the example itself let the arm do, and where the cube is."""
    folder = Path(__file__).parents[2] / "examples"
    texts = (
        (folder / "robots" / "pick_and_place.py").read_text(),
        compose(load(folder / "plans" / "pick_and_place.json")),
    )
    worlds = []
    for text in texts:
        space: dict[str, Any] = {"__name__": "example"}
        exec(compile(text, "program.py", "exec"), space)  # both are the project's own
        scene = Scene()
        space["build"](scene)
        worlds.append(describe(scene.stage))
    one, two = worlds
    assert [(r.times, r.positions, r.start) for r in one.reaches] == [
        (r.times, r.positions, r.start) for r in two.reaches
    ]
    assert [(s.prim, s.times, s.positions) for s in one.schedules] == [
        (s.prim, s.times, s.positions) for s in two.schedules
    ]
    assert one.body("/World/cube").mass == pytest.approx(two.body("/World/cube").mass)
