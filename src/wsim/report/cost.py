"""What models were asked in a run, and what it cost."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from wsim.report.numbers import NARROW_SPACE, number
from wsim.report.text import duration
from wsim.runs.records import BUILTIN, Account

if TYPE_CHECKING:
    from wsim.runs.records import Loop

ROLES = ("planner", "coder", "reviewer", "judge")


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
    return Cost(rows, CostRow("all", "", _total(list(used.values()))), tokens + ".")


def _name(loop: Loop, role: str) -> str:
    name = loop.models.get(role, "")
    return "built in, no model" if name == BUILTIN else name


def _numbers(account: Account | None) -> list[str]:
    if account is None:
        return [""] * 7
    kept = f" ({_count(account.cache_read_tokens)} kept by the provider)" if account.cache_read_tokens else ""
    return [
        *(_count(x) for x in (account.requests, account.cached, account.failed)),
        _count(account.input_tokens) + kept,
        _count(account.output_tokens),
        duration(account.seconds),
        "not known" if account.dollars is None else _dollars(account.dollars),
    ]


def _total(accounts: list[Account]) -> list[str]:
    """The numbers of all roles together; of the cost, what is known of it."""
    names = ("requests", "cached", "failed", "input_tokens", "output_tokens", "cache_read_tokens", "seconds")
    known = [account.dollars for account in accounts if account.dollars is not None]
    sums = {name: sum(getattr(account, name) for account in accounts) for name in names}
    numbers = _numbers(Account(**sums, dollars=sum(known) if known else None))
    partly = known and len(known) < sum(account.requests > 0 for account in accounts)
    return [*numbers[:-1], f"at least {numbers[-1]}" if partly else numbers[-1]]


def _dollars(x: float) -> str:
    return f"{number(x)}\N{NO-BREAK SPACE}$"


def _count(x: float) -> str:
    """A whole number, however large."""
    return f"{x:,.0f}".replace(",", NARROW_SPACE)
