"""Malformed plan files: each must be refused in one line, or be a plan; none may trace back, and none may hang.

    .venv/bin/python benchmarks/plan_fuzz.py --count 100000 --jobs 2

The files are mutations of the plans in examples/plans: values of wrong types, fields deleted, misspelt and given twice,
numbers that are huge or no numbers, deep nesting, giant texts and lists, other encodings, cut and garbled text, halves
of characters, names taken twice, references to nothing and in circles, predicates with wrong arguments. The same seed
makes the same files.
"""

from __future__ import annotations

import argparse
import copy
import json
import multiprocessing
import random
import signal
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from types import FrameType
from typing import Any

from wsim.errors import UserError
from wsim.plan.schema import PREDICATES
from wsim.plan.store import load, read

EXAMPLES = Path(__file__).parents[1] / "examples" / "plans"
PATIENCE = 10.0  # [s] of processor time: a file that takes more hangs; 300 bodies in one place take 2 s
LONGEST_MESSAGE = 20_000  # characters
ODD: list[Any] = [
    None, True, False, 0, -1, 1, 2, 1e308, -1e308, 1e-308, 1.1e6, 10**30, -(10**30), float("nan"), float("inf"), "",
    " ", "x", "2",  "\ud800", "\udfff\ud800", "a\nb", "\x00", "ü" * 50, "../../etc/passwd", "__class__", [], {}, [[]],
    [None], {"": None}, {"kind": "proxy"}, [0.0, 0.0, 0.0], [1e6, 1e6, 1e6], [float("nan")] * 3, list(range(50)),
]  # fmt: skip
Mutation = Callable[[Any, random.Random], Any]
Place = tuple[Any, Any]  # a list or an object of the JSON, and an index or a key of it


class Hang(BaseException):
    """A file took too long; no `except Exception` may swallow it."""


def places(data: Any) -> list[Place]:
    """Every value of the tree, by what holds it."""
    found: list[Place] = []
    todo = [data]
    while todo:
        holder = todo.pop()
        pairs = list(holder.items()) if isinstance(holder, dict) else list(enumerate(holder))
        for key, value in pairs:
            found.append((holder, key))
            if isinstance(value, dict | list):
                todo.append(value)
    return found


def _replace(data: Any, rng: random.Random) -> Any:
    holder, key = rng.choice(places(data))
    holder[key] = copy.deepcopy(rng.choice(ODD))  # later mutations change it
    return data


def _replace_number(data: Any, rng: random.Random) -> Any:
    numbers = [(h, k) for h, k in places(data) if isinstance(h[k], int | float)]
    holder, key = rng.choice(numbers)
    holder[key] = rng.choice([0, -1, 1e-300, 1e5, 1e6, 1.0001e6, 1e300, -holder[key], holder[key] * 1000, 10**399])
    return data


def _delete(data: Any, rng: random.Random) -> Any:
    holder, key = rng.choice(places(data))
    del holder[key]
    return data


def _misspell(data: Any, rng: random.Random) -> Any:
    holder, key = rng.choice([place for place in places(data) if isinstance(place[1], str)])
    holder[rng.choice([key + "s", key[:-1], key.upper(), "\ud800", "", "x" * 10_000])] = holder.pop(key)
    return data


def _repeat(data: Any, rng: random.Random) -> Any:
    holder, key = rng.choice([place for place in places(data) if isinstance(place[1], int)])
    count = rng.choice([1, 2, 10, 100, 1000])
    holder[key:key] = [json.loads(json.dumps(holder[key])) for _ in range(count)]
    return data


def _shuffle(data: Any, rng: random.Random) -> Any:
    rng.shuffle(data["objects"])
    return data


def _unplace(data: Any, rng: random.Random) -> Any:
    """A fixed place for one, which its relations may contradict."""
    rng.choice(data["objects"])["pose"] = {
        "position": [rng.uniform(-5, 5) for _ in range(3)],
        "rotation_deg": [0, 0, 30],
    }
    return data


def _names(data: Any) -> list[str]:
    return [item["name"] for item in data["objects"]] + ["nothing", "water", "vehicle"]


def _rename(data: Any, rng: random.Random) -> Any:
    rng.choice(data["objects"])["name"] = rng.choice([*_names(data), "1st", "a b", "ö", "x" * 81])
    return data


