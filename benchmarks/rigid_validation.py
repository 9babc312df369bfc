"""Hold rigid bodies against motions whose answer is known.

    python benchmarks/rigid_validation.py --device cpu --write
    python benchmarks/rigid_validation.py --device cuda:0 --write --plot
    python benchmarks/rigid_validation.py --cases slide_to_stop cradle

Every case of `benchmarks/rigid_cases` builds its world with `wsim.scene.Scene` and runs it with `wsim.sim.Simulation`.
The table has a row for each. `--write` puts it into docs/rigid.md, in the column of the device; the other column stays.
What misses its reach is said to, and does not fail the command; a case that raises does (exit code 1).
"""

from __future__ import annotations

import argparse
import importlib
import pkgutil
import re
import sys
import time
import traceback
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT)] if str(ROOT) not in sys.path else []

from benchmarks.rigid_cases.case import Bench, Case, Curve  # noqa: E402
from wsim.sim.devices import known_device  # noqa: E402

FOLDER = "benchmarks.rigid_cases"
DOCUMENT = ROOT / "docs/rigid.md"
PICTURES = ROOT / "docs/images"
MARKS = re.compile(r"(?<=<!-- rigid:begin -->\n).*?(?=<!-- rigid:end -->)", re.DOTALL)
SHEETS = re.compile(r"(?<=<!-- pictures:begin -->\n).*?(?=<!-- pictures:end -->)", re.DOTALL)
HEADER = ("case", "what is known", "expected", "CPU", "CUDA", "reach", "step [ms]")


@dataclass
class Run:
    """A case on a device: what it measured, or why it failed."""

    case: Case
    value: float = float("nan")
    expected: float = float("nan")
    step: float = 0.0  # [s]
    seconds: float = 0.0
    failure: str = ""
    curve: Curve | None = None

    @property
    def reached(self) -> bool:
        """Whether the value is near enough."""
        return not self.failure and self.case.reached(self.value, self.expected)

    def cell(self) -> str:
        """The value for a table, bold where it misses."""
        if self.failure:
            return "**failed**"
        text = number(self.value, self.case.bound(self.expected))
        return text if self.reached else f"**{text}**"


def find_cases(wanted: list[str] | None = None) -> list[Case]:
    """All cases, family by family, or those that are wanted.

    Raises:
        SystemExit: If a name is not a case's.
    """
    package = importlib.import_module(FOLDER)
    cases: dict[str, Case] = {}
    for found in pkgutil.iter_modules(package.__path__):
        for thing in vars(importlib.import_module(f"{FOLDER}.{found.name}")).values():
            cases |= {each.name: each for each in (thing if isinstance(thing, tuple) else (thing,))
                      if isinstance(each, Case)}  # fmt: skip
    for name in wanted or ():
        if name not in cases:
            raise SystemExit(f"rigid_validation: --cases {name} is none of {', '.join(cases)}")
    return [cases[name] for name in wanted] if wanted else list(cases.values())


def run_case(case: Case, device: str, worlds: int) -> Run:
    """Run one case; what it raises becomes its result."""
    run, bench, started = Run(case), Bench(device, worlds), time.perf_counter()
    try:
        run.value, run.expected = case.run(bench)
    except Exception as problem:  # noqa: BLE001 - the other cases still run; it is reported and sets the exit code
        traceback.print_exc()
        run.failure = f"{type(problem).__name__}: {problem}".replace("\n", " ")
    run.step, run.seconds, run.curve = bench.step, time.perf_counter() - started, bench.curve
    return run


def number(value: float, scale: float) -> str:
    """A number with as many digits as a bound on its error gives a meaning."""
    if abs(value) < 1e-3 * max(scale, 1e-12):
        return "0"
    return f"{value:.4g}" if abs(value) >= scale else f"{value:.2g}"


def with_unit(text: str, unit: str) -> str:
    """A number and its unit."""
    return f"{text} {unit}".rstrip()


def reach_of(run: Run) -> str:
    """The reach as the table has it: of the expected value, or in the unit."""
    case = run.case
    if case.reach == 0.0:
        return "exact"
    return f"{100 * case.reach:g} %" if run.expected else with_unit(f"{case.reach:g}", case.unit)


