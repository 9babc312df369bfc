"""Points that come to touch within an interval: too softly for a blow, but what they change no frame shows.

A box that rocks as it slides lands on one corner after another. Each landing takes the speed at which the point met,
and shares it out to all of the body's motion: how its other points slip changes with it, and back again with the next,
all between two frames. By the reduced mass M of both an impulse of (1 + e) M u changes a body's velocities by about
(1 + e) M u / m, where the pair bounces with e. What parts at v from what it bounces off has met it at v / e. Across a
gap that is open as the interval begins a body falls, too: of a gap d it comes with v^2 = u^2 + 2 g d at most, and so it
does where it still rises at u and falls back before the interval ends, as a barrel does that a blow has tipped.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.books.forces import slip

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.books.forces import Poses
    from wsim.judge.books.touching import Contacts, Touching
    from wsim.judge.evidence.evidence import Evidence

    Floats = NDArray[np.float64]

OPEN = 1e-4  # [m]: a wider gap; of what lies on each other wsim leaves 1e-8
TURNS = 0.04  # [rad]: friction of 0.5 that is as far off its way leaves 0.02 of the push: what an interval may lack


def landing(touching: Touching, contacts: Contacts, poses: Poses, h: Floats, mass: Floats, end: int = 0) -> Floats:
    """By how much landings may change the velocities of bodies in an interval, (B,) [m/s].

    Args:
        touching: The shapes.
        contacts: Points that are near each other at
        poses: of the bodies as the interval begins or ends, or as they would go on from there, or came to it.
        h: Length of the interval of each body, (B,) [s].
        mass: (B,) [kg].
        end: 0 where the poses are told from the interval's beginning, 1 where they are from its end.
    """
    found = np.zeros(len(mass))
    if not len(contacts):
        return found
    closing = -np.einsum("ni,ni->n", slip(touching, contacts, poses), contacts.normal)
    bounce = touching.bounces(contacts.shapes)
    if end:  # what parts has bounced: it met at its speed over the restitution
        closing = np.where(bounce > 0.0, -closing, 0.0)
    rows = np.stack([contacts.one, contacts.two])
    moves, at = rows >= 0, np.maximum(rows, 0)
    pull, time = float(np.linalg.norm(touching.world.gravity)), h[at.max(axis=0)]
    falls = np.where((contacts.gap > OPEN) & (end == 0), pull, 0.0)
    lands = ((closing > 0.0) | (falls > 0.0)) & (contacts.gap <= (closing + 0.5 * falls * time) * time)
    closing = np.sqrt(closing**2 + 2.0 * falls * np.maximum(contacts.gap, 0.0)) * lands
    met = closing * (1.0 + (1.0 / np.maximum(bounce, 1e-9) if end else bounce))
    light = np.where(moves, 1.0 / mass[at], 0.0)
    for side in (0, 1):
        ours = lands & moves[side]
        np.maximum.at(found, at[side][ours], (met * light[side] / light.sum(axis=0))[ours])
    return found


def keeps_way(contacts: Contacts, speed: Floats, landed: Floats) -> NDArray[np.bool_]:
    """Whether contacts that slip at a speed (n,) [m/s] keep their way with what landings may change, (B,) [m/s]."""
    changes = sum(np.where(rows >= 0, landed[np.maximum(rows, 0)], 0.0) for rows in (contacts.one, contacts.two))
    return np.asarray(changes <= TURNS * speed)


def caught(evidence: Evidence, hit: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Where what hits a body between two frames (T - 1, B) may go on: as long as contacts that yield take to catch it.

    Such contacts take a slip as they take an approach, in that time, and not with all of their friction.
    """
    time, within = evidence.time, evidence.world.give.time
    found = hit.copy()
    for n in range(1, len(hit)):
        goes_on = time[n:-1] - time[1:-n] < within
        if not goes_on.any():
            break
        found[n:] |= hit[:-n] & goes_on[:, None]
    return found
