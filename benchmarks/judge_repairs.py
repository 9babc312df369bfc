"""How good are the judge's suggestions? Rejected programs, mended by program with what it suggests first.

    .venv/bin/python benchmarks/judge_repairs.py --jobs 2                    the tuning half
    .venv/bin/python benchmarks/judge_repairs.py --only friction --verbose   trials whose names hold some words
    .venv/bin/python benchmarks/judge_repairs.py --half held-out --jobs 2 --json build/judge_repairs.json \\
        --docs docs/judge.md

Into sound programs that the judge accepts one wrong number or arrangement is put, drawn at random from each of some
thirty kinds; the plan stays as it is, or leaves open what is wrong, so that physics alone can tell. What the judge then
rejects is mended by nobody's judgement: the first suggestion is applied to the program's text as it stands
(`wsim.program.mend`), the program is run and judged again, and so up to three times. A suggestion without a value is
one that fails.

The halves are of other draws; the held-out one is for the final figure. Simulations are kept under
build/judge_faults/families by their content: remove the folder after a change of the simulator.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import sys
import time
from collections.abc import Iterable, Iterator
from dataclasses import asdict
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT)] if str(ROOT) not in sys.path else []

from benchmarks.judge_mends.trial import Outcome, run  # noqa: E402
from benchmarks.judge_mends.wrong import WRONG  # noqa: E402
from benchmarks.judge_worlds.tables import between_marks, interval  # noqa: E402

DRAWS = 2  # of each kind of mistake, in each half
MARK = "judge-repairs"


def _run(given: tuple[str, str, int]) -> Outcome:
    return run(*given)


def outcomes(wanted: list[tuple[str, str, int]], jobs: int) -> Iterator[Outcome]:
    """Run them, in several processes."""
    if jobs == 1:
        yield from map(_run, wanted)
        return
    with multiprocessing.get_context("spawn").Pool(jobs) as pool:
        yield from pool.imap_unordered(_run, wanted)


def watched(found: Iterable[Outcome], count: int, verbose: bool) -> list[Outcome]:
    """The outcomes, with a line on each, and the time that is left."""
    started, done = time.perf_counter(), []
    for outcome in found:
        done.append(outcome)
        left = (time.perf_counter() - started) / len(done) * (count - len(done))
        told = f"accepted after {outcome.rounds}" if outcome.rounds else outcome.error or "still rejected"
        print(f"[{len(done)}/{count}, {left:.0f} s left] {outcome.name}: {outcome.world}, {outcome.what}"
              f"{', open' if outcome.opened else ''}: {told}", flush=True)  # fmt: skip
        if verbose or outcome.rounds != 1:
            for line in outcome.taken:
                print("      " + line)
            for line in outcome.left[:4]:
                print("        left: " + line[:150])
    return done


def share(part: list[Outcome], most: int) -> str:
    """Of some the part that is accepted after so many suggestions, with its 95 % interval."""
    good, n = sum(0 < each.rounds <= most for each in part), len(part)
    low, high = interval(good, n)
    return f"{good} of {n} = {good / n:.0%} ({low:.0%} to {high:.0%})"


def tables(done: list[Outcome]) -> str:
    """The shares, by what is told of the mistake and by the check whose suggestion was taken first."""
    found = [each for each in done if each.world]
    groups = [("all", found)]
    groups += [
        ("the plan states it", [each for each in found if not each.opened]),
        ("the plan leaves it open", [each for each in found if each.opened]),
    ]
    checks = sorted({each.found for each in found})
    groups += [(f"`{name}` first", [each for each in found if each.found == name]) for name in checks]
    lines = ["| rejected programs | accepted after one suggestion | after three |", "| --- | --- | --- |"]
    lines += [f"| {name} | {share(part, 1)} | {share(part, 3)} |" for name, part in groups if part]
    return "\n".join(lines)


def main(arguments: list[str] | None = None) -> int:
    """Run, print the table; 1 if a trial broke."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--half", choices=("tuning", "held-out"), default="tuning")
    parser.add_argument("--only", nargs="+", default=[], metavar="WORDS", help="trials whose names hold one of these")
    parser.add_argument("--draws", type=int, default=DRAWS, help="of each kind of mistake")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--verbose", action="store_true", help="say what was suggested in each trial")
    parser.add_argument("--json", type=Path, metavar="FILE")
    parser.add_argument("--docs", type=Path, metavar="FILE", help="put the table between the marks of this document")
    given = parser.parse_args(arguments)
    wanted = [(kind, given.half, k) for k in range(given.draws) for kind in WRONG]
    wanted = [
        each for each in wanted
        if not given.only or any(word in f"{each[0]} | {each[1]} {each[2]}" for word in given.only)
    ]  # fmt: skip
    done = watched(outcomes(wanted, given.jobs), len(wanted), given.verbose)
    done.sort(key=lambda outcome: outcome.name)
    print("\n" + tables(done))
    if given.json:
        given.json.parent.mkdir(parents=True, exist_ok=True)
        given.json.write_text(json.dumps([asdict(each) for each in done], indent=1) + "\n", encoding="utf-8")
    if given.docs:
        given.docs.write_text(
            between_marks(given.docs.read_text(encoding="utf-8"), tables(done), MARK), encoding="utf-8"
        )
    return int(any(each.error.startswith("broke") for each in done))


if __name__ == "__main__":
    sys.exit(main())
