"""How well the ideal dam break is solved, its table, and how far it is from the experiments.

python -m benchmarks.dam_break_ideal
"""

from __future__ import annotations

import math

import numpy as np
from scipy.interpolate import CubicSpline

from benchmarks.sph_cases import dam_break_koshizuka as koshizuka
from benchmarks.sph_cases import dam_break_martin_moyce as martin_moyce
from benchmarks.sph_cases.dam_break import G
from benchmarks.sph_cases.dam_break_potential import HEIGHT, SPACINGS, STORED, front, release_errors, solve


def compare(name: str, times: np.ndarray, fronts: np.ndarray) -> None:
    """Say how far the table is from an experiment, with times [sqrt(a / g)] and fronts [a]."""

    def percent(delay: float) -> np.ndarray:
        return 100.0 * (front(np.maximum(times - delay, 0.0)) / fronts - 1.0)

    late = min(np.linspace(0.0, 1.0, 1001), key=lambda delay: float(np.abs(percent(delay)).mean()))
    off, rest = percent(0.0), float(np.abs(percent(late)).mean())
    print(f"{name}: mean |error| {np.abs(off).mean():.2f} %, of {off.min():+.2f} to {off.max():+.2f} %")
    print(f"    mean |error| {rest:.2f} % if the experiment was let go {late:.3f} sqrt(a / g) later")


def main() -> None:
    """Print the checks, the table, and how far the table that is stored is from the experiments."""
    fronts, root = np.full(len(STORED), np.nan), math.sqrt(2.0)
    for largest in SPACINGS:
        coarser, (side, top) = fronts, release_errors(largest)
        t, x, v, volume, energy = solve(largest, STORED[-1] / root).T
        fronts = CubicSpline(root * t, x, extrapolate=False)(STORED)  # not a number past the run's end
        print(f"spacing {largest:g} a: {len(t) - 1} steps to T = {root * t[-1]:.3f}, greatest speed {v.max():.3f}")
        print(f"    acceleration at release off by {side:.1e} g on the side, by {top:.1e} g on top at the wall")
        print(f"    drift of volume {0.5 * np.ptp(volume):.1e}, of energy {0.5 * np.ptp(energy):.1e}")
        if np.isfinite(coarser).any():
            print(f"    front within {100.0 * np.abs(fronts / coarser - 1.0).max():.2f} % of the coarser spacing's")
    print(f"Ritter's (1892) front of an endless reservoir so high: {2.0 * math.sqrt(HEIGHT):.3f} sqrt(a g)")
    print("  ".join(f"{scaled:.2f} {x:.4f}" for scaled, x in zip(STORED, fronts, strict=True)))
    compare("Koshizuka & Oka", koshizuka.TIMES * math.sqrt(G), koshizuka.FRONTS)
    a = martin_moyce.WIDTH
    compare("Martin & Moyce", martin_moyce.TIMES * math.sqrt(G / a), martin_moyce.FRONTS / a)


if __name__ == "__main__":
    main()
