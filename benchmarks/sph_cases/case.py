"""What a validation case is, and what running it gives."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np


@dataclass
class Measured:
    """One run of a case at one spacing.

    `errors` holds a value for every key of the case's `reach`, in the same unit; `figures` are numbers worth a place
    in the table beside them; `curves` are lines for the plot, label -> (x, y), where a label that begins with
    "reference" is drawn in black.
    """

    errors: dict[str, float]
    figures: dict[str, float] = field(default_factory=dict)
    curves: dict[str, tuple[np.ndarray, np.ndarray]] = field(default_factory=dict)
    particles: int = 0
    simulated_seconds: float = 0.0
    wall_seconds: float = 0.0


@dataclass(frozen=True)
class Case:
    """A flow with a known answer.

    `reach[key]` is the largest error that counts as reached, `unit[key]` what it is measured in ("%", "J", …).
    `coarse` and `fine` are spacings [m], coarsest first; at least two each, so that convergence shows. `run` takes the
    Warp device's name and a spacing.
    """

    name: str
    title: str
    reference: str
    reach: dict[str, float]
    unit: dict[str, str]
    coarse: tuple[float, ...]
    fine: tuple[float, ...]
    run: Callable[[str, float], Measured]
    axes: tuple[str, str] = ("", "")
