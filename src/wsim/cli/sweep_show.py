"""What `wsim sweep` shows at its end: the first rows of the table, and what the room hangs on."""

from __future__ import annotations

from collections import Counter

from rich.table import Table
from rich.text import Text

from wsim.cli.show import STATUS_STYLE, console
from wsim.sweep.candidate import Outcome
from wsim.sweep.sensitivity import sensitivities
from wsim.sweep.spec import Spec
from wsim.sweep.table import parameters

SHOWN = 12  # rows


def show(outcomes: list[Outcome]) -> None:
    """The first rows of the table, and how many there are of each status."""
    names = parameters(outcomes)
    several = len({outcome.candidate.program for outcome in outcomes}) > 1
    table = Table(show_edge=False, pad_edge=False)
    for column in (
        "rank",
        "candidate",
        *(["program"] if several else []),
        *names,
        "status",
        "slack",
        "decided by",
        "s",
    ):
        table.add_column(column, overflow="fold")
    for rank, outcome in enumerate(outcomes[:SHOWN], start=1):
        values = [outcome.candidate.values.get(name) for name in names]
        stands = "" if outcome.candidate.values else "as it stands"  # else this program has no such parameter
        numbers = [stands if value is None else f"{value:.4g}" for value in values]
        slack = "" if outcome.slack is None else f"{outcome.slack:+.3f}"
        program = [outcome.candidate.program] if several else []
        cells = [str(rank), str(outcome.candidate.number), *program, *numbers]
        row = [*map(Text, cells), Text(outcome.status, style=STATUS_STYLE.get(outcome.status, "bold magenta"))]
        table.add_row(*row, Text(slack), Text(outcome.decided_by or outcome.reason), Text(f"{outcome.seconds:.1f}"))
    console.print(table)
    counts = {status: sum(o.status == status for o in outcomes) for status in {o.status: 0 for o in outcomes}}
    console.print(", ".join(f"{count} {status}" for status, count in counts.items()) + f" of {len(outcomes)}")
    accepted = [outcome for outcome in outcomes if outcome.status == "accepted"]
    if len(accepted) > 1 and all(outcome.slack is None for outcome in accepted):
        console.print("no objective ranks the accepted: they stand by their numbers; --plan gives what to rank by")
    for note, count in Counter(outcome.note for outcome in outcomes if outcome.note).most_common():
        console.print(f"{count} {note}", soft_wrap=True)
    if outcomes and outcomes[0].status == "accepted" and outcomes[0].together > 1:
        console.print("the best was judged in its batch alone, without contacts and ties; --full runs it by itself")


def show_sensitivity(spec: Spec, outcomes: list[Outcome]) -> None:
    """Which parameter the room to the limit hangs on, where the points tell."""
    for each in sensitivities(spec, outcomes)[:1]:
        table = Table(show_edge=False, pad_edge=False)
        for column in (f"{each.result} hangs on", "by itself", "95 %", "with others", "95 %"):
            table.add_column(column, justify="left" if column.startswith(each.result) else "right")
        for index in each.indices:
            low, high = index.first_between
            own = [f"{index.first:.2f}", f"{low:.2f} … {high:.2f}"]
            low, high = index.total_between
            table.add_row(index.name, *own, f"{index.total:.2f}", f"{low:.2f} … {high:.2f}")
        console.print(table)