def _relate(data: Any, rng: random.Random) -> Any:
    """Rows of any predicate with any arguments: circles, contradictions, references to nothing."""
    arguments: dict[str, Callable[[], Any]] = {
        "ref": lambda: rng.choice(_names(data)),
        "other": lambda: rng.choice(_names(data)),
        "axis": lambda: rng.choice(_names(data)),
        "gap": lambda: rng.choice([0, 0.1, 5, 1e6, -1]),
        "value": lambda: rng.choice([0, 0.3, 20, 1e6, -1]),
        "anchor": lambda: rng.choice(["top", "seat", "x"]),
        "by": lambda: rng.choice(["top", "center", "side"]),
        "region": lambda: {"low": [-1, -1], "high": [rng.choice([1, -1, 1e6]), 1]},
        "range": lambda: [rng.choice([0, -180, 1e6]), 90],
        "overlap": lambda: rng.choice([0.1, 5, 0]),
        "group": lambda: rng.choice(["vehicle", "g", "water"]),
        "members": lambda: rng.sample(_names(data), k=min(3, len(_names(data)))),
    }
    for _ in range(rng.choice([1, 1, 2, 8])):
        predicate = rng.choice(list(PREDICATES))
        spec = PREDICATES[predicate]
        chosen = [*spec.needs, *(name for name in spec.takes if rng.random() < 0.5)]
        if rng.random() < 0.1:
            chosen.append(rng.choice(list(arguments)))
        row = {"predicate": predicate, **{name: arguments[name]() for name in chosen}}
        item = rng.choice(data["objects"])
        rows = item.setdefault("topology", {}).setdefault("relation", [])
        if rows and rng.random() < 0.7:
            rows[rng.randrange(len(rows))] = row
        else:
            rows.append(row)
    return data


def _circle(data: Any, rng: random.Random) -> Any:
    """Each of some objects on, beside or facing the next, and the last the first."""
    ring = rng.sample(data["objects"], k=rng.randint(2, len(data["objects"])))
    predicate = rng.choice(["PLACE-ON", "FRONT-OF", "ALIGN-FRONT", "FACING-TO", "placed_on_top", "FACING-SAME-AS"])
    for one, after in zip(ring, [*ring[1:], ring[0]], strict=True):
        one["topology"] = {"relation": [{"predicate": predicate, "ref": after["name"]}]}
    return data


def _many(data: Any, rng: random.Random) -> Any:
    """Hundreds of objects in a tower or a row."""
    box = {"role": "rigid_body", "construction": {"kind": "proxy", "primitive": "box", "size": [0.1, 0.1, 0.1]}}
    predicate = rng.choice(["PLACE-ON", "FRONT-OF", "PLACE-ANYWHERE"])
    for k in range(rng.choice([20, 100, 300])):
        row = (
            {"predicate": predicate} if predicate == "PLACE-ANYWHERE" else {"predicate": predicate, "ref": f"m{k - 1}"}
        )
        rows = [row] if k else [{"predicate": "PLACE-ON-BASE"}]
        data["objects"].append({**box, "name": f"m{k}", "state": "static", "topology": {"relation": rows}})
    return data


