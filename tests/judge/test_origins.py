"""Where a world stands says nothing of its motion: at the origin, through it, and a kilometre off."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from wsim.judge.decide import judge
from wsim.recording import read
from wsim.recording.recording import Recording
from wsim.scene import Scene
from wsim.sim import Simulation

Build = Callable[[Scene], object]


def recorded(folder: Path, build: Build) -> Recording:
    scene = Scene()
    build(scene)
    Simulation(scene.save(folder / "stage.usda"), device="cpu").run(folder / "r.rrd")
    return read(folder / "r.rrd")


def failed(recording: Recording) -> list[str]:
    return [finding.check for finding in judge(recording).findings if not finding.passed]


@pytest.mark.parametrize("start", [-0.5, -1.0, 0.0])
def test_a_ball_flies_through_the_origin_where_nothing_pulls(tmp_path: Path, start: float) -> None:
    """A place of 0 has no rounding of its own: that of the one before, and of the velocity, is what there is."""

    def build(scene: Scene) -> None:
        scene.simulation(duration=0.5, gravity=(0.0, 0.0, 0.0), frame_rate=60)
        scene.sphere("ball", radius=0.1, position=(start, 0.0, 0.0), velocity=(2.0, 0.0, 0.0), density=500.0)

    assert failed(recorded(tmp_path, build)) == []


@pytest.mark.parametrize("origin", [(0.0, 0.0), (1000.0, 500.0), (1000.0, 1000.0), (-700.0, 1000.0)])
def test_a_ball_hits_a_box_a_kilometre_off(tmp_path: Path, origin: tuple[float, float]) -> None:
    """What they give each other is theirs: squares of a kilometre in single precision hid that they meet."""
    x, y = origin

    def build(scene: Scene) -> None:
        scene.simulation(duration=0.5, frame_rate=60)
        scene.ground(friction=0.5)
        scene.box("crate", size=(0.2,) * 3, position=(x, y, 0.1), density=500.0, restitution=0.3)
        scene.sphere(
            "ball", radius=0.08, position=(x - 1.0, y + 0.03, 0.12), velocity=(4.0, 0.0, 0.0), density=2000.0,
            restitution=0.3,
        )  # fmt: skip

    assert failed(recorded(tmp_path, build)) == []


@pytest.mark.parametrize(("x", "speed"), [(0.0, 2.5e-5), (1.0, 2.5e-5), (3.0, 6e-5)])
def test_what_creeps_is_found_as_far_off_as_single_precision_tells(tmp_path: Path, x: float, speed: float) -> None:
    """A box at rest, moved by 0.025 mm/s; three metres off a rounding a frame is half of that."""

    def build(scene: Scene) -> None:
        scene.simulation(duration=1.0, frame_rate=60)
        scene.ground(friction=0.5)
        scene.box("crate", size=(0.2,) * 3, position=(x, 0.0, 0.1), density=500.0)

    sound = recorded(tmp_path, build)
    assert failed(sound) == []
    q, qd = sound.body_q.copy(), sound.body_qd.copy()
    q[:, 0, 0] += (speed * sound.time).astype(np.float32)
    qd[:, 0, 0] += speed
    assert "CheckForces" in failed(replace(sound, body_q=q, body_qd=qd))


def test_what_rests_under_no_force_at_all_is_carried_by_nothing(tmp_path: Path) -> None:
    def build(scene: Scene) -> None:
        scene.simulation(duration=0.5, frame_rate=60)
        scene.ground(friction=0.5)
        for k in range(2):
            scene.box(f"crate_{k}", size=(0.2,) * 3, position=(k, 0.0, 0.1), density=500.0)

    sound = recorded(tmp_path, build)
    assert failed(sound) == []
    for rows in ([0], [0, 1]):
        force = sound.contact_force.copy()
        force[:, rows] = 0.0
        assert set(failed(replace(sound, contact_force=force))) == {"CheckRestForce"}
