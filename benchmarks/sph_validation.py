"""Hold the fluid solver against flows whose answer is known.

    python benchmarks/sph_validation.py --device auto
    python benchmarks/sph_validation.py --device cuda:0 --fine --json validation.json --plots plots --markdown table.md
    python benchmarks/sph_validation.py --cases standing_wave taylor_green

Every case of `benchmarks/sph_cases` runs at each of its spacings. The table has a row for each error that was measured,
with the reach that the case sets for it, and the order at which the error falls with the spacing. What misses its reach
is said to, and does not fail the command; a case that raises does (exit code 1).
"""

from __future__ import annotations

import argparse
import importlib
import importlib.util
import itertools
import json
import math
import pkgutil
import platform
import sys
import time
import traceback
from dataclasses import asdict, dataclass, field
from importlib.metadata import version
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT)] if str(ROOT) not in sys.path else []

import numpy as np  # noqa: E402
import warp as wp  # noqa: E402

from benchmarks.sph_cases.case import Case, Measured  # noqa: E402

FOLDER = "benchmarks.sph_cases"
HEADER = ("case", "spacing [mm]", "particles", "error", "measured", "reach", "order", "result", "seconds")


@dataclass
class Run:
    """One case at one spacing: what it measured, or why it failed."""

    case: Case
    spacing: float
    seconds: float = 0.0
    measured: Measured | None = None
    failure: str = ""
    order: dict[str, float] = field(default_factory=dict)
    """Of each error, from the next coarser spacing to this one; not a number where there is none."""


def find_cases(wanted: list[str] | None = None) -> list[Case]:
    """The cases of the folder by name, or those that are wanted, in their order.

    Raises:
        SystemExit: If a name is not a case's.
    """
    package = importlib.import_module(FOLDER)
    modules = (importlib.import_module(f"{FOLDER}.{found.name}") for found in pkgutil.iter_modules(package.__path__))
    cases = {module.CASE.name: module.CASE for module in modules if hasattr(module, "CASE")}
    for name in wanted or ():
        if name not in cases:
            raise SystemExit(f"sph_validation: --cases {name} is none of {', '.join(cases)}")
    return [cases[name] for name in wanted] if wanted else list(cases.values())


def run_case(case: Case, spacing: float, device: str) -> Run:
    """Run one case at one spacing; what it raises becomes its result."""
    run = Run(case, spacing)
    started = time.perf_counter()
    try:
        run.measured = case.run(device, spacing)
        if set(run.measured.errors) != set(case.reach):
            raise ValueError(f"measured {sorted(run.measured.errors)}, not {sorted(case.reach)}")
    except Exception as problem:  # noqa: BLE001 - the other cases still run; it is reported and sets the exit code
        traceback.print_exc()
        run.measured, run.failure = None, f"{type(problem).__name__}: {problem}".replace("\n", " ")
    run.seconds = time.perf_counter() - started
    return run


def find_orders(runs: list[Run]) -> None:
    """Note how fast each error falls between successive spacings of a case: e ~ spacing^order."""
    good = [run for run in runs if run.measured is not None]
    for coarser, finer in itertools.pairwise(good):
        for key, error in finer.measured.errors.items():
            before = abs(coarser.measured.errors[key])
            if before > 0.0 and abs(error) > 0.0:
                finer.order[key] = math.log(before / abs(error)) / math.log(coarser.spacing / finer.spacing)


def verdict(error: float, reach: float, unit: str) -> str:
    """Whether an error is within reach, and by how much it is not."""
    if not math.isfinite(error):
        return "MISSED: not finite"
    return "reached" if abs(error) <= reach else f"MISSED by {abs(error) - reach:.3g} {unit}"


def errors(run: Run) -> str:
    """What was measured in a run, in a line."""
    found = run.measured.errors.items() if run.measured else ()
    return ", ".join(f"{key} {abs(error):.3g} {run.case.unit[key]}" for key, error in found)