def _giant(data: Any, rng: random.Random) -> Any:
    holder, key = rng.choice(places(data))
    size = rng.choice([10**4, 10**5, 10**6])
    holder[key] = rng.choice(["x" * size, [0.5] * (size // 10), {f"k{k}": k for k in range(size // 100)}])
    return data


TREE: list[tuple[Mutation, int]] = [
    (_replace, 30), (_replace_number, 12), (_delete, 12), (_misspell, 8), (_repeat, 5), (_shuffle, 3), (_unplace, 3),
    (_rename, 6), (_relate, 20), (_circle, 6), (_many, 1), (_giant, 2),
]  # fmt: skip


def _cut(text: bytes, rng: random.Random) -> bytes:
    return text[: rng.randrange(len(text))]


def _garble(text: bytes, rng: random.Random) -> bytes:
    raw = bytearray(text)
    for _ in range(rng.choice([1, 3, 30])):
        raw[rng.randrange(len(raw))] = rng.randrange(256)
    return bytes(raw)


def _encode(text: bytes, rng: random.Random) -> bytes:
    encoding = rng.choice(["utf-16", "utf-16-le", "utf-32", "utf-8-sig", "utf-7"])
    return text.decode("utf-8", "surrogatepass").encode(encoding, "surrogatepass")


def _nest(text: bytes, rng: random.Random) -> bytes:
    depth = rng.choice([100, 900, 1100, 10**4, 10**5])
    left, right = rng.choice([(b"[", b"]"), (b'{"a":', b"}")])
    deep = left * depth + b"1" + right * depth
    return deep if rng.random() < 0.3 else _put(text, deep, rng)


def _put(text: bytes, value: bytes, rng: random.Random) -> bytes:
    """A literal in place of one after a colon."""
    colons = [k for k, c in enumerate(text) if c == ord(":")]
    if not colons:
        return value
    at = rng.choice(colons)
    return text[: at + 1] + value + b"," + text[at + 1 :]


def _literal(text: bytes, rng: random.Random) -> bytes:
    odd = [b"NaN", b"-Infinity", b"1e999", b"-1e999", b"1" * 5000, b"0x10", b"01", b"'x'", b"\\u0000", b"undefined"]
    return _put(text, rng.choice(odd), rng)


def _twice(text: bytes, rng: random.Random) -> bytes:
    """A field given twice."""
    at = rng.choice([k for k, c in enumerate(text) if c == ord("{")] or [0])
    return text[: at + 1] + b'"name": "a", "name": "b", ' + text[at + 1 :]


def _other(text: bytes, rng: random.Random) -> bytes:
    return rng.choice([b"", b"\x00" * 1000, b"null", b"[]", b"{}", b'"', text + text, b"\xff" * 100, b"// a\n" + text])


TEXT = [(_cut, 4), (_garble, 6), (_encode, 2), (_nest, 4), (_literal, 4), (_twice, 2), (_other, 2)]


def malformed(sources: list[str], seed: int, number: int) -> tuple[str, bytes]:
    """A file's mutations, and its bytes."""
    rng = random.Random(f"{seed}/{number}")
    data = json.loads(rng.choice(sources))
    said = []
    if rng.random() < 0.75:
        for mutate in rng.choices([m for m, _ in TREE], [w for _, w in TREE], k=rng.choice([1, 1, 1, 2, 4])):
            try:
                data = mutate(data, rng)
            except (AttributeError, IndexError, KeyError, TypeError, ValueError):
                continue  # what it would change is gone already
            said.append(mutate.__name__)
    raw = json.dumps(data, ensure_ascii=rng.random() < 0.5).encode("utf-8", "surrogatepass")
    if not said or rng.random() < 0.05:
        (change,) = rng.choices([m for m, _ in TEXT], [w for _, w in TEXT])
        raw = change(raw, rng)
        said.append(change.__name__)
    return " ".join(said), raw


def _too_long(signum: int, frame: FrameType | None) -> None:
    raise Hang


def try_file(path: Path, lay_out: bool = True) -> tuple[str, str]:
    """What becomes of a file: "plan", "refused", "traceback", "hang" or "long message"; and the evidence."""
    signal.setitimer(signal.ITIMER_PROF, PATIENCE)
    try:
        (load if lay_out else read)(path)
    except UserError as error:
        message = str(error)
        bad = "\n" in message or len(message) > LONGEST_MESSAGE or not message.startswith(str(path))
        return ("long message", message[:300]) if bad else ("refused", "")
    except Hang:
        return "hang", traceback.format_exc(limit=-4)
    except BaseException:  # noqa: BLE001 - whatever else comes out is what this looks for
        return "traceback", traceback.format_exc(limit=-4)
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
    return "plan", ""


def run(
    seed: int, first: int, count: int, lay_out: bool = True, keep: Path | None = None
) -> tuple[Counter[str], list[str], float]:
    """Try files; how many came to what, reports of the faults, and the slowest file's seconds."""
    signal.signal(signal.SIGPROF, _too_long)
    sources = [path.read_text(encoding="utf-8") for path in sorted(EXAMPLES.glob("*.json"))]
    results: Counter[str] = Counter()
    faults: list[str] = []
    slowest = 0.0
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "plan.json"
        for number in range(first, first + count):
            said, raw = malformed(sources, seed, number)
            path.write_bytes(raw)
            began = time.process_time()
            result, evidence = try_file(path, lay_out)
            slowest = max(slowest, time.process_time() - began)
            results[result] += 1
            if evidence:
                faults.append(f"file {number} ({said}): {result}\n{evidence}")
                if keep:
                    keep.mkdir(parents=True, exist_ok=True)
                    (keep / f"{number}.json").write_bytes(raw)
    return results, faults, slowest


def main() -> int:
    """Print the counts; 1 if a file traced back or hung."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--no-layout", action="store_true", help="read and validate only")
    parser.add_argument("--keep", type=Path, help="folder for the files with a fault")
    parser.add_argument("--json", type=Path, help="write the counts here")
    given = parser.parse_args()
    began = time.perf_counter()
    share = -(-given.count // given.jobs)
    parts = [
        (given.seed, first, min(share, given.count - first), not given.no_layout, given.keep)
        for first in range(0, given.count, share)
    ]
    if given.jobs == 1:
        done = [run(*part) for part in parts]
    else:
        with multiprocessing.Pool(given.jobs) as pool:
            done = pool.starmap(run, parts)
    results = sum((counts for counts, _, _ in done), Counter())
    faults = [fault for _, found, _ in done for fault in found]
    for fault in faults[:20]:
        print(fault, file=sys.stderr)
    facts = {
        "files": given.count,
        "seed": given.seed,
        "laid out": "no" if given.no_layout else "yes",
        **{name: results[name] for name in ("refused", "plan", "traceback", "hang", "long message")},
        "slowest_s": round(max(slowest for _, _, slowest in done), 3),
        "seconds": round(time.perf_counter() - began, 1),
    }
    for name, value in facts.items():
        print(f"{name:>14}: {value:,}" if isinstance(value, int) else f"{name:>14}: {value}")
    if given.json:
        given.json.parent.mkdir(parents=True, exist_ok=True)
        given.json.write_text(json.dumps(facts, indent=2) + "\n", encoding="utf-8")
    return int(bool(faults))


if __name__ == "__main__":
    sys.exit(main())
