"""How often does the judge reject a sound world? Mechanisms of many kinds, drawn by seed, beside each other.

    .venv/bin/python benchmarks/judge_sound.py --seeds 0:20                 all kinds, as recorded and bare
    .venv/bin/python benchmarks/judge_sound.py --seeds 7 --only springs --verbose
    .venv/bin/python benchmarks/judge_sound.py --seeds 0:100 --json build/judge_sound.json

A world is one mechanism, or two or three, of a kind, or of kinds that are mixed; its bodies are of 2 cm to 3 m, its
gravity 1 to 20 m/s^2, or none, its frames 24 to 120 a second. wsim simulates it on the CPU, and the judge is given
what wsim records, and poses and velocities alone ("bare"). A world that no stage can be made of, or that the simulator
says it cannot follow, is left out and counted. A reject says that judge or simulator is wrong, or that what was drawn
is none that a rigid world can follow: which of them is to be looked at.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT)] if str(ROOT) not in sys.path else []

from benchmarks.judge_families.drawn import Draw  # noqa: E402
from benchmarks.judge_families.record import other, own, simulated, world_of  # noqa: E402
from benchmarks.judge_sound_parts import KINDS, Place  # noqa: E402
from benchmarks.judge_worlds.tables import interval  # noqa: E402
from wsim.errors import UserError  # noqa: E402
from wsim.judge import judge  # noqa: E402
from wsim.scene import Scene  # noqa: E402

RATES = (24.0, 30.0, 50.0, 60.0, 120.0)  # frames a second
LEAST, MOST = 0.02, 3.0  # of bodies [m]
MIXED = "mixed"
EVIDENCE = {"recorded": own, "bare": other}


@dataclass
class Outcome:
    """What the judge made of one world by one kind of evidence."""

    kind: str
    seed: int
    evidence: str
    rate: float
    status: str
    failed: list[str] = field(default_factory=list)


def stage_of(kind: str, seed: int) -> tuple[str, float]:
    """A world's stage as text, and its frame rate [1/s].

    Raises:
        SceneError: If what was drawn is no world.
    """
    draw, scene = Draw("sound parts", kind, seed), Scene()
    rate, g = draw.pick(RATES), draw.pick((0.0, 9.81, *(draw.between(1.0, 20.0) for _ in range(5))))
    scene.simulation(gravity=(0.0, 0.0, -g), duration=draw.between(1.0, 2.0), frame_rate=rate)
    y, size = 0.0, draw.log(LEAST, MOST)
    for k in range(draw.whole(1, 3)):
        name = draw.pick(list(KINDS)) if kind == MIXED else kind
        KINDS[name](scene, draw, Place(f"{name}{k}", y, size, g))
        y += 20.0 * size
    with tempfile.TemporaryDirectory() as folder:
        return scene.save(Path(folder) / "sound.usda").read_text(encoding="utf-8"), rate


def outcomes(kind: str, seed: int) -> list[Outcome]:
    """Simulate and judge one world."""
    try:
        stage, rate = stage_of(kind, seed)
        track, world = simulated(stage), world_of(stage)
    except (UserError, RuntimeError) as problem:
        return [Outcome(kind, seed, "", 0.0, "left out", [str(problem)])]
    found = []
    for name, record in EVIDENCE.items():
        verdict = judge(record(track, world))
        failed = [f"{finding.check} {finding.prim} {finding.time}: {finding.message}" for finding in verdict.failures]
        failed += [f"crash: {crash}" for crash in verdict.crashes]
        found.append(Outcome(kind, seed, name, rate, verdict.status, failed))
    return found


def table(done: list[Outcome]) -> str:
    """Worlds and rejects by kind, then by frame rate, in Markdown."""
    lines = ["| worlds | judged | rejected as recorded | rejected bare |", "| --- | --- | --- | --- |"]
    judged = [outcome for outcome in done if outcome.evidence]
    groups: list[tuple[str, list[Outcome]]] = []
    for kind in sorted({outcome.kind for outcome in judged}):
        groups.append((kind, [outcome for outcome in judged if outcome.kind == kind]))
    for rate in sorted({outcome.rate for outcome in judged}):
        groups.append((f"{rate:g} frames/s", [outcome for outcome in judged if outcome.rate == rate]))
    for name, group in [*groups, ("all", judged)]:
        cells = []
        for evidence in EVIDENCE:
            of = [outcome for outcome in group if outcome.evidence == evidence]
            bad = sum(outcome.status != "accepted" for outcome in of)
            low, high = interval(bad, len(of))
            cells.append(f"{bad} ({100 * low:.1f} to {100 * high:.1f} %)")
        lines.append(f"| {name} | {len(of)} | " + " | ".join(cells) + " |")
    left = sum(outcome.status == "left out" for outcome in done)
    return "\n".join([*lines, "", f"Left out: {left}. In brackets: 95 % (Wilson)."])


def _seeds(text: str) -> range:
    first, _, last = text.partition(":")
    return range(int(first), int(last or int(first) + 1))


def _watched(kinds: list[str], seeds: range, verbose: bool) -> Iterator[Outcome]:
    for seed in seeds:
        for kind in kinds:
            for outcome in outcomes(kind, seed):
                yield outcome
                if outcome.status != "accepted" or verbose:
                    print(f"{outcome.kind} {outcome.seed}, {outcome.rate:g}/s, {outcome.evidence}: {outcome.status}")
                    print(*("      " + line for line in outcome.failed), sep="\n", flush=True)


def main(arguments: list[str] | None = None) -> int:
    """Draw, judge, print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=_seeds, default=range(10), metavar="FIRST:END")
    parser.add_argument("--only", nargs="+", default=[*KINDS, MIXED], choices=[*KINDS, MIXED], metavar="KIND")
    parser.add_argument("--verbose", action="store_true")
    parser.add_argument("--json", type=Path, metavar="FILE")
    given = parser.parse_args(arguments)
    done = list(_watched(given.only, given.seeds, given.verbose))
    print("\n" + table(done))
    if given.json:
        given.json.parent.mkdir(parents=True, exist_ok=True)
        given.json.write_text(json.dumps([asdict(outcome) for outcome in done], indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
