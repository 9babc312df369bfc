"""What a batch's judge misses: worlds with a wrong number, judged with contacts and ties recorded, and without.

    .venv/bin/python benchmarks/judge_batches.py --count 64
    .venv/bin/python benchmarks/judge_batches.py --count 64 --docs docs/judge.md

The worlds of a sweep are simulated as one batch, whose recordings hold neither contacts nor what joints, springs and
ropes give. Here faults of `benchmarks/judge_faults.py` are drawn, of any family without fluid and of any of its sizes.
Each is put into a world that is drawn as well, recorded by wsim's own run, and judged twice: with all that was
recorded, and as a batch would have recorded it. A fault that only the first judgement finds is one
that a sweep accepts in its batch, and rejects when it runs its best by themselves.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT)] if str(ROOT) not in sys.path else []

from benchmarks.judge_families.drawn import Draw, Sound  # noqa: E402
from benchmarks.judge_families.family import effect  # noqa: E402
from benchmarks.judge_families.record import own, simulated, world_of  # noqa: E402
from benchmarks.judge_families.register import FAMILIES, MECHANISMS  # noqa: E402
from benchmarks.judge_families.trial import LEAST_EFFECT  # noqa: E402
from wsim.judge import judge  # noqa: E402

MARKS = "<!-- judge-batches:begin -->", "<!-- judge-batches:end -->"
Found = tuple[str, str, list[str], list[str]]  # fault, world, and what failed with contacts and ties, and without


def drawn(seed: int) -> Iterator[Found]:
    """Faults in worlds, as many as are asked for."""
    draw = Draw("batches", seed)
    kinds = [family for family in FAMILIES.values() if not family.hand]
    dry = [mechanism for mechanism in MECHANISMS.values() if "fluid" not in mechanism.has]
    while True:
        family = draw.pick(kinds)
        suited = [mechanism for mechanism in dry if family.suits(mechanism)]
        if not suited:
            continue
        sound = Sound(draw.pick(suited), draw.whole(0, 999))
        size = draw.pick(family.sizes)
        try:
            track = simulated(sound.stage)
            faulty = family.make(sound, size, draw)
        except (RuntimeError, ValueError):  # the run broke: there is nothing to judge
            continue
        if effect(track, faulty) < LEAST_EFFECT or judge(own(track, world_of(sound.stage)), sound.plan).failures:
            continue
        recording = own(faulty.track, faulty.world)
        both = (judge(each, faulty.plan) for each in (recording, replace(recording, contacts=None, ties=None)))
        with_all, without = ([finding.check for finding in verdict.failures] for verdict in both)
        yield f"{family.name} {size:g}", sound.name, with_all, without


def table(found: list[Found]) -> str:
    """How many of the faults each finds."""
    alone, batch = (sum(bool(each[k]) for each in found) for k in (2, 3))
    missed = [each for each in found if each[2] and not each[3]]
    by = Counter(check for _, _, checks, _ in missed for check in set(checks))
    named = ", ".join(f"{name} {n}" for name, n in by.most_common())
    return "\n".join([
        "| worlds with a wrong number | found with contacts and ties | found as in a batch | found alone only |",
        "| --- | --- | --- | --- |",
        f"| {len(found)} | {alone} | {batch} | {len(missed)}{': ' if missed else ''}{named} |",
    ])  # fmt: skip


def main() -> None:
    """Draw, judge, print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=64)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--docs", type=Path, metavar="FILE", help="put the table between the marks of this document")
    given = parser.parse_args()
    found: list[Found] = []
    for each in drawn(given.seed):
        found.append(each)
        said = " ".join("none" if not checks else ",".join(sorted(set(checks))) for checks in each[2:])
        print(f"[{len(found)}/{given.count}] {each[0]} in {each[1]}: {said}", flush=True)
        if len(found) == given.count:
            break
    print("\n" + table(found))
    if given.docs:
        text = given.docs.read_text(encoding="utf-8")
        before, rest = text.split(MARKS[0])
        given.docs.write_text(
            f"{before}{MARKS[0]}\n{table(found)}\n{MARKS[1]}{rest.split(MARKS[1])[1]}", encoding="utf-8"
        )


if __name__ == "__main__":
    main()
