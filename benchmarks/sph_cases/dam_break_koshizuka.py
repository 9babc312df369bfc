"""A column of water 1 m wide and 2 m high breaks loose.

Koshizuka & Oka (1996, Nucl. Sci. Eng. 123, 421-434), with the numbers that DualSPHysics distributes, scaled to a column
1 m wide: the front on the dry floor [m] against time [s]. The error is the mean of |x - x_measured| / x_measured over
the fifteen points; `ideal` is the same against potential flow. The tank is 5 m long, so that the front does not meet
its far wall.
"""

from __future__ import annotations

import numpy as np

from benchmarks.sph_cases.case import Case, Measured
from benchmarks.sph_cases.dam_break import release

# Time [s] and front [m].
POINTS = """
0.0920 1.128   0.1907 1.244   0.2663 1.464   0.3221 1.695   0.3681 1.903   0.4140 2.123   0.4466 2.365   0.4958 2.584
0.5219 2.804   0.5646 3.034   0.5940 3.219   0.6366 3.462   0.6693 3.704   0.7021 3.900   0.7513 4.132
"""
TIMES, FRONTS = np.array(POINTS.split(), float).reshape(-1, 2).T


def run(device: str, spacing: float) -> Measured:
    """Let go the column."""
    return release(device, spacing, 1.0, 2.0, (5.0, 2.5), TIMES, FRONTS)


CASE = Case(
    name="dam_break_koshizuka",
    title="Dam break, 1 m x 2 m",
    reference="Koshizuka & Oka (1996)",
    reach={"front": 5.0, "ideal": 5.0},
    unit={"front": "%", "ideal": "%"},
    coarse=(0.05, 0.025),
    fine=(0.01, 0.005),
    run=run,
    axes=("time [s]", "front [m]"),
)
