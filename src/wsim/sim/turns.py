"""Controllers, and whose turn it is."""

from __future__ import annotations

from typing import Any, Protocol


class Controller(Protocol):
    """What drives joints and pushes bodies: called once a control step."""

    def __call__(self, t: float, simulation: Any) -> None:
        """Read the state of the `Simulation`, and set its `control` and `control_force`."""


class Turns:
    """Controllers that are asked each at its own interval, rounded to whole steps, in the order of their coming.

    Args:
        dt: The time step [s].
    """

    def __init__(self, dt: float) -> None:
        self._dt = dt
        self._all: list[tuple[int, Controller]] = []

    def __bool__(self) -> bool:
        return bool(self._all)

    def add(self, controller: Controller, interval: float) -> None:
        """Let one more be asked, every `interval` [s]."""
        self._all.append((max(1, round(interval / self._dt)), controller))

    def ask(self, step: int, simulation: Any) -> int:
        """Ask those whose turn is at a step; the steps until the next turn of any."""
        for every, controller in self._all:
            if step % every == 0:
                controller(step * self._dt, simulation)
        return min(every - step % every for every, _ in self._all)
