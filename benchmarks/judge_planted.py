"""How good is the judge? Sound worlds that it must accept, and planted faults that it must reject.

    .venv/bin/python benchmarks/judge_planted.py --jobs 2                     the sound worlds and the tuning half
    .venv/bin/python benchmarks/judge_planted.py --jobs 2 --rejudge           what is recorded already, judged again
    .venv/bin/python benchmarks/judge_planted.py --only pendulum --verbose    the runs whose names hold a word
    .venv/bin/python benchmarks/judge_planted.py --half all --json build/judge_faults/planted.json --docs docs/judge.md

Each world's plan and program are real: composed, built in the sandbox and simulated. A fault changes the program, the
solver, or what is recorded, while the plan that the judge holds the run to stays as it is; and each faulty recording
must differ from the sound one by the size that the fault states, or the benchmark fails. Which half a fault belongs to
was drawn by a seed before the judge was looked at with any of them; the held-out half is for the final figure.

Recordings are kept under build/judge_faults by the program and the fault that made them: a run that was stopped goes on
where it was. Remove the folder after a change of the simulator or of what it records. `--half held-out --record` makes
the other half's recordings, and makes sure that their faults are there, without showing a verdict.
"""

from __future__ import annotations

import argparse
import copy
import hashlib
import json
import multiprocessing
import shutil
import sys
import time
import traceback
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT)] if str(ROOT) not in sys.path else []

from benchmarks.judge_worlds import FAULTS, WORLDS  # noqa: E402
from benchmarks.judge_worlds.fault import Fault, halves  # noqa: E402
from benchmarks.judge_worlds.tables import between_marks, markdown, print_tables, summary  # noqa: E402
from benchmarks.judge_worlds.tamper import simulate  # noqa: E402
from benchmarks.judge_worlds.world import SoundWorld  # noqa: E402
from wsim.judge import judge  # noqa: E402
from wsim.judge.verdict import unjudged  # noqa: E402
from wsim.plan.schema import Plan  # noqa: E402
from wsim.recording import read  # noqa: E402

CACHE = ROOT / "build" / "judge_faults"
FORMAT = 1  # of the kept recordings: raise it where the simulator records more


@dataclass(frozen=True)
class Case:
    """One run: a variant of a sound world, or a fault in it."""

    world: SoundWorld
    variant: int
    fault: Fault | None = None

    @property
    def name(self) -> str:
        """Which run it is."""
        return self.fault.name if self.fault else f"sound | {self.world.name} {self.variant}"

    @cached_property
    def plan(self) -> Plan:
        """What the judge holds the run to."""
        return self.world.plans[self.variant]()

    @cached_property
    def program(self) -> str:
        """What is run: the plan's program, or a faulty one."""
        plan = self.fault.plan(self.plan) if self.fault and self.fault.plan else self.plan
        program = self.world.write(plan)
        return self.fault.program(program) if self.fault and self.fault.program else program

    @property
    def pictures(self) -> bool:
        """Whether pictures are taken: where the fault is one of them, and of the sound run that it is held against."""
        if self.fault:
            return self.fault.pictures
        return any(f.pictures and (f.world, f.variant) == (self.world.name, self.variant) for f in FAULTS)

    @property
    def folder(self) -> Path:
        """Where what is recorded of it is kept: by the program and by what was tampered with."""
        tamper = repr(self.fault.tamper) if self.fault else ""
        text = f"{FORMAT}\n{self.program}\n{tamper}\n{self.pictures}"
        return CACHE / "recordings" / hashlib.sha256(text.encode()).hexdigest()[:16]


@dataclass
class Outcome:
    """What the judge made of a run."""

    name: str
    world: str
    family: str
    kind: str = ""  # of the fault; none of a sound world
    made: str = ""
    half: str = ""
    size: str = ""
    status: str = ""
    failed: list[str] = field(default_factory=list)  # the checks that failed, and their messages
    checks: list[str] = field(default_factory=list)
    difference: float | None = None
    least: float | None = None
    unit: str = ""
    error: str = ""  # of the benchmark itself
    seconds: float = 0.0

    @property
    def accepted(self) -> bool:
        """Whether the judge let it pass."""
        return self.status == "accepted"


def cases(half: str, only: Sequence[str] = ()) -> list[Case]:
    """The sound runs and the faults of a half whose names hold one of some words; sound ones first."""
    worlds = {world.name: world for world in WORLDS}
    of = halves(FAULTS)
    found = [Case(world, k) for world in WORLDS for k in range(len(world.plans))]
    found += [Case(worlds[f.world], f.variant, f) for f in FAULTS if half in ("all", of[f.name])]
    return [case for case in found if not only or any(word in case.name for word in only)]


def record(case: Case) -> Path:
    """The recording of a run, made now unless it is kept."""
    from wsim.runs.iteration import Iteration
    from wsim.runs.settings import Settings

    folder = case.folder
    recording = folder / "recording.rrd"
    if recording.exists():
        return recording
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    (folder / "name.txt").write_text(case.name + "\n")
    (folder / "program.py").write_text(case.program)
    built = Iteration(folder, settings=Settings(device="cpu")).build()
    if not built.ok:
        raise RuntimeError(f"the program made no world: {built.finding()}")
    fault = case.fault
    tamper = copy.deepcopy(fault.tamper) if fault else None
    simulate(folder / "stage.usda", recording, tamper, pictures=case.pictures)
    return recording


