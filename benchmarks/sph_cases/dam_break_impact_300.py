"""A column of water 0.6 m long and 0.3 m high hits a wall 1.01 m off: Lobovsky et al. (2014).

Peaks at 3, 15, 30 and 80 mm over the floor: the median and the 2.5 % and 97.5 % quantiles of 100 runs, their Table 2,
in mbar. The error of a peak is in spreads: 1 is the quantile to that side. The pressure here is a 5 ms mean, and the
quantiles are of raw records of 20 kHz; the one record that is public, the fifth run (their Fig. 18), keeps 0.876,
0.976, 0.987 and 0.972 of its peaks in the same mean, and so the quantiles are multiplied by that. The peak at 80 mm is
the second wave's, a second after the release.

Impulses are from the release to 0.7 s, against that run's: 864, 768, 682 and 314 Pa s. At the height of the second, but
off the middle, it had 667 for 768, which is 13 %: reach is 15 %.

The front is against their Fig. 12. In the fifth run it is at the wall at 0.427 s, and 100 runs scatter by 0.07
sqrt(H / g).
"""

from __future__ import annotations

import numpy as np

from benchmarks.sph_cases import dam_break_impact as impact
from benchmarks.sph_cases.case import Case, Measured, Value

HEIGHT, SECONDS = 0.3, 1.2
# Median and quantiles [mbar], what a 5 ms mean leaves of a peak, and the last time that counts as its impact [s].
PEAKS = {
    "P1": (91.44, 75.06, 130.98, 0.876, 0.7),
    "P2": (57.49, 53.26, 63.31, 0.976, 0.7),
    "P3": (43.76, 39.79, 49.62, 0.987, 0.7),
    "P4": (30.15, 24.18, 36.32, 0.972, 1.2),
}
IMPULSES = {"P1": 864.0, "P2": 768.0, "P3": 682.0, "P4": 314.0}  # [Pa s]
IMPULSE_UNTIL = 0.7  # [s]
# The fifth run's P2 after the 5 ms: time [s], pressure [Pa].
RECORD = np.array(
    [
        (0.42, 10), (0.43, 710), (0.44, 4990), (0.456, 5590), (0.48, 4350), (0.50, 3570), (0.52, 2800), (0.55, 2220),
        (0.60, 2090), (0.65, 2060), (0.70, 1900), (0.80, 1940), (0.90, 1980), (1.00, 2120), (1.10, 2730),
    ]
)  # fmt: skip
ARRIVAL, SCATTER = 427.0, 12.0  # [ms]
FRONT = np.array(
    [
        (0.5142, 0.4210), (0.7050, 0.5834), (0.9337, 0.8267), (1.1242, 1.0732), (1.3150, 1.3233),
        (1.5055, 1.6034), (1.6963, 1.8795), (1.9250, 2.2364), (2.1158, 2.5602), (2.3063, 2.8855), (2.4206, 3.0780),
    ]
)  # fmt: skip


def run(device: str, spacing: float, seconds: float = SECONDS) -> Measured:
    """Let go the column."""
    found = impact.release(device, spacing, HEIGHT, seconds)
    values = {}
    for name, (median, low, high, kept, until) in PEAKS.items():
        peak = impact.impact_of(found.t, found.smooth[name], until).peak
        values[f"{name} peak"] = Value(peak, 100.0 * kept * median, 100.0 * kept * low, 100.0 * kept * high, "Pa")
    for name, expected in IMPULSES.items():
        of_run = impact.impulse_of(found.t, found.raw[name], IMPULSE_UNTIL)
        values[f"{name} impulse"] = Value.within(of_run, expected, CASE.reach[f"{name} impulse"], "Pa s")
    values["arrival"] = Value(1e3 * found.arrival, ARRIVAL, ARRIVAL - SCATTER, ARRIVAL + SCATTER, "ms")
    errors = {key: value.percent if key.endswith("impulse") else value.spreads for key, value in values.items()}
    errors["front"] = impact.front_error(found, HEIGHT, FRONT)
    return Measured(
        errors=errors,
        figures=impact.figures(found, IMPULSE_UNTIL),
        curves={
            "reference: experiment, fifth run": (RECORD[:, 0], RECORD[:, 1]),
            f"dp = {1e3 * spacing:g} mm": (found.t, found.smooth["P2"]),
        },
        values=values,
        particles=found.particles,
        simulated_seconds=seconds,
        wall_seconds=found.wall_seconds,
    )


CASE = Case(
    name="dam_break_impact_300",
    title="Dam break on a wall, H = 0.3 m: 15 mm over the floor",
    reference="Lobovsky et al. (2014)",
    reach=dict.fromkeys((f"{name} peak" for name in PEAKS), 1.0)
    | dict.fromkeys((f"{name} impulse" for name in IMPULSES), 15.0)
    | {"arrival": 1.0, "front": 5.0},
    unit=dict.fromkeys((f"{name} peak" for name in PEAKS), "spreads")
    | dict.fromkeys((f"{name} impulse" for name in IMPULSES), "%")
    | {"arrival": "spreads", "front": "%"},
    coarse=(0.01, 0.005),
    fine=(0.01, 0.005),
    run=run,
    axes=("time [s]", "pressure [Pa]"),
)
