"""How often do the searches find what is meant, when it is said in other words?

    .venv/bin/python benchmarks/search.py              shares of three searches, and what was missed of the tuning half
    .venv/bin/python benchmarks/search.py --half all   and what was missed of the half that is held out

A query counts if a right answer is among the first three hits. Every second one is held out: nothing was changed to
suit it.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from fnmatch import fnmatchcase
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT)] if str(ROOT) not in sys.path else []

from benchmarks.search_cases import API, ASSETS, SKILLS, Cases  # noqa: E402
from wsim.assets import search as search_assets  # noqa: E402
from wsim.program.api import index  # noqa: E402
from wsim.skills import pick  # noqa: E402

TOP = 3


def _assets(words: str) -> list[str]:
    return [hit.asset.id for hit in search_assets(words, TOP)]


def _skills(words: str) -> list[str]:
    return [picked.skill.name for picked in pick(words, TOP)]


def _api(words: str) -> list[str]:
    return [hit.entry.name for hit in index().search(words, TOP)]


SEARCHES: dict[str, tuple[Cases, Callable[[str], list[str]]]] = {
    "assets": (ASSETS, _assets),
    "skills": (SKILLS, _skills),
    "API": (API, _api),
}


def found(right: str, hits: list[str]) -> bool:
    """Whether a right answer is among the hits."""
    return any(fnmatchcase(hit, pattern) for hit in hits for pattern in right.split())


def misses(cases: Cases, search: Callable[[str], list[str]], half: str = "all") -> dict[str, list[str]]:
    """The hits of each query that missed: of the "tuning" half, of the "held out" one, or of "all"."""
    start, step = {"tuning": (0, 2), "held out": (1, 2), "all": (0, 1)}[half]
    asked = {words: search(words) for words in list(cases)[start::step]}
    return {words: hits for words, hits in asked.items() if not found(cases[words], hits)}


def main() -> None:
    """Print the shares, and what was missed."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--half", choices=("tuning", "all"), default="tuning", help="whose misses to list")
    shown = parser.parse_args().half
    print(f"{'':8}  tuning   held out  all")
    for name, (cases, search) in SEARCHES.items():
        missed = {half: len(misses(cases, search, half)) for half in ("tuning", "held out")}
        odd = len(cases) // 2
        even = len(cases) - odd
        total = sum(missed.values())
        print(
            f"{name:8}  {even - missed['tuning']:2} of {even}  {odd - missed['held out']:2} of {odd}  "
            f"{len(cases) - total} of {len(cases)}"
        )
    for name, (cases, search) in SEARCHES.items():
        for words, hits in misses(cases, search, shown).items():
            print(f"{name}: {words!r} finds {hits}, not {cases[words]}")


if __name__ == "__main__":
    main()
