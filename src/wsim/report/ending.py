"""How a run ended, and which of its iterations the page is about, in words."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from wsim.report.contents import RunContents

# What a cause of run.json means, and the option that allows more.
LIMITS = {
    "iteration limit": ("it may try no more", "--max-iterations"),
    "token limit": ("its tokens are used up", "--max-tokens"),
    "time limit": ("its time is over", "--max-seconds"),
}


@dataclass(frozen=True)
class Ending:
    """Why a run ended with nothing accepted or rejected."""

    words: str
    detail: str = ""  # as run.json has it
    option: str = ""  # of wsim generate: allows more


def why_it_ended(contents: RunContents) -> Ending | None:
    """What stopped a run; None for one that came to its end."""
    loop, facts = contents.loop, contents.facts
    if not loop.cause:
        stopped = loop.looped and facts.get("status") == "stopped"
        return Ending("The run was stopped", str(facts.get("summary") or "")) if stopped else None
    cause = loop.cause.rstrip(".")
    kind, _, detail = cause.partition(": ")
    if kind in LIMITS:
        words, option = LIMITS[kind]
        return Ending(f"No program was accepted, and {words}", detail, option)
    # A reviewer or a judge that fails is done without; only these two end a run.
    if loop.iterations:
        return Ending("No program was accepted, and the coder's model gave no patch that could be used", cause)
    if ": cannot: " in cause:
        return Ending("Nothing was built: what is asked cannot be simulated", cause.partition(": cannot: ")[2])
    return Ending("Nothing was built: the planner's model gave no plan that could be used", cause)


def which_is_shown(contents: RunContents) -> str:
    """Which iteration the page is about, where that is not plain."""
    shown, newest, loop = contents.shown, contents.newest, contents.loop
    if shown is None or newest is None or not loop.looped:
        return ""
    count = len(contents.iterations)
    if shown is not newest:
        became = "was no better and was undone" if loop.tried(newest.index) else "was not finished"
        return f"Shown is iteration {shown.number}, the best of {count}; the newest, {newest.number}, {became}."
    if loop.tried(shown.index) is None:
        return f"Iteration {shown.number} was not finished; shown is what it left."
    return f"Shown is iteration {shown.number}, the newest of {count} and the best." if count > 1 else ""
