"""The tables of the judge's error rates, with their confidence intervals."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from typing import Protocol

Z = 1.959964  # of a normal distribution's 95 %


class Judged(Protocol):
    """What the tables read of a run."""

    kind: str
    made: str
    family: str
    status: str
    checks: list[str]
    error: str

    @property
    def accepted(self) -> bool:
        """Whether the judge let it pass."""


def interval(k: int, n: int) -> tuple[float, float]:
    """95 % confidence interval of a rate of k in n: the score interval (Wilson, J. Am. Stat. Assoc. 22, 1927)."""
    if n == 0:
        return 0.0, 1.0
    p = k / n
    middle = (p + Z**2 / (2 * n)) / (1 + Z**2 / n)
    half = Z / (1 + Z**2 / n) * math.sqrt(p * (1 - p) / n + Z**2 / (4 * n**2))
    return max(0.0, middle - half), min(1.0, middle + half)


def rate(k: int, n: int) -> str:
    """A rate in words: "1 of 60 = 1.7 % (0.3 to 8.9 %)"."""
    low, high = interval(k, n)
    return f"{k} of {n} = {100 * k / max(n, 1):.1f} % ({100 * low:.1f} to {100 * high:.1f} %)"


def summary(outcomes: Sequence[Judged]) -> dict[str, object]:
    """The two rates; runs that the benchmark itself failed at count for neither."""
    judged = [outcome for outcome in outcomes if not outcome.error]
    faults = [outcome for outcome in judged if outcome.kind]
    sound = [outcome for outcome in judged if not outcome.kind]
    missed = sum(outcome.accepted for outcome in faults)
    wronged = sum(not outcome.accepted for outcome in sound)
    return {
        "faults": len(faults),
        "false_accepts": missed,
        "false_accept_interval": interval(missed, len(faults)),
        "sound": len(sound),
        "false_rejects": wronged,
        "false_reject_interval": interval(wronged, len(sound)),
        "broken": sum(bool(outcome.error) for outcome in outcomes),
    }


def fault_rows(outcomes: Sequence[Judged]) -> list[tuple[str, ...]]:
    """A row a kind: how it is made, runs, caught, false accepts, and what caught it."""
    rows = []
    faults = [outcome for outcome in outcomes if outcome.kind and not outcome.error]
    for kind in sorted({outcome.kind for outcome in faults}):
        here = [outcome for outcome in faults if outcome.kind == kind]
        missed = sum(outcome.accepted for outcome in here)
        by = Counter(check for outcome in here for check in outcome.checks)
        caught = ", ".join(f"{check} {count}" for check, count in by.most_common(4))
        made = ", ".join(sorted({outcome.made for outcome in here}))
        rows.append((kind, made, str(len(here)), str(len(here) - missed), str(missed), caught))
    return rows


def sound_rows(outcomes: Sequence[Judged]) -> list[tuple[str, ...]]:
    """A row a family: runs, accepted, false rejects, and what rejected them."""
    rows = []
    sound = [outcome for outcome in outcomes if not outcome.kind and not outcome.error]
    for family in sorted({outcome.family for outcome in sound}):
        here = [outcome for outcome in sound if outcome.family == family]
        wronged = [outcome for outcome in here if not outcome.accepted]
        by = Counter(check for outcome in wronged for check in outcome.checks)
        why = ", ".join(f"{check} {count}" for check, count in by.most_common(4))
        rows.append((family, str(len(here)), str(len(here) - len(wronged)), str(len(wronged)), why))
    return rows


FAULTS_HEADER = ("fault", "planted in", "runs", "caught", "false accepts", "caught by")
SOUND_HEADER = ("sound worlds", "runs", "accepted", "false rejects", "rejected by")


def _rates(outcomes: Sequence[Judged]) -> list[str]:
    judged = [outcome for outcome in outcomes if not outcome.error]
    faults = [outcome for outcome in judged if outcome.kind]
    sound = [outcome for outcome in judged if not outcome.kind]
    return [
        f"False accepts: {rate(sum(o.accepted for o in faults), len(faults))}.",
        f"False rejects: {rate(sum(not o.accepted for o in sound), len(sound))}.",
        "In brackets: 95 % confidence (Wilson).",
    ]


def print_tables(outcomes: Sequence[Judged]) -> None:
    """Both tables as aligned columns, then the rates, then what broke."""
    for header, rows in ((FAULTS_HEADER, fault_rows(outcomes)), (SOUND_HEADER, sound_rows(outcomes))):
        widths = [max(len(row[k]) for row in [header, *rows]) for k in range(len(header))]
        for row in [header, *rows]:
            print("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip())
        print()
    print("\n".join(_rates(outcomes)))
    broken = [outcome for outcome in outcomes if outcome.error]
    if broken:
        print(f"{len(broken)} runs could not be judged, or their faults are none.")


def markdown(outcomes: Sequence[Judged]) -> str:
    """Both tables and the rates, for the documentation."""
    parts = []
    for header, rows in ((FAULTS_HEADER, fault_rows(outcomes)), (SOUND_HEADER, sound_rows(outcomes))):
        lines = [" | ".join(row) for row in [header, ("---",) * len(header), *rows]]
        parts.append("".join(f"| {line} |\n" for line in lines))
    return "\n".join([*parts, " ".join(_rates(outcomes)) + "\n"])


def between_marks(text: str, tables: str, name: str = "faults") -> str:
    """A document with its tables in place of those between the two marks of a name.

    Raises:
        ValueError: If the marks are not there, in order.
    """
    first, last = f"<!-- {name}:begin -->", f"<!-- {name}:end -->"
    before, begin, rest = text.partition(first)
    _, end, after = rest.partition(last)
    if not begin or not end:
        raise ValueError(f"the document has no {first} followed by {last}; add the two lines where the tables go")
    return f"{before}{begin}\n{tables.rstrip()}\n{end}{after}"