def kept_cells(text: str) -> dict[str, list[str]]:
    """The rows of the table that a document has, by case."""
    rows = (line.strip("| ").split(" | ") for line in text.splitlines() if line.startswith("| `"))
    return {row[0].strip("`"): row for row in rows if len(row) == len(HEADER)}


def table(runs: list[Run], device: str, kept: dict[str, list[str]]) -> str:
    """The document's table; what was not run, and the other device's column, as it was."""
    done, lines = {run.case.name: run for run in runs}, [HEADER, ("---",) * len(HEADER)]
    column = HEADER.index("CUDA" if device.startswith("cuda") else "CPU")
    for case in find_cases():
        old = kept.get(case.name)
        if case.name not in done:
            lines += [tuple(old)] if old else []
            continue
        run = done[case.name]
        expected = with_unit(number(run.expected, case.bound(run.expected)), case.unit)
        row = [f"`{case.name}`", case.says, expected, "", "", reach_of(run), f"{1e3 * run.step:.3g}"]
        row[3:5] = old[3:5] if old else ["–", "–"]
        row[column] = run.cell()
        lines.append(tuple(row))
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def print_row(run: Run) -> None:
    """One line to read while the rest runs."""
    if run.failure:
        print(f"{run.case.name:28} failed: {run.failure}", flush=True)
        return
    ratio = f"{run.value / run.expected:.5f}" if run.expected else ""
    found = f"{run.value:12.6g} of {run.expected:10.5g} {run.case.unit:8} {ratio:9} reach {reach_of(run):12}"
    result = "reached" if run.reached else "MISSED"
    print(f"{run.case.name:28} {found} {1e3 * run.step:5.3g} ms {result:8} {run.seconds:4.1f} s", flush=True)


def plot(runs: list[Run], device: str, folder: Path) -> None:
    """A picture of each case, on sheets; those of the document are shown in it."""
    from benchmarks.rigid_plot import draw  # loads matplotlib, of the extra dev, which --plot alone needs

    paths = draw([run for run in runs if not run.failure], folder, device)
    for path in paths:
        print(f"{path}: {path.stat().st_size // 1000} kB")
    if folder == PICTURES:
        links = [f"![Measured over known, sheet {k}](images/{path.name})\n" for k, path in enumerate(paths, 1)]
        rewrite(SHEETS, "\n".join(links))


def rewrite(marks: re.Pattern[str], new: str) -> None:
    """Put text between its marks in the document, under a side name first."""
    side = DOCUMENT.with_name(DOCUMENT.name + ".part")
    side.write_text(marks.sub(lambda _: new, DOCUMENT.read_text(encoding="utf-8")), encoding="utf-8")
    side.replace(DOCUMENT)


def main(arguments: list[str] | None = None) -> int:
    """Run the cases, print the table; 1 if a case raised."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--device", default="auto", help="cpu, cuda:0, … or auto: CUDA if there is one")
    parser.add_argument(
        "--worlds", type=int, default=1, help="copies at once; two or more take the batched code on a CPU"
    )
    parser.add_argument("--cases", nargs="+", metavar="NAME", help="all, if left out")
    parser.add_argument("--write", action="store_true", help="put the table into docs/rigid.md")
    parser.add_argument("--plot", nargs="?", const=PICTURES, type=Path, metavar="FOLDER",
                        help="draw a picture of each case, on sheets in docs/images; needs matplotlib")  # fmt: skip
    args = parser.parse_args(arguments)
    device, runs = known_device(args.device), []
    for case in find_cases(args.cases):
        runs.append(run_case(case, device, args.worlds))
        print_row(runs[-1])
    missed = [run.case.name for run in runs if not run.reached]
    total = sum(run.seconds for run in runs)
    print(
        f"{len(runs) - len(missed)} of {len(runs)} within reach on {device}, {total:.0f} s; missed: {missed or 'none'}"
    )
    if args.write:
        rewrite(MARKS, table(runs, device, kept_cells(DOCUMENT.read_text(encoding="utf-8"))))
    if args.plot:
        plot(runs, device, args.plot)
    return 1 if any(run.failure for run in runs) else 0


if __name__ == "__main__":
    sys.exit(main())
