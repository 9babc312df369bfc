"""A planted fault: what is changed, and by how much the recording then differs from the sound one."""

from __future__ import annotations

import random
from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

from benchmarks.judge_worlds.tamper import Tamper
from wsim.plan.schema import Plan
from wsim.recording import Recording

SPLIT_SEED = 20261121  # fixed before any limit of the judge was looked at with these faults
Made = Literal["program", "solver", "recording"]
Difference = Callable[[Recording, Recording], float]


@dataclass(frozen=True)
class Fault:
    """One fault in one variant of a sound world; the plan that the judge holds it to stays as it is.

    Attributes:
        kind: What is wrong, as the tables have it.
        world: Name of the sound world.
        variant: Which of its plans.
        size: How wrong, for people.
        difference: From the sound recording and the faulty one, how far they are apart.
        least: What `difference` must be at the least, or the fault is none.
        unit: Of both.
        plan: Changes the plan that the program is composed of, and so the program.
        program: Changes the program's text.
        tamper: Changes the solver, its state, or what is recorded.
        pictures: Whether the fault is one of the pictures, which are then taken.
    """

    kind: str
    world: str
    variant: int
    size: str
    difference: Difference
    least: float
    unit: str
    plan: Callable[[Plan], Plan] | None = None
    program: Callable[[str], str] | None = None
    tamper: Tamper | None = None
    pictures: bool = False

    @property
    def name(self) -> str:
        """Which fault it is: no two have the same."""
        return f"{self.kind} | {self.world} {self.variant} | {self.size}"

    @property
    def made(self) -> Made:
        """Where the fault is planted."""
        if self.tamper is None:
            return "program"
        return "solver" if type(self.tamper).__module__.endswith("in_solver") else "recording"


def halves(faults: Sequence[Fault], seed: int = SPLIT_SEED) -> dict[str, str]:
    """Which half each fault belongs to, "tuning" or "held-out", by its name: half of every kind, drawn by the seed.

    Each kind is drawn by itself, so that a fault that is added to one kind moves none of another. The odd one of a kind
    goes to either half.
    """
    of_kind: dict[str, list[str]] = defaultdict(list)
    for fault in faults:
        of_kind[fault.kind].append(fault.name)
    half: dict[str, str] = {}
    for kind, names in of_kind.items():
        rng = random.Random(f"{seed} {kind}")
        drawn = rng.sample(sorted(names), len(names))
        first = (len(names) + rng.randrange(2)) // 2
        half |= {name: "tuning" if k < first else "held-out" for k, name in enumerate(drawn)}
    return half