def print_values(run: Run) -> None:
    """A line for each number that has a reference: measured / reference / tolerance."""
    for key, value in (run.measured.values if run.measured else {}).items():
        print(f"    {key}: {value}", flush=True)


def table(runs: list[Run]) -> list[tuple[str, ...]]:
    """A row for each error of each run, and one for each run that failed."""
    rows = []
    for run in runs:
        spacing = f"{1e3 * run.spacing:.4g}"
        if run.measured is None:
            rows.append((run.case.name, spacing, "", "", "", "", "", f"failed: {run.failure}", f"{run.seconds:.1f}"))
            continue
        for key, error in run.measured.errors.items():
            unit, reach = run.case.unit[key], run.case.reach[key]
            order = f"{run.order[key]:+.1f}" if key in run.order else ""
            start = (run.case.name, spacing, f"{run.measured.particles}", key)
            value = run.measured.values.get(key)
            beside = f" ({value.measured:.4g} for {value.reference:.4g} {value.unit})" if value else ""
            numbers = (f"{abs(error):.3g} {unit}{beside}", f"{reach:g} {unit}", order)
            rows.append((*start, *numbers, verdict(error, reach, unit), f"{run.seconds:.1f}"))
    return rows


def print_table(rows: list[tuple[str, ...]]) -> None:
    """Columns as wide as what is in them; what failed says so at its end, unaligned."""
    fitting = [row for row in rows if not row[7].startswith("failed")]
    widths = [max(len(row[k]) for row in [HEADER, *fitting]) for k in range(len(HEADER))]
    for row in [HEADER, *rows]:
        print("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip())


def bold_misses(row: tuple[str, ...]) -> tuple[str, ...]:
    """A row for Markdown, where what misses its reach stands out."""
    return tuple(f"**{cell}**" if cell.startswith("MISSED") else cell for cell in row)


def describe(device: str) -> dict[str, str]:
    """What the numbers were measured with."""
    about = wp.get_device(device)
    versions = {name: version(name) for name in ("newton", "warp-lang", "mujoco", "mujoco-warp", "numpy")}
    return {
        "device": device,
        "device_name": about.name if about.is_cuda else platform.processor() or platform.machine(),
        "python": platform.python_version(),
        **versions,
    }


def as_json(runs: list[Run], device: str, fine: bool) -> dict[str, Any]:
    """All numbers; nothing in it changes from one run to the next but the seconds."""
    rows = []
    for run in runs:
        row: dict[str, Any] = {"case": run.case.name, "title": run.case.title, "reference": run.case.reference}
        row |= {"spacing": run.spacing, "seconds": run.seconds, "failure": run.failure or None}
        if run.measured is not None:
            units, reach = run.case.unit, run.case.reach
            row |= {k: v for k, v in asdict(run.measured).items() if k not in ("errors", "curves")}
            row["errors"] = {
                key: {
                    "value": error,
                    "unit": units[key],
                    "reach": reach[key],
                    "order": run.order.get(key),
                    "reached": bool(abs(error) <= reach[key]),
                }
                for key, error in run.measured.errors.items()
            }
            row["curves"] = {name: {"x": x, "y": y} for name, (x, y) in run.measured.curves.items()}
        rows.append(row)
    return {"made_with": describe(device), "spacings": "fine" if fine else "coarse", "seed": None, "runs": rows}


def plain(value: Any) -> Any:
    """Numpy's numbers and arrays as Python's, of six digits; what is not finite as text."""
    if isinstance(value, dict):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple, np.ndarray)):
        return [plain(item) for item in value]
    if isinstance(value, (float, np.floating)):
        return float(f"{value:.6g}") if math.isfinite(value) else str(float(value))
    return value.item() if isinstance(value, np.generic) else value


