"""A column of water 0.6 m long and 0.6 m high hits a wall 1.01 m off: Lobovsky et al. (2014).

Of this height the front is public (their Fig. 12), which is at the wall at t sqrt(g / H) = 1.59, and of the pressures
the median impulse at 3 mm over the floor, 12.74 mbar s between the halves of its peak (their section 5.2.3): the most
that a fixed time can be compared with is its order. Pressures are so among the figures. The arrival may scatter by 0.07
sqrt(H / g), as at 0.3 m.
"""

from __future__ import annotations

import math

import numpy as np

from benchmarks.sph_cases import dam_break_impact as impact
from benchmarks.sph_cases.case import Case, Measured, Value

HEIGHT, SECONDS = 0.6, 0.8
ARRIVAL, SCATTER = 393.0, 17.0  # [ms]
FRONT = np.array(
    [
        (0.2827, 0.2218), (0.4309, 0.3416), (0.5791, 0.4641), (0.7276, 0.6052), (0.8758, 0.7582),
        (1.0240, 0.9201), (1.1455, 1.0721), (1.2396, 1.1951), (1.3341, 1.3217), (1.4419, 1.4691), (1.5633, 1.6377),
    ]
)  # fmt: skip


def run(device: str, spacing: float, seconds: float = SECONDS) -> Measured:
    """Let go the column."""
    found = impact.release(device, spacing, HEIGHT, seconds)
    arrival = Value(1e3 * found.arrival, ARRIVAL, ARRIVAL - SCATTER, ARRIVAL + SCATTER, "ms")
    return Measured(
        errors={"arrival": arrival.spreads, "front": impact.front_error(found, HEIGHT, FRONT)},
        figures=impact.figures(found, seconds),
        curves={
            "reference: experiment": (FRONT[:, 0] * math.sqrt(HEIGHT / impact.G), impact.COLUMN + HEIGHT * FRONT[:, 1]),
            f"dp = {1e3 * spacing:g} mm": (found.front_t, found.front),
        },
        values={"arrival": arrival},
        particles=found.particles,
        simulated_seconds=seconds,
        wall_seconds=found.wall_seconds,
    )


CASE = Case(
    name="dam_break_impact_600",
    title="Dam break on a wall, H = 0.6 m",
    reference="Lobovsky et al. (2014)",
    reach={"arrival": 1.0, "front": 5.0},
    unit={"arrival": "spreads", "front": "%"},
    coarse=(0.02, 0.01),
    fine=(0.01, 0.005),
    run=run,
    axes=("time [s]", "front [m]"),
)