def run(case: Case, rejudge: bool = False, judged: bool = True) -> Outcome:
    """Record a run, make sure that its fault is there, and judge it; what goes wrong is told, not raised."""
    started = time.perf_counter()
    fault = case.fault
    made = Outcome(case.name, case.world.name, case.world.family)
    if fault:
        made.kind, made.made, made.size, made.unit, made.least = (
            fault.kind,
            fault.made,
            fault.size,
            fault.unit,
            fault.least,
        )
        made.half = halves(FAULTS)[fault.name]
    try:
        if rejudge and not (case.folder / "recording.rrd").exists():
            raise FileNotFoundError("not recorded yet; leave out --rejudge")
        recording = read(record(case))
        if fault:
            sound = read(record(Case(case.world, case.variant)))
            made.difference = float(fault.difference(sound, recording))
            if not made.difference >= fault.least:
                raise AssertionError(f"differs by {made.difference:.3g} {fault.unit}, not by {fault.least:g}: no fault")
        if not judged:
            made.status = "recorded"
            return made
        verdict = judge(recording, case.plan)
        if verdict.crashes:
            raise RuntimeError(f"{unjudged(verdict.crashes)}\n{verdict.crashes[0].traceback}")
        made.status = verdict.status
        made.checks = sorted({finding.check for finding in verdict.failures})
        made.failed = [f"{finding.check}: {finding.message}" for finding in verdict.failures]
    except Exception as problem:  # noqa: BLE001 - the other runs go on; it is told, and sets the exit code
        made.error = f"{type(problem).__name__}: {problem}".splitlines()[0]
        (case.folder.parent.mkdir(parents=True, exist_ok=True))
        case.folder.with_suffix(".error").write_text(case.name + "\n" + traceback.format_exc())
    made.seconds = round(time.perf_counter() - started, 2)
    return made


def _run_named(given: tuple[str, bool, bool]) -> Outcome:
    name, rejudge, judged = given
    return run(next(case for case in cases("all") if case.name == name), rejudge, judged)


def outcomes(wanted: list[Case], jobs: int, rejudge: bool, judged: bool = True) -> Iterator[Outcome]:
    """Run them, in several processes; those that a fault is compared with come first."""
    given = [(case.name, rejudge, judged) for case in wanted]
    if jobs == 1:
        yield from map(_run_named, given)
        return
    with multiprocessing.get_context("spawn").Pool(jobs) as pool:
        yield from pool.imap_unordered(_run_named, given)


def watched(found: Iterator[Outcome], count: int, verbose: bool) -> list[Outcome]:
    """The outcomes, with a line on each and the time that is left."""
    started, done = time.perf_counter(), []
    for outcome in found:
        done.append(outcome)
        left = (time.perf_counter() - started) / len(done) * (count - len(done))
        wrong = outcome.error or ("FALSE ACCEPT" if outcome.kind and outcome.accepted else "")
        wrong = wrong or ("FALSE REJECT" if not outcome.kind and outcome.status in ("rejected", "blocked") else "")
        print(f"[{len(done)}/{count}, {left:.0f} s left] {outcome.name}: {outcome.status} {wrong}", flush=True)
        if verbose or (wrong and not outcome.kind):
            for line in outcome.failed:
                print("      " + line)
    return done


def main(arguments: list[str] | None = None) -> int:
    """Run, print the tables; 1 if a run failed or a fault was none."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--half", choices=("tuning", "held-out", "all"), default="tuning")
    parser.add_argument("--only", nargs="+", default=[], metavar="WORD", help="runs whose names hold one of these")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--rejudge", action="store_true", help="record nothing: judge what is kept")
    parser.add_argument(
        "--record", action="store_true", help="record, and look whether the faults are there; judge none"
    )
    parser.add_argument("--verbose", action="store_true", help="say what failed of each run")
    parser.add_argument("--json", type=Path, metavar="FILE")
    parser.add_argument("--markdown", type=Path, metavar="FILE")
    parser.add_argument("--docs", type=Path, metavar="FILE", help="put the tables between the marks of this document")
    given = parser.parse_args(arguments)
    wanted = cases(given.half, given.only)
    found = outcomes(wanted, given.jobs, given.rejudge, not given.record)
    done = watched(found, len(wanted), given.verbose and not given.record)
    done.sort(key=lambda outcome: outcome.name)
    if given.record:
        return int(any(outcome.error for outcome in done))
    print()
    print_tables(done)
    if given.json:
        facts: dict[str, Any] = {"half": given.half, **summary(done), "runs": [asdict(outcome) for outcome in done]}
        given.json.parent.mkdir(parents=True, exist_ok=True)
        given.json.write_text(json.dumps(facts, indent=1) + "\n", encoding="utf-8")
    if given.markdown:
        given.markdown.parent.mkdir(parents=True, exist_ok=True)
        given.markdown.write_text(markdown(done), encoding="utf-8")
    if given.docs:
        given.docs.write_text(between_marks(given.docs.read_text(encoding="utf-8"), markdown(done)), encoding="utf-8")
    return int(any(outcome.error for outcome in done))


if __name__ == "__main__":
    sys.exit(main())
