"""How good is the static validator? Mistakes that it must find, and correct programs that it must leave alone.

    .venv/bin/python benchmarks/validator.py --jobs 2                   both halves; what was missed of the tuning half
    .venv/bin/python benchmarks/validator.py --only wrong_name truck    the cases whose names or kinds hold a word
    .venv/bin/python benchmarks/validator.py --prove --jobs 2           run the cases in the sandbox instead
    .venv/bin/python benchmarks/validator.py --jobs 2 --json build/validator/results.json

A mistake is found if a complaint stands within a line of it, and named if that complaint says the right name or
signature, too. What has no line, such as a missing `build`, is found by a complaint that names it. Which half a mistake
belongs to is drawn by the hash of its name; of the held-out half only the figures are told, unless by `--half all`.
Seconds are those of one program in a process that has validated another one before.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import statistics
import sys
import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT)] if str(ROOT) not in sys.path else []

from benchmarks.validator_cases import Mistake, Program, halves, mistakes, programs  # noqa: E402

TARGET_FOUND, TARGET_SECONDS = 0.98, 0.5
Complaint = tuple[int | None, str]  # the line, and all that it says


@dataclass
class Outcome:
    """What the validator said of one program."""

    name: str
    kind: str = ""  # of a mistake; empty for a correct program
    half: str = ""
    right: str | None = None
    lines: list[int] = field(default_factory=list)
    complaints: list[Complaint] = field(default_factory=list)
    found: bool = False
    named: bool = False
    seconds: float = 0.0
    first: float = 0.0  # seconds of the first program that the process validated
    error: str = ""


Case = tuple[Program, Mistake | None, str]  # a program, the mistake in it if there is one, and its half


def cases(only: Sequence[str] = ()) -> list[Case]:
    """The correct programs, then the mistakes; with `only`, those whose names or kinds hold one of the words."""
    planted = mistakes()
    of = halves(mistake.name for mistake in planted)
    found: list[Case] = [(program, None, "") for program in programs()]
    found += [(mistake.program, mistake, of[mistake.name]) for mistake in planted]
    words = [word.replace("_", " ") for word in only]

    def wanted(case: Case) -> bool:
        program, mistake, _ = case
        label = f"{mistake.kind} {mistake.name}" if mistake else program.name
        return not words or any(word in label.replace("_", " ") for word in words)

    return [case for case in found if wanted(case)]


def score(case: Case, complaints: Sequence[Complaint]) -> Outcome:
    """Hold what was complained of against what is wrong."""
    program, mistake, half = case
    if mistake is None:
        return Outcome(program.name, complaints=list(complaints))
    hits = [sentence for line, sentence in complaints if mistake.found_by(line, sentence)]
    return Outcome(
        mistake.name,
        mistake.kind,
        half,
        mistake.right,
        mistake.lines,
        list(complaints),
        found=bool(hits),
        named=any(mistake.named_by(sentence) for sentence in hits),
    )


def _complaints(program: Program) -> list[Complaint]:
    from wsim.program.validator import validate

    found = validate(program.text, program.plan)
    return [(problem.line, f"{problem.sentence} {problem.nearest or ''}".strip()) for problem in found]


_first: float | None = None


def measure(case: Case) -> Outcome:
    """Validate one program; what the validator raises is told, not raised."""
    global _first
    try:
        if _first is None:
            started = time.perf_counter()
            _complaints(programs()[0])
            _first = time.perf_counter() - started
        started = time.perf_counter()
        complaints = _complaints(case[0])
        seconds = time.perf_counter() - started
    except Exception as problem:  # noqa: BLE001 - the other programs go on; it is told, and sets the exit code
        outcome = score(case, [])
        outcome.error = f"{type(problem).__name__}: {problem}".splitlines()[0]
        return outcome
    outcome = score(case, complaints)
    outcome.seconds, outcome.first = seconds, _first
    return outcome


def prove(case: Case) -> str:
    """What is wrong with a case itself, run in the sandbox; empty if nothing is."""
    from benchmarks.validator_cases.prove import excuse, objection

    program, mistake, _ = case
    return excuse(mistake) if mistake else objection(program)


def each(work: Any, wanted: list[Case], jobs: int) -> Iterator[Any]:
    """The results of the cases, in their order, in several processes; progress goes to stderr."""
    started = time.perf_counter()

    def watched(results: Iterable[Any]) -> Iterator[Any]:
        for done, result in enumerate(results, 1):
            left = (time.perf_counter() - started) / done * (len(wanted) - done)
            print(f"\r{done} of {len(wanted)} programs, {left:.0f} s left   ", end="", file=sys.stderr, flush=True)
            yield result
        print(file=sys.stderr)

    if jobs == 1:
        yield from watched(map(work, wanted))
        return
    with multiprocessing.get_context("spawn").Pool(jobs) as pool:
        yield from watched(pool.imap(work, wanted))


def _counts(outcomes: Iterable[Outcome]) -> dict[str, int]:
    here = list(outcomes)
    nameable = [outcome for outcome in here if outcome.right]
    return {
        "mistakes": len(here),
        "found": sum(outcome.found for outcome in here),
        "nameable": len(nameable),
        "named": sum(outcome.named for outcome in nameable),
    }


def summary(outcomes: Sequence[Outcome]) -> dict[str, Any]:
    """Counts by half and by kind, complaints on correct programs, and seconds."""
    planted = [outcome for outcome in outcomes if outcome.kind]
    correct = [outcome for outcome in outcomes if not outcome.kind]
    seconds = [outcome.seconds for outcome in outcomes if not outcome.error]
    firsts = [outcome.first for outcome in outcomes if not outcome.error]
    return {
        "all": _counts(planted),
        "halves": {half: _counts(o for o in planted if o.half == half) for half in ("tuning", "held-out")},
        "kinds": {kind: _counts(o for o in planted if o.kind == kind) for kind in sorted({o.kind for o in planted})},
        "correct": len(correct),
        "complained_of": sum(bool(outcome.complaints or outcome.error) for outcome in correct),
        "errors": sum(bool(outcome.error) for outcome in outcomes),
        "median_s": round(statistics.median(seconds), 4) if seconds else None,
        "worst_s": round(max(seconds), 4) if seconds else None,
        "first_s": round(max(firsts), 4) if firsts else None,
    }


def print_table(facts: dict[str, Any]) -> None:
    """A row a kind, a row a half, a row for all; then the correct programs and the seconds."""
    rows = [(kind, counts) for kind, counts in facts["kinds"].items()]
    rows += [(f"{half} half", counts) for half, counts in facts["halves"].items()] + [("all", facts["all"])]
    width = max(len(name) for name, _ in rows)
    print(f"{'mistakes':{width}}  planted  found  right entry named")
    for name, counts in rows:
        print(
            f"{name:{width}}  {counts['mistakes']:7}  {counts['found']:5}  {counts['named']:5} of {counts['nameable']}"
        )
    print(f"\ncorrect programs complained of: {facts['complained_of']} of {facts['correct']}")
    if facts["median_s"] is not None:
        print(
            f"seconds a program: median {facts['median_s']:.3f}, worst {facts['worst_s']:.3f}; "
            f"the first in a process {facts['first_s']:.3f}"
        )
    if facts["errors"]:
        print(f"the validator itself failed on {facts['errors']} programs")


def shown(outcome: Outcome, half: str) -> bool:
    """Whether more than its count is told of a case."""
    return half == "all" or outcome.half != "held-out"


def print_misses(outcomes: Sequence[Outcome], half: str) -> None:
    """What was missed, named wrongly, or complained of without cause."""
    for outcome in outcomes:
        wrong = outcome.error or ("MISSED" if outcome.kind and not outcome.found else "")
        wrong = wrong or (f"{outcome.right!r} is not named" if outcome.right and not outcome.named else "")
        wrong = wrong or ("COMPLAINED OF" if not outcome.kind and outcome.complaints else "")
        if not wrong or not shown(outcome, half):
            continue
        where = f", line {' or '.join(map(str, outcome.lines))}" if outcome.lines else ""
        print(f"{outcome.kind or 'correct'} | {outcome.name}{where}: {wrong}")
        for line, sentence in outcome.complaints:
            print(f"      {line}: {sentence}")


def main(arguments: list[str] | None = None) -> int:
    """Print the tables; 1 if fewer mistakes are found than must be, or a correct program is complained of."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--half", choices=("tuning", "all"), default="tuning", help="whose misses are listed")
    parser.add_argument("--only", nargs="+", default=[], metavar="WORD")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--prove", action="store_true", help="run the cases in the sandbox: is each what it says?")
    parser.add_argument("--json", type=Path, metavar="FILE")
    given = parser.parse_args(arguments)
    wanted = cases(given.only)
    if not wanted:
        parser.error(f"no case has {' or '.join(given.only)} in its name or kind")
    if given.prove:
        wrong = [reason for reason in each(prove, wanted, given.jobs) if reason]
        print("\n".join(wrong) or f"all {len(wanted)} cases are what they say")
        return int(bool(wrong))
    outcomes = list(each(measure, wanted, given.jobs))
    facts = summary(outcomes)
    print_misses(outcomes, given.half)
    print_table(facts)
    if given.json:
        given.json.parent.mkdir(parents=True, exist_ok=True)
        record = {**facts, "cases": [asdict(outcome) for outcome in outcomes if shown(outcome, given.half)]}
        given.json.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    found = facts["all"]["found"] >= TARGET_FOUND * facts["all"]["mistakes"]
    quick = facts["worst_s"] is not None and facts["worst_s"] <= TARGET_SECONDS
    return int(bool(facts["errors"] or facts["complained_of"] or not found or not quick))


if __name__ == "__main__":
    sys.exit(main())
