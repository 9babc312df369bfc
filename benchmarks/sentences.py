"""Sentences from a grammar that the builtin planner does not know: how many are planned, and how many become worlds.

    .venv/bin/python benchmarks/sentences.py --count 1000                       # plan them
    .venv/bin/python benchmarks/sentences.py --count 1000 --build 200 --jobs 2  # and build, simulate and judge some
    .venv/bin/python benchmarks/sentences.py --build 40 --pictures              # with stills, to look at

The grammar is `data/sentences.toml`: its words are those that the README announces, its orders are those that people
write. The same seed makes the same sentences. Intervals are Wilson's, 95 %.
"""

from __future__ import annotations

import argparse
import json
import random
import re
import subprocess
import sys
import tempfile
import time
import tomllib
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from math import sqrt
from pathlib import Path

from wsim.errors import UserError
from wsim.rules.planner import plan

GRAMMAR = Path(__file__).parent / "data" / "sentences.toml"
PATIENCE = 900.0  # [s] for one world
_SLOT = re.compile(r"\{(\w+)\}")
_ARTICLE = re.compile(r"\ba\(n\) (\w)", re.IGNORECASE)


def sentences(seed: int, count: int) -> list[tuple[str, str]]:
    """Kinds of sentences and the sentences, all different, each kind about as often.

    Args:
        seed: Of the draw.
        count: How many.
    """
    grammar = tomllib.loads(GRAMMAR.read_text(encoding="utf-8"))
    rng = random.Random(seed)
    found: dict[str, str] = {}
    kinds = list(grammar["sentence"])
    misses = 0
    while len(found) < count and misses < 50 * count:
        kind = kinds[(len(found) + misses) % len(kinds)]
        text = _spelled(_expanded(rng.choice(grammar["sentence"][kind]), grammar["symbol"], rng))
        misses += text in found
        found.setdefault(text, kind)
    return [(kind, text) for text, kind in found.items()]


def _expanded(text: str, symbols: dict[str, list[str]], rng: random.Random) -> str:
    while slot := _SLOT.search(text):
        text = text[: slot.start()] + rng.choice(symbols[slot[1]]) + text[slot.end() :]
    return text


def _spelled(text: str) -> str:
    text = _ARTICLE.sub(lambda found: f"{'an' if found[1] in 'aeio' else 'a'} {found[1]}", text)
    return text[0].upper() + text[1:]


def interval(hits: int, of: int) -> str:
    """A share with its 95 % interval (Wilson 1927)."""
    if not of:
        return "none"
    z, p = 1.96, hits / of
    middle, half = p + z * z / (2 * of), z * sqrt(p * (1 - p) / of + z * z / (4 * of * of))
    low, high = (100 * (middle + sign * half) / (1 + z * z / of) for sign in (-1, 1))
    return f"{hits} of {of} = {100 * p:.1f} % ({max(low, 0.0):.0f} to {min(high, 100.0):.0f})"


def refusal(text: str) -> str:
    """Why a sentence is not planned; empty where it is."""
    try:
        plan(text)
    except UserError as error:
        return str(error)
    except Exception as error:  # noqa: BLE001 - a crash is to be seen as one
        return f"CRASH {type(error).__name__}: {error}"
    return ""


def built(text: str, runs: Path, pictures: bool) -> tuple[str, str, float]:
    """Status, summary and seconds of the world that a sentence becomes."""
    started = time.perf_counter()
    command = [str(Path(sys.executable).with_name("wsim")), "generate", text, "--yes", "--runs", str(runs)]
    try:
        done = subprocess.run(
            [*command, *([] if pictures else ["--no-pictures"])], capture_output=True, text=True, timeout=PATIENCE
        )
    except subprocess.TimeoutExpired:
        return "timeout", f"more than {PATIENCE:g} s", PATIENCE
    said = done.stdout + done.stderr
    folder = next((Path(line) for line in re.findall(r"\S*/\d{8}-\S+", said) if Path(line).is_dir()), None)
    seconds = time.perf_counter() - started
    if folder is None or not (folder / "run.json").is_file():
        return "failed", said[-300:], seconds
    facts = json.loads((folder / "run.json").read_text(encoding="utf-8"))
    return facts.get("status", "?"), f"{folder}: {facts.get('summary', '')}", seconds


def _table(title: str, rows: Sequence[tuple[str, bool]]) -> Iterator[str]:
    good, of = Counter(kind for kind, fine in rows if fine), Counter(kind for kind, _ in rows)
    yield f"{title}: {interval(sum(good.values()), len(rows))}"
    for kind in of:
        yield f"  {kind:12} {good[kind]:4} of {of[kind]}"


def main() -> None:
    """Draw, plan, and build."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--build", type=int, default=0, help="how many of those that are planned become worlds")
    parser.add_argument("--pictures", action="store_true")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--runs", type=Path, help="folder of the worlds; a temporary one by default")
    parser.add_argument("--only", help="one kind of sentences")
    given = parser.parse_args()
    drawn = [(kind, text) for kind, text in sentences(given.seed, given.count) if given.only in (None, kind)]
    planned = []
    for kind, text in drawn:
        why = refusal(text)
        planned.append((kind, text, not why))
        if why:
            print(f"[{kind}] {text}\n    {why.splitlines()[0][:200]}", flush=True)
    print("\n".join(_table("planned", [(kind, fine) for kind, _, fine in planned])), flush=True)
    if not given.build:
        return
    runs = given.runs or Path(tempfile.mkdtemp(prefix="sentences-"))
    chosen = [(kind, text) for kind, text, fine in planned if fine]
    random.Random(given.seed).shuffle(chosen)
    rows = []
    with ThreadPoolExecutor(given.jobs) as pool:
        results = pool.map(lambda one: built(one[1], runs, given.pictures), chosen[: given.build])
        for (kind, text), (status, summary, seconds) in zip(chosen, results, strict=False):
            rows.append((kind, status == "accepted"))
            if status != "accepted" or given.pictures:
                print(f"[{kind}] {text}\n    {status} after {seconds:.0f} s: {summary[:400]}", flush=True)
            left = (given.build - len(rows)) * seconds / given.jobs
            print(f"{len(rows)} of {given.build}, about {left / 60:.0f} min left", file=sys.stderr, flush=True)
    print("\n".join(_table("accepted", rows)))


if __name__ == "__main__":
    main()
