"""The slip that a step's contacts are left with, sought until a solution leaves what it was guessed to."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from wsim.solvers.contact_config import ContactConfig

Array = np.ndarray
SMALL_CHANGE = 1e-8  # [m/s]: less says nothing about how what is left goes with the guess
MOST_SHARE = 19.0  # of the solution before: as where what is left is 0.95 of what was


def seek_slip(
    left: Callable[[Array], Array],
    slip: Array,
    bodies: Array,
    blows: bool,
    config: ContactConfig,
    near: tuple[float, float],
) -> None:
    """Solve until the slips that are left are those that were guessed.

    What wedges itself in has none, or none that is found: then the nearest of all counts, not the last.

    Args:
        left: Solves with guessed slips, times friction [m/s], (contacts,), and says which the solution leaves.
        slip: The first guess.
        bodies: Of each contact, (contacts, 2), 0 for the world.
        blows: Whether surfaces meet, whose first solution does not know yet what its regularisation gives way.
        config: How often.
        near: How near is near enough, at first and after some solutions [m/s].
    """
    before: tuple[Array, Array] | None = None
    nearest, best = math.inf, slip
    for k in range(config.most_solutions):
        found = left(slip)
        change = float(np.abs(found - slip).max(initial=0.0))
        if change < near[0] and (k or not blows):
            return
        if change < near[1] and k + 1 >= config.solutions:
            return
        if change < nearest:
            nearest, best = change, slip
        goes = np.maximum(found, 0.0) if before is None else extrapolated(slip, found, before, bodies)
        slip, before = goes, (slip, found)
    left(best)


def extrapolated(slip: Array, left: Array, before: tuple[Array, Array], bodies: Array) -> Array:
    """Slips that a solution will leave as they were guessed, by the secant through two solutions (Anderson 1965).

    A push is asked for by the slip, and its friction changes the slip. What is left goes by a / (1 + a) with the guess
    where a ball slides, a = mu² A_t / A_n, A what it yields to a push along and across: 3.5 mu². It goes against the
    guess where a crate is shoved off, and what comes to stick leaves nothing. The contacts of a body change together:
    the share of each of two solutions is that which would have left the least over all of them, for a contact over
    those of both its bodies.

    Args:
        slip: Guessed, times friction [m/s], (contacts,).
        left: By the solution with that guess.
        before: The same two of the solution before.
        bodies: (contacts, 2), 0 for the world.
    """
    rest = left - slip
    change = rest - (before[1] - before[0])
    over, under = _of_both_bodies(change * rest, bodies), _of_both_bodies(change * change, bodies)
    share = np.divide(over, under, out=np.zeros(len(slip)), where=under > SMALL_CHANGE**2)
    return np.maximum(left - np.clip(share, -MOST_SHARE, 1.0) * (left - before[1]), 0.0)


def _of_both_bodies(values: Array, bodies: Array) -> Array:
    """Sums of contacts' values over all contacts of their first body and of their second, the world's left out."""
    sums = np.bincount(bodies.ravel(), np.repeat(values, 2))
    sums[0] = 0.0
    return np.asarray(sums[bodies].sum(axis=1))
