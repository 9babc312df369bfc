"""How long a run is to be, for bodies that friction brings to rest: v = v0 - mu g t, in closed form."""

import math

import numpy as np
import pytest

from tests.judge.theory import box, record, times
from wsim.judge.evidence.evidence import Evidence
from wsim.judge.evidence.final_window import final_window
from wsim.judge.repair.lasting import settled
from wsim.judge.verdict import Finding

FRICTION, G, RATE = 0.05, 9.81, 30.0


@pytest.mark.parametrize("start", [2.0, 5.0])
def test_what_stands_at_the_end_needs_a_run_whose_last_window_begins_there(start: float) -> None:
    """5 m/s on ice stands after 10.2 s: of 11.2 s the last 2.8 are asked, of 13.6 the last 3.4."""
    stops = start / (FRICTION * G)
    t = times(1.1 * stops, RATE)
    speed = np.maximum(start - FRICTION * G * t, 0.0)
    way = np.where(t < stops, start * t - 0.5 * FRICTION * G * t**2, 0.5 * start * stops)
    moved = [np.stack([x, 0.0 * t, 0.0 * t], axis=1) for x in (way, speed)]
    evidence = Evidence(record([box()], *moved, t))
    target = settled(Finding(check="", passed=False, message="", prim="/World/box", value=0.8, limit=0.012), evidence)
    assert (target.parameter, target.direction) == ("duration", "raise")
    assert target.suggested is not None
    assert stops <= target.suggested - final_window(target.suggested) <= 1.1 * stops
    assert math.isclose(target.suggested * RATE, round(target.suggested * RATE))
