"""Where each second of `wsim generate` goes, with no kernel compiled yet and with all of them.

    .venv/bin/python benchmarks/first_minute.py
    .venv/bin/python benchmarks/first_minute.py --device cuda:0
    .venv/bin/python benchmarks/first_minute.py --device cpu --warm 1 --no-cold

Each run is a command of its own: the first with an empty folder for Warp's kernels, the others with the one that it
filled. Printed are the wall time of the whole command and its phases, as run.json and checks.json have them.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

PROMPT = "Three wooden blocks float on the water in a glass tank while a steel ball drops in and sinks."
SLOWEST = 8  # modules that are named
PATIENCE = 240.0  # [s] of a run


def generate(prompt: str, device: str, runs: Path, cache: Path | None) -> tuple[float, dict[str, Any], dict[str, Any]]:
    """Wall time of a command [s], its run.json and its checks.json."""
    command = [sys.executable, "-m", "wsim.cli", "generate", prompt, "--yes", "--device", device, "--runs", str(runs)]
    began = time.perf_counter()
    done = subprocess.run(
        command,
        env={**os.environ, **({"WARP_CACHE_PATH": str(cache)} if cache else {})},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=PATIENCE,
    )
    seconds = time.perf_counter() - began
    if done.returncode != 0:
        raise SystemExit(f"{' '.join(command)} ended with {done.returncode}:\n{done.stdout}")
    folder = next(runs.iterdir())
    facts = json.loads((folder / "run.json").read_text(encoding="utf-8"))
    checks = json.loads((folder / "iterations" / "01" / "checks.json").read_text(encoding="utf-8"))
    return seconds, facts, checks


def phases(whole: float, facts: dict[str, Any], checks: dict[str, Any]) -> dict[str, float]:
    """Seconds by phase, in their order; what no phase has is the rest."""
    of_run = dict(facts["phases"])
    of_run.pop("try")
    first = {name: of_run.pop(name) for name in ("start-up", "plan")}
    found = {**first, **checks["seconds"], **of_run}
    return {**found, "report and the rest": whole - sum(found.values())}


def main() -> None:
    """Run cold and warm, and print a table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--device", default="auto")
    parser.add_argument("--prompt", default=PROMPT)
    parser.add_argument("--warm", type=int, default=2, help="runs with all kernels compiled, after a first")
    parser.add_argument("--no-cold", action="store_true", help="use the kernels that this machine has compiled")
    given = parser.parse_args()
    columns: dict[str, dict[str, float]] = {}
    with tempfile.TemporaryDirectory() as folder:
        cache = None if given.no_cold else Path(folder) / "cache"
        names = [*([] if given.no_cold else ["cold"]), *(f"warm {k + 1}" for k in range(given.warm))]
        for name in names:
            whole, facts, checks = generate(given.prompt, given.device, Path(folder) / name, cache)
            columns[name] = {**phases(whole, facts, checks), "whole command": whole}
            print(f"{name}: {whole:.1f} s on {checks['simulation']['device']}, {facts['status']}", flush=True)
            compiled = checks["simulation"]["compiled"]
            for module in sorted(compiled, key=compiled.__getitem__, reverse=True)[:SLOWEST]:
                print(f"    compiling {module:70} {compiled[module]:7.2f} s")
            if compiled:
                print(f"    compiling {len(compiled)} modules, one after another: {sum(compiled.values()):.1f} s")
    rows = list(dict.fromkeys(name for column in columns.values() for name in column))
    print(f"\n{'seconds':24}" + "".join(f"{name:>10}" for name in columns))
    for row in rows:
        print(f"{row:24}" + "".join(f"{column.get(row, 0.0):10.2f}" for column in columns.values()))
    print(f"\n{len(os.sched_getaffinity(0))} CPU cores")


if __name__ == "__main__":
    main()
