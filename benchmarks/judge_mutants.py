"""Does the suite notice when the judge is wrong? Flip one comparison, or drop one check, and run the judge's tests.

    .venv/bin/python benchmarks/judge_mutants.py --count 40 --seed 1 --jobs 2 --json build/judge_mutants.json

Each mutant is a copy of the package with one change: a comparison of `src/wsim/judge` turned round (`<` to `>=`, `<=`
to `>`, `==` to `!=` and back), `at_most=False` left out, or a check taken from
its module's `CHECKS`. A mutant is noticed if a test fails. Mutants are drawn by a seed from all there are; every
dropped check is among them with `--drops`. What survives is printed with its place: a missing test, or a comparison
where both sides do.
"""

from __future__ import annotations

import argparse
import ast
import json
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
JUDGE = Path("src/wsim/judge")
LIST = "CHECKS"  # of a module of checks
TURNED: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.GtE, ast.GtE: ast.Lt, ast.Gt: ast.LtE, ast.LtE: ast.Gt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq,
}  # fmt: skip


@dataclass
class Mutant:
    """One change: `what` at a line of a file of the judge, and whether a test failed for it."""

    path: str
    line: int
    what: str
    text: str  # of the whole file
    noticed: bool | None = None


def mutants_of(path: Path) -> Iterator[Mutant]:
    """Every mutant of a file."""
    source = (ROOT / path).read_text(encoding="utf-8")
    for index, node in enumerate(ast.walk(ast.parse(source))):
        for what in _changes(node):
            tree = ast.parse(source)
            twin = next(other for k, other in enumerate(ast.walk(tree)) if k == index)
            _apply(twin, what)
            yield Mutant(str(path), getattr(node, "lineno", 0), what, ast.unparse(tree))


def _changes(node: ast.AST) -> list[str]:
    """What can be done to a node, in words."""
    if isinstance(node, ast.Compare) and len(node.ops) == 1 and type(node.ops[0]) in TURNED:
        return [f"turned {ast.unparse(node)}"]
    if isinstance(node, ast.keyword) and node.arg == "at_most" and ast.unparse(node.value) == "False":
        return ["at_most=False left out"]
    if isinstance(node, ast.AnnAssign) and ast.unparse(node.target) == LIST and isinstance(node.value, ast.Tuple):
        return [f"dropped {ast.unparse(item)}" for item in node.value.elts]
    return []


def _apply(node: ast.AST, what: str) -> None:
    if isinstance(node, ast.Compare):
        node.ops = [TURNED[type(node.ops[0])]()]
    elif isinstance(node, ast.keyword):
        node.value = ast.Constant(value=True)
    elif isinstance(node, ast.AnnAssign):
        assert isinstance(node.value, ast.Tuple)
        node.value.elts = [item for item in node.value.elts if f"dropped {ast.unparse(item)}" != what]


def suite_passes(path: str = "", text: str = "") -> bool:
    """Run the judge's tests on a copy of the project, one file of it replaced."""
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder)
        for item in ROOT.iterdir():
            if item.name == "src":
                shutil.copytree(item, copy / "src")
            elif item.name not in {".git", "build", "runs"}:
                (copy / item.name).symlink_to(item)
        if path:
            (copy / path).write_text(text, encoding="utf-8")
        command = [sys.executable, "-m", "pytest", "tests/judge", "-x", "-q", "-p", "no:cacheprovider"]
        environment = {**os.environ, "PYTHONPATH": str(copy / "src")}
        ended = subprocess.run(command, cwd=copy, env=environment, capture_output=True, timeout=900, check=False)
    return ended.returncode == 0


def try_out(mutant: Mutant) -> Mutant:
    """See whether a test fails for a mutant."""
    mutant.noticed = not suite_passes(mutant.path, mutant.text)
    return mutant


def main() -> None:
    """Draw mutants, try them, and print what survived."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=40, help="comparisons to turn")
    parser.add_argument("--drops", action="store_true", help="every dropped check as well")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--json", type=Path)
    given = parser.parse_args()
    files = sorted((ROOT / JUDGE).rglob("*.py"))
    every = [mutant for path in files for mutant in mutants_of(path.relative_to(ROOT))]
    dropped = [mutant for mutant in every if mutant.what.startswith("dropped")]
    turned = [mutant for mutant in every if mutant not in dropped]
    chosen = random.Random(given.seed).sample(turned, min(given.count, len(turned))) + dropped * given.drops
    print(f"{len(chosen)} of {len(every)} mutants", flush=True)
    if not suite_passes():
        sys.exit("the tests fail without any mutant: nothing can be said of mutants")
    began = time.perf_counter()
    with ThreadPoolExecutor(given.jobs) as pool:
        for done, mutant in enumerate(pool.map(try_out, chosen), 1):
            left = (time.perf_counter() - began) / done * (len(chosen) - done)
            fate = "noticed " if mutant.noticed else "SURVIVED"
            print(
                f"[{done}/{len(chosen)}, {left:.0f} s left] {fate} {mutant.path}:{mutant.line} {mutant.what}",
                flush=True,
            )
    print(f"noticed: {sum(bool(m.noticed) for m in chosen)} of {len(chosen)}")
    if given.json:
        given.json.parent.mkdir(parents=True, exist_ok=True)
        rows = [{k: v for k, v in asdict(m).items() if k != "text"} for m in chosen]
        given.json.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
