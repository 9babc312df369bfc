"""A wrong program is run, judged, mended by what the judge suggests first, and run again: up to three times."""

from __future__ import annotations

import time
import traceback
from dataclasses import dataclass, field
from typing import Any

from benchmarks.judge_families.drawn import Draw
from benchmarks.judge_families.record import own, simulated, world_of
from benchmarks.judge_mends.worlds import ALL, written
from benchmarks.judge_mends.wrong import WRONG, Mistake
from benchmarks.judge_worlds.world import SoundWorld
from wsim.judge import judge
from wsim.judge.repair.order import suggestions
from wsim.judge.verdict import Verdict
from wsim.plan.schema import Plan
from wsim.program.mend import NotMendedError, mended
from wsim.program.mend.unroll import unrolled
from wsim.scene import Scene, SceneError

SEEDS = {"tuning": 1, "held-out": 4}  # 2, and what was seen of 3, were looked at
TRIES = 12  # worlds that a mistake is put into until the judge rejects what it made of a sound one
ROUNDS = 3
SLOW = ("pour", "submerged", "dominoes", "seesaw", "cradle")  # whose runs take minutes, or whose steps are short
WET = ("floating block", "floating ball", "sinking")


@dataclass
class Outcome:
    """What became of one wrong program."""

    kind: str  # of mistake
    half: str
    k: int
    world: str = ""
    what: str = ""
    opened: bool = False  # whether the plan leaves open what is wrong
    found: str = ""  # the check whose suggestion was taken first
    taken: list[str] = field(default_factory=list)  # the suggestions, in words
    rounds: int = 0  # suggestions after which it is accepted; 0: never
    error: str = ""  # why no further suggestion could be applied
    left: list[str] = field(default_factory=list)  # what still fails
    seconds: float = 0.0

    @property
    def name(self) -> str:
        """As `--only` finds it."""
        return f"{self.kind} | {self.half} {self.k}"


def stage_of(program: str) -> str:
    """The stage that a program makes, as text.

    Raises:
        SceneError: Its numbers make none.
    """
    names: dict[str, Any] = {"__name__": "program"}
    exec(compile(program, "program.py", "exec"), names)  # the benchmark's own programs
    scene = Scene()
    names["build"](scene)
    return str(scene.stage.GetRootLayer().ExportToString())


def judged(program: str, plan: Plan) -> Verdict:
    """The verdict on a program's run."""
    stage = stage_of(program)
    return judge(own(simulated(stage), world_of(stage)), plan)


def drawn(kind: str, half: str, k: int) -> tuple[SoundWorld, int, Plan, Plan, str, Mistake] | None:
    """A world, the right plan, the plan that the judge is told, and the wrong program; None if none was found."""
    draw = Draw("mends", SEEDS[half], kind, k)
    names = WET if kind in ("too_heavy_to_float", "too_light_to_sink", "water_level", "fluid_density") else ()
    worlds = [w for w in ALL if (w.name in names if names else w.name not in (*SLOW, *WET))]
    for _ in range(TRIES * 4):
        world = draw.pick(worlds)
        variant = draw.whole(0, len(world.plans) - 1)
        plan = world.plans[variant]()
        try:
            mistake = WRONG[kind](plan, draw)
            if mistake is None:
                continue
            right = unrolled(written(world, plan))
            program = unrolled(written(world, mistake.plan(plan))) if mistake.plan else right
            program = mistake.program(program) if mistake.program else program
            told = mistake.opened(plan) if mistake.opened else plan
            if judged(right, plan).status != "accepted" or judged(program, told).status != "rejected":
                continue
        except (SceneError, ValueError, KeyError, TypeError, AssertionError):
            continue  # this mistake cannot be made in this world
        return world, variant, plan, told, program, mistake
    return None


def run(kind: str, half: str, k: int) -> Outcome:
    """Draw a wrong program and mend it; what goes wrong is told, not raised."""
    started = time.perf_counter()
    outcome = Outcome(kind, half, k)
    try:
        found = drawn(kind, half, k)
        if found is None:
            outcome.error = "no world was found for it"
            return outcome
        world, variant, plan, told, program, mistake = found
        outcome.world, outcome.what, outcome.opened = (
            f"{world.name} {variant}",
            mistake.what,
            mistake.opened is not None,
        )
        mend(outcome, program, plan, told)
    except Exception:  # noqa: BLE001 - the other trials go on; it is told, and sets the exit code
        outcome.error = "broke: " + traceback.format_exc().strip().splitlines()[-1]
    outcome.seconds = round(time.perf_counter() - started, 1)
    return outcome


def mend(outcome: Outcome, program: str, plan: Plan, told: Plan) -> None:
    """Apply first suggestions until the world is accepted, three at most, and note them."""
    verdict = judged(program, told)
    for n in range(1, ROUNDS + 1):
        first = next(iter(suggestions(verdict)), None)
        outcome.found = outcome.found or (first.check if first else "")
        if first is None or first.target is None:
            outcome.error = "nothing is suggested"
            break
        outcome.taken.append(f"{first.check}: {first.target.sentence}")
        try:
            program = mended(program, first.target, plan)
            verdict = judged(program, told)
        except (NotMendedError, SceneError, RuntimeError) as error:
            outcome.error = str(error).splitlines()[0]
            break
        if verdict.status == "accepted":
            outcome.rounds = n
            break
    outcome.left = [f"{f.check}: {f.message}" for f in verdict.failures]
