"""A trial: a fault of a family's size in a sound world, or the sound world itself, put before the judge."""

from __future__ import annotations

import time
import traceback
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache

from benchmarks.judge_families.drawn import Draw, Mechanism, Sound, seed_of
from benchmarks.judge_families.family import Family, effect
from benchmarks.judge_families.record import other, own, simulated, world_of
from benchmarks.judge_families.register import FAMILIES, MECHANISMS
from wsim.judge import judge
from wsim.judge.verdict import unjudged

LEAST_EFFECT = 0.01  # of a body's size, of its speed, or in radians
TRIES = 4  # worlds that a fault is put into until it does something there
WORLDS = 9  # sound worlds of a mechanism
SEED = 3
EVIDENCE = {"wsim": own, "other engine": other}


@dataclass(frozen=True)
class Trial:
    """One of them, by names and numbers alone, so that it can be told and made again.

    Attributes:
        family: Of the fault; empty for a sound world.
        step: Which of the family's sizes.
        k: Which draw; of a sound world, which of its mechanism.
        evidence: As wsim records it, or as another engine's trajectory is imported.
        mechanism: Of a sound world.
    """

    family: str
    step: int
    k: int
    evidence: str
    mechanism: str = ""

    @property
    def name(self) -> str:
        """As `--only` finds it."""
        if not self.family:
            return f"sound | {self.mechanism} {self.k} | {self.evidence}"
        return f"{self.family} | {FAMILIES[self.family].sizes[self.step]:g} | {self.k}"


@dataclass
class Outcome:
    """What the judge made of a trial."""

    name: str
    family: str
    size: float = 0.0
    unit: str = ""
    half: str = ""
    world: str = ""
    mechanism: str = ""
    evidence: str = ""
    status: str = ""
    failed: list[str] = field(default_factory=list)  # checks and their messages
    checks: list[str] = field(default_factory=list)
    effect: float | None = None
    error: str = ""  # of the benchmark itself
    seconds: float = 0.0

    @property
    def accepted(self) -> bool:
        """Whether the judge let it pass."""
        return self.status == "accepted"


def halves(names: Sequence[str]) -> dict[str, str]:
    """Which half each family is in: drawn by its name, so that the others stay where they are as families are added."""
    return {name: ("tuning", "held-out")[seed_of(SEED, "half", name)[0] % 2] for name in names}


def trials(half: str, draws: int, worlds: int, only: Sequence[str] = ()) -> list[Trial]:
    """Sound worlds, then the families of a half, whose names hold one of some words."""
    found = [
        Trial("", 0, k, evidence, mechanism)
        for mechanism in MECHANISMS
        for k in range(worlds)
        for evidence in _evidence(MECHANISMS[mechanism])
    ]
    of = halves(list(FAMILIES))
    for name, family in FAMILIES.items():
        if half in ("all", of[name]):
            kinds = (
                ("other engine",) if family.hand else _evidence(*(m for m in MECHANISMS.values() if family.suits(m)))
            )
            found += [
                Trial(name, step, k, kinds[k % len(kinds)]) for step in range(len(family.sizes)) for k in range(draws)
            ]
    return [trial for trial in found if not only or any(word in trial.name for word in only)]


def _evidence(*mechanisms: Mechanism) -> tuple[str, ...]:
    """What is judged of them: an imported trajectory has no particles."""
    return ("wsim",) if all("fluid" in mechanism.has for mechanism in mechanisms) else tuple(EVIDENCE)


def run(trial: Trial) -> Outcome:
    """Make the recording and judge it; what goes wrong is told, not raised."""
    started = time.perf_counter()
    made = Outcome(trial.name, trial.family, evidence=trial.evidence)
    try:
        if trial.family:
            _fault(trial, FAMILIES[trial.family], made)
        else:
            sound = Sound(MECHANISMS[trial.mechanism], trial.k)
            made.world, made.mechanism = sound.name, trial.mechanism
            _judge(made, EVIDENCE[trial.evidence](simulated(sound.stage), world_of(sound.stage)), sound.plan)
    except Exception as problem:  # noqa: BLE001 - the other trials go on; it is told, and sets the exit code
        made.error = f"{type(problem).__name__}: {problem}".splitlines()[0]
        made.failed = traceback.format_exc().splitlines()[-6:]
    made.seconds = round(time.perf_counter() - started, 2)
    return made


def _fault(trial: Trial, family: Family, made: Outcome) -> None:
    made.size, made.unit = family.sizes[trial.step], family.unit
    made.half = halves([family.name])[family.name]
    suited = [mechanism for mechanism in MECHANISMS.values() if family.suits(mechanism)]
    for attempt in range(TRIES):
        draw = Draw(SEED, family.name, trial.step, trial.k, attempt)
        sound = Sound(draw.pick(suited), draw.whole(0, WORLDS - 1))
        made.world, made.mechanism = sound.name, sound.mechanism.name
        faulty = family.make(sound, made.size, draw)
        made.effect = effect(simulated(sound.stage), faulty) if family.seen else None
        seen = made.effect is None or made.effect >= LEAST_EFFECT
        if seen and _sound_is_accepted(sound, trial.evidence):  # else what rejects it may be no fault
            _judge(made, EVIDENCE[trial.evidence](faulty.track, faulty.world), faulty.plan)
            return
    made.status = "no effect"


@cache
def _sound_is_accepted(sound: Sound, evidence: str) -> bool:
    recording = EVIDENCE[evidence](simulated(sound.stage), world_of(sound.stage))
    return judge(recording, sound.plan).status == "accepted"


def _judge(made: Outcome, recording: object, plan: object = None) -> None:
    verdict = judge(recording, plan)  # type: ignore[arg-type]
    if verdict.crashes:
        raise RuntimeError(unjudged(verdict.crashes))
    made.status = verdict.status
    made.checks = sorted({finding.check for finding in verdict.failures})
    made.failed = [f"{finding.check}: {finding.message}" for finding in verdict.failures]


def outcomes(wanted: list[Trial], jobs: int) -> Iterator[Outcome]:
    """Run them, in several processes; sound worlds come first, as faults start from them."""
    import multiprocessing

    if jobs == 1:
        yield from map(run, wanted)
        return
    with multiprocessing.get_context("spawn").Pool(jobs) as pool:
        yield from pool.imap_unordered(run, wanted, chunksize=4)
