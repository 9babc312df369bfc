"""What limits the step of a world."""

import math
from pathlib import Path

import pytest

from wsim.scene import Scene
from wsim.scene.describe import describe
from wsim.sim.time_step import SHARE_OF_SIZE, choose_time_step

G, THIN = 9.81, 0.004


@pytest.mark.parametrize(("led", "loose"), [(True, False), (False, False), (True, True)])
def test_what_is_led_does_not_fall(tmp_path: Path, led: bool, loose: bool) -> None:
    """A thin plate at 2 m that falls needs small steps, one that is led none, whatever lies on the ground."""
    scene = Scene()
    scene.ground()
    scene.box("plate", size=(0.2, 0.2, THIN), position=(0.0, 0.0, 2.0), kinematic=led)
    if loose:
        scene.box("block", size=(0.1, 0.1, 0.1), position=(1.0, 0.0, 0.05))
    world = describe(scene.save(tmp_path / "stage.usda"))
    limit = SHARE_OF_SIZE * THIN / math.sqrt(2.0 * G * (0.05 if led else 2.0))
    step = choose_time_step(world, None)
    assert step.dt == pytest.approx(1.0 / 800.0 if led and not loose else limit, rel=0.05)
