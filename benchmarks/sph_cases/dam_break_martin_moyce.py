"""A column of water 2.25 in wide and twice as high breaks loose.

Martin & Moyce (1952, Phil. Trans. R. Soc. A 244, 312-324), a = 2.25 in, n^2 = 2: the front Z = x / a on the dry floor
against the time T = t sqrt(n^2 g / a). The error is the mean of |Z - Z_measured| / Z_measured over the five points;
`ideal` is the same against potential flow. The tank is 15.5 a long.
"""

from __future__ import annotations

import math

import numpy as np

from benchmarks.sph_cases.case import Case, Measured
from benchmarks.sph_cases.dam_break import G, release

WIDTH = 2.25 * 0.0254
TIMES = np.array([0.832, 1.997, 3.345, 5.091, 9.237]) / math.sqrt(2.0 * G / WIDTH)
FRONTS = np.array([1.217, 2.292, 4.134, 6.980, 13.97]) * WIDTH


def run(device: str, spacing: float) -> Measured:
    """Let go the column."""
    return release(device, spacing, WIDTH, 2.0 * WIDTH, (15.5 * WIDTH, 2.5 * WIDTH), TIMES, FRONTS)


CASE = Case(
    name="dam_break_martin_moyce",
    title="Dam break, a = 2.25 in, n^2 = 2",
    reference="Martin & Moyce (1952)",
    reach={"front": 5.0, "ideal": 5.0},
    unit={"front": "%", "ideal": "%"},
    coarse=(WIDTH / 16, WIDTH / 32),
    fine=(WIDTH / 64, WIDTH / 128),
    run=run,
    axes=("time [s]", "front [m]"),
)
