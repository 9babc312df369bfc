"""What blows show of a restitution, and how surely."""

import numpy as np
import pytest

from tests.judge.language.conftest import G, moving, shape, solid, still, times
from tests.judge.theory import bouncing, with_world
from wsim.judge.evidence.evidence import Evidence
from wsim.judge.language import Signals, evaluate, parse
from wsim.scene.world import World

WALL = shape("box", 0.1, 4.0, 20.0, position=(1.05, 0.0, 1.0))


@pytest.mark.parametrize("restitution", [0.5, 0.8])
@pytest.mark.parametrize(("speed", "step"), [(0.4, 0.0), (1.0, 1.0 / 240.0), (1.5, 1.0 / 120.0), (2.5, 1.0 / 120.0)])
def test_gravity_makes_no_blow_against_a_wall_unsure(speed, step, restitution):
    """A ball flies at a wall and falls along it: what gravity adds within a step is not along the normal."""
    time = times(0.8, 60.0)
    since = time - 0.305
    x = 0.9 + np.where(since < 0.0, speed, -restitution * speed) * since
    path = np.stack([x, 0.0 * x, 5.0 - G * time**2 / 2], axis=1)
    v = np.zeros((len(time), 1, 3))
    v[:, 0, 0], v[:, 0, 2] = np.where(since < 0.0, speed, -restitution * speed), -G * time
    world = World(time_step=step, bodies=[solid("ball", shape("sphere", 0.1))], statics=[still("wall", WALL)])
    signals = moving(world, time, path, v=v)
    for off, holds in ((-0.11, False), (0.0, True), (0.11, False)):
        asked = f"collides_with(ball, wall, restitution {restitution + off}, within 0.1)"
        assert evaluate(parse(asked), signals).satisfied[0] == holds


@pytest.mark.parametrize(("off", "holds"), [(-0.15, True), (0.15, True), (-0.25, False), (0.25, False)])
def test_slow_blows_alone_show_a_restitution_as_surely_as_they_are(off, holds):
    """Where none is clear, the surest is as far off as a step may have it, and at most twice `within`."""
    recording = bouncing(0.5, 1.0, 0.02, 60.0)
    signals = Signals.of(Evidence(with_world(recording, time_step=1.0 / 120.0)))
    asked = f"collides_with(ball, ground, restitution {0.5 + off}, within 0.1)"
    assert evaluate(parse(asked), signals).satisfied[0] == holds
