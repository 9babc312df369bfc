"""All candidates in one table: a row for each, the best first."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet

from wsim.sweep.candidate import Outcome

FIRST = ("rank", "candidate", "program", "seed")
DECIDED = ("status", "slack", "decided_by")
LAST = ("failures", "reason", "seconds", "together", "note")


def ranked(outcomes: Sequence[Outcome]) -> list[Outcome]:
    """The best first: by verdict, then by the room to the limit that decides."""
    return sorted(outcomes, key=lambda outcome: outcome.rank)


def parameters(outcomes: Sequence[Outcome]) -> list[str]:
    """What candidates differ in."""
    return list(dict.fromkeys(name for outcome in outcomes for name in outcome.candidate.values))


def table(outcomes: Sequence[Outcome]) -> pa.Table:
    """Columns: rank, candidate, program, seed, each parameter and draw, status, slack, decided_by, each objective's
    value and margin, failures, reason, seconds, how many were simulated together, note. Nothing stands where one has
    none; a parameter that is called as one of the other columns is `parameter: NAME`."""
    best_first = ranked(outcomes)
    rows = [_row(rank, outcome) for rank, outcome in enumerate(best_first, start=1)]
    params, objectives = map(_column, parameters(outcomes)), _objectives(outcomes)
    order = [*FIRST, *params, *DECIDED, *objectives, *LAST] if rows else []
    return pa.table({name: [row.get(name) for row in rows] for name in order})


def write(outcomes: Sequence[Outcome], folder: Path) -> list[Path]:
    """table.parquet and table.csv; each whole or not there."""
    made, paths = table(outcomes), [folder / "table.parquet", folder / "table.csv"]
    for path, put in zip(paths, (pa.parquet.write_table, pa.csv.write_csv), strict=True):
        partial = path.with_name(path.name + ".partial")
        put(made, partial)
        partial.replace(path)
    return paths


def _objectives(outcomes: Sequence[Outcome]) -> list[str]:
    names = dict.fromkeys(name for outcome in outcomes for name in (*outcome.values, *outcome.margins))
    return [f"{what}: {name}" for name in names for what in ("value", "margin")]


def _column(name: str) -> str:
    return f"parameter: {name}" if name in (*FIRST, *DECIDED, *LAST) else name


def _row(rank: int, outcome: Outcome) -> dict[str, Any]:
    candidate = outcome.candidate
    row: dict[str, Any] = {"rank": rank, "candidate": candidate.number, "program": candidate.program}
    row |= {"seed": candidate.seed}
    row |= {_column(name): value for name, value in candidate.values.items()}
    row |= {"status": outcome.status, "slack": outcome.slack, "decided_by": outcome.decided_by}
    row |= {f"value: {name}": value for name, value in outcome.values.items()}
    row |= {f"margin: {name}": value for name, value in outcome.margins.items()}
    row |= {"failures": "; ".join(outcome.failures), "reason": outcome.reason, "seconds": outcome.seconds}
    return row | {"together": outcome.together, "note": outcome.note}
