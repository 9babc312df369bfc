"""How long work tells how far it is."""

from __future__ import annotations

from typing import Protocol


class Progress(Protocol):
    """Called with what is being done and how much of it is done, in any unit that `total` shares."""

    def __call__(self, stage: str, done: float, total: float) -> None:
        """Report that `done` of `total` of `stage` is finished."""


def silent(stage: str, done: float, total: float) -> None:
    """Report nothing."""
