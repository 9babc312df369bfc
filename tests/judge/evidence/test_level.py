"""The surface that particles show: one level, or one for each pool that a gate parts."""

import numpy as np
import pytest

from wsim.judge.checks.physics import CheckWaterLevel
from wsim.judge.evidence.containment import pools_of
from wsim.judge.evidence.evidence import Evidence
from wsim.scene.world import Shape, Static

INNER, WALL, SPACING, LEVEL = (0.66, 0.51, 0.45), 0.02, 0.03, 0.3


def parted(pool, high, low, gate=True):
    """The pool's water piled to two heights over its floor on the two sides of its middle, with its first volume."""
    case = pool()
    points = case.recording.fluids["/World/water"].position.copy()
    left = points[0, :, 0] < 0.0
    rise = (points[..., 2] - WALL) / (points[0, :, 2].max() - WALL + SPACING / 2)
    points[..., 2] = WALL + rise * np.where(left, high, low)
    statics = case.recording.world.statics
    plate = Shape(prim="/World/gate/g", kind="box", size=(0.02, INNER[1], 0.5), position=(0.0, 0.0, WALL + 0.25))
    gated = [*statics, Static(prim="/World/gate", shapes=[plate])]
    return case.water(position=points).world(statics=gated if gate else statics)


def level(case):
    (finding,) = CheckWaterLevel().run(Evidence(case.recording, case.plan))
    return finding


def test_pools_are_what_is_connected():
    dry = np.zeros((5, 3), dtype=bool)
    dry[2] = True
    assert pools_of(dry).max() == 1 and (pools_of(dry)[2] == -1).all()
    dry[2, 1] = False
    assert pools_of(dry).max() == 0


@pytest.mark.parametrize("step", [0.0, 0.06, 0.12])
def test_a_gate_holds_water_on_both_sides_at_its_own_height(pool, step):
    evidence = Evidence(pool().recording)
    mean = evidence.level(evidence.world.fluids[0]).height - WALL
    assert level(parted(pool, mean + step, mean - step)).passed
    # Both sides too high by 6 cm are more water than there is, gate or not.
    assert not level(parted(pool, mean + 0.06 + step, mean + 0.06 - step)).passed
