"""Speeds under what is solid: what hangs there may fall as far as it gets, and no faster."""

import math

import numpy as np
import pytest

from tests.judge.theory import G, ask, ball, edited, only, record, slab, times
from wsim.judge.checks.physics import CheckExplosion


def swung():
    """A ball under a beam, on a spring that swings by m g / k: z = -m g / k (1 - cos w t)."""
    t, rate = times(2.0), math.sqrt(10.0)
    reach = G / rate**2
    zero = np.zeros_like(t)
    place = np.stack([zero, zero, reach * (np.cos(rate * t) - 1.0)], axis=1)
    speed = np.stack([zero, zero, -reach * rate * np.sin(rate * t)], axis=1)
    return record([ball()], place, speed, t, statics=[slab("beam", (1.0, 1.0, 0.1), (0.0, 0.0, 2.0))])


def test_what_hangs_under_all_that_is_solid_may_swing():
    finding = only(ask(CheckExplosion(), swung()))
    assert finding.passed
    fall = 2.0 * G / 10.0 + 0.2  # of its top, to where its lowest point gets
    assert finding.limit == pytest.approx(2.0 * math.sqrt(2.0 * G * fall), rel=1e-2)


@pytest.mark.parametrize("speed", [20.0, -100.0])
def test_what_hangs_under_all_that_is_solid_may_not_explode(speed):
    """Thrown up, or down faster than any fall as deep, from the middle of the run on."""
    recording, late = swung(), slice(30, None)
    way = speed * (recording.time[late] - recording.time[30])
    thrown = edited(edited(recording, "body_qd", (late, 0, 2), speed), "body_q", (late, 0, 2), way)
    assert not only(ask(CheckExplosion(), thrown)).passed


@pytest.mark.parametrize(("share", "passes"), [(2.0 / 7.0, True), (3.0, False)])
def test_what_spins_may_run_off_by_its_rim(share, passes):
    """Set down with a spin alone a ball comes to roll at 2/7 of the speed of its rim."""
    still = ball()
    rim = 30.0 * still.shapes[0].size[0]
    t = times(0.5)
    speed = np.zeros((len(t), 3))
    speed[5:, 0] = share * rim
    way = np.zeros((len(t), 3))
    way[1:] = np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(t)[:, None], axis=0)
    spinning = still.model_copy(update={"angular_velocity": (0.0, 30.0, 0.0)})
    found = only(ask(CheckExplosion(), record([spinning], np.array(still.position) + way, speed, t)))
    assert found.passed == passes