def write_plots(runs: list[Run], folder: Path) -> None:
    """One picture a case: the reference in black, a line for each spacing."""
    from matplotlib.figure import Figure  # of the extra dev, and --plots alone needs it

    folder.mkdir(parents=True, exist_ok=True)
    for name in dict.fromkeys(run.case.name for run in runs):
        here = [run for run in runs if run.case.name == name and run.measured is not None]
        if not here or not any(run.measured.curves for run in here):
            continue
        figure = Figure(figsize=(7.0, 4.5), dpi=100, layout="constrained")
        axes = figure.subplots()
        references = {k: v for run in here for k, v in run.measured.curves.items() if k.startswith("reference")}
        for run in here:
            for label, (x, y) in run.measured.curves.items():
                if not label.startswith("reference"):
                    axes.plot(x, y, label=label, linewidth=1.2)
        for style, (label, (x, y)) in zip("-:." * len(references), references.items(), strict=False):
            # An experiment has a few points, a closed form has a line.
            axes.plot(x, y, "ko" if len(x) < 30 else f"k{style}", label=label, linewidth=1.0, markersize=4)
        axes.set(title=f"{here[0].case.title}\n{here[0].case.reference}", xlabel=here[0].case.axes[0])
        axes.set_ylabel(here[0].case.axes[1])
        axes.grid(alpha=0.3)
        longest = max(map(len, axes.get_legend_handles_labels()[1]))
        columns = 2 if longest > 24 else 3
        figure.legend(loc="outside lower center", ncols=columns, fontsize="small", frameon=False)
        figure.savefig(folder / f"{name}.png")


def write_text(path: Path, text: str) -> None:
    """Write under a side name, then rename."""
    path.parent.mkdir(parents=True, exist_ok=True)
    side = path.with_name(path.name + ".part")
    side.write_text(text)
    side.replace(path)


def main(arguments: list[str] | None = None) -> int:
    """Run the cases, print the table; 1 if a case raised."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--device", default="auto", help="cpu, cuda:0, … or auto: CUDA if there is one")
    size = parser.add_mutually_exclusive_group()
    size.add_argument("--fine", action="store_true", default=None, help="fine spacings; the default on CUDA")
    size.add_argument("--coarse", dest="fine", action="store_false", help="coarse spacings; the default on a CPU")
    parser.add_argument("--cases", nargs="+", metavar="NAME", help="all, if left out")
    parser.add_argument("--json", type=Path, metavar="FILE")
    parser.add_argument("--plots", type=Path, metavar="FOLDER")
    parser.add_argument("--markdown", type=Path, metavar="FILE")
    args = parser.parse_args(arguments)
    if args.plots and not importlib.util.find_spec("matplotlib"):
        parser.error("--plots needs matplotlib: pip install 'wsim[dev]'")
    wp.config.log_level = wp.LOG_WARNING
    wp.init()
    device = args.device if args.device != "auto" else "cuda:0" if wp.is_cuda_available() else "cpu"
    fine = wp.get_device(device).is_cuda if args.fine is None else args.fine
    runs: list[Run] = []
    for case in find_cases(args.cases):
        of_case = []
        for spacing in case.fine if fine else case.coarse:
            print(f"{case.name} at {1e3 * spacing:.4g} mm on {device} … ", end="", flush=True)
            of_case.append(run_case(case, spacing, device))
            print(of_case[-1].failure or f"{of_case[-1].seconds:.1f} s: {errors(of_case[-1])}", flush=True)
            print_values(of_case[-1])
        find_orders(of_case)
        runs += of_case
    rows = table(runs)
    print()
    print_table(rows)
    if args.json:
        write_text(args.json, json.dumps(plain(as_json(runs, device, fine)), indent=1) + "\n")
    if args.markdown:
        lines = [" | ".join(row) for row in [HEADER, ("---",) * len(HEADER), *map(bold_misses, rows)]]
        write_text(args.markdown, "".join(f"| {line} |\n" for line in lines))
    if args.plots:
        write_plots(runs, args.plots)
    return 1 if any(run.failure for run in runs) else 0


if __name__ == "__main__":
    sys.exit(main())
