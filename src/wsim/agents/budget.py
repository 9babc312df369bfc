"""What a run may use, and what it has used, by role."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import Any

from wsim.runs.records import Account, Usage


class BudgetError(Exception):
    """Tokens or time have run out: the run ends here, with the best that it has."""


@dataclass(frozen=True)
class Budget:
    """What a run may use.

    Attributes:
        iterations: Programs that are tried.
        tokens: In requests and replies of all roles together.
        seconds: Wall time [s].
        request_seconds: Wall time of one request to a model [s].
        attempts: How often a request is sent before it has failed.
    """

    iterations: int = 8
    tokens: int = 200_000
    seconds: float = 3600.0
    request_seconds: float = 180.0
    attempts: int = 3


@dataclass
class Ledger:
    """The accounts of a run, held against its budget."""

    budget: Budget = field(default_factory=Budget)
    accounts: dict[str, Account] = field(default_factory=dict)
    started: float = field(default_factory=time.monotonic)

    def account(self, role: str) -> Account:
        """A role's account."""
        return self.accounts.setdefault(role, Account())

    @property
    def tokens(self) -> int:
        """Used by all roles."""
        return sum(account.input_tokens + account.output_tokens for account in self.accounts.values())

    @property
    def seconds_used(self) -> float:
        """Since the run began [s]."""
        return time.monotonic() - self.started

    @property
    def seconds_left(self) -> float:
        """Of the run's time [s]."""
        return self.budget.seconds - self.seconds_used

    def check(self) -> None:
        """Look whether there is anything left.

        Raises:
            BudgetError: If not.
        """
        if self.tokens >= self.budget.tokens:
            raise BudgetError(f"token limit: {self.tokens} of {self.budget.tokens} tokens are used")
        self.check_time()

    def check_time(self) -> None:
        """Look whether there is time left.

        Raises:
            BudgetError: If not.
        """
        if self.seconds_left <= 0.0:
            raise BudgetError(f"time limit: {self.budget.seconds:g} s are over")

    def facts(self) -> dict[str, Any]:
        """For run.json: by role and in all."""
        by_role = {role: _rounded(account) for role, account in sorted(self.accounts.items())}
        return Usage(tokens=self.tokens, by_role=by_role).model_dump(exclude_none=True)


def _rounded(account: Account) -> Account:
    dollars = None if account.dollars is None else round(account.dollars, 5)
    return account.model_copy(update={"seconds": round(account.seconds, 1), "dollars": dollars})
