"""What models were asked in a run, and what it cost; why the run ended, where a limit or a model ended it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from wsim.report.numbers import NARROW_SPACE, number
from wsim.report.records import BUILTIN, Account
from wsim.report.text import duration

if TYPE_CHECKING:
    from wsim.report.records import Loop

ROLES = ("planner", "coder", "reviewer", "judge")
# What a cause of run.json means, and what allows more.
LIMITS = {
    "iteration limit": ("it may try no more", "--max-iterations"),
    "token limit": ("its tokens are used up", "--max-tokens"),
    "time limit": ("its time is over", "--max-seconds"),
}


@dataclass(frozen=True)
class CostRow:
    """A role, or all of them."""

    role: str
    model: str
    numbers: list[str]  # answered, from the cache, failed, tokens in, tokens out, time, cost


@dataclass(frozen=True)
class Cost:
    """What a run's models were asked; no rows where none was."""

    rows: list[CostRow]
    total: CostRow
    tokens: str  # in all, against the world that they made


def make_cost(loop: Loop, status: str) -> Cost | None:
    """What run.json says of models; None where it does not say."""
    if loop.usage is None:
        return None
    used = loop.usage.by_role
    roles = list(dict.fromkeys([*ROLES, *sorted(used)])) if loop.asked else []
    rows = [CostRow(role, _name(loop, role), _numbers(used.get(role))) for role in roles]
    allowed = loop.budget.get("tokens")
    words = "for this accepted world" if status == "accepted" else "and no world was accepted"
    tokens = f"{_count(loop.usage.tokens)} tokens in all{' ' if status == 'accepted' else ', '}{words}"
    tokens += f"; {_count(allowed)} were allowed" if allowed is not None else ""
    return Cost(rows, CostRow("all", "", _numbers(_sum(list(used.values())))), tokens + ".")


def why_it_ended(loop: Loop, facts: dict[str, Any]) -> tuple[str, str, str]:
    """Why a run ended without a verdict of its own: in plain words, as it was noted, and the option that allows more."""
    if not loop.cause:
        stopped = facts.get("status") == "stopped" and loop.looped
        return ("The run was stopped", str(facts.get("summary") or ""), "") if stopped else ("", "", "")
    kind, _, detail = loop.cause.partition(": ")
    state = "No program was accepted" if loop.iterations else "Nothing was built"
    if kind in LIMITS:
        words, option = LIMITS[kind]
        return f"{state}, and {words}", detail, option
    return f"{state}: a language model gave nothing that could be used", loop.cause, ""


def _name(loop: Loop, role: str) -> str:
    name = loop.models.get(role, "")
    return "built in, no model" if name == BUILTIN else name


def _numbers(account: Account | None) -> list[str]:
    if account is None:
        return [""] * 7
    tokens = (account.input_tokens, account.output_tokens)
    return [
        *(_count(x) for x in (account.requests, account.cached, account.failed, *tokens)),
        duration(account.seconds),
        "not known" if account.dollars is None else f"{number(account.dollars)}\N{NO-BREAK SPACE}$",
    ]


def _sum(accounts: list[Account]) -> Account:
    names = ("requests", "cached", "failed", "input_tokens", "output_tokens", "seconds")
    sums = {name: sum(getattr(account, name) for account in accounts) for name in names}
    prices = [account.dollars for account in accounts if account.requests]
    known = [price for price in prices if price is not None]
    return Account(**sums, dollars=sum(known) if known and len(known) == len(prices) else None)


def _count(x: float) -> str:
    """A whole number, however large."""
    return f"{x:,.0f}".replace(",", NARROW_SPACE)
