"""The sweep of examples/wood_afloat.py against Archimedes: which blocks touch the bottom, and how high the others end.

    .venv/bin/wsim sweep examples/wood_afloat.py --plan examples/plans/wood_afloat.json --no-full \
        --samples 32 --vary density=250:1000 --vary level=0.04:0.12
    .venv/bin/python benchmarks/wood_plot.py runs/<time>-sweep-a-wooden-block-and-the-bottom-of/table.csv

A block of r times water's density, h high and of cross-section a², in a tank of cross-section A that was filled to a
level before it came, has level - r h (1 - a²/A) under it, and stands on the bottom where that is negative. Particles
know of the water under it only while some of it is there: where the kernels of the block's particles and of the floor's
overlap, closer than their support of 2.6 spacings, the lift is short. Printed is how high over the bottom, by theory,
the last blocks are that stand on it, and the first that do not.
"""

from __future__ import annotations

import argparse
import csv
import runpy
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from wsim.solvers.sph_config import ConfigSPH

PROGRAM = Path(__file__).parents[1] / "examples" / "wood_afloat.py"
BLOCK = runpy.run_path(str(PROGRAM))
SUNK = BLOCK["HEIGHT"] * (1.0 - BLOCK["SHARE"]) / 1000.0  # how far under the level a block is, for its density [m^4/kg]
COLORS = {True: ("#2a9d5c", "floats"), False: ("#c8443c", "stands on the bottom")}


@dataclass(frozen=True)
class Blocks:
    """Those that were judged: density [kg/m^3], level [m], gap under each as simulated [m], whether it floats."""

    density: np.ndarray
    level: np.ndarray
    gap: np.ndarray
    floats: np.ndarray

    @property
    def theory(self) -> np.ndarray:
        """The gap by Archimedes; negative where a block stands [m]."""
        return self.level - self.density * SUNK


def read(table: Path) -> Blocks:
    """What a sweep's table.csv says of candidates with a density and a level."""
    with table.open(newline="", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["density"] and row["status"] in ("accepted", "rejected")]
    value, margin = (next(name for name in rows[0] if name.startswith(start)) for start in ("value: ", "margin: "))
    rows = [row for row in rows if row[value]]
    numbers = np.array([[float(row[name]) for name in ("density", "level", value, margin)] for row in rows])
    density, level, gap, over = numbers.T
    return Blocks(density, level, gap, over > 0.0)  # a block may float and be rejected: the plan has one density


def say(blocks: Blocks, spacing: float) -> None:
    """Where the boundary is, and how far off it is, in spacings."""
    floats, theory = blocks.floats, blocks.theory / spacing
    wrong = floats != (theory > 0.0)
    print(f"{len(theory)} candidates, {floats.sum()} float; {wrong.sum()} are not on theory's side of the line")
    print(f"the highest by theory that stands on the bottom: {theory[~floats].max():.2f} spacings over it")
    print(f"the lowest by theory that floats: {theory[floats].min():.2f} spacings over it")
    off = blocks.gap[floats] / spacing - theory[floats]
    print(
        f"those that float end {off.mean():+.2f} spacings off theory in the mean, {off.min():+.2f} to {off.max():+.2f}"
    )
    print(f"support of the kernel: {support(spacing) / spacing:.1f} spacings")


def support(spacing: float) -> float:
    """The kernel's [m]."""
    return ConfigSPH(spacing=spacing, speed_of_sound=1.0).support


def draw(blocks: Blocks, spacing: float, path: Path) -> None:
    """Density and level of each, with theory's line; and the gaps under them, over those of theory."""
    figure = Figure((8.0, 3.4), dpi=100, layout="constrained")
    plane, gaps = figure.subplots(1, 2)
    level = np.linspace(blocks.level.min(), blocks.level.max(), 50)
    plane.plot(level * 1e3, level / SUNK, color="#222", label="theory")
    near = np.maximum(level - support(spacing), 0.0)
    plane.fill_between(level * 1e3, near / SUNK, level / SUNK, color="#ddd", label="within the kernel's support")
    for floats, (color, label) in COLORS.items():
        these, look = blocks.floats == floats, {"s": 14 if len(level) > len(blocks.level) else 4, "linewidths": 0}
        plane.scatter(blocks.level[these] * 1e3, blocks.density[these], color=color, label=label, zorder=3, **look)
        gaps.scatter(blocks.theory[these] / spacing, blocks.gap[these] / spacing, color=color, zorder=3, **look)
    plane.set(xlabel="level of the water before the block [mm]", ylabel="density [kg/m³]", ylim=(240, 1010))
    plane.legend(fontsize=7, loc="upper left", markerscale=2.0)
    low, high = blocks.theory.min() / spacing, blocks.theory.max() / spacing
    gaps.plot([low, 0.0, high], [0.0, 0.0, high], color="#222", linewidth=0.8)
    gaps.axvspan(0.0, support(spacing) / spacing, color="#ddd")
    gaps.set(xlabel="gap under the block, theory [spacings]", ylabel="simulated [spacings]")
    figure.savefig(path)


def main() -> None:
    """Print where the boundary is, and draw it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("table", type=Path, help="table.csv of the sweep")
    parser.add_argument("--spacing", type=float, default=0.02, help="of its particles [m]")
    parser.add_argument("--output", type=Path, default=Path("wood.png"))
    given = parser.parse_args()
    blocks = read(given.table)
    say(blocks, given.spacing)
    draw(blocks, given.spacing, given.output)
    print(given.output)


if __name__ == "__main__":
    main()
